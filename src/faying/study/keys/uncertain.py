"""[uncertain]: which numbers of a study scatter, and how; a text such as "0.1 to 0.6" may also stand in their place."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import inf
from pathlib import Path
from typing import Any

from faying import units
from faying.bolt.tightening import tightening
from faying.contact.build import find
from faying.distribution import Distribution, uncertain_text
from faying.errors import InputError
from faying.materials import Material
from faying.study.declaration.reader import Faults
from faying.study.declaration.values import quantity
from faying.study.keys.joint import JointChoice
from faying.study.keys.varied import MODEL, Varied, number_of, owners, rooms, short_keys, varied, words

OF_TEST = ("test", "discrepancy", "structure", "test_loss", "discrepancy_loss")
DISTRIBUTIONS = {"distribution", "tightening", "scatter"}  # keys of a table that is one value
OWN = ("preload", *OF_TEST, "surface.fit", "surface.scans", MODEL, "only")  # that are not plain distributions
# standard deviations of the shapes of a joint over the flatness tolerance of its faces: the second-degree part of the
# random form of `faying.form.form`, whose mean flatness over one face is two thirds of the tolerance
ANY_DRAW = Distribution(kind="uniform", centre=5e5, spread=5e5)  # of a million draws of waves each sample has one
SHAPE_SD = {"crown_along": 0.41, "crown_across": 0.41, "twist": 0.36}


def is_draw(key: str) -> bool:
    """Whether a number that varies names a draw of waves: no value of it lies between two others."""
    return key.endswith(".waviness_seed")


@dataclass(frozen=True, kw_only=True)
class Input:
    """One number that scatters.

    Args:
        key: What it is, as a sweep calls it.
        distribution: Of its value in SI units.
        unit: SI unit, "" for a plain number.
        cut: Share of probability that was cut since the number cannot lie there [-].
        within: Whether it stood in the place of the number.
    """

    key: str
    distribution: Distribution
    unit: str
    cut: float = 0.0
    within: bool = False


@dataclass(frozen=True, kw_only=True)
class UncertainChoice:
    """What scatters in a study.

    Args:
        inputs: The numbers.
        models: Laws and their weights, which sum to 1; empty where the law is certain.
        fit: Whether D and G scatter as the fit of the scan says; scans: others of the same surface.
        only: Whether nothing else scatters; else the rest does as it is assumed.
        test, discrepancy: Standard deviation of a test frequency over its value, and of the model's own error in a mode
            [-]; None for the defaults of an identification.
        structure: Standard deviation of ln f that all modes share, beyond E and density where these are listed [-].
        test_loss, discrepancy_loss: The same of loss factors.
    """

    inputs: tuple[Input, ...] = ()
    models: tuple[tuple[str, float], ...] = ()
    fit: bool = False
    scans: tuple[Path, ...] = ()
    only: bool = False
    test: Distribution | None = None
    discrepancy: Distribution | None = None
    structure: Distribution | None = None
    test_loss: Distribution | None = None
    discrepancy_loss: Distribution | None = None


@dataclass(frozen=True, kw_only=True)
class Known:
    """What the keys of [uncertain] may name: the joints, names of bolts, materials, and the material of each part;

    loads: how many preloads there are.
    """

    joints: Sequence[JointChoice]
    bolts: Sequence[str]
    loads: int
    materials: Mapping[str, Material]
    parts: Mapping[str, str]


def extracted(data: Mapping[str, Any]) -> tuple[dict[str, Any], dict[str, str]]:
    """Take texts that scatter out of the places of numbers: the study with their medians, and key -> text.

    A text that its number cannot have is left where it is, for the reader to refuse.
    """
    found: dict[str, str] = {}

    def lifted(owner: Any, room: str, name: str = "") -> Any:
        head = f"{room}.{name}" if name else room
        for number in filter(None, (varied(f"{head}.{name}") for name in rooms()[room].numbers)):
            if number.scatters:
                owner, text = _lifted(owner, number.place.split("."), number.parameter.unit)
                found.update({number.key: text} if text else {})
        return owner

    def of_room(table: Any, room: str, named: str) -> Any:
        if named == "optional" and isinstance(table, list | Mapping):
            entries = [table] if isinstance(table, Mapping) else table
            names = [one.get("name", "") if isinstance(one, Mapping) else "" for one in entries]
            return [lifted(one, room, names[k] or f"{room} {k + 1}") for k, one in enumerate(entries)]
        if named == "always" and isinstance(table, Mapping):
            return {name: lifted(one, room, name) for name, one in table.items()}
        return lifted(table, room) if named == "never" else table

    tables = {room: of_room(data[room], room, there.named) for room, there in rooms().items() if room in data}
    return {**data, **tables}, found


def _lifted(table: Any, place: Sequence[str], unit: str) -> tuple[Any, str]:
    """A table with the median in place of a text that scatters, and that text; "" where there is none."""
    key, *rest = place
    if not isinstance(table, Mapping) or key not in table:
        return table, ""
    value: Any = table[key]
    text = ""
    if rest:
        value, text = _lifted(value, rest, unit)
    elif uncertain_text(value):
        try:
            median = Distribution.read(value, unit).median
        except InputError:
            return table, ""
        text, value = value, f"{median!r} {unit}" if unit else median
    return {**table, key: value} if text else table, text


def read_uncertain(
    table: Mapping[str, Any] | None, inside: Mapping[str, str], known: Known, faults: Faults
) -> UncertainChoice | None:
    """Read [uncertain] and the texts that were taken out of their places; every fault is noted.

    Args:
        table: The table; None where there is none.
        inside: Texts by key, from `extracted`.
        known: What the keys may name.
        faults: Where faults go, and the files that are read.
    """
    if table is None and not inside:
        return None
    reader = _Reader(known, faults)
    takes = [partial(reader.take, ".".join(path), value) for path, value in flat(table or {})]
    takes += [partial(reader.add, key, value, key, within=True) for key, value in inside.items()]
    for take in takes:
        try:
            take()
        except InputError as fault:
            faults.add(str(fault))
    for text in _twice([*map(number_of, reader.inputs)], known):
        faults.add(text)
    return UncertainChoice(inputs=tuple(reader.inputs.values()), **reader.rest)


def _twice(numbers: Sequence[Varied], known: Known) -> Iterator[str]:
    """Say what scatters by two lines: of all owners and of each of them, or a force and a factor on it."""
    names = owners((joint.name for joint in known.joints), known.bolts, known.parts)
    by_place = {(one.room, one.name, one.owner): one.key for one in numbers}
    for (room, name, owner), key in by_place.items():
        own = [by_place.get((room, name, each), "") for each in names.get(room, ())] if owner is None else []
        others = own if own and all(own) else []
        alike = [one for one in numbers if (one.room, one.varies) == (room, name) != (room, one.name)]  # factors on it
        others = [*others, *(one.key for one in alike if None in (owner, one.owner) or one.owner == owner)]
        if others:
            yield f"uncertain: {key} scatters already by {', '.join(others)}; leave one of them out"


def flat(table: Mapping[str, Any], before: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Keys, each as its names in tables within tables, and their values: text, a list, a number, or a table of one."""
    for name, value in table.items():
        path = (*before, name)
        if isinstance(value, Mapping) and value and not DISTRIBUTIONS & set(value) and ".".join(path) != MODEL:
            yield from flat(value, path)
        else:
            yield path, value


