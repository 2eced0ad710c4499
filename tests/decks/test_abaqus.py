"""What an Abaqus deck can do to the places of its nodes, and what a damaged one must not do."""

import os

import numpy as np
import pytest

import faying
from faying.fe.sides import nodes_of, skin
from tests.decks.test_meshfile import same, two, written
from tests.helpers import meshfiles

TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])  # rows: axes of a local system
ORIGIN = np.array([12.0, -7.0, 3.0])  # mm


@pytest.fixture
def blocks():
    return two(gap=1e-4)


def lines_of(points):
    return [", ".join(f"{x:.12g}" for x in row) for row in points]


def with_nodes(mesh, some):
    """The deck of a mesh, its nodes written by some(numbers, places in mm)."""
    text = meshfiles.abaqus(mesh)
    head, rest = text.split("*Node, nset=NALL\n")[0], text[text.index("*Element") :]
    return head + "\n".join(some(meshfiles.numbers(mesh), mesh.points * 1e3)) + "\n" + rest


@pytest.mark.parametrize("kind", ["shifted", "about z", "any"])
def test_nodes_in_a_local_system_are_turned_and_moved(tmp_path, blocks, kind):
    """*System holds until the next one; one point moves, two turn about the global z, three give the xy plane."""
    if kind == "any":
        turn, given = TURN, [ORIGIN, ORIGIN + 5 * TURN[0], ORIGIN + 2 * TURN[1] + 7 * TURN[0]]
    elif kind == "about z":
        c, s = np.cos(0.7), np.sin(0.7)
        turn = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
        given = [ORIGIN, ORIGIN + 4 * turn[0]]
    else:
        turn, given = np.eye(3), [ORIGIN]

    def some(numbers, places):
        half = len(numbers) // 2
        local = (places - ORIGIN) @ turn.T
        flat = ", ".join(f"{x:.12g}" for x in np.ravel(given))
        words = flat.split(", ")
        system = [", ".join(words[:6]), *([", ".join(words[6:])] if len(words) > 6 else [])]
        rows = ["*System", *system, "*Node"]
        rows += [f"{n}, {x}" for n, x in zip(numbers[:half], lines_of(local), strict=False)]
        rows += ["*System", "*Node"]
        return rows + [f"{n}, {x}" for n, x in zip(numbers[half:], lines_of(places[half:]), strict=True)]

    same(faying.read_mesh(written(tmp_path, with_nodes(blocks, some), "m.inp"), unit="mm"), blocks)


def test_nodes_in_cylindrical_coordinates(tmp_path, blocks):
    def some(numbers, places):
        polar = np.column_stack(
            [np.hypot(places[:, 0], places[:, 1]), np.rad2deg(np.arctan2(places[:, 1], places[:, 0])), places[:, 2]]
        )
        return ["*NODE, SYSTEM=C", *(f"{n}, {x}" for n, x in zip(numbers, lines_of(polar), strict=True))]

    same(faying.read_mesh(written(tmp_path, with_nodes(blocks, some), "m.inp"), unit="mm"), blocks)
    text = with_nodes(blocks, some).replace("SYSTEM=C", "SYSTEM=S")
    fault(tmp_path, text, r"\*NODE, SYSTEM=S is not known; write the nodes in R or C")


def test_nodes_from_a_file_of_their_own(tmp_path, blocks):
    rows = []

    def some(numbers, places):
        rows.extend(f"{n}, {x}" for n, x in zip(numbers, lines_of(places), strict=True))
        return ["*NODE, INPUT=nodes.txt"]

    text = with_nodes(blocks, some)
    written(tmp_path, "** nodes\n" + "\n".join(rows), "nodes.txt")
    same(faying.read_mesh(written(tmp_path, text, "m.inp"), unit="mm"), blocks)


def fault(tmp_path, text, match, kind=faying.ReadError):
    with pytest.raises(kind, match=match):
        faying.read_mesh(written(tmp_path, text, "m.inp"), unit="mm")


