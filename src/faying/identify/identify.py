"""From a model with priors and a test to the posterior: surrogate, sampling, check, prediction."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, hypot, inf, log2
from typing import Protocol

import numpy as np

from faying.distribution import Distribution
from faying.errors import InputError
from faying.identify import remarks
from faying.identify.fit import Fit, identifiability, least_squares_ends
from faying.identify.identification import Identification
from faying.identify.noise import (
    DISCREPANCY,
    DISCREPANCY_SD,
    LOSS_DISCREPANCY,
    LOSS_SCATTER,
    SCATTER,
    TEST_SD,
    Losses,
    Offsets,
    offsets,
)
from faying.identify.sampling.emulator import Emulator
from faying.identify.sampling.points import at_shares, sobol
from faying.identify.sampling.tempering import Tempered, temper
from faying.progress import Report
from faying.typing import Array, Mask

MIN_EVALUATIONS, MAX_EVALUATIONS = 256, 1024  # evaluations over the priors, where not given
CHECKS = 50  # points of the posterior at which the surrogate is compared with the model
ROUNDS = 3  # most times that the surrogate is drawn closer
WORSE = 2.0  # over the leave-one-out error: a surrogate that is rough
IDLE, BLUNT = 0.1, 0.5  # errors over the scatter of the test that do not matter, and that blur the posterior
GAINED = 0.8  # of the error that a surrogate claims: one drawn closer that still claims more is the last
AGREE = 0.1  # of the scatter: misfits so near to the best are as good
WIDENED = 1.6  # points about the posterior, over its own spread


class Model(Protocol):
    """A model with parameters that scatter, evaluated at many of their values.

    names, units, priors: of the d parameters, which are independent; units are SI, "" for plain numbers.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    priors: tuple[Distribution, ...]

    def frequencies(self, values: Array, report: Report | None = None, allowed: float = inf) -> tuple[Array, list[str]]:
        """The frequencies of the test's modes, and after them their loss factors where the test has these.

        Args:
            values: of the parameters (n, d), SI.
            report: told what is done, how much of it, and of how much.
            allowed: the model's own estimate of a frequency's relative error up to which it is good enough.

        Returns:
            Frequencies [Hz] (n, load, mode), or with loss factors [-] (n, load, twice as many), NaN where a sample has
            no answer or a mode of the test no partner; and for each sample the reason why it has no answer, "" where it
            has one.
        """

    def own_errors(self) -> tuple[Array, Array]:
        """Standard deviations of what the model itself is off in ln f, once it was asked for frequencies (mode,).

        Of one offset of each mode at all loads, and of each frequency by itself; nothing where not overridden.
        """
        return np.zeros(1), np.zeros(1)


