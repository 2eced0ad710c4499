"""FRFs from text files: a complex number on each line, or columns of frequency, real and imaginary part."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import InputError, ReadError
from faying.files import end_of, refuse_decimal_comma
from faying.measured.frf import FRF, Dof
from faying.typing import Array, Complex


def read_frf_text(
    files: Sequence[str | Path], *, quantity: str, frequency_step: float | None = None, direction: str = "z"
) -> FRF:
    """Read one FRF from each file; the outputs are points 1, 2, ... in the order of the files, all in SI.

    A file holds either one complex number on each line, as "(-0.07+2.6e-08j)", with spectral lines `frequency_step`
    [Hz] apart from 0 Hz on, or columns: frequency [Hz], then real and imaginary part of one FRF or more, split by
    commas, semicolons or blanks, with or without a line of names. Raises ReadError where a line is neither, InputError
    where files do not fit together or the step is missing.
    """
    frequency: Array | None = None
    notes: list[str] = []
    rows: list[Complex] = []
    for name in files:
        path = Path(name)
        own, values = _read(path, frequency_step)
        notes += end_of(path)
        if frequency is not None and (own.shape != frequency.shape or not np.allclose(own, frequency, rtol=1e-6)):
            raise InputError(f"{path}: its frequencies are not those of {files[0]}; give files of one test")
        frequency = own
        rows += list(values)
    if frequency is None:
        raise InputError("no file was given; name one text file or more")
    return FRF(
        frequency=frequency,
        values=np.array(rows)[:, None],
        outputs=tuple(Dof(i + 1, direction) for i in range(len(rows))),
        inputs=(Dof(1, direction),),
        quantity=quantity,
        source=", ".join(str(f) for f in files),
        warnings=tuple(notes),
    )


def _read(path: Path, step: float | None) -> tuple[Array, Complex]:
    """Frequencies, and values (functions, frequencies)."""
    try:
        text = path.read_text(encoding="utf-8-sig", errors="replace")
    except OSError as fault:
        raise ReadError(f"{path}: cannot be read ({fault.strerror or fault})") from None
    lines = [line.strip() for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    if lines and not re.match(r"[-+(.\d]", lines[0]):
        lines = lines[1:]  # names of the columns
    if len(lines) < 2:
        raise ReadError(f"{path}: no FRF in it; expected a complex number on each line, or frequency, real, imaginary")
    if "j" in lines[0] or "i" in lines[0]:
        if step is None or not step > 0:
            raise InputError(
                f"{path}: the file states no frequencies; give their step, for example frequency_step=1.0 [Hz] or "
                '--frequency-step "1 Hz"'
            )
        values = [_number(complex, path, line.replace("i", "j").replace(" ", "").strip("()")) for line in lines]
        return np.arange(len(values), dtype=float) * step, np.array([values], dtype=np.complex128)
    for line in lines:
        refuse_decimal_comma(line, str(path))
    table = [[_number(float, path, cell) for cell in re.split(r"[,;\s]+", line)] for line in lines]
    widths = {len(row) for row in table}
    if len(widths) > 1 or (width := widths.pop()) < 3 or width % 2 == 0:
        raise ReadError(
            f"{path}: lines of {len(table[0])} numbers; expected frequency, then real and imaginary part of each FRF"
        )
    data = np.array(table)
    return data[:, 0], (data[:, 1::2] + 1j * data[:, 2::2]).T


def _number(kind: Any, path: Path, text: str) -> Any:
    try:
        return kind(text)
    except ValueError:
        raise ReadError(
            f"{path}: {text!r} is no number; expected a complex number on each line, or frequency, real, imaginary"
        ) from None
