import numpy as np
import pytest
from matplotlib.figure import Figure

from faying import FRF, compare_modes, identify_modes
from faying.measured import figure as measured
from faying.measured.model import ModelModes
from faying.measured.modes import ModeSet


@pytest.fixture
def comparison():
    rng = np.random.default_rng(0)
    shapes = np.linalg.qr(rng.standard_normal((30, 3)))[0].T.reshape(3, 10, 3)
    f = np.array([100.0, 200.0, 300.0])
    model = ModelModes(
        frequencies=f,
        loss_factors=np.full(3, 0.02),
        shapes=shapes,
        points=rng.uniform(0, 1, (10, 3)),
        triangles=np.array([[0, 1, 2], [3, 4, 5]]),
    )
    order = [1, 0]
    dofs = [(k, d) for k in range(6) for d in "xyz"]
    test = ModeSet(
        frequencies=f[order],
        loss_factors=np.full(2, 0.02),
        dofs=dofs,
        lines=((0, 1), (1, 99)),
        shapes=1j * shapes[order][:, :6].reshape(2, 18),
        positions={k: tuple(model.points[k]) for k in range(6)},
    )
    lines = np.arange(1, 400.0)
    here = (np.array([0]), np.eye(3)[2:])
    frf = FRF(
        frequency=lines,
        values=model.frf(lines, here, here, "mobility"),
        outputs=[(0, "z")],
        inputs=[(0, "z")],
        quantity="mobility",
    )
    return compare_modes(test, model, frf=frf)


def axes(**options):
    return Figure().add_subplot(**options)


def test_mac_shows_every_value_and_frames_the_pairs(comparison):
    ax = measured.mac_map(axes(), comparison)
    np.testing.assert_array_equal(ax.images[0].get_array(), comparison.mac)
    assert len(ax.texts) == comparison.mac.size
    assert {patch.get_xy() for patch in ax.patches} == {(0.5, -0.5), (-0.5, 0.5)}


def test_overlay_draws_both_and_says_frac(comparison):
    ax = measured.frf_overlay(axes(), comparison)
    test, model = (line.get_ydata() for line in ax.lines)
    np.testing.assert_allclose(test, model)
    assert "FRAC 1.00" in ax.get_title(loc="left")


def test_the_measured_shape_stands_where_the_model_s_does(comparison):
    """A test that is the model, times i: its drawn points coincide with those of the model's drawing."""
    for pair in range(2):
        here, there = axes(), axes()
        moved = np.array(measured.shape_test(here, comparison, pair).lines[-1].get_data())
        at = np.array(measured.shape_model(there, comparison, pair).lines[-1].get_data())
        np.testing.assert_allclose(np.sort(moved, axis=1), np.sort(at, axis=1), atol=1e-9)


def test_stabilisation_and_fit():
    f = np.arange(1, 500.0)
    model = ModelModes(
        frequencies=np.array([120.0, 300]),
        loss_factors=np.full(2, 0.02),
        shapes=np.ones((2, 1, 3)),
        points=np.zeros((1, 3)),
    )
    here = (np.array([0]), np.eye(3)[2:])
    frf = FRF(
        frequency=f,
        values=model.frf(f, here, here, "mobility"),
        outputs=[(0, "z")],
        inputs=[(0, "z")],
        quantity="mobility",
    )
    found = identify_modes(frf)
    ax = measured.stabilisation(axes(), found)
    assert len(ax.lines[1].get_xdata()) == (found.poles.track >= 0).sum()
    ax = measured.frf_fit(axes(), found)
    size = ax.lines[0].get_ydata()
    np.testing.assert_allclose(ax.lines[1].get_ydata(), size, atol=0.01 * size.max())


def test_one_row_for_each_pair(comparison):
    assert len(measured.shapes_side_by_side(comparison).axes) == 4
