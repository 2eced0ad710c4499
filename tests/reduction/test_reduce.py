"""The small bases against full solutions of the same variants."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.bolt.bolt import Bolt
from faying.contact.models.persson import Persson
from faying.fe.interface import join
from faying.files import load_arrays, write_arrays
from faying.joint.attachments import Support
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.structure import Structure
from faying.numerics.damped import damped_modes
from faying.numerics.modes import lowest_modes
from faying.reduction.part_shares import PartShares
from faying.reduction.reduce import STATIC_SHARE, Reduction
from faying.reduction.reduced import BLOCK, SLIGHT, ReducedEquilibrium, _complex_modes
from tests.helpers.boxes import stack

STEEL = faying.CATALOGUE["45 steel"]
COUNT = 6
TOLERANCE = 1e-7


def law(D=2.39, G=1.5e-10):
    return JointLaw(model=faying.JK(D=D, G=G, pair=faying.ContactPair(STEEL, STEEL), scan_area=16e-6))


def beam(**changes):
    mesh = stack([0.06, 0.05], [5, 4], width=0.02, height=0.015)
    joint = FittedJoint(name="j", faces=("p0.right", "p1.left"), interface=join(mesh, "p0.right", "p1.left"), law=law())
    bolt = Bolt(name="b", faces=("p0.left", "p1.right"), at=(0.0, 0.009, 0.0075), seat=(0.0, 0.012))
    return Structure(mesh=mesh, materials=dict.fromkeys(mesh.parts, STEEL), joints=(joint,), bolts=(bolt,), **changes)


def full(structure, law, force):
    joint = replace(structure.joints[0], law=law)
    structure = replace(structure, joints=(joint,))
    found = structure.assembly().solve(structure.loads @ [force])
    K, loss = structure.coupled(structure.springs(found.pressures))
    M, still = structure.dynamic_matrices[1], structure.rigid.shape[1]
    modes = lowest_modes(K, M, still + COUNT + 15, shift_frequency=structure.shift_frequency)
    return found, damped_modes(modes, K, M, loss, rigid=still, count=COUNT, tolerance=1e-9)


CORNERS = [(D, G, F) for D in (2.3, 2.5) for G in (3e-11, 3e-10) for F in (300.0, 3000.0)]


@pytest.fixture(scope="module", params=["free", "clamped"])
def trained(request):
    structure = beam(supports=(Support(face="p0.left"),) if request.param == "clamped" else ())
    reduction = Reduction.of(structure, [law()], np.array([1000.0]), count=COUNT)
    for D, G, F in CORNERS:
        reduction.train([law(D, G)], np.array([F]), [None], tolerance=TOLERANCE)
    reduction.compress(TOLERANCE)
    return structure, reduction


# inside the corners trained on, and outside them
@pytest.mark.parametrize(("D", "G", "F"), [(2.41, 1e-10, 900.0), (2.33, 5e-11, 2100.0), (2.55, 4e-10, 200.0)])
def test_frequencies_and_damping_are_those_of_the_full_solution(trained, D, G, F):
    structure, reduction = trained
    found, damped = full(structure, law(D, G), F)
    variant = reduction.model.evaluate([law(D, G)], np.array([F]), [None])
    assert variant.frequencies == pytest.approx(damped.frequencies, rel=1e-5)
    assert variant.loss_factors == pytest.approx(damped.loss_factors, rel=1e-2)
    pressed = found.pressures[0]
    assert variant.preload.pressures[0] == pytest.approx(pressed, abs=0.02 * pressed.max())


def test_the_estimate_covers_the_error(trained):
    structure, reduction = trained
    for D, G, F in [(2.41, 1e-10, 900.0), (2.55, 4e-10, 200.0)]:
        _, damped = full(structure, law(D, G), F)
        variant = reduction.model.evaluate([law(D, G)], np.array([F]), [None])
        error = np.abs(variant.frequencies / damped.frequencies - 1)
        assert error.max() < variant.estimate.max() + 5e-7  # the share of the force balance


@pytest.fixture(scope="module")
def compressed():
    """Bases before and after they were compressed to what 96 variants between the corners need."""
    structure = beam()
    reduction = Reduction.of(structure, [law()], np.array([1000.0]), count=COUNT)
    for D, G, F in CORNERS:
        reduction.train([law(D, G)], np.array([F]), [None], tolerance=LOOSE)
    before = reduction.model
    rng = np.random.default_rng(4)
    for _ in range(96):
        one = [law(rng.uniform(2.3, 2.5), 10 ** rng.uniform(-10.5, -9.5))]
        reduction.learn(one, reduction.model.evaluate(one, np.array([rng.uniform(300.0, 3000.0)]), [None]))
    reduction.compress(LOOSE)
    return reduction, before


LOOSE = 1e-4


@pytest.mark.parametrize(
    ("D", "G", "F"),
    [*CORNERS, (2.41, 1e-10, 900.0), (2.33, 5e-11, 2100.0), (2.48, 2e-10, 400.0), (2.36, 2.5e-10, 1500.0)],
)
def test_compressed_bases_serve_what_they_were_trained_on_and_what_lies_between(compressed, D, G, F):
    """By the residual in the full equations: variants trained on stay right, others become hardly worse."""
    reduction, before = compressed
    after = reduction.model
    assert len(after.static_stiffness) < len(before.static_stiffness)
    assert len(after.dynamic_mass) < len(before.dynamic_mass)
    laws, forces = [law(D, G)], np.array([F])
    found = after.equilibrium(laws, forces, [None])
    error, _ = reduction.static_error(laws, forces, [None], found)
    assert error < 2 * STATIC_SHARE * LOOSE
    assert reduction.frequency_error(laws, forces, [None], found, COUNT) < 3 * LOOSE
    wide, narrow = (model.evaluate(laws, forces, [None]).frequencies for model in (before, after))
    assert narrow == pytest.approx(wide, rel=LOOSE)


def test_few_variants_leave_the_basis_for_equilibrium_as_it_is():
    """Less than three for two vectors that they need: others need more."""
    from faying.reduction.reduce import for_states

    rng = np.random.default_rng(5)
    states = rng.standard_normal((12, 5)) @ rng.standard_normal((5, 40))
    assert for_states(states, 1e-6, 0) is None
    assert for_states(states, 1e-6, 7) is None
    kept = for_states(states, 1e-6, 40)
    assert kept.shape == (12, 5)
    assert kept @ (kept.T @ states) == pytest.approx(states, abs=1e-9)


def test_enrichment_lowers_the_estimates():
    """From stiff joints to soft ones: at the variant that is trained on, and at its neighbours."""
    reduction = Reduction.of(beam(), [law()], np.array([1000.0]), count=COUNT)
    for D, G, F in [(2.5, 3e-11, 3000.0), (2.5, 3e-10, 3000.0), (2.39, 1.5e-10, 1000.0)]:
        reduction.train([law(D, G)], np.array([F]), [None], tolerance=TOLERANCE)
    reduction.compress(TOLERANCE)
    soft = [(2.3, 3e-10), (2.3, 1e-10), (2.25, 2e-10)]

    def estimates():
        return np.array(
            [reduction.model.evaluate([law(*one)], np.array([100.0]), [None]).estimate.max() for one in soft]
        )

    before = estimates()
    reduction.train([law(*soft[0])], np.array([100.0]), [None], tolerance=TOLERANCE)
    reduction.compress(TOLERANCE)
    assert np.all(before > 1e-3)
    assert np.all(estimates() < 1e-2 * before)


def test_a_variant_trained_on_is_solved_and_adds_nothing(trained):
    _, reduction = trained
    D, G, F = CORNERS[3]
    found = reduction.model.equilibrium([law(D, G)], np.array([F]), [None])
    error = reduction.modal_error([law(D, G)], found.pressures)
    assert error.max() < 3 * TOLERANCE


def test_the_reduced_model_travels(trained):
    import pickle

    _, reduction = trained
    laws, force = [law(2.4, 1e-10)], np.array([800.0])
    there = pickle.loads(pickle.dumps(reduction.model)).evaluate(laws, force, [None])
    assert there.frequencies == pytest.approx(reduction.model.evaluate(laws, force, [None]).frequencies, rel=1e-9)


def test_bases_that_were_kept_grow_on_as_if_they_had_not_been(tmp_path):
    structure, kept = beam(), tmp_path / "bases.npz"
    once = Reduction.of(structure, [law()], np.array([1000.0]), count=COUNT)
    once.train([law(2.3, 3e-11)], np.array([300.0]), [None], tolerance=TOLERANCE)
    once.compress(TOLERANCE)
    write_arrays(kept, once.arrays())
    again = Reduction.resumed(structure, load_arrays(kept))
    other = [law(2.5, 3e-10)], np.array([3000.0]), [None]
    before = once.model.evaluate(*other)
    for one in (once, again):
        assert one.model.evaluate(*other).frequencies == pytest.approx(before.frequencies, rel=1e-10)
        one.train(*other, tolerance=TOLERANCE)
        one.compress(TOLERANCE)
    assert again.trained == once.trained == 2
    grown, expected = again.model.evaluate(*other), once.model.evaluate(*other)
    assert grown.frequencies == pytest.approx(expected.frequencies, rel=1e-9)
    assert grown.loss_factors == pytest.approx(expected.loss_factors, rel=1e-6)
    assert grown.estimate == pytest.approx(expected.estimate, rel=0.1, abs=1e-9)


def test_springs_of_one_pressure_carry_the_load(trained):
    """The start of an equilibrium: springs that are linear about one pressure balance the bolt, and carry its mean."""
    from faying.reduction.reduced import evenly_pressed

    model = trained[1].model
    (motion,), one, load = model._motions(model.static_relative), law(), model.static_loads @ [900.0]
    u = evenly_pressed(model.matrices[0], [(motion, one)], load)
    force = load - model.matrices[0] @ u
    # what is left is the force of the springs, which is that of one pressure and stiffness at all points
    wanted, moved = motion.relative.T, (motion.relative @ u).reshape(-1, 3)
    exact = model.equilibrium([one], np.array([900.0]), [None])
    mean = float(motion.weights @ exact.pressures[0] / motion.weights.sum())
    k_n, k_t = (float(k) for k in one.stiffness(np.asarray(mean)))
    p = mean - k_n * (moved[:, 0] + motion.gap + float(one.approach(mean)))
    local = np.column_stack([-p, k_t * moved[:, 1], k_t * moved[:, 2]]) * motion.weights[:, None]
    assert np.linalg.norm(force - wanted @ local.ravel()) < 0.2 * np.linalg.norm(load)


def test_wrong_number_of_forces(trained):
    with pytest.raises(faying.InputError, match="2 bolt forces for 1 bolts"):
        trained[1].model.evaluate([law()], np.array([1.0, 2.0]), [None])


def test_modes_on_both_sides_of_the_border_may_be_as_close_as_they_like():
    """First order has no bound there: one of the small problem's modes lay below all others, with f^2 below 0."""
    rng, count = np.random.default_rng(0), 3
    for apart in (1e-1, 1e-3, 1e-6, 1e-9, 0.0):
        real = 1e8 * np.arange(1, 61.0)
        last = count + BLOCK - 1
        real[last + 1] = real[last] * (1 + apart)
        root = rng.normal(size=(60, 60)) * np.sqrt(1e-4 * real[:, None])
        values, _ = _complex_modes(real, root @ root.T, count, SLIGHT)
        whole = np.linalg.eigvals(np.diag(real) + 1j * root @ root.T)
        assert values == pytest.approx(whole[np.argsort(whole.real)][:count], rel=2 * SLIGHT)


