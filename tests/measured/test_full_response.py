"""The model's full response in a comparison, from a closed form: rigid motion, two modes known, one unknown."""

import numpy as np
import pytest

from faying import FRF, InputError, compare_modes
from faying.measured.model import FullResponse, ModelModes
from faying.measured.modes import ModeSet

RIGID, HIGH = 0.3, 2500.0
F, ETA = np.array([200.0, 450.0]), np.array([0.01, 0.004])


@pytest.fixture
def points():
    return np.random.default_rng(3).uniform(0, 1, (12, 3))


def truth(model, high, frequency, outputs, inputs):
    """Accelerance (o, i, f): rigid motion along each other, the model's modes, one mode beyond them."""
    (_, o), (_, i) = outputs, inputs
    w2 = (2 * np.pi * frequency) ** 2
    beyond = ModelModes(frequencies=np.array([HIGH]), loss_factors=np.array([0.02]), shapes=high, points=model.points)
    elastic = sum(m.receptance(frequency, outputs, inputs) for m in (model, beyond))
    return RIGID * (o @ i.T)[:, :, None] - w2 * elastic


@pytest.fixture
def case(points):
    rng = np.random.default_rng(4)
    model = ModelModes(frequencies=F, loss_factors=ETA, shapes=rng.standard_normal((2, 12, 3)), points=points)
    high = 3 * rng.standard_normal((1, 12, 3))
    eye = np.eye(3)
    outputs, inputs = (np.array([0, 0, 5]), eye[[0, 2, 1]]), (np.array([7]), eye[[2]])
    lines = np.arange(20, 800, 3.0)
    values = truth(model, high, lines, outputs, inputs) / -((2 * np.pi * lines) ** 2)
    full = FullResponse(
        frequency=lines,
        receptance=values,
        outputs=(points[outputs[0]], outputs[1]),
        inputs=(points[inputs[0]], inputs[1]),
    )
    return ModelModes(**{**vars(model), "full": full}), high, outputs, inputs


def test_at_its_own_lines_it_is_what_was_given(case):
    model, high, outputs, inputs = case
    lines = model.full.frequency
    found = model.full_frf(lines, outputs, inputs, "accelerance")
    np.testing.assert_allclose(found, truth(model, high, lines, outputs, inputs), rtol=1e-9)


def test_between_its_lines_peaks_narrower_than_their_spacing_are_kept(case):
    """The second peak is 1.8 Hz wide, the lines are 3 Hz apart; superposition alone is far off."""
    model, high, outputs, inputs = case
    lines = np.arange(20.5, 797, 1.0)
    exact = truth(model, high, lines, outputs, inputs)
    found = model.full_frf(lines, outputs, inputs, "accelerance")
    assert np.abs(found - exact).max() < 1e-3 * np.abs(exact).max()
    assert np.median(np.abs(found / exact - 1)) < 1e-4
    superposed = model.frf(lines, outputs, inputs, "accelerance")
    assert np.median(np.abs(superposed / exact - 1)) > 0.05


def test_signs_and_reciprocity(case):
    model, _, outputs, inputs = case
    lines = model.full.frequency
    straight = model.full_frf(lines, outputs, inputs, "mobility")
    np.testing.assert_allclose(
        model.full_frf(lines, (outputs[0], -outputs[1]), inputs, "mobility"), -straight, rtol=1e-12
    )
    np.testing.assert_allclose(
        model.full_frf(lines, inputs, outputs, "mobility"), straight.transpose(1, 0, 2), rtol=1e-9
    )


def test_nothing_is_made_up_where_it_is_not_known(case):
    model, _, outputs, inputs = case
    other = (np.array([1, 0]), np.array([[1.0, 0, 0], [0, 1, 0]]))  # another node; another direction
    assert np.isnan(model.full_frf(np.array([100.0, 200]), other, inputs, "receptance")).all()
    tilted = (outputs[0][:1], np.array([[np.cos(0.05), np.sin(0.05), 0]]))  # three degrees
    assert np.isnan(model.full_frf(np.array([100.0, 200]), tilted, inputs, "receptance")).all()
    edge = model.full_frf(np.array([0.0, 10, 20, 900]), outputs, inputs, "receptance")[0, 0]
    assert np.isfinite(edge).tolist() == [False, False, True, False]
    bare = ModelModes(**{**vars(model), "full": None})
    assert np.isnan(bare.full_frf(np.array([100.0]), outputs, inputs, "receptance")).all()


def compared(case, lines, more=()):
    model, high, _, inputs = case
    places = [(0, "x"), (0, "z"), (5, "y"), *more]
    every = (np.array([p for p, _ in places]), np.array([np.eye(3)["xyz".index(d)] for _, d in places]))
    values = truth(model, high, lines, every, inputs)
    positions = {k: tuple(model.points[k]) for k in (0, 3, 5, 7)}
    frf = FRF(
        frequency=lines, values=values, outputs=places, inputs=[(7, "z")], quantity="accelerance", positions=positions
    )
    dofs = [(k, d) for k in positions for d in "xyz"]
    test = ModeSet(
        frequencies=F,
        loss_factors=ETA,
        dofs=dofs,
        positions=positions,
        shapes=model.shapes[:, list(positions)].reshape(2, -1).astype(complex),
    )
    return compare_modes(test, model, frf=frf)


def test_a_comparison_takes_it_and_says_so(case):
    found = compared(case, np.arange(25.0, 790))
    assert found.full.all()
    np.testing.assert_allclose(found.frac, 1, atol=1e-5)
    assert any("are its full response" in note for note in found.notes)
    assert {one["model"] for one in found.to_dict()["frac"]} == {"full response"}


def test_pairs_that_it_lacks_stay_superposed(case):
    found = compared(case, np.arange(25.0, 790), more=((3, "x"),))
    assert found.full[:, 0].tolist() == [True, True, True, False]
    assert any("3 of 4 are its full response" in note for note in found.notes)


def test_lines_beyond_it_do_not_count(case):
    found = compared(case, np.arange(0.0, 1000))
    assert any("reaches from 20 to 797 Hz" in note for note in found.notes)
    np.testing.assert_allclose(found.frac, 1, atol=1e-5)


def test_shapes_of_a_full_response(points):
    with pytest.raises(InputError, match="need"):
        FullResponse(
            frequency=np.array([1.0, 2]),
            receptance=np.zeros((1, 1, 3), complex),
            outputs=(points[:1], points[:1]),
            inputs=(points[:1], points[:1]),
        )