@pytest.mark.parametrize(
    ("more", "match"),
    [
        ("*NCOPY, CHANGE NUMBER=100, OLD SET=NALL, SHIFT\n1., 0., 0.\n", r"\*NCOPY makes nodes or elements"),
        ("*ELGEN\n1, 3\n", r"\*ELGEN makes nodes or elements"),
        ("*SYSTEM\n1., 2.\n", r"\*SYSTEM has 2 numbers"),
        ("*SYSTEM\n0, 0, 0, 1, 0, 0\n2, 0, 0\n", r"coincide or are on one line"),
        ("*NODE\n100, 9., 9., 9.\n", "node 100 is given twice, at different places"),
        ("*NODE\n9000, 1,5, 2,5, 3,5\n", "node 9000 has more than three coordinates; a number has a decimal point"),
        ("*NODE\n9000, 1,5, 2,5, 3,5, 1\n", "node 9000 has 7 finite numbers"),
        ("*NODE\n9000, nan, 0, 0\n", "node 9000 has 3 finite numbers"),
        ("*NODE\n9000, 1e400, 0, 0\n", "node 9000 has 3 finite numbers"),
        ("*NODE\n-3, 1., 0, 0\n", "node -3: numbers of nodes are between 1 and"),
        ("*NODE\n1" + 30 * "0" + ", 1., 0, 0\n", "is none of a node or an element"),
        ("*ELEMENT, TYPE=C3D4\n-5, 100, 103, 106, 109\n", "element -5: numbers of elements are between 1"),
        ("*NSET, NSET=x, GENERATE\n1, 1000000000000\n", "a range from 1 to 1000000000000 by 1"),
        ("*NSET, NSET=x, GENERATE\n1, 1e12\n", "something that is not a number"),
        ("*NSET, NSET=x, GENERATE\n9, 1\n", "a range from 9 to 1"),
        ("*NSET, NSET=x, GENERATE\n1, 9, 0\n", "a range from 1 to 9 by 0"),
        ("*NSET, NSET=x\nx\n", "names the set 'x', which is not in the file or is part of it"),
        ("*ELEMENT, TYPE=C3D8I\n", "0 numbers do not make elements of 8 nodes; is the file complete"),
        ("*ELEMENT, TYPE=C3D4,", "the file ends within a keyword; is it complete?"),
        ("*SURFACE, TYPE=CUTTING SURFACE, NAME=x\n1, S1\n", r"\*SURFACE of this type is not known"),
    ],
)
def test_faults(tmp_path, blocks, more, match):
    fault(tmp_path, meshfiles.abaqus(blocks) + more, match)


def test_a_node_given_twice_at_one_place_is_one_node(tmp_path, blocks):
    text = meshfiles.abaqus(blocks)
    begin = text.index("\n", text.index("*Node")) + 1
    again = text[begin : text.index("\n", begin) + 1]
    same(faying.read_mesh(written(tmp_path, text + "*NODE\n" + again, "m.inp"), unit="mm"), blocks)


@pytest.mark.parametrize(
    ("end", "match"),
    [
        ("*End Assembly", r"ends without \*END ASSEMBLY; the file is cut short"),
        ("*End Instance", r"ends without \*END INSTANCE"),
        ("*Assembly", r"ends without \*ASSEMBLY"),
        ("*End Part", r"ends without \*END PART"),
    ],
)
def test_a_deck_cut_at_a_keyword_is_refused(tmp_path, blocks, end, match):
    text = meshfiles.assembly(blocks)
    fault(tmp_path, text[: text.rindex(end)], match)


def test_a_deck_without_an_end_of_line_is_noted(tmp_path, blocks):
    mesh = faying.read_mesh(written(tmp_path, meshfiles.abaqus(blocks)[:-1], "m.inp"), unit="mm")
    assert ["it may be cut short" in note.text for note in mesh.notes] == [True]
    assert not faying.read_mesh(written(tmp_path, meshfiles.abaqus(blocks), "m.inp"), unit="mm").notes


@pytest.mark.parametrize("keyword", ["NSET, NSET=x", "ELSET, ELSET=x", "SURFACE, NAME=x", "NODE"])
def test_a_keyword_without_its_data_is_noted(tmp_path, blocks, keyword):
    """What a deck cut between keyword and data looks like."""
    text = meshfiles.abaqus(blocks) + f"*{keyword}\n"
    mesh = faying.read_mesh(written(tmp_path, text, "m.inp"), unit="mm")
    assert ["has no data lines: the file may be cut short" in note.text for note in mesh.notes] == [True]


