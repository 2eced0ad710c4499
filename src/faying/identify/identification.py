"""What a test tells of the parameters of a model: its numbers, on disk, and drawn."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cached_property
from itertools import islice
from typing import TYPE_CHECKING, Any, ClassVar, Self, TypeVar, final

import numpy as np

from faying.distribution import Distribution
from faying.errors import ReadError
from faying.identify.fit import Fit, Identifiability
from faying.identify.prediction import about_median
from faying.misuse import checked_call
from faying.netcdf import Group, Variable
from faying.notes import Note
from faying.result.fields import RECORD, Recorded, from_group, listed, optional, to_group, variable
from faying.style import COLOURS, WIDE, axes_of, drawing, new_figure
from faying.text import listed as joined
from faying.text import notes_row
from faying.typeset import name_of
from faying.typing import Array, Mask
from faying.units import load_text, show

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from xarray import DataTree

LEVELS = (0.05, 0.5, 0.95)
MAX_PARAMETERS = 5  # that a summary has a line for


@final
@dataclass(frozen=True, kw_only=True)
class LawEvidence:
    """What a test says of one law: ln evidence and its sd, and the probability of the law among those compared [-]."""

    name: str
    log_evidence: float
    log_evidence_sd: float
    weight: float


Found = TypeVar("Found", bound="Identification")
OWN = "faying"  # the group of the file that holds everything


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Identification(Recorded):
    """The posterior of a model's parameters, and what it predicts.

    names, units, priors: of the parameters; the last two are the relative sd of the test's scatter and of the model's
    discrepancy. log_evidence: ln of the probability density of the test's ln f under this model; a difference between
    two models on one test is the logarithm of their odds. laws: that were compared, where several were; the parameters
    are then those of the likeliest, and the predicted frequencies are drawn from all. evaluations: of the model;
    answered: those with an answer; calls: of the likelihood; rounds: how often the surrogate was drawn closer to the
    posterior.
    """

    KIND: ClassVar[str] = "identification"
    COMMAND: ClassVar[str] = "faying identify STUDY.toml"

    names: tuple[str, ...]
    units: tuple[str, ...]
    priors: tuple[Distribution, ...]
    log_evidence: float
    log_evidence_sd: float
    evaluations: int
    answered: int
    rounds: int
    steps: int
    calls: int
    samples: Array = variable("draw parameter", "SI", "samples of the posterior, of one weight")
    log_likelihood: Array = variable("draw mode", "1", "ln likelihood of what was measured of a mode")
    loads: Array = variable("load", "N", "preload")
    test: Array = variable("load mode", "Hz", "frequencies of the test", gaps=True)
    used: Mask = variable("load mode", "1", "whether a frequency was used", dtype="bool")
    left_out: Mask = variable("load", "1", "whether a load was left out", dtype="bool")
    predictive: Array = variable("draw load mode", "Hz", "frequencies as measured", gaps=True)
    offset_mean: Array = variable("mode", "1", "offset of ln test from ln model: posterior mean")
    offset_sd: Array = variable("mode", "1", "offset of ln test from ln model: posterior sd")
    surrogate_error: Array = variable(
        "load mode", "1", "leave-one-out error of the surrogate about the posterior", gaps=True
    )
    checked: Array = variable("load mode", "1", "surrogate less model at points of the posterior, rms", gaps=True)
    fit: Fit
    singular: Identifiability
    notes: tuple[Note, ...] = ()
    laws: tuple[LawEvidence, ...] = ()
    losses: Array | None = optional("load mode", "1", "loss factors of the test", gaps=True)
    losses_used: Mask | None = optional("load mode", "1", "whether a loss factor was used", dtype="bool")
    predictive_losses: Array | None = optional("draw load mode", "1", "loss factors as measured", gaps=True)

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and the parameters with what the test says of them."""
        used = int(self.used.sum())
        head = f"Identification: {len(self.names)} parameters from {used} measured frequencies; `.table()` has all"
        rows = {"parameters": "5 % | 50 % | 95 %, sd over that of the prior"}
        shown = len(self.names) if len(self.names) <= MAX_PARAMETERS else MAX_PARAMETERS - 1
        for name, cells, share in islice(self._parameters(), shown):
            rows[name] = f"{' | '.join(cells)}, {share:.2f}"
        if len(self.names) > shown:
            rows["more"] = f"{len(self.names) - shown} parameters"
        rows["ln evidence"] = f"{self.log_evidence:.2f} +- {self.log_evidence_sd:.2f}"
        if self.laws:
            rows["laws"] = joined(f"{law.name} {law.weight:.0%}" for law in self.laws)
        rows["least squares"] = f"{self.fit.misfit:.2%} rms"
        return head, rows | notes_row(self.notes)

    @property
    def mean(self) -> Array:
        """Posterior means (d,), SI."""
        return np.asarray(self.samples.mean(axis=0))

    @property
    def sd(self) -> Array:
        """Posterior standard deviations (d,), SI."""
        return np.asarray(self.samples.std(axis=0, ddof=1))

    @property
    def posterior_contraction(self) -> Array:
        """Posterior over prior standard deviation (d,): near 1 where the test says nothing."""
        return np.asarray(self.sd / np.array([prior.sd for prior in self.priors]))

    def quantiles(self, levels: Sequence[float] = LEVELS) -> Array:
        """Posterior quantiles (level, d), SI."""
        return np.asarray(np.quantile(self.samples, levels, axis=0))

    @property
    def correlation(self) -> Array:
        """Correlation of the parameters in the posterior (d, d)."""
        return np.asarray(np.corrcoef(self.samples.T))

    @property
    def offsets(self) -> Array:
        """Offset b of ln test from ln model by mode: posterior mean and standard deviation (2, mode)."""
        return np.stack([self.offset_mean, self.offset_sd])

    @cached_property
    def predicted(self) -> Array:
        """5, 50 and 95 % of every frequency as a test would measure it (3, load, mode) [Hz]; left-out loads too."""
        return np.asarray(np.quantile(self.predictive, LEVELS, axis=0))

    @cached_property
    def predicted_losses(self) -> Array | None:
        """5, 50 and 95 % of every loss factor as a test would measure it (3, load, mode) [-]; None where none was."""
        return None if self.predictive_losses is None else np.quantile(self.predictive_losses, LEVELS, axis=0)

    # -- for people and programs

    def table(self) -> str:
        """What was found, for a terminal of 80 columns."""
        frequencies = self._lines(self.test, self.predicted, "test [Hz]", "11.2f")
        losses = []
        if self.losses is not None and self.predicted_losses is not None:
            losses = ["", *self._lines(self.losses, self.predicted_losses, "test loss", "11.2e")]
        lines = [f"{'parameter':<26}{'5 %':>13}{'50 %':>13}{'95 %':>13}  sd/prior"]
        for name, cells, share in self._parameters():
            lines.append(f"{name:<26}{''.join(f'{cell:>13}' for cell in cells)}{share:>10.2f}")
        return "\n".join([*lines, "", *frequencies, *losses, "", *self._closing_lines()])

    def _parameters(self) -> Iterator[tuple[str, list[str], float]]:
        """Name of each parameter, at most 25 letters; 5, 50 and 95 % with the unit; sd over that of the prior."""
        columns = zip(self.names, self.units, self.quantiles().T, self.posterior_contraction, strict=True)
        for name, unit, row, share in columns:
            cells = [show(v, unit) if unit else f"{v:.4g}" for v in row]
            yield name if len(name) <= 25 else f"~{name[-24:]}", cells, share

    def _lines(self, measured: Array, predicted: Array, title: str, form: str) -> list[str]:
        """What was measured (load, mode) beside its intervals (3, load, mode)."""
        lines = [f"{'load':<10}{'mode':>4}{title:>12}{'5 %':>11}{'50 %':>11}{'95 %':>11}"]
        for i, load in enumerate(self.loads):
            for j in range(measured.shape[1]):
                low, middle, high = predicted[:, i, j]
                if np.isnan(middle):
                    continue
                test = measured[i, j]
                outside = np.isfinite(test) and not low <= test <= high
                mark = ["  left out"] * bool(self.left_out[i]) + ["  outside"] * bool(outside)
                given = f"{'-':>12}" if np.isnan(test) else f" {test:{form}}"
                cells = "".join(f"{value:{form}}" for value in (low, middle, high))
                lines.append(f"{show(load, 'N'):<10}{j + 1:>4}{given}{cells}{','.join(mark)}")
        return lines

    def _closing_lines(self) -> list[str]:
        from textwrap import wrap

        sentences = [
            f"ln evidence {self.log_evidence:.2f} +- {self.log_evidence_sd:.2f}.",
            *(
                f"Law {law.name}: ln evidence {law.log_evidence:.2f} +- {law.log_evidence_sd:.2f}, "
                f"probability {law.weight:.1%} among those compared."
                for law in self.laws
            ),
            f"Least squares: {self.fit.misfit:.2%} rms; {self.fit.agreeing} of {self.fit.starts} starts end there.",
            self.singular.text,
            *(note.text for note in self.notes),
        ]
        return [line for sentence in sentences for line in wrap(sentence, 80)]

    def to_dict(self) -> dict[str, Any]:
        """The numbers a reader wants, ready for JSON, in SI; samples are left out."""

        def by_level(values: Array) -> dict[str, Any]:
            return {str(level): listed(row) for level, row in zip(LEVELS, values, strict=True)}

        parameters = {
            name: {
                "unit": unit or "1",
                "prior": prior.text(unit),
                "mean": float(self.mean[k]),
                "sd": float(self.sd[k]),
                "posterior_contraction": float(self.posterior_contraction[k]),
                "quantiles": by_level(self.quantiles()[:, k]),
            }
            for k, (name, unit, prior) in enumerate(zip(self.names, self.units, self.priors, strict=True))
        }
        losses = None
        if self.losses is not None and self.predicted_losses is not None:
            losses = {"test": listed(self.losses), "quantiles": by_level(self.predicted_losses)}
        return {
            "parameters": parameters,
            "correlation": listed(self.correlation),
            "log_evidence": self.log_evidence,
            "log_evidence_sd": self.log_evidence_sd,
            "laws": [asdict(law) for law in self.laws],
            "loads": {"unit": "N", "values": listed(self.loads)},
            "left_out": listed(self.left_out),
            "test": {"unit": "Hz", "values": listed(self.test)},
            "used": listed(self.used),
            "predicted": {"unit": "Hz", "quantiles": by_level(self.predicted)},
            "loss_factors": losses,
            "offsets": {"mean": listed(self.offset_mean), "sd": listed(self.offset_sd)},
            "surrogate_error": listed(self.surrogate_error),
            "checked": listed(self.checked),
            "fit": {
                "values": dict(zip(self.names, self.fit.values.tolist(), strict=False)),
                "misfit": listed(np.array(self.fit.misfit)),
                "frequencies": {"unit": "Hz", "values": listed(self.fit.frequencies)},
                "starts": self.fit.starts,
                "agreeing": self.fit.agreeing,
            },
            "singular": {
                "values": listed(self.singular.values),
                "vectors": listed(self.singular.vectors),
                "posterior_contraction": listed(self.singular.posterior_contraction),
                "text": self.singular.text,
            },
            "evaluations": self.evaluations,
            "answered": self.answered,
            "notes": [asdict(note) for note in self.notes],
        }

    # -- on disk

    def tree(self) -> Group:
        """Groups with ArviZ's names and dimensions, and one with everything, from which `load` reads.

        posterior has a variable for each parameter; posterior_predictive, observed_data and log_likelihood (by mode)
        have the dimensions chain and draw.
        """
        chain = Variable(dims=("chain",), values=np.arange(1))
        draw = Variable(dims=("draw",), values=np.arange(len(self.samples)))
        load = Variable(dims=("load",), values=self.loads, unit="N", long_name="preload")
        mode = Variable(dims=("mode",), values=np.arange(1, self.test.shape[1] + 1))

        def drawn(values: Array, *dims: str, unit: str = "", long_name: str = "") -> Variable:
            return Variable(dims=("chain", "draw", *dims), values=values[None], unit=unit, long_name=long_name)

        posterior = {
            name.replace("/", "_"): drawn(column, unit=unit, long_name=name)
            for name, unit, column in zip(self.names, self.units, self.samples.T, strict=True)
        }
        sampled = {"chain": chain, "draw": draw}
        predictive = {"frequency": drawn(self.predictive, "load", "mode", unit="Hz")}
        observed = {"frequency": Variable(dims=("load", "mode"), values=self.test, unit="Hz")}
        groups = {
            "posterior": {**sampled, **posterior},
            "posterior_predictive": {**sampled, "load": load, "mode": mode, **predictive},
            "observed_data": {"load": load, "mode": mode, **observed},
            "log_likelihood": {**sampled, "mode": mode, "frequency": drawn(self.log_likelihood, "mode")},
        }
        return Group(
            attributes={"Conventions": "CF-1.11", "inference_library": "faying", RECORD: self.KIND},
            groups={**{name: Group(variables=inside) for name, inside in groups.items()}, OWN: to_group(self)},
        )

    @classmethod
    def of_tree(cls, tree: Group) -> Self:
        """Return what a tree was made of. Raises ReadError that names what it lacks."""
        if OWN not in tree.groups:
            raise ReadError(f"it lacks the group {OWN!r}")
        return from_group(cls, tree.groups[OWN])

    def to_xarray(self) -> "DataTree":
        """Return the groups that ArviZ knows as an xarray.DataTree, as `xarray.open_datatree` reads them."""
        return super().to_xarray().drop_nodes(OWN)

    @drawing
    @checked_call
    def plot(self, ax: Any = None) -> "list[Axes]":
        """Draw each parameter before and after the test, and frequencies and loss factors beside the test.

        Args:
            ax: Two matplotlib axes to draw into, three where loss factors were used; new ones where None.

        Returns:
            The axes.

        Raises:
            InputError: The number of axes does not fit.
        """
        heights = _heights(self)
        axes = axes_of(ax, len(heights), width=WIDE, height=max(heights), columns=1)
        _draw(axes, self)
        return axes


