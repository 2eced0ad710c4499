"""The solver itself: its error bound, its operator, invariances, and what it says to bad input."""

from math import pi

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import dblquad
from scipy.optimize import lsq_linear

from faying.errors import InputError, NotConverged
from faying.halfspace import error_bound, solve_half_space
from faying.halfspace import solve as module
from faying.halfspace.bounded import Problem, minimise, project
from faying.halfspace.kernels import normal_kernel, shear_kernel

maps = st.integers(0, 2**32 - 1).map(lambda seed: np.random.default_rng(seed).standard_normal((6, 9)) * 0.3)


def dense(kernel):
    """The operator as a matrix, column by column."""
    c, (ny, nx) = kernel.components, kernel.shape
    units = np.eye(c * ny * nx).reshape(-1, c, ny, nx)
    return np.array([kernel.apply(unit).ravel() for unit in units]).T


@pytest.mark.parametrize("aspect", [1.0, 1.7])
def test_free_kernels_are_the_integrals_of_boussinesq_and_cerruti(aspect):
    nu, shape = 0.3, (5, 4)
    G = (1 - nu) / 2
    normal = dense(normal_kernel(shape, aspect, periodic=False))
    shear = dense(shear_kernel(shape, aspect, nu, periodic=False)).reshape(2, 20, 2, 20)
    row, column = 3, 2
    seen = row * 4 + column  # from a load on the first cell

    def cell(f):
        return dblquad(
            lambda y, x: f(column - x, row * aspect - y, np.hypot(column - x, row * aspect - y)),
            -0.5,
            0.5,
            -aspect / 2,
            aspect / 2,
            epsabs=1e-12,
        )[0]

    assert normal[seen, 0] == pytest.approx(cell(lambda x, y, r: 1 / (pi * r)), rel=1e-9)
    for i, j, f in (
        (0, 0, lambda x, y, r: (1 - nu) / r + nu * x * x / r**3),
        (1, 1, lambda x, y, r: (1 - nu) / r + nu * y * y / r**3),
        (0, 1, lambda x, y, r: nu * x * y / r**3),
    ):
        assert shear[i, seen, j, 0] == pytest.approx(cell(f) / (2 * pi * G), rel=1e-9)


def test_periodic_kernels_carry_one_wave_as_elasticity_says():
    nu, (ny, nx), aspect = 0.3, (8, 12), 1.5
    y, x = np.mgrid[0:ny, 0:nx]
    qx, qy = 2 * pi * 2 / nx, 2 * pi * 1 / (ny * aspect)
    wave = np.cos(qx * x + qy * aspect * y)
    q = np.hypot(qx, qy)
    normal = normal_kernel((ny, nx), aspect, periodic=True).apply(wave[None])[0]
    assert normal == pytest.approx(2 / q * wave, abs=1e-12)
    shear = shear_kernel((ny, nx), aspect, nu, periodic=True)
    G = (1 - nu) / 2
    along = shear.apply(np.array([qx * wave, qy * wave]) / q)
    across = shear.apply(np.array([-qy * wave, qx * wave]) / q)
    assert along == pytest.approx((1 - nu) / (G * q) * np.array([qx * wave, qy * wave]) / q, abs=1e-12)
    assert across == pytest.approx(1 / (G * q) * np.array([-qy * wave, qx * wave]) / q, abs=1e-12)


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("shape", [(6, 8), (7, 5)])
def test_kernels_are_symmetric_and_positive(periodic, shape):
    for kernel in (
        normal_kernel(shape, 1.2, periodic=periodic),
        shear_kernel(shape, 1.2, 0.4, periodic=periodic),
        shear_kernel(shape, 1.2, 0.4, periodic=periodic, vector=False),
    ):
        A = dense(kernel)
        assert pytest.approx(A.T, abs=1e-12) == A
        assert np.linalg.eigvalsh(A).min() > -1e-12
        assert kernel.own == pytest.approx(A[0, 0], rel=1e-12)


