"""FRFs from text files: a complex number on each line, or columns of frequency, real and imaginary part."""

import re
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import pairwise
from math import pi
from pathlib import Path
from typing import Any

import numpy as np

from faying.columns import Cell, in_brackets, is_unit, plain_unit, split_heading, states_unit
from faying.errors import InputError, ReadError
from faying.files import LATIN, end_of, refuse_decimal_comma
from faying.measured.frf import FRF, UNITS, Dof, without_static
from faying.measured.uff_units import DIMENSIONS, unit_factor
from faying.typing import Array, Complex
from faying.units import scale

ROLES = {
    "frequency": {"frequency", "frequencies", "freq", "f"},
    "omega": {"omega", "w", "ω", "angular frequency", "circular frequency"},
    "real": {"real", "re", "realpart", "r"},
    "imaginary": {"imaginary", "imag", "im", "imagpart", "i"},
    "magnitude": {"magnitude", "mag", "amplitude", "amp", "abs", "modulus"},
    "phase": {"phase", "angle", "arg"},
    "coherence": {"coherence", "coh", "gamma^2", "γ^2"},
}
MAX_PHASE = 1e6  # rad
PAIRS = {("real", "imaginary"): "parts", ("magnitude", "phase"): "polar"}
FORM = "a table of FRFs looks like: frequency [Hz],real [m/s^2/N],imaginary [m/s^2/N] or frequency [Hz],magnitude [dB],"
FORM += "phase [deg]"
# the number of a reference may carry a prefix, as in "dB/1.00u (m/s^2)/N"
REFERENCE = re.compile(r"(\d+\.?\d*(?:[eE][-+]?\d+)?)?([pnu](?=\s))?\s*(.*)")
PREFIXES = {"": 1.0, "p": 1e-12, "n": 1e-9, "u": 1e-6}
NO_UNIT = ("", "-", "1", "lin", "linear")


@dataclass(frozen=True, kw_only=True)
class Pair:
    """Two columns that make one FRF: their places, how they are written, and the factors to SI.

    decibels: whether the first is 20 log10 of the magnitude; turn: radians in one unit of the phase.
    """

    first: int
    second: int
    polar: bool
    scales: tuple[float, float] = (1.0, 1.0)
    decibels: bool = False
    turn: float = 1.0

    def values(self, table: Array) -> Complex:
        """Complex values (f,) in SI. Raises ReadError for a phase of so many turns that its digits are lost."""
        a, b = table[:, self.first], table[:, self.second]
        if not self.polar:
            a, b = (np.where(np.isfinite(one), one, np.nan) for one in (a, b))
            return np.asarray(self.scales[0] * a + 1j * self.scales[1] * b)
        most = float(np.abs(self.turn * b).max(initial=0.0))
        if most > MAX_PHASE:
            raise ReadError(f"a phase of {most:.3g} rad has lost its digits; is the column a phase?")
        size = np.where(np.isfinite(a), 10 ** (a / 20) if self.decibels else a, np.nan)
        return np.asarray(self.scales[0] * size * np.exp(1j * self.turn * b))


@dataclass(frozen=True, kw_only=True)
class FrfColumns:
    """Columns of a table of FRFs: place and factor to Hz of the frequency, the pairs, the places of their coherence
    (none, or one for each pair), and sentences for the reader."""

    frequency: int
    hertz: float
    pairs: tuple[Pair, ...]
    coherence: tuple[int, ...] = ()
    notes: tuple[str, ...] = ()
    named: bool = True


