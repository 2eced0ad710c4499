"""Compliance of bolts and members, and the load factor, against closed forms and the deformation cone of VDI 2230."""

from dataclasses import replace
from math import log, pi

import numpy as np
import pytest

import faying
from faying.bolt.bolt import Bolt
from faying.bolt.vdi2230 import cone_angle, cone_compliance, embedding_guide
from faying.fe.interface import join
from faying.joint.clamping import clamping, cone_of
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.load_path import LoadPaths
from faying.joint.structure import Structure
from faying.numerics.modes import lowest_modes
from tests.helpers.laws import Given
from tests.helpers.rings import discs

STEEL = faying.Material(name="steel", E=210e9, nu=0.3, density=7850.0)
HARD, SOFT = replace(STEEL, nu=0.0), faying.Material(name="soft", E=70e9, nu=0.0, density=2700.0)
HOLE, ALL_ROUND = 9e-3, 12


def held(k_n):
    """A law of one stiffness, whatever the pressure."""
    return JointLaw(model=Given(k_n=lambda p: k_n + 0 * p, k_t=lambda p: 0.8 * k_n + 0 * p))


def clamped(mesh, bolts, *, k_n=1e16, materials=None):
    """Structure, stiffness and clamping of two discs under even pressure."""
    joint = FittedJoint(
        name="j",
        faces=("high.bottom", "low.top"),
        interface=join(mesh, "high.bottom", "low.top"),
        law=held(k_n),
    )
    structure = Structure(
        mesh=mesh, materials=materials or dict.fromkeys(mesh.parts, STEEL), joints=(joint,), bolts=bolts
    )
    springs = structure.springs([np.full(len(joint.interface.weights), 10e6)])
    K, _ = structure.coupled(springs)
    modes = lowest_modes(K, structure.dynamic_matrices[1], 8, shift_frequency=structure.shift_frequency)
    return structure, K, modes, springs, clamping(structure, K, modes, springs)


def sleeve(materials=None, k_n=2e13, **bolt):
    """Two sleeves of 9 and 20 mm diameter, 10 and 16 mm high, under a bolt that presses their whole ends."""
    mesh = discs([HOLE / 2, 7e-3, 10e-3], ALL_ROUND, [0.0, 5e-3, 10e-3], lower=[0.0, 8e-3, 16e-3])
    given = {"diameter": 8e-3, "material": STEEL} | bolt
    one = Bolt(name="b", faces=("high.top", "low.bottom"), **given)
    return clamped(mesh, (one,), k_n=k_n, materials=materials)


def test_a_sleeve_is_a_rod_with_its_joint_in_series():
    """Sum of l/(E A), and of the joint's 1/(k_n A). Curved elements have a little less area.

    The bolt's is that of the guideline: head and nut, free and engaged thread.
    """
    structure, *_, found = sleeve({"low": SOFT, "high": HARD})
    area = structure.joints[0].interface.area
    assert area == pytest.approx(pi / 4 * (20e-3**2 - HOLE**2), rel=2e-3)
    members = 10e-3 / (210e9 * area) + 16e-3 / (70e9 * area) + 1 / (2e13 * area)
    shank = (0.9 * 8e-3 / 8e-3**2 + (26e-3 + 4e-3) / (8e-3 - 1.22687 * 1.25e-3) ** 2) / (210e9 * pi / 4)
    assert found.members[0] == pytest.approx(members, rel=1e-6)
    assert found.bolt[0] == pytest.approx(shank, rel=1e-12)
    assert found.load_factor[0] == pytest.approx(members / (members + shank), rel=1e-6)


@pytest.mark.parametrize("accuracy", [1e-2, 1e-3])
def test_a_compliance_is_wrong_by_the_square_of_the_residual(accuracy, monkeypatch):
    """Begun from the motion under uneven springs: the product with the load alone is off by a tenth of the residual."""
    import faying.joint.clamping as module

    structure, K, _, springs, exact = sleeve({"low": SOFT, "high": HARD})
    share = np.linspace(0.05, 1, len(springs[0].k_n))
    uneven = [replace(s, k_n=s.k_n * share, k_t=s.k_t * share) for s in springs]
    before = structure.coupled(uneven)[0]
    modes = lowest_modes(before, structure.dynamic_matrices[1], 8, shift_frequency=structure.shift_frequency)
    like = clamping(structure, before, modes, uneven).motions
    monkeypatch.setattr(module, "ACCURACY", accuracy)
    found = clamping(structure, K, modes, springs, like=like)
    assert found.members == pytest.approx(exact.members, rel=accuracy**2)


