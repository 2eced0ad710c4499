"""Bolts tightened one after another: each later bolt changes the force in those that are tight already."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from faying.errors import InputError
from faying.joint.bolted import BoltedStructure
from faying.joint.equilibrium import Equilibrium, PreloadState
from faying.joint.preload_case import NO_SHANK
from faying.typing import Array

BALANCED = 1e-9  # of the load: what is out of balance then moves pressures by some 1e-10 of the greatest
SNUG = 0.01  # of its force, in a solid bolt that is yet to be tightened: without any, it would fall out


def tighten(
    structure: BoltedStructure,
    assembly: Equilibrium,
    forces: Sequence[float],
    *,
    order: Sequence[int] | None = None,
) -> PreloadState:
    """Find the preload of a structure whose bolts are brought to `forces` [N], one for each bolt.

    order: indices of the bolts, in the order of tightening, any of them more than once; None pulls all at once, so that
    each ends at its force. In an order, the bolt at hand is pulled to its force while those tightened before it are
    springs of their shank's stiffness; bolts yet to come carry nothing, solid ones a hundredth of their force. The
    forces left at the end are in `bolt_forces`. Raises InputError where an order misses a bolt or a bolt in it has no
    shank.
    """
    force = np.asarray(forces, dtype=float)
    loads = structure.loads
    if order is None:
        at_once = assembly.solve(loads @ force, tolerance=BALANCED)
        return replace(at_once, bolt_forces=tuple(float(f) for f in force))
    bolts = structure.fitted_bolts
    missing = sorted(set(range(len(bolts))) - set(order))
    if missing or any(not 0 <= i < len(bolts) for i in order):
        raise InputError(
            f"the order of tightening must name every bolt; it misses {[bolts[i].bolt.name for i in missing]}"
        )
    soft = [bolt.bolt.name for bolt in bolts if bolt.stiffness is None]
    if soft:
        raise InputError(NO_SHANK.format(", ".join(soft)))
    tight: dict[int, tuple[float, Array]] = {}  # force and displacement when the bolt was let go
    found: PreloadState | None = None
    for turn in order:
        shanks, load = None, force[turn] * loads[:, turn]
        for index, bolt in enumerate(bolts):
            if bolt.released is not None and index not in tight and index != turn:
                load = load + SNUG * force[index] * loads[:, index]
        for index, (kept, moved) in tight.items():
            shank = bolts[index].stiffness
            if index != turn and shank is not None:
                shanks = shank if shanks is None else shanks + shank
                load = load + kept * loads[:, index] + shank @ moved
        found = assembly.solve(load, shanks=shanks, tolerance=BALANCED)
        tight[turn] = (float(force[turn]), found.displacement)
    assert found is not None
    final = found.displacement
    left = tuple(tight[i][0] + bolts[i].tension(final - tight[i][1]) for i in range(len(bolts)))
    return replace(found, bolt_forces=left)
