"""Tables of numbers as text: headings with names and units, CSV files under one, and rows of numbers alone."""

import csv
import re
import warnings
from collections.abc import Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from faying import checks
from faying.errors import InputError, ReadError
from faying.files import LATIN, refuse_decimal_comma
from faying.memory import require
from faying.typing import Array
from faying.units import scale

LINE_MEMORY = 450  # B of a line of numbers beside its text while a table is read line by line, measured


MARKS = ("\t", ";", ",")
_BRACKETS = re.compile(r"(.*?)(?:\[(.{0,99})\]|\((.{0,99})\))\s*")  # no unit is longer
_LEVEL = re.compile(r"([^\[(]*?)\s*\b(dB\b.*)", re.IGNORECASE)  # decibels, with a reference in brackets or without
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
    level = _LEVEL.fullmatch(text)
    if level is not None:
        return Cell(text=text, name=_name(level[1].rstrip("/ ")), unit=plain_unit(level[2]))
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
    text = text.replace("Â", "")  # UTF-8 that was read as Latin-1
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
    return any(is_unit(text, unit) for text in in_brackets(line) for unit in units)


def in_brackets(line: str) -> list[str]:
    """What stands in each pair of brackets of a line."""
    inner = [a or b for a, b in re.findall(r"\[([^\]]*)\]|\(([^)]*)\)", line)]
    return [text for text in inner if text.strip()]


def row_of_units(cells: Sequence[Cell], units: Sequence[str]) -> tuple[str, ...] | None:
    """Return the units of a line that holds one for each column and nothing else, None for another line."""
    if len(cells) != len(units):
        return None
    given = tuple(plain_unit(one.text.strip(" []()")) for one in cells)
    return given if all(is_unit(text, unit) for text, unit in zip(given, units, strict=True)) else None


@dataclass(frozen=True, kw_only=True)
class Columns:
    """SI arrays by name; lines: number of the head's line and of each row's; factors from the file's units to SI."""

    values: Mapping[str, Array]
    head: int
    lines: list[int]
    factors: Mapping[str, float]

    def given(self, name: str, row: int) -> str:
        """A value as the file gives it, in its unit."""
        return f"{self.values[name][row] / self.factors[name]:g}"


def read_columns(
    path: Path,
    known: Mapping[str, str],
    *,
    needed: str | tuple[str, ...],
    form: str,
    examples: Mapping[str, str] | None = None,
    passed_over: Collection[str] = (),
) -> Columns:
    """Read the columns of a CSV file with a head such as `pressure [MPa],k_n [MPa/um]`; names in any order and case.

    Args:
        path: the file; lines from # on are comments.
        known: SI unit by the name of each column that may stand in it; "" for a plain number, "1" for one that may
            be given in percent.
        needed: the column, or columns, without which there is no table.
        form: what the file should look like, for messages.
        examples: a unit that a user would write, by SI unit.
        passed_over: names of columns that are not read.

    Raises:
        ReadError: with the file and the line.
    """
    try:
        hold_table(checks.path(path, "path"))
        text = path.read_text(encoding="utf-8-sig", errors=LATIN)
    except (OSError, UnicodeDecodeError) as fault:
        raise ReadError(f"{path}: cannot be read as text ({fault})") from None
    lines = [(i, bare) for i, line in enumerate(text.splitlines(), start=1) if (bare := line.partition("#")[0].strip())]
    if not lines:
        raise ReadError(f"{path}: the head is empty; {form}")
    (first, head), *body = lines
    mark = mark_of(head) or ","
    if mark != ",":
        for number, line in lines:
            refuse_decimal_comma(line, f"{path}, line {number}")
    if _is_number(_cells(head, mark)[0]):
        raise ReadError(f"{path}, line {first}: no head with the names of the columns; {form}")
    where = f"{path}, line {first}"
    reader = _Head(known=known, passed_over=passed_over, form=form, examples=examples or {}, where=where)
    columns = [reader.column(one) for one in _cells(head, mark)]
    names = [name for name, _ in columns]
    for name in names:
        if names.count(name) > 1:
            raise ReadError(f'{path}, line {first}: {names.count(name)} columns are called "{name}"; leave one')
    for name in (needed,) if isinstance(needed, str) else needed:
        if name not in names:
            shown = f"{name} [unit]" if known[name] else name
            raise ReadError(f'{path}, line {first}: no column "{shown}"; the head is {head}')
    quick = None
    if body and not set(names) & set(passed_over):
        quick = table_in_one_go(path, len(names), delimiter=mark, skip=first, comments="#")
    if quick is not None and len(quick) == len(body):
        values = dict(zip(names, quick.T, strict=True))
    else:
        rows = [_row(_cells(line, mark), names, passed_over, f"{path}, line {number}", form) for number, line in body]
        values = {name: np.array([row[name] for row in rows]) for name in names if name in known}
    found = {name: factor * values[name] for name, factor in columns if name in known}
    for name, column in found.items():
        damaged = _too_large(column, known[name])
        if damaged is not None:
            raise ReadError(
                f'{path}, line {body[damaged][0]}: {column[damaged]:.3g} {known[name]} in the column "{name}" is '
                "damaged: nothing measured is so large"
            )
    return Columns(values=found, head=first, lines=[number for number, _ in body], factors=dict(columns))


