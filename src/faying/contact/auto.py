"""The default law: the numerical contact of the scan, or the analytic law that comes closest to it."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import exp, log
from typing import final

import numpy as np

from faying.contact.build import AUTO, LawKind, build, find, kinds
from faying.contact.inputs import RoughSurface
from faying.contact.law import ContactLaw
from faying.contact.models.half_space import HalfSpace
from faying.errors import FayingError, InputError
from faying.materials import ContactPair
from faying.typing import Array

CLOSE = 1.3  # an analytic law stands for the numerical contact where their k_n differ by no more than this factor
SHARES = np.array([10**-2.5, 1e-2, 10**-1.5])  # of the greatest pressure: where laws are compared


@final
@dataclass(frozen=True, kw_only=True)
class Choice:
    """A law and why it was taken.

    Args:
        law: the law.
        reason: one line; empty where the user named the law.
        ratios: k_n of each analytic law over that of the numerical contact, at the middle pressure.
        mates: both faces and their materials in one line; empty where the law takes nothing from a surface.
    """

    law: ContactLaw
    reason: str = ""
    ratios: Mapping[str, float] = field(default_factory=dict)
    mates: str = ""


def pick(
    kind: LawKind | str,
    given: Mapping[str, object],
    surface: RoughSurface | None,
    pair: ContactPair,
    *,
    exact: HalfSpace | None = None,
) -> Choice:
    """Return the law that a user names, or the choice among those of the surface for "auto".

    "auto" takes the half-space contact of the scan where it is valid at a hundredth of the bulk hardness (10 spots
    touch, half of the stiffness is on spots of 4 points or more, and k_n moves by at most 25 % on half the points each
    way); else the analytic law whose k_n comes closest to it, where that lies within 30 %; else the half-space contact
    all the same, with its flags. With D and G alone there is no contact to solve: JK is taken. exact: the half-space
    contact of this surface and pair, where there is one already, so that it is not solved again.

    Raises:
        InputError: as `build`, and for "auto" without a surface.
    """
    kind = find(kind) if isinstance(kind, str) else kind
    if kind.label != AUTO:
        return Choice(law=build(kind, given, surface, pair))
    if surface is None:
        raise InputError('model = "auto" takes its inputs from a surface; give [surface] with a scan, or name a law')
    if surface.scan is None:
        law = build("JK", given, surface, pair)
        return Choice(law=law, reason="JK, since there is no areal scan to solve; a scan would give a better answer")
    return _choose(surface, pair, exact)


def _choose(surface: RoughSurface, pair: ContactPair, exact: HalfSpace | None) -> Choice:
    plastic = np.isfinite(pair.hardness)
    law = build("half-space", {}, surface, pair) if exact is None else exact
    assert isinstance(law, HalfSpace)
    full = pair.bulk_hardness if plastic else law.greatest_pressure / 0.3
    pressure = np.clip(SHARES * full, law.least_pressure, law.greatest_pressure)
    solved = law.at_pressure(pressure)
    assert solved.k_n is not None
    ratios = closed_ratios(surface, pair, pressure, solved.k_n) if plastic else {}
    middle = {name: float(row[1]) for name, row in ratios.items()}
    nearest = min(ratios, key=lambda name: float(np.abs(np.log(ratios[name])).max()), default=None)
    said = (
        ""
        if nearest is None
        else f"; for comparison, the closest analytic law ({nearest}) gives {middle[nearest]:.2f} times this stiffness"
    )
    at = f"at {pressure[1] / 1e6:.3g} MPa"
    faults = [reason for reason, mask in solved.reasons.items() if mask[1]]
    if not faults:
        moved = float(np.interp(log(pressure[1]), np.log(law.series.pressure), np.abs(law.series.change[0])))
        reason = (
            f"half-space, which resolves the contact {at} (k_n moves by {exp(moved) - 1:.0%} on half the points){said}"
        )
        return Choice(law=law, reason=reason, ratios=middle)
    if nearest is not None and np.abs(np.log(ratios[nearest])).max() <= log(CLOSE):
        reason = (
            f"{nearest}, with {middle[nearest]:.2f} times the k_n of the half-space, which does not resolve the contact"
        )
        return Choice(law=build(nearest, {}, surface, pair), reason=f"{reason} {at}: {faults[0]}", ratios=middle)
    reason = f"half-space, though {faults[0]} {at}: no analytic law is within {CLOSE - 1:.0%} of it{said}"
    return Choice(law=law, reason=reason, ratios=middle)


def closed_ratios(surface: RoughSurface, pair: ContactPair, pressure: Array, k_n: Array) -> dict[str, Array]:
    """k_n of the laws of summits that yield over a given k_n [Pa/m] at pressures [Pa] (n,), by label.

    Laws without an answer there are left out.
    """
    out = {}
    for kind in kinds().values():
        if kind.law.name != "GW" or not kind.fixed:
            continue
        try:
            found = build(kind, {}, surface, pair).at_pressure(pressure).k_n
        except FayingError:
            continue
        if found is not None and np.all(found > 0):
            out[kind.label] = found / k_n
    return out
