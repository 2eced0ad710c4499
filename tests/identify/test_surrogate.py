"""The surrogate: exact on polynomials, its error that of refits, its gradient that of differences."""

import numpy as np
import pytest

from faying.errors import InputError
from faying.identify.sampling.surrogate import Surrogate

RNG = np.random.default_rng(3)
MIXED = [False, True, False]
FACTORIAL = np.array([1.0, 1.0, 2.0, 6.0])


def points(count, bounded=MIXED):
    x = RNG.standard_normal((count, len(bounded)))
    uniform = RNG.uniform(-1, 1, x.shape)
    return np.where(bounded, uniform, x)


def wavy(x):
    return np.column_stack([np.exp(0.3 * x[:, 0]) * np.sin(2 * x[:, 1] + x[:, 2]), np.cos(x[:, 0] * x[:, 1])])


def test_a_cubic_is_met_exactly():
    x, new = points(60), points(20)

    def cubic(x):
        a, b, c = x.T
        return np.column_stack([a**3 - 2 * a * b * c + 3, b**2 * c - a, 5 + 0 * a, 2 * a])

    fit = Surrogate.fit(x, cubic(x), bounded=MIXED)
    assert fit.predict(new) == pytest.approx(cubic(new), abs=1e-9)
    assert fit.error == pytest.approx(np.zeros(4), abs=1e-9)
    assert fit.degree[:2].tolist() == [3, 3]


def test_the_error_is_that_of_refits_without_each_point():
    x = points(45)
    y = wavy(x)
    fit = Surrogate.fit(x, y, degree=2, bounded=MIXED)
    for output in range(2):
        chosen = fit.terms[np.abs(fit.coefficients[:, output]) > 0]
        one = [
            np.polynomial.hermite_e.hermevander,
            np.polynomial.legendre.legvander,
            np.polynomial.hermite_e.hermevander,
        ]
        columns = np.prod(
            [van(x[:, j], 3)[:, chosen[:, j]] for j, van in enumerate(one)], axis=0
        )  # not normalised: least squares do not care
        missed = []
        for k in range(len(x)):
            rest = np.arange(len(x)) != k
            found = np.linalg.lstsq(columns[rest], y[rest, output], rcond=None)[0]
            missed.append(y[k, output] - columns[k] @ found)
        # Chapelle's correction, by columns that are orthonormal under the prior
        norms = np.sqrt(np.prod(np.where(MIXED, 1 / (2 * chosen + 1), FACTORIAL[chosen]), axis=1))
        inverse = np.linalg.inv((columns / norms).T @ (columns / norms))
        few = len(x) / (len(x) - len(chosen)) * (1 + np.trace(inverse))
        assert fit.error[output] == pytest.approx(np.sqrt(few * np.mean(np.square(missed))), rel=1e-10)


def test_the_error_tells_what_new_points_miss():
    """In the median of some draws: few points far out make most of a mean square, so that each draw scatters."""
    ratios = []
    for _ in range(8):
        x, new = points(300), points(4000)
        fit = Surrogate.fit(x, wavy(x), bounded=MIXED)
        ratios.append(fit.error / np.sqrt(np.mean((fit.predict(new) - wavy(new)) ** 2, axis=0)))
    typical = np.median(ratios, axis=0)
    assert np.all((typical > 0.6) & (typical < 1.6))


def test_the_gradient_is_that_of_differences():
    x = points(100)
    fit = Surrogate.fit(x, wavy(x), bounded=MIXED)
    at, h = points(7), 1e-5
    for j in range(3):
        step = h * np.eye(3)[j]
        slope = (fit.predict(at + step) - fit.predict(at - step)) / (2 * h)
        assert fit.gradient(at)[:, :, j] == pytest.approx(slope, abs=1e-7)


@pytest.mark.parametrize(("count", "inputs"), [(3, 2), (8, 3), (40, 8), (100, 8), (64, 20)])
def test_there_are_points_enough_for_every_coefficient(count, inputs):
    x = RNG.standard_normal((count, inputs))
    y = (x[:, :1] + 0.1 * x[:, 1:2] ** 2) ** 3
    fit = Surrogate.fit(x, y)
    assert np.count_nonzero(fit.coefficients) * 1.5 <= count or fit.degree[0] == 0
    assert np.isfinite(fit.error).all()


def test_many_inputs_keep_few_mixed_terms():
    x = RNG.standard_normal((120, 12))
    y = x[:, :1] ** 2 + x[:, 1:2] ** 3
    fit = Surrogate.fit(x, y)
    assert fit.error[0] < 1e-9
    assert len(fit.terms) <= 91


def test_points_without_an_answer_are_left_out_of_that_output_alone():
    x = points(80)
    y = wavy(x)
    y[:5, 0] = np.nan
    fit = Surrogate.fit(x, y, bounded=MIXED)
    assert fit.points.tolist() == [75, 80]
    alone = Surrogate.fit(x[5:], y[5:, :1], bounded=MIXED)
    assert fit.predict(x[:9])[:, 0] == pytest.approx(alone.predict(x[:9])[:, 0], rel=1e-9)
    assert fit.error[0] == pytest.approx(alone.error[0], rel=1e-9)


def test_an_output_without_answers_is_said():
    y = wavy(points(20))
    y[1:, 1] = np.nan
    with pytest.raises(InputError, match="output 2 has an answer at fewer than 2 points"):
        Surrogate.fit(points(20), y)