@settings(max_examples=25, deadline=None)
@given(maps, st.sampled_from([None, 0.5, 0.05]), st.booleans())
def test_agrees_with_a_dense_bounded_least_squares(h, hardness, periodic):
    # energy plus a spring on the mean is a bounded least-squares problem for scipy's active-set method; the mean
    # that it ends with is the load that we ask for
    A = dense(normal_kernel(h.shape, 1.0, periodic=periodic))
    n, stiff = h.size, 100.0
    factor = np.linalg.cholesky(A + stiff * np.full((n, n), 1 / n))
    goal = np.linalg.solve(factor, h.ravel() - h.max() + stiff * 0.03)
    reference = lsq_linear(factor.T, goal, (0, np.inf if hardness is None else hardness), method="bvls", tol=1e-14).x
    ours = solve_half_space(
        h, 1.0, E_star=1.0, pressure=float(reference.mean()), hardness=hardness, periodic=periodic, tol=1e-12
    )
    assert ours.traction.ravel() == pytest.approx(reference, abs=1e-4 * reference.max())


@settings(max_examples=40, deadline=None)
@given(maps, st.integers(0, 2**32 - 1), st.sampled_from([None, 0.2]))
def test_the_error_bound_holds_for_any_map(h, seed, hardness):
    pressure = 0.05
    best = solve_half_space(h, 1.0, E_star=1.0, pressure=pressure, hardness=hardness, tol=1e-11)
    limit = np.inf if hardness is None else hardness
    any_map = project(np.random.default_rng(seed).exponential(pressure, h.size), 0.0, limit, pressure * h.size)[0]
    A = dense(normal_kernel(h.shape, 1.0, periodic=True))

    def energy(x):
        return x @ A @ x / 2 - h.ravel() @ x

    excess = (energy(any_map) - energy(best.traction.ravel())) / (pressure * h.size * h.std())
    claimed = error_bound(h, 1.0, any_map.reshape(h.shape), E_star=1.0, hardness=hardness)
    assert -1e-10 <= excess <= claimed + 1e-10
    assert best.residual < 1e-11


def test_the_error_bound_sees_a_wrong_answer(rough):
    h = rough(64)
    right = solve_half_space(h, 1 / 64, E_star=1.0, pressure=0.01, tol=1e-8)
    assert error_bound(h, 1 / 64, right.traction, E_star=1.0) == pytest.approx(right.residual, rel=1e-3, abs=1e-14)
    assert error_bound(h, 1 / 64, np.roll(right.traction, 1, 0), E_star=1.0) > 1e-2
    assert error_bound(h, 1 / 64, np.full(h.shape, 0.01), E_star=1.0) > 1


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 2**32 - 1), st.floats(0.05, 0.95), st.sampled_from([0.5, 1.0, np.inf]))
def test_projection_is_the_nearest_point(seed, share, upper):
    random = np.random.default_rng(seed)
    v = random.standard_normal(40) * 10.0 ** random.integers(-6, 7)
    total = share * 40 * min(upper, 1.0)
    x, shift = project(v.copy(), 0.0, upper, total)
    assert x.sum() == pytest.approx(total, rel=1e-10, abs=1e-16 * np.abs(v).sum())
    # optimality: a shifted copy of v, cut to the bounds
    assert x == pytest.approx(np.clip(v + shift, 0, upper), abs=1e-12)


@settings(max_examples=10, deadline=None)
@given(st.floats(1e-9, 1e3), st.floats(1e-3, 1e12), st.floats(-5, 5), st.integers(0, 63), st.integers(0, 63))
def test_units_place_and_height_of_the_map_do_not_matter(length, stress, lift, rows, columns):
    h = np.random.default_rng(5).standard_normal((64, 64))
    here = solve_half_space(h, 10.0, E_star=1.0, pressure=0.02, hardness=0.3, tol=1e-8)
    moved = np.roll(h + lift, (rows, columns), (0, 1)) * length
    there = solve_half_space(
        moved, 10.0 * length, E_star=stress, pressure=0.02 * stress, hardness=0.3 * stress, tol=1e-8
    )
    assert np.roll(here.traction, (rows, columns), (0, 1)) == pytest.approx(there.traction / stress, abs=1e-3 * 0.3)
    assert there.approach == pytest.approx(here.approach * length, rel=1e-5)
    assert there.area == pytest.approx(here.area, abs=2 / h.size)


