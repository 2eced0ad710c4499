"""Print the comparison with the test: the default law with flat faces and with waves, JK, and what their skill is.

The draws of waves come from a sweep over their seed.

Run: uv run --extra pardiso python examples/t-specimen/table.py (some minutes).
"""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np

import faying
from faying.form.form import Form
from faying.output import table
from faying.result.run_record import preload_slope
from faying.study import Study
from faying.study.keys.alternative import AlternativeChoice

STUDY = Study.read(Path(__file__).parent / "study.toml")
FLAT = AlternativeChoice(name="default, flat", form=Form())
(JK,) = STUDY.alternatives
SEEDS = range(4)
TOLERANCE = 1e-4  # of a frequency; draws differ by a thousandth and more


def draws(result: faying.Result) -> np.ndarray:
    """Frequencies [Hz] (draws, 3, 5) of the modes that the study's own draw pairs with the test's."""
    axes = [
        faying.axis_of("joint.form.waviness_seed=" + ",".join(map(str, SEEDS))),
        faying.axis_of("bolt.preload=" + ",".join(f"{load:g} N" for load in result.loads)),
    ]
    with tempfile.TemporaryDirectory() as folder:
        frequencies = faying.sweep(STUDY, axes, Path(folder) / "draws.nc", tolerance=TOLERANCE).frequencies
    modes = result.comparison.modes
    return np.stack([frequencies[:, load, modes[load]] for load in range(len(modes))], axis=1)


def skill(name: str, test: np.ndarray, found: np.ndarray) -> list[str]:
    """Rms error at the last load [%], alone and as a ratio to the test at the load before, and their skill."""

    def error(row: np.ndarray) -> float:
        return float(100 * np.sqrt(np.mean((row / test[-1] - 1) ** 2)))

    same, own, carried = error(test[-2]), error(found[-1]), error(test[-2] * found[-1] / found[-2])
    return [name, f"{own:.2f}", f"{carried:.2f}", f"{own / same:.2f}", f"{carried / same:.2f}"]


def main() -> None:
    """Print the tables of docs/t-specimen.md."""
    result = faying.run(replace(STUDY, alternatives=(FLAT, replace(JK, name="JK, flat"))))
    c = result.comparison
    print(table.text(table.comparison(result)))
    wavy = draws(result)
    slopes = 1e3 * np.stack([preload_slope(one, result.loads) for one in wavy])
    rows = [["d f/d preload [Hz/kN]", *(f"mode {j + 1}" for j in range(slopes.shape[1]))]]
    for what, share in (("least draw", 0.0), ("median draw", 0.5), ("greatest draw", 1.0)):
        rows.append([what, *(f"{value:.3f}" for value in np.quantile(slopes, share, axis=0))])
    print("\n" + table.text(rows))
    rows = [["rms error at the last load", "own [%]", "test before times own ratio [%]", "skill", "skill of the ratio"]]
    rows.append(skill("same as at the load before", c.frequencies, np.ones_like(c.frequencies) * c.frequencies[-2]))
    for name, found in zip(result.alternatives.names, c.alternatives, strict=True):
        rows.append(skill(name, c.frequencies, found))
    for seed, found in zip(SEEDS, wavy, strict=True):
        rows.append(skill(f"default, waves, draw {seed}", c.frequencies, found))
    print("\n" + table.text(rows))


if __name__ == "__main__":
    main()
