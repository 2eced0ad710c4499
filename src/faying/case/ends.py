"""Frequencies at both ends of what is not known of a joint and changes no pressure."""

from dataclasses import replace
from typing import Literal

import numpy as np

from faying.case.case import Case
from faying.case.engine import Engine
from faying.case.scatter import LEVELS, default, stated
from faying.distribution import Distribution
from faying.fe.interface import Interface
from faying.joint.equilibrium import PreloadState
from faying.joint.joint import FittedJoint
from faying.joint.springs import Springs
from faying.numerics.modes import Modes
from faying.typing import Array

Pair = tuple[Array, Array]  # frequencies [Hz] at both ends of one number


def ends_of(case: Case, preload: PreloadState, engine: Engine, modes: Modes) -> dict[str, Pair]:
    """Frequencies of one load at 5 and at 95 % of the range of the law that the scan makes.

    modes: at this load, whose order the frequencies have. "contact": with each half of the points of the joints, for
    the error of the mesh.
    """
    joints, out = case.structure.joints, {}

    def at(end: Literal["low", "high"]) -> Array:
        laws = [replace(joint.law, end=end) if joint.law.has_range else joint.law for joint in joints]
        springs = case.structure.with_joints(laws=laws).springs(preload.pressures)
        return engine.frequencies(springs, modes, one_way=True)

    if any(joint.law.has_range for joint in joints):
        out["scan"] = at("low"), at("high")
    if case.study.modes.intervals and not any(joint.per_node for joint in joints):
        springs = case.structure.springs(preload.pressures)
        halves = ([half_of(one, which) for one in springs] for which in (0, 1))
        first, second = (engine.frequencies(half, modes, one_way=False) for half in halves)
        out["contact"] = first, second
    return out


def half_of(springs: Springs[Interface], which: int) -> Springs[Interface]:
    """Every second point of a joint, from the first or from the second one, with twice its stiffness."""
    twice = 2.0 * (np.arange(len(springs.k_n)) % 2 == which)
    return replace(springs, k_n=twice * springs.k_n, k_t=twice * springs.k_t)


def quantiles(case: Case, own: str, common: str, table: Distribution | None) -> tuple[float, float, float] | None:
    """5, 50 and 95 % of a number: as the study says of it or of all such numbers, else from a table; None without."""
    known = stated(case.study.uncertain)
    found = known.get(own) or known.get(common) or (table if case.study.assumes_scatter else None)
    if found is None:
        return None
    low, middle, high = found.quantile(LEVELS)
    return float(low), float(middle), float(high)


def ratios_of(case: Case, joint: FittedJoint) -> tuple[float, float, float]:
    """5, 50 and 95 % of k_t/k_n of a joint; three times the same where it does not scatter."""
    known, given = stated(case.study.uncertain), joint.law.tangential
    own, common = f"joint.{joint.name}.tangential", "joint.tangential"
    if isinstance(given, int | float) and own not in known and common not in known:
        return float(given), float(given), float(given)
    return quantiles(case, own, common, default("k_t/k_n")) or (1.0, 1.0, 1.0)