def identify_model(
    model: Model,
    test: Array,
    loads: Array,
    *,
    leave_out: Sequence[int] = (),
    count: int = 1000,
    seed: int = 0,
    test_sd: Distribution = TEST_SD,
    discrepancy: Distribution = DISCREPANCY_SD,
    losses: Losses | None = None,
    evaluations: int | None = None,
    report: Report | None = None,
) -> Identification:
    """Identify the parameters of a model from measured frequencies, and loss factors where they are given.

    ln test = ln model + b + e: e is the scatter of each frequency, b the model's own bias, one offset for each mode at
    all loads. The sd of both are identified with the rest. The model is evaluated over its priors and replaced by
    polynomials of ln f, whose leave-one-out error counts as scatter; where the polynomials miss the model at points of
    the posterior, points there are added and the surrogate is drawn closer. Loss factors are treated as the frequencies
    are, with a scatter and offsets of their own.

    Args:
        model: with its parameters and their priors.
        test: measured frequencies [Hz] (load, mode), NaN where there is none.
        loads: preloads of the test [N] (load,).
        leave_out: which loads (from 0) are not used, and predicted.
        count: samples of the posterior.
        seed: of all random numbers.
        test_sd: prior of the relative sd of the scatter.
        discrepancy: prior of the relative sd of the offsets.
        losses: measured loss factors; None where they are not used.
        evaluations: of the model over its priors; a power of 2 of at least 256 where not given, more for many
            parameters.
        report: told what is done, how much of it, and of how much.

    Raises:
        InputError: shapes that do not fit, a test without frequencies, a model without answers.

    Source: Kennedy and O'Hagan 2001, doi:10.1111/1467-9868.00294 (discrepancy as part of the noise).
    """
    test, loads = np.asarray(test, dtype=float), np.asarray(loads, dtype=float)
    wanted, left_out = _what_counts(test, loads, leave_out)
    priors = (*model.priors, test_sd, discrepancy)
    if losses is not None:
        if losses.values.shape != test.shape or np.any(losses.values <= 0):
            raise InputError(
                f"loss factors of shape {losses.values.shape}; positive ones of shape {test.shape} are due"
            )
        test = np.concatenate([test, losses.values], axis=1)
        wanted = np.isfinite(test) & ~left_out[:, None]
        priors = (*priors, losses.scatter, losses.discrepancy)
    size = len(model.names)
    chosen = at_shares(model.priors, sobol(size, evaluations or points_for(size), seed))
    points = _Points.at(model, chosen, test.shape, report)
    answered = int(np.isfinite(points.frequencies).any(axis=(1, 2)).sum())
    if answered < 2 * (size + 1):
        reasons = "".join(note.text for note in remarks.of_answers(points.reasons, "of the priors"))
        raise InputError(
            f"the model has an answer at {answered} of {len(chosen)} points of the priors; an identification of "
            f"{size} parameters needs {2 * (size + 1)}: change the priors. {reasons}".rstrip()
        )
    emulator = Emulator.fit(model.priors, points.values, points.frequencies)
    question = _Question(
        model=model,
        test=test,
        loads=loads,
        wanted=wanted,
        used=wanted & emulator.known,
        left_out=left_out,
        priors=priors,
        count=count,
        seed=seed,
        report=report,
    )
    if not question.used.any():
        raise InputError("no frequency of the test has a partner in the model over most of the priors")
    return _identification(question, _sampled(question, emulator, points))


def _what_counts(test: Array, loads: Array, leave_out: Sequence[int]) -> tuple[Mask, Mask]:
    """Which frequencies are wanted (load, mode), and which loads are left out; InputError for a test that is none."""
    if test.ndim != 2 or loads.shape != test.shape[:1]:
        raise InputError(f"test of shape {test.shape} for loads of shape {loads.shape}; it must be (load, mode)")
    outside = [k for k in leave_out if not 0 <= k < len(loads)]
    if outside:
        raise InputError(f"leave_out = {outside[0]}; the test has {len(loads)} loads, counted from 0")
    known = np.isfinite(test)
    if np.any(test[known] <= 0):
        raise InputError(f"the test has a frequency of {test[known].min():g} Hz; frequencies are positive")
    left_out = np.isin(np.arange(len(loads)), list(leave_out))
    wanted = known & ~left_out[:, None]
    if not wanted.any():
        rest = " apart from the loads that are left out" if left_out.any() else ""
        raise InputError(f"the test has no frequency{rest}; an identification needs at least one")
    return wanted, left_out


def points_for(size: int) -> int:
    """How many points of the priors: a power of 2 that has four for each coefficient of a quadratic."""
    return int(min(max(MIN_EVALUATIONS, 2 ** ceil(log2(2 * (size + 1) * (size + 2)))), MAX_EVALUATIONS))


