"""Samples of a study whose numbers scatter, each at all of its loads."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from faying.case.case import surfaces_of
from faying.contact.build import kinds
from faying.distribution import Distribution
from faying.errors import FayingError, InputError
from faying.identify.sampling.points import at_shares, sobol
from faying.study.keys.surface import Surface
from faying.study.keys.uncertain import Input, UncertainChoice
from faying.study.keys.varied import MODEL
from faying.study.study import Study
from faying.surface.estimators.base import EstimateScatter
from faying.sweeps.variant_builder import StudyVariant, check_key
from faying.typing import Array

LEVEL = "surface.level"  # of the spectrum in the middle of its band, at a given D
# standard normal score of the shares of 5 and 95 %, to which the bases are trained in each input
TRAINING_SCORE = 1.645
PAIRS = 4  # samples far out in all inputs at once that the bases are trained on


@dataclass(frozen=True, kw_only=True)
class Inputs:
    """What scatters, one column each.

    Args:
        columns: The numbers; the law, where it is uncertain, is the last, as its place among `models`.
        models: Laws that are drawn, with their weights; empty where the law is certain.
        scatter: How D and the level of the spectrum belong together, and D and G about which they scatter; None where
            neither does.
    """

    columns: tuple[Input, ...]
    models: tuple[tuple[str, float], ...] = ()
    scatter: tuple[EstimateScatter, float, float] | None = None

    @classmethod
    def of(cls, study: Study, surfaces: Sequence[Surface]) -> Self:
        """What scatters in a study. Raises InputError where it has no [uncertain], or one that does not fit."""
        choice = scattering(study)
        columns = list(choice.inputs)
        for column in columns:
            check_key(study, column.key, models=bool(choice.models), where=f"uncertain.{column.key}")
        scatter = None
        if choice.fit:
            if any(column.key in ("surface.D", "surface.G") for column in columns):
                raise InputError("uncertain: D or G scatters by itself and by surface.fit; leave one of them out")
            scatter, more = _of_fit(study, surfaces, choice)
            columns += more
        if choice.models:
            check_key(study, MODEL, models=True, where="uncertain.law.model")
            share = Distribution(kind="uniform", centre=0.5, spread=0.5)
            columns.append(Input(key=MODEL, distribution=share, unit=""))
        return cls(columns=tuple(columns), models=choice.models, scatter=scatter)

    @property
    def names(self) -> tuple[str, ...]:
        """Key of each column."""
        return tuple(column.key for column in self.columns)

    @property
    def priors(self) -> tuple[Distribution, ...]:
        """Distribution of each column; that of the law is the share of the weights, from 0 to 1."""
        return tuple(column.distribution for column in self.columns)

    def model(self, share: float) -> str:
        """The law at a share of the weights, from 0 to 1."""
        ends = np.cumsum([weight for _, weight in self.models])
        return self.models[min(int(np.searchsorted(ends, share, side="right")), len(ends) - 1)][0]

    def share(self, law: int) -> float:
        """The share of the weights, from 0 to 1, at which a law is drawn: the middle of its own."""
        weights = [weight for _, weight in self.models]
        return sum(weights[:law]) + 0.5 * weights[law]

    def put(self, point: StudyVariant, values: Array) -> StudyVariant:
        """The point with values (d,) put in."""
        named = dict(zip(self.names, values.tolist(), strict=True))
        if self.scatter is not None:
            point = _with_surface(point, self.scatter, named)
        return point.with_values({key: self.model(value) if key == MODEL else value for key, value in named.items()})


def scattering(study: Study) -> UncertainChoice:
    """What a study says of scatter. Raises InputError where it says nothing."""
    choice = study.uncertain
    if choice is None or not (choice.inputs or choice.models or choice.fit):
        raise InputError(
            "nothing in the study scatters; add for example\n[uncertain]\n"
            'preload = {tightening = "torque wrench, friction estimated"}\nE = "200 GPa +- 4 GPa"'
        )
    return choice


def _with_surface(
    point: StudyVariant, scatter: tuple[EstimateScatter, float, float], named: dict[str, float]
) -> StudyVariant:
    """Put in D and the G that goes with it and with the level."""
    rule, D0, G0 = scatter
    D = named.pop("surface.D")
    (_, both), (_, var) = rule.covariance
    level = rule.level(D0, G0) + both / var * (D - D0) + np.log(named.pop(LEVEL))
    return point.with_values({"surface.D": D, "surface.G": rule.G(D, level)})


def _of_fit(
    study: Study, surfaces: Sequence[Surface], choice: UncertainChoice
) -> tuple[tuple[EstimateScatter, float, float], list[Input]]:
    """D and the level of the spectrum from the fit of the scan, and from other scans of the same surface."""
    laws = [study.law_of(joint) for joint in study.joints]
    takes = any("D" in law.kind.law.parameters for law in laws if law.kind is not None) or bool(choice.models)
    own = [surface for joint, surface in zip(study.joints, surfaces, strict=True) if joint.surface is None]
    if not takes:
        names = ", ".join(sorted(name for name, kind in kinds().items() if "D" in kind.law.parameters))
        raise InputError(f"uncertain.surface.fit: no law of the study takes D and G; those that do are {names}")
    if not own or own[0].fit is None or own[0].fit.scatter is None or own[0].rough is None:
        raise InputError(
            "uncertain.surface.fit needs a scan under [surface] and an estimator that states the covariance of D and "
            'its level: method = "psd"; or give surface.D and surface.G distributions'
        )
    fit, inputs = own[0].fit, own[0].rough.inputs
    rule = fit.scatter
    assert rule is not None
    covariance = np.array(rule.covariance)
    found = [(inputs.D, rule.level(inputs.D, inputs.G))]
    assert study.surface is not None
    for file in choice.scans:
        other = replace(study.surface, scan=file).read()
        if other.fit is None or other.rough is None:
            raise InputError(f"uncertain.surface.scans: {file.name} has no D and G ({'; '.join(other.warnings)})")
        found.append((other.rough.inputs.D, rule.level(other.rough.inputs.D, other.rough.inputs.G)))
    D0, level0 = np.mean(found, axis=0)
    if len(found) > 1:
        covariance = covariance + np.cov(np.array(found)[:, ::-1].T)
    (own_level, both), (_, var) = covariance.tolist()
    rule = replace(rule, covariance=((own_level, both), (both, var)))
    D = Distribution(kind="normal", centre=float(D0), spread=float(var) ** 0.5)
    D, cut = D.within(2.0, 3.0, "()")
    rest = max(float(own_level - both**2 / var), 1e-12) ** 0.5
    level = Distribution(kind="lognormal", centre=1.0, spread=rest)
    return (rule, float(D0), rule.G(float(D0), float(level0))), [
        Input(key="surface.D", distribution=D, unit="", cut=cut),
        Input(key=LEVEL, distribution=level, unit=""),
    ]


@dataclass(frozen=True, kw_only=True)
class Ensemble:
    """Samples of a study at each of its loads; the index of a point is sample * loads + load.

    The first samples are for training alone: the medians, under each law, each input far out to either side, and some
    far out in all.

    Args:
        study, surfaces: What is varied.
        inputs: What scatters.
        values: Of all samples (n, d) in SI units.
        training: How many of them come before those that count.
    """

    study: Study
    surfaces: tuple[Surface, ...]
    inputs: Inputs
    values: Array
    training: int
    # the last sample asked for, at all loads: its points differ in the forces alone
    _last: dict[int, StudyVariant] = field(default_factory=dict, init=False, repr=False, compare=False)

    @classmethod
    def of(cls, study: Study, count: int, seed: int, surfaces: tuple[Surface, ...] | None = None) -> "Ensemble":
        """Draw samples by Sobol's sequence, scrambled. Raises InputError where the study cannot be varied so.

        surfaces: of its joints, where they were read before.
        """
        if study.in_order:
            raise InputError("a prediction pulls all bolts at once; leave out [tightening]")
        surfaces = surfaces_of(study) if surfaces is None else surfaces
        inputs = Inputs.of(study, surfaces)
        rows = cls._far(inputs, seed)
        made = cls(
            study=study, surfaces=surfaces, inputs=inputs, values=at_shares(inputs.priors, rows), training=len(rows)
        )
        made.point(0)
        return made.with_values(at_shares(inputs.priors, sobol(len(inputs.columns), count, seed)))

    @staticmethod
    def _far(inputs: Inputs, seed: int) -> Array:
        """Shares of probability (t, d) of the samples for training."""
        from scipy.stats import norm

        size, laws = len(inputs.columns), max(len(inputs.models), 1)
        either = np.stack([-np.eye(size), np.eye(size)], axis=1).reshape(-1, size)  # each input to both sides, in turn
        far = np.random.default_rng(seed).choice([-TRAINING_SCORE / 2, TRAINING_SCORE / 2], (PAIRS, size))
        shares = norm.cdf(np.concatenate([np.zeros((laws, size)), TRAINING_SCORE * either, far]))
        if inputs.models:  # laws in turn
            middles = np.array([inputs.share(law) for law in range(laws)])
            shares[:, -1] = middles[np.arange(len(shares)) % laws]
        return np.asarray(shares)

    def with_values(self, values: Array) -> "Ensemble":
        """The same training, with values (n, d) in SI units as the samples that count."""
        return replace(self, values=np.concatenate([self.values[: self.training], values]))

    @property
    def count(self) -> int:
        """Samples that count."""
        return len(self.values) - self.training

    @property
    def loads(self) -> int:
        """Loads of the study."""
        return len(self.study.loads)

    @property
    def size(self) -> int:
        """Number of points."""
        return len(self.values) * self.loads

    @property
    def middle(self) -> int:
        """The medians at the last load."""
        return self.loads - 1

    @property
    def keys(self) -> tuple[str, ...]:
        """What varies."""
        return self.inputs.names

    @property
    def ends(self) -> list[int]:
        """The first and the last load, one where they are the same."""
        return sorted({0, self.loads - 1})

    def corners(self, most: int) -> list[int]:
        """The samples for training, at the first and the last load in turn, the medians at both."""
        ends = 0, self.loads - 1
        found = [
            0,
            self.middle,
            *(sample * self.loads + ends[sample % 2] for sample in range(1, self.training)),
        ]
        return list(dict.fromkeys(found))[: max(most, self.training + 1)]

    def point(self, index: int) -> StudyVariant:
        """The study at one sample and load."""
        sample, load = divmod(index, self.loads)
        if sample not in self._last:
            found = self._at(sample)
            self._last.clear()
            self._last[sample] = found
        found = self._last[sample]
        return replace(found, forces=found.forces[load])

    def as_modelled(self, load: int) -> StudyVariant:
        """The study as it stands at one load."""
        forces = np.array(self.study.preloads[load].forces)
        return StudyVariant(study=self.study, surfaces=self.surfaces, forces=forces)

    def _at(self, sample: int) -> StudyVariant:
        """The study at one sample, with the forces [N] of all loads (loads, b)."""
        forces = np.array([one.forces for one in self.study.preloads])
        try:
            point = StudyVariant(study=self.study, surfaces=self.surfaces, forces=forces)
            return self.inputs.put(point, self.values[sample])
        except FayingError as fault:
            raise InputError(f"a sample of the study cannot be: {fault}") from None


def by_reason(reasons: Sequence[str]) -> Mapping[str, int]:
    """How many samples have no answer for each reason; reasons that differ in their numbers alone count as one."""
    import re

    counts: dict[str, tuple[str, int]] = {}
    for reason in filter(None, reasons):
        mask = re.sub(r"[-+]?\d[\d.e+-]*", "#", reason)
        first, count = counts.get(mask, (reason, 0))
        counts[mask] = first, count + 1
    return dict(counts.values())
