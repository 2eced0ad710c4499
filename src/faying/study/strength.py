"""Notes where forces and pressures leave what the parts bear: yield of shanks, seats and joints, and odd units."""

from collections.abc import Sequence
from math import pi

import numpy as np

from faying.fe.faces import face_centre
from faying.joint.bolt import Bolt, FittedBolt
from faying.joint.structure import Structure
from faying.notes import Note
from faying.typing import Array
from faying.units import show

GRAVITY = 9.81  # m/s2


def bolt_notes(structure: Structure) -> list[Note]:
    """Say which preloads are beyond yield of the shank or the seat, or less than the structure weighs.

    The shank's stress is taken over its full section: that of a thread is smaller, so that yield comes sooner. No key
    states a bolt's grade; its material's yield strength stands for the proof stress.
    """
    out = []
    weight = GRAVITY * float(structure.matrices[1].sum()) / 3
    for fitted in structure.fitted_bolts:
        bolt = fitted.bolt
        if not bolt.preload:
            continue
        least, greatest = bolt.preload[0], bolt.preload[-1]
        if least < weight:
            text = (
                f"bolt {bolt.name!r}: a preload of {show(least, 'N')} is less than the {show(weight, 'N')} that the "
                "structure weighs; is its unit right?"
            )
            out.append(Note(code="slight-preload", load=least, text=text))
        if isinstance(fitted, FittedBolt) and isinstance(bolt, Bolt):
            out += _shank(bolt, greatest) + _seats(structure, fitted, greatest)
    return out


def _shank(bolt: Bolt, force: float) -> list[Note]:
    strength = getattr(bolt.material, "yield_strength", None)
    if bolt.diameter is None or strength is None:
        return []
    stress = force / (pi / 4 * bolt.diameter**2)
    if stress <= strength:
        return []
    text = (
        f"bolt {bolt.name!r}: {show(force, 'N')} pull its shank of {show(bolt.diameter, 'm')} to {show(stress, 'Pa')}, "
        f"beyond the yield strength of its material, {show(strength, 'Pa')}; the shank stays elastic here"
    )
    return [Note(code="bolt-yield", load=force, text=text)]


def _seats(structure: Structure, fitted: FittedBolt, force: float) -> list[Note]:
    mesh, out = structure.mesh, []
    for face in fitted.bolt.faces:
        strength = _strength(structure, face)
        inner, outer = fitted.ring or (0.0, 0.0)
        area = pi / 4 * (outer**2 - inner**2) if fitted.ring else face_centre(mesh.points, mesh.face(face))[2]
        if strength is not None and force / area > strength:
            text = (
                f"bolt {fitted.bolt.name!r}: {show(force, 'N')} press its seat on {face!r} with "
                f"{show(force / area, 'Pa')}, beyond the yield strength of the part, {show(strength, 'Pa')}; "
                "the part stays elastic here"
            )
            out.append(Note(code="seat-yield", load=force, text=text))
    return out


def _strength(structure: Structure, face: str) -> float | None:
    """Yield strength [Pa] of the part that a face is on, None where it is not known."""
    found: float | None = getattr(structure.materials[structure.mesh.face_part[face]], "yield_strength", None)
    return found


def pressure_notes(structure: Structure, pressures: Sequence[Array], load: float) -> list[Note]:
    """Say on which share of a joint the nominal pressure exceeds the yield strength of the softer part."""
    out = []
    for joint, pressure in zip(structure.joints, pressures, strict=True):
        known = [_strength(structure, face) for face in joint.faces]
        strength = min((value for value in known if value is not None), default=np.inf)
        share = float(joint.interface.weights @ (pressure > strength) / joint.interface.area)
        if share > 0:
            text = (
                f"{joint.name}, {load / 1e3:g} kN: on {share:.2%} of the joint the pressure exceeds the yield strength "
                f"of the softer part, {show(strength, 'Pa')}; the parts stay elastic here"
            )
            out.append(Note(code="joint-yield", joint=joint.name, load=load, share=share, text=text))
    return out