@dataclass(frozen=True, kw_only=True, eq=False)
class _Points:
    """Points at which the model was evaluated (n, d), what it gives there (n, load, column), or why it does not."""

    values: Array
    frequencies: Array
    reasons: tuple[str, ...]

    @classmethod
    def at(
        cls, model: Model, values: Array, shape: tuple[int, ...], report: Report | None, allowed: float = inf
    ) -> "_Points":
        frequencies, reasons = model.frequencies(values, report, allowed)
        frequencies = np.array(frequencies, dtype=float)
        if frequencies.shape != (len(values), *shape):
            raise InputError(
                f"the model gives frequencies of shape {frequencies.shape}; {(len(values), *shape)} is needed: "
                "(sample, load, mode) of the test"
            )
        frequencies[[bool(reason) for reason in reasons]] = np.nan
        frequencies[~(frequencies > 0)] = np.nan  # a loss factor of a law that predicts none
        return cls(values=values, frequencies=frequencies, reasons=tuple(reasons))

    def __add__(self, other: "_Points") -> "_Points":
        return _Points(
            values=np.concatenate([self.values, other.values]),
            frequencies=np.concatenate([self.frequencies, other.frequencies]),
            reasons=self.reasons + other.reasons,
        )


@dataclass(frozen=True, kw_only=True, eq=False)
class _Question:
    """What is asked: the test, what of it counts, and the priors with those of the noise.

    The columns of the test are its frequencies by mode, and then its loss factors where they are used.
    """

    model: Model
    test: Array
    loads: Array
    wanted: Mask
    used: Mask
    left_out: Mask
    priors: tuple[Distribution, ...]
    count: int
    seed: int
    report: Report | None

    @property
    def size(self) -> int:
        """Number of the model's parameters, without those of the noise."""
        return len(self.model.names)

    @property
    def modes(self) -> int:
        """Number of the test's modes."""
        return int(2 * self.test.shape[1] // (len(self.priors) - self.size))

    def noise(self, values: Array) -> tuple[Array, Array]:
        """Relative sd of the scatter and of the offsets (n, column) at values of all parameters (n, d + 2 or 4).

        With what the model itself may be off.
        """
        both = values[:, self.size :: 2], values[:, self.size + 1 :: 2]
        scatter, discrepancy = (np.repeat(sd, self.modes, axis=1) for sd in both)
        offset, own = self.model.own_errors()
        for sd, more in ((scatter, own), (discrepancy, offset)):  # of loss factors nothing is known
            sd[:, : self.modes] = np.hypot(sd[:, : self.modes], more)
        return scatter, discrepancy

    def offsets(self, emulator: Emulator, values: Array) -> Offsets:
        """What the test says at values of all parameters (n, d + 2 or 4)."""
        logs, error = emulator.predict_known(values[:, : self.size])
        chosen, columns = self.used[emulator.known], np.nonzero(self.used)[1]
        scatter, discrepancy = self.noise(values)
        variance = scatter[:, columns] ** 2 + error[:, chosen] ** 2
        residual = np.log(self.test[self.used]) - logs[:, chosen]
        return offsets(residual, variance, discrepancy, columns, self.test.shape[1])

    def sample(self, emulator: Emulator) -> Tempered:
        """Sample the posterior with a surrogate in place of the model."""

        def log_likelihood(values: Array) -> Array:
            return np.asarray(self.offsets(emulator, values).log_likelihood.sum(axis=1))

        return temper(log_likelihood, self.priors, count=self.count, seed=self.seed, report=self.report)

    def evaluate(self, values: Array, allowed: float) -> _Points:
        return _Points.at(self.model, values, self.test.shape, self.report, allowed)


@dataclass(frozen=True, kw_only=True, eq=False)
class _Check:
    """The surrogate beside the model at points of the posterior.

    difference: rms of ln f (load, column); error: what the surrogate says of itself there; missed, claimed: both as one
    number, of the frequencies; rough: whether it misses by far more than that; blunt: whether its own error blurs the
    posterior; allowed: estimate of the model's error that does not matter beside that and the scatter of the test.
    """

    points: _Points
    difference: Array
    error: Array
    missed: float
    claimed: float
    rough: bool
    blunt: bool
    allowed: float

    @classmethod
    def of(cls, question: _Question, emulator: Emulator, posterior: Tempered, rng: np.random.Generator) -> "_Check":
        chosen = posterior.samples[rng.choice(len(posterior.samples), min(CHECKS, len(posterior.samples)), False)]
        size, modes = question.size, question.modes
        logs, errors = emulator.predict(chosen[:, :size])
        error = np.sqrt((errors**2).mean(axis=0))
        scatter = np.broadcast_to(np.median(question.noise(posterior.samples)[0], axis=0), error.shape)
        used, pitch = question.used, np.arange(error.shape[1]) < modes
        claimed = _rms(error[used & pitch])
        allowed = hypot(float(scatter[0, 0]), claimed)  # its error is a fifth of an estimate, mostly
        points = question.evaluate(chosen[:, :size], allowed)
        apart = np.log(points.frequencies) - logs
        count = np.isfinite(apart).sum(axis=0)
        square = np.where(np.isfinite(apart), apart, 0.0) ** 2
        difference = np.sqrt(np.where(count > 0, square.sum(axis=0) / np.maximum(count, 1), np.nan))
        seen = used & (count > 0)
        rough = difference[seen] > np.maximum(WORSE * error[seen], IDLE * scatter[seen])
        return cls(
            points=points,
            difference=difference,
            error=error,
            missed=_rms(difference[seen & pitch]),
            claimed=claimed,
            rough=bool(np.any(rough)),
            blunt=any(_rms(error[part] / scatter[part]) > BLUNT for part in (used & pitch, used & ~pitch)),
            allowed=allowed,
        )


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2))) if len(values) else float("nan")


