"""The interval of a frequency from what is not known, and the score against a test."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from faying.result.interval import Interval
from faying.result.run_record import MeasuredComparison
from faying.result.score import Score

SCORE = 1.6448536


def interval(*sources: tuple[float, float]) -> Interval:
    """One load, one mode; each source by its mean and standard deviation of ln f."""
    offsets = {f"source {k}": np.array([-SCORE * sd, SCORE * sd])[:, None, None] for k, (_, sd) in enumerate(sources)}
    return Interval.about(np.array([[100.0 * np.exp(sum(m for m, _ in sources))]]), offsets)


def test_independent_normal_sources_have_the_quantiles_of_their_sum():
    rng = np.random.default_rng(0)
    sources = (0.0, 0.01), (-0.02, 0.03), (0.004, 0.002)
    drawn = 100.0 * np.exp(sum(rng.normal(m, sd, 400_000) for m, sd in sources))
    found = interval(*sources)
    # the quantiles of 400,000 samples scatter by sqrt(0.05 * 0.95/400,000)/density = 0.33 % of the standard deviation
    ends = [found.low[0, 0], found.high[0, 0]]
    assert ends == pytest.approx(np.quantile(drawn, [0.05, 0.95]), abs=100 * 0.0318 * 0.015)
    # the median scatters by half over sqrt(400,000) times the density: 0.2 % of the standard deviation
    assert found.best[0, 0] == pytest.approx(np.median(drawn), abs=100 * 0.0318 * 0.01)


def test_no_stiffness_of_a_joint_passes_free_and_bonded_faces():
    offsets = {"law": np.array([-0.9, 0.3]), "mode": np.array([-0.02, 0.02])}
    plain = Interval.about(np.array([[100.0]]), {name: one[:, None, None] for name, one in offsets.items()})
    found = plain.between(np.array([60.0]), np.array([105.0]))
    low, high = found.low, found.high
    # what is not known of the parts moves the bounds as well
    assert low[0, 0] == pytest.approx(60 * np.exp(-0.02))
    assert high[0, 0] == pytest.approx(105 * np.exp(0.02))


def test_the_best_estimate_of_modes_that_change_places_lies_between_its_ends():
    """Two modes at 100 and 104 Hz whose ends are 2 and 10 % away, with bounds of ranks between them."""
    ends = np.log([[0.98, 0.90], [1.02, 1.10]])[:, None]
    plain = Interval.about(np.array([[100.0, 104.0]]), {"law": ends})
    found = plain.between(np.array([93.0, 101.0]), np.array([103.0, 120.0]))
    assert np.all(found.low <= found.best)
    assert np.all(found.best <= found.high)


def test_a_part_that_moves_one_mode_past_another_leaves_both_where_they_are():
    """Each mode in a part of its own, which no joint moves; the first part is 4 % higher by its test."""
    moved = np.array([[0.04, 0.0]])
    offsets = {"mode": np.array([-0.01, 0.01])[:, None, None] * np.ones(2)}
    plain = Interval.about(np.array([[100.0, 101.0]]) * np.exp(moved), offsets, moved)
    found = plain.between(*2 * (np.array([100.0, 101.0]),))
    assert found.best == pytest.approx(plain.best, rel=1e-12)
    assert found.low == pytest.approx(plain.low, rel=1e-12)
    assert found.high == pytest.approx(plain.high, rel=1e-12)


def test_one_source_that_is_not_symmetric_keeps_its_own_quantiles():
    """f = 100 (1 - exp(-x)) of a normal x, as stiffness that saturates: its median is no middle of its ends."""
    x = 1.0 + 0.5 * SCORE * np.array([-1.0, 0.0, 1.0])
    low, middle, high = 100 * (1 - np.exp(-x))
    ends = np.log([low / middle, high / middle])
    still = np.array([-1e-4, 1e-4])
    offsets = {"law": ends[:, None, None], "other": still[:, None, None]}
    found = Interval.about(np.array([[middle]]), offsets)
    got = [found.low[0, 0], found.best[0, 0], found.high[0, 0]]
    assert got == pytest.approx([low, middle, high], rel=1e-6)


def test_shares_are_those_of_the_variance_and_sum_to_one():
    found = interval((0.0, 0.01), (0.01, 0.03))
    assert found.shares[:, 0, 0] == pytest.approx([0.1, 0.9])
    assert found.width[0, 0] == pytest.approx(2 * SCORE * np.hypot(0.01, 0.03))


def test_what_is_known_better_narrows_by_its_share_alone():
    found = interval((0.0, 0.01), (0.01, 0.03))
    assert found.narrowed_width({"source 1": 0.5})[0, 0] == pytest.approx(2 * SCORE * np.hypot(0.01, 0.015))
    assert found.narrowed_width({"another": 0.1}) == found.width


def result(test, predicted, low=None, high=None, modes=None):
    """What a score reads of a result."""
    test, predicted = np.asarray(test, dtype=float), np.asarray(predicted, dtype=float)
    modes = np.tile(np.arange(test.shape[1]), (len(test), 1)) if modes is None else np.asarray(modes)
    return SimpleNamespace(
        comparison=MeasuredComparison(source="made up", frequencies=test, predicted=predicted, modes=modes),
        loads=np.arange(1, len(test) + 1) * 1e3,
        bonded=np.full(test.shape[1], 200.0),
        free=np.full(test.shape[1], 50.0),
        interval=None if low is None else SimpleNamespace(ends=np.stack([low, high])),
    )


def test_a_model_with_the_right_change_and_the_wrong_level_adds_to_the_test():
    """The true change is 2 %; the model has it, 5 % too high throughout."""
    score = Score.of(result([[100.0, 150.0], [102.0, 153.0]], [[105.0, 157.5], [107.1, 160.65]]))
    assert score.errors("Faying") == pytest.approx([0.05, 0.05])
    assert score.errors("test at the load before")[1] == pytest.approx(1 - 1 / 1.02)
    assert np.isnan(score.errors("test at the load before")[0])
    assert score.errors("that times Faying's ratio")[1] == pytest.approx(0.0, abs=1e-12)
    assert score.gain == pytest.approx(0.0, abs=1e-9)
    assert score.errors("faces bonded")[0] == pytest.approx(np.sqrt((1.0**2 + (1 / 3) ** 2) / 2))


def test_a_model_whose_change_is_twice_too_large_adds_nothing():
    score = Score.of(result([[100.0], [102.0]], [[100.0], [104.04]]))
    assert score.gain == pytest.approx(1.02)


def test_modes_without_partner_do_not_count():
    modes = [[0, -1], [0, -1]]
    predicted = [[100.0, np.nan], [101.0, np.nan]]
    low, high = np.full((2, 2), 99.5), np.full((2, 2), 100.5)
    score = Score.of(result([[100.0, 70.0], [101.0, 71.0]], predicted, low, high, modes))
    assert score.measured == 2
    assert score.errors("Faying") == pytest.approx([0.0, 0.0])
    assert score.inside.tolist() == [[True, False], [False, False]]


def test_no_score_without_a_test():
    nothing = result([[100.0]], [[100.0]], modes=[[-1]])
    assert Score.of(nothing) is None
    nothing.comparison = None
    assert Score.of(nothing) is None


def test_bars_of_a_comparison_are_the_intervals_wherever_the_points_lie():
    """A frequency as modelled may lie outside its own interval; a bar does not reach to it."""
    from matplotlib.figure import Figure

    from faying.result.figure import comparison
    from tests.helpers.figures import result

    found = result()
    ends = {"low": 1.05 * found.frequencies, "high": 1.1 * found.frequencies}
    shifted = replace(found, interval=replace(found.interval, **ends))
    ax = comparison(Figure().subplots(), shifted)
    c = shifted.comparison
    for row, bars in enumerate(ax.collections):
        ends = np.array([segment[:, 1] for segment in bars.get_segments()])
        own = shifted.frequencies[row, c.modes[row]] / c.frequencies[row]
        assert ends == pytest.approx(100 * (np.outer(own, [1.05, 1.1]) - 1))
