"""Frequencies of a case with a few things changed, in one small basis, at no full solution."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np

from faying.case.case import Case
from faying.case.solve import LoadedCase
from faying.joint.joint_law import JointLaw
from faying.numerics.follow import follow
from faying.reduction.reduce import Gapped, Reduction
from faying.reduction.reduced import Variant
from faying.typing import Array

TOLERANCE = 2e-4  # of a frequency, where what is changed moves one by a thousandth and more


@dataclass(frozen=True, kw_only=True)
class ChangedCase:
    """A case with other laws, gaps [m] (q,) and forces on all joints and bolts; factor: on the force of each bolt."""

    laws: Sequence[JointLaw]
    gaps: Sequence[Array]
    factor: float = 1.0

    @classmethod
    def nothing(cls, case: Case) -> "ChangedCase":
        """The case as it is."""
        joints = case.structure.joints
        return cls(laws=[joint.law for joint in joints], gaps=[joint.interface.gap for joint in joints])


def can_change(case: Case) -> bool:
    """Whether it has joints that small bases hold: no bolts tightened in order, viscous dampers, springs per node."""
    ordered, viscous, joints = case.study.in_order, case.study.modes.damping == "viscous", case.structure.joints
    return bool(joints) and not (ordered or viscous or any(joint.per_node for joint in joints))


def frequencies_of(case: Case, states: Sequence[LoadedCase], changes: Sequence[ChangedCase]) -> list[Array]:
    """Frequencies [Hz] (loads, m) of each change; the basis is made for the first and the last load of all of them.

    They are in the order of the modes of the states, each that of the mode whose shape it has.

    Raises NotConverged where a change has no equilibrium.
    """
    if not changes:
        return []
    ends = sorted({0, len(states) - 1})
    last, structure = states[-1], case.structure
    reduction = Reduction.about(
        structure,
        factor=last.modes.factorisation,
        reference=(last.modes.factorised + last.modes.shift * structure.dynamic_matrices[1]).tocsr(),
        state=last.preload.displacement,
        shapes=np.concatenate([states[k].modes.shapes[:, case.rigid_count :] for k in ends], axis=1),
        count=case.study.modes.count,
    )
    friction = [joint.friction for joint in structure.joints]
    forces = [np.array(one.forces) for one in case.study.preloads]
    every = [
        [Gapped(laws=one.laws, forces=one.factor * force, friction=friction, gaps=one.gaps) for force in forces]
        for one in changes
    ]
    states_at_ends = reduction.train_together([loads[k] for loads in every for k in ends], TOLERANCE)
    starts = [state.displacement for state in states_at_ends]
    plain = ChangedCase.nothing(case)
    at_rest = cache(
        lambda k: reduction.evaluate_at(
            Gapped(laws=plain.laws, forces=forces[k], friction=friction, gaps=plain.gaps), starts[0]
        )
    )

    def followed(one: Variant, k: int) -> Array:
        """Frequencies in the order of the modes at a load."""
        at = at_rest(k)
        return np.asarray(one.frequencies[follow(at.shapes, one.shapes, reduction.model.dynamic_mass, at.frequencies)])

    return [
        np.stack([followed(reduction.evaluate_at(one, starts[len(ends) * number]), k) for k, one in enumerate(loads)])
        for number, loads in enumerate(every)
    ]
