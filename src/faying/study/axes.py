"""The axes of a sweep: which quantity of a study varies, and over which values."""

from dataclasses import dataclass, replace
from itertools import product
from typing import Any

import numpy as np

from faying import units
from faying.contact.build import check_entries, find, kinds
from faying.contact.parameter import FILE, TABLE, Parameter
from faying.errors import InputError
from faying.joint.form import PARAMETERS, Form
from faying.study.keys.joint import JointChoice
from faying.study.keys.law import OF_SURFACE
from faying.study.keys.surface import Surface
from faying.study.study import Study
from faying.typing import Array

# what a sweep may vary beside the entries of laws: all of it acts on the joints alone
OWN = {
    "surface.D": Parameter("", "fractal dimension", 2, 3),
    "surface.G": Parameter("m", "fractal roughness", 0),
    "surface.scan_area": Parameter("m^2", "area that the scan covers", 0),
    "bolt.preload": Parameter("N", "preload of the bolts", 0),
    "joint.friction": Parameter("", "coefficient of friction", 0, 10, "[)"),
    "law.counterbody": Parameter("text", "what the rough face presses on", choices=("part", "rigid")),
}
MODEL = "law.model"
MOST = 1_000_000  # points of a grid


def _swept(key: str) -> Parameter | None:
    """What a sweep key declares, for any law that has it; None where there is no such key."""
    parts = key.split(".")
    if parts[0] == "bolt" and parts[-1] == "preload" and len(parts) in (2, 3):
        return OWN["bolt.preload"]
    if _formed(parts):
        return PARAMETERS.get(parts[-1])
    if key in OWN:
        return OWN[key]
    if parts[0] != "law" or len(parts) != 2 or parts[1] in OF_SURFACE:
        return None
    entries = [kind.law.entries().get(parts[1]) for kind in kinds().values()]
    return next((p for p in entries if p is not None and p.unit not in (FILE, TABLE)), None)


def _formed(parts: list[str]) -> bool:
    """Whether a key is joint.form.SHAPE, or joint.NAME.form.SHAPE for one joint."""
    return parts[0] == "joint" and len(parts) in (3, 4) and parts[-2] == "form"


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
    if key == MODEL:
        return Axis(key=key, unit="", values=tuple(find(word).label for word in given.split(",")))
    parameter = _swept(key)
    if parameter is None:
        forms = f"joint.form.{{{', '.join(PARAMETERS)}}}", "joint.NAME.form.SHAPE"
        known = ", ".join((*OWN, "bolt.NAME.preload", *forms, MODEL, "law.NAME (a parameter of the law)"))
        raise InputError(
            f"--set {key}: a sweep varies what acts on the joints alone, which is {known}; anything else changes "
            "the parts, and takes a study of its own"
        )
    unit = parameter.unit if parameter.is_number else ""
    words = given.split(":")
    if len(words) in (3, 4):
        count = words[2].strip()
        if not count.isdigit() or not 2 <= int(count) <= MOST or words[3:] not in ([], ["log"]):
            raise InputError(
                f"--set {text}: after the two ends comes a whole number from 2 to {MOST:,}, and log if wanted"
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
        if self.size > MOST:
            raise InputError(f"the axes have {self.size:,} combinations; a sweep takes up to {MOST:,}")
        for key in keys:
            self._check_key(key, models="law.model" in keys)
        if self.study.order is not None:
            raise InputError("a sweep pulls all bolts at once; leave out [tightening], or run studies one by one")
        self.point(0)
        self.point(self.size - 1)

    def _check_key(self, key: str, *, models: bool) -> None:
        """InputError where the study has nothing that this key could vary; models: whether the law varies, too."""
        study, parts = self.study, key.split(".")
        if parts[0] == "bolt" and len(parts) == 3:
            names = [bolt.name for bolt in study.bolts]
            if parts[1] not in names:
                raise InputError(f"--set {key}: no bolt is called {parts[1]!r}; the bolts are {', '.join(names)}")
        if _formed(parts):
            names = [joint.name for joint in study.joints]
            if len(parts) == 4 and parts[1] not in names:
                raise InputError(f"--set {key}: no joint is called {parts[1]!r}; the joints are {', '.join(names)}")
        if parts[0] == "surface":
            if all(joint.surface is not None for joint in study.joints):
                raise InputError(
                    f"--set {key}: every joint has a surface of its own; a sweep varies the study's [surface]"
                )
            if not any(joint.surface is None and study.law_of(joint).needs_surface for joint in study.joints):
                raise InputError(f"--set {key}: no joint takes its law from [surface]; it would change nothing")
        if parts[0] == "law":
            if all(joint.law is not None for joint in study.joints):
                raise InputError(f"--set {key}: every joint has a law of its own; a sweep varies the study's [law]")
            if key == MODEL and not study.law.needs_surface:
                raise InputError(
                    f'--set {key}: [law] gives "{study.law.model}" in full; other laws would lack their surface. '
                    "Vary them on a study with [surface]"
                )
            if key not in (MODEL, "law.counterbody") and not models:
                check_entries(study.law.kind, [parts[1]])

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
                    _with(surface, name, value) if joint.surface is None else surface
                    for joint, surface in zip(study.joints, surfaces, strict=True)
                )
            elif room == "law":
                law = study.law
                if name in ("model", "counterbody"):
                    law = replace(law, **{name: value})
                else:
                    law = replace(law, given={**law.given, name: value})
                study = replace(study, law=law)
            elif _formed(axis.key.split(".")):
                study = replace(study, joints=tuple(_with_form(j, axis.key.split("."), value) for j in study.joints))
            elif room == "joint":
                study = replace(study, joints=tuple(replace(j, friction=value) for j in study.joints))
            elif name == "preload":
                forces = np.full(len(forces), value)
            else:
                forces[[bolt.name for bolt in study.bolts].index(name.split(".")[0])] = value
        return Point(study=study, surfaces=surfaces, forces=forces)

    def corners(self, most: int) -> list[int]:
        """Indices of the grid's corners, at most so many, and every text value once.

        A form opens and closes parts of the joint on its way, so that three values between its ends count, too.
        """

        def ends(axis: Axis) -> list[int]:
            last = len(axis.values) - 1
            if not axis.numeric:
                return list(range(last + 1))
            steps = 4 if _formed(axis.key.split(".")) else 1
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


def _with_form(joint: JointChoice, key: list[str], value: float) -> JointChoice:
    """The joint with one number of its form changed, where the key is for it."""
    if len(key) == 4 and key[1] != joint.name:
        return joint
    return replace(joint, form=(joint.form or Form()).with_value(key[-1], value))


def _with(surface: Surface, name: str, value: float) -> Surface:
    """The surface with one of D, G and scan_area changed."""
    if surface.rough is None:
        return surface
    inputs = replace(surface.rough.inputs, **{name: value})
    return replace(surface, rough=replace(surface.rough, inputs=inputs))
