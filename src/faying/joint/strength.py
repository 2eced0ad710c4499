"""Notes where forces and pressures leave what the parts bear: bolts, seats and joints, and odd units."""

from collections.abc import Mapping, Sequence
from math import pi
from typing import Protocol

import numpy as np

from faying.bolt.bolt import Bolt, BoltPlace, FittedBolt
from faying.bolt.solid_bolt import FittedSolidBolt, SolidBolt, SolidPlace
from faying.fe.elasticity import Solid
from faying.fe.sides import NamedFaces
from faying.joint.bolted import BoltedStructure
from faying.notes import Note, percent
from faying.typing import Array
from faying.units import load_text, show

GRAVITY = 9.81  # m/s2
FASTEST = 20e3  # m/s; the speed sqrt(E/density) of diamond, the fastest of all solids, is 18 km/s
USED = 0.9  # share of its proof load that a bolt is usually tightened to at most


class Bolted(Protocol):
    """What strength is judged by: a structure, or its sketch before there is a mesh."""

    @property
    def mesh(self) -> NamedFaces:
        """The faces."""
        ...

    @property
    def materials(self) -> Mapping[str, Solid]:
        """Part -> its material."""
        ...

    @property
    def mass(self) -> float:
        """Mass of the parts [kg]."""
        ...

    @property
    def fitted_bolts(self) -> Sequence[FittedBolt | FittedSolidBolt | BoltPlace | SolidPlace]:
        """The bolts in their places."""
        ...


def bolt_notes(structure: Bolted, forces: Mapping[str, Sequence[float]]) -> list[Note]:
    """Say which preloads are beyond what bolt or seat bears, or less than the structure weighs.

    A bolt whose grade is known is measured by its proof load. Else the stress over the full section of its shank is
    set beside the yield strength of its material: that of a thread is smaller, so that yield comes sooner. A seat is
    measured by the bearing limit of its part, or by the part's yield strength where no such limit is known.

    forces: of each bolt [N] at each preload, by its name; a bolt that is not among them is not judged.
    """
    out = []
    weight = GRAVITY * structure.mass
    for fitted in structure.fitted_bolts:
        bolt = fitted.bolt
        if not forces.get(bolt.name):
            continue
        least, greatest = min(forces[bolt.name]), max(forces[bolt.name])
        if least < weight:
            text = (
                f"bolt {bolt.name!r}: a preload of {show(least, 'N')} is less than the {show(weight, 'N')} that the "
                "structure weighs; check its unit and its prefix, for example 12 kN"
            )
            out.append(Note(code="slight-preload", severity="limit", load=least, text=text))
        if bolt.fastener is not None:
            out += _proof(bolt, greatest)
        elif isinstance(bolt, Bolt):
            out += _shank(bolt, greatest)
        if isinstance(fitted, FittedBolt | BoltPlace):
            out += _seats(structure, fitted, greatest)
    return out


def material_notes(structure: Bolted) -> list[Note]:
    """Say which materials no solid can be, by sqrt(E/density) as by a density in g/cm^3 that was given as kg/m^3."""
    out = []
    for part, material in structure.materials.items():
        speed = (material.E / material.density) ** 0.5 if material.density else 0.0
        if speed > FASTEST:
            E, density = show(material.E, "Pa"), show(material.density or 0.0, "kg/m^3")
            text = (
                f"part {part!r}: E = {E} and a density of {density} make a speed of sound of {show(speed, 'm/s')}, "
                "which no solid has; are their units right?"
            )
            out.append(Note(code="odd-material", severity="wrong", text=text))
    return out


def _proof(bolt: Bolt | SolidBolt, force: float) -> list[Note]:
    fastener = bolt.fastener
    assert fastener is not None
    proof = fastener.proof_load
    if force <= USED * proof:
        return []
    what = f"bolt {bolt.name!r}: {show(force, 'N')} are {force / proof:.0%} of the proof load of {fastener.thread} "
    what += f"{fastener.grade}, {show(proof, 'N')} (ISO 898-1)"
    if force > proof:
        text = f"{what}: the bolt stretches permanently, which the model leaves out. Lower the preload, or take another"
        return [Note(code="beyond-proof", severity="wrong", load=force, text=text)]
    text = f"{what}, more than the {USED:.0%} that a bolt is usually tightened to"
    return [Note(code="near-proof", severity="limit", load=force, text=text)]


def _shank(bolt: Bolt, force: float) -> list[Note]:
    strength = getattr(bolt.material, "yield_strength", None)
    if bolt.diameter is None or strength is None:
        return []
    stress = force / (pi / 4 * bolt.diameter**2)
    if stress <= strength:
        return []
    text = (
        f"bolt {bolt.name!r}: {show(force, 'N')} pull its shank of {show(bolt.diameter, 'm')} to {show(stress, 'Pa')}, "
        f"above the yield strength of its material, {show(strength, 'Pa')}; the shank stays elastic here. "
        "Lower the preload, take a thicker bolt, or give its grade"
    )
    return [Note(code="bolt-yield", severity="wrong", load=force, text=text)]


def least_seat_area(fitted: FittedBolt | FittedSolidBolt) -> float:
    """The smaller area [m2] of a bolt's seats; NaN for a meshed bolt."""
    return min(seat.area for seat in fitted.pressed) if isinstance(fitted, FittedBolt) else float("nan")


def seat_limit(structure: Bolted, face: str) -> tuple[float, str] | None:
    """Pressure [Pa] that the part of a face bears under a bolt, and what that is; None where nothing is known."""
    limit: float | None = getattr(structure.materials[structure.mesh.face_part[face]], "bearing_limit", None)
    if limit is not None:
        return limit, "bearing limit"
    strength = _strength(structure, face)
    return None if strength is None else (strength, "yield strength")


def _seats(structure: Bolted, fitted: FittedBolt | BoltPlace, force: float) -> list[Note]:
    out = []
    for seat in fitted.pressed:
        pressure, limit = force / seat.area, seat_limit(structure, seat.face)
        if limit is not None and pressure > limit[0]:
            text = (
                f"bolt {fitted.bolt.name!r}: {show(force, 'N')} press its seat on {seat.face!r} with "
                f"{show(pressure, 'Pa')}, above the {limit[1]} of the part, {show(limit[0], 'Pa')}; "
                "the part stays elastic here. Lower the preload, widen the seat, or give the part's bearing_limit"
            )
            out.append(Note(code="seat-yield", severity="wrong", load=force, text=text))
    return out


def _strength(structure: Bolted, face: str) -> float | None:
    """Yield strength [Pa] of the part that a face is on, None where it is not known."""
    found: float | None = getattr(structure.materials[structure.mesh.face_part[face]], "yield_strength", None)
    return found


def pressure_notes(structure: BoltedStructure, pressures: Sequence[Array], load: float) -> list[Note]:
    """Say on which share of a joint the nominal pressure exceeds the yield strength of the softer part."""
    out = []
    for joint, pressure in zip(structure.joints, pressures, strict=True):
        known = [_strength(structure, face) for face in joint.faces]
        strength = min((value for value in known if value is not None), default=np.inf)
        share = float(joint.interface.weights @ (pressure > strength) / joint.interface.area)
        if share > 0:
            text = (
                f"{joint.name}, {load_text(load)}: on {percent(share)} of the joint the pressure exceeds the yield "
                f"strength of the softer part, {show(strength, 'Pa')}; the parts stay elastic here. Lower the preload, "
                "or check the area of the joint and the yield_strength of its parts"
            )
            out.append(Note(code="joint-yield", severity="wrong", joint=joint.name, load=load, share=share, text=text))
    return out
