"""Several laws on one surface: each takes its own inputs from it, all answer the same pressures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.auto import pick
from faying.contact.build import AUTO, find, kinds, label_of
from faying.contact.half_space import HalfSpace
from faying.contact.inputs import FractalSurface, RoughSurface
from faying.contact.law import ContactLaw, Response, checked
from faying.errors import FayingError
from faying.materials import ContactPair
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
        values = {name: r.quantities()[quantity] for name, r in self.responses.items() if quantity in r.quantities()}
        exact = values.get(HalfSpace.name)
        return {} if exact is None else {name: value / exact for name, value in values.items()}


def laws_of_surface(
    surface: RoughSurface | FractalSurface, pair: ContactPair, *, names: Sequence[str] | None = None
) -> tuple[dict[str, ContactLaw], dict[str, str]]:
    """Return the laws of a measured surface by label, and why others are left out.

    Args:
        surface: the rough surface, or its numbers alone.
        pair: the materials that meet.
        names: the laws to take, in any spelling; None takes all that the surface feeds, the half-space among them
            where there is a scan.

    Raises:
        InputError: unknown names.
    """
    rough = RoughSurface(inputs=surface) if isinstance(surface, FractalSurface) else surface
    fed = ("fractal", "moments", "scan") if rough.scan is not None else ("fractal", "moments")
    numbers = [kind for kind in kinds().values() if kind.label != AUTO and kind.law.takes() in fed]
    made: dict[str, ContactLaw] = {}
    left_out: dict[str, str] = {}
    for kind in numbers if names is None else [find(name) for name in names]:
        try:
            law = pick(kind, {}, rough, pair).law
            made[label_of(law).label if kind.label == AUTO else kind.label] = law
        except FayingError as fault:
            left_out[kind.label] = str(fault)
    return made, left_out


def compare(
    laws: Mapping[str, ContactLaw], pressure: ArrayLike, left_out: Mapping[str, str] | None = None
) -> Comparison:
    """Ask every law for a row of pressures [Pa]; InputError for pressures that are not finite or not positive."""
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
    beyond = pressure > law.greatest_pressure * (1 + 1e-9)
    below = pressure < law.least_pressure * (1 - 1e-9)
    at = law.at_pressure(np.clip(pressure, law.least_pressure, law.greatest_pressure))
    out = beyond | below
    arrays = {name: np.where(out, np.nan, value) for name, value in at.quantities().items()}
    arrays["pressure"] = pressure.copy()
    reasons = {name: mask & ~out for name, mask in at.reasons.items()}
    reasons["pressure above what the law covers"] = beyond
    reasons["pressure below what the law resolves"] = below
    return Response(reasons=reasons, **arrays)
