"""The numerical contact against the closed forms of contact mechanics; every error must fall as the map gets finer."""

from math import asin, pi, sqrt

import numpy as np
import pytest

from faying.halfspace import solve_half_space


def grid(n, side=1.0):
    y, x = (np.mgrid[0:n, 0:n] - (n - 1) / 2) * (side / n)
    return x, y


def sphere(n, *, radius=10.0, a=0.3, E_star=1.0, nu=0.3, **options):
    """Hertz's problem with contact radius a on a unit square."""
    x, y = grid(n)
    force = 4 * E_star * a**3 / (3 * radius)
    return solve_half_space(
        -(x**2 + y**2) / (2 * radius), 1 / n, E_star=E_star, pressure=force, periodic=False, nu=nu, **options
    )


def rate(errors):
    """Order of convergence between the coarsest and the finest of maps that double."""
    return np.log2(errors[0] / errors[-1]) / (len(errors) - 1)


def test_hertz_errors_fall_at_first_order_or_better():
    a, radius = 0.3, 10.0
    errors = {"pressure": [], "approach": [], "k_n": [], "area": []}
    for n in (32, 64, 128, 256):
        contact = sphere(n, tol=1e-9)
        x, y = grid(n)
        exact = 2 * a / (pi * radius) * np.sqrt(np.maximum(0, 1 - (x**2 + y**2) / a**2))
        errors["pressure"].append(np.abs(contact.traction - exact).mean() / exact.mean())
        errors["approach"].append(abs(contact.approach / (a**2 / radius) - 1))
        errors["k_n"].append(abs(contact.tangent().k_n / (2 * a) - 1))
        errors["area"].append(abs(contact.area / (pi * a**2) - 1))
    assert rate(errors["pressure"]) > 1.2  # the square root at the rim allows 3/2
    assert rate(errors["approach"]) > 0.9  # the highest point lies half a cell off the middle
    assert rate(errors["k_n"]) > 0.9
    assert rate(errors["area"]) > 0.7  # a count of cells: noisy
    assert errors["pressure"][-1] < 3e-3
    assert errors["approach"][-1] < 1e-3
    assert errors["k_n"][-1] < 1e-3
    assert errors["area"][-1] < 1e-2


def test_the_corrected_area_is_nearer_than_the_count_on_average():
    a = np.linspace(0.2, 0.4, 9)
    contacts = [sphere(64, a=value) for value in a]
    counted = np.array([c.area for c in contacts]) / (pi * a**2) - 1
    corrected = np.array([c.area_corrected for c in contacts]) / (pi * a**2) - 1
    assert counted.mean() > 0.005  # cells that are touched in part count in full
    assert abs(corrected.mean()) < counted.mean() / 2


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
def test_hertz_contact_without_slip_has_mindlins_ratio_of_stiffness(nu):
    tangent = sphere(128, nu=nu).tangent()
    assert tangent.k_t / tangent.k_n == pytest.approx(2 * (1 - nu) / (2 - nu), rel=1e-3)
    assert tangent.k_tensor[0, 0] == pytest.approx(tangent.k_tensor[1, 1], rel=1e-6)
    assert abs(tangent.k_tensor[0, 1]) < 1e-6 * tangent.k_t


def test_flat_punch_stiffness_and_pressure():
    a, errors = 0.3, []
    for n in (64, 128, 256):
        x, y = grid(n)
        r = np.hypot(x, y)
        contact = solve_half_space(np.where(r <= a, 0.0, -1.0), 1 / n, E_star=2.0, pressure=1e-3, periodic=False)
        # the counted cells make a disc of this radius
        radius = sqrt(contact.area / pi)
        errors.append(abs(contact.tangent().k_n / (2 * 2.0 * radius) - 1))
        middle = r < 0.7 * a
        exact = 1e-3 / (2 * pi * radius * np.sqrt(radius**2 - r[middle] ** 2))
        assert contact.traction[middle] == pytest.approx(exact, rel=0.06 * 64 / n + 0.005)
    assert rate(errors) > 0.9
    assert errors[-1] < 0.006


