"""Identification: closed forms, twins, calibration, what it says of what it cannot know."""

import json

import numpy as np
import pytest
from scipy import stats

import faying
from faying.distribution import Distribution
from faying.errors import InputError, ReadError
from faying.identify.fit import Identifiability
from faying.identify.identification import Identification, figure, mixed, weights_of
from faying.identify.identify import identify_model
from faying.identify.noise import DISCREPANCY_SD, TEST_SD, Losses, offsets
from faying.identify.sampling.emulator import Emulator
from faying.identify.sampling.tempering import temper
from tests.helpers.chain import LOADS, Altered, Chain, DampedChain, Linear

COUNT = 400


def codes(found):
    return [note.code for note in found.notes]


def fixed(value):
    """A noise that is known."""
    return Distribution(kind="lognormal", centre=value, spread=1e-6)


def twin(truth, seed, model=None, offset=0.01, scatter=0.003):
    """A test of a model: its frequencies with an offset for each mode, and scatter."""
    rng = np.random.default_rng(seed)
    f = (model or Chain()).frequencies(np.array([truth]))[0][0]
    return f * np.exp(offset * rng.standard_normal(f.shape[1]) + scatter * rng.standard_normal(f.shape))


TRUTH = (1.3e7, 0.35, 1.01, 2.03e11)


@pytest.fixture(scope="module")
def chain():
    return identify_model(Chain(), twin(TRUTH, 0), LOADS, leave_out=[2], count=COUNT)


# -- closed forms


@pytest.mark.parametrize(("offset", "own"), [(0.0, 0.0), (0.02, 0.0), (0.0, 0.02)])
def test_errors_of_the_model_itself_count_with_discrepancy_and_scatter(offset, own):
    """ln f = s z in three modes at two loads, z standard normal: 1 + 3 s^2 times the sum of the inverse covariance."""
    slope, scatter, discrepancy = 0.02, 0.004, 0.006

    class Meshed(Linear):
        def own_errors(self):
            return np.full(3, offset), np.full(3, own)

    model = Meshed(slope * np.ones((2, 3, 1)))
    found = identify_model(
        model, np.full((2, 3), 100.0), LOADS[:2], count=1000, test_sd=fixed(scatter), discrepancy=fixed(discrepancy)
    )
    each, common = scatter**2 + own**2, discrepancy**2 + offset**2
    exact = (1 + 3 * slope**2 * 2 / (each + 2 * common)) ** -0.5
    assert found.posterior_contraction[0] == pytest.approx(exact, rel=0.07)  # 1000 draws: three times 2.3 %


def test_offsets_are_those_of_the_whole_covariance():
    rng = np.random.default_rng(0)
    modes = np.array([0, 2, 0, 2, 2])
    residual, variance, t = rng.standard_normal((4, 5)), rng.uniform(0.5, 2, (4, 5)), rng.uniform(0.5, 2, 4)
    found = offsets(residual, variance, t, modes, 3)
    for n in range(4):
        for m in (0, 2):
            here = modes == m
            r, cov = residual[n, here], np.diag(variance[n, here]) + t[n] ** 2
            inverse, ones = np.linalg.inv(cov), np.ones(here.sum())
            assert found.log_likelihood[n, m] == pytest.approx(stats.multivariate_normal.logpdf(r, cov=cov))
            assert found.mean[n, m] == pytest.approx(t[n] ** 2 * ones @ inverse @ r)
            assert found.variance[n, m] == pytest.approx(t[n] ** 2 - t[n] ** 4 * ones @ inverse @ ones)
    assert (found.log_likelihood[:, 1] == 0).all()
    assert found.variance[:, 1] == pytest.approx(t**2)


