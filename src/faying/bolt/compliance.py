"""Compliance of a bolt by VDI 2230: head, shank, free thread, engaged thread, nut or tapped hole."""

from dataclasses import dataclass
from math import pi
from typing import Literal

from faying.bolt.threads import Thread
from faying.errors import InputError
from faying.units import show

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