def mixed(found: Mapping[str, Found], prior: Mapping[str, float], *, seed: int = 0) -> Found:
    """One identification out of those of several laws on one test.

    Args:
        found: by the name of the law.
        prior: probability of each law before the test.
        seed: of the draws.

    Returns:
        That of the likeliest law, with the evidence of all, its predicted frequencies drawn from all by their weights.
    """
    every = list(found.values())
    weights = weights_of([one.log_evidence + np.log(prior[name]) for name, one in found.items()])
    best = every[int(np.argmax(weights))]
    rng = np.random.default_rng([seed, 3])
    count = len(best.samples)
    which = rng.choice(len(every), count, p=weights)
    rows = rng.integers(count, size=count)
    draws = [(every[k], row) for k, row in zip(which, rows, strict=True)]
    predictive = np.stack([one.predictive[row] for one, row in draws])
    lost = [one.predictive_losses[row] for one, row in draws if one.predictive_losses is not None]
    laws = tuple(
        LawEvidence(name=name, log_evidence=one.log_evidence, log_evidence_sd=one.log_evidence_sd, weight=float(weight))
        for (name, one), weight in zip(found.items(), weights, strict=True)
    )
    notes = best.notes
    if any(_data(one) != _data(best) for one in every):
        text = (
            "The laws were not compared on the same measured numbers, since not every law has an answer for each of "
            "them: their evidences do not show which is better."
        )
        notes = (Note(code="evidence", text=text), *notes)
    return replace(
        best, predictive=predictive, predictive_losses=np.stack(lost) if lost else None, laws=laws, notes=notes
    )


