"""Distributions: quantiles against quadrature of the density, truncation, what is read and what is refused."""

from itertools import pairwise
from math import exp, inf, log, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import integrate, stats

from faying.distribution import Distribution, uncertain_text
from faying.errors import InputError

SHARES = np.array([0.001, 0.02, 0.3, 0.5, 0.7, 0.98, 0.999])


def read(value, unit=""):
    return Distribution.read(value, unit, "x")


@st.composite
def distributions(draw):
    kind = draw(st.sampled_from(["normal", "lognormal", "uniform"]))
    centre = draw(st.floats(0.1, 10.0))
    spread = draw(st.floats(0.05, 1.5))
    whole = Distribution(kind=kind, centre=centre, spread=spread)
    low, high = whole.quantile(np.array([draw(st.floats(0.0, 0.45)), draw(st.floats(0.55, 1.0))]))
    cut = draw(st.sampled_from(["neither", "low", "high", "both"]))
    return Distribution(
        kind=kind,
        centre=centre,
        spread=spread,
        low=low if cut in ("low", "both") else -inf,
        high=high if cut in ("high", "both") else inf,
    )


@given(distributions())
def test_quantiles_invert_the_integral_of_the_density(d):
    x = d.quantile(SHARES)
    assert np.all(np.diff(x) > 0)
    nodes, weights = np.polynomial.legendre.leggauss(40)
    first, *pieces = (
        (b - a) / 2 * weights @ np.exp(d.log_density((a + b) / 2 + (b - a) / 2 * nodes)) for a, b in pairwise(x)
    )
    assert [first, *pieces] == pytest.approx(np.diff(SHARES), rel=1e-6)


@given(distributions())
def test_the_density_integrates_to_one_and_gives_the_moments(d):
    a, b = (float(v) for v in d.quantile(np.array([1e-12, 1 - 1e-12])))
    nodes, weights = np.polynomial.legendre.leggauss(60)
    ends = d.quantile(np.array([1e-12, 1e-6, 1e-3, 0.05, 0.5, 0.95, 1 - 1e-3, 1 - 1e-6, 1 - 1e-12]))
    x = np.concatenate([(a + b) / 2 + (b - a) / 2 * nodes for a, b in pairwise(ends)])
    w = np.concatenate([(b - a) / 2 * weights for a, b in pairwise(ends)])
    p = w * np.exp(d.log_density(x))
    assert p.sum() == pytest.approx(1, rel=1e-6)
    assert p @ x == pytest.approx(d.mean, rel=1e-5)
    assert sqrt(p @ (x - d.mean) ** 2) == pytest.approx(d.sd, rel=2e-4)
    assert a <= d.median <= b


@given(distributions(), st.floats(-5, 5))
def test_scores_go_there_and_back(d, score):
    x = d.from_score(np.array(score))
    assert x == pytest.approx(d.quantile(stats.norm.cdf(score)), rel=1e-6, abs=1e-9)
    assert d.score(x) == pytest.approx(score, rel=1e-6, abs=1e-6)


@given(distributions(), st.floats(-1, 2.0), st.floats(2.0, 20.0))
def test_the_share_that_is_cut_is_the_probability_outside(d, least, greatest):
    a, b = (float(v) for v in np.clip([least, greatest], *d.quantile(np.array([1e-13, 1 - 1e-13]))))
    inside = integrate.quad(lambda x: float(np.exp(d.log_density(np.array(x)))), a, b, points=[d.median], limit=200)[0]
    if inside < 0.499:
        with pytest.raises(InputError, match="at most half"):
            d.within(least, greatest)
    elif inside > 0.501:
        cut, share = d.within(least, greatest)
        assert share == pytest.approx(1 - inside, abs=1e-6)
        assert cut.support[0] >= least
        assert cut.support[1] <= greatest
        middle = np.linspace(a, b, 7)[1:-1]
        assert cut.log_density(middle) - d.log_density(middle) == pytest.approx(np.full(5, -log(inside)), abs=1e-5)


