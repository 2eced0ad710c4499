"""One key of a study's text changed, every other line left as it is; what a comment says of the old value goes."""

import json
import re
from collections.abc import Iterator
from copy import deepcopy
from typing import Any

from faying.errors import InputError
from faying.setup.lines import KeyPath, Statement, name_of, statements
from faying.text import toml

_BARE = re.compile(r"[A-Za-z0-9_-]+")
# comments by which `faying new` says where a value is from, or what follows from it
_OF_VALUE = re.compile(
    r"\A[ \t]*#[ \t]*(?:ASSUMED\b|drawn: |[\d.,]+ [mc]?m2(?:, [^\r\n]* apart)?[ \t\r]*$)[^\r\n]*"
    r"|\A([ \t]*# largest element):[^\r\n]*"
)
_ABOVE = re.compile(
    r"(?:^[ \t]*#[^\n]*\n)+\Z", re.MULTILINE
)  # comments right above a place, which are of what begins there
_BLANK = re.compile(r"[ \t]*\r?\n")


def edited(text: str, path: KeyPath, value: Any) -> str:
    """Return a TOML text with one value set, added or taken out; all other lines stay as they are.

    Comments stay, too, but for those by which `faying new` says where the value was from, such as "ASSUMED", and those
    right above a table of a list that is taken out.

    Args:
        text: the study.
        path: names of the tables and the key, with the place from 0 behind the name of a list of tables; the place
            behind the last one adds a table.
        value: text, number, truth, list or table; None takes the key or the table out.

    Returns:
        The text. It reads as the old one with that one change, which is checked.

    Raises:
        InputError: the text is not TOML, has no such place, or writes the place in a way that cannot be changed alone.
    """
    data = parsed(text)
    wanted = _changed(data, path, value)
    new = _with_line_end(_edit(text, data, wanted, path, value))
    try:
        new.encode()
        found = toml(new)
    except ValueError:
        found = None
    if not any(_same(found, one) for one in (_without_empty(wanted, path) if value is None else [wanted])):
        raise InputError(f"{name_of(path)} is written in a way that cannot be changed alone; change it in the text")
    return new


def parsed(text: str) -> dict[str, Any]:
    """What a text says. Raises InputError where it is not TOML."""
    try:
        return toml(text)
    except ValueError as fault:
        raise InputError(f"the text is not TOML: {fault}; correct it first") from None


