"""Conductance of a contact against closed forms of spots and against the sum of many."""

import numpy as np
import pytest

import faying
from faying.contact.conductance import contact_conductance
from faying.halfspace.solve import solve_half_space


def test_one_circular_spot():
    """A spot of radius a has k_n = 2 E* a (Johnson, eq. 3.41) and conducts 2 a K_h (Holm), K_h the harmonic mean."""
    a, E_star, K = 0.3e-3, 115e9, (50.0, 200.0)
    harmonic = 2 / (1 / K[0] + 1 / K[1])
    found = contact_conductance(2 * E_star * a, E_star=E_star, resistivities=(1 / K[0], 1 / K[1]))
    assert found == pytest.approx(2 * a * harmonic, rel=1e-14)


def test_one_spot_between_metals():
    """Holm: R = (rho_1 + rho_2)/(4 a)."""
    a, E_star, rho = 20e-6, 60e9, (1.7e-8, 2.8e-8)
    found = contact_conductance(2 * E_star * a, E_star=E_star, resistivities=rho)
    assert 1 / found == pytest.approx(sum(rho) / (4 * a), rel=1e-14)


def test_a_sphere_by_the_half_space_solution():
    """Its k_n, from maps of points, conducts what Hertz's circle of contact does, 2 a K_h."""
    R, E_star, K, n, cell = 10e-3, 100e9, 50.0, 96, 5e-6
    x = (np.arange(n) - (n - 1) / 2) * cell
    heights = -(x[:, None] ** 2 + x**2) / (2 * R)
    load = 4.0
    found = solve_half_space(heights, cell, E_star=E_star, pressure=load / (n * cell) ** 2, periodic=False, tol=1e-6)
    k_n = found.normal_stiffness(loading=False) * (n * cell) ** 2
    a = (3 * load * R / (4 * E_star)) ** (1 / 3)
    assert a > 12 * cell
    conducts = contact_conductance(k_n, E_star=E_star, resistivities=(1 / K, 1 / K))
    assert conducts == pytest.approx(2 * a * K, rel=0.02)


@pytest.mark.parametrize("changes", [{"E_star": 0.0}, {"resistivities": (0.0, 0.0)}, {"resistivities": (-1.0, 2.0)}])
def test_what_is_no_contact(changes):
    with pytest.raises(faying.InputError, match="positive modulus and positive resistivities"):
        contact_conductance(1.0, **({"E_star": 1e11, "resistivities": (0.02, 0.02)} | changes))
