"""The tables of assemblies of one structure, for the terminal."""

import textwrap

import numpy as np

from faying.identify.assemblies import Assemblies
from faying.output.table import Rows, by_mode
from faying.output.table import text as aligned
from faying.output.terminal import WIDTH
from faying.units import load_text


def scatter(found: Assemblies, load: int) -> Rows:
    """One row per mode at one preload: as modelled, between assemblies, and between structures."""
    low, high = found.quantiles()[:, load]
    heads = ["as modelled [Hz]", "assemblies 5 .. 95 % [Hz]", "sd [%]", "most by"]
    between = found.low is not None and found.high is not None
    heads += ["structures 5 .. 95 % [Hz]", "part of it [%]"] * between
    cells = []
    for k, f in enumerate(found.modelled[load]):
        row = [f"{f:.1f}", f"{low[k]:.1f} .. {high[k]:.1f}", f"{100 * found.deviation[load, k]:.2g}"]
        row.append(found.most(load, k))
        if found.low is not None and found.high is not None:
            row.append(f"{found.low[load, k]:.0f} .. {found.high[load, k]:.0f}")
            row.append(f"{100 * found.part_of_interval[load, k]:.0f}")
        cells.append(row)
    return by_mode(heads, cells)


def alone(found: Assemblies, load: int) -> Rows:
    """One row per mode at one preload: the standard deviation with one thing drawn alone, and with all."""
    rows = 100 * np.vstack([found.deviation_alone[:, load], found.deviation[load]])
    heads = [*(f"{name} alone [%]" for name in found.sources), "all [%]"]
    return by_mode(heads, ([f"{x:.2g}" for x in one] for one in rows.T))


def text(found: Assemblies) -> str:
    """All tables for the terminal."""
    count = int(np.count_nonzero(found.sound))
    parts = [
        textwrap.fill(
            f"{found.title}: one structure bolted together {len(found.frequencies)} times by one person, {count} with "
            f"an answer. Drawn: {', '.join(found.sources)}. Structures: the interval of faying run",
            WIDTH,
        )
    ]
    parts += [f"\nat {load_text(load)}\n{aligned(scatter(found, k))}" for k, load in enumerate(found.loads)]
    if len(found.sources) > 1:
        head = f"standard deviation at {load_text(found.loads[-1])}, each thing drawn alone"
        parts.append(f"\n{head}\n" + aligned(alone(found, -1)))
    return "\n".join([*parts, *(textwrap.fill(f"note: {note.text}", WIDTH) for note in found.notes)])
