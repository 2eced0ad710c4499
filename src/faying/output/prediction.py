"""The tables of a prediction, for the terminal and for files."""

import textwrap

import numpy as np

from faying.errors import InputError
from faying.identify.prediction import LEVELS, Prediction
from faying.output.table import Rows, by_mode
from faying.output.table import text as aligned
from faying.output.terminal import WIDTH
from faying.units import load_text

SHOWN = 0.03  # share of the variance from which an input is named


def scatter(found: Prediction) -> Rows:
    """One row per input: what scatters, and how."""
    columns = [column for column in found.inputs.columns if column.key != "law.model"]
    rows = [["source", "distribution"], *([one.key, one.distribution.text(one.unit)] for one in columns)]
    laws = ", ".join(f"{name} {weight:.0%}" for name, weight in found.inputs.models)
    return [*rows, ["law.model", laws]] if laws else rows


def intervals(found: Prediction) -> Rows:
    """One row per mode: 5 % .. median .. 95 % of the frequency at each preload."""
    q = found.quantiles(LEVELS).frequencies.T  # mode, load, level
    return by_mode((f"{load_text(load)} [Hz]" for load in found.loads), (map(_three, mode) for mode in q))


def slopes(found: Prediction) -> Rows:
    """One row per mode: 5 % .. median .. 95 % of the change with preload; empty for a single load."""
    if len(found.loads) < 2:
        return []
    q = 1e3 * found.quantiles(LEVELS).slopes
    return by_mode(["[Hz/kN]"], ([" .. ".join(f"{value:.3g}" for value in mode)] for mode in q.T))


def losses(found: Prediction) -> Rows:
    """One row per mode: 5 % .. median .. 95 % of the loss factor at each preload; empty where none is predicted."""
    q = found.quantiles(LEVELS).loss_factors
    if not np.isfinite(q).any():
        return []
    heads = (f"{load_text(load)} (loss)" for load in found.loads)
    return by_mode(heads, ([" .. ".join(f"{value:.1e}" for value in load) for load in mode] for mode in q.T))


def beside_test(found: Prediction) -> Rows:
    """One row per mode of the test and preload: what was measured, the interval, and whether it holds it."""
    paired = found.quantiles(LEVELS).paired
    if paired is None or found.test is None:
        return []
    rows: Rows = [["test mode", "preload", "test [Hz]", "5 % .. median .. 95 % [Hz]", "inside"]]
    for mode in range(found.test.shape[1]):
        for load, preload in enumerate(found.loads):
            low, _, high = paired[:, load, mode]
            value = found.test[load, mode]
            inside = "yes" if low <= value <= high else "no"
            rows.append([str(mode + 1), load_text(preload), f"{value:.1f}", _three(paired[:, load, mode]), inside])
    return rows


def blame(found: Prediction) -> tuple[Rows, str]:
    """One row per mode: which inputs make its variance at the last preload, greatest first; and what to know of it."""
    try:
        shares, _ = found.shares()
    except InputError as fault:
        return [], f"No shares of the variance: {fault}."
    name = "mode" if found.paired is None else "test mode"
    rows: Rows = [[name, "total share of the variance"]]
    for mode, row in enumerate(shares.total):
        named = [k for k in np.argsort(-np.nan_to_num(row)) if row[k] >= SHOWN]  # NaN is not
        words = ", ".join(f"{found.blamed[k]} {row[k]:.0%}" for k in named)
        rows.append([str(mode + 1), words or "-"])
    text = (
        "A total share counts what an input does together with others, too. The shares of inputs are those of a "
        "polynomial through the samples."
    )
    return rows, text


def _three(values: np.ndarray) -> str:
    digits = 1 if np.nanmax(values) >= 100 else 2
    return " .. ".join(f"{v:.{digits}f}" for v in values)


def text(found: Prediction) -> str:
    """All tables for the terminal."""
    rows, words = blame(found)
    inside, count = found.covered
    parts = [
        textwrap.fill(
            f"{found.title}: {found.answered} of {len(found.values)} samples have an answer; bases of "
            f"{found.basis[0]} and {found.basis[1]} vectors",
            WIDTH,
        ),
        "\nwhat scatters\n" + _wrapped(scatter(found)),
        "\nfrequencies, 5 % .. median .. 95 %\n" + aligned(intervals(found)),
    ]
    for head, lines in (
        ("loss factors, 5 % .. median .. 95 %", losses(found)),
        ("change with preload, 5 % .. median .. 95 %", slopes(found)),
        (f"compared with the test ({found.test_source}): {inside} of {count} inside", beside_test(found)),
    ):
        if lines:
            parts.append(f"\n{textwrap.fill(head, WIDTH)}\n" + aligned(lines))
    last = load_text(found.loads[-1])
    parts.append(f"\nwhat makes the scatter at {last}\n" + _wrapped(rows) + "\n\n" + textwrap.fill(words, WIDTH) + "\n")
    return "\n".join([*parts, *(textwrap.fill(f"note: {note.text}", WIDTH) for note in found.notes)])


def _wrapped(rows: Rows) -> str:
    """Two columns, the second wrapped to the terminal."""
    first = max((len(row[0]) for row in rows), default=0) + 2
    lines = []
    for head, words in rows:
        parts = textwrap.wrap(words, max(WIDTH - first, 30)) or [""]
        lines.append(head.ljust(first) + parts[0])
        lines += [" " * first + part for part in parts[1:]]
    return "\n".join(line.rstrip() for line in lines)