def read_layout(line: str, quantity: str, where: str) -> FrfColumns:
    """Read a heading.

    Args:
        line: the heading, such as "Frequency (Hz),Magnitude (dB),Phase (deg)".
        quantity: what the FRFs are, one of QUANTITIES.
        where: file and line, for messages.

    Raises:
        ReadError: a column is unknown or stands alone, a unit is unknown or of another quantity, a phase has no unit.
    """
    cells = tuple(_with_unit(cell, ("Hz", "rad", DIMENSIONS[quantity] + "/N")) for cell in split_heading(line))
    roles = [_role(cell, where) for cell in cells]
    lines = [k for k, role in enumerate(roles) if role in ("frequency", "omega")]
    if len(lines) != 1:
        raise ReadError(f'{where}: {len(lines)} columns of frequency in the heading "{line.strip()[:120]}"; {FORM}')
    coherence = tuple(k for k, role in enumerate(roles) if role == "coherence")
    rest = [k for k in range(len(cells)) if k != lines[0] and k not in coherence]
    notes: list[str] = []
    pairs = []
    for a, b in zip(rest[::2], [*rest[1::2], None], strict=False):
        names = roles[a], None if b is None else roles[b]
        kind = PAIRS.get(names) or PAIRS.get(names[::-1])  # type: ignore[arg-type]
        if kind is None or b is None:
            shown = f'"{cells[a].text}"' + ("" if b is None else f' and "{cells[b].text}"')
            raise ReadError(f"{where}: {shown} of the heading make no FRF; {FORM}")
        first, second = (a, b) if names in PAIRS else (b, a)
        pairs.append(_pair(cells, first, second, kind == "polar", quantity, where, notes))
    if not pairs:
        raise ReadError(f'{where}: no FRF in the heading "{line.strip()[:120]}"; {FORM}')
    if coherence and len(coherence) != len(pairs):
        raise ReadError(f"{where}: {len(coherence)} columns of coherence for {len(pairs)} FRFs; give each one, or none")
    return FrfColumns(
        frequency=lines[0],
        hertz=_hertz(cells[lines[0]], roles[lines[0]], where),
        pairs=tuple(pairs),
        coherence=coherence,
        notes=tuple(dict.fromkeys(notes)),
    )


def _with_unit(cell: Cell, units: tuple[str, ...]) -> Cell:
    """The cell with the unit that its last word is, as in "Frequency kHz", where it states none in brackets."""
    name, _, last = cell.text.replace("_", " ").rpartition(" ")
    found, stated = plain_unit(last), set("[(") & set(cell.text) or cell.unit.lower().startswith("db")
    if stated or not name or not any(is_unit(found, unit) for unit in units):
        return cell
    return Cell(text=cell.text, name=name.lower(), unit=found)


def _words(cell: Cell) -> set[str]:
    """The words of the name of a column, and the whole of it."""
    return {*re.findall(r"[^\W\d_]+", cell.name), cell.name}


def _role(cell: Cell, where: str) -> str:
    """What one column is: the one role that its words name; one in decibels is a magnitude."""
    units = [f"{unit}/N" for unit in DIMENSIONS.values()]
    stated = [one[:2].lower() == "db" or any(is_unit(one, unit) for unit in units) for one in in_brackets(cell.text)]
    if stated.count(True) > 1:
        raise ReadError(f'{where}: "{cell.text}" states two units; write one, for decibels "dB re 1 g/N" or the like')
    found = [role for role, names in ROLES.items() if names & _words(cell)]
    if not found and re.match(r"db\b", cell.unit, re.IGNORECASE):
        found = ["magnitude"]
    if "omega" in found and "frequency" in found:
        found.remove("frequency")
    if len(found) != 1:
        what = "is unknown" if not found else f"may be {' or '.join(found)}"
        raise ReadError(
            f'{where}: the column "{cell.text}" {what}; the known ones are {", ".join(ROLES)}; leave other '
            f"columns out; {FORM}"
        )
    return found[0]


def _hertz(cell: Cell, role: str, where: str) -> float:
    unit = cell.unit.lower().replace("sec", "s")
    if unit.replace(" ", "") in ("rad/s", "1/s", "rads^-1", "s^-1") and (role == "omega" or "rad" in unit):
        return 1 / (2 * pi)
    if unit in ("rpm", "1/min", "cpm", "min^-1"):
        return 1 / 60
    if not unit and role == "frequency":
        return 1.0
    if role == "frequency":
        with suppress(InputError):
            return scale({"hz": "Hz", "khz": "kHz"}.get(unit, cell.unit), "Hz")
    raise ReadError(
        f'{where}: the column "{cell.text}" states no unit that Faying reads; write frequency [Hz], frequency [kHz] or '
        "omega [rad/s]"
    )


