"""Frequency response of a bar with structural loss against its closed form; residual, reciprocity, messages."""

import numpy as np
import pytest

import faying
from faying.fe.elasticity import assemble
from faying.fe.interface import join
from faying.fe.response import ForcedVibration, frequency_response
from faying.numerics.damped import damped_modes
from faying.numerics.modes import lowest_modes
from tests.helpers.boxes import stack

BAR = faying.Material(name="bar", E=200e9, nu=0.0, density=7800.0)
L, SIDE, ETA = 0.5, 0.02, 0.02
FREQUENCIES = np.linspace(200.0, 16000.0, 400)


@pytest.fixture(scope="module")
def bar():
    """A bar, cut in the middle and bonded by stiff springs: mesh, K, M, loss (none), modes and damped modes."""
    mesh = stack([L / 2, L / 2], [14, 14], width=SIDE, height=SIDE, sections=[(1, 1), (1, 1)])
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, BAR))
    joint = join(mesh, "p0.right", "p1.left")
    ones = np.ones(len(joint.weights))
    K = (K + joint.springs(1e17 * ones, 1e17 * ones)).tocsr()
    nothing = 0.0 * K
    modes = lowest_modes(K, M, 48, shift_frequency=20.0)
    return mesh, K, M, nothing, modes, damped_modes(modes, K, M, nothing, rigid=6, count=20)


def end_force(mesh, x):
    """An even traction of 1 N along x on the end of the bar: as a force, and as the mean motion it works on."""
    from tests.helpers.loads import face_load

    name = "p0.left" if x == 0 else "p1.right"
    place = np.array([x, SIDE / 2, SIDE / 2])
    return face_load(mesh.points, mesh.face(name), place, np.array([1.0, 0.0, 0.0]))


def respond(bar, forces, outputs, **changes):
    _, K, M, loss, modes, damped = bar
    given = {"frequencies": FREQUENCIES, "rigid": 6, "structural_loss": ETA} | changes
    names = ("rigid", "kind", "structural_loss", "parts")
    vibration = ForcedVibration(
        stiffness=K, mass=M, loss=loss, **{name: given.pop(name) for name in names if name in given}
    )
    return frequency_response(vibration, modes, damped, forces=forces, outputs=outputs, **given)


def test_driving_point_and_transfer_of_a_free_bar(bar):
    """u(x)/F = -cos(kx)/(E A k sin(kL)) seen from the driven end at x = L, with k = w/c and E (1 + i eta)."""
    mesh = bar[0]
    both = np.stack([end_force(mesh, 0.0), end_force(mesh, L)], axis=1)
    found = respond(bar, both, both)
    E = BAR.E * (1 + 1j * ETA)
    k = 2 * np.pi * FREQUENCIES * np.sqrt(BAR.density / E)
    driving = -np.cos(k * L) / (E * SIDE**2 * k * np.sin(k * L))
    transfer = -1 / (E * SIDE**2 * k * np.sin(k * L))
    size = np.abs(driving).max()
    assert np.abs(found.receptance[:, 1, 1] - driving).max() < 2e-3 * size
    assert found.receptance[:, 1, 1] == pytest.approx(driving, rel=0.01, abs=1e-3 * np.median(np.abs(driving)) * 10)
    assert np.abs(found.receptance[:, 0, 1] - transfer).max() < 2e-3 * size
    omega = 2 * np.pi * FREQUENCIES
    assert found.accelerance()[:, 1, 1] == pytest.approx(-(omega**2) * found.receptance[:, 1, 1])
    assert found.mobility()[:, 1, 1] == pytest.approx(1j * omega * found.receptance[:, 1, 1])


def test_reciprocity(bar):
    rng = np.random.default_rng(3)
    places = np.zeros((len(bar[0].points) * 3, 3))
    places[rng.choice(len(places), 3, replace=False), [0, 1, 2]] = 1.0
    found = respond(bar, places, places)
    assert found.receptance == pytest.approx(found.receptance.transpose(0, 2, 1), rel=1e-5, abs=1e-14)


def test_the_residual_tells_when_modes_are_missing(bar):
    """Beyond the last mode of the basis the answer is wrong, and the residual says so."""
    mesh = bar[0]
    push = end_force(mesh, L)[:, None]
    good = respond(bar, push, push, frequencies=np.linspace(200, 8000, 50))
    beyond = respond(bar, push, push, frequencies=np.linspace(200, 120e3, 50), checks=5)
    assert good.error.max() < 1e-2
    assert beyond.error.max() > 0.1
    assert len(good.checked) == len(good.error) == 5


