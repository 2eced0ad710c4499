"""Run both studies and compare them with the published model: a table, and pressure.png with gap and pressures."""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from faying.answer.run import run
from faying.case.case import build
from faying.result import Result
from faying.study import Study

HERE = Path(__file__).parent
NAMES = ("flat", "measured-form")


def table(results: list[Result]) -> str:
    """Return modes 1 to 3 of both studies beside those published, and what form error changes, as lines of text."""
    rows = ["faces          source       mode 1   mode 2   mode 3  [Hz]"]
    pairs = []
    for name, result in zip(NAMES, results, strict=True):
        comparison = result.comparison
        assert comparison is not None
        pairs.append((comparison.frequencies[0], comparison.predicted[0]))
        for source, values in zip(("published", "Faying"), pairs[-1], strict=True):
            rows.append(f"{name:14s} {source:10s}" + "".join(f"{value:9.2f}" for value in values))
        change = comparison.predicted[0] / comparison.frequencies[0] - 1
        rows.append(f"{'':14s} {'difference':10s}" + "".join(f"{100 * value:+8.2f}%" for value in change))
    for source, flat, form in zip(("published", "Faying"), *pairs, strict=True):
        rows.append(f"{'form error':14s} {source:10s}" + "".join(f"{100 * v:+8.2f}%" for v in form / flat - 1))
    return "\n".join(rows)


def figure(results: list[Result], gap: np.ndarray, path: Path) -> None:
    """Draw the gap before the load and the pressure of both studies over the joint, and write them to `path`."""
    fig, axes = plt.subplots(3, 1, figsize=(7.5, 6), sharex=True, layout="constrained")
    x, y = 1e3 * results[0].points[:, 0], 1e3 * results[0].points[:, 1]
    top = max(float(result.pressure.max()) for result in results) / 1e6
    panels = [("gap before the load [um]", 1e6 * gap, None)]
    panels += [
        (f"pressure, {name} [MPa]", result.pressure[0] / 1e6, top) for name, result in zip(NAMES, results, strict=True)
    ]
    for ax, (title, values, most) in zip(axes, panels, strict=True):
        dots = ax.scatter(x, y, c=values, s=5, vmin=0, vmax=most, linewidths=0)
        ax.set(title=title, ylabel="y [mm]", aspect="equal")
        fig.colorbar(dots, ax=ax)
    axes[-1].set_xlabel("x [mm]")
    fig.savefig(path, dpi=130)


def main(path: Path) -> None:
    """Run, print, draw."""
    studies = [Study.read(HERE / f"{name}.toml") for name in NAMES]
    results = [run(study) for study in studies]
    print(table(results))
    figure(results, build(studies[1]).joints[0].interface.gap, path)


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "results" / "pressure.png")
