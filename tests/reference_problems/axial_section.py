"""Discs that a bolt or a screw clamps, by finite elements of the section through their axis."""

from itertools import pairwise

import numpy as np
from scipy.sparse import bmat, coo_array, diags_array
from skfem import Basis, BilinearForm, ElementQuad2, ElementVector, FacetBasis, LinearForm, MeshQuad, condense, solve
from skfem.helpers import ddot, sym_grad, trace


def rows(places, size):
    """Rows of nodes about `size` apart through the places."""
    parts = [np.linspace(a, b, 1 + round((b - a) / size)) for a, b in pairwise(places)]
    return np.unique(np.concatenate(parts))


def solid(basis, E, nu):
    """Stiffness of a body of revolution."""
    lame, shear = E * nu / ((1 + nu) * (1 - 2 * nu)), E / (2 * (1 + nu))

    def body(u, v, w):
        radius = w.x[0]
        hoop_u, hoop_v = u[0] / radius, v[0] / radius
        volume = (trace(sym_grad(u)) + hoop_u) * (trace(sym_grad(v)) + hoop_v)
        strain = ddot(sym_grad(u), sym_grad(v)) + hoop_u * hoop_v
        return 2 * np.pi * radius * (lame * volume + 2 * shear * strain)

    return BilinearForm(body).assemble(basis)


def compliance(*, seat, hole, outer, length, k_n, E, nu, size):
    """Mean displacement of both seats towards each other over the force [m/N]; the joint in the middle has no tension.

    seat, hole, outer: diameters [m]; length: of both discs [m]; k_n: of the joint [Pa/m]; size: of the elements [m].
    """
    section = MeshQuad.init_tensor(rows((hole / 2, seat / 2, outer / 2), size), rows((0.0, length / 2), size))
    basis = Basis(section, ElementVector(ElementQuad2()))

    def joint(u, v, w):
        return 2 * np.pi * w.x[0] * w["shut"] * 2 * k_n * u[1] * v[1]  # half of the joint: twice as stiff

    def unit(v, w):
        return -2 * np.pi * w.x[0] * v[1] / (np.pi / 4 * (seat**2 - hole**2))

    top = section.facets_satisfying(lambda x: (np.abs(x[1] - length / 2) < 1e-9) & (x[0] < seat / 2 + 1e-9))
    middle = section.facets_satisfying(lambda x: np.abs(x[1]) < 1e-9)
    above, below = FacetBasis(section, basis.elem, facets=top), FacetBasis(section, basis.elem, facets=middle)
    stiffness, load = solid(basis, E, nu), LinearForm(unit).assemble(above)
    shut = np.ones(below.dx.shape)
    while True:
        springs = BilinearForm(joint).assemble(below, shut=shut)
        u = solve(*condense(stiffness + springs, load, D=np.array([], dtype=int)))
        pressed = (np.asarray(below.interpolate(u))[1] < 0).astype(float)
        if np.array_equal(pressed, shut):
            return 2 * float(load @ u)
        shut = pressed


def traces(basis, facets):
    """Operators (points, unknowns) to the radial and axial motion at points on facets, their weights and radii."""
    side = FacetBasis(basis.mesh, basis.elem, facets=facets)
    radius = np.asarray(side.default_parameters()["x"])[0]
    order = np.argsort(radius.ravel())
    rows = np.arange(radius.size).reshape(radius.shape)
    out = []
    for axis in range(2):
        values = np.array([np.broadcast_to(np.asarray(shape[0])[axis], radius.shape) for shape in side.basis])
        columns = np.broadcast_to(side.element_dofs[:, :, None], values.shape)
        where = np.broadcast_to(rows, values.shape)
        whole = coo_array((values.ravel(), (where.ravel(), columns.ravel())), shape=(radius.size, basis.N))
        out.append(whole.tocsr()[order])
    return out, (2 * np.pi * radius * side.dx).ravel()[order], radius.ravel()[order]


def tapped(*, seat, hole, thread, outer, base, length, depth, engaged, k_n, k_t, parts, screw, preload, pull, size):
    """Compliance [m/N] between the seat and the thread, and the force [N] of the screw under a pull.

    A bracket, from hole to outer diameter [m] and of a length [m], lies on a base of another diameter and depth, which
    is held below. The screw presses the bracket evenly out to the seat's diameter, and pulls evenly at the wall of the
    thread's diameter over the engaged length. The joint has k_n and k_t [Pa/m] and no tension. parts: (E [Pa], nu) of
    bracket and base; screw: its compliance [m/N]; pull [N]: even on the bracket outside of the seat.
    """
    upper = MeshQuad.init_tensor(rows((hole / 2, seat / 2, outer / 2), size), rows((0.0, length), size))
    lower = MeshQuad.init_tensor(
        rows((thread / 2, hole / 2, seat / 2, outer / 2, base / 2), size), rows((-depth, -engaged, 0.0), size)
    )
    bases = [Basis(mesh, ElementVector(ElementQuad2())) for mesh in (upper, lower)]
    body = bmat([[solid(bases[0], *parts[0]), None], [None, solid(bases[1], *parts[1])]], format="csr")
    (above, weight, radius), (below, _, under) = (
        traces(
            one,
            one.mesh.facets_satisfying(
                lambda x: (np.abs(x[1]) < 1e-9) & (x[0] > hole / 2 - 1e-9) & (x[0] < outer / 2 + 1e-9)
            ),
        )
        for one in bases
    )
    assert np.allclose(radius, under, rtol=0, atol=1e-12)
    across, along = (bmat([[a, -b]], format="csr") for a, b in zip(above, below, strict=True))

    def even(number, axis, place, span):
        """Unit force on a side of a part, upwards."""
        mesh = bases[number].mesh
        there = mesh.facets_satisfying(
            lambda x: (np.abs(x[axis] - place) < 1e-9) & (x[1 - axis] > span[0] - 1e-9) & (x[1 - axis] < span[1] + 1e-9)
        )
        (_, motion), area, _ = traces(bases[number], there)
        row = motion.T @ area / area.sum()
        out = [np.zeros(one.N) for one in bases]
        out[number] = row
        return np.concatenate(out)

    clamp = even(1, 0, thread / 2, (-engaged, 0.0)) - even(0, 1, length, (hole / 2, seat / 2))
    lift = pull * even(0, 1, length, (seat / 2, outer / 2))
    held = bases[0].N + bases[1].get_dofs(lambda x: np.abs(x[1] + depth) < 1e-9).all()

    def pressed(load, shaft=0.0):
        """Motion under a load, with the screw as a spring or without, and the stiffness of what is shut."""
        shut = np.ones(len(weight), dtype=bool)
        while True:
            springs = weight * shut
            stiff = body + k_n * along.T @ diags_array(springs) @ along + k_t * across.T @ diags_array(springs) @ across
            u, v = (solve(*condense(stiff.tocsr(), one, D=held)) for one in (load, clamp))
            u = u - shaft * (clamp @ u) / (1 + shaft * (clamp @ v)) * v
            now = along @ u < 0
            if np.array_equal(now, shut):
                return u, float(clamp @ v), shut
            shut = now

    at_rest, between, shut = pressed(preload * clamp)
    stretched = 1 / screw
    loaded, *_ = pressed(preload * clamp + lift + stretched * (clamp @ at_rest) * clamp, stretched)
    return between, preload - stretched * float(clamp @ (loaded - at_rest)), shut.mean()