def test_a_linear_model_gives_the_closed_form():
    """Posterior, evidence, offsets and prediction of a linear-Gaussian model, to 2 % of their sd (5 % for sds)."""
    rng = np.random.default_rng(4)
    slopes = 0.02 * rng.standard_normal((3, 4, 2))
    model, s, t = Linear(slopes), 0.004, 0.008
    truth = np.array([1.1, 0.85])
    test = twin(truth, 5, model, t, s)
    found = identify_model(
        model, test, LOADS, leave_out=[1], count=8000, test_sd=fixed(s), discrepancy=fixed(t), evaluations=64
    )
    # all of ln f and the parameters as one Gaussian vector: x, b, ln f
    design = slopes.reshape(12, 2)
    modes = np.tile(np.eye(4), (3, 1))
    cov_f = design @ design.T + t**2 * modes @ modes.T + s**2 * np.eye(12)
    known = np.repeat([True, False, True], 4)
    y = np.log(test / 100).ravel()[known]
    inverse = np.linalg.inv(cov_f[np.ix_(known, known)])
    for prior, cross, mean, sd in (
        (np.eye(2), design[known], (found.mean[:2] - 1) / 0.1, found.sd[:2] / 0.1),
        (t**2 * np.eye(4), t**2 * modes[known], found.offset_mean, found.offset_sd),
    ):
        exact_mean = cross.T @ inverse @ y
        exact_sd = np.sqrt(np.diag(prior - cross.T @ inverse @ cross))
        assert mean == pytest.approx(exact_mean, abs=0.06 * exact_sd.max())
        assert sd == pytest.approx(exact_sd, rel=0.05)
    exact = stats.multivariate_normal.logpdf(y, cov=cov_f[np.ix_(known, known)])
    assert found.log_evidence == pytest.approx(exact, abs=0.2)
    left = cov_f[np.ix_(~known, known)]
    middle = 100 * np.exp(left @ inverse @ y)
    spread = np.sqrt(np.diag(cov_f[np.ix_(~known, ~known)] - left @ inverse @ left.T))
    assert found.predicted[1, 1] == pytest.approx(middle, rel=0.06 * spread.max())
    assert np.log(found.predicted[2, 1] / found.predicted[0, 1]) / (2 * 1.645) == pytest.approx(spread, rel=0.06)
    assert found.surrogate_error.max() < 1e-9
    assert found.rounds == 0


def test_evidence_of_laws_gives_their_weights():
    """The law that made the test is preferred; equal evidences weigh the same."""
    slopes = 0.02 * np.random.default_rng(4).standard_normal((3, 4, 2))
    right, wrong = Linear(slopes), Linear(slopes[::-1])
    test = twin([1.2, 0.8], 1, right, 0.002, 0.002)
    evidences = [identify_model(m, test, LOADS, count=COUNT, evaluations=64).log_evidence for m in (right, wrong)]
    assert weights_of(evidences)[0] > 0.99
    assert weights_of([-3.0, -3.0 + np.log(3)]) == pytest.approx([0.25, 0.75])
    assert weights_of([-1e5, -1e5]) == pytest.approx([0.5, 0.5])


# -- twins and calibration


@pytest.mark.slow
def test_twins_are_found():
    """Ten truths drawn from the priors, with offsets: intervals hold them, and the load that was left out."""
    rng = np.random.default_rng(21)
    inside, covered, told = [], [], []
    for seed in range(10):
        truth = [float(p.quantile(u)) for p, u in zip(Chain.priors, rng.uniform(0.02, 0.98, 4), strict=True)]
        test = twin(truth, seed)
        found = identify_model(Chain(), test, LOADS, leave_out=[2], count=COUNT, seed=seed)
        low, _, high = found.quantiles()
        inside.append((low[:4] <= truth) & (truth <= high[:4]))
        covered.append((found.predicted[0, 2] <= test[2]) & (test[2] <= found.predicted[2, 2]))
        told.append(found.posterior_contraction)
        assert "not-told" in codes(found)
    assert np.all(np.sum(inside, axis=0) >= 8)
    assert np.sum(covered) >= 32
    told = np.array(told)
    assert np.all(told[:, 3] > 0.9)
    assert np.all(told[:, :2] < 0.5)


