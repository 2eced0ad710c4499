"""Short texts of objects, for a console and for a notebook, and trees as JSON."""

import csv
import io
import json
import re
from collections.abc import Iterable, Mapping, Sequence, Sized
from math import isfinite
from textwrap import shorten
from typing import Any

from faying.typing import Index

MAX_NAMES = 6
# a dotted name of forty keys: a study nests four deep, and the parser's memory grows with their square
KEY = r"""(?:[\w-]++|"(?:[^"\\\n]|\\.)*+"|'[^'\n]*+')"""
DEEP = re.compile(rf"(?:^[ \t]*+\[{{0,2}}|[{{,])[ \t]*+(?:{KEY}[ \t]*+\.[ \t]*+){{40}}", re.MULTILINE)


def toml(text: str) -> dict[str, Any]:
    """The tables of a TOML text. Raises ValueError where it is not TOML, or nests deeper than any study."""
    import tomllib

    deep = DEEP.search(text)
    try:
        if deep is not None:
            raise RecursionError
        return tomllib.loads(text)
    except RecursionError:
        line = "" if deep is None else f" (at line {text.count(chr(10), 0, deep.start()) + 1})"
        raise ValueError(f"tables or brackets are nested too deep{line}") from None


def listed(names: Iterable[str], most: int = MAX_NAMES) -> str:
    """Names with commas; how many more there are, where they are many."""
    every = list(names)
    return ", ".join(every[:most]) + (f" and {len(every) - most} more" if len(every) > most else "")


def cut(text: str, most: int = 100) -> str:
    """A text on one line, its end left out where it is long."""
    return shorten(text, most, placeholder=" ...")


def notes_row(notes: Sized) -> dict[str, str]:
    """The row of a summary that says how many notes there are; none without notes."""
    return {"notes": f"{len(notes)}, in .notes"} if len(notes) else {}


def titled(kind: str, name: str) -> str:
    """What a thing is and its name, the former once: "joint 1", "joint flange"."""
    return name if kind in name.lower() else f"{kind} {name}"


def json_text(tree: Any) -> str:
    """A tree as JSON, indented; numbers that are not finite, which JSON does not know, become null."""
    return json.dumps(finite(tree), indent=2, allow_nan=False)


def in_columns(*columns: tuple[str, Iterable[Any], str]) -> list[list[str]]:
    """Rows of text, the heads first, from columns: head, values, format; a dash stands for NaN."""
    heads = [head for head, _, _ in columns]
    cells = [[or_dash(value, form) for value in values] for _, values, form in columns]
    return [heads, *map(list, zip(*cells, strict=True))]


def or_dash(value: Any, form: str) -> str:
    """A value in a format; a dash stands for NaN."""
    return "-" if value != value else format(value, form)


def csv_text(rows: Iterable[Sequence[Any]]) -> str:
    """Rows as CSV, the heads first."""
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(rows)
    return out.getvalue()


def finite(tree: Any) -> Any:
    """A tree of lists and tables with None in place of numbers that are not finite."""
    if isinstance(tree, Mapping):
        return {name: finite(value) for name, value in tree.items()}
    if isinstance(tree, list | tuple):
        return [finite(value) for value in tree]
    return None if isinstance(tree, float) and not isfinite(tree) else tree


def few(items: Sequence[object] | Index, most: int = 5) -> str:
    """The first of some numbers or names, as text; dots stand for the others."""
    return ", ".join(map(str, items[:most])) + (", ..." if len(items) > most else "")