def written(value: Any) -> str:
    """A value as TOML writes it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, list | tuple):
        return "[" + ", ".join(written(one) for one in value) + "]"
    if isinstance(value, dict):
        inner = ", ".join(f"{_key(name)} = {written(one)}" for name, one in value.items())
        return f"{{ {inner} }}" if inner else "{}"
    return repr(value) if isinstance(value, int | float) else value.isoformat()


def _key(name: str) -> str:
    return name if _BARE.fullmatch(name) else written(name)


def _dotted(path: KeyPath) -> str:
    return ".".join(_key(one) for one in path if isinstance(one, str))


def _with_line_end(text: str) -> str:
    """The line ends of a text made all alike where its first one is of Windows."""
    if "\r\n" not in text[: text.find("\n") + 1]:
        return text
    return re.sub(r"(?<!\r)\n", "\r\n", text)


def _same(a: Any, b: Any) -> bool:
    """Whether two trees hold the same; 1 and 1.0 differ, a number that is none equals itself."""
    if isinstance(a, dict) and isinstance(b, dict):
        return a.keys() == b.keys() and all(_same(a[key], b[key]) for key in a)
    if isinstance(a, list) and isinstance(b, list):
        return len(a) == len(b) and all(map(_same, a, b))
    return type(a) is type(b) and (a == b or a != a)  # NaN is itself


def _changed(data: dict[str, Any], path: KeyPath, value: Any) -> dict[str, Any]:
    """The data with the change."""
    out = deepcopy(data)
    at: Any = out
    for k, one in enumerate(path):
        last = k == len(path) - 1
        if isinstance(one, str) and isinstance(at, dict):
            if last and value is None and one in at:
                del at[one]
            elif last and value is not None:
                at[one] = deepcopy(value)
            elif one not in at and value is not None:
                at[one] = [] if isinstance(path[k + 1], int) else {}
            elif one not in at:
                raise InputError(f"{name_of(path)} is not in the text")
        elif isinstance(one, int) and isinstance(at, list) and 0 <= one < len(at) + (value is not None):
            if last and value is None:
                del at[one]
                break
            at[one:] = [deepcopy(value) if last else at[one] if one < len(at) else {}, *at[one + 1 :]]
        else:
            raise InputError(f"{name_of(path)} has no place in the text; look at {name_of(path[:k])}")
        at = at[one] if not last else at
    return out


def _without_empty(data: dict[str, Any], path: KeyPath) -> Iterator[dict[str, Any]]:
    """The data, then without tables that a removal has left empty, from the inner one outwards: dotted keys and the
    heads of tables within them made these."""
    out = deepcopy(data)
    yield data
    for length in range(len(path) - 1, 0, -1):
        if isinstance(path[length - 1], int) or _at(out, path[:length]):
            return
        del _at(out, path[: length - 1])[path[length - 1]]
        yield deepcopy(out)


def _edit(text: str, data: dict[str, Any], wanted: dict[str, Any], path: KeyPath, value: Any) -> str:
    every = list(statements(text))
    holder = next((one for one in every if not one.is_head and one.path == path[: len(one.path)]), None)
    if holder is not None and holder.path != path:  # an inline table, or a list of them
        return _replaced(text, holder, _at(wanted, holder.path))
    if value is None:
        for one in reversed([one for one in every if one.path[: len(path)] == path]):
            above = _ABOVE.search(text, 0, one.start) if text.startswith("[[", one.start) else None
            text = text[: above.start() if above else one.start] + text[one.end :]
        return text
    if holder is not None:
        return _replaced(text, holder, value)
    if isinstance(value, dict):
        return _with_table(text, every, path, value)
    return _with_key(text, every, path, value)


def _at(data: Any, path: KeyPath) -> Any:
    for one in path:
        data = data[one]
    return data


def _replaced(text: str, one: Statement, value: Any) -> str:
    comment = _OF_VALUE.sub(r"\1", text[one.value_end : one.end], count=1)
    return text[: one.value] + written(value) + comment + text[one.end :]


def _with_key(text: str, every: list[Statement], path: KeyPath, value: Any) -> str:
    """A key that is new in its table, below the other keys there."""
    parent = path[:-1]
    heads = [k for k, one in enumerate(every) if one.is_head]
    if not parent or any(every[k].path == parent for k in heads):
        first = next((k for k in heads if every[k].path == parent), -1) if parent else -1
        end = next((k for k in heads if k > first), len(every))
        if first + 1 < end:
            return _below(text, every[end - 1], f"{_key(str(path[-1]))} = {written(value)}")
        if parent:
            return _inserted(text, every[first].end, f"{_key(str(path[-1]))} = {written(value)}\n")
        return _inserted(text, _behind_comments(text, 0), f"{_key(str(path[-1]))} = {written(value)}\n")
    outer: KeyPath = ()
    dotted: tuple[Statement, KeyPath] | None = None  # the table is written as a.b = ..., below the head of an outer one
    for one in every:
        if one.is_head:
            outer = one.path
        elif one.path[: len(parent)] == parent and len(outer) < len(parent):
            dotted = one, outer
    if dotted is not None:
        return _below(text, dotted[0], f"{_dotted(path[len(dotted[1]) :])} = {written(value)}")
    return _with_table(text, every, parent, {path[-1]: value})


def _below(text: str, one: Statement, line: str) -> str:
    """A line below a statement, as far in as that."""
    first = text[one.start : one.end]
    return _inserted(text, one.end, first[: len(first) - len(first.lstrip(" \t"))] + line + "\n")


def _inserted(text: str, at: int, lines: str) -> str:
    lead = "" if at == 0 or text[at - 1] == "\n" else "\n"
    return text[:at] + lead + lines + text[at:]


def _with_table(text: str, every: list[Statement], path: KeyPath, value: dict[Any, Any]) -> str:
    """A table that is new, behind what is nearest to it: its element of a list, its kin, or the end."""
    head = f"[[{_dotted(path)}]]" if isinstance(path[-1], int) else f"[{_dotted(path)}]"
    lines = "".join(f"{_key(name)} = {written(one)}\n" for name, one in value.items())
    at = len(text)
    for length in range(len(path) - 1, 0, -1):
        kin = [one for one in every if one.path[:length] == path[:length]]
        if kin:
            at = _behind_comments(text, kin[-1].end)
            break
    before = text[:at].rstrip(" \t")
    gap = "" if not before.strip() or before.endswith(("\n\n", "\n\r\n")) else "\n" if before.endswith("\n") else "\n\n"
    after = "" if at == len(text) or _BLANK.match(text, at) else "\n"
    return text[:at] + gap + head + "\n" + lines + after + text[at:]


def _behind_comments(text: str, at: int) -> int:
    """Behind the comments that follow up to a blank line; `at` where they lead to a statement."""
    here = at
    while here < len(text):
        end = text.find("\n", here) + 1 or len(text)
        line = text[here:end].strip()
        if not line:
            return here
        if not line.startswith("#"):
            return at
        here = end
    return here