def test_the_map_may_be_turned_and_its_cells_oblong():
    h = np.random.default_rng(2).standard_normal((40, 56))
    one = solve_half_space(h, (3.0, 5.0), E_star=1.0, pressure=0.05, tol=1e-9)
    two = solve_half_space(h.T, (5.0, 3.0), E_star=1.0, pressure=0.05, tol=1e-9)
    assert one.traction == pytest.approx(two.traction.T, abs=1e-4 * one.traction.max())
    assert one.tangent().k_n == pytest.approx(two.tangent().k_n, rel=1e-6)
    assert one.area_corrected == pytest.approx(two.area_corrected)


@pytest.mark.parametrize("hardness", [None, 0.05])
def test_contact_conditions_hold_at_every_point(rough, hardness):
    h = rough(256)
    contact = solve_half_space(h, 1 / 256, E_star=1.0, pressure=0.01, hardness=hardness, tol=1e-9)
    gap, small = contact.gap, 1e-3 * h.std()
    limit = np.inf if hardness is None else hardness
    assert contact.pressure == pytest.approx(0.01, rel=1e-12)
    assert contact.traction.min() == 0
    assert contact.traction.max() <= limit
    assert gap[contact.state == 0].min() > -small
    assert np.abs(gap[contact.state == 1]).max() < small
    if hardness is not None:
        assert gap[contact.state == 2].max() < small
        assert contact.saturated > 0.05
    displacement = normal_kernel(h.shape, 1.0, periodic=True).apply(contact.traction[None])[0] / 256
    assert contact.displacement == pytest.approx(displacement, abs=1e-12)


def test_coarse_maps_first_or_a_warm_start_lead_to_the_same_contact(rough, monkeypatch):
    h = rough(128)
    nested = solve_half_space(h, 1 / 128, E_star=1.0, pressure=0.01, tol=1e-10)
    warm = solve_half_space(
        h, 1 / 128, E_star=1.0, pressure=0.01, tol=1e-10, start=solve_half_space(h, 1 / 128, E_star=1.0, pressure=0.004)
    )
    monkeypatch.setattr(module, "COARSEST", 1000)
    cold = solve_half_space(h, 1 / 128, E_star=1.0, pressure=0.01, tol=1e-10)
    assert nested.traction == pytest.approx(cold.traction, abs=1e-4 * cold.traction.max())
    assert warm.traction == pytest.approx(cold.traction, abs=1e-4 * cold.traction.max())
    fewer = solve_half_space(*module.halved_map(h, (1 / 128, 1 / 128)), E_star=1.0, pressure=0.02)
    finer = solve_half_space(h, 1 / 128, E_star=1.0, pressure=0.01, tol=1e-10, start=fewer)
    assert finer.traction == pytest.approx(cold.traction, abs=1e-4 * cold.traction.max())


@pytest.mark.parametrize("hardness", [None, 0.02])
def test_displacement_in_place_of_pressure(rough, hardness):
    h = rough(64)
    pressed = solve_half_space(h, 1 / 64, E_star=1.0, pressure=0.004, hardness=hardness, tol=1e-9)
    moved = solve_half_space(h, 1 / 64, E_star=1.0, displacement=pressed.approach, hardness=hardness, tol=1e-9)
    assert moved.pressure == pytest.approx(0.004, rel=1e-5)
    assert moved.approach == pytest.approx(pressed.approach, rel=1e-8)
    assert solve_half_space(h, 1 / 64, E_star=1.0, displacement=0.0).area == 0


@pytest.mark.parametrize("kind", ["white noise", "steps", "one spike", "ridges"])
@pytest.mark.parametrize("hardness", [None, 0.0045])
def test_ugly_maps_converge(kind, hardness):
    random, n = np.random.default_rng(1), 96
    h = {
        "white noise": random.standard_normal((n, n)),
        "steps": np.round(random.standard_normal((n, n))),
        "one spike": np.where(np.arange(n * n) == 17, 50.0, 1e-3 * random.standard_normal(n * n)).reshape(n, n),
        "ridges": np.tile(random.standard_normal(n), (n, 1)),
    }[kind]
    for share in (1e-3, 0.1, 0.8):
        pressure = share * (0.5 if hardness is None else hardness)
        contact = solve_half_space(h, 1.0, E_star=1.0, pressure=pressure, hardness=hardness)
        assert contact.residual < 1e-6
        assert contact.pressure == pytest.approx(pressure, rel=1e-10)


