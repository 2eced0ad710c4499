"""Single precision, threads, products and memory of the half-space."""

import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faying.errors import InputError, NotConverged
from faying.halfspace import error_bound, solve_half_space
from faying.halfspace.cells import Cells
from faying.halfspace.conjugate import CellSystem
from faying.halfspace.kernels import normal_kernel, shear_kernel
from faying.halfspace.solve import memory_needed


def test_the_precisions_are_listed():
    with pytest.raises(InputError, match='precision = \'half\'; allowed: "double", "single"'):
        solve_half_space(np.eye(8), 1.0, E_star=1.0, pressure=0.1, precision="half")


@pytest.mark.parametrize("hardness", [None, 0.05])
@pytest.mark.parametrize("lift", [0.0, 30.0])
def test_single_precision_is_certified_in_double(rough, hardness, lift):
    # lift: heights far from 0 against their roughness must cost no digits
    h = rough(128)
    h = h + lift * h.std()
    given = {"E_star": 3.0, "pressure": 0.03, "hardness": hardness and 3 * hardness}
    exact = solve_half_space(h, 1 / 128, tol=1e-11, **given)
    single = solve_half_space(h, 1 / 128, tol=1e-5, precision="single", **given)
    assert (single.traction.dtype, single.displacement.dtype) == (np.float32, np.float32)
    bound = error_bound(h, 1 / 128, single.traction.astype(float), E_star=3.0, hardness=given["hardness"])
    assert single.residual == pytest.approx(bound, rel=1e-6)
    assert single.residual < 1e-5
    assert single.pressure == pytest.approx(0.03, rel=1e-6)
    assert single.saturated == pytest.approx(exact.saturated, abs=2e-3)
    # the bound says |x - x*|_A^2/2 <= residual * load * rms height, in units of E* and of the cell
    v = (single.traction.astype(float) - exact.traction) / 3.0
    moved = normal_kernel(h.shape, 1.0, periodic=True).apply(v[None])[0]
    assert (v * moved).sum() / 2 <= bound * exact.traction.sum() / 3.0 * h.std() * 128


def test_single_precision_of_heights_in_single_precision_keeps_them(rough):
    h = rough(64).astype(np.float32)
    contact = solve_half_space(h, 1 / 64, E_star=1.0, pressure=0.01, tol=1e-5, precision="single")
    assert contact.heights.dtype == np.float32
    assert error_bound(h, 1 / 64, contact.traction, E_star=1.0) == pytest.approx(contact.residual, rel=1e-5)


def test_a_tolerance_beyond_single_precision_is_refused_with_the_remedy(rough):
    with pytest.raises(NotConverged, match='tol, or precision="double"'):
        solve_half_space(rough(64), 1 / 64, E_star=1.0, pressure=0.01, tol=1e-13, precision="single")


def test_threads_do_not_change_the_contact(rough):
    h = rough(64)
    one, two = (solve_half_space(h, 1 / 64, E_star=1.0, pressure=0.01, workers=w) for w in (None, 2))
    assert one.traction == pytest.approx(two.traction, abs=1e-6 * one.traction.max())


@settings(max_examples=15, deadline=None)
@given(
    st.integers(0, 2**32 - 1),
    st.sampled_from([(40, 40), (33, 57)]),
    st.floats(0.02, 1.0),
    st.sampled_from(["normal", "free", "shear"]),
)
def test_the_preconditioner_is_symmetric_and_positive_and_keeps_totals(seed, shape, share, kind):
    kernel = {
        "normal": lambda: normal_kernel(shape, 1.3, periodic=True),
        "free": lambda: normal_kernel(shape, 1.3, periodic=False),
        "shear": lambda: shear_kernel(shape, 1.3, 0.3, periodic=True),
    }[kind]()
    random = np.random.default_rng(seed)
    mask = random.random(shape[0] * shape[1]) < share
    mask[:2] = True
    system = CellSystem(kernel, Cells(kernel, mask))
    a, b = random.standard_normal((2, kernel.components, int(mask.sum()))).astype(np.float32)
    Ma, Mb = system.preconditioned(a), system.preconditioned(b)
    size = float(np.sqrt(np.vdot(a, Ma) * np.vdot(b, Mb)))
    assert size > 0
    # what holds for K exactly, holds to the tolerance of its iteration on more than 100 blocks; here are fewer
    assert float(np.vdot(b, Ma)) == pytest.approx(float(np.vdot(a, Mb)), abs=1e-4 * size)
    assert np.abs(Ma.sum(axis=1)).max() < 1e-5 * np.abs(Ma).sum()


def test_products_do_not_grow_with_the_map(rough):
    """From 128 to 1024 points a side, over a band of waves that grows with it (one level alone: 65 to 82)."""
    counts = [solve_half_space(rough(n, 1), 1 / n, E_star=1.0, pressure=0.01).applications for n in (128, 1024)]
    assert counts[1] <= 1.25 * counts[0]
    counts = [
        solve_half_space(rough(n, 1), 1 / n, E_star=1.0, pressure=0.002, hardness=0.005).applications
        for n in (128, 1024)
    ]
    assert counts[1] <= 1.25 * counts[0]


@pytest.mark.parametrize("precision", ["double", "single"])
@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize(("pressure", "hardness"), [(0.01, None), (0.2, None), (0.002, 0.005)])
def test_memory_is_what_is_said_and_less_than_twelve_arrays(rough, pressure, hardness, periodic, precision):
    n = 256
    h = rough(n)
    solve_half_space(rough(32), 1 / 32, E_star=1.0, pressure=0.01)  # imports
    tracemalloc.start()
    try:
        given = {"E_star": 1.0, "pressure": pressure, "hardness": hardness, "periodic": periodic}
        solve_half_space(h, 1 / n, tol=1e-5, precision=precision, **given)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    said = memory_needed(h.shape, periodic=periodic, precision=precision)
    assert peak < said
    if pressure == 0.2:  # every point touches
        assert peak > 0.7 * said
    if periodic:
        large = memory_needed((8192, 8192), periodic=True, precision=precision)
        assert large / 8192**2 + 8 < 96  # with the map that was given


def test_memory_of_a_patch_counts_its_padding():
    assert memory_needed((512, 512), periodic=False) > 1.25 * memory_needed((512, 512), periodic=True)
