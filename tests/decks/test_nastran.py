"""Coordinate systems, skins, constraints and damage in Nastran bulk data."""

import numpy as np
import pytest

import faying
from faying.decks.nastran import card
from faying.decks.raw import UPRIGHT_FIRST
from faying.fe.elements import KINDS
from faying.fe.sides import face_centre
from tests.decks.test_meshfile import same, two, written
from tests.helpers import meshfiles

TURN = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])  # rows: axes of a local system
ORIGIN = np.array([12.0, -7.0, 3.0])  # mm


@pytest.fixture
def blocks():
    return two(gap=1e-4)


def deck(mesh, grids, more=()):
    """Bulk data with other GRID cards: grids(numbers, places in mm)."""
    rest = meshfiles.nastran(mesh, field="large").splitlines()
    keep, skip = [], False
    for line in rest:
        if line.startswith("GRID*"):
            skip = True
            continue
        if skip and line.startswith("*"):
            continue
        skip = False
        keep.append(line)
    at = next(i for i, line in enumerate(keep) if "BEGIN BULK" in line) + 1
    new = grids(meshfiles.numbers(mesh).tolist(), mesh.points * 1e3)
    return "\n".join([*keep[:at], *new, *more, *keep[at:]]) + "\n"


def alike(found, mesh):
    """`same`, under the names that the deck gives."""
    face = {name: f"PLOAD4_{k + 1}" for k, name in enumerate(mesh.faces)}
    same(found, mesh, face.get, {"p0": "part1", "p1": "part2"}, digits=1e-8)


def read(tmp_path, text):
    return faying.read_mesh(written(tmp_path, text, "m.bdf"), unit="mm")


def local(kind, places):
    """Coordinates in a system of ORIGIN and TURN, of kind R, C or S."""
    x, y, z = ((places - ORIGIN) @ TURN.T).T
    if kind == "R":
        return np.column_stack([x, y, z])
    around = np.rad2deg(np.arctan2(y, x))
    if kind == "C":
        return np.column_stack([np.hypot(x, y), around, z])
    r = np.sqrt(x**2 + y**2 + z**2)
    return np.column_stack([r, np.rad2deg(np.arccos(z / r)), around])


def system(kind, number=5, reference=0, origin=ORIGIN, turn=TURN):
    points = [origin, origin + 3 * turn[2], origin + 2 * turn[0] + 4 * turn[2]]
    return card(f"CORD2{kind}", number, reference, *(float(x) for x in np.ravel(points)))


@pytest.mark.parametrize("kind", "RCS")
@pytest.mark.parametrize("how", ["CP", "GRDSET"])
def test_grids_in_a_local_system(tmp_path, blocks, kind, how):
    def grids(numbers, places):
        cp = 5 if how == "CP" else ""
        return [
            row
            for n, p in zip(numbers, local(kind, places), strict=True)
            for row in card("GRID", n, cp, *map(float, p))
        ]

    more = [*system(kind), *(["GRDSET,,5"] if how == "GRDSET" else [])]
    alike(read(tmp_path, deck(blocks, grids, more)), blocks)


def test_a_system_in_a_system_and_one_of_grids(tmp_path, blocks):
    """CORD2R 6 is given in the cylindrical 5; CORD1R 7 by three grids, the first of them the place of 6."""

    def grids(numbers, places):
        half = len(numbers) // 2
        out = [
            row
            for n, p in zip(numbers[:half], local("R", places[:half]), strict=True)
            for row in card("GRID", n, 6, *map(float, p))
        ]
        out += [
            row
            for n, p in zip(numbers[half:], local("R", places[half:]), strict=True)
            for row in card("GRID", n, 7, *map(float, p))
        ]
        for n, p in ((90001, ORIGIN), (90002, ORIGIN + TURN[2]), (90003, ORIGIN + TURN[0])):
            out += card("GRID", n, "", *map(float, p))
        return [*out, "RBE2,90,90001,123,90002,90003"]

    # the points of 6 in the system 5, which is cylindrical about the axes of the model through (1, 2, 0)
    base = np.array([1.0, 2.0, 0.0])
    points = np.array([ORIGIN, ORIGIN + 3 * TURN[2], ORIGIN + 2 * TURN[0]]) - base
    polar = np.column_stack(
        [np.hypot(points[:, 0], points[:, 1]), np.rad2deg(np.arctan2(points[:, 1], points[:, 0])), points[:, 2]]
    )
    more = [
        *system("C", 5, 0, base, np.eye(3)),
        *card("CORD2R", 6, 5, *map(float, polar.ravel())),
        "CORD1R,7,90001,90002,90003",
    ]
    more += ["SET1,91,90002", "SET1,92,90003"]
    alike(read(tmp_path, deck(blocks, grids, more)), blocks)