GREATEST_LENGTH, GREATEST = 1e4, 1e15  # m; in any other SI unit


def _too_large(column: Array, unit: str) -> int | None:
    """Index of a number that is larger than anything measured; None where there is none, and for plain numbers."""
    if not unit:
        return None
    found = np.flatnonzero(np.abs(column) > (GREATEST_LENGTH if unit == "m" else GREATEST))
    return int(found[0]) if found.size else None


@dataclass(frozen=True, kw_only=True)
class _Head:
    """What the cells of a head may say; arguments as of `read_columns`, where: file and line."""

    known: Mapping[str, str]
    passed_over: Collection[str]
    form: str
    examples: Mapping[str, str]
    where: str

    def column(self, text: str) -> tuple[str, float]:
        """Name and factor to SI of one cell."""
        part = cell(text)
        names = {name.lower().replace("_", " "): name for name in (*self.known, *self.passed_over)}
        name, unit = names.get(part.name), part.unit
        if name is None:
            raise ReadError(
                f'{self.where}: the column "{text}" is unknown; the known ones are {", ".join(self.known)}; {self.form}'
            )
        if name not in self.known:
            return name, 1.0
        wanted = self.known[name]
        if wanted in ("", "1") and unit in ("", "-", "1"):
            return name, 1.0
        if not wanted:
            raise ReadError(f'{self.where}: the column "{text}" has no unit; give plain numbers under "{name}"')
        example = f'write for example "{name} [{self.examples.get(wanted, wanted)}]"'
        if not unit:
            raise ReadError(f'{self.where}: the column "{text}" lacks its unit; {example}')
        try:
            return name, scale(unit, wanted)
        except InputError:
            raise ReadError(
                f'{self.where}: "{unit}" of the column "{text}" is not a unit like {wanted}; {example}'
            ) from None


def _cells(line: str, mark: str) -> list[str]:
    """The cells of one line, without blanks and quotation marks around them."""
    return [word.strip() for word in next(csv.reader([line], delimiter=mark, skipinitialspace=True))]


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _row(cells: list[str], names: list[str], passed_over: Collection[str], where: str, form: str) -> dict[str, float]:
    """The numbers of one line by the names of their columns."""
    if len(cells) > len(names):
        raise ReadError(f"{where}: {len(cells)} values under the {len(names)} columns of the head; {form}")
    row = {}
    for i, name in enumerate(names):
        if name in passed_over:
            continue
        word = cells[i] if i < len(cells) else ""
        if not word:
            raise ReadError(f'{where}: no value in the column "{name}"; give one, or leave the row out')
        try:
            value = row[name] = float(word)
        except ValueError:
            raise ReadError(f'{where}: "{word}" in the column "{name}" is not a number') from None
        if not isfinite(value):
            raise ReadError(f'{where}: "{word}" in the column "{name}" is not a finite number; leave the row out')
    return row


def hold_table(path: Path) -> None:
    """Raise InputError where the numbers of a text file do not fit into the free memory while they are read."""
    size = path.stat().st_size
    text = f"{path}: {size / 1e6:.3g} MB of numbers"
    require(3 * size + LINE_MEMORY * line_count(path), text, "leave out rows and columns that are not needed")


