"""Tempered sampling: the linear-Gaussian closed form, evidence beside nested sampling, coverage."""

import numpy as np
import pytest
from scipy import special, stats

from faying.distribution import Distribution
from faying.errors import InputError
from faying.identify.sampling.tempering import _systematic, temper

NORMAL = Distribution(kind="normal", centre=0, spread=1)


@pytest.mark.parametrize("size", [1, 3])
def test_the_linear_gaussian_closed_form(size):
    """Mean, sd and evidence to 2 %: means within 2 % of the prior's sd."""
    rng = np.random.default_rng(size)
    priors = [Distribution(kind="normal", centre=1.0 + k, spread=0.5 + k) for k in range(size)]
    centre, spread = np.array([[p.centre, p.spread] for p in priors]).T
    a, noise = rng.standard_normal((size + 2, size)), 0.3
    y = a @ (centre + spread * rng.standard_normal(size)) + noise * rng.standard_normal(size + 2)
    cov = np.linalg.inv(a.T @ a / noise**2 + np.diag(spread**-2))
    mean = cov @ (a.T @ y / noise**2 + centre / spread**2)
    evidence = stats.multivariate_normal.logpdf(
        y, a @ centre, a @ np.diag(spread**2) @ a.T + noise**2 * np.eye(size + 2)
    )

    def log_likelihood(x):
        return stats.norm.logpdf(y, x @ a.T, noise).sum(axis=1)

    found = temper(log_likelihood, priors, count=20_000)
    assert found.samples.mean(axis=0) == pytest.approx(mean, abs=0.02 * spread.min())
    assert found.samples.std(axis=0) == pytest.approx(np.sqrt(np.diag(cov)), rel=0.02)
    assert found.log_evidence == pytest.approx(evidence, abs=0.05)
    assert found.log_likelihood == pytest.approx(log_likelihood(found.samples))
    assert found.calls > found.steps * 20_000
    assert found.correlation < 0.1


def test_the_evidence_scatters_as_it_says():
    def log_likelihood(x):
        return -0.5 * ((x - 0.5) ** 2).sum(axis=1) / 0.05**2

    runs = [temper(log_likelihood, [NORMAL] * 4, count=320, seed=k) for k in range(25)]
    exact = 4 * stats.norm.logpdf(0.5, 0, np.sqrt(1 + 0.05**2)) + 4 * np.log(0.05 * np.sqrt(2 * np.pi))
    errors = np.array([run.log_evidence - exact for run in runs])
    said = np.mean([run.log_evidence_sd for run in runs])
    assert abs(errors.mean()) < 4 * said / 5
    assert 0.5 * said < errors.std() < 2 * said


def bimodal(x):
    first, second = (-((x - c) ** 2).sum(axis=1) / (2 * 0.15**2) - np.log(2 * np.pi * 0.15**2) for c in (-1.5, 1.5))
    return np.logaddexp(np.log(0.7) + first, np.log(0.3) + second)


def banana(x):
    return -((1 - x[:, 0]) ** 2) / 0.5 - 10 * (x[:, 1] - x[:, 0] ** 2) ** 2


def five(x):
    """Narrow and oblique, with tails of a t distribution."""
    y = x - 0.3 + 0.8 * np.roll(x, 1, axis=1)
    return -5.0 * np.log1p((y**2).sum(axis=1) / 0.2)


