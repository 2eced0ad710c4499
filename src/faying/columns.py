"""Tables of numbers: CSV files whose head names each quantity and its unit, and rows of numbers alone."""

import csv
import warnings
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import InputError, ReadError
from faying.files import refuse_decimal_comma
from faying.memory import require
from faying.typing import Array
from faying.units import scale

LINE_MEMORY = 450  # B of a line of numbers beside its text while a table is read line by line, measured


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
    needed: str,
    form: str,
    examples: Mapping[str, str] | None = None,
    passed_over: Collection[str] = (),
) -> Columns:
    """Read the columns of a CSV file with a head such as `pressure [MPa],k_n [MPa/um]`.

    Args:
        path: the file; lines from # on are comments.
        known: SI unit by the name of each column that may stand in it; "" for a plain number, "1" for one that may
            be given in percent.
        needed: the column without which there is no table.
        form: what the file should look like, for messages.
        examples: a unit that a user would write, by SI unit.
        passed_over: names of columns that are not read.

    Raises:
        ReadError: with the file and the line.
    """
    try:
        hold_table(path)
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as fault:
        raise ReadError(f"{path}: cannot be read as text ({fault})") from None
    lines = [(i, bare) for i, line in enumerate(text.splitlines(), start=1) if (bare := line.partition("#")[0].strip())]
    if not lines:
        raise ReadError(f"{path}: the head is empty; {form}")
    (first, head), *body = lines
    if "," not in head and (";" in head or "\t" in head):
        mark = "semicolons" if ";" in head else "tabs"
        raise ReadError(
            f"{path}, line {first}: {mark} between the columns; put commas there, and points in decimal numbers"
        )
    if _is_number(_cells(head)[0]):
        raise ReadError(f"{path}, line {first}: no head with the names of the columns; {form}")
    reader = _Head(known, form, examples or {}, passed_over, f"{path}, line {first}")
    columns = [reader.column(cell) for cell in _cells(head)]
    names = [name for name, _ in columns]
    for name in names:
        if names.count(name) > 1:
            raise ReadError(f'{path}, line {first}: {names.count(name)} columns are called "{name}"; leave one')
    if needed not in names:
        raise ReadError(f'{path}, line {first}: no column "{needed} [unit]"; the head is {head}')
    quick = None
    if body and not set(names) & set(passed_over):
        quick = table_in_one_go(path, len(names), delimiter=",", skip=first, comments="#")
    if quick is not None and len(quick) == len(body):
        values = dict(zip(names, quick.T, strict=True))
    else:
        rows = [_row(line, names, passed_over, f"{path}, line {number}", form) for number, line in body]
        values = {name: np.array([row[name] for row in rows]) for name in names if name in known}
    found = {name: factor * values[name] for name, factor in columns if name in known}
    return Columns(values=found, head=first, lines=[number for number, _ in body], factors=dict(columns))


class _Head:
    """What the cells of a head may say."""

    def __init__(
        self,
        known: Mapping[str, str],
        form: str,
        examples: Mapping[str, str],
        passed_over: Collection[str],
        where: str,
    ) -> None:
        self.known, self.form, self.examples, self.passed_over = known, form, examples, passed_over
        self.where = where

    def column(self, cell: str) -> tuple[str, float]:
        """Name and factor to SI of one cell."""
        name, _, unit = cell.partition("[")
        name, unit = name.strip(), unit.rstrip("] ").strip()
        if name in self.passed_over:
            return name, 1.0
        if name not in self.known:
            raise ReadError(
                f'{self.where}: the column "{cell}" is unknown; known are {", ".join(self.known)}; {self.form}'
            )
        wanted = self.known[name]
        if wanted in ("", "1") and unit in ("", "-", "1"):
            return name, 1.0
        if not wanted:
            raise ReadError(f'{self.where}: the column "{cell}" has no unit; give plain numbers under "{name}"')
        example = f'write for example "{name} [{self.examples.get(wanted, wanted)}]"'
        if not unit:
            raise ReadError(f'{self.where}: the column "{cell}" lacks its unit; {example}')
        try:
            return name, scale(unit, wanted)
        except InputError:
            raise ReadError(
                f'{self.where}: "{unit}" of the column "{cell}" is not a unit like {wanted}; {example}'
            ) from None


def _cells(line: str) -> list[str]:
    """The cells of one line, without blanks and quotation marks around them."""
    return [cell.strip() for cell in next(csv.reader([line], skipinitialspace=True))]


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _row(line: str, names: list[str], passed_over: Collection[str], where: str, form: str) -> dict[str, float]:
    """The numbers of one line by the names of their columns."""
    cells = _cells(line)
    if len(cells) > len(names):
        raise ReadError(f"{where}: {len(cells)} values under the {len(names)} columns of the head; {form}")
    row = {}
    for i, name in enumerate(names):
        if name in passed_over:
            continue
        cell = cells[i] if i < len(cells) else ""
        if not cell:
            raise ReadError(f'{where}: no value in the column "{name}"; give one, or leave the row out')
        try:
            value = row[name] = float(cell)
        except ValueError:
            raise ReadError(f'{where}: "{cell}" in the column "{name}" is not a number') from None
        if not isfinite(value):
            raise ReadError(f'{where}: "{cell}" in the column "{name}" is not a finite number; leave the row out')
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
    with path.open(encoding="utf-8-sig", errors="replace") as handle:
        for skip, line in enumerate(handle):
            text = line.split("#")[0]
            refuse_decimal_comma(text, f"{path.name}, line {skip + 1}")
            if len(_numbers(text)) == columns:
                delimiter = next((mark for mark in ";," if mark in text), None)
                return table_in_one_go(path, columns, delimiter=delimiter, skip=skip, comments="#")
    return None


def _numbers(text: str) -> list[float]:
    """The numbers of a line, with commas, semicolons or blanks between; none where a word is no number."""
    try:
        return [float(word) for word in text.replace(",", " ").replace(";", " ").split()]
    except ValueError:
        return []


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
    for number, line in enumerate(path.read_text(encoding="utf-8-sig", errors="replace").splitlines(), start=1):
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
        raise ReadError(f"{path.name} holds no line of {columns} numbers; {form}")
    return np.array(rows)