class _Reader:
    def __init__(self, known: Known, faults: Faults) -> None:
        self.known, self.faults = known, faults
        self.inputs: dict[str, Input] = {}
        self.rest: dict[str, Any] = {}

    def take(self, key: str, value: Any) -> None:
        """Take one key of the table."""
        where = f"uncertain.{key}"
        key = short_keys().get(key, key)
        parts = key.split(".")
        if key == "preload":
            self._preload(value, where)
        elif key in OF_TEST:
            self.rest[key] = _share(value, where)
        elif key in ("surface.fit", "only"):
            if not isinstance(value, bool):
                raise InputError(f"{where} = {value!r} should be true or false")
            self.rest[key.rsplit(".", 1)[-1]] = value
        elif key == "surface.scans":
            self.rest |= {"fit": True, "scans": self._files(value, where)}
        elif key == "law.model":
            self.rest["models"] = _weights(value, where)
        elif parts[0] == "material" and len(parts) == 2:
            self._of_material(parts[1], value, where)
        elif parts[-2:] == ["form", "flatness"]:
            self._flatness(parts, value, where)
        elif parts[-2:] == ["form", "waviness"]:
            self._waviness(parts, value, where)
        else:
            self.add(key, value, where)

    def add(self, key: str, value: Any, where: str, *, within: bool = False) -> None:
        """Take the distribution of one number."""
        number = varied(key)
        if number is None or not number.scatters:
            raise InputError(f"{where} cannot scatter; what can: {', '.join((*short_keys(), *OWN))}, {words()}")
        self._check(number, where)
        if not isinstance(value, str | Mapping) or not value:
            raise InputError(f'{where} = {value!r} is not a distribution; write for example "0.1 to 0.6" or "2 +- 0.1"')
        self._add(key, Distribution.read(value, number.parameter.unit, where), where, within)

    def _add(self, key: str, found: Distribution, where: str, within: bool = False) -> None:
        parameter = number_of(key).parameter
        if key in self.inputs:
            raise InputError(f"{where}: {key} scatters already by another line; leave one of them out")
        try:
            found, cut = found.within(parameter.least, parameter.greatest, parameter.ends)
        except InputError as fault:
            raise InputError(f"{where}: {fault}") from None
        self.inputs[key] = Input(key=key, distribution=found, unit=parameter.unit, cut=cut, within=within)

    def _check(self, number: Varied, where: str) -> None:
        """Raise InputError where a key names nothing that the study has."""
        known = self.known
        number.check_owner(owners((joint.name for joint in known.joints), known.bolts, known.parts), where)
        if number.room == "bolt" and number.name == "preload" and self.known.loads > 1:
            raise InputError(
                f"{where}: the study has {self.known.loads} preloads; let a factor on all of them scatter, for example "
                'preload = {tightening = "torque wrench, friction estimated"} or bolt.factor = "1 +- 0.1"'
            )

    def _preload(self, value: Any, where: str) -> None:
        """A way of tightening, or its scatter, as a factor on the preload of each bolt; bolts scatter apart."""
        form = '{tightening = "torque wrench, friction estimated"} or {scatter = "25 %"}'
        if not isinstance(value, Mapping) or len(value) != 1 or not {"tightening", "scatter"} & set(value):
            raise InputError(f"{where} = {value!r} should be {form}")
        if "tightening" in value:
            found = tightening(value["tightening"], f"{where}.tightening").distribution
        else:
            scatter = _percent(value["scatter"], f"{where}.scatter")
            found = Distribution(kind="normal", centre=1.0, spread=scatter / 2)
        for name in self.known.bolts:
            self._add(f"bolt.{name}.factor", found, where)

    def _of_material(self, key: str, value: Any, where: str) -> None:
        """E or density of the one material that the parts have."""
        used = sorted(set(self.known.parts.values()))
        if len(used) > 1:
            each = ", ".join(f'material."{name}".{key}' for name in used)
            raise InputError(f"{where}: the parts have {len(used)} materials; say which, as {each}")
        for name in used:
            self.add(f"material.{name}.{key}", value, where)

    def _flatness(self, parts: list[str], value: Any, where: str) -> None:
        """Crowns and twist of the faces of each joint, or of one, from a flatness tolerance of each face."""
        tolerance = quantity(value, "m", where)
        for joint in self._joints(parts, where):
            for shape, sd in SHAPE_SD.items():
                centre = 0.0 if joint.form is None else float(getattr(joint.form, shape))
                found = Distribution(kind="normal", centre=centre, spread=sd * tolerance)
                self._add(f"joint.{joint.name}.form.{shape}", found, where)

    def _waviness(self, parts: list[str], value: Any, where: str) -> None:
        """The waves of each joint, or of one: which are drawn, and how large unless that is given (value: true)."""
        for joint in self._joints(parts, where):
            key = f"joint.{joint.name}.form.waviness"
            if value is not True:
                self.add(key, value, where)
            elif joint.form is None or joint.form.waviness is None:
                raise InputError(
                    f"{where} = true draws waves whose size the joint gives, and {joint.name!r} gives none; write for "
                    'example "0.5 um to 2 um", the rms of the waves of each face'
                )
            self._add(f"{key}_seed", ANY_DRAW, where)

    def _joints(self, parts: list[str], where: str) -> list[JointChoice]:
        """The joint that a key names, or all of them."""
        number = number_of(".".join(parts))
        self._check(number, where)
        return [joint for joint in self.known.joints if number.owner in (None, joint.name)]

    def _files(self, value: Any, where: str) -> tuple[Path, ...]:
        if not isinstance(value, list) or not value or not all(isinstance(one, str) for one in value):
            raise InputError(f'{where} = {value!r} should be a list of files, for example ["second.x3p"]')
        found = tuple(self.faults.folder / one for one in value)
        for file in found:
            if not file.is_file():
                raise InputError(f"{where}: no file {file}")
        self.faults.files += found
        return found


