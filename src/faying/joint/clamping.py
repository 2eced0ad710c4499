"""What a bolt clamps: the compliance of the members in a preloaded structure, and how its force spreads over joints.

K is the tangent stiffness of the structure with all bolts tight, f the forces of 1 N in one bolt and k what its shank
gives along them. Taking away k f f' leaves the members, whose compliance under f follows from C = f' K^-1 f alone:
1/(1/C - k) (Sherman and Morrison 1950, doi:10.1214/aoms/1177729893). The other bolts stay in place as springs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from faying.bolt.bolt import FittedBolt
from faying.bolt.solid_bolt import FittedSolidBolt
from faying.bolt.vdi2230 import cone_compliance
from faying.errors import NotConverged
from faying.fe.elasticity import strain_energy
from faying.fe.interface import Interface
from faying.joint.bolted import BoltedStructure
from faying.joint.load_path import LEVEL, LoadPaths
from faying.joint.springs import Springs
from faying.numerics.modes import Modes
from faying.numerics.product import product
from faying.numerics.solve import conjugate_gradients
from faying.typing import Array

ACCURACY = 1e-4  # of the residual of a solution: a compliance is right to its square, what lies in a joint to it
MESHED = 1e-6  # the same where a bolt is meshed, whose numbers are all of first order
MAX_STEPS = 2000
NAN = float("nan")
WIDEST = 5.0  # diameters of the seat: what lies farther out bears nothing, but the guideline's angle goes on growing


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
            members[index] = _member_energy(structure, stiffness, springs, fitted.bolt.part, motion)
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


def _member_energy(
    structure: BoltedStructure, stiffness: Any, springs: Sequence[Springs[Interface]], part: str, motion: Array
) -> float:
    """Work [m/N] on what a meshed bolt clamps, for 1 N of tension: twice the energy of all but the bolt and its seats.

    By Clapeyron's theorem this is the work that the seats do on the members, be they in contact, bonded or tied.
    """
    mesh = structure.mesh
    total = float(motion @ product(stiffness, motion))
    total -= strain_energy(mesh, part, structure.materials[part], motion)
    for joint, s in zip(structure.joints, springs, strict=True):
        if part in [mesh.face_part[face] for face in joint.faces]:
            relative = np.asarray(s.interface.relative @ motion).reshape(-1, 3)
            total -= float(s.interface.weights @ (s.k_n * relative[:, 0] ** 2 + s.k_t * (relative[:, 1:] ** 2).sum(1)))
    for faces in mesh.ties:
        if part in [mesh.face_part[face] for face in faces]:
            total -= float(motion @ (structure.tie_of(faces) @ motion))
    return total


def cone_of(structure: BoltedStructure, paths: LoadPaths, index: int) -> float:
    """Return the compliance [m/N] of what a bolt clamps by the deformation cone of VDI 2230.

    The parts are as wide as a ring of the area of the joint that is the bolt's own, the mean of its joints, and five
    seats at most. A screw clamps what lies between its head and where the thread of the tapped part begins. NaN for a
    meshed bolt, where its seat is not a ring, and where its joints make no chain of parts from seat to seat.
    """
    fitted, mesh, cuts = structure.fitted_bolts[index], structure.mesh, paths.cuts[index]
    if not isinstance(fitted, FittedBolt) or not cuts:
        return NAN
    seat = fitted.pressed[0]
    if not seat.is_ring:
        return NAN
    ends = [mesh.face_part[face] for face in fitted.bolt.faces]
    names = [*(cut.parts[0] for cut in cuts), cuts[-1].parts[1]]
    if [names[0], names[-1]] != ends or any(one.parts[1] != two.parts[0] for one, two in pairwise(cuts)):
        return NAN
    depths = np.array([0.0, *(cut.depth for cut in cuts), paths.lines[index].length - fitted.inside])
    tapped, lengths = fitted.thread is not None, np.diff(depths)
    if tapped and abs(lengths[-1]) <= LEVEL * depths[-1]:  # threaded up to the joint
        names, lengths = names[:-1], lengths[:-1]
    sections = [(length, structure.materials[part].E) for length, part in zip(lengths, names, strict=True)]
    outer = float(np.mean([np.sqrt(4 * cut.area / np.pi + seat.inner**2) for cut in cuts]))
    outer = min(outer, WIDEST * seat.outer)
    if outer <= seat.inner or min(lengths) <= 0:
        return NAN
    return cone_compliance(sections, seat=seat.outer, hole=seat.inner, outer=outer, tapped=tapped)
