"""faying new DECK: the pretension sections of a deck become bolts that carry the force that the deck pulls with."""

import re

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.case.case import checked_mesh
from faying.cli.main import cli
from faying.decks.meshfile import read_pretensions
from faying.fe.mesh import Mesh
from faying.study import Study
from tests.helpers import meshfiles
from tests.helpers.plates import LAW
from tests.helpers.rings import disc
from tests.helpers.sides import sides_on
from tests.helpers.voxels import bolted


def call(*words):
    return CliRunner().invoke(cli, list(map(str, words)), standalone_mode=False)


@pytest.fixture(scope="module")
def mesh():
    return bolted(kind="hex8")


def middle_layer(mesh, height):
    """(element, nodes of the side at a height [m]) of the shank, in the numbers of the deck."""
    n = meshfiles.numbers(mesh)
    place = dict(zip(n.tolist(), mesh.points, strict=True))
    for part, number, _, nodes in meshfiles.solids(mesh):
        at = np.array([place[k] for k in nodes])
        if part == "bolt0" and at[:, 2].max() <= height + 1e-9 and at[:, 2].max() >= height - 1e-9:
            yield number, [k for k, x in zip(nodes, at, strict=True) if abs(x[2] - height) < 1e-9]


def deck(mesh, height=10e-3, load="*STEP\n*STATIC\n*CLOAD\n9001, 1, 5000.\n*END STEP\n", axis="0., 0., 1.\n"):
    """The plates and the bolt with the section of its preload across the shank (the upper side of a brick is S2)."""
    text = meshfiles.abaqus(mesh) + "*NODE\n9001, 20, 20, 10\n*SURFACE, NAME=Cut\n"
    text += "".join(f"{number}, S2\n" for number, _ in middle_layer(mesh, height))
    return text + f"*PRE-TENSION SECTION, SURFACE=CUT, NODE=9001\n{axis}{load}"


def proposed(tmp_path, text, name="m.inp"):
    (tmp_path / name).write_text(text)
    done = call("new", tmp_path / name, "--unit", "mm", "--yes", "--out", tmp_path / "s.toml")
    assert done.exception is None, done.output
    return Study.read(tmp_path / "s.toml"), done.output


