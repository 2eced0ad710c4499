import numpy as np
import pytest

import faying
from faying.fe.interface import join
from faying.fe.sides import face_centre
from faying.joint.equilibrium import Equilibrium
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.preload_case import preload_index
from faying.joint.structure import Structure
from faying.numerics.modes import lowest_modes
from tests.helpers.boxes import stack
from tests.helpers.loads import bolt_load, face_load

STEEL = faying.CATALOGUE["45 steel"]
SIMPLE = faying.Material(name="simple", E=200e9, nu=0.0, density=7800.0)


def law(G=1.53e-10):
    return faying.JK(D=2.39, G=G, pair=faying.ContactPair(STEEL, STEEL), scan_area=16e-6)


def bars(sections=((2, 2), (2, 2)), material=SIMPLE, **changes):
    mesh = stack([0.05, 0.05], [3, 3], width=0.02, height=0.02, sections=sections)
    joint = FittedJoint(
        name="j",
        faces=("p0.right", "p1.left"),
        interface=join(mesh, "p0.right", "p1.left"),
        law=JointLaw(model=law()),
        **changes,
    )
    return Structure(mesh=mesh, materials=dict.fromkeys(mesh.parts, material), joints=(joint,))


def squeeze(structure, force):
    return force * bolt_load(structure, "p1.right", "p0.left")


@pytest.mark.parametrize("sections", [((2, 2), (2, 2)), ((2, 2), (3, 3))], ids=["matched", "unmatched"])
def test_uniform_pressure(sections):
    """Bars of nu = 0 pressed by uniform end loads: p = F/A everywhere, and the joint closes by the law's w(p)."""
    structure = bars(sections)
    for force in (400.0, 2000.0, 8000.0):
        found = structure.assembly().solve(squeeze(structure, force))
        p = force / 4e-4
        tolerance = 1e-8
        weights = structure.joints[0].interface.weights
        assert weights @ found.pressures[0] == pytest.approx(force, rel=1e-8)
        assert found.pressures[0] == pytest.approx(np.full_like(found.pressures[0], p), rel=tolerance)
        closing = -(weights @ found.openings[0]) / weights.sum()
        assert closing == pytest.approx(structure.joints[0].law.approach(p), rel=max(tolerance / 10, 1e-7))


def test_faces_that_begin_apart_come_together():
    """There is one equilibrium, and free bars find it: on the way there the motion of one of them costs nothing."""
    structure = bars()
    for apart in (1e-6, 1e-5, 1e-4, 1e-3):
        start = np.zeros((len(structure.mesh.points), 3))
        start[structure.mesh.part_nodes("p1"), 0] = apart
        found = structure.assembly().solve(squeeze(structure, 400.0), start=start.ravel())
        assert found.pressures[0] == pytest.approx(np.full_like(found.pressures[0], 1e6), rel=1e-8)


def test_balance_and_warm_start():
    structure = bars(material=STEEL)
    assembly = structure.assembly()
    for force in (1e3, 3e3, 9e3):
        found = assembly.solve(squeeze(structure, force))
        weights = structure.joints[0].interface.weights
        assert weights @ found.pressures[0] == pytest.approx(force, rel=1e-8)
    direct = structure.assembly().solve(squeeze(structure, 9e3))
    assert found.pressures[0] == pytest.approx(direct.pressures[0], rel=1e-6)


def face_pair(structure, force):
    """Load [N] (unknowns,) that presses the bars together along a line beside their axis."""
    mesh = structure.mesh
    centre, _, _ = face_centre(mesh.points, mesh.face("p1.right"))
    line, inward = centre + np.array([0.0, 0.006, 0.0]), np.array([-1.0, 0.0, 0.0])
    load = face_load(mesh.points, mesh.face("p1.right"), line, inward)
    return force * (load + face_load(mesh.points, mesh.face("p0.left"), line, -inward))


def test_an_eccentric_load_opens_one_side_and_still_balances():
    """A resultant outside the kern: part of the face carries nothing; force and moment are those of the load."""
    structure = bars(material=STEEL)
    mesh = structure.mesh
    centre, _, _ = face_centre(mesh.points, mesh.face("p1.right"))
    line = centre + np.array([0.0, 0.006, 0.0])
    load = face_pair(structure, 1.0)
    found = structure.assembly().solve(4e3 * load)
    joint, p = structure.joints[0].interface, found.pressures[0]
    assert 0.05 < joint.weights[p == 0].sum() / joint.area < 0.9
    assert np.all(p >= 0)
    assert joint.weights @ p == pytest.approx(4e3, rel=1e-8)
    arm = joint.weights @ (p * joint.positions[:, 1]) / 4e3
    assert arm == pytest.approx(line[1], abs=1e-5)


