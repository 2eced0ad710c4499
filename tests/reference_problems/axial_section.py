"""Compliance of two alike discs under an even pressure on their seats, by the section through their axis."""

from itertools import pairwise

import numpy as np
from skfem import Basis, BilinearForm, ElementQuad2, ElementVector, FacetBasis, LinearForm, MeshQuad, condense, solve
from skfem.helpers import ddot, sym_grad, trace


def rows(places, size):
    """Rows of nodes about `size` apart through the places."""
    parts = [np.linspace(a, b, 1 + round((b - a) / size)) for a, b in pairwise(places)]
    return np.unique(np.concatenate(parts))


def compliance(*, seat, hole, outer, length, k_n, E, nu, size):
    """Mean displacement of both seats towards each other over the force [m/N]; the joint in the middle has no tension.

    seat, hole, outer: diameters [m]; length: of both discs [m]; k_n: of the joint [Pa/m]; size: of the elements [m].
    """
    section = MeshQuad.init_tensor(rows((hole / 2, seat / 2, outer / 2), size), rows((0.0, length / 2), size))
    basis = Basis(section, ElementVector(ElementQuad2()))
    lame, shear = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))

    def body(u, v, w):
        radius = w.x[0]
        hoop_u, hoop_v = u[0] / radius, v[0] / radius
        volume = (trace(sym_grad(u)) + hoop_u) * (trace(sym_grad(v)) + hoop_v)
        strain = ddot(sym_grad(u), sym_grad(v)) + hoop_u * hoop_v
        return 2 * np.pi * radius * (lame * volume + 2 * shear * strain)

    def joint(u, v, w):
        return 2 * np.pi * w.x[0] * w["shut"] * 2 * k_n * u[1] * v[1]  # half of the joint: twice as stiff

    def unit(v, w):
        return -2 * np.pi * w.x[0] * v[1] / (np.pi / 4 * (seat**2 - hole**2))

    top = section.facets_satisfying(lambda x: (np.abs(x[1] - length / 2) < 1e-9) & (x[0] < seat / 2 + 1e-9))
    middle = section.facets_satisfying(lambda x: np.abs(x[1]) < 1e-9)
    above, below = FacetBasis(section, basis.elem, facets=top), FacetBasis(section, basis.elem, facets=middle)
    stiffness, load = BilinearForm(body).assemble(basis), LinearForm(unit).assemble(above)
    shut = np.ones(below.dx.shape)
    while True:
        springs = BilinearForm(joint).assemble(below, shut=shut)
        u = solve(*condense(stiffness + springs, load, D=np.array([], dtype=int)))
        pressed = (np.asarray(below.interpolate(u))[1] < 0).astype(float)
        if np.array_equal(pressed, shut):
            return 2 * float(load @ u)
        shut = pressed
