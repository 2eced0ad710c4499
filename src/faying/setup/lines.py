"""On which line of a study's text a key stands."""

import re
from collections.abc import Mapping

_KEY = re.compile(r'\s*(?:"((?:[^"\\\n]|\\.)*)"|\'([^\'\n]*)\'|([A-Za-z0-9_-]+))\s*')


def line_of_fault(fault: Exception, text: str) -> int | None:
    """The line, from 1, at which a text stops being TOML, from what the parser says of it; None where it says none."""
    at = re.search(r"at line (\d+)", str(fault))
    if at:
        return int(at[1])
    return text.count("\n") + 1 if "end of document" in str(fault) else None


def lines_of(text: str) -> dict[str, int]:
    """The line, from 1, of every table and key of a TOML text, by its path.

    A path is written as messages write it: `bolt[2].preload`, `geometry.face.upper.joint`; names in quotes lose these.
    Keys within inline tables stand for themselves only where they are the first of their statement. Text that is not
    TOML gives what was understood up to there.
    """
    found: dict[str, int] = {}
    counts: dict[str, int] = {}
    table, at = "", 0
    while at < len(text):
        if text[at] in " \t\r\n":
            at += 1
            continue
        if text[at] == "#":
            at = _end_of_line(text, at)
            continue
        line = text.count("\n", 0, at) + 1
        double = text.startswith("[[", at)
        if text[at] == "[":
            keys, end = _path(text, at + 1 + double)
            if not keys:
                break
            table = _resolved(keys, counts, new=double)
            found.setdefault(table, line)
            at = _end_of_line(text, end)
            continue
        keys, end = _path(text, at)
        if not keys or not text.startswith("=", end):
            break
        key = ".".join(keys)
        found.setdefault(f"{table}.{key}" if table else key, line)
        at = _end_of_value(text, end + 1)
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
        key = re.sub(r"(?:\.[^.\[\]]*|\[\d+\]|^[^.\[\]]*)$", "", key)
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
        keys.append(next(part for part in found.groups() if part is not None))
        at = found.end()
        if not text.startswith(".", at):
            break
        at += 1
    return keys, at


def _resolved(keys: list[str], counts: dict[str, int], *, new: bool) -> str:
    """The path of a table, with the places of those lists of tables that it lies in."""
    path = ""
    for k, key in enumerate(keys):
        path = f"{path}.{key}" if path else key
        if new and k == len(keys) - 1:
            counts[path] = counts.get(path, 0) + 1
        if path in counts:
            path = f"{path}[{counts[path]}]"
    return path


def _end_of_line(text: str, at: int) -> int:
    end = text.find("\n", at)
    return len(text) if end < 0 else end + 1


def _end_of_value(text: str, at: int) -> int:
    """Where the line ends on which a value ends that may hold brackets, texts and comments over several lines."""
    depth = 0
    while at < len(text):
        letter = text[at]
        if letter in "\"'":
            at = _end_of_text(text, at)
            continue
        if letter == "#":
            at = _end_of_line(text, at) - 1
            if at < 0 or at >= len(text) or text[at] != "\n":
                return len(text)
            continue
        depth += (letter in "[{") - (letter in "]}")
        at += 1
        if letter == "\n" and depth <= 0:
            return at
    return at


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