def test_the_traction_of_a_clamp_force_adds_up_to_it():
    structure, *_, found = sleeve()
    (spread,) = found.traction
    weights = structure.joints[0].interface.weights
    assert spread @ weights == pytest.approx([1.0], rel=1e-7)
    assert spread[0] == pytest.approx(1 / weights.sum(), rel=1e-4)


def test_forces_at_the_seats_divide_by_the_load_factor():
    """1 N that pulls the seats of the tight bolt apart: the bolt takes Phi of it, the joint loses the rest."""
    structure, K, _, springs, found = sleeve()
    bolt = structure.fitted_bolts[0]
    M = structure.dynamic_matrices[1]
    motion = np.zeros(K.shape[0])
    rigid = structure.rigid @ np.linalg.inv(structure.rigid.T @ structure.rigid) @ structure.rigid.T
    from scipy.sparse.linalg import splu

    shifted = (K + 1e-9 * K.diagonal().mean() * M / M.diagonal().mean()).tocsc()
    motion = splu(shifted).solve(-bolt.load)
    motion -= rigid @ motion
    assert bolt.tension(motion) == pytest.approx(found.load_factor[0], rel=1e-5)
    i = structure.joints[0].interface
    left = i.weights @ (springs[0].k_n * np.asarray(i.relative @ motion).reshape(-1, 3)[:, 0])
    assert left == pytest.approx(1 - found.load_factor[0], rel=1e-5)


def test_what_embeds_takes_force_from_the_bolt():
    """A joint that closes by 1 um at some places: the bolt loses the traction-weighted closing over delta_S + delta_P.

    The other way round, the misfit is put on the tangent structure as the force that would open it again.
    """
    structure, K, _, springs, found = sleeve()
    i, bolt = structure.joints[0].interface, structure.fitted_bolts[0]
    closing = 1e-6 * (1 + np.sin(1e3 * i.positions[:, 0]))
    from scipy.sparse.linalg import splu

    M = structure.dynamic_matrices[1]
    shifted = (K + 1e-9 * K.diagonal().mean() * M / M.diagonal().mean()).tocsc()
    pressed = i.forces(-springs[0].k_n * closing, np.zeros((len(closing), 2)))
    lost = -bolt.tension(splu(shifted).solve(pressed))
    mean = found.traction[0][0] @ (i.weights * closing)
    assert lost == pytest.approx(mean / (found.bolt[0] + found.members[0]), rel=1e-5)
    assert lost > 0


def test_a_bolt_without_a_shank_has_members_alone():
    *_, plain = sleeve(diameter=None, material=None)
    *_, found = sleeve()
    assert plain.members == pytest.approx(found.members, rel=1e-6)
    assert np.isnan(plain.bolt[0])
    assert np.isnan(plain.load_factor[0])


@pytest.fixture(scope="module")
def wide():
    """Two steel discs of 60 mm diameter and 12 mm height each, hole 9 mm, head 13 mm."""
    radii = np.array([4.5, 5.5, 6.5, 8.5, 12, 18, 30]) * 1e-3
    heights = np.array([0, 2, 5, 8.5, 12]) * 1e-3
    bolt = Bolt(name="b", faces=("high.top", "low.bottom"), diameter=8e-3, material=STEEL, seat=(HOLE, 13e-3))
    return clamped(discs(radii, ALL_ROUND, heights), (bolt,))


