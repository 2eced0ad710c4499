"""Metric threads and property classes of steel bolts: stress area and proof load."""

import re
from dataclasses import dataclass
from math import isclose, pi

import numpy as np

from faying.bolt.standards import METRIC
from faying.errors import InputError
from faying.units import show

# property class: least tensile strength, least stress at yield (or at 0.2 % or 0.0048 d of lasting elongation), and
# stress under proof load [Pa] (ISO 898-1:2013, Table 3)
CLASSES = {
    "4.6": (400e6, 240e6, 225e6),
    "4.8": (420e6, 340e6, 310e6),
    "5.6": (500e6, 300e6, 280e6),
    "5.8": (520e6, 420e6, 380e6),
    "6.8": (600e6, 480e6, 440e6),
    "8.8": (800e6, 640e6, 580e6),
    "9.8": (900e6, 720e6, 650e6),
    "10.9": (1040e6, 940e6, 830e6),
    "12.9": (1220e6, 1100e6, 970e6),
}
PROOF = {name: proof for name, (*_, proof) in CLASSES.items()}
STRENGTH = {name: (tensile, lasting) for name, (tensile, lasting, _) in CLASSES.items()}
THICK, THICK_CLASS = 16e-3, (830e6, 660e6, 600e6)  # beyond this diameter [m], class 8.8 has these stresses
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
        """Return the coarse thread of a nominal diameter [m]; above M68 that of 6 mm, the coarsest pitch of ISO 261.

        Raises:
            InputError: There is none.
        """
        for size, one in METRIC.items():
            if isclose(1e3 * diameter, size, rel_tol=1e-9):
                return cls(diameter=diameter, pitch=one.pitch * 1e-3)
        raise InputError(
            f"no coarse thread has a diameter of {show(diameter, 'm')}; give one of "
            f'{", ".join(f"M{size:g}" for size in METRIC)}; give thread = "M8x1" with its pitch'
        )

    @classmethod
    def near(cls, diameter: float) -> "Thread":
        """Return the coarse thread of a diameter [m], with a pitch between those of the sizes about it.

        Below M1.6 the ratio of pitch to diameter is that of M1.6; above M68 the pitch is 6 mm.

        Raises:
            InputError: The diameter is none of a metric thread, 1 mm to 300 mm.
        """
        size, pitches = 1e3 * diameter, [one.pitch for one in METRIC.values()]
        pitch = np.interp(size, list(METRIC), pitches) * min(size / min(METRIC), 1.0)
        return cls(diameter=diameter, pitch=1e-3 * float(pitch))

    @property
    def is_coarse(self) -> bool:
        """Whether this is a coarse thread of ISO 261."""
        coarse = [one.pitch for one in METRIC.values() if isclose(1e3 * self.diameter, one.size, rel_tol=1e-9)]
        return any(isclose(1e3 * self.pitch, pitch, rel_tol=1e-9) for pitch in coarse)

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


def is_graded(thread: Thread) -> bool:
    """Whether ISO 898-1 has strengths for a thread."""
    return MIN_DIAMETER <= thread.diameter <= MAX_DIAMETER


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
        if not is_graded(self.thread):
            raise InputError(
                f"thread {self.thread}: the property classes of ISO 898-1 cover M1.6 to M39; leave out grade"
            )

    @property
    def _stresses(self) -> tuple[float, float, float]:
        return THICK_CLASS if self.grade == "8.8" and self.thread.diameter > THICK else CLASSES[self.grade]

    @property
    def tensile_strength(self) -> float:
        """Least tensile strength R_m [Pa]."""
        return self._stresses[0]

    @property
    def yield_stress(self) -> float:
        """Least stress [Pa] at yield, or at 0.2 % of lasting elongation (0.0048 d for 4.8, 5.8 and 6.8)."""
        return self._stresses[1]

    @property
    def proof_stress(self) -> float:
        """Stress under proof load [Pa]."""
        return self._stresses[2]

    @property
    def proof_load(self) -> float:
        """Force [N] that the bolt bears without lasting elongation."""
        return self.proof_stress * self.thread.stress_area
