"""A study with one thing changed: the path of a key, and what stands there instead."""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from difflib import get_close_matches
from typing import Any

from faying.errors import InputError
from faying.misuse import shortened
from faying.study.declaration.declared import NAME, Declared, Inner, Key
from faying.study.keys.tables import STUDY
from faying.text import toml


def with_value(data: Mapping[str, Any], path: str, value: Any) -> dict[str, Any]:
    """The tables of a study with another value at a path.

    Args:
        data: the tables, as TOML gives them.
        path: keys with dots between them, as `geometry.size`; in a list of tables for all entries, as `bolt.preload`,
            or for one by its name, as `bolt.left.preload`. A name with other signs than letters, digits, - and _ stands
            in quotes: `part."upper half".material`.
        value: text with a unit, or a number or several in SI units; a mapping for a table; None takes the key out.

    Raises:
        InputError: the path leads nowhere, with what there is.
    """
    out = deepcopy(dict(data))
    _set(out, STUDY, _parts(path), value, path)
    return out


def _parts(path: str) -> list[str]:
    wrong = InputError(f"path = {shortened(path)} should be keys with dots between them, such as bolt.preload")
    if "\n" in path:
        raise wrong
    try:
        table: Any = toml(f"{path} = 0")
    except ValueError:
        raise wrong from None
    parts = []
    while isinstance(table, dict):
        ((name, table),) = table.items()
        parts.append(name)
    return parts


def _set(table: dict[str, Any], keys: Declared, parts: Sequence[str], value: Any, path: str) -> None:
    """Set a value in a table, or in one within it."""
    name, rest = parts[0], parts[1:]
    what = keys.get(name) or keys.get(NAME)
    if what is None:
        near = get_close_matches(name, keys, n=1)
        hint = f"did you mean {near[0]}?" if near else f"give one of {', '.join(keys)}"
        raise InputError(f'"{path}" is not a key of a study: {name!r}; {hint}')
    if not rest:
        if value is None:
            table.pop(name, None)
        else:
            table[name] = _written(what, value)
    elif isinstance(what, Key):
        raise InputError(f'"{path}": {name} has no other keys; leave out {".".join(rest)}')
    elif what.many:
        _set_in_list(table, what, parts, value, path)
    else:
        of_laws = {key: one for found in what.models().values() for key, one in found.items()}
        _set(table.setdefault(name, {}), {**what.keys, **of_laws}, rest, value, path)


def _set_in_list(table: dict[str, Any], what: Inner, parts: Sequence[str], value: Any, path: str) -> None:
    """Set a value in all tables of a list, or in the one that the next part names."""
    name, rest = parts[0], parts[1:]
    found = table.get(name, [])
    every = [found] if isinstance(found, dict) else found
    if not every:
        raise InputError(f'"{path}": the study has no [[{name}]]')
    chosen = every
    if rest[0] not in what.keys:
        names = [one.get("name", f"{name} {k}") for k, one in enumerate(every, start=1)]
        chosen, rest = [one for one, own in zip(every, names, strict=True) if own == rest[0]], rest[1:]
        if not chosen:
            near = get_close_matches(parts[1], what.keys, n=1)
            hint = f"; did you mean {near[0]}?" if near else ""
            raise InputError(f'"{path}": no {name} is called {parts[1]!r}; give one of {", ".join(names)}{hint}')
        if not rest:
            raise InputError(f'"{path}" is a {name}, not a key; add one of its keys: {", ".join(what.keys)}')
    for one in chosen:
        _set(one, what.keys, rest, value, path)


def _written(what: Key | Inner, value: Any) -> Any:
    """A value as a study file has it: numbers of a quantity get their unit."""
    if isinstance(what, Inner):
        return deepcopy(value)
    if isinstance(value, list | tuple):
        return [_written(what, one) for one in value]
    if isinstance(value, Mapping):
        return {key: _written(what, one) for key, one in value.items()}
    if hasattr(value, "item"):  # of numpy
        value = value.item()
    if what.unit and isinstance(value, int | float) and not isinstance(value, bool):
        return f"{value!r} {what.unit}"
    return value


def change_line(path: str, value: Any) -> str:
    """A comment that says what was changed, for the text that a result keeps."""
    return f"# changed in Python: {path} = {shortened(value)}"