@pytest.mark.slow
def test_ranks_are_uniform_over_a_hundred_truths():
    """Truths and noise from their priors, on one surrogate. Chi-square over ten bins at 99.9 % for each parameter.

    Intervals of all parameters together cover 85 to 95 %: 90 % within 2.5 standard deviations of 100 truths.
    """
    model, size = Chain(), 2
    rng = np.random.default_rng(17)
    values = np.column_stack([p.quantile(rng.random(200)) for p in model.priors])
    values[:, size:] = [1.0, 2e11]
    emulator = Emulator.fit(model.priors[:size], values[:, :size], model.frequencies(values)[0])
    priors = (*model.priors[:size], TEST_SD, DISCREPANCY_SD)
    modes = np.tile(np.arange(4), 3)
    ranks = []
    for seed in range(100):
        truth = np.array([float(p.quantile(rng.random())) for p in priors])
        logs, error = (part[0] for part in emulator.predict_known(truth[None, :size]))
        bias = truth[-1] * rng.standard_normal(4)
        y = logs + bias[modes] + np.sqrt(truth[-2] ** 2 + error**2) * rng.standard_normal(12)

        def log_likelihood(x, y=y):
            logs, error = emulator.predict_known(x[:, :size])
            found = offsets(y - logs, x[:, -2:-1] ** 2 + error**2, x[:, -1], modes, 4)
            return found.log_likelihood.sum(axis=1)

        ranks.append((temper(log_likelihood, priors, count=320, seed=seed).samples < truth).mean(axis=0))
    ranks = np.array(ranks)
    for each in ranks.T:
        counts = np.histogram(each, bins=10, range=(0, 1))[0]
        assert ((counts - 10) ** 2 / 10).sum() < stats.chi2.ppf(0.999, 9)
    assert 0.85 < np.mean((ranks > 0.05) & (ranks < 0.95)) < 0.95


def test_the_surrogate_is_drawn_closer_where_the_prior_is_wide():
    """A decade and more of stiffness: the cubic over the prior is too rough, the one about the posterior is not."""
    model = Chain()
    model.priors = (Distribution(kind="lognormal", centre=1e7, spread=1.5), *Chain.priors[1:])
    test = twin((2e6, 0.7, 1.0, 2e11), 3)
    found = identify_model(model, test, LOADS, count=COUNT)
    whole = Emulator.fit(model.priors, values := _sobol(model), model.frequencies(values)[0])
    assert found.rounds >= 1
    assert found.surrogate_error.max() < 0.2 * whole.over_prior.error.max()
    assert np.nanmax(found.checked) < 0.003
    assert "surrogate-rough" not in codes(found)
    low, _, high = found.quantiles()
    assert low[0] < 2e6 < high[0]


def _sobol(model):
    from scipy.stats import qmc

    points = qmc.Sobol(len(model.priors), rng=np.random.default_rng(0)).random(256)
    return np.column_stack([p.quantile(u) for p, u in zip(model.priors, points.T, strict=True)])


def test_a_bias_of_one_mode_is_found():
    slopes = 0.01 * np.random.default_rng(2).standard_normal((3, 4, 1))
    model = Linear(slopes)
    test = twin([1.05], 0, model, 0.0, 0.002) * np.exp([0, 0, 0.04, 0])
    found = identify_model(model, test, LOADS, count=COUNT, evaluations=32)
    mean, sd = found.offsets
    assert abs(mean[2] - 0.04) < 3 * sd[2]
    assert np.all(np.abs(mean[[0, 1, 3]]) < 3 * sd[[0, 1, 3]])
    assert found.quantiles()[1, -1] > 0.01


# -- what it says


def test_the_result(chain):
    assert chain.names == (*Chain.names, "test scatter", "model discrepancy")
    assert chain.samples.shape == (COUNT, 6)
    assert chain.predicted.shape == (3, 3, 4)
    assert np.all(np.diff(chain.predicted, axis=0) > 0)
    assert chain.left_out.tolist() == [False, False, True]
    assert chain.used.sum() == 8
    assert chain.correlation == pytest.approx(np.corrcoef(chain.samples.T))
    assert chain.mean == pytest.approx(chain.samples.mean(axis=0))
    assert chain.posterior_contraction == pytest.approx(chain.sd / [p.sd for p in chain.priors])
    assert chain.quantiles((0.1, 0.9)).shape == (2, 6)
    assert chain.answered == chain.evaluations >= 256
    assert codes(chain) == ["not-told"]
    assert "The test carries no information about unseen" in chain.notes[0].text