def _data(found: Identification) -> bytes:
    """What an identification used of the test."""
    return found.used.tobytes() + (b"" if found.losses_used is None else found.losses_used.tobytes())


def weights_of(log_evidences: Sequence[float]) -> Array:
    """Probabilities of models that explain one test, equally likely before it, from their ln evidences."""
    logs = np.asarray(log_evidences, dtype=float)
    odds = np.exp(logs - logs.max())
    return np.asarray(odds / odds.sum())


@drawing
def figure(found: Identification) -> Any:
    """Return the figure of an identification.

    Above, the 5 to 95 % of each parameter, over its prior's own 5 to 95 %: a bar as long as the prior's tells that the
    test says nothing of it. Below, the predicted 5 to 95 % of each frequency over its median, the test as dots, hollow
    where it was left out; and the same of loss factors where they were used.
    """
    heights = _heights(found)
    fig = new_figure(WIDE, 0.4 + sum(heights))
    _draw(list(fig.subplots(len(heights), 1, height_ratios=heights)), found)
    return fig


def _draw(axes: "Sequence[Axes]", found: Identification) -> None:
    upper, *lower = axes
    _draw_parameters(upper, found)
    labels = [
        load_text(load) + (", left out" if out else "") for load, out in zip(found.loads, found.left_out, strict=True)
    ]
    for ax, (test, predicted, unit) in zip(lower, _parts(found), strict=True):
        about_median(ax, labels, predicted, test, found.left_out, unit)
        ax.set_xlabel("difference from the median [%]; bars 5 to 95 %, squares measured")
        ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=4)


