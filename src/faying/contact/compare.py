"""Several laws on one surface: each takes its own inputs from it, all answer the same pressures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.inputs import SurfaceInputs
from faying.contact.law import ContactLaw, Response, checked
from faying.contact.registry import find_law, laws
from faying.errors import FayingError
from faying.materials import ContactPair
from faying.typing import Array

# the asperities that published models put into Greenwood and Williamson's sum
ASPERITIES = {
    "GW-CEB": "ChangEtsionBogy",
    "GW-KE": "KogutEtsion",
    "GW-ZMC": "ZhaoMaiettaChang",
    "GW-JG": "JacksonGreen",
}


def law_class(name: str) -> type[ContactLaw]:
    """Return the class of a law by any of its names; "GW-KE" and the like are Greenwood and Williamson's.

    Raises InputError for unknown names.
    """
    return laws()["GreenwoodWilliamson"] if name.upper() in ASPERITIES else find_law(name)


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


def laws_of_surface(
    surface: SurfaceInputs, pair: ContactPair, *, names: Sequence[str] | None = None, scan: Any = None
) -> tuple[dict[str, ContactLaw], dict[str, str]]:
    """Return the laws of a measured surface by name, and why others are left out.

    names: models to take (any spelling; "GW-KE" and the like put another asperity into GW); None takes all that live
    on numbers. A law with a field `scan` (the half-space) takes the scan itself, and only when it is named.
    Raises InputError for unknown names.
    """
    wanted = list(names) if names is not None else [*laws(), *ASPERITIES]
    made: dict[str, ContactLaw] = {}
    left_out: dict[str, str] = {}
    for name in wanted:
        upper = name.strip().upper()
        cls = law_class(name.strip())
        label = upper if upper in ASPERITIES else cls.name
        takes_scan = any(f.name == "scan" for f in fields(cls))  # type: ignore[arg-type]
        if names is None and cls.from_surface.__func__ is ContactLaw.from_surface.__func__:  # type: ignore[attr-defined]
            continue
        try:
            if takes_scan:
                made[label] = cls(scan=scan, pair=pair)  # type: ignore[call-arg]
            else:
                law = cls.from_surface(surface, pair)
                made[label] = law.with_(asperity=ASPERITIES[upper]) if upper in ASPERITIES else law
        except FayingError as fault:
            left_out[label] = str(fault)
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
