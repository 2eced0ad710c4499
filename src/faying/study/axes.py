"""The axes of a sweep: which quantity of a study varies, and over which values."""

from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from faying import units
from faying.contact.compare import law_class
from faying.contact.tabulated import TabulatedLaw
from faying.errors import InputError
from faying.study.contact import JK_NUMBERS, LawSpec, own_numbers
from faying.study.schema import Study
from faying.study.surface import Surface
from faying.typing import Array

# what a sweep may vary, with its SI unit ("" for a plain number): all of it acts on the joints alone
NUMBERS = {"surface.D": "", "surface.G": "m", "surface.scan_area": "m^2", "bolt.preload": "N", "joint.friction": ""}
TEXTS = ("law.model", "law.counterbody")


@dataclass(frozen=True, kw_only=True)
class Axis:
    """One quantity of the study and its values, SI floats or texts. unit: of the values, "" for plain numbers."""

    key: str
    unit: str
    values: tuple[float | str, ...]

    @property
    def numeric(self) -> bool:
        """Whether the values are numbers."""
        return self.key not in TEXTS

    def read(self) -> str:
        """What the axis spans, for people."""
        first, last = self.values[0], self.values[-1]
        if isinstance(first, str) or isinstance(last, str):
            return f"{self.key} = {', '.join(map(str, self.values))}"
        ends = (f"{v:g}" if not self.unit else units.show(v, self.unit) for v in (first, last))
        return f"{self.key} = {' to '.join(ends)}, {len(self.values)} values"


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
    if key in TEXTS:
        return Axis(key=key, unit="", values=tuple(word.strip() for word in given.split(",")))
    parts = key.split(".")
    known_units = NUMBERS | _law_units()
    unit = known_units.get("bolt.preload" if parts[0] == "bolt" and parts[-1] == "preload" and len(parts) == 3 else key)
    if unit is None:
        known = ", ".join((*NUMBERS, "bolt.NAME.preload", "law.NAME (a parameter of the law)", *TEXTS))
        raise InputError(
            f"--set {key}: a sweep varies what acts on the joints alone, which is {known}; anything else changes "
            "the parts, and takes a study of its own"
        )
    words = given.split(":")
    if len(words) in (3, 4):
        if not words[2].strip().isdigit() or int(words[2]) < 2 or words[3:] not in ([], ["log"]):
            raise InputError(f"--set {text}: after the two ends comes a whole number of 2 or more, and log if wanted")
        first, last = (_value(word, unit, key) for word in words[:2])
        if first == last or (words[3:] and min(first, last) <= 0):
            raise InputError(f"--set {text}: the ends must differ, and be positive for log")
        spread = np.geomspace if words[3:] else np.linspace
        return Axis(key=key, unit=unit, values=tuple(float(v) for v in spread(first, last, int(words[2]))))
    if len(words) == 1:
        return Axis(key=key, unit=unit, values=tuple(_value(word, unit, key) for word in given.split(",")))
    raise InputError(f"--set {text}: give first:last:count, first:last:count:log, or values with commas between")


def _law_units() -> dict[str, str]:
    """SI unit of every number that some law states as its own parameter, by `law.NAME`."""
    from faying.contact.registry import laws

    taken = (own_numbers(law) for law in laws().values() if law is not TabulatedLaw)
    return {f"law.{name}": unit for numbers in taken for name, unit in numbers.items()}


def _law_takes(law: LawSpec) -> tuple[str, ...]:
    """Numbers under [law] that a sweep can vary, for the law that the study has."""
    if law.model.lower() == "jk":
        return JK_NUMBERS
    if law.heights is not None or law.table is not None:
        return ()
    return tuple(own_numbers(law_class(law.model)))


def _value(text: str, unit: str, name: str) -> float:
    if unit:
        return units.parse(text.strip(), unit, name=name)
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{name}: {text.strip()!r} should be a plain number, for example 2.4") from None


@dataclass(frozen=True, kw_only=True)
class Point:
    """One place of the grid: the study and the surfaces with its values put in, and the bolts' forces [N] (b,)."""

    study: Study
    surfaces: tuple[Surface, ...]
    forces: Array