def _parts(found: Identification) -> list[tuple[Array, Array, str]]:
    """What was measured, its intervals, and the unit."""
    parts = [(found.test, found.predicted, "Hz")]
    if found.losses is not None and found.predicted_losses is not None:
        parts.append((found.losses, found.predicted_losses, ""))
    return parts


def _heights(found: Identification) -> list[float]:
    heights = [0.6 + 0.22 * len(found.names)]
    return heights + [0.6 + 0.24 * found.test.shape[1] * len(found.loads) ** 0.5] * len(_parts(found))


def _draw_parameters(ax: Any, found: Identification) -> None:
    low, high = np.array([one.quantile(np.array([0.05, 0.95])) for one in found.priors]).T
    low_after, middle, high_after = (found.quantiles() - low) / (high - low)
    y = np.arange(len(found.names))
    ax.barh(y, np.ones(len(y)), height=0.55, color="0.88", label="before the test")
    ends = [middle - low_after, high_after - middle]
    ax.errorbar(middle, y, xerr=ends, fmt="o", ms=4, color=COLOURS[0], lw=2.2, label="after it")
    contractions = zip(found.names, found.posterior_contraction, strict=True)
    ax.set_yticks(y, [f"{name_of(name)} ({contraction:.2f})" for name, contraction in contractions])
    ax.set_xlabel("5 to 95 % of the prior = 0 to 1; in brackets, sd after over sd before")
    ax.invert_yaxis()
    ax.grid(axis="x", alpha=0.3)
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
