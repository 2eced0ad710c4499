"""Do the intervals of a run hold what was measured? Shares inside, by the nominal share, of measured structures.

    python benchmarks/coverage.py [coverage.svg]

Frequencies: the T-specimen (five modes of a hammer test at three preloads) and, where its measured interface lies in
examples/brake-reuss-beam/data (make_data.py writes it), the Brake-Reuss beam: two modes, at both ends of the published
plots of its measured curves. Damping: the same curves, and structures of which a damping at rest was published. k_n:
the measured stiffnesses of docs/theory/measured-over-laws.csv, in the range of the default law.

Nobody published the dimensions of the T-specimen. "As fitted" has those of the study, fitted to what all five modes
have in the mean over the loads. "From all modes" lets them scatter over the bounds of identify.py, as far as these
means leave them open. "From the other modes" predicts each mode with dimensions that only the four others narrow.
"""

import csv
import sys
from collections.abc import Callable
from dataclasses import dataclass, replace
from importlib import import_module
from itertools import combinations_with_replacement
from pathlib import Path

import numpy as np
from law_range import specimens
from scipy.linalg import block_diag
from scipy.stats import binom, norm, qmc

import faying
from faying.case.law_range import law_range
from faying.case.level_damping import FRICTION, REST
from faying.case.scatter import SCORE
from faying.study import Study
from faying.style import COLOURS, COLUMN, drawing, legend_above, new_figure, save

EXAMPLES = Path(__file__).parents[1] / "examples"
AT_REST = EXAMPLES.parent / "docs" / "theory" / "damping-at-rest.csv"
NOMINAL = np.array([0.5, 0.8, 0.9, 0.95])
TEST = 2e-3  # standard deviation of ln f of the hammer test, which is rounded to 5 Hz
TRAINED, DRAWN = 256, 2**18  # dimensions of the plane model, and of the polynomial through it
OF_EACH_MODE = ("waves", "mode")  # what moves one mode does not tell how it moves another


@dataclass(frozen=True, kw_only=True)
class Plot:
    """Limits of a published plot of a measured curve, over the level: frequency falls and damping rises with it.

    Porter and Brake 2023, doi:10.1016/j.ymssp.2023.110210, and its code (PLOTS/elastic_bb.m): the axes of the plots
    that show the measurement alone, and the viscous damping that it adds to all models. Limits of axes are near the
    curve for frequencies, and rounded to one digit for damping.

    Args:
        mode: of the study, from 0.
        levels: least and greatest [m/s2].
        frequencies: at these [Hz].
        damping: at these [-].
        at_rest: damping ratio at rest [-].
    """

    mode: int
    levels: tuple[float, float]
    frequencies: tuple[float, float]
    damping: tuple[float, float]
    at_rest: float


PLOTS = {
    "bending mode 1": Plot(
        mode=0, levels=(0.28, 13.5), frequencies=(180.0, 175.5), damping=(5e-4, 1e-2), at_rest=8.7e-4
    ),
    "bending mode 2": Plot(
        mode=2, levels=(0.6, 45.0), frequencies=(595.0, 591.8), damping=(2e-4, 1e-2), at_rest=3.4e-4
    ),
}
SMALL = 0.1  # m/s2, at rest


@dataclass(frozen=True, kw_only=True)
class Measured:
    """Measured values of one structure in units of their interval.

    Args:
        name: of the structure.
        scores: distance from the middle (n,), in standard deviations of the interval [-].
        widths: from 5 to 95 % (n,), of the logarithm [-].
    """

    name: str
    scores: np.ndarray
    widths: np.ndarray

    def inside(self, nominal: float) -> float:
        """Share of the values in the interval of a nominal share [-]."""
        return float(np.mean(np.abs(self.scores) <= norm.ppf((1 + nominal) / 2)))

    def __str__(self) -> str:
        shares = ", ".join(f"{self.inside(share):.2f}" for share in NOMINAL)
        width = 100 * np.median(self.widths)
        return f"{self.name}, {len(self.scores)}, {width:.1f}, {shares}; scores {self.scores.round(2)}"