def plain(numbers, places):
    return [row for n, p in zip(numbers, places, strict=True) for row in card("GRID", n, "", *map(float, p))]


@pytest.mark.parametrize(
    ("more", "match"),
    [
        (["GRDSET,,5"], "coordinate system 5 is not in the file"),
        (
            ["GRDSET,,5", "CORD2R,5,5,0.,0.,0.,0.,0.,1.", "+,1.,0.,0."],
            "coordinate system 5 is not in the file, or is given by itself",
        ),
        (
            ["GRDSET,,5", "CORD2R,5,,0.,0.,0.,0.,0.,1.", "+,0.,0.,2."],
            "coordinate system 5: its three points coincide or are on one line",
        ),
        (["CORD3G,5,E123,1,1,1"], "CORD3G is not known"),
        (["GRID,100,,9.,9.,9."], "GRID 100 is given twice, at different places"),
        (["GRID,90001,,1,0,2,0,3,0"], "GRID 90001 has more than three coordinates; a number has a decimal point"),
        (["GRID,90001,,1,5,2,5,3,5,6,7"], "10 fields, 8 fit; a number has a decimal point, not a comma"),
        (["GRID,-4,,1.,2.,3."], "node -4: numbers of nodes are between 1 and"),
        (["GRID,90001,,1.E+999,2.,3."], "node 90001 has no three finite coordinates"),
        (["GRID,1" + 25 * "0" + ",,1.,2.,3."], "is none of a node or an element"),
        (["INCLUDE 'm.bdf'"], "includes itself"),
        (["CTRIA3"], "CTRIA3  has no 3 corners"),
        (["CQUAD8,7,1,100,,103,106,109"], "CQUAD8 7 has no 4 corners"),
    ],
)
def test_faults(tmp_path, blocks, more, match):
    with pytest.raises(faying.ReadError, match=match):
        read(tmp_path, deck(blocks, plain, more))


def test_a_deck_without_its_end_is_refused(tmp_path, blocks):
    text = deck(blocks, plain)
    assert "ENDDATA" in text
    alike(read(tmp_path, text), blocks)
    with pytest.raises(faying.ReadError, match="ends without ENDDATA; the file is cut short"):
        read(tmp_path, text.replace("ENDDATA", ""))
    bulk = text[text.index("BEGIN BULK") + len("BEGIN BULK") :].replace("ENDDATA", "")
    assert ["no ENDDATA: it may be cut short" in note.text for note in read(tmp_path, bulk).notes] == [True]


def test_includes_without_end(tmp_path):
    for k in range(20):
        written(tmp_path, f"INCLUDE 'part{k + 1}.bdf'\n" * 2, f"part{k}.bdf")
    written(tmp_path, "", "part20.bdf")
    with pytest.raises(faying.ReadError, match="more than 500 files are included"):
        read(tmp_path, "INCLUDE 'part0.bdf'\n")


@pytest.mark.parametrize("kinds", [("hex8", "tet4"), ("hex20", "tet10")])
def test_skins_are_faces(tmp_path, kinds):
    """Shells of one property on the joint of each part; others on no solid are left out with a note."""
    mesh = two(kinds, gap=1e-4)
    n = meshfiles.numbers(mesh)
    names = {3: "CTRIA3", 4: "CQUAD4", 6: "CTRIA6", 8: "CQUAD8"}
    skins, number = [], 70000
    for pid, face in ((31, "p0.right"), (32, "p1.left")):
        for block in mesh.face(face):
            for nodes in block:
                number += 1
                words = [number, pid, *n[nodes].tolist()]
                skins += [
                    ",".join(map(str, [names[len(nodes)] if k == 0 else "+", *words[k : k + 8]]))
                    for k in range(0, len(words), 8)
                ]
    loose = [
        *plain([90001, 90002, 90003], np.array([[0.0, 50, 0], [9, 50, 0], [0, 59, 0]])),
        "CTRIA3,90001,33,90001,90002,90003",
    ]
    found = read(tmp_path, deck(mesh, plain, [*skins, *loose]))
    for pid, face in ((31, "p0.right"), (32, "p1.left")):
        assert found.face_part[f"face{pid}"] == f"part{pid - 30}"
        assert sum(map(len, found.face(f"face{pid}"))) == sum(map(len, mesh.face(face)))
    assert [note.text for note in found.notes] == [
        "1 shells 'face33' are not on a solid and are left out, with their stiffness and mass"
    ]


