"""Do the 90 % intervals hold on bolted structures that nothing was fitted to? Every measured frequency in its interval.

    python benchmarks/blind.py [name ...]

Each folder of benchmarks/blind has a study of published facts (its README.md says which), the geometry and what was
measured. Modes are paired in rising order. A structure without measured frequencies prints its prediction.
"""

import csv
import runpy
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from coverage import NOMINAL, Measured, scored

import faying
from faying.setup.template import surface
from faying.study import Study

FOLDER = Path(__file__).parent / "blind"


@dataclass(frozen=True, kw_only=True)
class Row:
    """One measured frequency.

    Args:
        mode: of the study, from 1.
        load: preload of the study, from 1.
        frequency: measured [Hz].
    """

    mode: int
    load: int
    frequency: float


def measured(folder: Path) -> list[Row]:
    """The rows of measured.csv."""
    with (folder / "measured.csv").open(encoding="utf-8", newline="") as file:
        return [
            Row(mode=int(row["mode"]), load=int(row["load"]), frequency=float(row["frequency [Hz]"]))
            for row in csv.DictReader(file)
        ]


def ready(folder: Path) -> Study:
    """The study, with its geometry and the surface of `faying new` beside it."""
    runpy.run_path(str(folder / "make_geometry.py"), run_name="__main__")
    name = next(iter(folder.glob("*.step"))).stem
    surface(folder / f"{name}-surface.x3p")
    return Study.read(folder / "study.toml")


def compared(folder: Path) -> Measured | None:
    """Print the modes of one structure; what was measured in units of its intervals, None where nothing was."""
    result, rows = faying.run(ready(folder)), measured(folder)
    if not rows:
        for mode, (low, best, high) in enumerate(
            zip(result.interval.low[-1], result.interval.best[-1], result.interval.high[-1], strict=True), 1
        ):
            print(f"{folder.name}, mode {mode}: {low:.4g} .. {best:.4g} .. {high:.4g} Hz, nothing published")
        return None
    at = tuple(np.array([(row.load - 1, row.mode - 1) for row in rows]).T)
    test = np.array([row.frequency for row in rows])
    best, low, high = (array[at] for array in (result.interval.best, result.interval.low, result.interval.high))
    for row, *ends in zip(rows, low, best, high, strict=True):
        inside = "" if ends[0] <= row.frequency <= ends[2] else "  OUTSIDE"
        error = 100 * (ends[1] / row.frequency - 1)
        print(
            f"{folder.name}, mode {row.mode}: measured {row.frequency:.4g}, "
            f"{ends[0]:.4g} .. {ends[1]:.4g} .. {ends[2]:.4g} Hz, best {error:+.1f} %{inside}"
        )
    scores, widths = scored(result.interval.offsets[:, :, *at], best, test)
    error = np.log(best / test)
    print(f"{folder.name}: best estimate {100 * error.mean():+.1f} % on average, {100 * error.std():.1f} % about it")
    return Measured(name=folder.name, scores=scores, widths=widths)


def main(names: list[str]) -> None:
    """Run the structures named, or all."""
    folders = sorted(path.parent for path in FOLDER.glob("*/study.toml"))
    found = [compared(folder) for folder in folders if not names or folder.name in names]
    print("structure, number, median width [%], share inside at", NOMINAL)
    for one in found:
        if one is not None:
            print(one)


if __name__ == "__main__":
    main(sys.argv[1:])