def test_nothing_happens_without_load(rough):
    contact = solve_half_space(rough(32), 1 / 32, E_star=1.0, pressure=0.0)
    tangent = contact.tangent()
    assert (contact.area, contact.residual, contact.approach, contact.elastic_energy) == (0, 0, 0, 0)
    assert (tangent.k_n, tangent.k_t) == (0, 0)
    assert contact.gap == pytest.approx(contact.heights.max() - contact.heights)


def test_one_point_in_contact_stays_one_point(rough):
    # a warm start whose total is right already must not be lifted off zero by rounding
    h = rough(64)
    first = solve_half_space(h, 1 / 64, E_star=1.0, pressure=1e-7)
    assert np.count_nonzero(first.traction) == 1
    assert np.count_nonzero(solve_half_space(h, 1 / 64, E_star=1.0, pressure=1.3e-7, start=first).traction) == 1


@pytest.mark.parametrize("periodic", [True, False])
def test_the_area_is_corrected_by_the_sides_of_cells(periodic):
    # a ridge two rows wide along x and a lone pillar, far above the rest
    h = np.full((12, 16), -1.0)
    h[3:5] = h[9, 7] = 0.0
    contact = solve_half_space(h, (2.0, 3.0), E_star=1.0, pressure=1e-6, periodic=periodic)
    assert np.array_equal(contact.traction > 0, h == 0)
    ends = 0 if periodic else 2 * 2 * 3.0
    border = 2 * 16 * 2.0 + ends + 2 * (2.0 + 3.0)  # Yastrebov et al. 2017 take (pi - 1 + ln 2)/24 of it times a side
    excess = (np.pi - 1 + np.log(2)) / 24 * border / (h.size * 6.0) * np.sqrt(6.0)
    assert contact.area - contact.area_corrected == pytest.approx(excess)


def test_a_flat_map_carries_the_load_evenly():
    contact = solve_half_space(np.zeros((16, 16)), 1e-6, E_star=1e11, pressure=1e6)
    assert contact.area == 1
    assert contact.traction == pytest.approx(np.full((16, 16), 1e6))


def test_progress_reports_and_its_exception_stops_the_run(rough):
    steps = []
    contact = solve_half_space(rough(64), 1 / 64, E_star=1.0, pressure=0.01, progress=lambda s, r: steps.append((s, r)))
    assert [s for s, _ in steps] == list(range(contact.iterations + 1))
    assert steps[-1][1] < 1e-6 < steps[0][1]

    def cancel(step, residual):
        if step == 1:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        solve_half_space(rough(64), 1 / 64, E_star=1.0, pressure=0.01, progress=cancel)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"heights": np.full((8, 8), np.nan)}, "every point is missing"),
        ({"heights": np.where(np.eye(8) > 0, np.nan, 0.0)}, "8 of 64 points are NaN"),
        ({"heights": np.zeros(8)}, "give a map of rows and columns"),
        ({"spacing": 0.0}, "spacing = 0 m; it must be positive"),
        ({"spacing": np.array(1.0)}, "spacing = an object of type ndarray; give a number in m"),
        ({"spacing": (1.0, 1.0, 1.0)}, "give 2 numbers in m, or one for all"),
        ({"E_star": -1.0}, "E_star = -1 Pa; it must be positive"),
        ({"nu": 0.6}, "nu = 0.6; it must be above -1 and at most 0.5"),
        ({"hardness": 0.0}, "hardness = 0 Pa; it must be positive"),
        ({"tol": 0.0}, "tol = 0; it must be between 0 and 1"),
        ({"pressure": -1.0}, "pressure = -1 Pa; it must be 0 or more"),
        ({"pressure": np.nan}, "it must be 0 or more"),
        ({"pressure": 2.0, "hardness": 2.0}, "not below the hardness 2 Pa"),
        ({"pressure": None}, "either pressure or displacement"),
        ({"displacement": 1.0}, "either pressure or displacement"),
        ({"pressure": None, "displacement": -1.0}, "displacement = -1 m; it must be 0 or more"),
        ({"pressure": None, "displacement": 10.0}, "closes every gap"),
        ({"pressure": None, "displacement": 1e4, "hardness": 0.1, "periodic": False}, "more than the hardness"),
    ],
)
def test_bad_input_is_named_with_its_remedy(change, text):
    given = {
        "heights": np.random.default_rng(0).standard_normal((8, 8)),
        "spacing": 1.0,
        "E_star": 1.0,
        "pressure": 0.1,
    }
    given |= change
    with pytest.raises(InputError, match=text):
        solve_half_space(given.pop("heights"), given.pop("spacing"), **given)


