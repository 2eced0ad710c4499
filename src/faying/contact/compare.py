"""Several laws at one row of pressures."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import ArrayLike

from faying.checks import choice
from faying.contact.law import ContactLaw, Response, checked
from faying.contact.models.half_space import HalfSpace
from faying.contact.response import UNITS
from faying.errors import FayingError, InputError, shown
from faying.typing import Array


@final
@dataclass(frozen=True, kw_only=True)
class Comparison:
    """Laws and their responses at one row of pressures [Pa], by name; `left_out` says why a law is missing.

    A response is NaN, and not valid, where the pressure lies outside what the law covers.
    """

    pressure: Array
    laws: Mapping[str, ContactLaw]
    responses: Mapping[str, Response]
    left_out: Mapping[str, str]

    def spread(self, quantity: str) -> Array:
        """Return the largest over the smallest value of a quantity among the laws that define it, per pressure [-].

        NaN where fewer than two laws answer.
        """
        choice(quantity, "quantity", tuple(UNITS))
        given = [r.quantities()[quantity] for r in self.responses.values() if quantity in r.quantities()]
        out = np.full(self.pressure.shape, np.nan)
        values = np.array([np.broadcast_to(v, out.shape) for v in given]) if given else np.empty((0, out.size))
        several = np.sum(values > 0, axis=0) >= 2
        kept = np.where(values > 0, values, np.nan)[:, several]
        if kept.size:
            out[several] = np.nanmax(kept, axis=0) / np.nanmin(kept, axis=0)
        return out

    def ratios(self, quantity: str) -> dict[str, Array]:
        """A quantity of every law that defines it over that of the half-space, per pressure [-]; empty without it."""
        choice(quantity, "quantity", tuple(UNITS))
        values = {name: r.quantities()[quantity] for name, r in self.responses.items() if quantity in r.quantities()}
        exact = values.get(HalfSpace.name)
        return {} if exact is None else {name: value / exact for name, value in values.items()}


def compare(
    laws: Mapping[str, ContactLaw], pressure: ArrayLike, left_out: Mapping[str, str] | None = None
) -> Comparison:
    """Ask every law for a row of pressures [Pa]; InputError for pressures that are not finite or not positive."""
    if not isinstance(laws, Mapping) or not all(isinstance(law, ContactLaw) for law in laws.values()):
        raise InputError(f'laws = {shown(laws)}; give contact laws by name, {{"JK": law}} say')
    p = np.atleast_1d(checked(pressure, name="pressure", unit="Pa", zero=False))
    missing = dict(left_out or {})
    responses = {}
    for name, law in laws.items():
        try:
            responses[name] = _covered(law, p)
        except FayingError as fault:
            missing[name] = str(fault)
    kept = {name: law for name, law in laws.items() if name in responses}
    return Comparison(pressure=p, laws=kept, responses=responses, left_out=missing)


def _covered(law: ContactLaw, pressure: Array) -> Response:
    """Response with NaN where the law does not reach."""
    above_range = pressure > law.greatest_pressure * (1 + 1e-9)
    below = pressure < law.least_pressure * (1 - 1e-9)
    at = law.at_pressure(np.clip(pressure, law.least_pressure, law.greatest_pressure))
    out = above_range | below
    arrays = {name: np.where(out, np.nan, value) for name, value in at.quantities().items()}
    arrays["pressure"] = pressure.copy()
    reasons = {name: mask & ~out for name, mask in at.reasons.items()}
    reasons["pressure above what the law covers"] = above_range
    reasons["pressure below what the law resolves"] = below
    return Response(reasons=reasons, **arrays)
