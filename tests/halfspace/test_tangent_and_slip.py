"""Tangent stiffness and partial slip: against finite differences, Mindlin, and each other."""

from math import pi

import numpy as np
import pytest
from scipy.integrate import quad

from faying.errors import InputError, NotConverged
from faying.halfspace import solve_half_space
from faying.halfspace import tangent as module
from faying.halfspace.arrays import Arithmetic
from faying.halfspace.conjugate import CellSystem
from faying.halfspace.kernels import shear_kernel

N = 128


@pytest.mark.parametrize("pressure", [0.001, 0.005, 0.02])
def test_k_n_is_the_finite_difference_of_the_elastic_solution(rough, pressure):
    h = rough(N)
    here = solve_half_space(h, 1 / N, E_star=1.0, pressure=pressure)
    sides = [
        solve_half_space(h, 1 / N, E_star=1.0, pressure=pressure * (1 + e), start=here, tol=1e-11)
        for e in (-2e-4, 2e-4)
    ]
    difference = (sides[1].pressure - sides[0].pressure) / (sides[1].approach - sides[0].approach)
    assert here.tangent().k_n == pytest.approx(difference, rel=1e-3)


def test_loading_at_hardness_is_softer_than_unloading_and_each_is_its_own_finite_difference(rough):
    h, pressure, hardness = rough(N), 0.01, 0.05
    here = solve_half_space(h, 1 / N, E_star=1.0, pressure=pressure, hardness=hardness, tol=1e-9)
    tangent = here.tangent()
    more = solve_half_space(
        h, 1 / N, E_star=1.0, pressure=pressure * (1 + 1e-3), hardness=hardness, start=here, tol=1e-11
    )
    loading = (more.pressure - here.pressure) / (more.approach - here.approach)
    assert tangent.k_n_loading == pytest.approx(loading, rel=0.02)  # points reach hardness one by one
    assert tangent.k_n_unloading > 1.05 * tangent.k_n_loading
    # unloading: the map as it was flattened (heights lowered by the indentation) and without a hardness is elastic,
    # holds the same pressures, and gives the stiffness as its own difference
    flattened = h - np.maximum(-here.gap, 0)
    less = [solve_half_space(flattened, 1 / N, E_star=1.0, pressure=pressure * (1 - e), tol=1e-11) for e in (0, 1e-3)]
    assert less[0].traction == pytest.approx(here.traction, abs=1e-3 * hardness)
    unloading = (less[0].pressure - less[1].pressure) / (less[0].approach - less[1].approach)
    assert tangent.k_n_unloading == pytest.approx(unloading, rel=2e-3)


def test_k_n_times_rms_height_over_pressure_stays_near_two_to_three(rough):
    # Persson 2007, doi:10.1103/PhysRevLett.99.125502: k_n is p over a length near .4 to .5 rms heights
    h = rough(512, 1)
    start = None
    for pressure in np.geomspace(2e-4, 1e-2, 5):  # real area from .5 to 21 %
        start = solve_half_space(h, 1 / 512, E_star=1.0, pressure=pressure, start=start)
        assert 2 < start.tangent().k_n * h.std() / pressure < 3


@pytest.mark.parametrize("nu", [0.0, 0.3, 0.49])
def test_shear_without_slip_over_normal_stiffness(rough, nu):
    tangent = solve_half_space(rough(512, 1), 1 / 512, E_star=1.0, pressure=1e-4, nu=nu).tangent()
    mindlin = 2 * (1 - nu) / (2 - nu)
    ratio = tangent.k_t / tangent.k_n
    # the normal traction scaled and laid along x would give Mindlin's ratio: the true one is stiffer, and little
    assert mindlin * (1 - 1e-6) < ratio < mindlin * (1 + 1e-6 + 0.02 * nu)
    if nu == 0:
        assert ratio == pytest.approx(1, rel=1e-6)


def test_stiffness_does_not_depend_on_units(rough):
    h = rough(64)
    one = solve_half_space(h, 1 / 64, E_star=1.0, pressure=0.01, hardness=0.1).tangent()
    two = solve_half_space(h * 1e-3, 1e-3 / 64, E_star=2e11, pressure=2e9, hardness=2e10).tangent()
    for name in ("k_n_loading", "k_n_unloading", "k_t"):
        assert getattr(two, name) == pytest.approx(getattr(one, name) * 2e14, rel=1e-4)


def sphere(n=128, nu=0.3, radius=10.0, a=0.3):
    y, x = (np.mgrid[0:n, 0:n] - (n - 1) / 2) / n
    return solve_half_space(
        -(x**2 + y**2) / (2 * radius),
        1 / n,
        E_star=1.0,
        pressure=4 * a**3 / (3 * radius),
        nu=nu,
        periodic=False,
        tol=1e-8,
    )


