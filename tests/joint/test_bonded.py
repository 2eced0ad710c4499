"""Welded and glued faces: a body cut in two and bonded again is that body; what cannot be bonded is refused."""

import re

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.linalg import eigh

import faying
from faying.case.case import build, checked_mesh
from faying.cli.main import cli
from faying.fe.bonded import bonded_mesh
from faying.fe.elasticity import assemble
from faying.fe.mesh import Mesh
from faying.numerics.solve import BY_PARTS
from faying.reduction.part_shares import PartShares
from faying.study import Study
from tests.geometry.test_face_facts import box, written
from tests.helpers.boxes import row

STEEL = faying.CATALOGUE["S355"]
SEAM = [("seam", ("p0.right", "p1.left"))]


def boxes(lengths, counts, **more):
    """A row of boxes of 20 x 20 mm, from lengths [mm]."""
    made = row([1e-3 * x for x in lengths], counts, kinds=("hex20",) * len(counts), width=0.02, height=0.02, **more)
    return made if isinstance(made, Mesh) else Mesh(**made)


def frequencies(mesh, materials):
    K, M = assemble(mesh, materials)
    values = eigh(K.toarray(), M.toarray(), eigvals_only=True, subset_by_index=(0, 13))
    return np.sqrt(np.maximum(values[6:], 0)) / (2 * np.pi)


def test_a_body_cut_in_two_and_bonded_is_that_body():
    cut = boxes((30, 50), (2, 3), sections=((2, 2),) * 2)
    joined = bonded_mesh(cut, SEAM)
    one = boxes((80,), (5,), sections=((2, 2),))
    # nodes of the two meshes do not lie at the same places along x: the same ones by moving them
    one = Mesh(points=_moved(one.points), parts=one.parts, faces=one.faces, face_part=one.face_part)
    assert joined.unknowns == one.unknowns
    assert joined.bodies == (("p0", "p1"),)
    assert cut.bodies == (("p0",), ("p1",))
    same = frequencies(joined, dict.fromkeys(("p0", "p1"), STEEL))
    assert same == pytest.approx(frequencies(one, {"p0": STEEL}), rel=1e-6)
    assert joined.volumes == pytest.approx(cut.volumes)
    again = cut.bonded_at(SEAM[0][1])
    assert np.array_equal(again.points, joined.points)
    assert again.bonded == joined.bonded == (("p0", "p1"),)


def _moved(points):
    """Cells of 16 mm along x to two of 15 mm and three of 50/3 mm."""
    x = np.interp(points[:, 0], 16e-3 * np.arange(6), [0, 15e-3, 30e-3, *(30e-3 + 50e-3 / 3 * np.arange(1, 4))])
    return np.column_stack([x, points[:, 1:]])


@pytest.mark.parametrize("solver", [None, BY_PARTS])
def test_a_joint_on_a_bonded_body_is_that_on_the_body(solver):
    """Frequencies of p0 and p1 bonded, pulled on p2, against those of one body in their place."""
    mates = faying.Mates.of_fractal(D=2.39, G="1.53e-10 m", scan_area="16 mm^2", materials="S355")
    law = mates.law("jk")
    cut = bonded_mesh(boxes((30, 30, 40), (2, 2, 2), sections=((2, 2),) * 3), SEAM)
    uncut = boxes((60, 40), (4, 2), sections=((2, 2),) * 2)
    states = []
    for mesh, last in ((cut, 2), (uncut, 1)):
        joint = faying.Joint((f"p{last - 1}.right", f"p{last}.left"), law)
        bolt = faying.Bolt("bolt", ("p0.left", f"p{last}.right"))
        structure = faying.Structure(mesh, "S355", [joint], [bolt])
        states.append(structure.solve("4 kN", modes=4, solver=solver))
    first, second = states
    assert first.modes.frequencies == pytest.approx(second.modes.frequencies, rel=1e-6)
    pressures = [np.sort(state.pressures["joint 1"]) for state in states]
    assert pressures[0] == pytest.approx(pressures[1], rel=1e-6)


def test_shares_of_bonded_parts_add_up_to_the_whole():
    mesh = bonded_mesh(boxes((30, 30, 40), (2, 2, 2), sections=((2, 2),) * 3), SEAM)
    mates = faying.Mates.of_fractal(D=2.39, G="1.53e-10 m", scan_area="16 mm^2", materials="S355")
    joint = faying.Joint(("p1.right", "p2.left"), mates.law("jk"))
    structure = faying.Structure(mesh, "S355", [joint], [faying.Bolt("bolt", ("p0.left", "p2.right"))])
    shares = PartShares.of(structure, list(mesh.parts))
    for parts, total in ((shares.stiffness, structure.matrices[0]), (shares.mass, structure.matrices[1])):
        assert abs(sum(parts) - total).max() <= 1e-12 * abs(total).max()