@dataclass(frozen=True, kw_only=True)
class Grid:
    """All combinations of the values of some axes, the last axis running fastest.

    Raises InputError for an axis given twice, and for one that does not fit the study.
    """

    study: Study
    surfaces: tuple[Surface, ...]
    axes: tuple[Axis, ...]

    def __post_init__(self) -> None:
        keys = [axis.key for axis in self.axes]
        if not keys or len(set(keys)) < len(keys):
            raise InputError(f"a sweep needs each axis once; --set gave {', '.join(keys) or 'none'}")
        names = [bolt.name for bolt in self.study.bolts]
        for key in keys:
            parts = key.split(".")
            if parts[0] == "bolt" and len(parts) == 3 and parts[1] not in names:
                raise InputError(f"--set {key}: no bolt is called {parts[1]!r}; the bolts are {', '.join(names)}")
            if parts[0] == "surface" and all(joint.surface is not None for joint in self.study.joints):
                raise InputError(
                    f"--set {key}: every joint has a surface of its own; a sweep varies the study's [surface]"
                )
            if parts[0] == "surface" and not any(
                joint.surface is None and (joint.law or self.study.law).needs_surface for joint in self.study.joints
            ):
                raise InputError(f"--set {key}: no joint takes its law from [surface]; it would change nothing")
            if parts[0] == "law" and all(joint.law is not None for joint in self.study.joints):
                raise InputError(f"--set {key}: every joint has a law of its own; a sweep varies the study's [law]")
            law = self.study.law
            if key in TEXTS[:1] and not law.needs_surface:
                raise InputError(
                    f'--set {key}: [law] gives "{law.model}" in full; other laws would lack their surface. Vary them on a '
                    "study with [surface]"
                )
            if parts[0] == "law" and key not in TEXTS and "law.model" not in keys and parts[1] not in _law_takes(law):
                raise InputError(
                    f'--set {key}: the law "{law.model}" takes {", ".join(_law_takes(law)) or "no numbers"}'
                )
        if self.study.order is not None:
            raise InputError("a sweep pulls all bolts at once; leave out [tightening], or run studies one by one")
        self.point(0)
        self.point(self.size - 1)

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def size(self) -> int:
        """Number of points."""
        return int(np.prod(self.shape))

    def point(self, index: int) -> Point:
        """Return the study at one place of the grid."""
        place = np.unravel_index(index, self.shape)
        study, surfaces = self.study, self.surfaces
        forces = np.array([bolt.preload[-1] for bolt in study.bolts])
        for axis, i in zip(self.axes, place, strict=True):
            value: Any = axis.values[i]
            room, _, name = axis.key.partition(".")
            if room == "surface":
                surfaces = tuple(
                    replace(surface, **{name: value}) if joint.surface is None else surface
                    for joint, surface in zip(study.joints, surfaces, strict=True)
                )
                if name == "D" and not 2 < value < 3:
                    raise InputError(f"surface.D = {value:g}: the dimension of a surface lies between 2 and 3")
            elif room == "law":
                law = study.law
                if name in ("model", "counterbody"):
                    law = replace(law, **{name: value})
                else:
                    law = replace(law, options=law.options | {name: value})
                study = replace(study, law=law)
            elif room == "joint":
                study = replace(study, joints=tuple(replace(j, friction=value) for j in study.joints))
            elif name == "preload":
                forces = np.full(len(forces), value)
            else:
                forces[[bolt.name for bolt in study.bolts].index(name.split(".")[0])] = value
        if np.any(forces <= 0):
            raise InputError(
                f"bolt.preload: {forces.min():g} N; a preload pulls the joint together and must be positive"
            )
        return Point(study=study, surfaces=surfaces, forces=forces)

    def corners(self, most: int) -> list[int]:
        """Indices of the grid's corners, at most so many, and every text value once."""
        ends = [range(len(a.values)) if not a.numeric else sorted({0, len(a.values) - 1}) for a in self.axes]
        found = [int(np.ravel_multi_index(place, self.shape)) for place in product(*ends)]
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