def test_complex_modes_of_the_small_problem_are_those_of_all_its_vectors(trained):
    """Higher modes join the lowest by first order; against the eigenvalues of the whole small problem."""
    from scipy.linalg import eig, eigh

    model = trained[1].model
    found = model.equilibrium([law(2.4, 1e-10)], np.array([800.0]), [None])
    springs = model.springs([law(2.4, 1e-10)], found.pressures)
    values, vectors, _ = model.modes(springs)
    joint, loss = sum(s.stiffness() for s in springs), sum(s.loss() for s in springs)
    K = model.dynamic_stiffness + joint + 1j * loss
    exact = eig(K, model.dynamic_mass.astype(complex))[0]
    nearest = exact[np.argmin(np.abs(exact[:, None] - values), axis=0)]
    assert values == pytest.approx(nearest, rel=2e-6)
    real = eigh(K.real, model.dynamic_mass, eigvals_only=True)[:COUNT]
    assert values.real == pytest.approx(real, rel=0.05)
    miss = K @ vectors - (model.dynamic_mass @ vectors) * values
    assert (
        np.linalg.norm(miss, axis=0).max()
        < 1e-2 * np.linalg.norm((model.dynamic_mass @ vectors) * values, axis=0).max()
    )


def test_a_solid_bolt_in_small_bases():
    """The same bases, on a structure whose bolt is drawn in: trained at two variants, right at a third."""
    from tests.bolt.test_solid_bolt import structure as with_bolt
    from tests.helpers.voxels import bolted

    made = with_bolt(bolted(kind="hex8"))
    laws = [joint.law for joint in made.joints]
    reduction = Reduction.of(made, laws, np.array([4e3]), count=COUNT)
    for force in (2e3, 6e3):
        reduction.train(laws, np.array([force]), [None] * len(laws), tolerance=TOLERANCE)
    found = made.assembly().solve(made.loads @ [3e3])
    K, _ = made.coupled(made.springs(found.pressures))
    modes = lowest_modes(K, made.dynamic_matrices[1], 6 + COUNT, shift_frequency=made.shift_frequency)
    variant = reduction.model.evaluate(laws, np.array([3e3]), [None] * len(laws))
    assert variant.frequencies == pytest.approx(modes.frequencies[6:], rel=1e-5)


