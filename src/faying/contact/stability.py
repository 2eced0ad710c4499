"""How far a law's stiffness depends on the window and on the resolution of the scan."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import log
from typing import final

import numpy as np

from faying.contact.build import LawKind
from faying.contact.inputs import FractalSurface
from faying.contact.law import ContactLaw
from faying.contact.mates import Mates
from faying.contact.models.half_space import HalfSpace
from faying.contact.two_faces import Counter, RoughPair
from faying.errors import FayingError, InputError
from faying.halfspace.solve import halved_map
from faying.surface.form import prepared
from faying.surface.scan import Profile, Scan

UNSTABLE = 0.25  # a greater relative change of k_n is told
CUTS = {"half window": 0.5, "quarter window": 0.25}
FULL, COARSE = "full scan", "half the points"
CASES = (FULL, *CUTS, COARSE)


@final
@dataclass(frozen=True, kw_only=True)
class Stability:
    """k_n of one law on parts of a scan.

    Args:
        label: of the law.
        pressure: at which it was asked [Pa].
        k_n: [Pa/m] on the full scan, on its middle half and quarter each way, and on half the points each way; NaN
            where the law has no answer.
    """

    label: str
    pressure: float
    k_n: Mapping[str, float]

    @property
    def factors(self) -> dict[str, float]:
        """k_n over that of the full scan [-]."""
        return {name: value / self.k_n[FULL] for name, value in self.k_n.items()}

    @property
    def worst(self) -> tuple[str, float]:
        """The part of the scan that moves k_n most, and its factor [-]; the whole and 1 where nothing was answered."""
        moved = {name: f for name, f in self.factors.items() if np.isfinite(f) and f > 0}
        return max(moved.items(), key=lambda item: abs(log(item[1])), default=(FULL, 1.0))

    @property
    def stable(self) -> bool:
        """Whether no part of the scan moves k_n by more than 25 %."""
        return abs(log(self.worst[1])) <= log(1 + UNSTABLE)


def stability(
    mates: Mates,
    *,
    model: LawKind | str = "auto",
    given: Mapping[str, object] | None = None,
    pressure: float,
) -> Stability:
    """Ask a law for k_n on the whole of a scan, on parts of it, and on fewer of its points.

    Args:
        mates: both faces, one of them an areal scan as it was measured; a scan of the other one is cut alike.
        model: the law; "auto" stays with the law that it takes on the full scan.
        given: entries of the law in SI units.
        pressure: nominal [Pa], above 0.

    Returns:
        The stiffnesses. Every part is levelled, filled and fitted anew, as a scan of that size would be; D and G that
        were given stay, and an area that was given goes with the window.

    Raises:
        InputError: for unknown laws, and where the law has no answer on the full scan.
    """
    law = mates.choose(model, given).law
    values = {FULL: stiffness_at(law, pressure)}
    for name in CASES[1:]:
        try:
            values[name] = stiffness_at(_part(mates, name).choose(law.name, given).law, pressure)
        except FayingError:
            values[name] = np.nan
    return Stability(label=law.name, pressure=pressure, k_n=values)


def _part(mates: Mates, name: str) -> Mates:
    """The mates on one of the parts of their scans; InputError where too few points are left."""
    faces, share = mates.faces, CUTS.get(name, 1.0)
    one, other = (_halved(one) if name == COARSE else cropped(one, share) for one in (faces.face, faces.counter))
    if not isinstance(one, Scan) or other is None:
        raise InputError("too few points")
    numbers = faces if faces.made is None else faces.made.inputs
    area = None if numbers.scan_area is None else share**2 * numbers.scan_area
    part = RoughPair(
        face=one, counter=other, method=faces.method, D=numbers.D, G=numbers.G, scan_area=area, cache=faces.cache
    )
    return Mates(part, materials=mates.pair)


def stiffness_at(law: ContactLaw, pressure: float) -> float:
    """k_n [Pa/m] at one pressure [Pa]; of the half-space by the one contact, not by its ladder."""
    if isinstance(law, HalfSpace):
        return law.stiffness_of_contact(pressure)
    k_n = law.at_pressure(pressure).k_n
    if k_n is None:
        raise InputError(f"{law.name} defines no normal stiffness")
    return float(k_n)


Part = Counter | Profile | FractalSurface


def cropped(scan: Part, share: float) -> Counter | None:
    """The middle part of a scan, a word as it is; None where too few points are left."""
    if not isinstance(scan, Scan):
        return scan if isinstance(scan, str) else None
    try:
        return scan.cropped(share)
    except InputError:
        return None


def _halved(scan: Part) -> Counter | None:
    """A scan on half as many points each way, by means over four, a word as it is; None where too few are left."""
    if not isinstance(scan, Scan):
        return scan if isinstance(scan, str) else None
    if min(scan.shape) < 32:
        return None
    ready = prepared(scan).scan
    heights, spacing = halved_map(ready.heights, ready.spacing)
    return Scan(heights=heights, spacing=spacing, source=scan.source, instrument=scan.instrument)
