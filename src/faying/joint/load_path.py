"""The load path of each bolt: the joints that it clamps from seat to seat, and which of their points are its own.

A bolt passes a joint where points of it lie within reach of its axis and between its own seats, and face along it. The
points of a joint are shared among the bolts that pass it: each belongs to the nearest axis of those. A joint that no
bolt passes has none. Compliance, load cases, bolt sheets and the check of a study all ask here.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from faying.bolt.bolt import BoltPlace
from faying.bolt.solid_bolt import FittedSolidBolt, SolidPlace
from faying.fe.line import Line
from faying.fe.sides import NamedFaces, nodes_of
from faying.fe.solids import bodies_of
from faying.joint.bolted import BoltedStructure
from faying.typing import Array, Index, Mask

Placed = BoltPlace | FittedSolidBolt | SolidPlace

REACH = 1.5  # outer diameters of the seat: the widest cone of VDI 2230 is about as wide under usual clamped lengths
LEVEL = 1e-3  # of the length from seat to seat: a joint nearer to a seat lies in its plane, beside the bolt
FACING = 0.5  # cosine between axis and normal: a steeper joint slides under the bolt's force, and is not clamped by it


@dataclass(frozen=True, kw_only=True)
class BoltLine:
    """The line of a bolt from seat to seat.

    Args:
        seats: Centres (2, 3) [m] of the seats of head and nut.
        reach: Distance [m] from the axis within which a joint is the bolt's.
    """

    seats: Array
    reach: float

    @classmethod
    def of(cls, mesh: NamedFaces, placed: Placed) -> "BoltLine":
        """Return the line of a bolt in its place; a seat that is not a ring counts as wide as its face."""
        if isinstance(placed, BoltPlace):
            return cls(seats=placed.seats, reach=REACH * placed.pressed[0].outer)
        line = cls(seats=placed.seats, reach=0.0)
        nodes = nodes_of(mesh.face(placed.bolt.faces[0]))
        return cls(seats=placed.seats, reach=2 * REACH * float(line.distance(mesh.points[nodes]).max()))

    @property
    def length(self) -> float:
        """From seat to seat [m]."""
        return float(np.linalg.norm(self.seats[1] - self.seats[0]))

    @property
    def axis(self) -> Array:
        """Unit vector (3,) from head to nut."""
        return np.asarray((self.seats[1] - self.seats[0]) / self.length)

    def depth(self, positions: Array) -> Array:
        """Depth [m] of places (q, 3) below the head."""
        return np.asarray((positions - self.seats[0]) @ self.axis)

    def distance(self, positions: Array) -> Array:
        """Distance [m] of places (q, 3) from the axis."""
        return Line(point=self.seats[0], axis=self.axis).about(positions)[0]

    def passes(self, positions: Array, normals: Array) -> Mask:
        """Which places (q, 3) [m] of a joint with these normals (q, 3) the bolt passes."""
        depth, room = self.depth(positions), LEVEL * self.length
        between = (depth > room) & (depth < self.length - room)
        return np.asarray(between & (self.distance(positions) <= self.reach) & (np.abs(normals @ self.axis) > FACING))


@dataclass(frozen=True, kw_only=True)
class Cut:
    """What a bolt presses together at one depth: all joints that it passes between what is above and what is below.

    Args:
        joints: Indices of the joints; several where they lie side by side, as on both sides of a T-slot.
        parts: Names of a part above and one below.
        depth: Mean depth [m] below the head of the points that the bolt passes.
        area: Of the points that are the bolt's own [m2].
    """

    joints: tuple[int, ...]
    parts: tuple[str, str]
    depth: float
    area: float


@dataclass(frozen=True, kw_only=True)
class LoadPaths:
    """The load paths of all bolts of a structure.

    Args:
        lines: Of each bolt.
        owner: Of each joint (q,): index of the bolt that a point belongs to; -1 where no bolt passes the joint.
        cuts: Of each bolt, from the head on.
    """

    lines: tuple[BoltLine, ...]
    owner: tuple[Index, ...]
    cuts: tuple[tuple[Cut, ...], ...]

    @classmethod
    def of(cls, structure: BoltedStructure) -> "LoadPaths":
        """Return the load paths of a structure."""
        bolts, joints, mesh = structure.fitted_bolts, structure.joints, structure.mesh
        lines = tuple(BoltLine.of(mesh, fitted) for fitted in bolts)
        passed = [
            [
                np.zeros(len(joint.interface.weights), dtype=bool)
                if fitted.bolt.part in [mesh.face_part[face] for face in joint.faces]
                else line.passes(joint.interface.positions, joint.interface.normals)
                for joint in joints
            ]
            for fitted, line in zip(bolts, lines, strict=True)
        ]
        owner = tuple(
            _nearest(lines, [bool(row[j].any()) for row in passed], joint.interface.positions)
            for j, joint in enumerate(joints)
        )
        fasteners = {fitted.bolt.part for fitted in bolts}
        bonded = [pair for pair in mesh.bonded if not fasteners.intersection(pair)]
        body = {part: k for k, parts in enumerate(bodies_of(tuple(mesh.parts), bonded)) for part in parts}
        cuts = []
        for k, (line, row) in enumerate(zip(lines, passed, strict=True)):
            here = [_passed(structure, j, line, some, owner[j] == k) for j, some in enumerate(row) if some.any()]
            cuts.append(_cuts(here, body))
        return cls(lines=lines, owner=owner, cuts=tuple(cuts))

    @property
    def interfaces(self) -> tuple[tuple[tuple[int, ...], tuple[int, ...]], ...]:
        """Joints that cuts have in common, and the bolts that hold them: what a load has to cross together."""
        groups: list[tuple[set[int], set[int]]] = []
        for k, cuts in enumerate(self.cuts):
            for cut in cuts:
                joints, bolts, apart = set(cut.joints), {k}, []
                for group in sorted(groups, key=lambda one: -len(one[0].intersection(cut.joints))):
                    # a load crosses two cuts of one bolt one after the other, even where they share a joint
                    if group[0].intersection(cut.joints) and not group[1] & bolts:
                        joints, bolts = joints | group[0], bolts | group[1]
                    else:
                        apart.append(group)
                groups = [*apart, (joints, bolts)]
        return tuple((tuple(sorted(joints)), tuple(sorted(bolts))) for joints, bolts in groups)


@dataclass(frozen=True, kw_only=True)
class _Passed:
    """A joint that a bolt passes: its index, the parts above and below, depth [m], weight and own area [m2] there."""

    joint: int
    parts: tuple[str, str]
    depth: float
    weight: float
    area: float


def _passed(structure: BoltedStructure, number: int, line: BoltLine, some: Mask, own: Mask) -> _Passed:
    joint = structure.joints[number]
    interface = joint.interface
    weights = interface.weights[some]
    first, second = (structure.mesh.face_part[face] for face in joint.faces)
    # normals look from the first face to the second
    down = float(weights @ (interface.normals[some] @ line.axis)) > 0
    return _Passed(
        joint=number,
        parts=(first, second) if down else (second, first),
        depth=float(weights @ line.depth(interface.positions[some]) / weights.sum()),
        weight=float(weights.sum()),
        area=float(interface.weights[own].sum()),
    )


def _nearest(lines: Sequence[BoltLine], passes: Sequence[bool], positions: Array) -> Index:
    """Index (q,) of the nearest bolt among those that pass, of places (q, 3); -1 where none does."""
    some = [k for k, passing in enumerate(passes) if passing]
    if not some:
        return np.full(len(positions), -1)
    return np.asarray(np.array(some)[np.argmin([lines[k].distance(positions) for k in some], axis=0)])


def _cuts(passed: Sequence[_Passed], body: Mapping[str, int]) -> tuple[Cut, ...]:
    """The cuts of a bolt: between bodies of one level and those below, a level being the longest way from the top."""
    level = {body[part]: 0 for one in passed for part in one.parts}
    for _ in level:  # as many rounds as a way has steps at most
        for one in passed:
            above, below = (body[part] for part in one.parts)
            if above != below:
                level[below] = min(max(level[below], level[above] + 1), len(level))
    out = []
    for step in range(max(level.values(), default=0)):
        here = [one for one in passed if level[body[one.parts[0]]] <= step < level[body[one.parts[1]]]]
        if not here:
            continue
        weight = sum(one.weight for one in here)
        out.append(
            Cut(
                joints=tuple(one.joint for one in here),
                parts=here[0].parts,
                depth=sum(one.depth * one.weight for one in here) / weight,
                area=sum(one.area for one in here),
            )
        )
    return tuple(out)