def under_rigid_seats(structure, stiffness, radius):
    """Compliance [m/N] of the members where each seat moves along the axis as one, as under a rigid head."""
    from scipy.sparse import csr_array
    from scipy.sparse.linalg import splu

    mesh, n = structure.mesh, structure.mesh.unknowns
    column, ends = np.arange(n), []
    for face in ("low.bottom", "high.top"):
        nodes = mesh.face_nodes(face)
        nodes = nodes[np.hypot(*mesh.points[nodes, :2].T) <= 1.001 * radius]
        column[3 * nodes + 2] = 3 * nodes[0] + 2
        ends.append(3 * nodes[0] + 2)
    left, place = np.unique(column, return_inverse=True)
    tie = csr_array((np.ones(n), (np.arange(n), place)), shape=(n, len(left)))
    K = tie.T @ (stiffness - structure.fitted_bolts[0].stiffness) @ tie
    M = tie.T @ structure.dynamic_matrices[1] @ tie
    force = np.zeros(len(left))
    force[place[ends]] = 1.0, -1.0
    motion = splu((K + 1e-8 * K.diagonal().mean() / M.diagonal().mean() * M).tocsc()).solve(force)
    return float(motion @ force)


def test_wide_discs_against_the_cone_of_the_guideline(wide):
    """The guideline's angle was fitted to heads that are stiff: under rigid seats the discs give its value to 7 %.

    A bolt of ours presses its ring evenly: softer, here by 18 %.
    """
    structure, stiffness, *_, found = wide
    paths = LoadPaths.of(structure)
    ((cut,),) = paths.cuts
    assert (cut.depth, paths.lines[0].length) == pytest.approx((12e-3, 24e-3))
    assert cut.joints == (0,)
    assert np.sqrt(4 * cut.area / pi + HOLE**2) == pytest.approx(60e-3, rel=2e-3)
    cone = cone_of(structure, paths, 0)
    rigid = under_rigid_seats(structure, stiffness, 6.5e-3)
    assert rigid == pytest.approx(cone, rel=0.07)
    assert rigid < found.members[0] < 1.25 * cone


def test_the_cone_is_that_of_the_guidelines_formula():
    """Eqs. (5.1/24) and (5.1/25) as printed, for a nut (w = 1) and a tapped part (w = 2), and a sleeve."""
    E, d_w, d_h, length = 205e9, 13e-3, 9e-3, 30e-3
    for tapped, w in ((False, 1), (True, 2)):
        for outer in (14e-3, 20e-3, 28e-3, 60e-3):
            tan = cone_angle(length, d_w, outer, tapped=tapped)
            limit = d_w + w * length * tan
            if outer >= limit:
                ratio = (d_w + d_h) * (d_w + w * length * tan - d_h) / ((d_w - d_h) * (d_w + w * length * tan + d_h))
                printed = 2 * log(ratio) / (w * E * pi * d_h * tan)
            else:
                ratio = (d_w + d_h) * (outer - d_h) / ((d_w - d_h) * (outer + d_h))
                rest = 4 / (outer**2 - d_h**2) * (length - (outer - d_w) / (w * tan))
                printed = (2 / (w * d_h * tan) * log(ratio) + rest) / (E * pi)
            found = cone_compliance([(length, E)], seat=d_w, hole=d_h, outer=outer, tapped=tapped)
            assert found == pytest.approx(printed, rel=1e-12), (tapped, outer)
    thin = cone_compliance([(length, E)], seat=20e-3, hole=d_h, outer=18e-3)
    assert thin == pytest.approx(4 * length / (E * pi * (18e-3**2 - d_h**2)), rel=1e-12)


def test_the_angle_of_the_guideline():
    """Through bolt with l_K/d_w = 2 and D_A = d_w: tan phi = .362, some 20 degrees; wider parts widen the cone."""
    assert cone_angle(2.0, 1.0, 1.0) == pytest.approx(0.362)
    assert cone_angle(1.0, 1.0, 1.0, tapped=True) == pytest.approx(0.348)
    assert cone_angle(2.0, 1.0, 4.0) > cone_angle(2.0, 1.0, 2.0) > 0.362