def _percent(value: Any, where: str) -> float:
    """A share such as "25 %", positive."""
    share = units.parse(value, "", name=where) if isinstance(value, str) else None
    if share is None or not 0 < share < 1:
        raise InputError(f'{where} = {value!r} should be per cent of the mean, for example "25 %"')
    return share


def _share(value: Any, where: str) -> Distribution:
    """A relative standard deviation that is known only roughly: its median "0.3 %", or a distribution."""
    if isinstance(value, str) and not uncertain_text(value):
        return Distribution(kind="lognormal", centre=_percent(value, where), spread=0.5)
    return Distribution.read(value, "", where).within(0.0, inf, "()")[0]


def _weights(value: Any, where: str) -> tuple[tuple[str, float], ...]:
    """Laws with weights, from a list of names or a table; they come out with the sum 1."""
    if isinstance(value, list):
        value = dict.fromkeys(map(str, value), 1)
    if not isinstance(value, Mapping) or len(value) < 2:
        raise InputError(f'{where} = {value!r} should name two laws or more, ["jk", "gw-ke"] or {{jk = 1, gw-ke = 2}}')
    for name, weight in value.items():
        if isinstance(weight, bool) or not isinstance(weight, int | float) or not 0 < weight < inf:
            raise InputError(f"{where}.{name} = {weight!r}; a weight is a positive number")
    total = float(sum(value.values()))
    labels = [find(name).label for name in value]
    if len(set(labels)) < len(labels):
        raise InputError(f"{where}: {', '.join(labels)} name one law twice")
    return tuple((label, weight / total) for label, weight in zip(labels, value.values(), strict=True))