def test_constraints_are_left_out_by_name(tmp_path, blocks):
    more = [
        *plain([90001], np.array([[0.0, 50.0, 0.0]])),
        "RBE3,80001,,90001,123456,1.0,123,100,103",
        "CONM2,80002,90001,,1.5",
    ]
    notes = {note.text for note in read(tmp_path, deck(blocks, plain, more)).notes}
    assert "1 cards RBE3 are left out, with their stiffness and mass" in notes
    assert "1 cards CONM2 are left out, with their stiffness and mass" in notes
    assert "1 reference points are left out, with the couplings that name them: 90001" in notes


def test_ranges_far_beyond_the_nodes_cost_nothing(tmp_path, blocks):
    """SET 1 = 1 THRU 10^12 is a usual way to say all; a range with the nodes of one face between its ends."""
    numbers = meshfiles.numbers(blocks)
    nodes = np.sort(numbers[blocks.face_nodes("p0.left")])
    fill = np.setdiff1d(np.arange(nodes[0], nodes[-1] + 1), numbers)
    assert len(fill)  # the range names numbers that no node has
    text = deck(blocks, plain, [f"SET1,41,1,THRU,{10**12}"])
    mesh = read(tmp_path, text)
    assert "SET41" not in mesh.faces  # all nodes are not a face
    alike(mesh, blocks)


def test_grids_with_directions_of_their_own_are_known(tmp_path, blocks):
    text = deck(blocks, plain, ["GRDSET,,,,,,5", *system("R")])
    assert read(tmp_path, text).turned.all()
    assert not read(tmp_path, deck(blocks, plain)).turned.any()


CARDS = {"tet": "CTETRA", "hex": "CHEXA", "wedge": "CPENTA"}
VOLUMES = {"tet": 1 / 6, "hex": 8.0, "wedge": 1.0}  # of the reference shapes


@pytest.mark.parametrize("kind", ["tet4", "tet10", "hex8", "hex20", "wedge6", "wedge15"])
@pytest.mark.parametrize("turned", [False, True])
def test_solids_numbered_in_either_sense_are_one_body(kind, turned, tmp_path):
    """MSC Nastran Quick Reference Guide: the corners of a face go round in either direction."""
    element = KINDS[kind]
    places = range(1, element.count + 1)
    grids = [
        ",".join(["GRID", str(k), "", *map(str, map(float, at))]) for k, at in zip(places, element.nodes, strict=True)
    ]
    nodes = [1 + i for i in (element.mirrored if turned else range(element.count))]
    order = UPRIGHT_FIRST.get(element.count, range(element.count))
    nodes = [nodes[list(order).index(k)] for k in range(element.count)]  # as Nastran lists them
    loaded = element.sides[-1][:3:2] if element.corners > 4 else (element.sides[0][0], 3)
    solid = card(CARDS[element.shape.name], 1, 1, *nodes)
    load = card("PLOAD4", 7, 1, 1.0, "", "", "", *[1 + k for k in loaded])
    mesh = read(tmp_path, "\n".join(["BEGIN BULK", *grids, *solid, *load, "ENDDATA", ""]))
    assert mesh.volumes["part1"] == pytest.approx(VOLUMES[element.shape.name] * 1e-9)
    assert bool(mesh.notes) == turned
    corners = element.nodes[list(element.sides[0 if element.corners == 4 else -1])]
    centre, normal, _ = face_centre(mesh.points, mesh.face("PLOAD4_7"))
    assert centre == pytest.approx(1e-3 * corners.mean(axis=0), abs=1e-9)
    assert normal @ (centre - 1e-3 * element.nodes.mean(axis=0)) > 0