def test_a_small_share_is_not_lost_in_rounding():
    cut, share = Distribution(kind="normal", centre=1.0, spread=0.1).within(0, inf, "()")
    assert share == pytest.approx(stats.norm.sf(10), rel=1e-9)
    assert cut.support[0] > 0
    assert cut.quantile(np.array(0.0)) > 0
    d = Distribution(kind="lognormal", centre=1.0, spread=0.1)
    assert d.within(0, inf, "()") == (d, 0.0)


def test_scores_are_exact_far_out():
    z = np.array([-30.0, -9.0, 9.0, 30.0])
    assert Distribution(kind="normal", centre=3, spread=2).from_score(z) == pytest.approx(3 + 2 * z, rel=1e-14)
    cut = Distribution(kind="normal", centre=0, spread=1, high=40)
    assert cut.score(cut.from_score(z)) == pytest.approx(z, rel=1e-8)


@pytest.mark.parametrize(
    ("low", "high"), [(0.0, inf), (-inf, 1.5), (0.8, 1.3), (3.0, inf), (3.0, 3.5), (1e-3, 1e-2)], ids=str
)
def test_cut_lognormal_moments_are_those_of_quadrature(low, high):
    d = Distribution(kind="lognormal", centre=1.0, spread=0.7, low=low, high=high)
    a, b = d.quantile(np.array([0.0, 1 - 1e-15]))
    moment = [
        integrate.quad(
            lambda t, k=k: exp(k * t + t) * float(np.exp(d.log_density(np.array(exp(t))))),
            log(max(a, 1e-6)),
            log(b),
            points=[log(d.median)],
            epsrel=1e-11,
        )[0]
        for k in (0, 1, 2)
    ]
    assert moment[0] == pytest.approx(1, rel=1e-8)
    assert d.mean == pytest.approx(moment[1], rel=1e-6)
    assert d.sd == pytest.approx(sqrt(moment[2] - moment[1] ** 2), rel=1e-4)


@pytest.mark.parametrize(
    ("value", "unit", "kind", "centre", "spread"),
    [
        ("0.1 to 0.6", "", "uniform", 0.35, 0.25),
        ("10 kN to 14 kN", "N", "uniform", 12e3, 2e3),
        ("-5 um to 5 um", "m", "uniform", 0, 5e-6),
        ("200 GPa +- 4 GPa", "Pa", "normal", 200e9, 4e9),
        ("200 GPa ± 2 %", "Pa", "normal", 200e9, 4e9),
        ("200 GPa +/- 4000 MPa", "Pa", "normal", 200e9, 4e9),
        ("0.3+-10%", "", "normal", 0.3, 0.03),
        ("-3 um +- 10 %", "m", "normal", -3e-6, 0.3e-6),
        ({"distribution": "normal", "mean": "12 kN", "sd": "1 kN"}, "N", "normal", 12e3, 1e3),
        ({"distribution": "normal", "mean": "12 kN", "sd": "5 %"}, "N", "normal", 12e3, 600),
        ({"distribution": "lognormal", "median": 0.2, "sd_ln": 0.4}, "", "lognormal", 0.2, 0.4),
        ({"distribution": "uniform", "low": "1 N", "high": "3 N"}, "N", "uniform", 2, 1),
    ],
)
def test_every_form_is_read(value, unit, kind, centre, spread):
    d = read(value, unit)
    assert (d.kind, d.centre, d.spread) == (kind, pytest.approx(centre), pytest.approx(spread))
    if isinstance(value, str):
        assert uncertain_text(value)


def test_a_factor_holds_ninety_per_cent():
    d = read({"distribution": "lognormal", "median": "10 kN", "factor": 2}, "N")
    assert d.quantile(np.array([0.05, 0.5, 0.95])) == pytest.approx([5e3, 10e3, 20e3])