def test_sections_of_a_cone_add_up():
    """Cut in pieces of one modulus nothing changes; soft parts weigh by where they lie; a thin hole is none."""
    given = {"seat": 13e-3, "hole": 9e-3, "outer": 22e-3}
    whole = cone_compliance([(30e-3, 2e11)], **given)
    assert cone_compliance([(4e-3, 2e11), (11e-3, 2e11), (15e-3, 2e11)], **given) == pytest.approx(whole, rel=1e-12)
    mixed = cone_compliance([(10e-3, 1e11), (20e-3, 2e11)], **given)
    assert mixed == pytest.approx(cone_compliance([(20e-3, 2e11), (10e-3, 1e11)], **given), rel=1e-12)
    assert whole < mixed < 2 * whole
    thin = {"seat": 13e-3, "outer": 60e-3}
    nothing = cone_compliance([(30e-3, 2e11)], hole=0.0, **thin)
    assert cone_compliance([(30e-3, 2e11)], hole=1e-6, **thin) == pytest.approx(nothing, rel=1e-6)
    for changes in ({"hole": 13e-3}, {"hole": 30e-3}):
        with pytest.raises(faying.InputError, match="must be narrower"):
            cone_compliance([(30e-3, 2e11)], **(given | changes))
    with pytest.raises(faying.InputError, match="positive length"):
        cone_compliance([(0.0, 2e11)], **given)
    with pytest.raises(faying.InputError, match="outside the range of the guideline's cone"):
        cone_compliance([(1e-9, 2e11)], **given)


def test_the_guide_values_of_embedding():
    assert embedding_guide(9.99e-6) == (3e-6, 2.5e-6, 1.5e-6)
    assert embedding_guide(10e-6) == (3e-6, 3e-6, 2e-6)
    assert embedding_guide(100e-6) == (3e-6, 4e-6, 3e-6)
    with pytest.raises(faying.InputError, match="end at"):
        embedding_guide(160e-6)


def test_two_bolts_share_a_joint_by_the_nearer_axis():
    from tests.helpers.plates import plates, stacked

    mesh = stacked(counts=(8, 4, 2), size=(0.08, 0.04, 0.01))
    bolts = tuple(
        Bolt(
            name=name,
            faces=("high.top", "low.bottom"),
            at=(x, 0.02, 0.0),
            diameter=8e-3,
            material=STEEL,
            seat=(8e-3, 20e-3),
        )
        for name, x in (("one", 0.02), ("two", 0.06))
    )
    structure = plates(mesh, bolts=bolts)
    for (cut,) in LoadPaths.of(structure).cuts:
        assert cut.area == pytest.approx(0.04 * 0.04, rel=1e-6)
        assert cut.depth == pytest.approx(0.01)
    (whole,) = (Bolt(name="w", faces=("high.top", "low.bottom")),)
    alone = replace(structure, bolts=(whole,))
    assert np.isnan(cone_of(alone, LoadPaths.of(alone), 0))


def test_a_face_that_is_a_ring_is_a_seat():
    structure, *_ = sleeve()
    seat = structure.fitted_bolts[0].pressed[0]
    assert (seat.inner, seat.outer, seat.is_ring) == (pytest.approx(HOLE), pytest.approx(20e-3), True)
    area = pi / 4 * (20e-3**2 - HOLE**2)
    assert cone_of(structure, LoadPaths.of(structure), 0) == pytest.approx(26e-3 / (210e9 * area), rel=5e-3)


def meshed(**changes):
    from tests.bolt.test_solid_bolt import structure as with_solid_bolts
    from tests.helpers.voxels import bolted

    made = with_solid_bolts(bolted(kind="hex8"), **changes)
    at = made.springs([np.full(len(j.interface.weights), 5e6) for j in made.joints])
    K, M = made.coupled(at)[0], made.dynamic_matrices[1]
    modes = lowest_modes(K, M, 8, shift_frequency=made.shift_frequency)
    return made, K, at, clamping(made, K, modes, at)


def test_a_meshed_bolt_divides_between_itself_and_its_members():
    """Wherever its shank is drawn in; 1 N of tension runs through joint, head and nut; its whole is its stiffness.

    Turned by a, the nut gives the tension a/(delta_S + delta_P).
    """
    made, K, _, found = meshed()
    for spread, joint in zip(found.traction, made.joints, strict=True):
        assert spread[0] @ joint.interface.weights == pytest.approx(1.0, rel=1e-6)
    *_, other = meshed(at=(0.02, 0.02, 13e-3))
    assert other.members == pytest.approx(found.members, rel=1e-6)
    assert other.bolt == pytest.approx(found.bolt, rel=1e-5)
    bolt, M = made.fitted_bolts[0], made.dynamic_matrices[1]
    from scipy.sparse.linalg import splu

    shifted = (K + 1e-10 * K.diagonal().mean() * M / M.diagonal().mean()).tocsc()
    turned = bolt.rigidity + bolt.pull @ splu(shifted).solve(-bolt.pull)
    assert 1 / turned == pytest.approx(found.bolt[0] + found.members[0], rel=1e-4)
    assert 0 < found.members[0] < found.bolt[0]