def test_a_section_becomes_a_bolt_with_the_force_of_its_node(tmp_path, mesh):
    study, out = proposed(tmp_path, deck(mesh))
    (bolt,) = study.bolts
    assert bolt.part == "bolt0"
    assert bolt.faces == ("bolt0.head", "bolt0.nut")
    assert bolt.at == pytest.approx((0.02, 0.02, 0.01))
    assert study.loads == (5000.0,)
    assert {frozenset(joint.faces) for joint in study.joints} == {
        frozenset(("lower.joint", "upper.joint")),
        frozenset(("bolt0.head", "upper.seat0")),
        frozenset(("bolt0.nut", "lower.seat0")),
    }
    text = (tmp_path / "s.toml").read_text()
    assert "*PRE-TENSION SECTION, SURFACE=CUT, NODE=9001" in text
    assert "taken as newtons" in out
    assert "ASSUMED: the force of the file" in text
    found = bolt.fitted(checked_mesh(study), stiffness(checked_mesh(study)))
    assert found.load @ np.tile([0, 0, 1.0], len(found.load) // 3) == pytest.approx(0, abs=1e-9)  # it pulls on itself


def stiffness(mesh):
    from faying.fe.elasticity import assemble

    steel = faying.Material(name="s", E=2e11, nu=0.3, density=7800.0)
    return assemble(mesh, dict.fromkeys(mesh.parts, steel))[0]


def test_the_axis_of_a_section_without_one_is_across_its_plane(tmp_path, mesh):
    study, _ = proposed(tmp_path, deck(mesh, axis=""))
    assert study.bolts[0].faces == ("bolt0.head", "bolt0.nut")


def test_a_section_that_is_held_has_no_force(tmp_path, mesh):
    """*BOUNDARY shortens the bolt by a length, which is not a preload."""
    held = "*STEP\n*STATIC\n*BOUNDARY\n9001, 1, 1, 0.01\n*CLOAD\n9001, 2, 77.\n*END STEP\n"
    (tmp_path / "m.inp").write_text(deck(mesh, load=held))
    done = call("new", tmp_path / "m.inp", "--unit", "mm", "--yes", "--out", tmp_path / "s.toml")
    assert done.exception is None
    assert re.search(r'^# preload = "10 kN"', (tmp_path / "s.toml").read_text(), re.M)
    assert "its thread is not known" in done.output
    with pytest.raises(faying.InputError, match="preload is missing"):
        Study.read(tmp_path / "s.toml")


def test_the_force_counts_by_the_set_of_its_node_and_the_last_step(tmp_path, mesh):
    load = "*NSET, NSET=pull\n9001\n*STEP\n*STATIC\n*CLOAD\npull, 1, 1000.\n*END STEP\n*STEP\n*CLOAD\nPULL, 1, 2500.\n"
    assert proposed(tmp_path, deck(mesh, load=load))[0].loads == (2500.0,)


def test_a_bolt_without_named_seats_and_a_beam_are_said_and_not_proposed(tmp_path, mesh):
    text = re.sub(r"\*ELSET, ELSET=_bolt0.head.*?\*ELSET", "*ELSET", deck(mesh), flags=re.S)
    text += "*ELEMENT, TYPE=B31, ELSET=rod\n7001, 100, 103\n*PRE-TENSION SECTION, ELEMENT=7001, NODE=9001\n"
    study_text = tmp_path / "s.toml"
    (tmp_path / "m.inp").write_text(text)
    done = call("new", tmp_path / "m.inp", "--unit", "mm", "--yes", "--out", study_text)
    assert done.exception is None, done.output
    assert "the bolt 'bolt0' has no named faces that touch other parts under its head and its nut" in done.output
    assert "no solid holds it, as of a beam" in done.output
    assert "\n[[bolt]]" not in study_text.read_text()


def test_the_halves_of_a_bolt_that_prets179_hold_are_one_part(tmp_path):
    """Two cubes on each other that four PRETS179 join are one column of the volume of both."""
    square = [(0, 0), (20, 0), (20, 20), (0, 20)]
    places = [(*square[k % 4], 10.0 * (k // 4)) for k in range(8)] + [
        (*square[k % 4], 10.0 + 10 * (k // 4)) for k in range(8)
    ]
    plate = [(x + 20, y, z) for x, y, z in places[:8]]
    rows = [*places, (10, 10, 10), *plate]
    head = f"ET,1,185\nET,2,179\nNBLOCK,6,SOLID,{len(rows)},{len(rows)}\n(3i9,6e21.13e3)\n"
    nodes = "".join(f"{k:9d}{0:9d}{0:9d}" + "".join(f"{v:21.13E}" for v in at) + "\n" for k, at in enumerate(rows, 1))
    solid = [(1, range(1, 9)), (2, range(9, 17)), (7, range(18, 26))]
    lines = [[1, 1, 1, 1, 0, 0, 0, 0, 8, 0, number, *some] for number, some in solid]
    lines += [[1, 2, 1, 3, 0, 0, 0, 0, 3, 0, 3 + k, 5 + k, 9 + k, 17] for k in range(4)]
    elements = f"EBLOCK,19,SOLID,7,{len(lines)}\n(19i9)\n" + "".join(
        "".join(f"{w:9d}" for w in row) + "\n" for row in lines
    )
    text = f"{head}{nodes}N,R5.3,LOC,-1,\n{elements}       -1\nSECTYPE,3,PRETENSION\nSECDATA,17,0,0,1\n"
    text += "SLOAD,3,PL01,LOCK,FORC,1200,1,2\n"
    path = tmp_path / "b.cdb"
    path.write_text(text)
    apart = faying.read_mesh(path, unit="mm")
    assert [len(apart.part_nodes(part)) for part in apart.parts] == [8, 8, 8]
    ((section, parts),) = read_pretensions(path, apart)
    assert parts == ("part1", "part2")
    assert (section.axis, section.force) == ((0, 0, 1), 1200)
    one = faying.read_mesh(path, unit="mm", parts={"bolt": "part1 + part2", "plate": "part3"})
    assert len(one.part_nodes("bolt")) == 12
    assert one.volumes["bolt"] == pytest.approx(8e-6)
    assert "4 pairs of its nodes one" in one.notes[-1].text + one.notes[0].text
    assert read_pretensions(path, one)[0][1] == ("bolt",)


@pytest.fixture
def screwed(mesh):
    """The bolt screwed into the lower plate: the mesh is one there, and no face is named between them."""
    from dataclasses import replace

    one = mesh.bonded_at(("bolt0.nut", "lower.seat0"))
    gone = ("bolt0.nut", "lower.seat0", "bolt0.shank")
    kept = {name: some for name, some in one.faces.items() if name not in gone}
    return replace(one, faces=kept, face_part={name: one.face_part[name] for name in kept})


def test_a_bolt_that_shares_nodes_with_what_it_is_screwed_into(tmp_path, screwed):
    """The tension that its seat carries is the force of the deck, whatever holds its other end."""
    study, _ = proposed(tmp_path, deck(screwed))
    (bolt,) = study.bolts
    assert bolt.faces == ("bolt0.head", "bolt0.lower")
    assert {frozenset(joint.faces) for joint in study.joints} == {
        frozenset(("lower.joint", "upper.joint")),
        frozenset(("bolt0.head", "upper.seat0")),
    }
    whole = checked_mesh(study)
    assert whole.bodies == (("lower", "bolt0"), ("upper",))
    joints = [faying.Joint(("lower.joint", "upper.joint"), LAW), faying.Joint(("bolt0.head", "upper.seat0"), LAW)]
    state = faying.Structure(whole, "45 steel", joints, [bolt]).solve("5 kN", modes=1)
    forces = [joint.interface.weights @ state.pressures[joint.name] for joint in state.structure.joints]
    assert forces == pytest.approx([5000, 5000], rel=1e-5)
    with pytest.raises(faying.InputError, match="'bolt0.lower' is one with another part, so that nothing moves there"):
        faying.Structure(whole, "45 steel", [*joints, faying.Joint(("bolt0.lower", "lower.bolt0"), LAW)], [bolt])


def test_the_joint_under_a_head_carries_the_force_of_its_bolt_once(tmp_path, mesh):
    """In a turned assembly the depth of the seat below the head is rounding, above zero as often as below."""
    from dataclasses import replace

    from scipy.spatial.transform import Rotation

    proposed(tmp_path, deck(mesh))
    for angle in np.linspace(0.1, 1.2, 6):
        turned = replace(mesh, points=mesh.points @ Rotation.from_rotvec([angle, 0.3, 0.2]).as_matrix().T)
        (tmp_path / "m.inp").write_text(meshfiles.abaqus(turned))
        study = (tmp_path / "s.toml").read_text()
        middle = ", ".join(
            f'"{1e3 * x:.9g} mm"' for x in Rotation.from_rotvec([angle, 0.3, 0.2]).apply([0.02, 0.02, 0.01])
        )
        (tmp_path / "t.toml").write_text(re.sub(r"^at = .*", f"at = [{middle}]", study, flags=re.M))
        out = " ".join(call("check", tmp_path / "t.toml").output.split())
        assert len(re.findall(r"5 kN on [\d.,]+ mm2 press", out)) == 3
        assert "10 kN" not in out


def test_a_unit_goes_with_a_mesh_file_alone(tmp_path, mesh):
    (tmp_path / "m.inp").write_text(deck(mesh))
    done = call("new", tmp_path / "m.inp", "--yes", "--out", tmp_path / "s.toml")
    assert isinstance(done.exception, faying.InputError)
    assert 'unit = "mm"' in str(done.exception)
    done = call("new", tmp_path / "a.step", "--unit", "mm", "--yes", "--out", tmp_path / "s.toml")
    assert "a STEP file states its unit" in str(done.exception)


def test_round_faces_that_touch_are_not_said_to_be_apart(tmp_path):
    """A ring in a ring: a joint is proposed for flat faces alone, and the words must not deny the others."""
    points, parts, faces, offset = [], {}, {}, 0
    for name, radii in (("inner", (5e-3, 10e-3)), ("outer", (10e-3, 15e-3))):
        where, cells = disc(radii, 24, (0, 5e-3))
        on = np.flatnonzero(np.abs(np.hypot(*where[:, :2].T) - 10e-3) < 1e-9)
        faces[f"{name}.wall"] = tuple(side + offset for side in sides_on(on, (cells,), len(where)))
        parts[name] = (cells + offset,)
        points.append(where)
        offset += len(where)
    owner = {face: face.partition(".")[0] for face in faces}
    rings = Mesh(points=np.concatenate(points), parts=parts, faces=faces, face_part=owner)
    (tmp_path / "m.inp").write_text(meshfiles.abaqus(rings))
    done = call("new", tmp_path / "m.inp", "--unit", "mm", "--yes", "--out", tmp_path / "s.toml")
    assert "0 joints" in done.output
    assert "no two flat named faces touch" in done.output
    assert "No two named faces" not in (tmp_path / "s.toml").read_text()
