"""Sampling of a posterior and its evidence by tempered sequential Monte Carlo."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import inf
from typing import final

import numpy as np

from faying.distribution import Distribution
from faying.errors import InputError
from faying.progress import Report
from faying.typing import Array, Index

LogLikelihood = Callable[[Array], Array]
WALKS_ACCEPTED, DRAWS_ACCEPTED = 0.25, 0.4  # shares of the moves that their lengths are set for
WIDER = 1.2  # the Gaussian that is drawn from, over the particles' own
ISLANDS = 8  # groups of particles
CORRELATED = 0.1  # with the start of a stage, below which the particles have moved enough
SWEEPS = (3, 100)  # fewest and most in a stage


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Tempered:
    """What sampling gives.

    Args:
        samples: values of the parameters (n, d), all of one weight.
        log_likelihood: at each (n,).
        log_evidence: ln of the integral of the likelihood over the prior.
        log_evidence_sd: its standard deviation, from the scatter between eight groups of the particles that are
            resampled apart, or from that of the weights where it is greater.
        steps: temperatures that were gone through.
        calls: evaluations of the likelihood.
        correlation: the greatest that was left between the particles and the start of their stage; near 1 where the
            moves could not mix, as between modes far apart.
    """

    samples: Array
    log_likelihood: Array
    log_evidence: float
    log_evidence_sd: float
    steps: int
    calls: int
    correlation: float


def temper(
    log_likelihood: LogLikelihood,
    priors: Sequence[Distribution],
    *,
    count: int = 1000,
    seed: int = 0,
    report: Report | None = None,
) -> Tempered:
    """Take particles from the prior to the posterior through likelihood^T, T from 0 to 1.

    All is done in the standard normal scores of the priors, which have one scale and no ends. Each temperature is the
    one at which the effective sample size falls to half; then systematic resampling, and Metropolis moves until the
    particles hardly correlate with where they started: random walks with their covariance, which find their way in any
    posterior, and draws towards their own Gaussian, which are far faster where the posterior is nearly one. At T = 1
    the moves go on for as long again, so that the spread of the samples is that of the posterior.

    Args:
        log_likelihood: from values (n, d) to ln likelihoods (n,); -inf or NaN where the model has no answer.
        priors: one for each parameter, independent.
        count: particles, rounded up to a multiple of 8.
        seed: of the random numbers.
        report: told the stage and per mille done.

    Raises:
        InputError: no particle of the prior has a likelihood.

    Source: Del Moral, Doucet and Jasra 2006, doi:10.1111/j.1467-9868.2006.00553.x (eqs. 12, 14); temperatures as in
        Ching and Chen 2007, doi:10.1061/(ASCE)0733-9399(2007)133:7(816); length of the stages as in Kantas, Beskos and
        Jasra 2014, doi:10.1137/130930364; draws: Cotter et al. 2013, doi:10.1214/13-STS421, eq. (4.2), about the
        Gaussian of the particles.
    """
    rng = np.random.default_rng(seed)
    target = _Target(log_likelihood, tuple(priors))
    particles = rng.standard_normal((-(-count // ISLANDS) * ISLANDS, len(priors)))
    likelihood = target(particles)
    if not np.isfinite(likelihood).any():
        raise InputError(
            f"none of {count} samples of the prior has a likelihood above 0; check the test, the units and the priors"
        )
    temperature, steps, left, lengths = 0.0, 0, 0.0, (2.38 / np.sqrt(len(priors)), 1.0)
    evidence, variance = _Evidence(), 0.0
    while temperature < 1:
        rise = _rise(likelihood, 1 - temperature)
        weights = np.exp(rise * (likelihood - likelihood.max()))
        evidence.add(weights, rise * float(likelihood.max()))
        variance += float(weights.var() / weights.mean() ** 2) / len(weights)
        temperature = 1.0 if rise >= 1 - temperature else temperature + rise
        chosen = evidence.resample(weights, rng, whole=temperature == 1)
        stage = _Stage(target, particles[chosen], likelihood[chosen], temperature, lengths, rng)
        left = max(left, stage.move())
        if temperature == 1:
            left = max(left, stage.move())
        particles, likelihood, lengths, steps = stage.particles, stage.likelihood, stage.lengths, steps + 1
        if report is not None:
            report("sampling", int(1000 * temperature), 1000)
    return Tempered(
        samples=target.values(particles),
        log_likelihood=likelihood,
        log_evidence=evidence.value,
        log_evidence_sd=max(float(np.sqrt(variance)), evidence.sd),
        steps=steps,
        calls=target.calls,
        correlation=left,
    )


class _Evidence:
    """The evidence by islands: groups of particles that are resampled apart, whose scatter shows that of the whole."""

    def __init__(self) -> None:
        self.logs = np.zeros(ISLANDS)

    def add(self, weights: Array, scale: float) -> None:
        with np.errstate(divide="ignore"):
            self.logs = self.logs + np.log(weights.reshape(ISLANDS, -1).mean(axis=1)) + scale

    def resample(self, weights: Array, rng: np.random.Generator, *, whole: bool) -> Index:
        """Which particles go on: within each island, or of the whole with each island by its evidence."""
        parts = weights.reshape(ISLANDS, -1)
        if whole:
            return _systematic((parts * (self._relative / np.maximum(parts.sum(axis=1), 1e-300))[:, None]).ravel(), rng)
        size = parts.shape[1]
        return np.concatenate(
            [  # an island without any likelihood starts again from the others, and counts no more
                k * size + _systematic(part, rng) if part.sum() > 0 else _systematic(weights, rng)[::ISLANDS]
                for k, part in enumerate(parts)
            ]
        )

    @property
    def _relative(self) -> Array:
        return np.asarray(np.exp(self.logs - self.logs.max()))

    @property
    def value(self) -> float:
        return float(np.log(np.mean(self._relative)) + self.logs.max())

    @property
    def sd(self) -> float:
        return float(np.std(self._relative, ddof=1) / np.mean(self._relative) / np.sqrt(ISLANDS))


class _Target:
    """The likelihood of standard normal scores; counts its calls."""

    def __init__(self, log_likelihood: LogLikelihood, priors: tuple[Distribution, ...]) -> None:
        self.log_likelihood, self.priors, self.calls = log_likelihood, priors, 0

    def values(self, scores: Array) -> Array:
        return np.column_stack([prior.from_score(z) for prior, z in zip(self.priors, scores.T, strict=True)])

    def __call__(self, scores: Array) -> Array:
        self.calls += len(scores)
        out = np.asarray(self.log_likelihood(self.values(scores)), dtype=float)
        return np.where(np.isnan(out), -inf, out)


def _rise(likelihood: Array, most: float) -> float:
    """By how much the temperature rises so that half of the effective sample size is left."""
    from scipy.optimize import brentq

    known = likelihood[np.isfinite(likelihood)] - likelihood.max()
    wanted = min(0.5 * len(likelihood), 0.5 * len(known)) if len(known) > 1 else 0.0

    def excess(rise: float) -> float:
        weights = np.exp(rise * known)
        return float(weights.sum() ** 2 / (weights**2).sum()) - wanted

    if excess(most) >= 0:
        return most
    # in the logarithm: the first rise may be 1e-9 of the last
    low = most
    while excess(low) < 0:
        low *= 0.5
    return float(brentq(excess, low, min(2 * low, most), rtol=1e-10))


def _systematic(weights: Array, rng: np.random.Generator) -> Index:
    count = len(weights)
    shares = np.cumsum(weights) / weights.sum()
    places = (rng.random() + np.arange(count)) / count
    return np.minimum(np.searchsorted(shares, places, side="right"), count - 1).astype(np.int64)


class _Stage:
    """Moves of the particles at one temperature: random walks and draws towards their Gaussian, in turn."""

    def __init__(
        self,
        target: _Target,
        particles: Array,
        likelihood: Array,
        temperature: float,
        lengths: tuple[float, float],
        rng: np.random.Generator,
    ) -> None:
        self.target, self.particles, self.likelihood = target, particles, likelihood
        self.temperature, self.rng = temperature, rng
        self.walk, self.draw = lengths
        # axes along which the particles scatter by 1
        self.centre = particles.mean(axis=0)
        scales, axes = np.linalg.eigh(np.atleast_2d(np.cov(particles.T)))
        scales = np.sqrt(np.maximum(scales, 1e-12 * max(float(scales[-1]), 1e-300)))
        self.root, self.inverse = axes * scales, axes / scales

    @property
    def lengths(self) -> tuple[float, float]:
        """Of both kinds of moves, for the next stage to start from."""
        return self.walk, self.draw

    def move(self) -> float:
        """Sweep until the correlation with the start is below 0.1, or the most sweeps are done; return what is left."""
        start, left = self._ranks(), 1.0
        for sweep in range(SWEEPS[1]):
            self._walk()
            self._draw()
            left = _correlation(start, self._ranks())
            if sweep + 1 >= SWEEPS[0] and left < CORRELATED:
                break
        return left

    def _ranks(self) -> Array:
        """Ranks of the particles along each axis, and by likelihood, whose memory is longest in heavy tails."""
        seen = np.column_stack([self.particles @ self.inverse, self.likelihood])
        return np.argsort(np.argsort(seen, axis=0), axis=0).astype(float)

    def _walk(self) -> None:
        """A random walk; its lengths scatter, so that some are short enough where the posterior is narrow."""
        old = self.particles
        lengths = self.walk * np.exp(0.5 * self.rng.standard_normal((len(old), 1)))
        taken = self._accept(old + lengths * self.rng.standard_normal(old.shape) @ self.root.T, np.zeros(len(old)))
        self.walk *= float(np.exp(np.clip(taken - WALKS_ACCEPTED, -0.2, 0.2)))

    def _draw(self) -> None:
        """Part of the way to a draw of a Gaussian wider than the particles, which it would leave as it is."""
        old = self.particles
        here = (old - self.centre) @ self.inverse
        there = np.sqrt(1 - self.draw**2) * here + self.draw * WIDER * self.rng.standard_normal(old.shape)
        bias = ((there**2).sum(axis=1) - (here**2).sum(axis=1)) / (2 * WIDER**2)
        taken = self._accept(self.centre + there @ self.root.T, bias)
        self.draw = float(np.clip(self.draw * np.exp(np.clip(taken - DRAWS_ACCEPTED, -0.2, 0.2)), 0.01, 1.0))

    def _accept(self, new: Array, bias: Array) -> float:
        """Metropolis: take what the target and the bias of the proposal allow; return the share."""
        old = self.particles
        likelihood = self.target(new)
        gain = self.temperature * (likelihood - self.likelihood) + ((old**2).sum(1) - (new**2).sum(1)) / 2 + bias
        taken = -self.rng.exponential(size=len(old)) < gain
        self.particles = np.where(taken[:, None], new, old)
        self.likelihood = np.where(taken, likelihood, self.likelihood)
        return float(taken.mean())


def _correlation(start: Array, now: Array) -> float:
    """The greatest correlation of a column with its start."""
    a, b = start - start.mean(axis=0), now - now.mean(axis=0)
    scale = np.sqrt((a**2).sum(axis=0) * (b**2).sum(axis=0))
    return float(np.max((a * b).sum(axis=0) / np.where(scale > 0, scale, 1.0)))
