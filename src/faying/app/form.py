"""The study as a form: groups of fields from the declarations of its keys, each with what the text says.

The text is the truth: a form is made from it, and a change in the form is a change of one key in it.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any, Literal

from faying.contact.build import AUTO, find
from faying.errors import InputError
from faying.setup.edit import KeyPath, edited, line_of, lines_of, name_of, parsed, written
from faying.study.declaration.declared import NAME, NUMERAL, REQUIRED, Declared, Inner, Key
from faying.study.keys.tables import STUDY
from faying.study.keys.uncertain import OWN, flat
from faying.study.keys.varied import rooms, short_keys, varied
from faying.text import toml

Shape = Literal["text", "choice", "truth", "number", "face", "list", "some", "any"]
# tables that stand in the form before the text has them, and the keys of a table that are shown at once
ALWAYS = ("geometry", "law", "surface", "modes", "uncertain")
FIRST: Mapping[str, Sequence[str]] = {
    "geometry": ("step", "size"),
    "joint": ("name", "faces", "friction", "tangential"),
    "bolt": ("name", "faces", "diameter", "grade", "preload"),
    "surface": ("scan", "counter"),
    "law": ("model",),
    "modes": ("count", "damping"),
    "material": ("E", "nu", "density"),
}
FILES = {"step": "geometry", "mesh": "mesh", "scan": "scan", "counter": "scan", "file": "test"}
FREE = Key(says="A number that scatters: a distribution such as 0.1 to 0.6 or 200 GPa +- 4 GPa.", kind="", schema={})
_NUMBER = re.compile(NUMERAL)


@dataclass(frozen=True, kw_only=True)
class FormField:
    """One key.

    Args:
        path: where it stands; name: the same as messages write it; label: the key alone.
        says: what it means.
        shape: how it is written.
        choices: the only values; suggestions: some of them.
        default: what holds where it is left out, "" where nothing does.
        unit: in SI.
        value: what the text says, None where it says nothing.
        first: whether it is shown at once.
        needed: whether it cannot be left out.
        line: of the text, from 1, on which it stands or would; None where it has no place yet.
    """

    path: KeyPath
    name: str
    label: str
    says: str
    shape: Shape
    choices: Sequence[str] = ()
    suggestions: Sequence[str] = ()
    default: str = ""
    unit: str = ""
    value: str | None = None
    first: bool = False
    needed: bool = False
    line: int | None = None


@dataclass(frozen=True, kw_only=True)
class FormAddition:
    """A table or a key that may be added.

    Args:
        path: where; without its last name where `named`, which the user gives.
        label: what it is called in the list.
        says: what it is.
        is_key: whether it is a key, which needs a value.
        suggestions: some names.
    """

    path: KeyPath
    label: str
    says: str
    named: bool = False
    is_key: bool = False
    suggestions: Sequence[str] = ()


@dataclass(frozen=True, kw_only=True)
class FormGroup:
    """One table, its keys, and what may be added to it; there: whether the text has it."""

    path: KeyPath
    name: str
    says: str
    there: bool = True
    fields: list[FormField] = field(default_factory=list)
    additions: list[FormAddition] = field(default_factory=list)


def form_of(text: str, files: Mapping[str, Sequence[str]]) -> list[dict[str, Any]]:
    """Return the groups of a study's text, ready for JSON.

    Args:
        text: of the study.
        files: names of files in its folder by kind: "geometry", "mesh", "scan", "test".

    Raises:
        InputError: the text is not TOML.
    """
    data = parsed(text)
    maker = _Maker(data, files, lines_of(text))
    return [asdict(group) for group in maker.groups((), "", Inner(says="The study.", keys=STUDY), data)]


def changed(text: str, path: KeyPath, value: str) -> str:
    """Return the text with one key set to what was written in its field; empty takes the key out.

    Raises:
        InputError: there is no such key, or the text cannot be changed alone there.
    """
    data = parsed(text)
    key, now = _key_of(path, data), _value_at(data, path)
    shape = _shape(key)
    if value.strip() == "" and now is None:
        return text
    if now is not None and value == _shown(now, shape):
        return text
    return edited(text, path, _read(value.strip(), shape, key) if value.strip() else None)


def added(text: str, path: KeyPath) -> str:
    """Return the text with a new table. Raises InputError where it is there already, or no such table exists."""
    data = parsed(text)
    _inner_of(path)
    if _value_at(data, path) is not None:
        raise InputError(f"{name_of(path)} is there already")
    return edited(text, path, {})


def removed(text: str, path: KeyPath) -> str:
    """Return the text without a table or a key. Raises InputError where there is none."""
    return edited(text, path, None)


class _Maker:
    def __init__(self, data: Mapping[str, Any], files: Mapping[str, Sequence[str]], lines: Mapping[str, int]) -> None:
        self.data, self.files, self.lines = data, files, lines
        self.faces = sorted(set(_faces(data)))

    def groups(self, path: KeyPath, name: str, inner: Inner, data: Any) -> Iterator[FormGroup]:
        """The group of a table, then those of the tables within it."""
        group = FormGroup(path=path, name=name, says=inner.says, there=data is not None)
        table = data if isinstance(data, Mapping) else {}
        inside: list[FormGroup] = []
        if inner.free:
            for rest, _ in flat(table):
                group.fields.append(self._field((*path, *rest), ".".join((name, *rest)), FREE))
            group.additions.append(self._scatter(path))
        for key, what in _keys(inner, table).items():
            here, its_name = (*path, key), f"{name}.{key}" if name else key
            if key == NAME:
                inside += self._named(group, path, name, what, table)
            elif isinstance(what, Key):
                group.fields.append(self._field(here, its_name, what))
            elif what.many:
                inside += self._many(group, here, its_name, what, table.get(key))
            elif tuple(what.keys) == (NAME,):
                inside += self._outer(group, here, its_name, what, table.get(key))
            elif key in table or (not path and key in ALWAYS):
                inside += self.groups(here, its_name, what, table.get(key))
            else:
                group.additions.append(FormAddition(path=here, label=key, says=what.says))
        yield group
        yield from inside

    def _many(self, group: FormGroup, path: KeyPath, name: str, inner: Inner, table: Any) -> Iterator[FormGroup]:
        single = isinstance(table, Mapping)
        entries = table if isinstance(table, list) else []
        if single:
            yield from self.groups(path, f"{name}[1]", inner, table)
        for k, entry in enumerate(entries):
            yield from self.groups((*path, k), f"{name}[{k + 1}]", inner, entry)
        if not single:
            group.additions.append(FormAddition(path=(*path, len(entries)), label=str(path[-1]), says=inner.says))

    def _outer(self, group: FormGroup, path: KeyPath, name: str, inner: Inner, table: Any) -> Iterator[FormGroup]:
        """A table that holds names of the user's own alone: its keys, or its tables, stand for themselves."""
        what = inner.keys[NAME]
        if isinstance(what, Key) and table is not None:
            yield from self.groups(path, name, inner, table)
        elif isinstance(what, Key):
            group.additions.append(self._new_name(path, what))
        else:
            yield from self._named(group, path, name, what, table if isinstance(table, Mapping) else {})

    def _named(
        self, group: FormGroup, path: KeyPath, name: str, what: Key | Inner, table: Mapping[str, Any]
    ) -> Iterator[FormGroup]:
        for own, value in table.items():
            if isinstance(what, Key):
                group.fields.append(self._field((*path, own), f"{name}.{own}", what, first=True))
            else:
                yield from self.groups((*path, own), f"{name}.{own}", what, value)
        group.additions.append(self._new_name(path, what))

    def _new_name(self, path: KeyPath, what: Key | Inner) -> FormAddition:
        words = self.faces if path[-1] in ("face_size", "face") else ()
        label, is_key = f"{path[-1]}.NAME", isinstance(what, Key)
        return FormAddition(path=path, label=label, says=what.says, named=True, is_key=is_key, suggestions=words)

    def _scatter(self, path: KeyPath) -> FormAddition:
        names = [*short_keys(), *OWN]
        for room, found in rooms().items():
            table = self.data.get(room)
            owners = [one["name"] for one in _tables(table) if isinstance(one.get("name"), str)]
            if found.named == "always" and isinstance(table, Mapping):
                owners = list(table)
            heads = [room] * (found.named == "optional") + [f"{room}.{owner}" for owner in owners]
            numbers = (varied(f"{head}.{name}") for head in heads for name in found.numbers)
            names += [number.key for number in numbers if number is not None and number.scatters]
        label = "uncertain.NAME"
        return FormAddition(path=path, label=label, says=FREE.says, named=True, is_key=True, suggestions=names)

    def _field(self, path: KeyPath, name: str, key: Key, *, first: bool = False) -> FormField:
        label, table = str(path[-1]), next((one for one in reversed(path[:-1]) if isinstance(one, str)), "")
        room = str(path[0]) if table not in FIRST else table
        value, shape = _value_at(self.data, path), _shape(key)
        at_once = FIRST.get(room)
        return FormField(
            path=path,
            name=name,
            label=label if key is not FREE else ".".join(str(one) for one in path[1:]),
            says=key.says,
            shape=shape,
            choices=[str(one) for one in key.schema.get("enum", ())],
            suggestions=self._suggestions(label, key),
            default=key.default_text.strip('"'),
            unit=key.unit,
            value=None if value is None else _shown(value, shape),
            first=first or value is not None or at_once is None or label in at_once,
            needed=key.default is REQUIRED,
            line=line_of(name, self.lines),
        )

    def _suggestions(self, label: str, key: Key) -> list[str]:
        words = [word for way in _ways(key.schema) for word in way.get("enum", ())]  # in place of a number
        found = [*key.examples(), *(words if "anyOf" in key.schema else [])]
        if label in FILES and (key.is_file or label == "counter"):
            found += self.files.get(FILES[label], ())
        if label == "material":
            own = self.data.get("material")
            found += own if isinstance(own, Mapping) else ()
        return found + (self.faces if _shape(key) == "face" else [])