def test_bonded_seats_of_a_meshed_bolt_are_very_stiff_ones():
    """Members, load factor and load path do not depend on whether a seat is bonded or in contact that hardly gives."""
    from faying.bolt.solid_bolt import SolidBolt
    from tests.helpers.voxels import bolted

    def made(seat):
        mesh = bolted(kind="hex8")
        pairs = [("lower.joint", "upper.joint"), ("bolt0.head", "upper.seat0"), ("bolt0.nut", "lower.seat0")]
        if seat is None:
            mesh, pairs = mesh.bonded_at(*pairs[1:]), pairs[:1]
        if seat == "tied":  # as seats whose nodes do not match
            owners = tuple((mesh.face_part[a], mesh.face_part[b]) for a, b in pairs[1:])
            mesh, pairs = replace(mesh, ties=tuple(pairs[1:]), bonded=owners), pairs[:1]
        joints = tuple(
            FittedJoint(name=a, faces=(a, b), interface=join(mesh, a, b), law=held(seat if "bolt" in a else 2e13))
            for a, b in pairs
        )
        bolt = SolidBolt(name="b", part="bolt0", faces=("bolt0.head", "bolt0.nut"), at=(0.02, 0.02, 13e-3))
        structure = Structure(mesh=mesh, materials=dict.fromkeys(mesh.parts, STEEL), joints=joints, bolts=(bolt,))
        at = structure.springs([np.full(len(j.interface.weights), 5e6) for j in joints])
        K, M = structure.coupled(at)[0], structure.dynamic_matrices[1]
        modes = lowest_modes(K, M, 8, shift_frequency=structure.shift_frequency)
        return structure, clamping(structure, K, modes, at)

    bonded, tied, stiff, soft = made(None), made("tied"), made(1e16), made(1e12)
    # what the contact under head and nut gives is the bolt's, not the members'
    assert soft[1].members == pytest.approx(stiff[1].members, rel=0.3)
    assert soft[1].bolt > 2 * stiff[1].bolt
    for one in (bonded, tied):
        assert one[1].members == pytest.approx(stiff[1].members, rel=0.01)
        assert one[1].load_factor == pytest.approx(stiff[1].load_factor, rel=0.01)
    assert bonded[1].members[0] > 0.05 * bonded[1].bolt[0]
    for structure, _ in (bonded, tied, stiff):
        ((cut,),) = LoadPaths.of(structure).cuts
        assert (cut.joints, cut.depth) == ((0,), pytest.approx(10e-3))


def test_a_bolt_among_others_has_the_cone_of_the_same_bolt_alone():
    """Of two on plates of 80 x 40 mm each has a square of 40 mm, five seats wide; alone it has all."""
    from tests.helpers.plates import plates, stacked

    mesh = stacked(counts=(16, 8, 2), size=(0.08, 0.04, 0.01))
    given = {"diameter": 5e-3, "material": STEEL, "seat": (5e-3, 8e-3)}
    both = tuple(Bolt(name=f"{x}", faces=("high.top", "low.bottom"), at=(x, 0.02, 0.0), **given) for x in (0.02, 0.06))
    pair, alone = plates(mesh, bolts=both), plates(mesh, bolts=both[:1])
    cones = [cone_of(one, LoadPaths.of(one), 0) for one in (pair, alone)]
    assert cones[0] == pytest.approx(cones[1], rel=0.02)
    E = faying.CATALOGUE["45 steel"].E
    guideline = cone_compliance([(0.01, E), (0.01, E)], seat=8e-3, hole=5e-3, outer=40e-3)
    assert cones[1] == pytest.approx(guideline, rel=1e-9)
