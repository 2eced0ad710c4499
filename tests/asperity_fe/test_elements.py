"""The element, the stress return and the tangent, each against what must hold whatever the code."""

import numpy as np
import pytest
from asperity_fe.body import Body, CapState, Quads
from asperity_fe.mesh import cap_mesh
from asperity_fe.model import FarField, shared
from asperity_fe.plasticity import Flow, equivalent, return_map
from hypothesis import given, settings
from hypothesis import strategies as st

from faying.errors import InputError
from faying.materials import Material

STEEL = Material(name="steel", E=100e9, nu=0.3, yield_strength=355e6)


def skewed():
    grid = np.array([[x, y] for y in (0, 1, 2) for x in (0, 1, 2)], float)
    grid[4] += (0.2, -0.15)
    grid[5] += (0.1, 0.2)
    quads = np.array([[0, 1, 4, 3], [1, 2, 5, 4], [3, 4, 7, 6], [4, 5, 8, 7]])
    return grid, quads


def sphere(elements=6, R=1.0):
    mesh = cap_mesh(R=R, h_a=R, contact_radius=0.1 * R, elements=elements, domain=None)
    constrained = np.concatenate([2 * mesh.axis, 2 * mesh.base + 1])
    return mesh, {"mesh": mesh, "materials": [STEEL], "hardening": [0.02], "constrained": constrained}


def test_volume_of_a_hemisphere():
    """Chords lie inside the arc, and the coarse elements at the rim miss the most."""
    mesh, _ = sphere(12)
    volume = Quads(mesh.nodes[mesh.quads]).weight.sum()
    assert 0.997 * 2 / 3 * np.pi < volume < 2 / 3 * np.pi


def test_uniform_strains_are_exact_on_skewed_elements():
    nodes, quads = skewed()
    B = Quads(nodes[quads]).B
    for field, strain in (
        (np.stack([nodes[:, 0], 0 * nodes[:, 0]], -1), [1, 0, 1, 0]),  # in plane: radial stretch
        (np.stack([0 * nodes[:, 0], nodes[:, 1]], -1), [0, 1, 0, 0]),
        (np.stack([0 * nodes[:, 0], nodes[:, 0]], -1), [0, 0, 0, 1]),
    ):
        found = np.einsum("egij,ej->egi", B, field[quads].reshape(-1, 8))
        np.testing.assert_allclose(found, np.broadcast_to(strain, found.shape), atol=1e-13)


def test_every_point_of_an_element_sees_the_same_dilatation():
    nodes, quads = skewed()
    B = Quads(nodes[quads]).B
    dilatation = B[..., :3, :].sum(axis=-2)
    np.testing.assert_allclose(dilatation, np.broadcast_to(dilatation[:, :1], dilatation.shape), atol=1e-13)


def test_an_element_turned_inside_out_is_refused():
    nodes, quads = skewed()
    with pytest.raises(InputError, match="inside out"):
        _ = Quads(nodes[quads[:, ::-1]]).B


def flow(n, modulus=0.0):
    K, G = STEEL.E / (3 * 0.4), STEEL.G
    return Flow(bulk=np.full(n, K), shear=np.full(n, G), strength=np.full(n, 355e6), modulus=np.full(n, modulus))


strains = st.lists(st.floats(-0.02, 0.02), min_size=4, max_size=4)


@settings(max_examples=60, deadline=None)
@given(strain=strains, modulus=st.sampled_from([0.0, 2e9, 50e9]))
def test_stress_is_on_or_inside_the_yield_surface_and_is_the_slope_of_the_energy(strain, modulus):
    e = np.array([strain])
    zero = np.zeros((1, 4)), np.zeros(1)
    found = return_map(flow(1, modulus), e, *zero)
    assert equivalent(found.stress)[0] <= 355e6 + modulus * found.hardened[0] + 1.0
    h = 1e-7
    for i in range(4):
        up, down = e.copy(), e.copy()
        up[0, i] += h
        down[0, i] -= h
        high, low = (return_map(flow(1, modulus), v, *zero).energy[0] for v in (up, down))
        assert (high - low) / (2 * h) == pytest.approx(found.stress[0, i], rel=1e-5, abs=2e4)