def test_includes_without_end(tmp_path, blocks):
    for k in range(20):
        written(tmp_path, f"*INCLUDE, INPUT=part{k + 1}.inp\n" * 2, f"part{k}.inp")
    written(tmp_path, "", "part20.inp")
    fault(tmp_path, "*INCLUDE, INPUT=part0.inp\n", "more than 500 files are included")
    os.mkfifo(tmp_path / "pipe")
    fault(tmp_path, "*INCLUDE, INPUT=pipe\n", "it is not a regular file")


def test_sets_of_instances_that_are_generated_or_named(tmp_path, blocks):
    """*NSET, INSTANCE=..., GENERATE and a set of the part, where the numbers of both instances clash."""
    text = meshfiles.assembly(blocks)
    last = {part: len(blocks.part_nodes(part)) for part in blocks.parts}
    first = text.index("*Elset, elset=all")
    text = text[:first] + f"*Nset, nset=Mine, generate\n1, {last['p0']}\n" + text[first:]
    more = [f"*Nset, nset=whole-{part}, instance={part}, generate\n1, {count}\n" for part, count in last.items()]
    more.append("*Nset, nset=named, instance=p0\nmine\n")
    mesh = faying.read_mesh(
        written(tmp_path, text.replace("*End Assembly", "".join(more) + "*End Assembly"), "m.inp"), unit="mm"
    )
    for part in blocks.parts:
        outside = nodes_of(skin(mesh.parts[part], len(mesh.points)))
        assert np.array_equal(mesh.face_nodes(f"whole-{part}"), outside)
        assert mesh.face_part[f"whole-{part}"] == part
    assert np.array_equal(mesh.face_nodes("named"), mesh.face_nodes("whole-p0"))


def test_an_independent_instance_is_moved_with_its_own_nodes(tmp_path, blocks):
    """Abaqus/CAE writes the mesh of an independent instance into the instance; its part is empty."""
    text = meshfiles.assembly(blocks)
    for part in blocks.parts:
        begin = text.index(f"*Part, name={part}-part\n") + len(f"*Part, name={part}-part\n")
        end = text.index("*End Part", begin)
        body = text[begin:end]
        text = text[:begin] + text[end:]
        at = text.index("*End Instance", text.index(f"*Instance, name={part},"))
        text = text[:at] + body + text[at:]
    mesh = faying.read_mesh(written(tmp_path, text, "m.inp"), unit="mm")
    same(mesh, blocks, lambda name: name.replace(".", "-"))


def test_reference_points_are_left_out_by_name(tmp_path, blocks):
    """A point of the assembly has number 1, as the first nodes of both instances have."""
    text = meshfiles.assembly(blocks)
    more = "*Node\n1, 5., 5., 50.\n*Nset, nset=RP\n1\n*Element, type=MASS, elset=m\n1, 1\n*Mass, elset=m\n2.\n"
    more += "*Coupling, constraint name=c, ref node=RP, surface=s\n*Kinematic\n"
    at = text.index("*Instance")
    mesh = faying.read_mesh(written(tmp_path, text[:at] + more + text[at:], "m.inp"), unit="mm")
    same(mesh, blocks, lambda name: name.replace(".", "-"))
    assert any("1 elements MASS are left out" in note.text for note in mesh.notes)
    without = more[: more.index("*Element")] + more[more.index("*Coupling") :]
    mesh = faying.read_mesh(written(tmp_path, text[:at] + without + text[at:], "m.inp"), unit="mm")
    assert [note.code for note in mesh.notes] == ["reference-points", "file"]
    assert "*COUPLING (1), *KINEMATIC (1): couplings and constraints are left out" in mesh.notes[1].text
    assert "1 reference points are left out, with the couplings that name them: 1" in mesh.notes[0].text


def test_both_kinds_of_a_surface_count(tmp_path, blocks):
    """A surface of one set with its side and of another set as a whole has the sides of both."""
    text = meshfiles.abaqus(blocks)
    text += "*ELSET, ELSET=whole\np1\n*SURFACE, NAME=both, TYPE=ELEMENT\n_p0.left_S6, S6\nwhole,\n"
    mesh = faying.read_mesh(written(tmp_path, text, "m.inp"), unit="mm")
    assert {mesh.face_part[name] for name in mesh.faces if "both" in name} == {"p0", "p1"}
