"""What a bolt clamps: the compliance of the members in a preloaded structure, and how its force spreads over joints.

K is the tangent stiffness of the structure with all bolts tight, f the forces of 1 N in one bolt and k what its shank
gives along them. Taking away k f f' leaves the members, whose compliance under f follows from C = f' K^-1 f alone:
1/(1/C - k) (Sherman and Morrison 1950, doi:10.1214/aoms/1177729893). The other bolts stay in place as springs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.bolt.bolt import BoltPlace, FittedBolt
from faying.bolt.solid_bolt import FittedSolidBolt
from faying.bolt.vdi2230 import cone_compliance
from faying.errors import NotConverged
from faying.fe.faces import NamedFaces, face_centre
from faying.fe.interface import Interface
from faying.fe.sides import nodes_of
from faying.joint.bolted import BoltedStructure
from faying.joint.springs import Springs
from faying.numerics.modes import Modes
from faying.numerics.product import product
from faying.numerics.solve import conjugate_gradients
from faying.typing import Array

ACCURACY = 1e-4  # of the residual of a solution: a compliance is right to its square, what lies in a joint to it
MESHED = 1e-6  # the same where a bolt is meshed, whose numbers are all of first order
MAX_STEPS = 2000
ROUND = 0.03  # of the area of a ring between its least and greatest radius: a face that differs by more is none
SEAT_REACH = 1.5  # outer diameters of the seat within which a joint belongs to a bolt


@dataclass(frozen=True, kw_only=True)
class Clamping:
    """Compliances of the bolts of a structure at one preload, in the terms of VDI 2230.

    Args:
        bolt: delta_S, of shank and washers [m/N] (b,); NaN for a bolt that is a force alone. That of a meshed bolt is
            what its members leave of the whole, and holds the contact under its head.
        members: delta_P, by how much the seats approach each other for 1 N of clamp force [m/N] (b,).
        traction: per joint, pressure [Pa] at its points for 1 N of clamp force in each bolt (b, q) [Pa/N].
        motions: displacements (unknowns, b) [m/N] for 1 N of pull in each bolt, all of them tight.
    """

    bolt: Array
    members: Array
    traction: tuple[Array, ...]
    motions: Array

    @property
    def load_factor(self) -> Array:
        """Phi = delta_P/(delta_S + delta_P) [-] (b,), for a working load at the seats; NaN without a shank."""
        return self.members / (self.bolt + self.members)


def clamping(
    structure: BoltedStructure,
    stiffness: Any,
    modes: Modes,
    springs: Sequence[Springs[Interface]],
    *,
    like: Array | None = None,
) -> Clamping:
    """Find what the bolts of a preloaded structure clamp.

    Args:
        structure: the structure.
        stiffness: its tangent stiffness [N/m] with all bolts tight and the springs of its joints.
        modes: its modes, for their factorisation.
        springs: of each joint, at this preload.
        like: `motions` (unknowns, k) at other preloads, to start from.

    Raises:
        NotConverged: the members have no stiffness against a bolt's force.
    """
    bolts = structure.fitted_bolts
    own, members = np.full(len(bolts), np.nan), np.full(len(bolts), np.nan)
    traction = [np.zeros((len(bolts), len(s.k_n))) for s in springs]
    loads = np.stack([fitted.load for fitted in bolts], axis=1)
    loads[structure.fixed] = 0.0
    motions = _solved(stiffness, loads, structure, modes, [fitted.bolt.name for fitted in bolts], like)
    # f'x + r'x with the residual r is wrong by the energy of the error alone, of second order
    rest = loads - product(stiffness, motions)
    for index, fitted in enumerate(bolts):
        motion = motions[:, index]
        loaded = float((loads[:, index] + rest[:, index]) @ motion)
        left = 1 - fitted.rigidity * loaded
        motion = motion / left  # of the members under 1 N, without what this bolt itself gives
        for spread, s in zip(traction, springs, strict=True):
            opening = np.asarray(s.interface.relative @ motion).reshape(-1, 3)[:, 0]
            spread[index] = -s.k_n * opening
        if isinstance(fitted, FittedBolt):
            members[index] = loaded / left
            own[index] = 1 / fitted.rigidity if fitted.rigidity else np.nan
        else:
            members[index] = _work(structure, springs, fitted, motion)
            own[index] = 1 / (fitted.rigidity * left) - members[index]
    return Clamping(bolt=own, members=members, traction=tuple(traction), motions=motions)


def _solved(
    stiffness: Any, loads: Array, structure: BoltedStructure, modes: Modes, names: Sequence[str], like: Array | None
) -> Array:
    """K^-1 f for loads (n, b) that balance, by conjugate gradients with the shifted factorisation of the modes."""
    rigid = np.linalg.qr(structure.rigid)[0] if structure.rigid.size else np.zeros((len(loads), 0))
    balanced = loads - rigid @ (rigid.T @ loads)
    try:
        return conjugate_gradients(
            lambda x: product(stiffness, x),
            modes.factorisation,
            balanced,
            accuracy=MESHED if any(isinstance(f, FittedSolidBolt) for f in structure.fitted_bolts) else ACCURACY,
            limit=MAX_STEPS,
            like=like,
        )
    except NotConverged:
        if len(names) == 1:
            text = f"bolt {names[0]!r}: the parts that it clamps have no stiffness against its force"
            raise NotConverged(text) from None
    alone = [_solved(stiffness, loads[:, k : k + 1], structure, modes, [name], like) for k, name in enumerate(names)]
    return np.concatenate(alone, axis=1)


def _work(
    structure: BoltedStructure, springs: Sequence[Springs[Interface]], fitted: FittedSolidBolt, motion: Array
) -> float:
    """Work [m/N] that the contacts of a meshed bolt do on what it clamps, for 1 N of tension."""
    total = 0.0
    for joint, s in zip(structure.joints, springs, strict=True):
        parts = [structure.mesh.face_part[face] for face in joint.faces]
        if fitted.bolt.part not in parts:
            continue
        i = s.interface
        relative = np.asarray(i.relative @ motion).reshape(-1, 3)
        first = parts[1] == fitted.bolt.part  # the other face is the first one
        nodes, values = (i.first_nodes, i.first_values) if first else (i.second_nodes, i.second_values)
        moved = np.einsum("qa,qai->qi", values, motion.reshape(-1, 3)[nodes])
        local = np.einsum("qij,qj->qi", i.frames, moved)
        force = i.weights[:, None] * np.stack([s.k_n, s.k_t, s.k_t], axis=1) * relative
        total += float(np.sum(force * local)) * (1 if first else -1)
    return total


@dataclass(frozen=True, kw_only=True)
class ClampedStack:
    """What lies between the seats of a bolt that is a beam, along its axis.

    Args:
        sections: (length [m], Young's modulus [Pa]) of the parts, from the head on.
        joints: indices of the joints that the bolt clamps, from the head on.
        outer: diameter [m] of a ring of the area of the joint that belongs to this bolt, the mean of its joints.
        seat: inner and outer diameter [m] of the seat; None where head and nut press a face that is not a ring.
    """

    sections: tuple[tuple[float, float], ...]
    joints: tuple[int, ...]
    outer: float
    seat: tuple[float, float] | None

    @property
    def cone(self) -> float:
        """Compliance of the members [m/N] by the deformation cone of VDI 2230; NaN where the seat is not a ring."""
        if self.seat is None or self.outer <= self.seat[0]:
            return float("nan")
        return cone_compliance(self.sections, seat=self.seat[1], hole=self.seat[0], outer=self.outer)


def stack_of(structure: BoltedStructure, index: int) -> ClampedStack | None:
    """Return the stack of a bolt; None for a meshed bolt, and where the joints along its axis make no chain of parts.

    The area of a joint belongs to the bolt whose axis is nearest.
    """
    bolts = structure.fitted_bolts
    fitted = bolts[index]
    if not isinstance(fitted, FittedBolt):
        return None
    mesh = structure.mesh
    beams = [bolt for bolt in bolts if isinstance(bolt, FittedBolt)]
    seat = seat_ring(mesh, fitted)
    found: list[tuple[float, int, float]] = []
    for number, joint in enumerate(structure.joints):
        i = joint.interface
        distance = np.stack([_beside(bolt, i.positions) for bolt in beams])
        mine = np.argmin(distance, axis=0) == beams.index(fitted)
        reach = np.inf if seat is None else SEAT_REACH * seat[1]
        depth = (i.positions - fitted.point) @ fitted.axis
        near = mine & (distance[beams.index(fitted)] <= reach)
        near &= (depth > 0) & (depth < fitted.length)
        if np.any(near):
            area = float(i.weights[mine].sum())
            found.append((float(i.weights[near] @ depth[near] / i.weights[near].sum()), number, area))
    found.sort()
    part = mesh.face_part[fitted.bolt.faces[0]]
    sections: list[tuple[float, float]] = []
    start = 0.0
    for place, number, _ in found:
        sides = [mesh.face_part[face] for face in structure.joints[number].faces]
        if part not in sides:
            return None
        sections.append((place - start, structure.materials[part].E))
        start, part = place, sides[1 - sides.index(part)]
    if part != mesh.face_part[fitted.bolt.faces[1]]:
        return None
    sections.append((fitted.length - start, structure.materials[part].E))
    hole = 0.0 if seat is None else seat[0]
    outer = [float(np.sqrt(4 * area / np.pi + hole**2)) for *_, area in found]
    if not outer or min(length for length, _ in sections) <= 0:
        return None
    return ClampedStack(
        sections=tuple(sections),
        joints=tuple(number for _, number, _ in found),
        outer=float(np.mean(outer)),
        seat=seat,
    )


def seat_ring(mesh: NamedFaces, fitted: FittedBolt | BoltPlace) -> tuple[float, float] | None:
    """Inner and outer diameter [m] of the seat: as given, or those of the face under the head where it is a ring."""
    if fitted.ring is not None:
        return fitted.ring
    face = fitted.bolt.faces[0]
    radius = _beside(fitted, mesh.points[nodes_of(mesh.face(face))])
    inner, outer = float(radius.min()), float(radius.max())
    inner = inner if inner > 0.05 * outer else 0.0
    area = face_centre(mesh.points, mesh.face(face))[2]
    return (2 * inner, 2 * outer) if abs(np.pi * (outer**2 - inner**2) / area - 1) < ROUND else None


def _beside(fitted: FittedBolt | BoltPlace, positions: Array) -> Array:
    """Distance [m] of places (q, 3) from the axis of a bolt."""
    arm = positions - fitted.point
    return np.asarray(np.linalg.norm(arm - (arm @ fitted.axis)[:, None] * fitted.axis, axis=1))