def scored(offsets: np.ndarray, median: np.ndarray, test: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Scores and widths (n,) of measured frequencies [Hz] (n,), from the best estimates and offsets (sources, 2, n)."""
    away = np.log(test / median)
    down, up = np.linalg.norm([np.minimum(offsets.min(axis=1), 0.0), np.maximum(offsets.max(axis=1), 0.0)], axis=1)
    return away / (np.where(away < 0, down, up) / SCORE), down + up


@dataclass(frozen=True, kw_only=True)
class Tee:
    """The T-specimen: its test, what a run gives for it, and a plane model of its dimensions.

    Args:
        test, frequencies: ln of the measured and of the best estimates [Hz] (loads, modes).
        offsets: of ln f (sources, 2, loads, modes).
        sources: their names.
        plane: ln of five frequencies of the plane model [Hz] of dimensions [mm] (4,).
        start: dimensions of the study [mm].
        bounds: least and greatest [mm] (2, 4).
    """

    test: np.ndarray
    frequencies: np.ndarray
    offsets: np.ndarray
    sources: tuple[str, ...]
    plane: Callable[[np.ndarray], np.ndarray]
    start: np.ndarray
    bounds: np.ndarray

    @classmethod
    def of_study(cls) -> "Tee":
        """From a run of the study."""
        folder = EXAMPLES / "t-specimen"
        sys.path.insert(0, str(folder))
        identify = import_module("identify")
        study = Study.read(folder / "study.toml")
        result = faying.run(replace(study, alternatives=(), modes=replace(study.modes, levels=())))
        load, modes = np.arange(len(result.loads))[:, None], result.comparison.modes
        return cls(
            test=np.log(result.comparison.frequencies),
            frequencies=np.log(result.interval.best[load, modes]),
            offsets=result.interval.offsets[:, :, load, modes],
            sources=result.interval.sources,
            plane=lambda x: np.log(identify.in_plane(identify.dimensions(x))),
            start=identify.START,
            bounds=identify.BOUNDS,
        )

    def as_fitted(self) -> Measured:
        """With the dimensions of the study."""
        flat = self.offsets.reshape(*self.offsets.shape[:2], -1)
        scores, widths = scored(flat, np.exp(self.frequencies.ravel()), np.exp(self.test.ravel()))
        return Measured(name="T-specimen, dimensions as fitted", scores=scores, widths=widths)

    def covariance(self) -> np.ndarray:
        """Of ln f (mode by mode, loads within), without the dimensions."""
        loads, modes = self.test.shape
        total = np.eye(loads * modes) * TEST**2
        for name, (low, high) in zip(self.sources, self.offsets, strict=True):
            sd = ((high - low) / (2 * SCORE)).T  # (modes, loads)
            blocks = [np.outer(row, row) for row in sd]
            total += block_diag(*blocks) if name in OF_EACH_MODE else np.outer(sd.ravel(), sd.ravel())
        return total

    def sampled(self) -> tuple[np.ndarray, np.ndarray]:
        """Dimensions spread over the bounds [mm] (n, 4), and ln of their five frequencies [Hz] (n, 5).

        By a cubic through the plane model in the logarithms, which misses it by 0.04 to 0.3 %.
        """
        ends = np.log(self.bounds)

        def terms(x: np.ndarray) -> np.ndarray:
            u = (2 * np.log(x) - ends.sum(axis=0)) / np.diff(ends, axis=0)
            every = [which for k in range(4) for which in combinations_with_replacement(range(u.shape[1]), k)]
            return np.stack([np.prod(u[:, list(which)], axis=1) for which in every], axis=1)

        trained = qmc.scale(qmc.Sobol(len(self.start), seed=1).random(TRAINED), *self.bounds)
        found = [self.plane(x) for x in trained]
        full = [k for k, one in enumerate(found) if len(one) == self.test.shape[1]]
        fit = np.linalg.lstsq(terms(trained[full]), np.array([found[k] for k in full]), rcond=None)[0]
        x = qmc.scale(qmc.Sobol(len(self.start), seed=2).random(DRAWN), *self.bounds)
        return x, terms(x) @ fit

    def as_scatter(self) -> tuple[Measured, Measured]:
        """With dimensions that scatter over their bounds: weighted by the means over the loads of all modes, and of the
        others alone for each mode.
        """
        loads, modes = self.test.shape
        x, plane = self.sampled()
        middle = self.frequencies.T  # (modes, loads)
        ratio, test, noise = middle - self.plane(self.start)[:, None], self.test.T, self.covariance()
        mean = np.kron(np.eye(modes), np.ones(loads) / loads)  # (modes, modes x loads)
        left = (test - ratio).mean(axis=1) - plane  # (n, modes)
        found: dict[bool, list[tuple[np.ndarray, np.ndarray]]] = {True: [], False: []}
        for mode in range(modes):
            own = slice(mode * loads, (mode + 1) * loads)
            for alone in (True, False):
                known = np.arange(modes) != mode if alone else np.ones(modes, dtype=bool)
                take = mean[known]
                inverse = np.linalg.inv(take @ noise @ take.T)
                chances = -0.5 * np.einsum("ni,ij,nj->n", left[:, known], inverse, left[:, known])
                keep = chances > chances.max() - 20
                weights = np.exp(chances[keep] - chances.max())
                weights /= weights.sum()
                expected, spread = plane[keep, mode, None] + ratio[mode], noise[own, own]
                if alone:  # what the other modes tell of what all modes share
                    gain = noise[own] @ take.T @ inverse
                    expected, spread = expected + left[keep][:, known] @ gain.T, spread - gain @ take @ noise[:, own]
                sd = np.sqrt(np.diag(spread))
                score = norm.ppf(weights @ norm.cdf((test[mode] - expected) / sd))
                centre = weights @ expected
                whole = np.sqrt(weights @ (expected - centre) ** 2 + sd**2)
                found[alone].append((score, 2 * SCORE * whole))
                if alone:
                    dimensions = (weights @ x[keep]).round(0)
                    print(f"T-specimen without mode {mode + 1}: {dimensions} mm, off by", 100 * (test[mode] - centre))
        every, others = (
            Measured(name=f"T-specimen, {name}", scores=np.concatenate(s), widths=np.concatenate(w))
            for name, (s, w) in (
                ("dimensions from all modes", zip(*found[False], strict=True)),
                ("dimensions from the other modes", zip(*found[True], strict=True)),
            )
        )
        return every, others


def beam() -> tuple[Measured, list[tuple[str, bool]]] | None:
    """Frequencies and damping of the Brake-Reuss beam with its measured form; None where the measurement is absent."""
    path = EXAMPLES / "brake-reuss-beam" / "measured-form.toml"
    if not (path.parent / "data" / "gap-map.csv").is_file():
        return None
    study = Study.read(path)
    levels = tuple(sorted({SMALL, *(level for plot in PLOTS.values() for level in plot.levels)}))
    study = replace(study, backbone=None, modes=replace(study.modes, count=3, levels=levels))
    result = faying.run(study)
    ends = []
    for friction in (FRICTION[0], FRICTION[2]):
        joints = tuple(replace(joint, friction=friction) for joint in study.joints)
        other = faying.run(replace(study, joints=joints, modes=replace(study.modes, intervals=False)))
        ends.append(np.log(other.levels.frequencies / result.levels.frequencies)[-1])
    scores, widths, damping = [], [], []
    for name, plot in PLOTS.items():
        for level, test in zip(plot.levels, plot.frequencies, strict=True):
            k = levels.index(level)
            friction_ends = np.array([[end[k, plot.mode]] for end in ends])
            offsets = np.concatenate([result.interval.offsets[:, :, -1, plot.mode, None], friction_ends[None]])
            best = (result.interval.best / result.frequencies)[-1, plot.mode]
            score, width = scored(offsets, best * result.levels.frequencies[-1, k, plot.mode, None], np.array([test]))
            print(f"beam, {name}, {level:g} m/s2: {result.levels.frequencies[-1, k, plot.mode]:.2f} Hz, test {test:g}")
            scores.append(score)
            widths.append(width)
        rows = ((SMALL, plot.at_rest), *zip(plot.levels, plot.damping, strict=True))
        for level, ratio in rows:
            k = levels.index(level)
            low, high = (float(end[-1, k, plot.mode]) for end in (result.levels.low, result.levels.high))
            words = f"beam, {name}, {level:g} m/s2: {100 * ratio:g} % of {100 * low:.3f} .. {100 * high:.3f} %"
            damping.append((words, low <= ratio <= high))
    return (
        Measured(name="Brake-Reuss beam, measured form", scores=np.concatenate(scores), widths=np.concatenate(widths)),
        damping,
    )


def stiffnesses() -> list[Measured]:
    """k_n of joints and of specimens of ultrasound and conductance, in the range of the default law."""
    groups: dict[str, list[tuple[float, float]]] = {}
    for one in specimens("half-space"):
        own = law_range("half-space").of(soft=one.soft)
        metal = "soft metals" if one.soft else "steel"
        for name in (f"{one.source.split(',')[0].split(' (')[0]}, {metal}", metal, "all"):
            scores = [(float(own.standardised(np.exp(value))), 2 * SCORE * own.spread) for value in one.values]
            groups.setdefault(name, []).extend(scores)
    return [
        Measured(name=f"k_n, {name}", scores=np.array(rows)[:, 0], widths=np.array(rows)[:, 1])
        for name, rows in groups.items()
    ]


def main() -> None:
    """Print the shares, and draw them where a file is named."""
    tee = Tee.of_study()
    every, others = tee.as_scatter()
    found, rows = beam(), [tee.as_fitted(), every, others]
    damping: list[tuple[str, bool]] = []
    if found is not None:
        rows.append(found[0])
        damping += found[1]
        every, others = (joined(one, found[0]) for one in (every, others))
        rows += [every, others]
    low, high = 100 * REST[0], 100 * REST[2]
    for row in csv.DictReader(AT_REST.open(encoding="utf-8")):
        ratio = float(row["damping ratio [%]"])
        damping.append((f"{row['structure']}: {ratio:g} % of {low:g} .. {high:g} % at rest", low <= ratio <= high))
    print("values, number, median width [%], share inside at", NOMINAL)
    for one in rows:
        print(one)
    for words, inside in damping:
        print(words, "" if inside else "OUTSIDE")
    print(f"damping: {sum(inside for _, inside in damping)} of {len(damping)} inside", flush=True)
    if len(sys.argv) > 1:
        draw({"T-specimen by all modes": every, "each mode by the others": others}, Path(sys.argv[1]))
    for one in stiffnesses():
        print(one)


def joined(one: Measured, other: Measured) -> Measured:
    """Both together."""
    return Measured(
        name=f"{one.name}, and beam",
        scores=np.concatenate([one.scores, other.scores]),
        widths=np.concatenate([one.widths, other.widths]),
    )


@drawing
def draw(every: dict[str, Measured], path: Path) -> None:
    """The reliability diagram: share inside against nominal share; on the line intervals hold what they say.

    The band holds 90 % of the shares that as many independent frequencies have where the intervals are right.
    """
    nominal, count = np.linspace(0.02, 0.98, 97), len(next(iter(every.values())).scores)
    figure = new_figure(COLUMN, COLUMN)
    ax = figure.subplots()
    low, high = (binom.ppf(end, count, nominal) / count for end in (0.05, 0.95))
    ax.fill_between(nominal, low, high, color="0.85", step="mid", label=f"90 % by chance, {count} frequencies")
    ax.plot([0, 1], [0, 1], color="0.4", lw=1, label="as stated")
    for (name, one), style, ink in zip(every.items(), ("-", "--"), COLOURS, strict=False):
        shares = [one.inside(share) for share in nominal]
        ax.step(nominal, shares, where="mid", color=ink, ls=style, label=name)
    ax.set(xlabel="nominal share of the interval", ylabel="share of them inside", xlim=(0, 1), ylim=(0, 1))
    legend_above(ax, 1)
    save(figure, path)


if __name__ == "__main__":
    main()