def test_low_and_high_cut():
    d = read({"distribution": "normal", "mean": 0.3, "sd": 0.2, "low": 0, "high": 0.5})
    assert d.support == (0, 0.5)
    assert d.quantile(np.array([0.0, 1.0])) == pytest.approx([0, 0.5], abs=1e-12)
    assert d.mean < 0.3
    assert d.sd < 0.2


@pytest.mark.parametrize("value", ["0.1", "12 kN", "auto", "torque wrench to yield", "a to b", "", 3, None, ["1 to 2"]])
def test_what_is_no_distribution_is_not_taken_for_one(value):
    assert not uncertain_text(value)


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        ("200 GPa +- 4 GPa", "Pa", "200 GPa +- 4 GPa (normal)"),
        ("0.1 to 0.6", "", "0.1 to 0.6 (uniform)"),
        ({"distribution": "lognormal", "median": "9 kN", "sd_ln": 0.4}, "N", "9 kN, sd of ln 0.4 (lognormal)"),
        (
            {"distribution": "normal", "mean": 0.3, "sd": 0.2, "low": 0, "high": 0.5},
            "",
            "0.3 +- 0.2 (normal, above 0 and below 0.5)",
        ),
    ],
)
def test_text(value, unit, text):
    assert read(value, unit).text(unit) == text


@pytest.mark.parametrize(
    ("value", "unit", "message"),
    [
        ("10 to 14 kN", "N", r'^x = "10 to 14 kN": "10" has no unit; write for example .*"12 kN to 18 kN"'),
        ("200 GPa +- 4", "Pa", r'"4" has no unit; write for example "200 GPa \+- 5 %"'),
        ("200 GPa +- 4 mm", "Pa", "not in a unit like Pa"),
        ("0 mm +- 2 %", "m", "2 % of 0"),
        ("1 N +- -3 N", "N", "must be positive"),
        ("0.6 to 0.1", "", "less than the second"),
        ("0.3 +- much", "", "plain finite number"),
        ("3 N", "N", 'x = "3 N" is not a distribution'),
        (3, "N", "x = 3 is not a distribution"),
        ({"distribution": "norml"}, "", "'norml'; allowed are normal, lognormal, uniform"),
        ({"mean": 3}, "", "has no `distribution`; allowed are"),
        ({"distribution": "normal", "mean": "1 N"}, "N", r'x.sd is missing; for example {distribution = "normal"'),
        ({"distribution": "uniform", "lo": "1 N"}, "N", r"x.lo is not a key .* did you mean low\?"),
        ({"distribution": "uniform", "zzz": "1 N"}, "N", "a uniform one takes low, high"),
        ({"distribution": "lognormal", "median": "1 N"}, "N", "needs one of sd_ln and factor"),
        ({"distribution": "lognormal", "median": 1, "sd_ln": 1, "factor": 2}, "", "needs one of sd_ln and factor"),
        ({"distribution": "lognormal", "median": 1, "factor": 0.5}, "", "greater than 1"),
        ({"distribution": "lognormal", "median": 1, "sd_ln": -0.5}, "", "sd_ln = -0.5; it must be positive"),
        ({"distribution": "lognormal", "median": -1, "factor": 2}, "", "median = -1; it must be positive"),
        ({"distribution": "normal", "mean": 1, "sd": 1, "low": 3, "high": 2}, "", "low must be less"),
        ({"distribution": "normal", "mean": 1, "sd": 0.01, "low": 3}, "", "has no probability"),
        ({"distribution": "normal", "mean": True, "sd": 1}, "", "plain finite number"),
    ],
)
def test_what_cannot_be_used_is_said_with_an_example(value, unit, message):
    with pytest.raises(InputError, match=message):
        read(value, unit)


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"kind": "gamma", "centre": 1, "spread": 1}, "allowed are normal"),
        ({"kind": "normal", "centre": inf, "spread": 1}, "must be finite"),
        ({"kind": "normal", "centre": 1, "spread": 0}, "must be positive"),
    ],
)
def test_a_distribution_checks_itself(fields, message):
    with pytest.raises(InputError, match=message):
        Distribution(**fields)