def test_least_squares_and_what_the_test_sees(chain):
    peak = chain.samples[np.argmax(chain.log_likelihood.sum(axis=1))]
    likeliest = Chain().frequencies(peak[None, :4])[0][0]
    assert chain.fit.misfit <= np.sqrt(np.mean(np.log(chain.test / likeliest)[:2] ** 2))
    at = Chain().frequencies(chain.fit.values[None, :])[0][0]
    assert chain.fit.frequencies == pytest.approx(at)
    assert chain.fit.misfit == pytest.approx(np.sqrt(np.mean(np.log(chain.test / at)[:2] ** 2)))
    assert 8 < chain.fit.agreeing <= chain.fit.starts
    assert chain.fit.frequencies.shape == (3, 4)
    seen = chain.singular
    assert np.all(np.diff(seen.values) <= 0)
    assert seen.vectors @ seen.vectors.T == pytest.approx(np.eye(4), abs=1e-10)
    assert abs(seen.vectors[-1, 3]) > 0.99
    assert seen.posterior_contraction[-1] > 0.99
    assert seen.posterior_contraction[0] < 0.1
    assert seen.text.endswith("It does not identify unseen.")
    assert "contact.c" in seen.text.partition(". It")[0]


def test_what_is_seen_of_a_sum():
    """Only x1 + x2 enters: one singular value in closed form, the difference unseen."""
    model = Linear(np.full((3, 1, 2), 0.01))
    s, t = 0.002, 0.001
    test = twin([1.0, 1.1], 0, model, 0, s)
    found = identify_model(model, test, LOADS, count=COUNT, evaluations=64, test_sd=fixed(s), discrepancy=fixed(t))
    row = np.linalg.solve(np.linalg.cholesky(s**2 * np.eye(3) + t**2), np.full(3, 0.01))
    assert found.singular.values == pytest.approx([np.sqrt(2) * np.linalg.norm(row), 0], rel=1e-3, abs=1e-6)
    assert found.singular.text == "The test identifies 0.71 x1 + 0.71 x2. It does not identify 0.71 x1 - 0.71 x2."
    assert found.correlation[0, 1] < -0.8


def test_more_parameters_than_frequencies_runs_and_says_so():
    model = Linear(0.02 * np.random.default_rng(1).standard_normal((1, 2, 5)))
    found = identify_model(model, twin([1.0] * 5, 0, model), LOADS[:1], count=200, evaluations=64)
    assert "more-parameters-than-data" in codes(found)
    assert "5 parameters and 2 frequencies" in found.notes[0].text
    assert found.singular.values.shape == (5,)
    assert found.singular.text.partition("not identify ")[2].count(";") == 2  # three combinations, the least seen first


def test_points_without_an_answer_are_counted_by_reason():
    def change(values, f, reasons):
        lost = np.array(["the joint opens" if x < 0.9 else "" for x in values[:, 0]])
        lost[np.argmax(values[:, 1])] = "no equilibrium"
        return f, list(lost)

    model = Linear(0.02 * np.random.default_rng(1).standard_normal((3, 2, 2)))
    altered = Altered(model, change)
    found = identify_model(altered, twin([1.1, 1.0], 0, model), LOADS, count=200, evaluations=128)
    note = next(n for n in found.notes if n.code == "no-answer")
    assert "points that were evaluated have no answer: the joint opens (" in note.text
    assert "no equilibrium (" in note.text
    assert found.answered < found.evaluations


def test_a_posterior_where_the_model_has_no_answer_is_said():
    def change(values, f, reasons):
        return f, ["the joint opens" if x < 0.95 else "" for x in values[:, 0]]

    model = Linear(0.02 * np.ones((3, 2, 1)))
    found = identify_model(Altered(model, change), twin([0.9], 0, model, 0), LOADS, count=200, evaluations=128)
    assert "no-answer" in codes(found)


def test_a_truth_beyond_the_prior_presses_against_its_end():
    limited = Distribution(kind="uniform", centre=1.0, spread=0.1)
    model = Linear(0.03 * np.ones((3, 3, 1)), priors=(limited,))
    found = identify_model(model, twin([1.25], 0, model, 0.001, 0.001), LOADS, count=200, evaluations=32)
    note = next(n for n in found.notes if n.code == "end-of-prior")
    assert note.text.startswith("x1 presses against the upper end of its prior: ")


def test_a_surrogate_that_cannot_follow_is_said():
    model = Linear(0.03 * np.ones((3, 3, 1)))

    def jagged(values, f, reasons):
        return f * np.exp(0.03 * np.sign(np.sin(500 * values[:, 0])))[:, None, None], reasons

    found = identify_model(Altered(model, jagged), twin([1.05], 0, model), LOADS, count=200, evaluations=64)
    assert found.rounds < 3  # a round that gains nothing is the last
    assert "surrogate-wide" in codes(found)


