"""The keys of a study, found by letting the readers read studies with a table that notes what they ask for."""

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping
from dataclasses import MISSING as FIELD_MISSING
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any
from unittest.mock import patch

from faying.contact.build import find_law, laws
from faying.contact.parameter import TABLE, Parameter
from faying.errors import FayingError
from faying.study import study as study_module
from faying.study.keys import geometry
from faying.study.keys.law import OF_SURFACE
from faying.study.keys.reader import MISSING, MOST, Table
from faying.study.study import Study

NAME = "NAME"  # stands for the names that a user gives to tables and keys
# what makes the readers take their other branches
SCENARIOS: tuple[Mapping[str, Any], ...] = (
    {},
    {"geometry": {"face_size": {NAME: "1 mm"}}},
    {"geometry": {"mesh": "", "unit": "mm", "sets": {NAME: "SET"}}},
    {"bolt": [{"part": "bolt"}]},
    {"bolt": [{"grade": "8.8", "thread": "M8"}]},
    {"test": {"file": "test.uff"}},
    *({"law": {"model": law.name}} for law in laws().values()),
)
# tables with the keys of another one
SAME_AS = ("joint.surface", "joint.law", "alternative.surface", "alternative.law", "alternative.form")


@dataclass(frozen=True, kw_only=True)
class Key:
    """One key: its path, what is written there, its default and what is allowed."""

    path: str
    kind: str
    default: str
    allowed: str = ""
    meaning: str = ""
    model: str = ""  # the law that it is a parameter of

    @property
    def table(self) -> str:
        """The path of the table that it stands in."""
        return self.path.rpartition(".")[0]

    @property
    def name(self) -> str:
        """The key alone."""
        return self.path.rpartition(".")[2]


def _plain(where: str) -> str:
    return re.sub(r"\[\d+\]", "", where)


def _default(value: Any, unit: str = "") -> str:
    if value is MISSING:
        return "required"
    if value is None or value in ("", (), [], {}):
        return ""
    if isinstance(value, tuple):
        return "[" + ", ".join(_default(v, unit) for v in value) + "]"
    if isinstance(value, float | int):
        return f'"{value:g} {unit}"' if unit else f"{value:g}"
    return f'"{value}"'


def recorder(found: dict[str, Key], model: str) -> type[Table]:
    """Return a kind of Table that puts every key that it is asked for into `found`."""

    class Recording(Table):
        _inside = False  # while a parameter is read, which is noted already

        def _note(self, key: str, kind: str, default: str, allowed: str = "", meaning: str = "") -> None:
            path = _plain(self._name(key))
            own = model if path.startswith("law.") and meaning else ""
            at = f"{path} {own}" if own else path
            found.setdefault(
                at, Key(path=path, kind=kind, default=default, allowed=allowed, meaning=meaning, model=own)
            )

        def take(self, key: str, convert: Callable[[Any, str], Any], default: Any = MISSING) -> Any:
            if not self._inside:
                self._note(key, _form(convert, key), _default(default))
            return super().take(key, convert, default)

        def quantity(self, key: str, unit: str, default: Any = MISSING, *, positive: bool = True) -> Any:
            self._note(
                key, f"quantity [{unit}]", _default(default, unit), "positive" if positive and default != 0 else ""
            )
            return super().quantity(key, unit, default, positive=positive)

        def text(self, key: str, default: Any = MISSING, choices: tuple[str, ...] | None = None) -> Any:
            words = " or ".join(f'"{word}"' for word in choices) if choices else ""
            self._note(key, "text", _default(default), words)
            return super().text(key, default, choices)

        def number(self, key: str, default: Any = MISSING) -> Any:
            self._note(key, "number", _default(default))
            return super().number(key, default)

        def count(self, key: str, default: Any = MISSING, *, most: int = MOST) -> Any:
            self._note(key, "whole number", _default(default), f"1 to {most:,}")
            return super().count(key, default, most=most)

        def texts(self, key: str, size: int, default: Any = MISSING) -> Any:
            self._note(key, f"list of {size} names", _default(default))
            return super().texts(key, size, default)

        def file(self, key: str, default: Any = MISSING) -> Any:
            if not self._inside:
                self._note(key, "file", _default(default))
            return super().file(key, default)

        def parameter(self, key: str, parameter: Parameter) -> Any:
            kind = parameter.unit if not parameter.is_number else "number"
            if parameter.is_number and parameter.unit:
                kind = f"quantity [{parameter.unit}]"
            if parameter.unit != TABLE:  # an array, which no study can hold
                default = _own_default(model, key, parameter) if self.where == "law" else ""
                self._note(key, kind, default, parameter.allowed, parameter.meaning)
            self._inside = True
            value = super().parameter(key, parameter)
            self._inside = False
            return value

        def table(self, key: str, *, required: bool = False) -> Table:
            self._note(key, "table", "required" if required else "")
            super().table(key, required=required)
            value = self.data.get(key)
            return Recording(value if isinstance(value, Mapping) else {}, self._name(key), self.faults)

        def tables(self, key: str, *, required: bool = False) -> list[Table]:
            self._note(key, "list of tables", "required" if required else "")
            there = super().tables(key, required=required)
            return [Recording(one.data, one.where, one.faults) for one in there] or [
                Recording({}, f"{self._name(key)}[1]", self.faults)
            ]

        def each(self) -> dict[str, Table]:
            return {NAME: self.table(NAME)}

    return Recording


def _own_default(model: str, key: str, parameter: Parameter) -> str:
    """The default of a parameter of a law, as its dataclass has it."""
    for one in fields(find_law(model)) if model else ():  # type: ignore[arg-type]
        if one.name == key and one.default is not FIELD_MISSING:
            return _default(one.default, parameter.unit if parameter.is_number else "")
    return ""


def _form(convert: Callable[[Any, str], Any], key: str) -> str:
    """What a conversion asks for, from what it says where it is given something else."""
    try:
        convert(0, key)
    except FayingError as fault:
        said = re.search(r"should (?:be|name) (.*)", str(fault))
        return said[1].split(";")[0] if said else "quantity"
    except TypeError:
        return "quantity"
    return "number"


def recorded() -> dict[str, Key]:
    """Return every key that the readers ask for, by path (with the law's label behind it for parameters of a law)."""
    found: dict[str, Key] = {}
    for scenario in SCENARIOS:
        kind = recorder(found, str(scenario.get("law", {}).get("model", "")))
        with patch.object(study_module, "Table", kind), patch.object(geometry, "Table", kind):
            try:
                Study.from_dict({**scenario}, folder=Path())
            except FayingError:
                pass  # every scenario lacks something: only what was asked for counts
            else:
                raise AssertionError("a scenario is a whole study")
    return dict(_own(found))


def _own(found: Mapping[str, Key]) -> Iterator[tuple[str, Key]]:
    for at, key in found.items():
        inside = any(key.path.startswith(f"{copy}.") for copy in SAME_AS)
        given_elsewhere = key.table == "law" and key.name in OF_SURFACE
        if not inside and not given_elsewhere:
            yield at, key


def meanings(path: Path) -> dict[str, str]:
    """What each key means, from the file of these words."""
    return {str(key): str(words) for key, words in tomllib.loads(path.read_text(encoding="utf-8")).items()}
