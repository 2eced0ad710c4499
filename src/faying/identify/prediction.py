"""What scatter makes of the frequencies of a study: its samples, what follows from them, on disk, and drawn."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from statistics import NormalDist
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np

from faying.errors import InputError
from faying.identify.sampling.ensemble import Inputs
from faying.identify.sampling.surrogate import Surrogate
from faying.identify.shares import Shares, shares
from faying.misuse import checked_call, shortened
from faying.notes import Note
from faying.result.fields import Recorded, load_texts, optional, variable
from faying.result.fields import listed as numbers
from faying.result.provenance import Provenance
from faying.result.run_record import preload_slope
from faying.study.keys.uncertain import is_draw
from faying.style import (
    COLOURS,
    WIDE,
    axes_of,
    colour,
    drawing,
    headline,
    load_colours,
    new_figure,
)
from faying.text import listed, notes_row
from faying.typeset import name_of
from faying.typing import Array, Mask
from faying.units import load_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LEVELS = (0.05, 0.5, 0.95)
# normal scores in the middle of equal shares of the probability, scaled to a variance of 1
_MIDDLES = [NormalDist().inv_cdf((k + 0.5) / 25) for k in range(25)]
SCORES = tuple(float(z / np.std(_MIDDLES)) for z in _MIDDLES)
MAX_MODES = 5  # that a summary has a line for
POINTS = 4096  # at which the shares of variance are taken


@dataclass(frozen=True, kw_only=True)
class Quantiles:
    """Quantiles over the samples that have an answer, one row for each level.

    Args:
        levels: Shares of the samples below (q,) [-].
        frequencies: (q, load, mode) [Hz], each mode of the median followed by its shape.
        loss_factors: (q, load, mode) [-]; NaN where no law predicts loss.
        slopes: Change with preload (q, mode) [Hz/N], by a line through all loads; NaN for a single load.
        paired: Frequencies of the test's modes (q, load, test mode) [Hz]; None where the study has no test.
    """

    levels: tuple[float, ...]
    frequencies: Array
    loss_factors: Array
    slopes: Array
    paired: Array | None


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Prediction(Recorded):
    """A study under the scatter of its numbers.

    Args:
        title: Of the study.
        inputs: What scatters.
        seed: Of the samples.
        tolerance: Relative error of a frequency that the bases were made for.
        basis: Sizes of the bases for equilibrium and vibration.
        reasons: Why samples have no answer, and how many.
        notes: What there is to say.
        test, test_source: The test, where the study has one.
    """

    KIND: ClassVar[str] = "prediction"
    COMMAND: ClassVar[str] = "faying predict STUDY.toml"

    title: str
    inputs: Inputs
    seed: int
    tolerance: float
    basis: tuple[int, int]
    loads: Array = variable("load", "N", "preload of the first bolt", "preload")
    values: Array = variable("sample input", "", "values drawn, in the unit of each input", "samples/value")
    frequencies: Array = variable(
        "sample load mode", "Hz", "frequencies of the median's modes", "samples/frequency", gaps=True
    )
    loss_factors: Array = variable("sample load mode", "1", "modal loss factors", "samples/loss_factor", gaps=True)
    open_share: Array = variable("sample load", "1", "share of the joints that is open", "samples/", gaps=True)
    above_range_share: Array = variable(
        "sample load", "1", "share of the contact above the end of the law", "samples/above_range_share", gaps=True
    )
    discrepancy: Array = variable(
        "load mode", "1", "standard deviation of ln f that samples lack: of the mode, and of parts that do not scatter"
    )
    paired: Array | None = optional(
        "sample load test_mode", "Hz", "frequencies of the test's modes", "samples/frequency_of_test_mode", gaps=True
    )
    discrepancy_of_test_mode: Array | None = optional(
        "load test_mode", "1", "discrepancy of the test's modes", gaps=True
    )
    test: Array | None = optional("load test_mode", "Hz", "measured frequencies", "test/frequency", gaps=True)
    test_source: str = ""
    reasons: dict[str, int] = field(default_factory=dict)
    notes: tuple[Note, ...] = ()
    provenance: Provenance | None = None

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, what scatters, and the intervals of the first frequencies at the last preload."""
        head = f"Prediction {self.title!r}: {self.answered} of {len(self.values)} samples have an answer"
        rows = {"scatters": listed(self.names, 4), "preloads": listed(load_texts(self.loads))}
        if not self.answered:
            return head, rows | {"why": shortened("; ".join(self.reasons))}
        values, test, lacking = self.observed
        low, middle, high = _levels(with_discrepancy(values[self.sound], lacking)[:, -1], LEVELS)
        rows["frequencies"] = f"5 % | 50 % | 95 % at {load_texts(self.loads)[-1]}"
        shown = min(len(middle), MAX_MODES)
        for k in range(shown):
            measured = f", test {test[-1, k]:.2f} Hz" if np.isfinite(test[-1, k]) else ""
            rows[f"mode {k + 1}"] = f"{low[k]:.2f} | {middle[k]:.2f} | {high[k]:.2f} Hz{measured}"
        if len(middle) > shown:
            rows["more modes"] = str(len(middle) - shown)
        inside, count = self.covered
        rows |= {"test": f"{inside} of {count} frequencies between 5 and 95 %"} if count else {}
        return head, rows | notes_row(self.notes)

    @property
    def names(self) -> tuple[str, ...]:
        """What scatters."""
        return self.inputs.names

    @property
    def sound(self) -> Any:
        """Which samples have an answer (n,)."""
        return np.isfinite(self.frequencies[:, 0, 0])

    @property
    def answered(self) -> int:
        """How many samples have an answer."""
        return int(np.count_nonzero(self.sound))

    @checked_call
    def quantiles(self, levels: Sequence[float] = LEVELS) -> Quantiles:
        """Quantiles of frequencies, loss factors and slopes.

        Args:
            levels: Shares from 0 to 1 of the samples that lie below.

        Raises:
            InputError: A level outside 0 to 1, or no sample with an answer.
        """
        if not len(levels) or not all(0 <= level <= 1 for level in levels):
            raise InputError(f"levels {tuple(levels)} should be shares from 0 to 1, for example (0.05, 0.5, 0.95)")
        return self._quantiles(tuple(map(float, levels)), self.sound)

    def _quantiles(self, levels: tuple[float, ...], which: Any) -> Quantiles:
        if not np.any(which):
            raise InputError(f"no sample has an answer: {'; '.join(self.reasons)}")
        paired = None
        if self.paired is not None and self.discrepancy_of_test_mode is not None:
            paired = _levels(with_discrepancy(self.paired[which], self.discrepancy_of_test_mode), levels)
        return Quantiles(
            levels=levels,
            frequencies=_levels(with_discrepancy(self.frequencies[which], self.discrepancy), levels),
            loss_factors=_levels(self.loss_factors[which], levels),
            slopes=_levels(self.slopes[which], levels),
            paired=paired,
        )

    @cached_property
    def slopes(self) -> Array:
        """Change of each mode's frequency with preload (sample, mode) [Hz/N], by a line; NaN for a single load."""
        return np.stack([preload_slope(one, self.loads) for one in self.frequencies])

    @cached_property
    def convergence(self) -> float:
        """What the 5 and 95 % of the frequencies move by when half of the samples are left out, over their distance.

        The greatest over modes and loads [-]; NaN with fewer than 16 samples.
        """
        half = self.sound & (np.arange(len(self.values)) < len(self.values) // 2)
        if self.answered < 16 or not np.any(half):
            return float("nan")
        whole, part = (self._quantiles((0.05, 0.95), which).frequencies for which in (self.sound, half))
        width = np.maximum(whole[1] - whole[0], 1e-9 * whole[1])
        return float((np.abs(part - whole) / width).max())

    @property
    def observed(self) -> tuple[Array, Array, Array]:
        """Frequencies (sample, load, k), their test and discrepancy (load, k): of the test's modes, or else of all."""
        if self.paired is None or self.test is None or self.discrepancy_of_test_mode is None:
            return self.frequencies, np.full(self.frequencies.shape[1:], np.nan), self.discrepancy
        return self.paired, self.test, self.discrepancy_of_test_mode

    @property
    def covered(self) -> tuple[int, int]:
        """How many of the measured frequencies lie between the 5 and the 95 %, and how many there are."""
        if self.paired is None or self.test is None:
            return 0, 0
        low, high = self.quantiles((0.05, 0.95)).paired  # type: ignore[misc]
        inside = (self.test >= low) & (self.test <= high)
        return int(inside.sum()), int(np.isfinite(self.test).sum())

    def shares(self) -> tuple[Shares, Array]:
        """Shares of the variance of the frequencies at the last load that each of `blamed` has.

        Those of inputs are of a polynomial through the samples, in the scores of the inputs; one for each law. What it
        does not explain has a share, the draws of waves among it, and so has the discrepancy.

        Returns:
            The shares of each mode: of the test's modes, or of all where there is no test; and the polynomial's
            leave-one-out error (mode,), over the standard deviation of the frequency [-].

        Raises:
            InputError: Too few samples with an answer.
        """
        return self._shares

    @property
    def columns(self) -> list[int]:
        """Columns of the inputs that a polynomial can follow: all but the seeds of waves, which name a draw."""
        return [k for k, name in enumerate(self.names) if not is_draw(name)]

    @property
    def blamed(self) -> tuple[str, ...]:
        """What has a share of the variance: inputs, what no polynomial of them explains, and the discrepancy."""
        drawn = len(self.columns) < len(self.names)
        rest = ("draws of waves, and what is not explained" if drawn else "not explained", "discrepancy")
        return (*(self.names[k] for k in self.columns), *rest)

    @cached_property
    def _shares(self) -> tuple[Shares, Array]:
        seen, lacking = self.observed[0][:, -1], self.observed[2][-1]
        inputs, columns = self.inputs, self.columns
        numeric = len(columns) - bool(inputs.models)
        if not numeric:
            raise InputError("only draws of waves or laws scatter, whose shares no polynomial has")
        needed = 2 * (numeric + 1)
        answers = np.isfinite(seen[self.sound]).sum(axis=0)
        modes = np.flatnonzero(answers >= needed)
        if not len(modes):
            raise InputError(
                f"at most {answers.max(initial=0)} samples have an answer; shares of {numeric} inputs need {needed}"
            )

        def at_modes(values: Array) -> Array:
            """Values of all modes, NaN of those with too few answers."""
            out = np.full((seen.shape[1], *values.shape[1:]), np.nan)
            out[modes] = values
            return out

        def scored(values: Array) -> Array:
            """Standard normal scores (n, k) of the columns (k, n) that are numbers."""
            numbers = zip(columns[:numeric], values, strict=False)
            return np.stack([inputs.priors[k].score(x) for k, x in numbers], axis=1)

        laws, scores = self._laws(self.values), scored(self.values.T[columns[:numeric]])
        fits, squared = {}, np.zeros(len(modes))
        for law in np.unique(laws[self.sound]):
            here = self.sound & (laws == law)
            fits[law] = Surrogate.fit(scores[here], seen[here][:, modes])
            squared = squared + fits[law].error ** 2 * np.count_nonzero(here)

        def function(values: Array) -> Array:
            out = np.empty((len(values), len(modes)))
            which, at = self._laws(values), scored(values.T)
            for law in np.unique(which):
                # a law without any answer has no part in the variance of the answers
                out[which == law] = fits.get(law, next(iter(fits.values()))).predict(at[which == law])
            return out

        variance = np.nanvar(seen[self.sound][:, modes], axis=0)
        missed = squared / self.answered / np.where(variance > 0, variance, np.inf)
        beyond = (lacking[modes] * np.nanmean(seen[self.sound][:, modes], axis=0)) ** 2
        found = shares(function, [inputs.priors[k] for k in columns], count=POINTS)
        sampled = variance / np.where(variance + beyond > 0, variance + beyond, 1.0)
        unexplained = np.minimum(missed, 1.0) * sampled
        found = found.beside(sampled - unexplained, np.stack([unexplained, 1 - sampled], axis=-1))
        return Shares(first=at_modes(found.first), total=at_modes(found.total)), at_modes(np.sqrt(missed))

    def _laws(self, values: Array) -> Any:
        """Place of the law of each sample (n,); 0 where the law is certain."""
        if not self.inputs.models:
            return np.zeros(len(values), dtype=int)
        names = [name for name, _ in self.inputs.models]
        return np.array([names.index(self.inputs.model(share)) for share in values[:, -1]])

    def to_dict(self) -> dict[str, Any]:
        """Return a summary ready for JSON, in SI units; the samples are in the file."""
        found = self.quantiles(LEVELS)
        out: dict[str, Any] = {
            "title": self.title,
            "samples": len(self.values),
            "answered": self.answered,
            "without_answer": self.reasons,
            "loads": {"unit": "N", "values": numbers(self.loads)},
            "inputs": [{"key": c.key, "distribution": c.distribution.text(c.unit)} for c in self.inputs.columns],
            "laws": dict(self.inputs.models),
            "quantiles": {
                "levels": list(LEVELS),
                "frequencies": {"unit": "Hz", "values": numbers(found.frequencies)},
                "loss_factors": {"unit": "1", "values": numbers(found.loss_factors)},
                "slopes": {"unit": "Hz/N", "values": numbers(found.slopes)},
            },
            "convergence": numbers(self.convergence),
            "notes": [{"code": note.code, "text": note.text} for note in self.notes],
        }
        if found.paired is not None and self.test is not None:
            inside, count = self.covered
            out["test"] = {
                "source": self.test_source,
                "frequencies": {"unit": "Hz", "values": numbers(self.test)},
                "predicted": {"unit": "Hz", "values": numbers(found.paired)},
                "covered": {"between 5 and 95 %": inside, "of": count},
            }
        try:
            shares, error = self.shares()
        except InputError as fault:
            return out | {"shares": {"none": str(fault)}}
        parts = {"first": numbers(shares.first), "total": numbers(shares.total)}
        return out | {"shares": {"inputs": list(self.blamed), **parts, "surrogate_error": numbers(error)}}

    def labels(self) -> dict[str, Any]:
        """Labels of the dimensions of its arrays, by the name of the dimension."""
        modes = np.arange(1, self.frequencies.shape[2] + 1)
        out: dict[str, Any] = {"load": load_texts(self.loads), "mode": modes, "input": self.names}
        return out | ({} if self.test is None else {"test_mode": np.arange(1, self.test.shape[1] + 1)})

    def with_notes(self, notes: Sequence[Note]) -> Self:
        """The same with more to say."""
        return replace(self, notes=(*self.notes, *notes))

    @drawing
    @checked_call
    def plot(self, ax: "Axes | None" = None) -> "Axes":
        """Draw the 5 to 95 % of each frequency about its median, with the test where there is one.

        Args:
            ax: Matplotlib axes to draw into; new ones where None.

        Returns:
            The axes.

        Raises:
            InputError: It is not axes, or no sample has an answer.
        """
        if not self.answered:
            raise InputError(f"no sample has an answer: {'; '.join(self.reasons)}")
        (target,) = axes_of(ax, 1, width=WIDE, height=_height(self))
        _draw_intervals(target, self)
        target.legend(loc="best")
        return target


def with_discrepancy(values: Array, discrepancy: Array) -> Array:
    """Frequencies (n, load, k), and those that a discrepancy (load, k) makes of each in equal shares: more samples."""
    return np.concatenate([values * np.exp(discrepancy * score) for score in SCORES])


def _levels(values: Array, levels: tuple[float, ...]) -> Array:
    """Quantiles (q, ...) over the first axis, NaN left out; NaN where nothing is left."""
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # all-NaN columns, such as losses where none is predicted
        return np.asarray(np.nanquantile(values, levels, axis=0))


@drawing
def intervals(found: Prediction) -> Any:
    """Return the figure of the 5 to 95 % of each frequency over its median, one column a preload, the test as dots."""
    fig = new_figure(WIDE, _height(found))
    _draw_intervals(fig.subplots(), found)
    fig.legend(loc="outside lower center", ncols=4)
    return fig


def _height(found: Prediction) -> float:
    """Of the figure of intervals [inches]."""
    return float(max(2.1, 1.2 + 0.24 * found.observed[0].shape[2] * len(found.loads) ** 0.5))


def _draw_intervals(ax: Any, found: Prediction) -> None:
    test, levels = found.observed[1], found.quantiles(LEVELS)
    predicted = levels.frequencies if levels.paired is None or found.test is None else levels.paired
    about_median(ax, list(map(load_text, found.loads)), predicted, test, np.full(len(found.loads), True))
    if np.isfinite(test).any():
        ax.plot([], [], "s", ms=4.5, mfc="white", mec="0.3", mew=1.2, label="test")
    ax.set_xlabel("difference from the median [%]; bars from 5 to 95 %")
    ax.set_ylabel("mode and its median")
    ax.set_title(headline(found.title))


def about_median(ax: Any, loads: Sequence[str], predicted: Array, test: Array, hollow: Mask, unit: str = "Hz") -> None:
    """Draw predicted quantiles (3, load, mode) over their median, and what was measured (load, mode) as squares.

    loads: their labels; hollow: at which of them the squares are empty (load,).
    """
    low, middle, high = predicted
    count, modes = len(loads), middle.shape[1]
    for k, (load, shade) in enumerate(zip(loads, load_colours(count), strict=True)):
        y = np.arange(modes) + (k - (count - 1) / 2) * 0.7 / count
        ends = [100 * (1 - low[k] / middle[k]), 100 * (high[k] / middle[k] - 1)]
        ax.errorbar(np.zeros(modes), y, xerr=ends, fmt="|", color=shade, lw=2.2, ms=7, label=load)
        face = "white" if hollow[k] else shade
        ax.plot(100 * (test[k] / middle[k] - 1), y, "s", ms=4.5, mfc=face, mec=shade, mew=1.2)
    last = [f"{value:.0f} {unit}" if unit else f"loss {value:.2g}" for value in middle[-1]]
    ax.set_yticks(range(modes), [f"{k + 1}: {text}" for k, text in enumerate(last)])
    ax.invert_yaxis()
    ax.grid(axis="x", alpha=0.3)


@drawing
def tornado(found: Prediction) -> Any:
    """Return the figure of the shares of the variance of each mode at the last preload, first order and total."""
    shares, _ = found.shares()
    modes = len(shares.first)
    order = np.argsort(np.nanmean(shares.total, axis=0))[::-1]
    fig = new_figure(WIDE, 1.3 + 0.22 * modes + 0.08 * len(found.blamed))
    ax = fig.subplots()
    left = np.zeros(modes)
    for rank, k in enumerate(order):
        width = np.clip(np.nan_to_num(shares.first[:, k]), 0, None)
        look = {"color": colour(rank), "hatch": "//" if rank >= len(COLOURS) else None}
        ax.barh(range(modes), 100 * width, left=100 * left, height=0.7, label=name_of(found.blamed[k]), **look)
        left += width
    rest, look = np.clip(1 - left, 0, None), {"color": "white", "edgecolor": "0.6"}
    ax.barh(range(modes), 100 * rest, left=100 * left, height=0.7, label="together, not one alone", **look)
    ax.invert_yaxis()
    ax.set_yticks(range(modes), [str(k + 1) for k in range(modes)])
    ax.set(xlim=(0, 100), ylabel="mode" if found.paired is None else "test mode")
    ax.set_xlabel(f"share of the variance at {load_text(found.loads[-1])} [%]")
    fig.legend(loc="outside lower center", ncols=2)
    ax.set_title(headline(found.title))
    return fig
