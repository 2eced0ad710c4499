"""Frequencies at both ends of what is not known of a joint and changes no pressure."""

from dataclasses import replace
from typing import Literal

from faying.case.case import Case
from faying.case.engine import Engine
from faying.joint.equilibrium import PreloadState
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
        halves = ([one.half(which) for one in springs] for which in (0, 1))
        first, second = (engine.frequencies(half, modes, one_way=False) for half in halves)
        out["contact"] = first, second
    return out
