"""Reads tables of a study file and collects every fault, so that the user sees them all at once."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from typing import Any, TypeVar

from faying import checks
from faying.contact.parameter import FILE, Parameter
from faying.errors import InputError
from faying.geometry.selectors import Selector
from faying.study.declaration.declared import NAME, REQUIRED, Declared, inner_of, key_of


class StudyFaults(InputError):
    """All faults of a study file; `lines` holds them one by one, each with its key in front."""

    def __init__(self, where: str, lines: list[str]) -> None:
        count = f"{len(lines)} fault" + "s" * (len(lines) > 1)
        super().__init__(f"{where}: {count}\n" + "\n".join(f"  - {line}" for line in lines))
        self.where, self.lines = where, tuple(lines)

    def __reduce__(self) -> tuple[type["StudyFaults"], tuple[str, list[str]]]:
        return StudyFaults, (self.where, list(self.lines))  # as other processes send it


DECLARED: Any = object()  # the default that the declaration has
Made = TypeVar("Made")


@dataclass
class Faults:
    """The faults found so far, the files that the study names, which lie relative to `folder`, and selectors by name.

    selectors: those that stand in place of a face's name, under the name that the face gets; tables: all that are read.
    """

    lines: list[str] = field(default_factory=list)
    folder: Path = field(default_factory=Path)
    files: list[Path] = field(default_factory=list)
    selectors: dict[str, Selector] = field(default_factory=dict)
    tables: "list[Table]" = field(default_factory=list)

    def add(self, text: str) -> None:
        """Note one fault."""
        self.lines.append(text)

    def note_alike(self, kind: str, names: Iterable[str]) -> None:
        """Note each name that several of a kind have."""
        for name, count in Counter(names).items():
            if count > 1:
                self.add(f"two {kind} are called {name!r}; give each a name of its own")

    def raise_if_any(self, where: str) -> None:
        """Raise one StudyFaults that lists all of them, with the keys that nobody took."""
        for table in self.tables:
            table.note_strays()
        if self.lines:
            raise StudyFaults(where, self.lines)


class Table:
    """One table of the file, read by the declarations of its keys."""

    def __init__(self, data: Mapping[str, Any], where: str, faults: Faults, keys: Declared) -> None:
        self.data, self.where, self.faults, self.keys = dict(data), where, faults, keys
        self._known: list[str] = []
        faults.tables.append(self)

    def _name(self, key: str) -> str:
        return f"{self.where}.{key}" if self.where else key

    def get(self, key: str, default: Any = DECLARED) -> Any:
        """What is written under a key, as its declaration converts it; `default`, or that of the declaration, else.

        A fault is noted where a required key is missing, or what is written does not convert.
        """
        declared = key_of(self.keys, self._declared(key))
        if declared.is_file:
            return self.existing(key, default)
        if declared.read is None:
            raise TypeError(f"{self._name(key)} depends on other keys; take it with what converts it")
        return self.take(key, declared.read, default)

    def take(self, key: str, convert: Callable[[Any, str], Any], default: Any = DECLARED) -> Any:
        """The same with a conversion that depends on more than the value."""
        self._known.append(key)
        if default is DECLARED:
            default = key_of(self.keys, self._declared(key)).default
        if key not in self.data:
            if default is REQUIRED:
                self.faults.add(f"{self._name(key)} is missing")
                return None
            return default
        try:
            return convert(self.data[key], self._name(key))
        except InputError as fault:
            self.faults.add(str(fault))
            return None if default is REQUIRED else default

    def existing(self, key: str, default: Any = DECLARED) -> Any:
        """Take the name of a file, relative to the study's folder; the study depends on that file from then on."""
        return self.take(key, self._existing, default)

    def _declared(self, key: str) -> str:
        """The name under which a key is declared: its own, or that of all names that users give."""
        return key if key in self.keys else NAME

    def _existing(self, value: Any, name: str) -> Path:
        path = self.faults.folder / checks.path(value, name)
        if not path.is_file():
            raise InputError(f"{name}: no file {path}")
        self.faults.files.append(path)
        return path

    def table(self, key: str) -> "Table | None":
        """Take a table within this one."""
        declared = inner_of(self.keys, self._declared(key))
        self._known.append(key)
        if key not in self.data:
            if declared.required:
                self.faults.add(f"[{self._name(key)}] is missing")
            return None
        value = self.data[key]
        if not isinstance(value, Mapping):
            self.faults.add(f"{self._name(key)} = {value!r} should be a table: [{self._name(key)}]")
            return None
        return Table(value, self._name(key), self.faults, declared.keys)

    def inner(self, key: str, read: "Callable[[Table], Made]") -> Made | None:
        """Take a table within this one as `read` reads it; None where there is none."""
        table = self.table(key)
        return None if table is None else read(table)

    def tables(self, key: str) -> "list[Table]":
        """Take a list of tables [[key]]; a single [key] counts as a list of one."""
        declared = inner_of(self.keys, key)
        self._known.append(key)
        value = self.data.get(key)
        if value is None:
            if declared.required:
                self.faults.add(f"[[{self._name(key)}]] is missing")
            return []
        items = [value] if isinstance(value, Mapping) else value
        if not isinstance(items, list) or not all(isinstance(item, Mapping) for item in items):
            self.faults.add(f"{self._name(key)} should be a list of tables: [[{self._name(key)}]]")
            return []
        return [Table(one, f"{self._name(key)}[{i + 1}]", self.faults, declared.keys) for i, one in enumerate(items)]

    def every(self, key: str, read: "Callable[[Table], Made | None]") -> tuple[Made, ...]:
        """Take a list of tables as `read` reads each; those that their faults leave nothing of are left out."""
        return tuple(made for made in map(read, self.tables(key)) if made is not None)

    def known(self, key: str) -> bool:
        """Whether this key has been asked for."""
        return key in self._known

    def parameter(self, key: str, parameter: Parameter) -> Any:
        """Take the parameter of a law, checked against its range; None where it is not given."""
        return self.take(key, self._existing if parameter.unit == FILE else parameter.read, None)

    def each(self) -> "dict[str, Table]":
        """Take every table within this one, by name."""
        return {name: table for name in self.data if (table := self.table(name)) is not None}

    def named(self, key: str) -> "dict[str, Table]":
        """Take the tables [key.NAME], by name."""
        outer = self.table(key)
        return outer.each() if outer is not None else {}

    def made(self, make: Callable[[], Made]) -> Made | None:
        """What `make` makes; an InputError of it is noted as a fault of this table."""
        try:
            return make()
        except InputError as fault:
            self.faults.add(f"{self.where}: {fault}")
            return None

    def note_strays(self) -> None:
        """Note every key that was not asked for, with the nearest known one; a table that declares none takes all."""
        for key in self.data if self.keys else ():
            if key not in self._known:
                near = get_close_matches(key, self._known, n=1)
                hint = f"; did you mean {near[0]}?" if near else f"; the known ones are {', '.join(self._known)}"
                self.faults.add(f"{self._name(key)} is not a key that a study has{hint}")
