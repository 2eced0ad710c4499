"""Do the intervals of a run hold what was measured? Shares inside, by the nominal share, of measured structures.

    python benchmarks/coverage.py [coverage.svg]

Runs the T-specimen (15 frequencies of a hammer test) and, where its measured interface lies in
examples/brake-reuss-beam/data (make_data.py writes it), the Brake-Reuss beam, whose first frequency was measured
between 175.5 and 180 Hz with a damping ratio of 0.05 to 1 %. Nothing is fitted to these measurements but the dimensions
of the T-specimen, which its study says.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.stats import binom, norm

import faying
from faying.case.scatter import SCORE
from faying.study import Study
from faying.style import COLOURS, COLUMN, drawing, legend_above, new_figure, save

EXAMPLES = Path(__file__).parents[1] / "examples"
NOMINAL = np.array([0.5, 0.8, 0.9, 0.95])
# published limits of the measured backbone (Porter and Brake 2023, doi:10.1016/j.ymssp.2023.110210)
BEAM = {"at rest": 180.0, "at the greatest level": 175.5}


@dataclass(frozen=True, kw_only=True)
class Measured:
    """Measured frequencies of one structure in units of their interval.

    Args:
        name: of the structure.
        scores: distance from the middle (n,), in standard deviations of the interval [-].
        widths: from 5 to 95 % (n,), over the frequency [-].
    """

    name: str
    scores: np.ndarray
    widths: np.ndarray

    def inside(self, nominal: float) -> float:
        """Share of the frequencies in the interval of a nominal share [-]."""
        return float(np.mean(np.abs(self.scores) <= norm.ppf((1 + nominal) / 2)))


def scored(
    result: faying.Result, load: np.ndarray, mode: np.ndarray, test: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Scores and widths of measured frequencies [Hz] (n,) of modes at loads (both from 0)."""
    middle = result.interval.offsets.mean(axis=1).sum(axis=0)[load, mode]
    width = result.interval.width[load, mode]
    away = np.log(test / result.frequencies[load, mode]) - middle
    return away / (width / (2 * SCORE)), width


def t_specimen() -> Measured:
    """Fifteen frequencies of five modes at three preloads."""
    study = Study.read(EXAMPLES / "t-specimen" / "study.toml")
    result = faying.run(replace(study, alternatives=(), modes=replace(study.modes, levels=())))
    test = result.comparison
    load, column = np.nonzero(test.modes >= 0)
    scores, widths = scored(result, load, test.modes[load, column], test.frequencies[load, column])
    return Measured(name="T-specimen", scores=scores, widths=widths)


def beam() -> tuple[Measured, faying.Result] | None:
    """The first frequency of the Brake-Reuss beam with its measured form; None where the measurement is absent."""
    path = EXAMPLES / "brake-reuss-beam" / "measured-form.toml"
    if not (path.parent / "data" / "gap-map.csv").is_file():
        return None
    study = Study.read(path)
    result = faying.run(replace(study, backbone=None, modes=replace(study.modes, count=3, levels=(0.3, 3.0, 13.5))))
    zero = np.zeros(1, dtype=int)
    scores, widths = scored(result, zero, zero, np.array([BEAM["at rest"]]))
    return Measured(name="Brake-Reuss beam", scores=scores, widths=widths), result


def main() -> None:
    """Print the shares, and draw them where a file is named."""
    every = [t_specimen()]
    other = beam()
    if other is not None:
        every.append(other[0])
        result = other[1]
        for k, level in enumerate(result.levels):
            low, high = 100 * result.level_low[-1, k, 0], 100 * result.level_high[-1, k, 0]
            print(
                f"beam, {level:g} m/s2: damping {low:.3f} .. {high:.3f} %, {result.level_frequencies[-1, k, 0]:.2f} Hz"
            )
        print(f"beam: {result.interval_low[-1, 0]:.2f} .. {result.interval_high[-1, 0]:.2f} Hz")
    every.append(
        Measured(
            name="all",
            scores=np.concatenate([one.scores for one in every]),
            widths=np.concatenate([one.widths for one in every]),
        )
    )
    print("structure, frequencies, median width [%], share inside at", NOMINAL)
    for one in every:
        shares = ", ".join(f"{one.inside(share):.2f}" for share in NOMINAL)
        print(
            f"{one.name}, {len(one.scores)}, {100 * np.median(one.widths):.1f}, {shares}; scores {one.scores.round(2)}"
        )
    if len(sys.argv) > 1:
        draw(every[-1], Path(sys.argv[1]))


@drawing
def draw(measured: Measured, path: Path) -> None:
    """The reliability diagram: share inside against nominal share; on the line intervals hold what they say.

    The band holds 90 % of the shares that as many independent frequencies have where the intervals are right.
    """
    nominal, count = np.linspace(0.02, 0.98, 97), len(measured.scores)
    figure = new_figure(COLUMN, COLUMN)
    ax = figure.subplots()
    low, high = (binom.ppf(end, count, nominal) / count for end in (0.05, 0.95))
    ax.fill_between(nominal, low, high, color="0.85", step="mid", label="90 % by chance")
    ax.plot([0, 1], [0, 1], color="0.4", lw=1, label="as stated")
    shares = [measured.inside(share) for share in nominal]
    ax.step(nominal, shares, where="mid", color=COLOURS[0], label=f"{count} measured frequencies")
    ax.set(xlabel="nominal share of the interval", ylabel="share of them inside", xlim=(0, 1), ylim=(0, 1))
    legend_above(ax, 1)
    save(figure, path)


if __name__ == "__main__":
    main()
