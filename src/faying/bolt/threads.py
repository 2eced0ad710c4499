"""Metric threads and property classes of steel bolts: stress area and proof load.

Dimensions of metric fasteners by their standards, in one table: threads, holes, heads, washers, pins.

Sources: ISO 261:1998 and 262:1998 (coarsest pitch), ISO 273:1979 (clearance holes: fine, medium, coarse), ISO 4014:2011
and 4017:2014 (hexagon heads: width across flats), ISO 4762:2004 (cap screws: diameter of the head; M18 and M22 by DIN
912), ISO 7089:2000 and 7090:2000 (plain washers: inner and outer diameter, thickness), ISO 10642:2004 (countersunk
heads: least diameter, and greatest of the sharp cone), ISO 2338:1997 (parallel pins). A dash is where the standard has
no such size.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import isclose, pi

import numpy as np

from faying.errors import InputError
from faying.units import show

# all in mm: thread, pitch; holes; flats; socket head; washer; countersunk head
_TABLE = """
1.6 0.35   1.7  1.8  2.0     3.2     3       1.7   4   0.3  -     -
2   0.4    2.2  2.4  2.6     4       3.8     2.2   5   0.3  -     -
2.5 0.45   2.7  2.9  3.1     5       4.5     2.7   6   0.5  -     -
3   0.5    3.2  3.4  3.6     5.5     5.5     3.2   7   0.5  5.54  6.72
3.5 0.6    3.7  3.9  4.2     6       -       3.7   8   0.5  -     -
4   0.7    4.3  4.5  4.8     7       7       4.3   9   0.8  7.53  8.96
5   0.8    5.3  5.5  5.8     8       8.5     5.3   10  1    9.43  11.2
6   1      6.4  6.6  7       10      10      6.4   12  1.6  11.34 13.44
7   1      7.4  7.6  8       11      -       -     -   -    -     -
8   1.25   8.4  9    10      13      13      8.4   16  1.6  15.24 17.92
10  1.5    10.5 11   12      16      16      10.5  20  2    19.22 22.4
12  1.75   13   13.5 14.5    18      18      13    24  2.5  23.12 26.88
14  2      15   15.5 16.5    21      21      15    28  2.5  26.52 30.8
16  2      17   17.5 18.5    24      24      17    30  3    29.01 33.6
18  2.5    19   20   21      27      27      19    34  3    -     -
20  2.5    21   22   24      30      30      21    37  3    36.05 40.32
22  2.5    23   24   26      34      33      23    39  3    -     -
24  3      25   26   28      36      36      25    44  4    -     -
27  3      28   30   32      41      -       28    50  4    -     -
30  3.5    31   33   35      46      45      31    56  4    -     -
33  3.5    34   36   38      50      -       34    60  5    -     -
36  4      37   39   42      55      54      37    66  5    -     -
39  4      40   42   45      60      -       42    72  6    -     -
42  4.5    43   45   48      65      63      45    78  8    -     -
45  4.5    46   48   52      70      -       48    85  8    -     -
48  5      50   52   56      75      72      52    92  8    -     -
52  5      54   56   62      80      -       56    98  8    -     -
56  5.5    58   62   66      85      84      62    105 10   -     -
60  5.5    62   66   70      90      -       66    110 10   -     -
64  6      66   70   74      95      96      70    115 10   -     -
68  6      70   74   78      -       -       -     -   -    -     -
72  6      74   78   82      -       -       -     -   -    -     -
76  6      78   82   86      -       -       -     -   -    -     -
80  6      82   86   91      -       -       -     -   -    -     -
85  6      87   91   96      -       -       -     -   -    -     -
90  6      93   96   101     -       -       -     -   -    -     -
95  6      98   101  107     -       -       -     -   -    -     -
100 6      104  107  112     -       -       -     -   -    -     -
"""


@dataclass(frozen=True, kw_only=True)
class MetricSize:
    """What the standards say of one nominal diameter [mm], all in mm; None where they have no such size."""

    size: float
    pitch: float
    holes: tuple[float, float, float]
    flats: float | None
    socket: float | None
    washer: tuple[float, float, float] | None
    sunk: tuple[float, float] | None


def _read(line: str) -> MetricSize:
    """A line of the table."""
    numbers = [None if word == "-" else float(word) for word in line.split()]
    size, pitch, fine, medium, coarse = (number or 0.0 for number in numbers[:5])  # which every line has
    inner, outer, thickness, least, most = numbers[7:]
    return MetricSize(
        size=size,
        pitch=pitch,
        holes=(fine, medium, coarse),
        flats=numbers[5],
        socket=numbers[6],
        washer=(inner, outer, thickness) if inner and outer and thickness else None,
        sunk=(least, most) if least and most else None,
    )


METRIC: Mapping[float, MetricSize] = {one.size: one for one in map(_read, _TABLE.strip().splitlines())}
# sizes that a hole by itself is taken for: with M7 or M27 every bore of 8 or 30 mm would be for a bolt
COMMON = tuple(size for size in METRIC if 3 <= size <= 24 and size not in (3.5, 7))
PINS = (0.6, 0.8, 1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10, 12, 16, 20, 25, 30, 40, 50)
COMMON_PINS = tuple(pin for pin in PINS if 3 <= pin <= 30)  # the same of pins
NOMINAL = 0.05  # mm: a hole wider by no more is drawn as wide as the thread, whatever the last digit of its radius


def metric(size: float) -> MetricSize:
    """The line of a nominal diameter [mm]. Raises InputError where the table has no such size."""
    if size not in METRIC:
        raise InputError(f"M{size:g} is not in the tables; give one of {', '.join(f'M{one:g}' for one in METRIC)}")
    return METRIC[size]


def nearest_size(value: float, of: Callable[[MetricSize], float | None], within: float) -> float | None:
    """The size [mm] whose number is nearest to a value [mm], at most `within` of it off [-]; None where none is."""
    numbers = {size: number for size, one in METRIC.items() if (number := of(one)) is not None}
    best = min(numbers, key=lambda size: abs(numbers[size] - value))
    return best if abs(numbers[best] - value) <= within * value else None


def size_for_hole(diameter: float) -> float | None:
    """Return the nominal diameter [mm] of the bolt that a clearance hole [m] is made for; None where there is none.

    The common size whose medium hole is nearest, the greater of two alike, if the hole is wider than the bolt by more
    than 0.05 mm and not wider than its coarse hole. What is narrower is as wide as the thread: see `is_tapped`.

    Source:
        ISO 273:1979.
    """
    hole = 1e3 * diameter
    fitting = [size for size in COMMON if size + NOMINAL < hole <= METRIC[size].holes[2] * (1 + 1e-6)]
    return min(fitting, key=lambda size: (round(abs(METRIC[size].holes[1] - hole), 6), -size), default=None)


def is_tapped(diameter: float, size: float) -> bool:
    """Whether a hole [m] may be that of the coarse thread of a size [mm].

    CAD models show a thread by its tap drill, by its core, or by its nominal diameter.
    """
    return bool(size - 1.3 * METRIC[size].pitch <= 1e3 * diameter <= size + NOMINAL)


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