def _pair(
    cells: tuple[Cell, ...], first: int, second: int, polar: bool, quantity: str, where: str, notes: list[str]
) -> Pair:
    if not polar:
        factors = tuple(_factor(cells[k], quantity, where, notes) for k in (first, second))
        if bool(cells[first].unit) != bool(cells[second].unit):
            raise ReadError(
                f'{where}: only one of "{cells[first].text}" and "{cells[second].text}" states a unit; state both'
            )
        return Pair(first=first, second=second, polar=False, scales=(factors[0], factors[1]))
    angle = cells[second].unit.lower()
    turns = {"deg": pi / 180, "degree": pi / 180, "degrees": pi / 180, "rad": 1.0, "radians": 1.0}
    if angle not in turns:
        raise ReadError(f'{where}: the column "{cells[second].text}" states no unit of angle; give deg or rad')
    decibels = re.fullmatch(r"db(.*)", cells[first].unit, re.IGNORECASE)
    if decibels is None:
        factor = _factor(cells[first], quantity, where, notes)
    else:
        factor = _reference(decibels[1], cells[first], quantity, where, notes)
    return Pair(
        first=first, second=second, polar=True, scales=(factor, 1.0), decibels=decibels is not None, turn=turns[angle]
    )


def _reference(text: str, cell: Cell, quantity: str, where: str, notes: list[str]) -> float:
    """SI value at 0 dB, from words such as "re 1 m/s^2/N" or "(re 1e-6 (m/s^2)/(1 N))"."""
    bare = re.sub(r"^\)?\s*[\[(]\s*(re\b.*)[\])]$", r"\1", text.strip(" ,;"))
    bare = re.sub(r"^((re|ref|rel)\b[.:]*|/)\s*", "", bare)
    number, prefix, unit = REFERENCE.fullmatch(bare).groups()  # type: ignore[union-attr]
    times = float(number or 1) * PREFIXES[prefix or ""]
    if not unit and times == 1:
        notes.append(f'{where}: "{cell.text}" states no reference; 0 dB is taken as 1 {UNITS[quantity]}')
        return 1.0
    factor = unit_factor(re.sub(r"\(1(\.0*)?\s+", "(", unit), DIMENSIONS[quantity] + "/N")
    if factor is None or times == 0:
        raise ReadError(
            f'{where}: "{cell.text}": "{bare}" is not a reference of {quantity}; write dB re 1 {DIMENSIONS[quantity]}/N'
        )
    return times * factor


def _factor(cell: Cell, quantity: str, where: str, notes: list[str]) -> float:
    if cell.unit.lower() in NO_UNIT:
        notes.append(f'{where}: "{cell.text}" states no unit; {UNITS[quantity]} is taken')
        return 1.0
    factor = unit_factor(cell.unit, DIMENSIONS[quantity] + "/N")
    if factor is None:
        others = [name for name, unit in DIMENSIONS.items() if unit_factor(cell.unit, unit + "/N") is not None]
        hint = f"write for example {DIMENSIONS[quantity]}/N"
        if others:
            hint = f"this is a unit of {others[0]}, give that as the quantity"
        raise ReadError(f'{where}: "{cell.unit}" of the column "{cell.text}" is not a unit of {quantity}; {hint}')
    return factor


BOTH_PARTS = re.compile(r"\(\s*[-+]?[^-+\s]+(?:[eE][-+]?\d+)?\s*[-+]\s*[^-+\s]+(?:[eE][-+]?\d+)?[ij]\s*\)")
NUMBER = re.compile(r"\(?[-+]?(\.?\d|(nan|inf)\b)", re.IGNORECASE)  # what a line of numbers begins with
ALIKE = 1e-2  # how far two forms of one FRF may differ, by the digits of their table
EVEN = 0.9  # share of steps that are alike, from which on a longer one is a gap