def line_count(path: Path) -> float:
    """About how many lines a text file has, as long as its first ones."""
    with path.open("rb") as handle:
        some = [len(line) for line in handle.readlines(65536)]
    return path.stat().st_size * len(some) / max(sum(some), 1)


def table_in_one_go(path: Path, columns: int, *, delimiter: str | None, skip: int, comments: str | None) -> Any:
    """All rows (n, columns) of a text file below its first `skip` lines, as an array.

    delimiter: between the numbers, None for blanks. None where not every line is so many finite numbers: who reads
    line by line can say which one.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            table = np.loadtxt(
                path, delimiter=delimiter, comments=comments, skiprows=skip, ndmin=2, encoding="utf-8-sig"
            )
    except (ValueError, Warning):
        return None
    return table if table.shape[1] == columns and np.isfinite(table).all() else None


def _in_one_go(path: Path, columns: int) -> Any:
    """What `read_numbers` reads, where every line from the first row on is one; else None."""
    with path.open(encoding="utf-8-sig", errors=LATIN) as handle:
        for skip, line in enumerate(handle):
            text = line.split("#")[0]
            refuse_decimal_comma(text, f"{path.name}, line {skip + 1}")
            if len(_numbers(text)) == columns:
                delimiter = next((mark for mark in ";," if mark in text), None)
                return table_in_one_go(path, columns, delimiter=delimiter, skip=skip, comments="#")
    return None


def _numbers(text: str) -> list[float]:
    """The numbers of a line, with commas, semicolons or blanks between; none where a word is not a number."""
    try:
        return [float(word) for word in text.replace(",", " ").replace(";", " ").split()]
    except ValueError:
        return []


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """A column of a list of numbers: its names in a heading (the first is the usual one), its SI unit ("" for plain
    numbers), the unit that the caller gives (text, or None), and how the caller gives it, for messages."""

    names: tuple[str, ...]
    unit: str
    given: str | None
    key: str

    def factor(self, cell: Cell | None, where: str) -> float:
        """SI units in one of the column's. InputError where nothing states the unit, or two state different ones."""
        name = self.names[0]
        if not self.unit:
            return 1.0
        own = None if self.given is None else scale(self.given, self.unit, name=self.key)
        if cell is None or not cell.unit:
            if own is None:
                raise InputError(
                    f'{where} states no unit of {name}; give {self.key}, or write it in a heading: "{name} [um]"'
                )
            return own
        try:
            stated = scale(cell.unit, self.unit)
        except InputError:
            raise ReadError(
                f'{where}: the column "{cell.text}" is not in a unit like {self.unit}; write for example "{name} [um]"'
            ) from None
        if own is not None and abs(own / stated - 1) > 1e-9:
            raise InputError(
                f'{where}: the heading says "{cell.text}" and {self.key} = "{self.given}"; '
                f"leave out {self.key}, or correct the heading"
            )
        return stated


def read_list(path: Path, wanted: Sequence[Wanted], form: str) -> Any:
    """Read a list of numbers, as many in a row as there are wanted columns, in the order of its heading.

    A heading names the columns, in any order, and may state their units; it stands on the last line above the numbers,
    maybe as a comment, maybe with the units on a line of their own. Without one the columns have the wanted order.

    Args:
        path: the file; numbers stand between commas, semicolons, tabs or blanks, comments begin with #.
        wanted: the columns.
        form: what the file should look like, for messages.

    Returns:
        Array (rows, len(wanted)) in SI units, in the wanted order.

    Raises:
        ReadError: for a heading with other columns, words about units that are not read, or rows that are not numbers.
        InputError: where a unit is stated by nobody, or differently by the heading and by the caller.
    """
    heading, where = _heading(path, wanted, form)
    table = read_numbers(path, len(wanted), form)
    endless = np.flatnonzero(np.isinf(table).any(axis=1))
    if endless.size:
        raise ReadError(f"{path.name}: row {endless[0] + 1} of the numbers has an infinite one; {form}")
    columns = []
    for k, column in enumerate(wanted):
        place = k if heading is None else next(i for i, one in enumerate(heading) if one.name in column.names)
        values = table[:, place] * column.factor(None if heading is None else heading[place], where)
        damaged = _too_large(values, column.unit)
        if damaged is not None:
            raise ReadError(
                f"{path.name}: row {damaged + 1} of the numbers holds {values[damaged]:.3g} {column.unit}, which is "
                "damaged: nothing measured is so large"
            )
        columns.append(values)
    return np.stack(columns, axis=1)


