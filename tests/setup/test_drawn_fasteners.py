"""Assemblies whose fasteners are bodies: number, size, head, nut, washer, engagement and preload, and their mass."""

import numpy as np
import pytest

import faying
from faying.case.case import build
from faying.geometry.cad import read_parts
from faying.setup import new
from faying.study import Study
from tests.helpers import assemblies, drawn
from tests.helpers.proposed import proposed

# N, of class 8.8: 0.9 of 640 MPa, 660 above M16, in tension and torsion at mu_G = 0.12, over 1.28 (VDI 2230, R7)
FORCES = {5: 5620, 6: 7940, 8: 14500, 10: 23100, 12: 33600, 16: 63200, 42: 470000}


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Name -> the STEP file, what is expected, and the proposal, each made once."""
    folder, kept = tmp_path_factory.mktemp("drawn"), {}

    def of(name):
        if name not in kept:
            path, expected = drawn.MADE[name](folder / f"{name}.step")
            kept[name] = path, expected, new.find(path)
        return kept[name]

    return of


@pytest.mark.parametrize("name", drawn.MADE)
def test_bolts_are_found_as_they_are_drawn(made, name):
    _, expected, found = made(name)
    assert len(found.bolts) == len(expected), [bolt.remark for bolt in found.bolts]
    for bolt, one in zip(found.bolts, expected, strict=True):
        assert bolt.size == one.size
        assert bolt.shape == one.head
        assert "lips" not in bolt.words or name == "t_slot"
        assert np.array(bolt.ring) * 1e3 == pytest.approx(one.ring, abs=1e-6)
        assert (bolt.at is None) == one.tapped
        assert (0 if bolt.drawn is None else len(bolt.drawn.washers)) == one.washers
        assert bolt.engaged == (None if one.engaged is None else pytest.approx(one.engaged * 1e-3))
        assert one.says in bolt.remark
        assert bolt.preload == pytest.approx(FORCES[one.size], rel=6e-3)


def test_bare_holes_in_line_with_a_drawn_bolt_have_a_bolt_of_their_own(tmp_path):
    """30 mm of air are between them: the far plate, through which the drawn bolt runs, is no lip of a slot."""
    path, expected = drawn.one_axis(tmp_path / "line.step", lows=(50,))
    found = new.find(path)
    assert len(found.bolts) == len(expected)
    assert {frozenset(bolt.parts) for bolt in found.bolts} == {
        frozenset({"plate a", "plate b"}),
        frozenset({"plate c", "plate d"}),
    }


def test_one_part_beside_its_bolts_is_refused_by_what_they_are_taken_for(tmp_path):
    """Head and nut touch the plate: that no faces touch would be wrong."""
    path = drawn.one_plate(tmp_path / "plate.step")
    with pytest.raises(faying.InputError, match="of two parts touch beside 'bolt 1', 'bolt 2', .*, taken for bolts"):
        new.find(path)


@pytest.mark.parametrize("name", drawn.MADE)
def test_no_fastener_is_meshed(made, name):
    _, _, found = made(name)
    assert all(part.name.split()[0] in ("plate", "tube", "lower", "upper") for part in found.facts.parts)


def test_a_shaft_with_a_collar_asks_for_no_bolt(tmp_path):
    """Its holes of 20 mm are medium clearance holes of M18 (ISO 273), and it leaves no play in them."""
    cylinder = assemblies._shapes()[1]
    parts = drawn._plates((20, 20), (20, 20), [drawn.A])
    shaft = cylinder(*drawn.A, -30, 60, 10) + cylinder(*drawn.A, 40, 48, 14)
    found = new.find(assemblies._write(tmp_path / "shaft.step", **parts, shaft=shaft))
    assert not found.bolts
    assert found.left_out == ("shaft",)


def test_a_plate_with_a_boss_is_no_bolt(tmp_path):
    """The boss of a motor's plate in the hole of its mount: both faces of the plate press, but away from each other."""
    cylinder = assemblies._shapes()[1]
    mount = assemblies._drilled(assemblies._box((-30, 30), (-30, 30), (30, 38)), [(0, 0)], 30, 38, 22)
    plate = assemblies._box((-21, 21), (-21, 21), (20, 30)) + cylinder(0, 0, 30, 32, 11)
    body = assemblies._box((-21, 21), (-21, 21), (0, 20))
    found = new.find(assemblies._write(tmp_path / "motor.step", mount=mount, plate=plate, body=body))
    assert not found.bolts
    assert not found.left_out
    assert {joint.faces[0].split(".")[0] for joint in found.joints} | {
        joint.faces[1].split(".")[0] for joint in found.joints
    } == {"mount", "plate", "body"}