def test_one_load_at_once_or_in_steps_gives_the_same_pressure():
    structure = bars(material=STEEL)
    steps = structure.assembly()
    for force in np.linspace(1e3, 6e3, 5):
        last = steps.solve(squeeze(structure, force))
    once = structure.assembly().solve(squeeze(structure, 6e3))
    assert last.pressures[0] == pytest.approx(once.pressures[0], rel=1e-6)


def test_a_gap_before_the_load_is_closed_first():
    """Bars 2 um apart: the same pressure as without the gap, and the ends come that much nearer."""
    mesh = stack([0.05, 0.05], [3, 3], width=0.02, height=0.02, gap=2e-6)
    joint = FittedJoint(
        name="j", faces=("p0.right", "p1.left"), interface=join(mesh, "p0.right", "p1.left"), law=JointLaw(model=law())
    )
    structure = Structure(mesh=mesh, materials=dict.fromkeys(mesh.parts, SIMPLE), joints=(joint,))
    found = structure.assembly().solve(squeeze(structure, 2000.0))
    assert found.pressures[0] == pytest.approx(np.full_like(found.pressures[0], 5e6), rel=1e-7)
    moved = found.displacement.reshape(-1, 3)[:, 0]
    left, right = (np.unique(mesh.face(name)) for name in ("p0.right", "p1.left"))
    approach = moved[left].mean() - moved[right].mean()
    assert approach == pytest.approx(2e-6 + joint.law.approach(5e6), rel=1e-4)


def test_preload_beyond_the_law():
    """The pressure is that of the force; the stiffness is held where the law ends."""
    structure = bars()
    pressure = structure.assembly().solve(squeeze(structure, 1e6)).pressures[0]
    assert pressure == pytest.approx(np.full_like(pressure, 1e6 / 4e-4), rel=1e-8)
    law = structure.joints[0].law
    end = law.stiffness(np.array([law.model.greatest_pressure]))
    assert structure.springs([pressure])[0].k_n == pytest.approx(np.full_like(pressure, end[0][0]), rel=1e-9)


def test_a_load_that_does_not_balance_is_refused():
    structure = bars()
    with pytest.raises(faying.InputError, match="do not balance"):
        structure.assembly().solve(np.ones(structure.mesh.unknowns))


def test_too_few_steps_are_reported():
    structure = bars(material=STEEL)
    with pytest.raises(faying.NotConverged, match="after 1 Newton steps"):
        structure.assembly().solve(squeeze(structure, 5e3), steps=1)


def test_bolts_that_pull_nothing_together():
    structure = bars()
    with pytest.raises(faying.InputError, match="do not look away from each other"):
        bolt_load(structure, "p0.right", "p1.left")
    with pytest.raises(faying.InputError, match="both on part 'p0'"):
        bolt_load(structure, "p0.right", "p0.left")


def test_a_part_without_joint_is_refused():
    mesh = stack([0.05, 0.05, 0.05], [2, 2, 2], width=0.02, height=0.02, gap=1e-6)
    joint = FittedJoint(
        name="j", faces=("p0.right", "p1.left"), interface=join(mesh, "p0.right", "p1.left"), law=JointLaw(model=law())
    )
    with pytest.raises(faying.InputError, match="part p2 has no joint"):
        Structure(mesh=mesh, materials=dict.fromkeys(mesh.parts, STEEL), joints=(joint,))