@dataclass(frozen=True, kw_only=True, eq=False)
class _Answer:
    """The posterior, the surrogate that it was sampled on, all points of the model, the last check, the rounds."""

    posterior: Tempered
    emulator: Emulator
    points: _Points
    check: _Check
    rounds: int


def _sampled(question: _Question, emulator: Emulator, points: _Points) -> _Answer:
    """Sample, check, and draw the surrogate closer until it holds or gains nothing more, at most three times."""
    rng, claimed = np.random.default_rng([question.seed, 1]), inf
    for rounds in range(ROUNDS + 1):
        surrogate = emulator
        posterior = question.sample(surrogate)
        check = _Check.of(question, surrogate, posterior, rng)
        gains = check.rough or (check.blunt and check.claimed < GAINED * claimed)
        if rounds == ROUNDS or not gains:
            break
        claimed = check.claimed
        samples = posterior.samples[:, : question.size]
        about = _about(question.model.priors, samples, rng)
        points = points + check.points + question.evaluate(about, check.allowed)
        emulator = surrogate.closer(points.values, points.frequencies, samples)
    return _Answer(posterior=posterior, emulator=surrogate, points=points + check.points, check=check, rounds=rounds)


def _about(priors: Sequence[Distribution], samples: Array, rng: np.random.Generator) -> Array:
    """Points of the posterior moved outwards, as many as two for each coefficient of a quadratic, or 50."""
    size = len(priors)
    chosen = samples[rng.choice(len(samples), min(max(CHECKS, (size + 1) * (size + 2)), len(samples)), False)]
    columns = []
    for prior, values, whole in zip(priors, chosen.T, samples.T, strict=True):
        x, centre = prior.standardised(values), float(np.mean(prior.standardised(whole)))
        columns.append(prior.from_standard(centre + WIDENED * (x - centre)))
    return np.column_stack(columns)