def test_a_part_that_is_held_by_nothing_is_named():
    """The bolt pulls the first two bars together; nothing presses the third."""
    from tests.joint.test_support_check import three

    structure = three(50e-6, supports=(Support(face="p0.left"),))
    with pytest.raises(faying.InputError, match="part 'p2' is free to move"):
        Reduction.of(structure, [joint.law for joint in structure.joints], np.array([2e3]), count=COUNT)


SCALES = (1.06, 0.93), (0.97, 1.05)  # of stiffness and mass of the two parts


@pytest.mark.parametrize("held", ["free", "clamped"])
@pytest.mark.parametrize("lossy", [True, False])
def test_parts_may_be_scaled_each_by_itself(held, lossy):
    """Against the full structure of two materials; the rigid motions go along with a mass that shifts."""
    structure = beam(supports=(Support(face="p0.left"),) if held == "clamped" else ())
    base = law() if lossy else JointLaw(model=faying.contact.PowerLaw(C=5e-10, m=0.5), tangential="mindlin")
    shares = PartShares.of(structure, ("p0", "p1"))
    reduction = Reduction.of(structure, [base], np.array([1000.0]), count=COUNT, shares=shares)
    for scales in [((k, m), (j, 1.1)) for k in (0.9, 1.1) for j in (0.9, 1.1) for m in (0.9, 1.1)]:
        reduction.train([base], np.array([1000.0]), [None], tolerance=TOLERANCE, scales=scales)
    reduction.compress(TOLERANCE)
    materials = {
        part: replace(STEEL, E=k * STEEL.E, density=m * STEEL.density)
        for part, (k, m) in zip(("p0", "p1"), SCALES, strict=True)
    }
    _, damped = full(replace(structure, materials=materials), base, 1000.0)
    variant = reduction.model.with_scales(SCALES).evaluate([base], np.array([1000.0]), [None])
    assert variant.frequencies == pytest.approx(damped.frequencies, rel=1e-5)
    plain = reduction.model.with_scales(None).evaluate([base], np.array([1000.0]), [None])
    assert np.abs(plain.frequencies / damped.frequencies - 1).max() > 1e-3


