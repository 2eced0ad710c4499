"""How far a part may lie from where it is drawn: within the holes of the bolts that hold it."""

from dataclasses import dataclass

from faying.bolt.bolt import AXIS_OFFSET, CLEARANCE, Bolt
from faying.bolt.solid_bolt import SolidBolt
from faying.fe.holes import Hole, holes
from faying.fe.mesh import Mesh
from faying.fe.solids import bodies_of
from faying.joint.load_path import BoltLine, LoadPaths
from faying.joint.structure import Structure


@dataclass(frozen=True, kw_only=True)
class Clearance:
    """Two bodies whose joints lie against each other.

    Args:
        joints: Indices of these joints, with 1 where the second face is on the body that moves and -1 where the first.
        reach: Greatest distance [m] of that body from its place in the plane of the joints.
    """

    joints: tuple[tuple[int, int], ...]
    reach: float


def clearances(structure: Structure) -> tuple[Clearance, ...]:
    """The bodies that bolts let move, each pair once.

    The bolt with the least play decides. Dowels leave none; nor do bolts whose size is not known.
    """
    mesh, paths = structure.mesh, LoadPaths.of(structure)
    fasteners = {bolt.part for bolt in structure.bolts}
    bodies = bodies_of(tuple(mesh.parts), [pair for pair in mesh.bonded if not fasteners.intersection(pair)])
    body = {part: number for number, parts in enumerate(bodies) for part in parts}
    pinned = [{body[mesh.face_part[wall]] for wall in dowel.walls} for dowel in structure.dowels]
    pairs: dict[frozenset[int], dict[int, int]] = {}
    for number, joint in enumerate(structure.joints):
        parts = [mesh.face_part[face] for face in joint.faces]
        first, second = (body[part] for part in parts)
        pair = frozenset((first, second))
        if len(pair) == 2 and not fasteners.intersection(parts) and not any(pair <= pins for pins in pinned):
            pairs.setdefault(pair, {})[number] = 1 if second == max(pair) else -1
    out = []
    for joints in pairs.values():
        found = [
            _play(mesh, structure.bolts[bolt], paths.lines[bolt], structure.joints[number].faces)
            for number in joints
            for bolt in sorted(set(paths.owner[number].tolist()) - {-1})
        ]
        reach = min((play for play in found if play is not None), default=0.0)
        if reach > 0:
            out.append(Clearance(joints=tuple(joints.items()), reach=reach))
    return tuple(out)


def _play(mesh: Mesh, bolt: Bolt | SolidBolt, line: BoltLine, faces: tuple[str, str]) -> float | None:
    """How far [m] a bolt lets the second face move against the first; None where its size is not known.

    A hole of diameter D lets its part move by (D - d)/2 against the bolt of diameter d. A hole that is not drawn is the
    medium one of ISO 273, a tapped hole has no play.
    """
    drawn = [
        next((2 * hole.radius for hole in holes(mesh.points, mesh.face(face)) if _on(line, hole)), None)
        for face in faces
    ]
    thread = bolt.metric if isinstance(bolt, Bolt) else None if bolt.fastener is None else bolt.fastener.thread
    known = [one for one in drawn if one is not None]
    size = thread.diameter if thread is not None else bolt.diameter or (min(known) / CLEARANCE if known else None)
    return None if size is None else sum(max((one or CLEARANCE * size) - size, 0.0) for one in drawn) / 2


def _on(line: BoltLine, hole: Hole) -> bool:
    return float(line.distance(hole.centre[None])[0]) <= AXIS_OFFSET * hole.radius