def _heading(path: Path, wanted: Sequence[Wanted], form: str) -> tuple[tuple[Cell, ...] | None, str]:
    """The heading of a list and where it stands; None and the file's name where there is none."""
    above = _above(path)
    units = [column.unit for column in wanted]
    plain = [k for k, (_, line) in enumerate(above) if not line.startswith("#")]
    heading, where, taken = None, path.name, set()
    if plain:
        number, line = above[plain[-1]]
        cells, where = split_heading(line), f"{path.name}, line {number}"
        own = row_of_units(cells, units) if len(plain) > 1 else None
        taken = {number}
        if own is not None:
            number, line = above[plain[-2]]
            cells = tuple(
                Cell(text=f"{one.text} [{unit}]", name=one.name, unit=unit)
                for one, unit in zip(split_heading(line), own, strict=False)
            )
            taken.add(number)
        known = {name for column in wanted for name in column.names}
        if own or len(cells) == len(wanted) or mark_of(line) or known & {one.name for one in cells}:
            heading = _matched(cells, wanted, where, form)
    else:
        for number, line in reversed(above):
            cells = split_heading(line.lstrip("# "))
            if all(sum(one.name in column.names for one in cells) == 1 for column in wanted):
                where, taken = f"{path.name}, line {number}", {number}
                heading = _matched(cells, wanted, where, form)
                break
    for number, line in above:
        if number not in taken and heading is None and states_unit(line, {unit for unit in units if unit}):
            raise ReadError(
                f'{path.name}, line {number}: "{line.strip()[:80]}" mentions units in words that Faying does not '
                f"read; write one heading with names and units above the numbers, or take the line out; {form}"
            )
    return heading, where if heading is not None else path.name


def _above(path: Path) -> list[tuple[int, str]]:
    """The lines above the first row of numbers, with their numbers; blank ones left out."""
    out: list[tuple[int, str]] = []
    with path.open(encoding="utf-8-sig", errors=LATIN) as handle:
        for number, line in enumerate(handle, start=1):
            if len(_numbers(line.split("#")[0])) > 1:
                return out
            if line.strip(" \t\r\n#,;"):
                out.append((number, line.strip()))
    return []  # no numbers at all, which `read_numbers` says


def _matched(cells: Sequence[Cell], wanted: Sequence[Wanted], where: str, form: str) -> tuple[Cell, ...]:
    """The cells where each is one wanted column. ReadError otherwise."""
    names = [next((column.names[0] for column in wanted if one.name in column.names), None) for one in cells]
    if None in names or len(set(names)) < len(wanted) or len(names) != len(wanted):
        odd = next((one.text for one, name in zip(cells, names, strict=True) if name is None), None)
        shown = ", ".join(f'"{one.text}"' for one in cells)[:120]
        raise ReadError(
            f"{where}: the heading has the columns {shown}"
            + (f', of which "{odd}" is unknown' if odd is not None else "")
            + f"; give {', '.join(column.names[0] for column in wanted)}, or write # before a line of words; {form}"
        )
    return tuple(cells)


def read_numbers(path: Path, columns: int, form: str) -> Any:
    """Read rows of `columns` numbers, with commas, semicolons or blanks between; lines of text may stand at the top.

    Returns an array (rows, columns); comments begin with #. Raises ReadError, with `form` as what was expected, where
    no such row is found or a later line is not one.
    """
    hold_table(path)
    table = _in_one_go(path, columns)
    if table is not None:
        return table
    rows: list[list[float]] = []
    for number, line in enumerate(path.read_text(encoding="utf-8-sig", errors=LATIN).splitlines(), start=1):
        text = line.split("#")[0]
        refuse_decimal_comma(text, f"{path.name}, line {number}")
        if not text.replace(",", " ").replace(";", " ").split():
            continue
        row = _numbers(text)
        if len(row) == columns:
            rows.append(row)
        elif rows:
            raise ReadError(f"{path.name}, line {number}: {line.strip()[:60]!r} is not {columns} numbers; {form}")
    if not rows:
        raise ReadError(f"{path.name} has no line of {columns} numbers; {form}")
    return np.array(rows)