@pytest.mark.parametrize(
    ("likelihood", "priors"),
    [
        (bimodal, [Distribution(kind="uniform", centre=0, spread=4)] * 2),
        (banana, [Distribution(kind="uniform", centre=0, spread=3), Distribution(kind="normal", centre=1, spread=2)]),
        pytest.param(
            five,
            [NORMAL] * 4 + [Distribution(kind="uniform", centre=0, spread=3)],
            marks=pytest.mark.slow,
        ),
    ],
    ids=["bimodal", "banana", "five"],
)
def test_the_evidence_is_that_of_nested_sampling(likelihood, priors):
    import dynesty

    def transform(u):  # in plain numbers: nested sampling asks for one point at a time
        ends = np.where([p.kind == "uniform" for p in priors], 2 * u - 1, special.ndtri(u))
        return np.array([p.centre for p in priors]) + np.array([p.spread for p in priors]) * ends

    nested = dynesty.NestedSampler(
        lambda x: float(likelihood(x[None, :])[0]),
        transform,
        len(priors),
        nlive=350,
        rstate=np.random.default_rng(1),
    )
    nested.run_nested(print_progress=False, dlogz=0.1)
    found = temper(likelihood, priors, count=3000)
    assert found.log_evidence == pytest.approx(nested.results.logz[-1], abs=0.3)
    if likelihood is bimodal:
        assert found.log_evidence == pytest.approx(np.log(1 / 64), abs=0.15)
        assert np.mean(found.samples[:, 0] < 0) == pytest.approx(0.7, abs=0.06)


def test_intervals_hold_the_truth_as_often_as_they_say():
    """Uniform ranks of the truth over 200 draws from the prior: chi-square over ten bins, 99.99 % for 9."""
    rng = np.random.default_rng(8)
    ranks = []
    for seed in range(200):
        truth = rng.standard_normal(2)
        y = truth[0] * np.array([1, 2]) + truth[1] ** 3 + 0.5 * rng.standard_normal(2)

        def log_likelihood(x, y=y):
            return -((x[:, :1] * [1, 2] + x[:, 1:] ** 3 - y) ** 2).sum(axis=1) / 0.5

        found = temper(log_likelihood, [NORMAL] * 2, count=200, seed=seed)
        ranks.append((found.samples < truth).mean(axis=0))
    for each in np.array(ranks).T:
        counts = np.histogram(each, bins=10, range=(0, 1))[0]
        assert ((counts - 20) ** 2 / 20).sum() < stats.chi2.ppf(0.9999, 9)
        assert 0.84 < np.mean((each > 0.05) & (each < 0.95)) < 0.96


def test_places_without_a_likelihood_are_left():
    def log_likelihood(x):
        return np.where(x[:, 0] > 1, np.where(x[:, 0] < 5, 0.0, -np.inf), np.nan)

    found = temper(log_likelihood, [NORMAL], count=4000)
    assert found.samples.min() > 1
    assert found.log_evidence == pytest.approx(stats.norm.logsf(1), abs=0.1)
    tail = stats.truncnorm(1, np.inf)
    assert found.samples.mean() == pytest.approx(tail.mean(), abs=0.03)


def test_no_likelihood_anywhere_is_said():
    with pytest.raises(InputError, match="none of 100 samples of the prior has a likelihood"):
        temper(lambda x: np.full(len(x), np.nan), [NORMAL], count=100)


def test_the_same_seed_gives_the_same_samples_and_progress_is_told():
    told = []
    runs = [
        temper(lambda x: -50 * x[:, 0] ** 2, [NORMAL], count=100, seed=s, report=lambda *a: told.append(a))
        for s in (1, 1, 2)
    ]
    assert np.array_equal(runs[0].samples, runs[1].samples)
    assert not np.array_equal(runs[0].samples, runs[2].samples)
    assert told[0][0] == "sampling"
    assert told[-1] == ("sampling", 1000, 1000)


def test_resampling_takes_each_particle_as_often_as_its_weight_says():
    """Systematic resampling: floor or ceiling of n w, and n w on average; a weight of 0 is never taken."""
    weights = np.array([0.0, 0.07, 0.31, 0.02, 0.6, 0.0])
    rng = np.random.default_rng(2)
    copies = np.array([np.bincount(_systematic(weights, rng), minlength=6) for _ in range(4000)])
    assert np.all(np.abs(copies - 6 * weights) < 1)
    assert np.all(copies[:, [0, 5]] == 0)
    assert copies.mean(axis=0) == pytest.approx(6 * weights, abs=4 * 0.5 / np.sqrt(4000))