def test_a_scaled_law_is_the_law_with_that_scale():
    one, other = law().scaled(1.7), replace(law(), scale=1.7)
    p = np.geomspace(1e3, 5e8, 300)
    for a, b in zip(one.stiffness(p), other.stiffness(p), strict=True):
        assert a == pytest.approx(b, rel=1e-9)
    w = one.approach(1e6)
    assert w == pytest.approx(law().approach(1e6) / 1.7, rel=1e-9)
    assert one.pressure(np.array([w]))[0] == pytest.approx([1e6], rel=1e-6)


@pytest.mark.parametrize("open_share", [0.0, 0.3, 1.0])
def test_springs_of_a_joint_are_the_sum_over_its_points(open_share):
    """Points without springs are left out where they are many; the sum is that over all of them."""
    from faying.reduction.reduced import joint_stiffness

    rng = np.random.default_rng(3)
    motion, springs = rng.standard_normal((60, 3, 5)), rng.random((60, 3))
    springs[: int(60 * open_share)] = 0.0
    expected = np.einsum("qim,qi,qin->mn", motion, springs, motion)
    assert joint_stiffness(motion.reshape(180, 5), springs) == pytest.approx(expected, rel=1e-12, abs=1e-12)


def test_a_start_that_presses_far_beyond_a_law_leads_to_the_same_equilibrium():
    """The curve of a law grows like an exponential: waves of the faces left 1e17 times the load."""
    structure = beam()
    model = Persson(pair=faying.ContactPair(STEEL, STEEL), h_rms=1e-6, slope=0.1)
    laws, forces = [JointLaw(model=model)], np.array([1000.0])
    reduction = Reduction.of(structure, laws, forces, count=COUNT)
    small = reduction.model
    right = small.equilibrium(laws, forces, [None])
    motions = small._motions(small.static_relative)
    load = small.static_loads @ forces
    balance = ReducedEquilibrium(small.static_stiffness, list(zip(motions, laws, strict=True)))
    far = right.displacement * 40.0
    left = balance._out_of_balance(far, load, balance._stick_slip(far))
    assert np.linalg.norm(left) > 1e6 * np.linalg.norm(load)
    found = balance.solve(load, start=far, tolerance=1e-9)
    assert found.newton_steps < 30
    assert found.displacement == pytest.approx(
        right.displacement, rel=1e-5, abs=1e-5 * np.abs(right.displacement).max()
    )