def _keys(inner: Inner, table: Mapping[str, Any]) -> Declared:
    """The keys of a table, with those of its law."""
    models = inner.models()
    if not models:
        return inner.keys
    try:
        kind = find(table.get("model", AUTO))
    except InputError:
        return inner.keys
    own = models.get(kind.law.name, {})
    return dict(inner.keys) | {name: key for name, key in own.items() if name not in kind.fixed}


def _key_of(path: KeyPath, data: Mapping[str, Any]) -> Key:
    """The declaration of a key. Raises InputError where there is none."""
    inner = _inner_of(path[:-1])
    if inner.free:
        return FREE
    table = _value_at(data, path[:-1])
    keys = _keys(inner, table if isinstance(table, Mapping) else {})
    found = keys.get(str(path[-1]), keys.get(NAME))
    if not isinstance(found, Key):
        raise InputError(f"{name_of(path)} is not a key of a study")
    return found


def _inner_of(path: KeyPath) -> Inner:
    """The declaration of a table. Raises InputError where there is none."""
    inner = Inner(says="", keys=STUDY)
    for one in path:
        if isinstance(one, int):
            continue
        found = inner.keys.get(one, inner.keys.get(NAME))
        if inner.free:
            return inner
        if not isinstance(found, Inner):
            raise InputError(f"{name_of(path)} is not a table of a study")
        inner = found
    return inner