def _identification(question: _Question, answer: _Answer) -> Identification:
    model, posterior, check = question.model, answer.posterior, answer.check
    samples, size, modes = posterior.samples, question.size, question.modes
    names = (*model.names, *(SCATTER, DISCREPANCY, LOSS_SCATTER, LOSS_DISCREPANCY)[: len(question.priors) - size])
    scatter, discrepancy = (np.median(noise, axis=0) for noise in question.noise(samples))
    found = question.offsets(answer.emulator, samples)
    density = [prior.log_density(x) for prior, x in zip(question.priors, samples.T, strict=True)]
    peak = samples[int(np.argmax(posterior.log_likelihood + np.sum(density, axis=0))), :size]
    notes = (
        *remarks.of_data(size, question.wanted, question.used, question.loads, modes),
        *remarks.of_answers(answer.points.reasons, "that were evaluated"),
        *remarks.of_answers(check.points.reasons, "of the posterior"),
        *remarks.of_posterior(names, question.priors, samples),
        *remarks.of_sampling(posterior.correlation),
        *remarks.of_surrogate(check.missed, check.claimed, float(scatter[0]), rough=check.rough),
    )
    predictive = _predictive(question, answer, found)
    damped = question.test.shape[1] > modes
    return Identification(
        names=names,
        units=(*model.units, *[""] * (len(names) - size)),
        priors=question.priors,
        log_evidence=posterior.log_evidence,
        log_evidence_sd=posterior.log_evidence_sd,
        evaluations=len(answer.points.values),
        answered=sum(not reason for reason in answer.points.reasons),
        rounds=answer.rounds,
        steps=posterior.steps,
        calls=posterior.calls,
        samples=samples,
        log_likelihood=found.log_likelihood.reshape(len(samples), -1, modes).sum(axis=1),
        loads=question.loads,
        test=question.test[:, :modes],
        used=question.used[:, :modes],
        left_out=question.left_out,
        predictive=predictive[:, :, :modes],
        losses=question.test[:, modes:] if damped else None,
        losses_used=question.used[:, modes:] if damped else None,
        predictive_losses=predictive[:, :, modes:] if damped else None,
        offset_mean=found.mean.mean(axis=0)[:modes],
        offset_sd=np.sqrt(found.variance.mean(axis=0) + found.mean.var(axis=0))[:modes],
        surrogate_error=check.error[:, :modes],
        checked=check.difference[:, :modes],
        fit=_fit(question, answer, scatter, peak),
        singular=identifiability(answer.emulator, peak, question.used, (scatter, discrepancy), model.names),
        notes=notes,
    )


def _predictive(question: _Question, answer: _Answer, found: Offsets) -> Array:
    """What a test would measure (draw, load, column): with the offset of the mode, and scatter."""
    rng = np.random.default_rng([question.seed, 2])
    samples = answer.posterior.samples
    logs, error = answer.emulator.predict(samples[:, : question.size])
    offset = found.mean + np.sqrt(found.variance) * rng.standard_normal(found.mean.shape)
    scatter = np.sqrt(question.noise(samples)[0][:, None, :] ** 2 + error**2)
    return np.asarray(np.exp(logs + offset[:, None, :] + scatter * rng.standard_normal(logs.shape)))


def _fit(question: _Question, answer: _Answer, scatter: Array, peak: Array) -> Fit:
    """The least-squares fit: of all ends of the search, the one at which the model itself is nearest to the test."""
    ends = least_squares_ends(answer.emulator, question.test, question.used, scatter, peak, question.seed)
    found, used, modes = question.evaluate(ends, inf).frequencies, question.used, question.modes
    apart = np.log(question.test[used] / found[:, used])
    misfit = np.sqrt(np.mean((apart / np.broadcast_to(scatter, used.shape)[used]) ** 2, axis=1))  # in sd of the scatter
    ranked = np.where(np.isnan(misfit), np.inf, misfit)
    best = int(ranked.argmin())
    if np.isfinite(ranked[best]):  # the bases grow for this one alone
        found[best] = question.evaluate(ends[[best]], answer.check.allowed).frequencies[0]
    nearest, seen = found[best][:, :modes], used[:, :modes]
    return Fit(
        values=ends[best],
        frequencies=nearest,
        misfit=_rms(np.log(question.test[:, :modes][seen] / nearest[seen])),
        starts=len(ends),
        agreeing=int((ranked <= ranked[best] + AGREE).sum()) if np.isfinite(ranked[best]) else 0,
    )