@settings(max_examples=40, deadline=None)
@given(strain=strains)
def test_plastic_flow_keeps_volume_and_is_not_repeated(strain):
    found = return_map(flow(1), np.array([strain]), np.zeros((1, 4)), np.zeros(1))
    assert abs(found.plastic[0, :3].sum()) < 1e-15
    again = return_map(flow(1), np.array([strain]), found.plastic, found.hardened)
    np.testing.assert_allclose(again.stress, found.stress, rtol=1e-9, atol=1e-3)


def test_tension_test_has_the_tangent_modulus():
    """Uniaxial stress: after yield the slope of stress over strain is Et = E H/(E + H)."""
    Et = 0.1 * STEEL.E
    H = STEEL.E * Et / (STEEL.E - Et)
    axial, stress = np.array([0.004, 0.006]), []
    for value in axial:
        low, high = -value, 0.0  # lateral strain that leaves no lateral stress
        for _ in range(80):
            side = 0.5 * (low + high)
            found = return_map(flow(1, H), np.array([[side, value, side, 0.0]]), np.zeros((1, 4)), np.zeros(1))
            low, high = (low, side) if found.stress[0, 0] > 0 else (side, high)
        stress.append(found.stress[0, 1])
    assert (stress[1] - stress[0]) / 0.002 == pytest.approx(Et, rel=1e-6)
    assert stress[0] == pytest.approx(355e6 + Et * (0.004 - 355e6 / STEEL.E), rel=1e-6)


def test_tangent_is_the_derivative_of_the_forces():
    mesh, settings_ = sphere(4)
    body = Body(elements=np.arange(len(mesh.quads)), **settings_)
    random = np.random.default_rng(5)
    u = 5e-4 * random.standard_normal(body.size)
    state = CapState(plastic=body.virgin.plastic, hardened=body.virgin.hardened + 1e-4)
    balance = body.balance(u, state)
    assert balance.returned.yielding.mean() > 0.5
    matrix = body.tangent(balance.returned)
    v = random.standard_normal(body.size)
    h = 1e-9
    slope = (body.balance(u + h * v, state).force - body.balance(u - h * v, state).force) / (2 * h)
    np.testing.assert_allclose(matrix @ v, slope, rtol=0, atol=2e-4 * np.abs(slope).max())


def test_condensing_the_elastic_rest_changes_nothing():
    mesh, settings_ = sphere(5)
    everything = np.arange(len(mesh.quads))
    centre = mesh.nodes[mesh.quads].mean(axis=1)
    near = np.hypot(centre[:, 0], centre[:, 1] - 1) < 0.4
    whole = Body(elements=everything, **settings_)
    part, rest = (Body(elements=np.flatnonzero(m), **settings_) for m in (near, ~near))
    far = FarField(body=rest, border=shared(part, rest), solver="superlu")
    small = Body(elements=np.flatnonzero(near), far=far.spring, **settings_)
    from faying.numerics.solve import factorise

    load = np.zeros(whole.size)
    load[whole.touching[:3]] = -1e3
    full = factorise(whole.elastic, "superlu").solve(load)
    load = np.zeros(small.size)
    load[small.touching[:3]] = -1e3
    condensed = factorise(small.elastic, "superlu").solve(load)
    inside = small.unknown_of_dof >= 0
    scale = np.abs(full).max()
    np.testing.assert_allclose(
        condensed[small.unknown_of_dof[inside]], full[whole.unknown_of_dof[inside]], atol=1e-9 * scale
    )
    border = condensed[small.unknown_of_dof[far.border]]
    outside = rest.unknown_of_dof >= 0
    np.testing.assert_allclose(
        far.unknowns(border)[rest.unknown_of_dof[outside]], full[whole.unknown_of_dof[outside]], atol=1e-9 * scale
    )
