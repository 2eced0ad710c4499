import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from faying import FRF, InputError
from faying.measured.frf import Dof

F = np.linspace(0, 100, 101)


def one(values=None, **changes):
    given = {"frequency": F, "outputs": [(1, "z")], "inputs": [(1, "z")], "quantity": "receptance"} | changes
    return FRF(values=np.ones((1, 1, 101)) if values is None else values, **given)


def test_oscillator_in_its_three_quantities():
    """Stiffness line at the bottom, 1/c at resonance, inertia line at the top."""
    m, c, k = 2.0, 5.0, 8e4
    w = 2 * np.pi * F
    frf = one((1 / (k - m * w**2 + 1j * c * w))[None, None])
    assert frf.values[0, 0, 0] == pytest.approx(1 / k)
    resonance = FRF(
        frequency=[1.0, np.sqrt(k / m) / (2 * np.pi)],
        values=[[[1, 1 / (1j * c * np.sqrt(k / m))]]],
        outputs=[(1, "z")],
        inputs=[(1, "z")],
        quantity="receptance",
    )
    assert resonance.to("mobility").values[0, 0, 1] == pytest.approx(1 / c)
    assert frf.to("accelerance").values[0, 0, -1] == pytest.approx(1 / m, rel=0.15)
    assert [frf.to(q).unit for q in ("receptance", "mobility", "accelerance")] == ["m/N", "m/(N*s)", "m/(N*s^2)"]


@given(
    st.sampled_from(["receptance", "mobility", "accelerance"]),
    st.sampled_from(["receptance", "mobility", "accelerance"]),
)
def test_there_and_back(a, b):
    frf = one(quantity=a, frequency=F + 1)
    np.testing.assert_allclose(frf.to(b).to(a).values, frf.values, rtol=1e-12)


def test_the_line_at_rest_is_left_out_where_it_would_be_divided_by_zero():
    assert one(quantity="accelerance").to("receptance").frequency[0] == 1
    assert one().to("accelerance").frequency[0] == 0


def test_pairs_that_were_not_measured_are_nan():
    values = np.ones((2, 2, 101), complex)
    values[0, 1] = np.nan
    frf = one(values, outputs=[(1, "x"), (2, "x")], inputs=[(1, "x"), (2, "-x")])
    assert frf.measured == [(0, 0), (1, 0), (1, 1)]
    assert frf.rows().shape == (3, 101)


def test_directions():
    np.testing.assert_array_equal(Dof(3, "-y").axis(), [0, -1, 0])
    assert str(Dof(3, "-y")) == "3-y"
    assert str(Dof(3, "y")) == "3+y"
    assert one(outputs=[(1, "")]).directed("y").outputs == (Dof(1, "y"),)
    for direction in ("rx", ""):
        with pytest.raises(InputError, match="--direction z"):
            Dof(3, direction).axis()


def test_arrays_cannot_be_changed():
    with pytest.raises(ValueError, match="read-only"):
        one().values[0, 0, 0] = 2


@pytest.mark.parametrize(
    ("changes", "match"),
    [
        ({"quantity": "inertance"}, "use one of receptance"),
        ({"values": np.ones((1, 2, 101))}, r"need \(1, 1, 101\)"),
        ({"frequency": -F}, "must be two or more, not negative, and rise"),
        ({"values": np.where(F < 3, np.nan, 1.0)[None, None]}, "some of its frequencies only"),
        ({"values": np.full((1, 1, 101), np.nan)}, "leave such spectral lines out"),
        ({"outputs": [(1, "up")]}, "use one of 'x'"),
        ({"outputs": [(1, "z"), (1, "z")]}, "appears twice"),
        ({"coherence": np.ones(101)}, "coherence has the shape"),
    ],
)
def test_what_does_not_fit(changes, match):
    with pytest.raises(InputError, match=match):
        one(**changes)


def test_other_errors():
    with pytest.raises(InputError, match="use one of"):
        one().to("inertance")
    with pytest.raises(InputError, match="no two spectral lines between 200 and 300 Hz"):
        one().band(200, 300)
    with pytest.raises(InputError, match="evenly spaced"):
        _ = one(frequency=F**1.1).step
