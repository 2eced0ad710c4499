"""Metric threads and property classes of steel bolts: stress area and proof load."""

import re
from dataclasses import dataclass
from itertools import pairwise
from math import isclose, pi

from faying.errors import InputError
from faying.units import show

# pitch [mm] of the coarse thread of each nominal diameter [mm] (ISO 261)
COARSE = {
    3: 0.5,
    4: 0.7,
    5: 0.8,
    6: 1.0,
    7: 1.0,
    8: 1.25,
    10: 1.5,
    12: 1.75,
    14: 2.0,
    16: 2.0,
    18: 2.5,
    20: 2.5,
    22: 2.5,
    24: 3.0,
    27: 3.0,
    30: 3.5,
    33: 3.5,
    36: 4.0,
    39: 4.0,
}
# the same beyond the property classes of ISO 898-1; wider threads have the last pitch
LARGE = {42: 4.5, 45: 4.5, 48: 5.0, 52: 5.0, 56: 5.5, 60: 5.5, 64: 6.0, 68: 6.0}
# diameters [mm] of clearance holes, fine, medium and coarse, by nominal diameter [mm] (ISO 273)
CLEARANCE_HOLES = {
    3: (3.2, 3.4, 3.6),
    4: (4.3, 4.5, 4.8),
    5: (5.3, 5.5, 5.8),
    6: (6.4, 6.6, 7.0),
    8: (8.4, 9.0, 10.0),
    10: (10.5, 11.0, 12.0),
    12: (13.0, 13.5, 14.5),
    14: (15.0, 15.5, 16.5),
    16: (17.0, 17.5, 18.5),
    18: (19.0, 20.0, 21.0),
    20: (21.0, 22.0, 24.0),
    22: (23.0, 24.0, 26.0),
    24: (25.0, 26.0, 28.0),
}
# outer diameters [mm] of plain washers (ISO 7089) and of heads of cap screws (ISO 4762), by nominal diameter [mm]
WASHERS = {3: 7, 4: 9, 5: 10, 6: 12, 8: 16, 10: 20, 12: 24, 14: 28, 16: 30, 18: 34, 20: 37, 22: 39, 24: 44}
HEADS = {3: 5.5, 4: 7, 5: 8.5, 6: 10, 8: 13, 10: 16, 12: 18, 14: 21, 16: 24, 18: 27, 20: 30, 22: 33, 24: 36}
# diameters [mm] of parallel pins (ISO 2338)
PINS = (3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 30)
# stress under proof load [Pa] of each property class (ISO 898-1:2013, Table 3)
PROOF = {
    "4.6": 225e6,
    "4.8": 310e6,
    "5.6": 280e6,
    "5.8": 380e6,
    "6.8": 440e6,
    "8.8": 580e6,
    "9.8": 650e6,
    "10.9": 830e6,
    "12.9": 970e6,
}
# least tensile strength and least stress at yield, or at 0.2 % or 0.0048 d of lasting elongation [Pa] (the same table)
STRENGTH = {
    "4.6": (400e6, 240e6),
    "4.8": (420e6, 340e6),
    "5.6": (500e6, 300e6),
    "5.8": (520e6, 420e6),
    "6.8": (600e6, 480e6),
    "8.8": (800e6, 640e6),
    "9.8": (900e6, 720e6),
    "10.9": (1040e6, 940e6),
    "12.9": (1220e6, 1100e6),
}
THICK, PROOF_THICK = 16e-3, 600e6  # beyond this diameter [m], class 8.8 has this stress under proof load [Pa]
STRENGTH_THICK = (830e6, 660e6)  # and these strengths
MIN_DIAMETER, MAX_DIAMETER = 1.6e-3, 39e-3  # diameters [m] that ISO 898-1 covers
THINNEST, THICKEST = 1e-3, 300e-3  # diameters [m] of the threads of ISO 261
FINEST = 0.2e-3  # m: pitch of the finest thread of ISO 261
FORM = re.compile(r"M([0-9]+(?:\.[0-9]+)?)(?:\s*x\s*([0-9]+(?:\.[0-9]+)?))?")