@pytest.mark.parametrize("solver", [None, BY_PARTS])
def test_a_joint_on_tied_parts_is_that_on_bonded_ones(solver):
    """Parts meshed apart with 2 and 3 elements across, beside both with 3: preload, pressure and modes."""
    mates = faying.Mates.of_fractal(D=2.39, G="1.53e-10 m", scan_area="16 mm^2", materials="S355")
    joint = faying.Joint(("p1.right", "p2.left"), mates.law("jk"))
    bolt = faying.Bolt("bolt", ("p0.left", "p2.right"))
    states = []
    for first in (2, 3):
        mesh = bonded_mesh(boxes((30, 30, 40), (2, 2, 2), sections=((first, first), (3, 3), (3, 3))), SEAM)
        assert (len(mesh.ties), mesh.bodies) == (int(first == 2), (("p0", "p1"), ("p2",)))
        assert mesh.notes[0].code == "bonded"
        assert ("do not match" in mesh.notes[0].text) == (first == 2)
        states.append(faying.Structure(mesh, "S355", [joint], [bolt]).solve("4 kN", modes=4, solver=solver))
    tied, one = states
    assert tied.modes.frequencies == pytest.approx(one.modes.frequencies, rel=3e-3)
    assert np.sort(tied.pressures["joint 1"]) == pytest.approx(np.sort(one.pressures["joint 1"]), rel=2e-2)


def test_what_cannot_be_bonded_is_refused():
    mesh = boxes((30, 50), (2, 3), sections=((2, 2),) * 2)
    with pytest.raises(faying.InputError, match="both faces are on part 'p0'"):
        bonded_mesh(mesh, [("seam", ("p0.left", "p0.right"))])
    joined = bonded_mesh(mesh, SEAM)
    with pytest.raises(faying.InputError, match="shares nodes with another part"):
        Mesh(points=joined.points, parts=joined.parts, faces=joined.faces, face_part=joined.face_part)


@pytest.fixture(scope="module")
def welded(tmp_path_factory):
    """A rib on the middle of a plate, and a plate below them that a joint takes; a bolt next to the rib."""
    path = tmp_path_factory.mktemp("welded") / "welded.step"
    written(
        path,
        box((0, 0, 0), (60, 40, 10), "low"),
        box((0, 0, 10), (60, 40, 20), "plate"),
        box((20, 15, 20), (40, 25, 40), "rib"),
    )
    out = path.with_suffix(".toml")
    CliRunner().invoke(cli, ["new", str(path), "--yes", "--out", str(out)], catch_exceptions=False)
    text = re.sub(r'^size = "[^"]*"', 'size = "10 mm"', out.read_text(), flags=re.M)
    bolt = """[[bolt]]
name = "bolt"
faces = [{ part = "plate", normal = "+z" }, { part = "low", normal = "-z" }]
at = ["10 mm", "10 mm", "0 mm"]
seat = ["0 mm", "12 mm"]
preload = "5 kN"
"""
    out.write_text(text.replace('model = "auto"', 'model = "jk"') + bolt)
    return out


def bonded(welded, name, words="bonded = true\n"):
    out = welded.with_name(name)
    joint = re.search(r"\[\[joint\]\]\nname = \"joint 2\"\n", welded.read_text())
    out.write_text(welded.read_text().replace(joint[0], joint[0] + words))
    return out


@pytest.mark.slow
def test_a_rib_is_welded_by_a_word_in_the_study(welded):
    study = Study.read(bonded(welded, "weld.toml"))
    assert [joint.name for joint in study.joints] == ["joint 1"]
    assert [bond.name for bond in study.bonds] == ["joint 2"]
    mesh = checked_mesh(study)
    assert mesh.bodies == (("low",), ("plate", "rib"))
    shared = np.intersect1d(mesh.part_nodes("plate"), mesh.part_nodes("rib"))
    places = 1e3 * mesh.points[shared]
    assert places.min(axis=0) == pytest.approx([20, 15, 20])
    assert places.max(axis=0) == pytest.approx([40, 25, 20])
    assert [note.code for note in build(study).notes].count("bonded") == 1
    done = CliRunner().invoke(cli, ["check", str(welded.with_name("weld.toml"))], standalone_mode=False)
    assert done.return_value == 0, done.output
    assert "its faces are bonded over 200 mm2" in " ".join(done.output.split())


def test_a_bonded_joint_takes_nothing_else(welded):
    out = bonded(welded, "law.toml", "bonded = true\nfriction = 0.2\n")
    with pytest.raises(faying.InputError, match=r"joint 'joint 2' is bonded, so that it .*; leave friction out"):
        Study.read(out)


def test_check_and_run_refuse_a_part_in_no_joint_alike(welded):
    out = welded.with_name("loose.toml")
    text = welded.read_text()
    begin = text.index('[[joint]]\nname = "joint 2"')
    out.write_text(text[:begin] + text[text.index("\n\n", begin) :])
    with pytest.raises(faying.InputError, match="part rib has no joint") as refused:
        build(Study.read(out))
    done = CliRunner().invoke(cli, ["check", str(out)], standalone_mode=False)
    assert done.return_value == 1
    fault = str(refused.value).splitlines()[-1].removeprefix("  - ")
    assert fault in " ".join(done.output.split())