def test_two_solutions_are_said():
    model = Linear(0.1 * np.ones((3, 3, 1)))

    def even(values, f, reasons):
        return 100 * np.exp(0.1 * ((values[:, 0] - 1) / 0.1) ** 2)[:, None, None] * np.ones_like(f), reasons

    altered = Altered(model, even)
    found = identify_model(altered, twin([1.15], 0, altered, 0, 0.001), LOADS, count=200, evaluations=64)
    assert "not-mixed" in codes(found)
    assert 0.1 < np.mean(found.samples[:, 0] > 1) < 0.9


def test_a_mode_without_partner_is_left_out_and_said():
    def change(values, f, reasons):
        f[:, 1, 2] = np.nan
        f[: len(f) // 8, 0, 0] = np.nan
        return f, reasons

    test = twin(TRUTH, 0)
    test[0, 3] = np.nan
    found = identify_model(Altered(Chain(), change), test, LOADS, count=200)
    assert "mode 3 at 8 kN" in next(n.text for n in found.notes if n.code == "test-modes")
    assert found.used.tolist() == [[True, True, True, False], [True, True, False, True], [True] * 4]
    assert np.isnan(found.predicted[:, 1, 2]).all()
    assert np.isfinite(found.predicted[:, 0, 3]).all()
    assert Identification.__eq__(found, found)
    assert "\n8 kN         3" not in found.table()


# -- out and in


def test_it_is_read_as_it_was_written(chain, tmp_path):
    path = chain.save(tmp_path / "found.nc")
    again = Identification.load(path)
    assert again == chain
    assert again.notes == chain.notes
    assert again.priors == chain.priors
    tree = chain.to_xarray()
    assert set(tree.children) == {"posterior", "posterior_predictive", "observed_data", "log_likelihood"}
    assert tree["posterior"]["contact.c"].dims == ("chain", "draw")
    assert tree["posterior"]["contact.c"].attrs["units"] == "N/m"
    assert tree["posterior"]["contact.c"].values[0] == pytest.approx(chain.samples[:, 0])
    assert tree["posterior_predictive"]["frequency"].dims == ("chain", "draw", "load", "mode")
    assert tree["log_likelihood"]["frequency"].sizes == {"chain": 1, "draw": COUNT, "mode": 4}


def test_a_file_that_is_none_is_said(tmp_path):
    with pytest.raises(ReadError, match=r"no such file.*faying identify STUDY\.toml"):
        Identification.load(tmp_path / "none.nc")


def test_numbers_for_json(chain):
    held = json.loads(json.dumps(chain.to_dict(), allow_nan=False))
    assert held["parameters"]["contact.c"]["unit"] == "N/m"
    assert held["parameters"]["contact.c"]["quantiles"]["0.5"] == pytest.approx(chain.quantiles()[1, 0])
    assert held["predicted"]["quantiles"]["0.95"][2][0] == pytest.approx(chain.predicted[2, 2, 0])
    assert held["notes"][0]["code"] == "not-told"


def test_an_identification_is_one_page(chain):
    from faying.output.report_predicted import identified

    page = identified(chain, "a <chain>", "made by the model")
    assert "a &lt;chain&gt;: identification" in page
    assert "The test carries no information about unseen" in page
    assert "contact.c" in page
    assert page.count("<figure>") == 1


def test_the_table_fits_a_terminal(chain):
    lines = chain.table().splitlines()
    assert max(map(len, lines)) <= 80
    assert sum("left out" in line for line in lines) == 4
    assert any(line.startswith("contact.c") and "MN/m" in line for line in lines)
    assert len(repr(chain).splitlines()) <= 12
    assert f"{chain.log_evidence:.2f}" in repr(chain)


def test_it_is_plotted_and_loaded_by_what_its_file_says(chain, tmp_path):
    axes = chain.plot()
    axes[0].figure.savefig(tmp_path / "identification.png")
    assert [len(one.get_yticks()) for one in axes] == [len(chain.names), chain.test.shape[1]]
    with pytest.raises(faying.InputError, match="draws into 2 matplotlib axes"):
        chain.plot(axes[0])
    assert faying.load(chain.save(tmp_path / "identification.nc")) == chain


def test_the_same_seed_gives_the_same_numbers():
    model = Linear(0.02 * np.ones((3, 2, 1)))
    test = twin([1.1], 0, model)
    told = []
    runs = [
        identify_model(model, test, LOADS, count=100, evaluations=32, seed=s, report=lambda *a: told.append(a))
        for s in (1, 1, 2)
    ]
    assert runs[0] == runs[1]
    assert not np.array_equal(runs[0].samples, runs[2].samples)
    assert ("sampling", 1000, 1000) in told


def test_many_combinations_are_counted():
    seen = Identifiability(names=tuple("abcdefg"), values=np.array([9.0, 8, 7, 6, 5, 0.1, 0.0]), vectors=np.eye(7))
    assert seen.text == "The test identifies a; b; c; and 2 more combinations. It does not identify g; f."
    assert (
        Identifiability(names=("a",), values=np.array([1.0]), vectors=np.eye(1)).text
        == "The test identifies none of the parameters."
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"test": np.ones(3)}, r"test of shape \(3,\) for loads of shape \(3,\); it must be \(load, mode\)"),
        ({"loads": LOADS[:2]}, "for loads of shape"),
        ({"test": np.full((3, 4), np.nan)}, "the test has no frequency; an identification needs"),
        ({"leave_out": [0, 1, 2]}, "no frequency apart from the loads that are left out"),
        ({"leave_out": [3]}, "leave_out = 3; the test has 3 loads, counted from 0"),
        ({"test": -np.ones((3, 4))}, "a frequency of -1 Hz; frequencies are positive"),
        ({"test": np.ones((3, 5))}, r"frequencies of shape \(256, 3, 4\); \(256, 3, 5\) is needed"),
    ],
)
def test_a_test_that_cannot_be_used_is_said(changes, message):
    given = {"test": twin(TRUTH, 0), "loads": LOADS} | changes
    with pytest.raises(InputError, match=message):
        identify_model(Chain(), **given)


