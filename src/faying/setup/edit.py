"""One key of a study's text changed, every other line left as it is; where the keys stand in it."""

import json
import re
import tomllib
from collections.abc import Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass
from typing import Any

from faying.errors import InputError
from faying.text import toml

KeyPath = tuple[str | int, ...]

_KEY = re.compile(r'\s*(?:"((?:[^"\\\n]|\\.)*)"|\'([^\'\n]*)\'|([A-Za-z0-9_-]+))\s*')


def line_of_fault(fault: Exception, text: str) -> int | None:
    """The line, from 1, at which a text stops being TOML, from what the parser says of it; None where it says none."""
    at = re.search(r"at line (\d+)", str(fault))
    if at:
        return int(at[1])
    return text.count("\n") + 1 if "end of document" in str(fault) else None


@dataclass(frozen=True, kw_only=True)
class Statement:
    """One statement of a TOML text: a key with its value, or the head of a table.

    Args:
        path: names of the tables and the key; the place of an element in a list of tables, from 0, behind its name.
        is_head: whether it is the head of a table.
        line: on which it begins, from 1.
        start, end: where its first line begins, and where the line behind its last one begins.
        value, value_end: where the value begins and ends; the end of the head of a table.
    """

    path: KeyPath
    is_head: bool
    line: int
    start: int
    value: int
    value_end: int
    end: int


def statements(text: str) -> Iterator[Statement]:
    """The statements of a TOML text in their order; of text that is not TOML, those that were understood."""
    counts: dict[KeyPath, int] = {}
    table: KeyPath = ()
    at = 0
    while at < len(text):
        if text[at] in " \t\r\n":
            at += 1
            continue
        if text[at] == "#":
            at = _end_of_line(text, at)
            continue
        line, start = text.count("\n", 0, at) + 1, text.rfind("\n", 0, at) + 1
        double = text.startswith("[[", at)
        is_head = text[at] == "["
        keys, end = _path(text, at + is_head + double)
        if not keys or not (is_head or text.startswith("=", end)):
            return
        if is_head:
            table = _resolved(keys, counts, new=double)
            value = value_end = end + 1 + double
            at = _end_of_line(text, end)
        else:
            value, value_end, at = _value(text, end + 1)
        path = table if is_head else (*table, *keys)
        yield Statement(path=path, is_head=is_head, line=line, start=start, value=value, value_end=value_end, end=at)


def name_of(path: KeyPath) -> str:
    """A path as messages write it: `bolt[2].preload`."""
    return "".join(f"[{one + 1}]" if isinstance(one, int) else f".{one}" for one in path).removeprefix(".")


def lines_of(text: str) -> dict[str, int]:
    """The line, from 1, of every table and key of a TOML text, by its path.

    A path is written as messages write it: `bolt[2].preload`, `geometry.face.upper.joint`; names in quotes lose these.
    Keys within inline tables stand for themselves only where they are the first of their statement. Text that is not
    TOML gives what was understood up to there.
    """
    found: dict[str, int] = {}
    for one in statements(text):
        found.setdefault(name_of(one.path), one.line)
    return found


def line_of(key: str, found: Mapping[str, int]) -> int | None:
    """The line of a key, else that of the nearest table or statement that holds it; None where there is none.

    A single table [bolt] counts as bolt[1].
    """
    while key:
        for path in (key, key.replace("[1]", "")):
            if path in found:
                return found[path]
            inside = [line for one, line in found.items() if one.startswith((f"{path}.", f"{path}["))]
            if inside:  # a table that is named by those within it alone
                return min(inside)
        key = key[: max(key.rfind("."), key.rfind("["), 0)]
    return None


def key_of(fault: str, found: Mapping[str, int]) -> str:
    """The key that a fault begins with, "" where it begins with none.

    The longest path of the text, or of what a table of it may hold, that stands in front.
    """
    start = fault.removeprefix("[[").removeprefix("[")
    begun = [path for path in found if start.startswith(path) and not start[len(path) :][:1].isalnum()]
    longest = max(begun, key=len, default="")
    written = re.match(r"[A-Za-z_][\w-]*(?:\[\d+\])?(?:\.[A-Za-z_][\w-]*(?:\[\d+\])?)*", start)
    path = written[0] if written else ""
    if len(path) > len(longest) and line_of(path, found) is not None:
        return path
    return longest


def _path(text: str, at: int) -> tuple[list[str], int]:
    """A dotted key from a place on, and where it ends."""
    keys: list[str] = []
    while found := _KEY.match(text, at):
        quoted, literal, bare = found.groups()
        keys.append(_unescaped(quoted) if quoted is not None else literal if literal is not None else bare)
        at = found.end()
        if not text.startswith(".", at):
            break
        at += 1
    return keys, at


def _unescaped(text: str) -> str:
    """A text in double quotes without its escapes; as it is where these are none."""
    try:
        return str(tomllib.loads(f'a = "{text}"')["a"])
    except tomllib.TOMLDecodeError:
        return text


def _resolved(keys: list[str], counts: dict[KeyPath, int], *, new: bool) -> KeyPath:
    """The path of a table, with the places of those lists of tables that it lies in."""
    path: KeyPath = ()
    for k, key in enumerate(keys):
        path = (*path, key)
        if new and k == len(keys) - 1:
            counts[path] = counts.get(path, 0) + 1
        if path in counts:
            path = (*path, counts[path] - 1)
    return path


def _end_of_line(text: str, at: int) -> int:
    end = text.find("\n", at)
    return len(text) if end < 0 else end + 1


def _value(text: str, at: int) -> tuple[int, int, int]:
    """Where a value begins and ends, which may hold texts and comments over several lines, and where its line ends."""
    while at < len(text) and text[at] in " \t":
        at += 1
    end, depth = at, 0
    for piece in _PIECE.finditer(text, at):
        word = piece[0]
        if (word[0] == "#" or word == "\n") and depth <= 0:
            return at, end, piece.end()
        depth += (word in "[{") - (word in "]}")
        if word[0] not in "# \t\r\n":
            end = piece.end()
    return at, end, len(text)


# texts, of which those in three quotes hold line breaks; comments; all else letter by letter
_QUOTED = (r'"""(?:\\.|(?!""").)*+(?:""")?', r"'''(?:(?!''').)*+(?:''')?", r'"(?:\\.|[^"\\\n])*+"?', r"'[^'\n]*+'?")
_PIECE = re.compile(rf"{'|'.join(_QUOTED)}|#[^\n]*+\n?|.", re.DOTALL)
_BARE = re.compile(r"[A-Za-z0-9_-]+")
# comments by which `faying new` says where a value is from, or what follows from it
_OF_VALUE = re.compile(
    r"\A[ \t]*#[ \t]*(?:ASSUMED\b|drawn: |[\d.,]+ [mc]?m2(?:, [^\r\n]* apart)?[ \t\r]*$)[^\r\n]*"
    r"|\A([ \t]*# largest element):[^\r\n]*"
)
# comments right above a place, which are of what begins there
_ABOVE = re.compile(r"(?:^[ \t]*#[^\n]*\n)+\Z", re.MULTILINE)
_COMMENTS = re.compile(r"(?:[^\S\n]*+#[^\n]*+\n?)*+")
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
        line = f"{_key(str(path[-1]))} = {written(value)}"
        if first + 1 < end:
            return _below(text, every[end - 1], line)
        return _inserted(text, every[first].end if parent else _behind_comments(text, 0), f"{line}\n")
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
    found = _COMMENTS.match(text, at)
    end = at if found is None else found.end()
    return at if text[end : _end_of_line(text, end)].strip() else end
