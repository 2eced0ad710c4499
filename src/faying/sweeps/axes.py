"""The axes of a sweep: which quantity of a study varies, and over which values."""

from dataclasses import dataclass
from itertools import product

import numpy as np

from faying import units
from faying.contact.build import find
from faying.contact.parameter import Parameter
from faying.errors import InputError
from faying.misuse import checked_call
from faying.study.keys.surface import Surface
from faying.study.keys.varied import MODEL, owners, varied
from faying.study.keys.varied import words as words_of_keys
from faying.study.study import Study
from faying.sweeps.variant_builder import StudyVariant, check_key

MAX_POINTS = 1_000_000  # points of a grid


@dataclass(frozen=True, kw_only=True)
class Axis:
    """One quantity of the study and its values, SI floats or texts. unit: of the values, "" for plain numbers."""

    key: str
    unit: str
    values: tuple[float | str, ...]

    @property
    def numeric(self) -> bool:
        """Whether the values are numbers."""
        return not any(isinstance(value, str) for value in self.values)

    @property
    def of_form(self) -> bool:
        """Whether the form of faces varies."""
        number = varied(self.key)
        return number is not None and number.of_form

    def read(self) -> str:
        """What the axis spans, for people."""
        first, last = self.values[0], self.values[-1]
        if isinstance(first, str) or isinstance(last, str):
            return f"{self.key} = {', '.join(map(str, self.values))}"
        ends = (units.show(v, self.unit) if self.unit else f"{v:g}" for v in (first, last))
        return f"{self.key} = {' to '.join(ends)}, {len(self.values)} values"


@checked_call
def axis_of(text: str) -> Axis:
    """Read `key=first:last:count`, `key=first:last:count:log` or `key=value,value,...`, quantities with units.

    Raises InputError that shows the form, or says what a sweep can vary.
    """
    key, found, given = text.partition("=")
    key = key.strip()
    if not found or not given.strip():
        raise InputError(
            f'--set {text}: give key=first:last:count, for example surface.D=2.2:2.6:40 or bolt.preload="1 kN:20 kN:30"'
        )
    if key == MODEL:
        return Axis(key=key, unit="", values=tuple(find(word).label for word in given.split(",")))
    number = varied(key)
    if number is None:
        raise InputError(f"--set {key}: a sweep varies {words_of_keys()}; anything else needs a study of its own")
    parameter = number.parameter
    unit = parameter.unit if parameter.is_number else ""
    words = given.split(":")
    if len(words) in (3, 4):
        count = words[2].strip()
        if not count.isdigit() or not 2 <= int(count) <= MAX_POINTS or words[3:] not in ([], ["log"]):
            raise InputError(
                f"--set {text}: after the two ends comes a whole number from 2 to {MAX_POINTS:,}, and log if wanted"
            )
        first, last = (_number(parameter, word, key) for word in words[:2])
        if first == last or (words[3:] and min(first, last) <= 0):
            raise InputError(f"--set {text}: the ends must differ, and be positive for log")
        spread = np.geomspace if words[3:] else np.linspace
        return Axis(key=key, unit=unit, values=tuple(float(v) for v in spread(first, last, int(count))))
    if len(words) == 1:
        return Axis(key=key, unit=unit, values=tuple(_value(parameter, word, key) for word in given.split(",")))
    raise InputError(f"--set {text}: give first:last:count, first:last:count:log, or values with commas between")


def _value(parameter: Parameter, text: str, name: str) -> float | str:
    value = parameter.read(text.strip(), name)
    return value if isinstance(value, str) else float(value)  # type: ignore[arg-type]


def _number(parameter: Parameter, text: str, name: str) -> float:
    value = _value(parameter, text, name)
    if isinstance(value, str):
        raise InputError(f"{name}: {value!r} is a word; give words with commas between")
    return value


@dataclass(frozen=True, kw_only=True)
class Grid:
    """All combinations of the values of some axes, the last axis running fastest.

    Raises InputError for an axis given twice, and for one that does not fit the study.
    """

    study: Study
    surfaces: tuple[Surface, ...]
    axes: tuple[Axis, ...]

    def __post_init__(self) -> None:
        keys = self.keys
        if not keys or len(set(keys)) < len(keys):
            raise InputError(f"a sweep needs each axis once; --set gave {', '.join(keys) or 'none'}")
        if self.size > MAX_POINTS:
            raise InputError(f"the axes have {self.size:,} combinations; a sweep takes up to {MAX_POINTS:,}")
        for key in keys:
            check_key(self.study, key, models=MODEL in keys, where=f"--set {key}")
        self._check_heard()
        if self.study.in_order:
            raise InputError("a sweep pulls all bolts at once; leave out [tightening], or run studies one by one")
        self.point(0)
        self.point(self.size - 1)

    def _check_heard(self) -> None:
        """Raise InputError for an axis of all owners of a number each of which has an axis of its own."""
        numbers = [number for number in map(varied, self.keys) if number is not None]
        study = self.study
        known = owners((one.name for one in study.joints), (one.name for one in study.bolts), study.parts)
        for one in numbers:
            own = {other.owner for other in numbers if (other.room, other.name) == (one.room, one.name)}
            if one.owner is None and len(own) > 1 and own.issuperset(known[one.room]):
                raise InputError(f"--set {one.key}: each {one.room} has an axis of its own, so that it changes nothing")

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def size(self) -> int:
        """Number of points."""
        return int(np.prod(self.shape))

    @property
    def middle(self) -> int:
        """Index of a point in the middle."""
        return int(np.ravel_multi_index(tuple(n // 2 for n in self.shape), self.shape))

    @property
    def keys(self) -> tuple[str, ...]:
        """What varies."""
        return tuple(axis.key for axis in self.axes)

    def point(self, index: int) -> StudyVariant:
        """Return the study at one place of the grid."""
        place = np.unravel_index(index, self.shape)
        forces = np.array(self.study.preloads[-1].forces)
        point = StudyVariant(study=self.study, surfaces=self.surfaces, forces=forces)
        return point.with_values({axis.key: axis.values[i] for axis, i in zip(self.axes, place, strict=True)})

    def corners(self, most: int) -> list[int]:
        """Indices of the grid's corners, at most so many, and every text value once.

        A form opens and closes parts of the joint on its way, so that three values between its ends count, too.
        """

        def ends(axis: Axis) -> list[int]:
            last = len(axis.values) - 1
            if not axis.numeric:
                return list(range(last + 1))
            steps = 4 if axis.of_form else 1
            return sorted({round(k * last / steps) for k in range(steps + 1)})

        found = [int(np.ravel_multi_index(place, self.shape)) for place in product(*map(ends, self.axes))]
        if len(found) <= most:
            return found
        return sorted(np.random.default_rng(0).choice(found, most, replace=False).tolist())

    def winding(self) -> list[int]:
        """All indices on a path on which neighbours differ in one value by one place: each starts from the last."""
        order = [()]  # type: list[tuple[int, ...]]
        for size in self.shape:
            order = [
                (*head, i)
                for k, head in enumerate(order)
                for i in (range(size) if k % 2 == 0 else reversed(range(size)))
            ]
        return [int(np.ravel_multi_index(place, self.shape)) for place in order]