def test_a_model_without_answers_is_said():
    def change(values, f, reasons):
        return f, ["the joint opens"] * len(values)

    with pytest.raises(InputError, match=r"at 0 of 256 points of the priors.*needs 10.*the joint opens \(256\)"):
        identify_model(Altered(Chain(), change), twin(TRUTH, 0), LOADS)


def test_a_model_without_partners_is_said():
    def change(values, f, reasons):
        f[40:] = np.where(np.arange(4) == 3, f[40:], np.nan)
        return f, reasons

    test = twin(TRUTH, 0)
    test[:, 3] = np.nan
    with pytest.raises(InputError, match="no frequency of the test has a partner in the model"):
        identify_model(Altered(Chain(), change), test, LOADS)


# -- damping


@pytest.fixture(scope="module")
def damped():
    """A test with loss factors, scattered by 10 % and off by some 20 % in each mode; one of them is missing."""
    rng = np.random.default_rng(8)
    whole = DampedChain().frequencies(np.array([[*TRUTH[:3], 0.05]]))[0][0]
    losses = whole[:, 4:] * np.exp(0.2 * rng.standard_normal(4) + 0.1 * rng.standard_normal((3, 4)))
    losses[0, 1] = np.nan
    return twin(TRUTH, 0), losses


def test_loss_factors_tell_what_frequencies_do_not(damped):
    test, losses = damped

    class Undamped(DampedChain):
        def frequencies(self, values, report=None, allowed=0.0):
            f, reasons = super().frequencies(values)
            return f[:, :, :4], reasons

    without = identify_model(Undamped(), test, LOADS, leave_out=[2], count=COUNT)
    found = identify_model(DampedChain(), test, LOADS, leave_out=[2], count=COUNT, losses=Losses(values=losses))
    assert without.posterior_contraction[3] > 0.85
    assert "not-told" in codes(without)
    low, high = found.quantiles((0.01, 0.99))[:, 3]
    assert low < 0.05 < high
    low, _, high = found.quantiles()[:, 3]
    assert np.log(high / low) < 0.4 * np.log(np.divide(*without.quantiles((0.95, 0.05))[:, 3]))
    # the frequencies say of the rest what they said before
    assert found.quantiles((0.5,))[0, :3] == pytest.approx(without.quantiles((0.5,))[0, :3], rel=0.05)
    low, _, high = found.predicted_losses
    assert ((losses[2] > low[2]) & (losses[2] < high[2])).sum() >= 3
    assert found.predicted.shape == found.predicted_losses.shape == (3, 3, 4)
    assert found.losses_used.sum() == 7
    assert found.names[-2:] == ("loss test scatter", "loss model discrepancy")


