"""FRFs from text files: a complex number on each line, or columns of frequency, real and imaginary part."""

import re
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from faying.columns import split_heading, states_unit
from faying.errors import InputError, ReadError
from faying.files import end_of, refuse_decimal_comma
from faying.measured.frf import FRF, Dof, without_static
from faying.measured.frf_table import FORM, FrfColumns, plain_layout, read_layout
from faying.measured.uff_units import DIMENSIONS
from faying.typing import Array, Complex

BOTH_PARTS = re.compile(r"\(\s*[-+]?[^-+\s]+(?:[eE][-+]?\d+)?\s*[-+]\s*[^-+\s]+(?:[eE][-+]?\d+)?[ij]\s*\)")
NUMBER = re.compile(r"\(?[-+]?(\.?\d|(nan|inf)\b)", re.IGNORECASE)  # what a line of numbers begins with
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
        warnings=tuple(notes),
    )


def _read(path: Path, step: float | None, quantity: str) -> tuple[Array, Complex, Array, tuple[str, ...]]:
    """Frequencies, values and coherence (functions, frequencies), NaN where none is given, and notes."""
    try:
        text = path.read_text(encoding="utf-8-sig", errors="replace")
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
    return frequency, functions, coherence, (*layout.notes, *_gaps(frequency, path))


def _gaps(frequency: Array, path: Path) -> list[str]:
    """A sentence where frequencies of even steps have gaps of whole steps."""
    steps = np.diff(frequency)
    step = float(np.median(steps))
    alike = np.abs(steps - step) < 0.02 * abs(step)
    if step <= 0 or alike.all() or alike.mean() < EVEN:
        return []
    gaps = np.flatnonzero(steps > 1.9 * step)
    if not gaps.size:
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
        with suppress(ReadError):
            named = len(split_heading(line.lstrip("# "))) == width
            if named:
                return read_layout(line.lstrip("# "), quantity, f"{path}, line {number}")
    _refuse_units(above, path)
    return plain_layout(width)


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