@pytest.mark.parametrize(("points", "side"), [(64, 1.0), (16, 1.2)])
def test_a_start_on_more_points_or_from_a_map_of_another_size_is_refused(rough, points, side):
    start = solve_half_space(rough(points), side / points, E_star=1.0, pressure=0.01)
    with pytest.raises(InputError, match="start from a contact of the same map"):
        solve_half_space(rough(32), 1 / 32, E_star=1.0, pressure=0.01, start=start)


def test_certify_wants_pressure_on_the_same_map():
    with pytest.raises(InputError, match="give pressures above 0 on a map of shape"):
        error_bound(np.eye(4), 1.0, np.zeros((4, 4)), E_star=1.0)


def test_a_map_too_large_for_the_memory_is_refused_before_any_work(monkeypatch):
    monkeypatch.setenv("FAYING_MEMORY", "0.0001")
    with pytest.raises(InputError, match=r"64 x 64 points needs about .* solve it as periodic"):
        solve_half_space(np.zeros((64, 64)), 1.0, E_star=1.0, pressure=1.0, periodic=False)
    assert module.memory_needed((4096, 4096), periodic=True) < 4e9


def test_an_unreachable_tolerance_says_how_far_it_came(rough):
    with pytest.raises(NotConverged, match=r"residual .* above the tolerance 1\.0e-30"):
        solve_half_space(rough(32), 1 / 32, E_star=1.0, pressure=0.01, tol=1e-30)


def test_bounds_that_vary_from_cell_to_cell():
    # uniform drag on a patch with little friction at one half: that half slips in full, the other carries the rest
    kernel = shear_kernel((8, 8), 1.0, 0.0, periodic=True, vector=False)
    upper = np.where(np.arange(64) < 32, 0.1, 10.0)
    problem = Problem(kernel=kernel, load=np.zeros(64), lower=-upper, upper=upper, mean=1.0, scale=1.0)
    found = minimise(problem, tol=1e-10)
    assert found.x[:32] == pytest.approx(0.1)
    assert found.x.mean() == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("n", "pressure", "area"), [(512, 0.002, 0.0468), (512, 0.01, 0.2082), (1024, 0.002, 0.0444), (1024, 0.01, 0.2040)]
)
def test_real_area_of_the_reference_maps(rough, n, pressure, area):
    """Hurst exponent .8, wave numbers 4 to n/8, rms gradient .1; areas given to four digits, found by other codes."""
    assert solve_half_space(rough(n, 1), 1 / n, E_star=1.0, pressure=pressure).area == pytest.approx(area, abs=6e-5)


@pytest.mark.slow
def test_real_area_of_the_reference_map_under_the_greatest_load(rough):
    contact = solve_half_space(rough(1024, 1), 1 / 1024, E_star=1.0, pressure=0.02)
    assert contact.area == pytest.approx(0.3782, abs=6e-5)


@pytest.mark.slow
def test_steps_do_not_grow_with_the_map(rough):
    """From 512 to 2048 points a side, over a band of waves that grows with it."""
    steps = [solve_half_space(rough(n, 1), 1 / n, E_star=1.0, pressure=0.01).iterations for n in (512, 1024, 2048)]
    assert max(steps) <= min(steps) + 3