def test_per_area_springs_do_not_depend_on_the_mesh_and_per_node_springs_do():
    """The same pressed bars on three meshes: the sum of k_n per area stays within 1 %, the node-by-node sum drifts."""
    totals = {False: [], True: []}
    for n in (1, 2, 4):
        mesh = stack([0.02, 0.02], [2 * n, 2 * n], width=0.02, height=0.02, sections=[(n, n), (n, n)])
        for per_node in totals:
            joint = FittedJoint(
                name="j",
                faces=("p0.right", "p1.left"),
                interface=join(mesh, "p0.right", "p1.left"),
                law=JointLaw(model=law()),
                per_node=per_node,
                scan_area=16e-6,
            )
            structure = Structure(mesh=mesh, materials=dict.fromkeys(mesh.parts, STEEL), joints=(joint,))
            found = structure.assembly().solve(squeeze(structure, 600.0))
            totals[per_node].append(structure.springs(found.pressures)[0].total()[0])
    area, node = np.array(totals[False]), np.array(totals[True])
    assert np.abs(area / area[-1] - 1).max() < 0.01
    assert np.all(np.diff(node) > 0.3 * node[:-1])


def test_a_preload_is_found_by_the_digits_that_messages_print():
    loads = (1e3, 10e3 / 3, 12e3)
    assert [preload_index(loads, float(f"{load:.4g}")) for load in loads] == [0, 1, 2]
    assert preload_index(loads, None) == 2
    assert preload_index(loads, f"{loads[1] / 1e3:.4g} kN") == 1
    for wanted, fault in ((2e3, "no such preload"), (-1e3, "must be positive"), ("1 mm", "not in a unit like N")):
        with pytest.raises(faying.InputError, match=fault):
            preload_index(loads, wanted)
    with pytest.raises(faying.InputError, match="it has none"):
        preload_index((), 1e3)
    assert preload_index((1e3, 1.0005e3), 1.0004e3) == 1


def test_the_factorisation_of_the_last_modes_serves_the_next_load():
    """The same equilibrium in fewer steps; one that was shifted further is not taken."""
    structure = bars(material=STEEL)
    shift = structure.shift_frequency
    alone, helped = structure.assembly(), structure.assembly()
    alone.vertices = helped.vertices = None  # else the first factorisation would be as near
    start = alone.solve(squeeze(structure, 1e3))
    helped.solve(squeeze(structure, 1e3))
    stiffness, _ = structure.coupled(structure.springs(start.pressures))
    modes = lowest_modes(stiffness, structure.dynamic_matrices[1], 8, shift_frequency=shift)
    helped.adopt_factor(modes.factorisation, 2 * shift)
    assert helped.factor is not modes.factorisation
    helped.adopt_factor(modes.factorisation, shift)
    found, wanted = (problem.solve(squeeze(structure, 3e3)) for problem in (helped, alone))
    assert found.pressures[0] == pytest.approx(wanted.pressures[0], rel=1e-8)
    assert found.inner_steps < wanted.inner_steps
    assert found.factorisations == wanted.factorisations == 1


def test_the_corners_lead_to_the_same_equilibrium_in_fewer_steps():
    """A load outside the kern: the joint opens on one side, which one pressure for all of it knows nothing of."""
    structure = bars(material=STEEL)
    helped, alone = structure.assembly(), structure.assembly()
    alone.vertices = None
    found, wanted = (problem.solve(face_pair(structure, 4e3)) for problem in (helped, alone))
    assert found.pressures[0] == pytest.approx(wanted.pressures[0], abs=1e-8 * wanted.pressures[0].max())
    assert found.inner_steps < 0.7 * wanted.inner_steps
    assert alone.factorised_springs is None
    [(k_n, _)] = helped.factorised_springs
    exact = structure.springs(found.pressures)[0].k_n
    assert np.mean((k_n > 0) == (exact > 0)) > 0.85
    both = (k_n > 0) & (exact > 0)
    assert np.median(np.abs(np.log(k_n[both] / exact[both]))) < 0.3


@pytest.mark.parametrize("fault", [faying.NotConverged, faying.InputError])
def test_where_the_corners_find_no_equilibrium_the_joint_begins_evenly(fault, monkeypatch):
    structure = bars(material=STEEL)
    wanted = structure.assembly().solve(face_pair(structure, 4e3))
    solve = Equilibrium.solve

    def fails(self, load, **options):
        if len(load) < structure.mesh.unknowns:
            raise fault("no equilibrium")
        return solve(self, load, **options)

    monkeypatch.setattr(Equilibrium, "solve", fails)
    problem = structure.assembly()
    found = problem.solve(face_pair(structure, 4e3))
    assert problem.factorised_springs is None
    assert found.pressures[0] == pytest.approx(wanted.pressures[0], abs=1e-8 * wanted.pressures[0].max())
