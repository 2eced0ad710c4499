"""What crosses the joints of bolts sideways, by shanks and by friction, and the share of it that each bolt has."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from faying.bolt.solid_bolt import FittedSolidBolt
from faying.fe.nodal_forces import thermal_forces
from faying.joint.bolted import BoltedStructure
from faying.joint.load_path import BoltLine, LoadPaths, distance_from
from faying.joint.shank_forces import shank_forces
from faying.loads.contact import LoadedContact
from faying.loads.statics import LoadedState
from faying.typing import Array

NAN = float("nan")
COAXIAL = 0.1  # of the mean arm of friction: bolts nearer to their middle bear no torque as a pattern


@dataclass(frozen=True, kw_only=True)
class Bent:
    """How a bolt is bent; NaN without a shank.

    Args:
        moments: Bending moments [N m] about two axes across it, at its ends (end, 2).
        shear, torsion: Force across it [N] (3,) and torque about it [N m] on the part under its head.
    """

    moments: Array
    shear: Array
    torsion: float

    @property
    def moment(self) -> float:
        """The greater bending moment of its ends [N m]."""
        return float(np.linalg.norm(self.moments, axis=1).max())


def bent(structure: BoltedStructure, index: int, state: LoadedState, motion: Array) -> Bent:
    """How a bolt is bent by a displacement [m] (unknowns,) from the preload."""
    fitted = structure.fitted_bolts[index]
    heat = own_heat(structure, fitted, state) if isinstance(fitted, FittedSolidBolt) else None
    found = shank_forces(structure, index, motion, heat)
    if found is None:
        return Bent(moments=np.full((1, 2), NAN), shear=np.full(3, NAN), torsion=NAN)
    return Bent(moments=found.moments, shear=found.shear @ found.across, torsion=float(found.torsion))


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