@pytest.mark.parametrize("nu", [0.0, 0.3])
@pytest.mark.parametrize("X", [0.2, 0.6, 0.95])
def test_partial_slip_of_hertz_contact_is_that_of_cattaneo_and_mindlin(nu, X):
    # Johnson 1985, eqs. 7.39 to 7.42; the loss by Masing's rule over the curve of first loading
    a, mu = 0.3, 0.25
    contact = sphere(nu=nu)
    slip = contact.slip(X, mu)
    force = contact.pressure
    G_star = (1 - nu) / 2 / (2 - nu)

    def moved(T):
        return 3 * mu * force / (16 * G_star * a) * (1 - (1 - T / (mu * force)) ** (2 / 3))

    T = X * mu * force
    under = T * moved(T) - quad(moved, 0, T, epsabs=0)[0]
    loss = 8 * under - 4 * T * moved(T)
    assert slip.tangential_pressure == pytest.approx(T, rel=1e-9)
    assert slip.displacement == pytest.approx(moved(T), rel=2e-3)
    assert 1 - slip.sliding == pytest.approx((1 - X) ** (2 / 3), abs=0.015)  # a count of cells
    assert slip.loss_per_cycle == pytest.approx(loss, rel=0.01)
    assert slip.loss_factor == pytest.approx(loss / (pi * T * moved(T)), rel=0.01)
    assert slip.k_t == pytest.approx(8 * G_star * a * (1 - X) ** (1 / 3), rel=0.02)
    bound = mu * contact.traction
    assert np.all(np.abs(slip.traction) <= bound * (1 + 1e-12))


def test_slip_grows_with_the_load_on_a_rough_contact(rough):
    contact = solve_half_space(rough(N), 1 / N, E_star=1.0, pressure=0.005, hardness=0.1)
    slips = [contact.slip(X, 0.3) for X in (0.0, 0.1, 0.4, 0.7, 0.95)]
    for quantity in ("displacement", "sliding", "loss_per_cycle", "loss_factor"):
        assert np.all(np.diff([getattr(s, quantity) for s in slips]) > 0)
    assert np.all(np.diff([s.k_t for s in slips[1:]]) < 0)
    assert slips[0].loss_factor == 0
    # friction scales out: the same share of mu F, twice the friction, twice the traction
    twice = contact.slip(0.4, 0.6)
    assert twice.traction == pytest.approx(2 * slips[2].traction, abs=2e-3 * twice.traction.max())
    assert twice.loss_per_cycle == pytest.approx(4 * slips[2].loss_per_cycle, rel=1e-3)


@pytest.mark.parametrize(
    ("X", "mu", "text"),
    [(1.0, 0.3, "slips everywhere"), (-0.1, 0.3, "0 or more"), (0.5, 0.0, "friction = 0; it must be positive")],
)
def test_impossible_slip_is_refused(X, mu, text):
    with pytest.raises(InputError, match=text):
        sphere(32).slip(X, mu)


@pytest.mark.parametrize("share", [0.03, 0.3, 0.95])
def test_what_is_said_of_the_error_of_a_stiffness_is_near_it(rough, share, monkeypatch):
    h = rough(96)
    kernel, touching = (
        shear_kernel(h.shape, 1.0, 0.3, periodic=True, arithmetic=Arithmetic()),
        h > np.quantile(h, 1 - share),
    )
    monkeypatch.setattr(module, "ENOUGH", 1e-13)
    exact = module.stiffness_on(kernel, touching)
    said = []
    energy = CellSystem.energy
    monkeypatch.setattr(CellSystem, "energy", lambda *a: said.append(energy(*a)) or said[-1])
    monkeypatch.setattr(module, "ENOUGH", 1.0)
    once = module.stiffness_on(kernel, touching)
    assert len(said) == 2
    error = (exact - once).trace() / exact.trace()
    worst = max(said) * once.max() / touching.size
    assert worst / 3 < error < module.MARGIN * worst
    assert error < 1e-3
    monkeypatch.setattr(module, "ENOUGH", 1e-6)
    assert module.stiffness_on(kernel, touching) == pytest.approx(exact, rel=1e-6, abs=1e-6 * exact.max())


def test_a_stiffness_that_does_not_settle_says_so(rough, monkeypatch):
    contact = solve_half_space(rough(32), 1 / 32, E_star=1.0, pressure=0.01)
    monkeypatch.setattr(module, "PASSES", 1)
    monkeypatch.setattr(module, "ENOUGH", 1e-15)
    with pytest.raises(NotConverged, match="the compliance may still be wrong by"):
        contact.tangent()
