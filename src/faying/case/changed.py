"""Frequencies of a case with a few things changed, in one small basis, at no full solution."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying.case.case import Case
from faying.case.solve import LoadedCase
from faying.errors import NotConverged
from faying.joint.joint_law import JointLaw
from faying.numerics.follow import follow
from faying.reduction.reduce import Gapped, Reduction
from faying.reduction.reduced import Variant
from faying.typing import Array, Index

# of a frequency at the loads trained on, where what is changed moves one by a thousandth and more; and between them
TOLERANCE, BETWEEN = 1e-4, 1e-3


@dataclass(frozen=True, kw_only=True)
class ChangedCase:
    """A case with other laws and gaps [m] (q,) of all joints.

    factor: on the force of each bolt (b,), or of all; trained: whether the basis is made for it, or for others near it.
    """

    laws: Sequence[JointLaw]
    gaps: Sequence[Array]
    factor: float | Array = 1.0
    trained: bool = True

    @classmethod
    def nothing(cls, case: Case) -> "ChangedCase":
        """The case as it is."""
        joints = case.structure.joints
        return cls(laws=[joint.law for joint in joints], gaps=[joint.interface.gap for joint in joints])


def can_change(case: Case) -> bool:
    """Whether it has joints that small bases hold: no bolts tightened in order, viscous dampers, springs per node."""
    ordered, viscous, joints = case.study.in_order, case.study.modes.damping == "viscous", case.structure.joints
    return bool(joints) and not (ordered or viscous or any(joint.per_node for joint in joints))


def frequencies_of(
    case: Case, states: Sequence[LoadedCase], changes: Sequence[ChangedCase], after: Sequence[int | None]
) -> list[Array | NotConverged]:
    """Frequencies [Hz] (loads, m) of each change, or why it has none.

    The basis is made for the least and the greatest load of all of them. Frequencies are in the order of the modes of
    the states, each that of the mode whose shape it has, by way of the change whose place `after` has: two small steps
    mix modes less than a large one. Where joints have carried more before, a change makes of them what it makes of
    first loading, relative.
    """
    if not changes:
        return []
    at = sorted({int(end([state.load for state in states])) for end in (np.argmin, np.argmax)})
    last, structure = states[-1], case.structure
    reduction = Reduction.about(
        structure,
        factor=last.modes.factorisation,
        reference=(last.modes.factorised + last.modes.shift * structure.dynamic_matrices[1]).tocsr(),
        state=last.preload.displacement,
        shapes=np.concatenate([states[k].modes.shapes[:, case.rigid_count :] for k in at], axis=1),
        count=case.study.modes.count,
    )
    friction = [joint.friction for joint in structure.joints]
    forces = [np.array(one.forces) for one in case.study.preloads]

    def loads_of(one: ChangedCase) -> list[Gapped]:
        return [Gapped(laws=one.laws, forces=one.factor * force, friction=friction, gaps=one.gaps) for force in forces]

    variants = [loads_of(one) for one in changes]
    groups = [[loads[k] for k in at] for one, loads in zip(changes, variants, strict=True) if one.trained]
    trained = iter(reduction.train_each(groups, TOLERANCE))
    starts: list[Array | NotConverged] = []
    for one, by_way in zip(changes, after, strict=True):
        group = next(trained) if one.trained else starts[by_way or 0]
        starts.append(group[0].displacement if isinstance(group, list) else group)
    solved = next((start for start in starts if not isinstance(start, NotConverged)), None)
    if solved is None:
        return [one for one in starts if isinstance(one, NotConverged)]
    before = _at_loads(reduction, loads_of(ChangedCase.nothing(case)), solved)
    way = [np.arange(len(one.frequencies)) for one in before]  # of each mode of the states in those of `before`
    remembered = np.array([bool(state.preload.carried) for state in states])[:, None]
    as_first = np.stack([one.frequencies for one in before])
    stiffer = np.where(remembered, np.stack([state.damped.frequencies for state in states]) / as_first, 1.0)
    out: list[Array | NotConverged] = []
    known: dict[int | None, tuple[list[Variant], list[Index]]] = {None: (before, way)}
    for number, (loads, start, by_way) in enumerate(zip(variants, starts, after, strict=True)):
        try:
            if isinstance(start, NotConverged):
                raise start
            found = _at_loads(reduction, loads, start)
        except NotConverged as fault:
            out.append(fault)
            continue
        mass, (before, way) = reduction.model.dynamic_mass, known.get(by_way, known[None])
        order = [
            follow(old.shapes, new.shapes, mass, old.frequencies)[first]
            for old, new, first in zip(before, found, way, strict=True)
        ]
        out.append(stiffer * np.stack([one.frequencies[k] for one, k in zip(found, order, strict=True)]))
        known[number] = found, order
    return out


def _at_loads(reduction: Reduction, loads: Sequence[Gapped], start: Array) -> list[Variant]:
    return [reduction.at(one).evaluate(one.laws, one.forces, one.friction, start) for one in loads]