@dataclass(frozen=True, kw_only=True)
class Thread:
    """A metric thread.

    Args:
        diameter: Nominal diameter [m].
        pitch: Pitch [m], at least 0.2 mm and less than a third of the diameter.

    Raises:
        InputError: No such thread.
    """

    diameter: float
    pitch: float

    def __post_init__(self) -> None:
        if not (THINNEST <= self.diameter <= THICKEST and FINEST * (1 - 1e-9) <= self.pitch < self.diameter / 3):
            raise InputError(
                f"thread {self}: metric threads are M1 to M300, with a pitch from 0.2 mm to a third of the diameter"
            )

    def __str__(self) -> str:
        return f"M{1e3 * self.diameter:g}x{1e3 * self.pitch:g}"

    @classmethod
    def parse(cls, text: str) -> "Thread":
        """Read "M8" (coarse) or "M8x1". Raises InputError where it is neither, or no coarse thread is called so."""
        found = FORM.fullmatch(text.strip())
        if found is None:
            raise InputError(f'thread "{text}" should be a metric thread, such as "M8" (coarse) or "M8x1"')
        diameter = float(found.group(1)) * 1e-3
        return cls(diameter=diameter, pitch=float(found.group(2)) * 1e-3) if found.group(2) else cls.coarse(diameter)

    @classmethod
    def coarse(cls, diameter: float) -> "Thread":
        """Return the coarse thread of a nominal diameter [m]. Raises InputError where there is none."""
        for size, pitch in COARSE.items():
            if isclose(1e3 * diameter, size, rel_tol=1e-9):
                return cls(diameter=diameter, pitch=pitch * 1e-3)
        raise InputError(
            f"no coarse thread has a diameter of {show(diameter, 'm')}; give one of "
            f'{", ".join(f"M{size}" for size in COARSE)}; give thread = "M8x1" with its pitch'
        )

    @classmethod
    def near(cls, diameter: float) -> "Thread":
        """Return the coarse thread of a diameter [m], with a pitch between those of the sizes about it.

        Below M3 the ratio of pitch to diameter is that of M3; above M68 the pitch is 6 mm.

        Raises:
            InputError: The diameter is none of a metric thread, 1 mm to 300 mm.
        """
        size, pitches = 1e3 * diameter, COARSE | LARGE
        sizes = sorted(pitches)
        if size <= sizes[0]:
            return cls(diameter=diameter, pitch=diameter * pitches[sizes[0]] / sizes[0])
        for low, high in pairwise(sizes):
            if low <= size <= high:
                share = (size - low) / (high - low)
                return cls(diameter=diameter, pitch=1e-3 * (pitches[low] + share * (pitches[high] - pitches[low])))
        return cls(diameter=diameter, pitch=1e-3 * pitches[sizes[-1]])

    @property
    def is_coarse(self) -> bool:
        """Whether this is a coarse thread of ISO 261."""
        return any(
            isclose(1e3 * self.diameter, size, rel_tol=1e-9) and isclose(1e3 * self.pitch, pitch, rel_tol=1e-9)
            for size, pitch in (COARSE | LARGE).items()
        )

    @property
    def pitch_diameter(self) -> float:
        """Pitch diameter d_2 [m] (ISO 724)."""
        return self.diameter - 0.64952 * self.pitch

    @property
    def minor_diameter(self) -> float:
        """Minor diameter d_3 [m] of the bolt, at the root of its thread (ISO 898-1:2013, 9.1.6.1)."""
        return self.diameter - 1.22687 * self.pitch

    @property
    def minor_area(self) -> float:
        """Area [m2] of the minor diameter, A_d3."""
        return pi / 4 * self.minor_diameter**2

    @property
    def stress_area(self) -> float:
        """Nominal stress area [m2]: that of the mean of pitch and minor diameter (ISO 898-1:2013, 9.1.6.1)."""
        return pi / 4 * ((self.pitch_diameter + self.minor_diameter) / 2) ** 2


NOMINAL = 0.05  # mm: a hole wider by no more is drawn as wide as the thread, whatever the last digit of its radius


def size_for_hole(diameter: float) -> int | None:
    """Return the nominal diameter [mm] of the bolt that a clearance hole [m] is made for; None where there is none.

    The size whose medium hole is nearest, the greater of two alike, if the hole is wider than the bolt by more than
    0.05 mm and not wider than its coarse hole. What is narrower is as wide as the thread: see `is_tapped`.

    Source:
        ISO 273:1979.
    """
    hole = 1e3 * diameter
    fitting = [size for size, (_, _, coarse) in CLEARANCE_HOLES.items() if size + NOMINAL < hole <= coarse * (1 + 1e-6)]
    return min(fitting, key=lambda size: (round(abs(CLEARANCE_HOLES[size][1] - hole), 6), -size), default=None)


def is_tapped(diameter: float, size: int) -> bool:
    """Whether a hole [m] may be that of the coarse thread of a size [mm].

    CAD models show a thread by its tap drill, by its core, or by its nominal diameter.
    """
    return bool(size - 1.3 * COARSE[size] <= 1e3 * diameter <= size + NOMINAL)


@dataclass(frozen=True, kw_only=True)
class Fastener:
    """Thread and property class of a steel bolt, such as M8 of class 8.8.

    Args:
        thread: The thread.
        grade: The property class, one of `PROOF`.

    Raises:
        InputError: The class is not known, or the thread is none of M1.6 to M39.

    Source:
        ISO 898-1:2013, Table 3 (strengths and stress under proof load).
    """

    thread: Thread
    grade: str

    def __post_init__(self) -> None:
        if self.grade not in PROOF:
            raise InputError(
                f'grade "{self.grade}" is not a property class of ISO 898-1; give one of {", ".join(PROOF)}'
            )
        if not MIN_DIAMETER <= self.thread.diameter <= MAX_DIAMETER:
            raise InputError(
                f"thread {self.thread}: the property classes of ISO 898-1 cover M1.6 to M39; leave out grade"
            )

    @property
    def _is_thick(self) -> bool:
        return self.grade == "8.8" and self.thread.diameter > THICK

    @property
    def proof_stress(self) -> float:
        """Stress under proof load [Pa]."""
        return PROOF_THICK if self._is_thick else PROOF[self.grade]

    @property
    def tensile_strength(self) -> float:
        """Least tensile strength R_m [Pa]."""
        return (STRENGTH_THICK if self._is_thick else STRENGTH[self.grade])[0]

    @property
    def yield_stress(self) -> float:
        """Least stress [Pa] at yield, or at 0.2 % of lasting elongation (0.0048 d for 4.8, 5.8 and 6.8)."""
        return (STRENGTH_THICK if self._is_thick else STRENGTH[self.grade])[1]

    @property
    def proof_load(self) -> float:
        """Force [N] that the bolt bears without lasting elongation."""
        return self.proof_stress * self.thread.stress_area