@pytest.mark.parametrize("kind", ["hysteretic", "viscous"])
def test_a_lossy_joint_against_the_full_equations(kind):
    """Every unknown solved directly at a few frequencies."""
    from scipy.sparse.linalg import spsolve

    mesh = stack([0.2, 0.3], [4, 6], width=SIDE, height=SIDE, sections=[(1, 1), (1, 1)])
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, BAR))
    joint = join(mesh, "p0.right", "p1.left")
    ones = np.ones(len(joint.weights))
    loss = joint.springs(4e11 * ones, 2e11 * ones) if kind == "hysteretic" else joint.springs(2e7 * ones, 1e7 * ones)
    K = (K + joint.springs(2e12 * ones, 1e12 * ones)).tocsr()
    modes = lowest_modes(K, M, 40, shift_frequency=20.0)
    damped = damped_modes(modes, K, M, loss, rigid=6, count=20, kind=kind)
    push = np.zeros((K.shape[0], 1))
    push[[1, 5, 40], 0] = 1.0, -0.5, 0.7
    frequencies = np.array([50.0, 400.0, 1300.0, 3000.0])
    vibration = ForcedVibration(stiffness=K, mass=M, loss=loss, rigid=6, kind=kind)
    found = frequency_response(vibration, modes, damped, forces=push, outputs=push, frequencies=frequencies, checks=4)
    for i, f in enumerate(frequencies):
        w = 2 * np.pi * f
        u = spsolve((K + 1j * (w if kind == "viscous" else 1.0) * loss - w**2 * M).tocsc(), push[:, 0].astype(complex))
        assert found.receptance[i, 0, 0] == pytest.approx(push[:, 0] @ u, rel=1e-3)


@pytest.mark.parametrize("wrong", [[0.0, 10.0], [20.0, 10.0], [], [[10.0, 20.0]]])
def test_frequencies_must_rise_from_above_zero(bar, wrong):
    push = end_force(bar[0], L)[:, None]
    with pytest.raises(faying.InputError, match="must be positive and rise"):
        respond(bar, push, push, frequencies=np.array(wrong))


def test_structural_loss_is_that_of_the_parts_alone(bar):
    """Two halves on a joint: the width of the first axial resonance is the parts' share of its energy, times eta.

    That share is what the frequency gains when the modulus does: d ln f / d ln E is half of it.
    """
    mesh, _, M, nothing, _, _ = bar
    parts, _ = assemble(mesh, dict.fromkeys(mesh.parts, BAR))
    joint = join(mesh, "p0.right", "p1.left")
    ones = np.ones(len(joint.weights))
    soft = (parts + joint.springs(1e11 * ones, 1e14 * ones)).tocsr()
    modes = lowest_modes(soft, M, 30, shift_frequency=20.0)
    damped = damped_modes(modes, soft, M, nothing, rigid=6, count=12)
    axial = modes.frequencies[6 + np.argmax([np.sum(s[0::3] ** 2) / np.sum(s**2) for s in modes.shapes[:, 6:].T])]
    force = end_force(mesh, 0.0)[:, None]

    def width(span, **changes):
        lines = np.linspace(1 - span, 1 + span, 2001) * axial
        vibration = ForcedVibration(stiffness=soft, mass=M, loss=nothing, rigid=6, structural_loss=ETA, **changes)
        found = frequency_response(vibration, modes, damped, forces=force, outputs=force, frequencies=lines)
        power = np.abs(found.receptance[:, 0, 0]) ** 2
        high = lines[power > power.max() / 2]
        return (high[-1] - high[0]) / axial

    more = (parts * 1.01 + soft - parts).tocsr()
    raised = lowest_modes(more, M, 30, shift_frequency=20.0).frequencies
    share = 2 * np.log(raised[np.argmin(np.abs(raised - axial))] / axial) / np.log(1.01)
    assert share < 0.2
    assert width(0.05) == pytest.approx(ETA, rel=0.03)
    assert width(0.05 * share, parts=parts) == pytest.approx(ETA * share, rel=0.03)


@pytest.mark.parametrize("eta", [0.02, 0.8])
def test_the_residual_is_that_of_the_full_equations(bar, eta):
    """In the norm of K + s M, by a dense solution: the force left unanswered, as displacement, over the answer."""
    mesh, K, M, loss, modes, damped = bar
    push = end_force(mesh, L)[:, None]
    where = np.array([3.0, 4000.0, 70e3])  # rigid motion, resonance, beyond the basis
    every = np.eye(K.shape[0])
    vibration = ForcedVibration(stiffness=K, mass=M, loss=loss, rigid=6, structural_loss=eta)
    found = frequency_response(vibration, modes, damped, forces=push, outputs=every, frequencies=where, checks=3)
    norm = (K + modes.shift * M).toarray()
    for u, error, f in zip(found.receptance[:, :, 0], found.error, where, strict=True):
        w = 2 * np.pi * f
        miss = push[:, 0] - K @ u * (1 + 1j * eta) + w**2 * (M @ u)
        left = sum(part @ np.linalg.solve(norm, part) for part in (miss.real, miss.imag))
        assert error == pytest.approx(np.sqrt(left / abs(np.vdot(u, norm @ u))), rel=1e-3)


def test_a_free_body_far_below_its_first_mode_moves_as_a_whole(bar):
    """1/(-w^2 m) and nothing else at a thousandth of a hertz, where one digit in 1e16 of K would outweigh the mass."""
    mesh = bar[0]
    push = end_force(mesh, L)[:, None]
    found = respond(bar, push, push, frequencies=np.array([1e-3, 1e-2]), structural_loss=0.0)
    mass = BAR.density * L * SIDE**2
    rigid = -1 / ((2 * np.pi * found.frequencies) ** 2 * mass)
    assert found.receptance[:, 0, 0] == pytest.approx(rigid, rel=1e-6)
