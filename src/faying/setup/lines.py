"""Where the keys of a study stand in its text."""

import re
import tomllib
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

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
    begin = end = at
    depth = 0
    while at < len(text):
        letter = text[at]
        if letter in "\"'":
            end = at = _end_of_text(text, at)
            continue
        if letter == "#":
            at = _end_of_line(text, at)
            if depth <= 0:
                return begin, end, at
            continue
        depth += (letter in "[{") - (letter in "]}")
        at += 1
        if letter == "\n" and depth <= 0:
            return begin, end, at
        if letter not in " \t\r\n":
            end = at
    return begin, end, at


def _end_of_text(text: str, at: int) -> int:
    """Behind a text in quotes; three of them hold line breaks."""
    mark = text[at] * 3 if text.startswith(text[at] * 3, at) else text[at]
    at += len(mark)
    while at < len(text):
        if mark[0] == '"' and text[at] == "\\":
            at += 2
        elif text.startswith(mark, at):
            return at + len(mark)
        elif len(mark) == 1 and text[at] == "\n":
            return at
        else:
            at += 1
    return at