def _value_at(data: Any, path: KeyPath) -> Any:
    """What stands at a path; None where nothing does."""
    for one in path:
        if isinstance(one, int):
            data = data[one] if isinstance(data, list) and 0 <= one < len(data) else None
        else:
            data = data.get(one) if isinstance(data, Mapping) else None
    return data


def _faces(data: Any, key: str = "") -> Iterator[str]:
    if key in ("face", "face_size") and isinstance(data, Mapping) and "part" not in data:
        yield from data
    elif key in ("face", "faces", "walls") and isinstance(data, str | list):
        yield from [one for one in ([data] if isinstance(data, str) else data) if isinstance(one, str)]
    elif isinstance(data, Mapping):
        for name, value in data.items():
            yield from _faces(value, name)
    elif isinstance(data, list):
        for one in data:
            yield from _faces(one)


def _tables(table: Any) -> list[Mapping[str, Any]]:
    return [one for one in (table if isinstance(table, list) else [table]) if isinstance(one, Mapping)]


def _ways(schema: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    return [way for one in schema["anyOf"] for way in _ways(one)] if "anyOf" in schema else [schema]


def _shape(key: Key) -> Shape:
    """How the value of a key is written, from its schema."""
    kinds = {_kind(way) for way in _ways(key.schema)}
    if key is FREE or "object" in kinds:
        return "any"
    if "selector" in kinds:
        return "face"
    if "array" in kinds:
        return "list" if kinds == {"array"} else "some"
    if kinds == {"enum"}:
        return "choice"
    if "boolean" in kinds:
        return "truth"
    return "number" if kinds & {"number", "integer"} else "text"


def _shown(value: Any, shape: Shape) -> str:
    """A value as its field shows it: text without quotes, a list with commas, all else as TOML writes it."""
    if isinstance(value, str):
        return value
    if isinstance(value, list) and value and shape != "any":
        plain = all(isinstance(one, str) and one == one.strip() and not set(one) & set(',[{"') and one for one in value)
        if plain and not any(_NUMBER.fullmatch(one) for one in value):
            return ", ".join(value)
        if all(isinstance(one, int | float) and not isinstance(one, bool) for one in value):
            return ", ".join(written(one) for one in value)
    return written(value)


def _read(text: str, shape: Shape, key: Key) -> Any:
    """What is written in a field as a value; what does not fit stays text, and the reader of the study refuses it."""
    if shape in ("face", "list", "some", "any", "number") and text[0] in "[{":
        try:
            return toml(f"a = {text}")["a"]
        except ValueError:
            raise InputError(
                f"{text} is not a list or table as TOML writes it, such as {key.kind or '[1, 2]'}"
            ) from None
    if shape == "truth" or (shape == "any" and text in ("true", "false")):
        return {"true": True, "false": False}.get(text, text)
    if shape in ("number", "any"):
        return _number(text)
    if shape in ("list", "some"):
        items = [_number(one.strip()) if _of_numbers(key) else one.strip() for one in text.split(",") if one.strip()]
        return items if shape == "list" or len(items) > 1 else items[0]
    return text


def _of_numbers(key: Key) -> bool:
    """Whether a list holds plain numbers."""
    items = [way["items"] for way in _ways(key.schema) if "items" in way]
    return any(_kind(way) in ("number", "integer") for item in items for way in _ways(item))


def _kind(way: Mapping[str, Any]) -> str:
    """The type of a schema, or the name of the definition that it refers to."""
    return str(way.get("type", way.get("$ref", "").rpartition("/")[2] or ("enum" if "enum" in way else "")))


def _number(text: str) -> int | float | str:
    if not _NUMBER.fullmatch(text):
        return text
    try:
        return int(text)
    except ValueError:
        return float(text)
