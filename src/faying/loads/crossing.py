"""What crosses the joints of bolts sideways, by shanks and by friction, and the share of it that each bolt has."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying.bolt.bolt import FittedBolt, frame_about
from faying.bolt.solid_bolt import FittedSolidBolt
from faying.fe.nodal_forces import thermal_forces
from faying.joint.bolted import BoltedStructure
from faying.joint.load_path import BoltLine, LoadPaths, distance_from
from faying.loads.contact import LoadedContact
from faying.loads.statics import LoadedState
from faying.numerics.product import product
from faying.typing import Array

NAN = float("nan")
COAXIAL = 0.1  # of the mean arm of friction: bolts nearer to their middle bear no torque as a pattern


@dataclass(frozen=True, kw_only=True)
class Bent:
    """How a bolt is bent; NaN without a shank.

    Args:
        moment: The greater bending moment [N m] of its ends.
        shear, torsion: Force across it [N] (3,) and torque about it [N m] on the part under its head.
    """

    moment: float
    shear: Array
    torsion: float


def bent(structure: BoltedStructure, index: int, state: LoadedState, motion: Array) -> Bent:
    """How a bolt is bent by a displacement [m] (unknowns,) from the preload."""
    fitted = structure.fitted_bolts[index]
    if isinstance(fitted, FittedBolt):
        ends = fitted.end_forces(motion)
        if ends is None:
            return Bent(moment=NAN, shear=np.full(3, NAN), torsion=NAN)
        moment = float(max(np.linalg.norm(ends[4:6]), np.linalg.norm(ends[10:12])))
        # the ends bear on the shank, so that the shank bears on the part the other way
        return Bent(moment=moment, shear=-ends[1:3] @ frame_about(fitted.axis)[1:], torsion=-float(ends[3]))
    moves = _section_moves(structure, fitted)
    layer = np.repeat(np.any(fitted.pull.reshape(-1, 3) != 0, axis=1), 3)
    # in the plane across the shank: nodes that the bolt shares with another part bear forces of that part, too
    resisted = np.where(layer[:, None], product(structure.matrices[0], moves), 0.0)
    work = resisted.T @ motion - moves.T @ own_heat(structure, fitted, state)
    return Bent(moment=float(np.linalg.norm(work[2:4])), shear=work[:2] @ _across(fitted), torsion=float(work[4]))


def _across(fitted: FittedSolidBolt) -> Array:
    """Two unit vectors (2, 3) across a meshed bolt."""
    axis = fitted.seats[1] - fitted.seats[0]
    return frame_about(axis / np.linalg.norm(axis))[1:]


def _section_moves(structure: BoltedStructure, fitted: FittedSolidBolt) -> Array:
    """Motions (unknowns, 5) of the far half of a meshed bolt: along two axes across it, about them, about its own."""
    first, second = across = _across(fitted)
    far = np.any(fitted.drawn.reshape(-1, 3) != 0, axis=1)[:, None]
    arm = structure.mesh.points - fitted.bolt.place(structure.mesh)
    moves = [np.where(far, one, 0.0) for one in across]
    moves += [np.where(far, np.cross(one, arm), 0.0) for one in (first, second, np.cross(first, second))]
    return np.stack([one.ravel() for one in moves], axis=1)


def own_heat(structure: BoltedStructure, fitted: FittedSolidBolt, state: LoadedState) -> Array:
    """Nodal forces [N] (unknowns,) of the heat of a meshed bolt."""
    part = fitted.bolt.part
    strain = state.acting.strains.get(part, 0.0)
    return thermal_forces(structure.mesh, part, structure.materials[part], strain)


def transverse_loads(
    structure: BoltedStructure,
    contacts: Sequence[LoadedContact],
    state: LoadedState,
    paths: LoadPaths,
    ends: Sequence[Bent],
) -> Array:
    """F_Q [N] of each bolt (b,): its share of what crosses its joints by friction and by shanks; 0 where it holds none.

    Shear V in the middle of n bolts and the torque T about it go to them as to a pattern of bolts between stiff parts:
    V/n, and T r/sum(r^2) across the arm r. Shear that balances itself within a joint is none that has to be carried.
    Where all bolts lie on one axis friction alone bears the torque, over the mean arm of the pressure.
    """
    out = np.zeros(len(ends))
    for joints, bolts in paths.interfaces:
        line = paths.lines[bolts[0]]
        depth = next(cut.depth for cut in paths.cuts[bolts[0]] if set(cut.joints) <= set(joints))
        places = np.stack([_at_depth(paths.lines[k], line, depth) for k in bolts])
        radii = places - places.mean(axis=0)
        shear, torque, arm = _crossing(structure, contacts, state, (joints, line.axis, places.mean(axis=0)))
        for k, radius in zip(bolts, radii, strict=True):
            if np.isfinite(ends[k].torsion):  # a bolt with a shank
                force = np.sign(paths.lines[k].axis @ line.axis) * ends[k].shear
                shear = shear + force
                torque += float(np.cross(radius, force) @ line.axis) + ends[k].torsion
        spread = float((radii**2).sum())
        if spread > len(bolts) * (COAXIAL * arm) ** 2:
            shares = shear / len(bolts) + torque / spread * np.cross(line.axis, radii)
            sizes = np.linalg.norm(shares, axis=1)
        else:
            turned = torque / arm if arm > 0 else 0.0
            sizes = np.full(len(bolts), np.hypot(np.linalg.norm(shear), turned) / len(bolts))
        out[list(bolts)] = np.maximum(out[list(bolts)], sizes)
    return out


def _at_depth(bolt: BoltLine, line: BoltLine, depth: float) -> Array:
    """Where the axis of a bolt meets the plane at a depth [m] across another (3,) [m]."""
    return np.asarray(bolt.seats[0] + (depth - line.depth(bolt.seats[:1])[0]) / (bolt.axis @ line.axis) * bolt.axis)


def _crossing(
    structure: BoltedStructure,
    contacts: Sequence[LoadedContact],
    state: LoadedState,
    where: tuple[Sequence[int], Array, Array],
) -> tuple[Array, float, float]:
    """What friction carries through joints, seen along an axis: shear [N] (3,), torque [N m] and arm [m].

    The torque is that about a middle, which friction bears over the mean arm. where: joints, axis, middle (3,).
    """
    joints, axis, middle = where
    shear, torque, press, arms = np.zeros(3), 0.0, 0.0, 0.0
    for j in joints:
        interface, traction, weights = structure.joints[j].interface, state.tractions[j], contacts[j].weights
        # the first face is pulled along, and lies above where its normal looks along the axis
        sign = np.sign(interface.weights @ (interface.normals @ axis))
        tau = sign * np.einsum("q,qi,qij->qj", weights, traction[:, 1:], interface.frames[:, 1:])
        shear = shear + tau.sum(axis=0)
        torque += float(np.cross(interface.positions - middle, tau).sum(axis=0) @ axis)
        pressed = weights * np.maximum(-traction[:, 0], 0.0)
        press += float(pressed.sum())
        arms += float(pressed @ distance_from(middle, axis, interface.positions))
    return shear, torque, arms / press if press > 0 else 0.0
