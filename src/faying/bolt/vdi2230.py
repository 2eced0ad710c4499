"""Numbers of the guideline VDI 2230: the deformation cone of the clamped parts, embedding, stress at assembly."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import atanh, log, pi, sqrt
from typing import Literal

from faying.bolt.threads import Thread
from faying.errors import InputError
from faying.units import show

# guide values of embedding [m] under axial load, from a roughness height Rz [m]: in the thread, under head or nut each,
# at each interface between parts (VDI 2230 Part 1:2003 and 2015, Table 5.4/1)
EMBEDDING = {0.0: (3.0e-6, 2.5e-6, 1.5e-6), 10e-6: (3.0e-6, 3.0e-6, 2.0e-6), 40e-6: (3.0e-6, 4.0e-6, 3.0e-6)}
DEFAULT_FRICTION = 0.12  # the middle of class B, 0.08 to 0.16: metal, oiled or coated (VDI 2230 Part 1:2015, Table A5)
TIGHTENED = 0.9  # of the yield stress that tightening may use (VDI 2230 Part 1:2015, R7)
ROUGHEST = 160e-6  # m: the table ends there


def cone_angle(length: float, seat: float, outer: float, *, tapped: bool = False) -> float:
    """Return the tangent of the angle of the deformation cone [-].

    Args:
        length: Clamped length [m].
        seat: Outer diameter [m] of the bearing area under the head.
        outer: Outer diameter [m] of the parts, at least that of the seat.
        tapped: The thread is in the last part (ESV); else there is a nut (DSV).

    Source:
        VDI 2230 Part 1:2015, eqs. (5.1/26) and (5.1/27).
    """
    slender, wide = length / seat, max(outer / seat, 1.0)
    if tapped:
        return 0.348 + 0.013 * log(slender) + 0.193 * log(wide)
    return 0.362 + 0.032 * log(slender / 2) + 0.153 * log(wide)


def cone_compliance(
    sections: Sequence[tuple[float, float]], *, seat: float, hole: float, outer: float, tapped: bool = False
) -> float:
    """Return the compliance of the clamped parts [m/N] by the deformation cone.

    Stress is even over a ring that widens by the angle of the cone from the seat (from both seats where there is a
    nut), and is nowhere wider than the parts: cone, cone and sleeve, or sleeve alone. With one modulus these are eqs.
    (5.1/24) and (5.1/25) of the guideline, and sleeve 4 l/(pi E (D^2 - d^2)).

    Args:
        sections: (length [m], Young's modulus [Pa]) of the clamped parts from the head on.
        seat: Outer diameter [m] of the bearing area.
        hole: Diameter [m] of the hole, less than that of the seat.
        outer: Outer diameter [m] of the parts, greater than the hole.
        tapped: The thread is in the last part (ESV); else there is a nut (DSV).

    Raises:
        InputError: A hole as wide as the seat or the parts, a length or modulus that is not positive, or parts so thin
            beside the seat that the guideline's angle is none.

    Source:
        VDI 2230 Part 1:2015, section 5.1.2.
    """
    if not 0 <= hole < min(seat, outer):
        raise InputError(f"a hole of {hole:g} m must be narrower than the seat, {seat:g} m, and the parts, {outer:g} m")
    if not sections or any(length <= 0 or E <= 0 for length, E in sections):
        raise InputError("a deformation cone needs parts with a positive length and modulus")
    total = sum(length for length, _ in sections)
    slope = 2 * cone_angle(total, seat, outer, tapped=tapped)
    if slope <= 0:
        raise InputError(
            f"parts {total:g} m thick under a seat of {seat:g} m are outside the range of the guideline's cone"
        )
    widest = total if tapped else total / 2  # from the seat to where the cone ends
    flank = min(max((outer - seat) / slope, 0.0), widest)  # from the seat to where it is as wide as the parts
    start = min(seat, outer)

    def ring(near: float, far: float) -> float:
        """Integral of dz/(D^2 - d^2) over depths below one seat, within cone or sleeve."""
        if (near + far) / 2 >= flank:
            return (far - near) / (outer**2 - hole**2)
        narrow, wide = start + slope * near, start + slope * far
        if hole == 0:
            return (1 / narrow - 1 / wide) / slope
        return (atanh(hole / narrow) - atanh(hole / wide)) / (hole * slope)

    ends, position = [0.0], 0.0
    for length, _ in sections:
        position += length
        ends.append(position)
    cuts = {*ends, flank} if tapped else {*ends, flank, total / 2, total - flank}
    places = sorted(z for z in cuts if 0 <= z <= total)
    compliance = 0.0
    for a, b in pairwise(places):
        middle = (a + b) / 2
        E = next(E for (_, E), end in zip(sections, ends[1:], strict=True) if middle < end)
        below = tapped or middle < total / 2
        compliance += 4 / (pi * E) * (ring(a, b) if below else ring(total - b, total - a))
    return compliance


def cone_pressure(
    force: float, *, depth: float, length: float, seat: float, hole: float, outer: float
) -> tuple[float, float]:
    """Return the pressure [Pa] in a joint under one bolt by the deformation cone: its mean, and that at the hole.

    The mean is the force over the section of the cone. The second falls in proportion to the distance from the hole, to
    nothing at the edge of the cone; runs with plates of 3, 10 and 20 mm have 0.8 to 1.02 of it.

    Args:
        force: Preload [N].
        depth: Distance [m] of the joint from the nearer seat.
        length: Clamped length [m].
        seat: Outer diameter [m] of the bearing area.
        hole: Diameter [m] of the hole, less than that of the seat.
        outer: Outer diameter [m] of the parts.

    Raises:
        InputError: A hole as wide as the cone.

    Source:
        VDI 2230 Part 1:2015, section 5.1.2, for the cone.
    """
    wide = seat + 2 * depth * max(cone_angle(length, seat, outer), 0.0)
    wide = max(min(wide, outer), seat)
    if hole >= wide:
        raise InputError(f"a hole of {hole:g} m must be narrower than the cone of pressure, {wide:g} m")
    mean = force / (pi / 4 * (wide**2 - hole**2))
    R, r = wide / 2, hole / 2
    # 2 pi of the integral of (R - s)/(R - r) s ds from r to R
    volume = 2 * pi * ((R**3 - 3 * R * r**2 + 2 * r**3) / 6) / (R - r)
    return mean, force / volume


def embedding_guide(Rz: float) -> tuple[float, float, float]:
    """Return the guideline's embedding [m] in the thread, at each bearing area, and at each interface, for axial load.

    The guideline gives these values for bolts, nuts and compact clamped parts of steel.

    Args:
        Rz: Mean height of the roughness [m], below 160 um.

    Raises:
        InputError: The roughness lies beyond the table.

    Source:
        VDI 2230 Part 1:2015, Table 5.4/1.
    """
    if not 0 <= Rz < ROUGHEST:
        raise InputError(f"Rz = {Rz:g} m: the guideline's values of embedding end at {ROUGHEST:g} m")
    return EMBEDDING[max(limit for limit in EMBEDDING if limit <= Rz)]


def thread_torque(F: float, P: float, d_2: float, mu_G: float) -> float:
    """Torque [N m] in the shank while a bolt is tightened to F [N]."""
    return F * (0.16 * P + 0.58 * d_2 * mu_G)


def tightening_torque(F: float, P: float, d_2: float, mu_G: float, D_Km: float, mu_K: float) -> float:
    """Torque [N m] that tightens a bolt to F [N], the friction under its head included (R13)."""
    return thread_torque(F, P, d_2, mu_G) + F * D_Km * mu_K / 2


def reduced_stress(F: float, d_0: float, torque: float) -> float:
    """Von Mises stress [Pa] at assembly, the shear stress even over the section of diameter d_0 [m]."""
    return sqrt((F / (pi / 4 * d_0**2)) ** 2 + 3 * (torque / (pi / 12 * d_0**3)) ** 2)


def greatest_preload(
    thread: Thread, yield_stress: float, *, scatter: float, friction: float = DEFAULT_FRICTION
) -> float:
    """Return the preload [N] at which the stress at assembly is 90 % of the yield stress where it scatters upwards.

    Args:
        thread: The thread.
        yield_stress: Of the bolt [Pa].
        scatter: Of the preload [-]: the greatest is (1 + scatter) times it.
        friction: Coefficient in the thread [-].

    Source:
        VDI 2230 Part 1:2015, R7.
    """
    torque = thread_torque(1.0, thread.pitch, thread.pitch_diameter, friction)
    stress = reduced_stress(1.0, (thread.pitch_diameter + thread.minor_diameter) / 2, torque)  # of 1 N
    return TIGHTENED * yield_stress / stress / (1 + scatter)


Head = Literal["hexagon", "socket"]
# lengths over the nominal diameter, each with the nominal section unless said otherwise
HEADS: dict[Head, float] = {"hexagon": 0.5, "socket": 0.4}
ENGAGED = 0.5  # on the minor section
NUT = 0.4
TAPPED = 0.33  # with the modulus of the part that is tapped


@dataclass(frozen=True, kw_only=True)
class BoltSection:
    """A cylinder that stands for one piece of a bolt.

    Args:
        name: What it stands for.
        length: [m].
        area: [m2].
        E: Young's modulus [Pa].
    """

    name: str
    length: float
    area: float
    E: float

    @property
    def compliance(self) -> float:
        """Length over modulus and area [m/N]."""
        return self.length / (self.E * self.area)


def bolt_sections(
    thread: Thread,
    *,
    free: float,
    E: float,
    diameter: float | None = None,
    shank: float = 0.0,
    head: Head = "hexagon",
    engaged: float | None = None,
    E_tapped: float | None = None,
) -> tuple[BoltSection, ...]:
    """Return the cylinders in series whose compliances sum to delta_S, from the head to the nut or tapped hole.

    Args:
        thread: The thread.
        free: Length [m] from under the head to where the thread engages, washers included.
        E: Young's modulus [Pa] of bolt and nut.
        diameter: Diameter [m] of the plain shank; that of the thread where None.
        shank: Length [m] of the plain shank, from the head on, between 0 and `free`; the rest is free thread.
        head: "hexagon" (0.5 d) or "socket" (0.4 d).
        engaged: Length [m] that engages a tapped hole; half a diameter of it stretches, or all of it if that is less.
            Not used where there is a nut.
        E_tapped: Young's modulus [Pa] of the part that is tapped (0.33 d); None for a nut (0.4 d) like the bolt.

    Raises:
        InputError: A shank longer than the free length, a length or modulus that is not positive, or an unknown head.

    Source:
        VDI 2230 Part 1:2015, section 5.1.1.1.
    """
    if head not in HEADS:
        raise InputError(f'head = "{head}" is unknown; give "hexagon" or "socket"')
    if free <= 0 or E <= 0 or (E_tapped is not None and E_tapped <= 0):
        raise InputError(f"a bolt needs a free length and moduli above 0; its free length is {free:g} m")
    if not 0 <= shank <= free * (1 + 1e-9):
        raise InputError(
            f"the shank is {show(shank, 'm')} long, but only {show(free, 'm')} are between head and thread; "
            "give a length from 0 to that"
        )
    d = thread.diameter
    nominal, minor = pi / 4 * d**2, thread.minor_area
    plain = nominal if diameter is None else pi / 4 * diameter**2
    inside = ENGAGED * d if E_tapped is None or engaged is None else min(ENGAGED * d, engaged)
    pieces = [
        ("head", HEADS[head] * d, nominal, E),
        ("shank", min(shank, free), plain, E),
        ("free thread", max(free - shank, 0.0), minor, E),
        ("engaged thread", inside, minor, E),
        ("nut", NUT * d, nominal, E) if E_tapped is None else ("tapped hole", TAPPED * d, nominal, E_tapped),
    ]
    return tuple(
        BoltSection(name=name, length=length, area=area, E=modulus)
        for name, length, area, modulus in pieces
        if length > 0
    )
