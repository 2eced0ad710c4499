"""Short texts of objects, for a console and for a notebook, and trees as JSON."""

import csv
import io
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from math import isfinite
from typing import Any

from faying.errors import ReadError
from faying.typing import Index

MOST_NAMES = 6


def listed(names: Iterable[str], most: int = MOST_NAMES) -> str:
    """Names with commas; how many more there are, where they are many."""
    every = list(names)
    return ", ".join(every[:most]) + (f" and {len(every) - most} more" if len(every) > most else "")


def titled(kind: str, name: str) -> str:
    """What a thing is and its name, the former once: "joint 1", "joint flange"."""
    return name if kind in name.lower() else f"{kind} {name}"


def json_text(tree: Any) -> str:
    """A tree as JSON, indented; numbers that are not finite, which JSON does not know, become null."""
    return json.dumps(finite(tree), indent=2, allow_nan=False)


def in_columns(*columns: tuple[str, Iterable[Any], str]) -> list[list[str]]:
    """Rows of text, the heads first, from columns: head, values, format; a dash stands for NaN."""
    heads = [head for head, _, _ in columns]
    cells = [["-" if value != value else format(value, form) for value in values] for _, values, form in columns]
    return [heads, *map(list, zip(*cells, strict=True))]


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


MERGED = re.compile(r" {4}-1[^\d\s.,eEdD+-]")  # a mark with something else in place of the end of the line
MOST_LINES = {"151": (7, "a header"), "164": (3, "units")}  # of data sets that all have the same
NUMBERS = (15, 18, 55, 56, 58, 82, 151, 164, 780, 781, 1858, 2411, 2412, 2414, 2420, 2429, 2430, 2432, 2435, 2452, 2467)


def _begins(line: str) -> bool:
    """Whether a line is the number of a data set that is known, as it stands after its mark: in six columns."""
    return len(line.rstrip()) == 6 and line.strip().isdigit() and int(line) in NUMBERS


def check_data_sets(lines: Sequence[str], where: str) -> None:
    """Raise ReadError unless all lines of a universal file stand in data sets: -1, a number, data, -1.

    A mark that is missing, or is there twice, would hide the data sets on both sides of it.
    """
    inside, begun = False, False
    held, left = "", 0  # a data set whose number of lines is known, and how many it may still have
    for number, line in enumerate(lines, 1):
        text = line.strip(" \t\r\n\x00\x1a")
        if text == "-1" and not begun:
            inside, begun = not inside, not inside
        elif begun:
            begun, held = False, text
            left = MOST_LINES.get(text, (0, ""))[0]
            if not re.match(r"\s*\d{1,6}b?(?:\s|$)", text) or not line[:6].strip().isdigit():  # in six columns
                raise ReadError(
                    f"{where}, line {number}: {text[:40]!r} is not the number of a data set, which follows on -1; is "
                    "the file damaged, or a line -1 too much or too few?"
                )
        elif inside and held in MOST_LINES and left == 0:
            most, what = MOST_LINES[held]
            raise ReadError(
                f"{where}, line {number}: {text[:40]!r} is one line too many for {what} (data set {held}), which has "
                f"{most}; are marks of the next data set missing?"
            )
        elif inside and (MERGED.match(line) or _begins(line)):
            raise ReadError(
                f"{where}, line {number}: {text[:40]!r} is inside a data set and looks like the beginning of "
                "another; is a line -1 missing or damaged before it?"
            )
        elif inside and held in MOST_LINES:
            left -= 1
        elif text and not inside:
            raise ReadError(
                f"{where}, line {number}: {text[:40]!r} is between two data sets; is a line -1 missing before it?"
            )
