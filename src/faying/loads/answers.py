"""From the states of load cases to what a designer asks for: bolts, opening, slip."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.bolt.bolt import FittedBolt, fatigue_area
from faying.bolt.fatigue import bending_modulus
from faying.bolt.solid_bolt import FittedSolidBolt
from faying.fe.line import Line
from faying.fe.nodal_forces import thermal_forces
from faying.joint.bolted import BoltedStructure
from faying.joint.carried import PressedPatch
from faying.joint.load_path import BoltLine, LoadPaths
from faying.joint.shank_forces import shank_forces
from faying.joint.strength import least_seat_area
from faying.loads.contact import LoadedContact
from faying.loads.statics import LoadedState
from faying.typing import Array, Index, Mask

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
        arms += float(pressed @ Line(point=middle, axis=axis).about(interface.positions)[0])
    return shear, torque, arms / press if press > 0 else 0.0


NAN = float("nan")
NOTHING = 1e-3  # of a bolt's preload: of a smaller working load no share is told, for bending changes the force, too


def joint_answers(
    structure: BoltedStructure,
    contacts: Sequence[LoadedContact],
    states: Sequence[LoadedState],
    dissipated: Sequence[Array],
    paths: LoadPaths,
) -> dict[str, Any]:
    """Return what the joints do under each state, arrays (case, joint) by their names in `LoadCases`.

    dissipated (joint,) [J]: on the way to each.
    """
    found = [
        [
            _joint(contact, joint.interface, paths.owner[k], state.motions[k], state.tractions[k])
            for k, (joint, contact) in enumerate(zip(structure.joints, contacts, strict=True))
        ]
        for state in states
    ]
    arrays = {name: np.array([[one[name] for one in row] for row in found]) for name in found[0][0]}
    return arrays | {"dissipated": np.array(dissipated)}


def _joint(contact: LoadedContact, interface: Any, bolt: Index, motion: Array, traction: Array) -> dict[str, float]:
    pressure, weights = -traction[:, 0], contact.weights
    touched = float(weights @ (contact.pressure > 0)) or NAN
    normal, shear, torque, needed = _carried(interface, traction, weights, np.ones(len(weights), dtype=bool))
    parts: dict[int, float] = {}
    for index in np.unique(bolt[bolt >= 0]):
        own, _, _, own_needed = _carried(interface, traction, weights, bolt == index)
        if own > 0:
            parts[int(index)] = own_needed / own
    worst = max(parts, key=lambda k: parts[k], default=-1)
    return {
        "normal_force": normal,
        "shear_force": shear,
        "torque": torque,
        "mean_pressure": normal / float(weights.sum()),
        "greatest_pressure": float(pressure.max()),
        "opened": float(weights @ contact.opened(motion)) / touched,
        "sliding": float(weights @ contact.sliding(motion, traction)) / (float(weights @ (pressure > 0)) or NAN),
        "friction_needed": needed / normal if normal > 0 else NAN,
        "friction_needed_worst": parts.get(worst, NAN),
        "worst_bolt": worst,
    }


def _carried(interface: Any, traction: Array, weights: Array, some: Mask) -> tuple[float, float, float, float]:
    """What some points (q,) of a joint carry under tractions (q, 3) [Pa].

    Normal and shear force [N], torque about the normal [N m], and the shear force that needs as much friction as both.
    """
    patch = PressedPatch.of(interface, -traction[:, 0], weights, some)
    forces, torques = patch.loads(traction[:, 1:, None])
    shear, torque = float(np.linalg.norm(forces)), abs(float(torques[0]))
    return patch.normal, shear, torque, patch.equivalent(shear, torque)


def bolt_answers(
    structure: BoltedStructure,
    contacts: Sequence[LoadedContact],
    preload: Array,
    states: Sequence[tuple[LoadedState, Array, Array]],
    starts: Sequence[int | None],
    paths: LoadPaths,
) -> dict[str, Any]:
    """Return what the bolts do, arrays (case, bolt) by their names in `LoadCases`.

    Args:
        structure: The structure.
        contacts: Of each joint.
        preload: Force of each bolt [N] (b,) before any load.
        states: Of each case: its equilibrium, its displacement and the linear one [m] (unknowns,).
        starts: Of each case: the case from whose state it starts; None for the preload.
        paths: Which joints each bolt clamps, and which of their points are its own.
    """
    change, linear, ends, working, transverse = [], [], [], [], []
    for state, motion, straight in states:
        here = bolt_changes(structure, state, motion)
        ends_here = [bent(structure, k, state, motion) for k in range(len(here))]
        change.append(here)
        linear.append(bolt_changes(structure, state, straight))
        ends.append(ends_here)
        crossing = cut_loads(contacts, state, paths, here)
        # F_A: of several cuts the one that more crosses; not known of a bolt that holds no joint
        working.append([max(loads, key=abs, default=NAN) for loads in crossing])
        transverse.append(transverse_loads(structure, contacts, state, paths, ends_here))
    moment = np.array([[one.moment for one in row] for row in ends])
    shear = np.array([[float(np.linalg.norm(one.shear)) for one in row] for row in ends])
    force, load = preload + np.array(change), np.array(working)
    some = np.abs(load) > NOTHING * preload  # not where F_A is not known
    bolts = structure.fitted_bolts
    areas = np.array([least_seat_area(one) for one in bolts])
    return {
        "bolt_force": force,
        "bolt_force_linear": preload + np.array(linear),
        "bolt_moment": moment,
        "bolt_shear": shear,
        "working_load": load,
        "load_factor": np.where(some, np.array(change) / np.where(some, load, 1.0), NAN),
        "transverse_load": np.array(transverse),
        "seat_pressure": force / areas,
        "stress_amplitude": np.array(
            [_stresses(structure, change, ends, k, start) for k, start in enumerate(starts)]
        ).reshape(force.shape),
        "head_friction_needed": np.where(force > 0, shear / np.where(force > 0, force, 1.0), NAN),
    }


def _stresses(
    structure: BoltedStructure, change: Sequence[Array], ends: Sequence[Sequence[Bent]], case: int, start: int | None
) -> list[float]:
    """Half of the range of stress [Pa] of each bolt where it is greatest, from the start of a case to it."""
    out = []
    for b, fitted in enumerate(structure.fitted_bolts):
        force, moments = change[case][b], ends[case][b].moments
        if start is not None:
            force, moments = force - change[start][b], moments - ends[start][b].moments
        area = fatigue_area(fitted)
        bending = np.linalg.norm(moments, axis=1).max() / bending_modulus(area)
        out.append(float(abs(force) / area + bending) / 2)
    return out


def bolt_changes(structure: BoltedStructure, state: LoadedState, motion: Array) -> Array:
    """Change of the force of each bolt [N] (b,) by a displacement [m] (unknowns,) under the load of a state."""
    out = structure.bolt_force_operator @ motion
    for k, fitted in enumerate(structure.fitted_bolts):
        if isinstance(fitted, FittedBolt):
            out[k] -= fitted.axial_stiffness * state.acting.longer[k]
        else:
            out[k] -= fitted.drawn @ own_heat(structure, fitted, state)
    return np.asarray(out)


def cut_loads(
    contacts: Sequence[LoadedContact], state: LoadedState, paths: LoadPaths, change: Array
) -> list[list[float]]:
    """Load [N] that crosses each cut of each bolt, positive where it pulls the parts apart.

    It is the change of the bolt's force less that of the clamp force round it. Over all bolts that hold the same joints
    this is all that the load sends through them.
    """
    lost = [one.weights * (-t[:, 0] - one.pressure) for one, t in zip(contacts, state.tractions, strict=True)]
    return [
        [float(change[k] - sum(lost[j][paths.owner[j] == k].sum() for j in cut.joints)) for cut in cuts]
        for k, cuts in enumerate(paths.cuts)
    ]