def test_loss_factors_are_written_read_and_shown(damped, tmp_path):
    test, losses = damped
    found = identify_model(DampedChain(), test, LOADS, count=COUNT, losses=Losses(values=losses))
    assert Identification.load(found.save(tmp_path / "i.nc")) == found
    assert "test loss" in found.table()
    said = json.loads(json.dumps(found.to_dict()))["loss_factors"]
    assert said["test"][0][1] is None
    assert said["quantiles"]["0.5"][2][3] == pytest.approx(found.predicted_losses[1, 2, 3])
    _, _, loss = figure(found).axes
    dots = [line.get_xdata() for line in loss.lines if line.get_marker() == "s"]
    assert np.array(dots) == pytest.approx(100 * (losses / found.predicted_losses[1] - 1), nan_ok=True)


def test_evidence_with_loss_factors_is_that_of_the_closed_form():
    """Frequencies and loss factors of a linear-Gaussian model, each with noise and offsets of their own."""
    slopes = 0.02 * np.random.default_rng(4).standard_normal((3, 4, 2))
    model, s, t, loss_s, loss_t = Linear(slopes), 0.004, 0.008, 0.02, 0.03
    whole = np.exp(model.logs(np.array([[1.1, 0.85]])))[0]
    rng = np.random.default_rng(3)
    data = whole * np.exp(rng.normal(0, 1, (3, 4)) * np.repeat([s, loss_s], 2))
    found = identify_model(
        model,
        data[:, :2],
        LOADS,
        count=4000,
        test_sd=fixed(s),
        discrepancy=fixed(t),
        losses=Losses(values=data[:, 2:], scatter=fixed(loss_s), discrepancy=fixed(loss_t)),
        evaluations=64,
    )
    design, modes = slopes.reshape(12, 2), np.tile(np.eye(4), (3, 1))
    offset, noise = np.repeat([t, loss_t], 2), np.tile(np.repeat([s, loss_s], 2), 3)
    cov = design @ design.T + (modes * offset**2) @ modes.T + np.diag(noise**2)
    y = np.log(data / 100).ravel()
    assert found.log_evidence == pytest.approx(stats.multivariate_normal.logpdf(y, cov=cov), abs=0.2)
    exact = design.T @ np.linalg.solve(cov, y)
    sd = np.sqrt(np.diag(np.eye(2) - design.T @ np.linalg.solve(cov, design)))
    assert (found.mean[:2] - 1) / 0.1 == pytest.approx(exact, abs=0.06 * sd.max())
    assert found.sd[:2] / 0.1 == pytest.approx(sd, rel=0.06)


@pytest.mark.slow
def test_a_law_without_loss_leaves_the_loss_factors_out_and_says_so(damped):
    test, losses = damped

    def lossless(values, f, reasons):
        f[:, :, 4:] = np.nan
        return f, reasons

    found = identify_model(Altered(DampedChain(), lossless), test, LOADS, count=COUNT, losses=Losses(values=losses))
    assert not found.losses_used.any()
    lossy = identify_model(DampedChain(), test, LOADS, count=COUNT, losses=Losses(values=losses))
    both = mixed({"lossy": lossy, "lossless": found}, {"lossy": 0.5, "lossless": 0.5})
    assert codes(both)[0] == "evidence"
    assert "evidence" not in codes(mixed({"one": lossy, "other": lossy}, {"one": 0.5, "other": 0.5}))
    assert both.predictive_losses.shape == lossy.predictive_losses.shape
    text = next(note.text for note in found.notes if note.code == "test-modes")
    assert "loss factor of mode 1 at 4 kN" in text


def test_loss_factors_that_cannot_be_are_refused(damped):
    test, losses = damped
    for wrong in (losses[:, :3], -losses):
        with pytest.raises(InputError, match=r"positive ones of shape \(3, 4\) are due"):
            identify_model(DampedChain(), test, LOADS, losses=Losses(values=wrong))