def read_frf_text(
    files: Sequence[str | Path], *, quantity: str, frequency_step: float | None = None, direction: str = "z"
) -> FRF:
    """Read one FRF from each file; the outputs are points 1, 2, ... in the order of the files, all in SI.

    A file holds either one complex number on each line, as "(-0.07+2.6e-08j)", with spectral lines `frequency_step`
    [Hz] apart from 0 Hz on, or columns split by commas, semicolons or blanks. Their heading, the last line above the
    numbers, names them in any order, with units: frequency (Hz, kHz, rad/s, rpm), and for each FRF real and imaginary
    part, or magnitude (or dB) and phase (deg or rad), maybe with a coherence. Without a heading they are frequency in
    Hz, real and imaginary part in SI. A line at 0 Hz without a number is left out with a note.

    Raises:
        ReadError: where a line is neither, or the heading names what is not read.
        InputError: where files do not fit together or the step is missing.
    """
    frequency: Array | None = None
    notes: list[str] = []
    rows: list[Complex] = []
    coherence: list[Array] = []
    for name in files:
        path = Path(name)
        own, values, seen, stated = _read(path, frequency_step, quantity)
        used, static = without_static(own, values, str(path))
        own = own[used]
        notes += [*stated, *static, *end_of(path)]
        if frequency is not None and (own.shape != frequency.shape or not np.allclose(own, frequency, rtol=1e-6)):
            raise InputError(f"{path}: its frequencies are not those of {files[0]}; give files of one test")
        frequency = own
        rows += list(values[:, used])
        coherence += list(seen[:, used])
    if frequency is None:
        raise InputError("no file was given; name one text file or more")
    return FRF(
        frequency=frequency,
        values=np.array(rows)[:, None],
        outputs=tuple(Dof(i + 1, direction) for i in range(len(rows))),
        inputs=(Dof(1, direction),),
        quantity=quantity,
        coherence=np.array(coherence)[:, None] if np.isfinite(coherence).any() else None,
        source=", ".join(str(f) for f in files),
        warnings=tuple(dict.fromkeys(notes)),
    )


def _read(path: Path, step: float | None, quantity: str) -> tuple[Array, Complex, Array, tuple[str, ...]]:
    """Frequencies, values and coherence (functions, frequencies), NaN where none is given, and notes."""
    try:
        text = path.read_text(encoding="utf-8-sig", errors=LATIN)
    except OSError as fault:
        raise ReadError(f"{path}: cannot be read ({fault.strerror or fault})") from None
    numbered = [(number, line.strip()) for number, line in enumerate(text.splitlines(), 1) if line.strip()]
    start = next((k for k, (_, line) in enumerate(numbered) if re.match(NUMBER, line)), len(numbered))
    above = [(number, line) for number, line in numbered[:start] if line.strip("# ,;")]
    lines = [line for _, line in numbered[start:] if not line.startswith("#")]
    if len(lines) < 2:
        raise ReadError(f"{path}: no FRF in it; expected a complex number on each line, or frequency, real, imaginary")
    if re.search(r"([\d.]|nan|inf)[ij]\b", lines[0], re.I):
        _refuse_units(above, path)
        if step is None or not step > 0:
            raise InputError(
                f"{path}: the file states no frequencies; give their step, for example frequency_step=1.0 [Hz] or "
                '--frequency-step "1 Hz"'
            )
        for line in lines:
            if set(line) & set("()") and not BOTH_PARTS.fullmatch(line):
                raise ReadError(f"{path}: {line[:60]!r} is not a complex number of two parts, as (-0.07+2.6e-08j)")
        values = [_number(complex, path, re.sub(r"i$", "j", line.replace(" ", "").strip("()"))) for line in lines]
        own = np.array([values], dtype=np.complex128)
        return np.arange(len(values), dtype=float) * step, own, np.full(own.shape, np.nan), ()
    for line in lines:
        refuse_decimal_comma(line, str(path))
    table = [[_number(float, path, cell) for cell in re.split(r"[,;\s]+", line.rstrip(",; \t"))] for line in lines]
    layout = _layout(above, len(table[0]), quantity, path)
    width = 1 + 2 * len(layout.pairs) + len(layout.coherence)
    if not layout.pairs or {len(row) for row in table} != {width}:
        odd = next((len(row) for row in table if len(row) != width), len(table[0]))
        raise ReadError(
            f"{path}: lines of {odd} numbers; expected frequency, then real and imaginary part of each FRF"
            + (f", {width} numbers as in the heading" if layout.named else "")
        )
    data = np.array(table)
    try:
        functions = np.array([pair.values(data) for pair in layout.pairs])
    except ReadError as fault:
        raise ReadError(f"{path}: {fault}") from None
    frequency = layout.hertz * data[:, layout.frequency]
    coherence = data.T[list(layout.coherence)] if layout.coherence else np.full(functions.shape, np.nan)
    same = [np.allclose(a, b, rtol=ALIKE, atol=0, equal_nan=True) for a, b in pairwise(functions)]
    new = [True, *(not s or a.polar == b.polar for s, (a, b) in zip(same, pairwise(layout.pairs), strict=True))]
    twice = [] if all(new) else [f"{path}: an FRF stands in parts and as magnitude and phase; it is read once"]
    return frequency, functions[new], coherence[new], (*layout.notes, *_gaps(frequency, path), *twice)


