"""The line above a table: names of columns and their units, as instruments and people write them."""

import csv
import re
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import dataclass

from faying.errors import InputError
from faying.units import scale

MARKS = ("\t", ";", ",")
_BRACKETS = re.compile(r"(.*?)\s*(?:\[(.*)\]|\((.*)\))\s*")
_WORD = re.compile(r"[^\s\[(]+(?:\s*(?:\[[^\]]*\]|\([^)]*\)))?")
_SIGNS = (("µ", "u"), ("μ", "u"), ("°", "deg"), ("²", "^2"), ("\ufffd", "^2"), ("**", "^"), ("·", "*"), ("⋅", "*"))


@dataclass(frozen=True, kw_only=True)
class Cell:
    """One column's place in a heading: the text as it stands, the name in small letters, the unit ("" without one)."""

    text: str
    name: str
    unit: str


def mark_of(line: str) -> str | None:
    """What stands between the columns of a line: a tab, a semicolon, a comma, or None for blanks."""
    return next((mark for mark in MARKS if mark in line), None)


def split_heading(line: str) -> tuple[Cell, ...]:
    """Take a heading apart, such as "x [mm], y [mm]", "Frequency (Hz);Phase (deg)" or "x/mm y/mm"."""
    bare = line.strip()
    mark = mark_of(bare)
    if mark is None:
        words = _WORD.findall(bare)
    else:
        words = [word.strip() for word in next(csv.reader([bare], delimiter=mark, skipinitialspace=True))]
        while len(words) > 1 and not words[-1]:
            words.pop()
    return tuple(cell(word) for word in words)


def cell(text: str) -> Cell:
    """Take one column's text apart into name and unit."""
    found = _BRACKETS.fullmatch(text)
    if found is not None:
        return Cell(text=text, name=_name(found[1]), unit=plain_unit(found[2] or found[3] or ""))
    name, slash, unit = text.partition("/")
    if slash and name.strip() and unit.strip():
        return Cell(text=text, name=_name(name), unit=plain_unit(unit))
    return Cell(text=text, name=_name(text), unit="")


def _name(text: str) -> str:
    return " ".join(text.replace("_", " ").lower().split())


def plain_unit(text: str) -> str:
    """Return the name of a unit in the signs that `units` reads."""
    for sign, plain in _SIGNS:
        text = text.replace(sign, plain)
    return text.strip()


def is_unit(text: str, unit: str) -> bool:
    """Whether a text is the name of a unit like the SI `unit`; g is gravity where that is an acceleration."""
    plain = re.sub(r"^[gG]\b", "g_0", plain_unit(text)) if unit.startswith("m/s^2") else plain_unit(text)
    with suppress(InputError):
        scale(plain, unit)
        return True
    return False


def states_unit(line: str, units: Iterable[str]) -> bool:
    """Whether a line of text speaks of a unit: the word itself, or one like those of `units` (SI) in brackets."""
    if re.search(r"\bunits?\b|\beinheit", line, re.IGNORECASE):
        return True
    inner = [a or b for a, b in re.findall(r"\[([^\]]*)\]|\(([^)]*)\)", line)]
    return any(is_unit(text, unit) for text in inner if text.strip() for unit in units)


def row_of_units(cells: Sequence[Cell], units: Sequence[str]) -> tuple[str, ...] | None:
    """Return the units of a line that holds one for each column and nothing else, None for another line."""
    if len(cells) != len(units):
        return None
    given = tuple(plain_unit(one.text.strip(" []()")) for one in cells)
    return given if all(is_unit(text, unit) for text, unit in zip(given, units, strict=True)) else None