def test_a_tube_wider_than_any_pin_is_no_dowel(tmp_path):
    """Two rings on a tube of 83 mm without play, as of a fuselage: ISO 2338 ends at 50 mm."""
    cylinder = assemblies._shapes()[1]
    parts = {f"ring {k}": cylinder(0, 0, 20 * k, 20 * k + 20, 60) - cylinder(0, 0, 0, 60, 41.5) for k in (0, 1)}
    tube = cylinder(0, 0, -20, 60, 41.5) - cylinder(0, 0, -20, 60, 40)
    found = new.find(assemblies._write(tmp_path / "tube.step", **parts, tube=tube))
    assert not found.dowels
    assert all("dowel" not in remark for remark in found.remarks)


@pytest.mark.slow
def test_drawn_bolts_are_parts_with_their_nuts_on_request(tmp_path):
    """A screw in a thread stays a beam; washers are parts with their own joints."""
    path, _ = drawn.hexagon_and_nut(tmp_path / "nuts.step")
    found = new.find(path, mesh_bolts=True)
    assert found.unite == (("bolt 1", "nut 1"), ("bolt 2", "nut 2"))
    assert not found.left_out
    assert [(bolt.part, bolt.size, bolt.preload) for bolt in found.bolts] == [
        (part, 10, pytest.approx(FORCES[10], rel=6e-3)) for part in ("bolt 1", "bolt 2")
    ]
    assert len(found.joints) == 9  # of the plates, and four about each bolt with two washers
    path, _ = drawn.socket_in_thread(tmp_path / "thread.step")
    found = new.find(path, mesh_bolts=True)
    assert not found.unite
    assert found.left_out == ("screw 1", "screw 2")


@pytest.mark.slow
def test_a_meshed_bolt_carries_its_preload_through_each_joint(tmp_path):
    """M10 with its nut through two plates, and the same as a beam, which does not hold its seats flat.

    The first mode of examples/solid-bolt is 13 % higher with the meshed bolt.
    """
    plates = drawn._plates((11, 11), (12, 12), [(60, 25)])
    bodies = {"bolt": drawn.screw((60, 25), 24, 10, 40, ("hexagon", 16)), "nut": drawn.nut((60, 25), -8.4, 10, 8.4, 16)}
    path = assemblies._write(tmp_path / "pair.step", **plates, **bodies)
    beam, meshed = (build(Study.read(proposed(path, "8 mm", *more))) for more in ((), ("--mesh-bolts",)))
    as_beam, as_mesh = (one.solve(preload=FORCES[10]) for one in (beam, meshed))
    assert as_mesh.forces == pytest.approx([FORCES[10]])
    for joint in meshed.joints:
        assert as_mesh.pressures[joint.name] @ joint.interface.weights == pytest.approx(FORCES[10], rel=1e-6)
    masses = dict(zip(meshed.mesh.parts, meshed.part_masses, strict=True))
    cad = read_parts(path)
    volume = 1e-9 * sum(solid.mass for solid, name in zip(cad.solids, cad.names, strict=True) if name in bodies)
    assert masses["bolt"] == pytest.approx(faying.CATALOGUE["S355"].density * volume, rel=2e-3)
    ratio = np.array(as_mesh.frequencies[:3]) / as_beam.frequencies[:3]
    assert np.all((ratio > 1) & (ratio < 1.15)), ratio


SLOW = [
    pytest.param(name, marks=pytest.mark.slow) for name in drawn.MADE if name not in ("socket_in_thread", "three_parts")
]


@pytest.mark.parametrize("name", ["socket_in_thread", *SLOW])
def test_the_beams_weigh_what_the_bodies_do(made, name):
    """Volumes of the bodies that are left out, by the CAD kernel, times the density of steel."""
    path, _, found = made(name)
    study = Study.read(proposed(path, "20 mm"))
    structure = build(study)
    along = np.zeros(3 * len(structure.mesh.points))
    along[0::3] = 1.0
    both = zip(structure.fitted_bolts, found.bolts, strict=True)
    beams = sum(along @ bolt.mass @ along for bolt, one in both if one.drawn is not None)
    cad = read_parts(path)
    volumes = dict(zip(cad.names, (1e-9 * solid.mass for solid in cad.solids), strict=True))
    bodies = sum(volumes[part] for part in study.geometry.leave_out)
    assert beams == pytest.approx(faying.CATALOGUE["S355"].density * bodies, rel=2e-3)