@pytest.mark.parametrize("share", [0.1, 0.5, 0.9])
def test_one_wave_flattens_as_westergaard_found(share):
    # Johnson 1985, 13.2: mean pressure over that of full contact pi E* Delta/lambda is sin^2(pi a/lambda)
    amplitude, errors = 0.01, []
    for n in (128, 512, 2048):
        x = (np.arange(n) + 0.5) / n
        h = np.tile(amplitude * np.cos(2 * pi * x), (4, 1))
        contact = solve_half_space(h, 1 / n, E_star=1.0, pressure=share * pi * amplitude, tol=1e-10)
        a = asin(sqrt(share)) / pi
        xi = np.where(x > 0.5, x - 1, x)
        inside = np.maximum(np.sin(pi * a) ** 2 - np.sin(pi * xi) ** 2, 0)
        exact = 2 * pi * amplitude * np.cos(pi * xi) * np.sqrt(inside)
        assert contact.area == pytest.approx(2 * a, abs=2.5 / n)
        errors.append(np.abs(contact.traction[0] - exact).mean() / exact.mean())
    assert rate(errors) > 2  # maps are four times finer each time; where the rim falls in its cell adds scatter
    assert errors[-1] < 1e-3


def test_full_contact_carries_the_pressure_of_linear_elasticity():
    # beyond pi E* Delta/lambda the wave is flat: p = mean + pi E* Delta/lambda cos
    n, amplitude = 64, 0.01
    x = np.arange(n) / n
    h = np.tile(amplitude * np.cos(2 * pi * x), (n, 1))
    contact = solve_half_space(h, 1 / n, E_star=1.0, pressure=1.5 * pi * amplitude, tol=1e-10)
    assert contact.area == 1
    assert contact.traction[0] == pytest.approx(pi * amplitude * (1.5 + np.cos(2 * pi * x)), rel=1e-6)
    assert contact.tangent().k_n == np.inf
    assert np.maximum(contact.gap, 0).mean() == pytest.approx(0, abs=1e-9)


def test_at_small_hardness_the_contact_is_the_bearing_area(rough):
    h = rough(128)
    contact = solve_half_space(h, 1 / 128, E_star=1.0, pressure=2e-7, hardness=1e-6)
    assert contact.saturated == pytest.approx(0.2, abs=2e-4)
    assert 0.2 <= contact.area_corrected <= contact.area
    # nothing bends: the highest fifth of the points carries the load
    high = h >= np.quantile(h, 0.8)
    assert np.count_nonzero(high ^ contact.at_hardness) < 1e-3 * h.size


def test_at_great_hardness_the_contact_is_elastic(rough):
    h = rough(128)
    elastic = solve_half_space(h, 1 / 128, E_star=1.0, pressure=0.01, tol=1e-9)
    limited = solve_half_space(h, 1 / 128, E_star=1.0, pressure=0.01, hardness=10.0, tol=1e-9)
    assert limited.saturated == 0
    assert limited.traction == pytest.approx(elastic.traction, abs=1e-4 * elastic.traction.max())


def test_work_of_the_load_is_strain_energy_plus_plastic_work(rough):
    # over first loading the load's work, integral of p d(approach), goes into the two
    h = rough(64)
    pressures = np.geomspace(1e-6, 2e-2, 120)
    contacts = [solve_half_space(h, 1 / 64, E_star=1.0, pressure=p, hardness=0.06, tol=1e-9) for p in pressures]
    approach = np.array([c.approach for c in contacts])
    work = np.trapezoid(pressures, approach)
    assert contacts[-1].saturated > 0.02
    assert contacts[-1].plastic_work > 0.05 * contacts[-1].elastic_energy
    assert contacts[-1].elastic_energy + contacts[-1].plastic_work == pytest.approx(work, rel=3e-3)


def test_a_free_patch_and_a_padded_periodic_one_agree():
    # a lone bump in a wide periodic map is nearly alone: images act at distance 1 on a contact of radius .04
    n = 128
    x, y = grid(n)
    h = -(x**2 + y**2) / 2
    free = solve_half_space(h, 1 / n, E_star=1.0, pressure=1e-4, periodic=False)
    periodic = solve_half_space(h, 1 / n, E_star=1.0, pressure=1e-4)
    assert periodic.area == pytest.approx(free.area, rel=0.05)
    assert periodic.traction.max() == pytest.approx(free.traction.max(), rel=0.02)