def _gaps(frequency: Array, path: Path) -> list[str]:
    """A sentence where frequencies of even steps have gaps of whole steps."""
    steps = np.diff(frequency)
    step = float(np.median(steps))
    alike = np.abs(steps - step) < 0.02 * abs(step)
    gaps = np.flatnonzero(steps > 1.9 * step)
    if step <= 0 or not gaps.size or alike.mean() < EVEN:
        return []
    k = int(gaps[0])
    return [
        f"{path}: the frequencies go in steps of {step:.4g} Hz, but from {frequency[k]:.6g} to {frequency[k + 1]:.6g} "
        f"Hz there is none{f', and {gaps.size - 1} more gaps' if gaps.size > 1 else ''}; is a line missing?"
    ]


def _layout(above: list[tuple[int, str]], width: int, quantity: str, path: Path) -> FrfColumns:
    """The layout that the heading states: the last line above the numbers, or a comment that reads as one."""
    plain = [(number, line) for number, line in above if not line.startswith("#")]
    if plain:
        found = read_layout(plain[-1][1], quantity, f"{path}, line {plain[-1][0]}")
        _refuse_units([entry for entry in above if entry != plain[-1]], path)
        return found
    for number, line in reversed(above):
        cells = split_heading(bare := line.lstrip("# "))
        if len(cells) == width and any(names & _words(cell) for cell in cells for names in ROLES.values()):
            return read_layout(bare, quantity, f"{path}, line {number}")
    _refuse_units(above, path)
    pairs = tuple(Pair(first=k, second=k + 1, polar=False) for k in range(1, width, 2))
    note = f"no heading: the columns are taken as frequency in Hz, then real and imaginary parts in {UNITS[quantity]}"
    return FrfColumns(frequency=0, hertz=1.0, pairs=pairs, notes=(note,), named=False)


def _refuse_units(above: list[tuple[int, str]], path: Path) -> None:
    """Raise ReadError where words above the numbers speak of units, which nobody reads."""
    for number, line in above:
        if states_unit(line, ("Hz", *(f"{unit}/N" for unit in DIMENSIONS.values()), *DIMENSIONS.values())):
            raise ReadError(
                f'{path}, line {number}: "{line[:80]}" mentions units in words that Faying does not read; take the '
                f"line out and write a heading: {FORM}"
            )


def _number(kind: Any, path: Path, text: str) -> Any:
    try:
        return kind(text)
    except ValueError:
        raise ReadError(
            f"{path}: {text!r} is not a number; expected a complex number on each line, or frequency, real, imaginary"
        ) from None
