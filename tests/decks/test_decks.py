"""Every deck, read back by a reader of its grammar, is the matrix of the pairs; units; dampers; what headers say."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

import faying
from faying.decks import abaqus, aster, calculix, mapdl, nastran
from faying.decks.deck import SOLVERS, UnitSystem, real, springs_of, write
from tests.helpers import readers
from tests.helpers.models import K_N, K_T, LOSS_N, deck_of, two

ANGLES = pytest.mark.parametrize("angle", [0.0, np.pi / 6])
COUPLINGS = pytest.mark.parametrize("coupling", ["nodes", "faces"])


def mesh(angle=0.0, coupling="nodes"):
    return two(("hex8", "hex8"), ((2, 2), (2, 2) if coupling == "nodes" else (3, 2)), angle, counts=(1, 1))


def same(got, deck, blocks, rel=1e-9):
    want = readers.expected(deck, blocks)
    assert got.shape == want.shape
    assert np.abs(got - want).max() < rel * np.abs(want).max()


@ANGLES
@COUPLINGS
def test_calculix(angle, coupling):
    deck = deck_of(mesh(angle, coupling), coupling)
    same(readers.one_way(calculix.spring2(deck)), deck, deck.stiffness)


@ANGLES
@COUPLINGS
def test_abaqus(angle, coupling):
    deck = deck_of(mesh(angle, coupling), coupling)
    text = abaqus.spring2(deck)
    springs, dashpots = text[: text.index("*ELEMENT,TYPE=DASHPOT2")], text
    same(readers.one_way(springs), deck, deck.stiffness)
    same(readers.one_way(dashpots, "DASHPOT", "DASHPOT2"), deck, deck.dampers)
    found = readers.matrix_input(abaqus.matrix(deck))
    same(found["STIFFNESS"], deck, deck.stiffness)
    same(found["STRUCTURAL DAMPING"], deck, deck.loss)
    if coupling == "nodes":
        stiffness, lost = readers.connectors(abaqus.connector(deck))
        same(stiffness, deck, deck.stiffness)
        same(lost, deck, deck.loss)


@ANGLES
@COUPLINGS
def test_nastran(angle, coupling):
    deck = deck_of(mesh(angle, coupling), coupling)
    stiffness, lost = readers.celas2(nastran.celas2(deck))
    same(stiffness, deck, deck.stiffness)
    same(lost, deck, deck.loss)
    found = readers.dmig(nastran.dmig(deck))
    same(found["KJOINT"], deck, deck.stiffness)
    same(found["K4JOINT"], deck, deck.loss)
    if coupling == "nodes":
        stiffness, lost = readers.cbush(nastran.cbush(deck))
        same(stiffness, deck, deck.stiffness)
        same(lost, deck, deck.loss)


@ANGLES
@COUPLINGS
def test_mapdl(angle, coupling):
    deck = deck_of(mesh(angle, coupling), coupling)
    stiffness, damping = readers.matrix27(mapdl.matrix27(deck))
    same(stiffness, deck, deck.stiffness)
    same(damping, deck, deck.dampers)
    if coupling == "nodes":
        stiffness, damping = readers.combin14(mapdl.combin14(deck))
        same(stiffness, deck, deck.stiffness)
        same(damping, deck, deck.dampers)


@ANGLES
@COUPLINGS
def test_aster(angle, coupling):
    deck = deck_of(mesh(angle, coupling), coupling)
    texts = aster.decks(deck)
    (stiffness, lost), blocks = readers.aster(texts["model.mail"], texts["joint.comm"])
    same(stiffness, deck, deck.stiffness)
    same(lost, deck, deck.loss)
    names = [name for name, _ in blocks]
    assert names[:3] == ["TITRE", "COOR_3D", "HEXA8"]
    nodes = dict(blocks)["COOR_3D"]
    assert nodes[0] == "N100"
    assert np.array(nodes[1:4], dtype=float) == pytest.approx(1e3 * deck.mesh.points[0], abs=1e-12)


def test_the_order_of_matrix27():
    """The constants that ANSYS's own check names: an x spring is C1 = C58 = K, C7 = -K; y and z alike."""
    kx, ky, kz = 3e5, 4e5, 5e5
    (row,) = mapdl.constants(np.diag([kx, ky, kz])[None])
    want = {1: kx, 7: -kx, 13: ky, 19: -ky, 24: kz, 30: -kz, 58: kx, 64: ky, 69: kz}
    assert {i + 1: v for i, v in enumerate(row) if v} == want
    full = np.array([[5.0, 1, 2], [1, 6, 3], [2, 3, 7]])
    (row,) = mapdl.constants(full[None])
    both = np.block([[full, -full], [-full, full]])
    rows = [0, 1, 2, 6, 7, 8]
    assert np.array_equal(readers.whole(row)[np.ix_(rows, rows)], both)


def test_the_listing_of_matrix27_line_by_line():
    """One pair, 1 N/m in each direction, in m and N: 78 constants in R and twelve RMORE."""
    deck = deck_of(mesh(), seed=None, unit="m", frequency=None)
    lines = mapdl.matrix27(deck).splitlines()
    start = next(i for i, line in enumerate(lines) if line.startswith("R,"))
    assert max(map(len, lines)) <= 128
    assert [line.split(",")[0] for line in lines[start : start + 13]] == ["R"] + 12 * ["RMORE"]
    words = [float(w) for line in lines[start : start + 13] for w in line.split(",")[1 + line.startswith("R,") :]]
    assert len(words) == 78
    share = deck.pairs.area.min()  # sets are in rising order of stiffness
    places = {1: K_N, 7: -K_N, 13: K_T, 19: -K_T, 24: K_T, 30: -K_T, 58: K_N, 64: K_T, 69: K_T}
    assert {i + 1: w for i, w in enumerate(words) if w} == pytest.approx({i: v * share for i, v in places.items()})


def test_units():
    """A spring of 1 kN/mm, a damper, a pressure and a mass in three systems."""
    assert UnitSystem("mm").stiffness * 1e6 == pytest.approx(1e3)
    assert UnitSystem("mm").pressure * 5e6 == pytest.approx(5.0)
    assert UnitSystem("mm").density * 2e13 == pytest.approx(2e4)
    assert UnitSystem("mm").mass * 7800 / UnitSystem("mm").metre ** 3 == pytest.approx(7.8e-9)
    assert UnitSystem("m").stiffness == UnitSystem("m").pressure == UnitSystem("m").mass == 1.0
    inch = UnitSystem("inch", "lbf")
    assert inch.pressure * 6894.757293168 == pytest.approx(1.0)
    assert inch.stiffness * 175.1268369864 == pytest.approx(1.0)
    with pytest.raises(faying.InputError, match="unit of force"):
        _ = UnitSystem("mm", "parsec").newton
    a, b = (readers.one_way(calculix.spring2(deck_of(mesh(), unit=unit))) for unit in ("mm", "m"))
    assert np.abs(1e3 * a - b).max() < 1e-9 * np.abs(b).max()


@pytest.mark.parametrize("solver", SOLVERS)
def test_totals_in_every_deck(solver):
    """k times area to 1e-10 from the text alone; 16 columns of Nastran hold ten digits."""
    deck = deck_of(mesh(0.3), seed=None)
    read = {
        "mapdl": lambda: readers.matrix27(mapdl.matrix27(deck))[0],
        "abaqus": lambda: readers.matrix_input(abaqus.matrix(deck))["STIFFNESS"],
        "nastran": lambda: readers.dmig(nastran.dmig(deck))["KJOINT"],
        "calculix": lambda: readers.one_way(calculix.spring2(deck)),
        "aster": lambda: readers.aster(*[aster.decks(deck)[n] for n in ("model.mail", "joint.comm")])[0][0],
    }[solver]()
    one, two_ = deck.ends
    place = readers.places(one, two_)
    move = np.zeros(len(place))
    for node in map(int, two_):
        for c in (1, 2, 3):
            move[place[node, c]] = deck.pairs.frames[0, 0, c - 1]
    assert move @ read @ move == pytest.approx(K_N * 6e-4 * 1e-3, rel=1e-10 if solver != "nastran" else 3e-10)


def test_headers_say_units_law_and_damping():
    deck = deck_of(mesh())
    for text in (t for s in (mapdl, abaqus, nastran, calculix, aster) for t in s.decks(deck).values()):
        assert "law: by hand" in text
    assert "right at 500 Hz" in mapdl.matrix27(deck)
    assert "no dampers" in abaqus.spring2(deck_of(mesh(), frequency=None))


def test_contact_properties():
    deck = deck_of(mesh())
    for module, extra in ((calculix, "NODE TO SURFACE"), (abaqus, "SURFACE TO SURFACE")):
        found = {k: (o, d) for k, o, d in readers.keywords(module.contact(deck))}
        rows = np.array([[float(w) for w in row] for row in found["SURFACE BEHAVIOR"][1]])
        assert len(rows) <= 200
        assert np.all(np.diff(rows, axis=0) > 0)
        assert np.diff(rows[:, 0]) / np.diff(rows[:, 1]) == pytest.approx(K_N * 1e-9)
        assert found["CONTACT PAIR"][0]["TYPE"] == extra
        assert found["CONTACT PAIR"][1] == [["p0.right", "p1.left"]]
    friction = {k: d for k, o, d in readers.keywords(calculix.contact(deck))}["FRICTION"]
    assert [float(w) for w in friction[0]] == pytest.approx([0.2, K_T * 1e-9])
    options = {k: (o, d) for k, o, d in readers.keywords(abaqus.contact(deck))}
    slip = float(options["FRICTION"][0]["ELASTIC SLIP"])
    assert 0.2 * 5.0 / slip == pytest.approx(K_T * 1e-9)
    damping = float(options["CONTACT DAMPING"][1][0][0])
    assert damping == pytest.approx(LOSS_N * K_N * 1e-9 / (2 * np.pi * 500))
    lines = mapdl.contact(deck).splitlines()
    assert [float(line.split(",")[-1]) for line in lines if line.startswith("RMODIF,cid,3,")] == [-K_N * 1e-9]
    assert [float(line.split(",")[-1]) for line in lines if line.startswith("RMODIF,cid,12,")] == [-K_T * 1e-9]


def test_nothing_is_half_written(tmp_path):
    with pytest.raises(faying.InputError, match="no exporter for 'ls-dyna'; give one of mapdl, abaqus"):
        write(deck_of(mesh()), "ls-dyna", tmp_path / "out")
    (tmp_path / "file").write_text("")
    with pytest.raises(faying.InputError, match="cannot make the folder"):
        write(deck_of(mesh()), "nastran", tmp_path / "file" / "out")
    assert [p.name for p in tmp_path.iterdir()] == ["file"]
    files = write(deck_of(mesh()), "nastran", tmp_path / "out")
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == sorted(p.name for p in files)


def test_springs_per_area_on_a_curved_face():
    """They couple the axes of a pair: forms with full blocks take them, the others say that they cannot."""
    flat = two(("hex8", "hex8"), ((4, 1), (4, 1)), counts=(1, 1))
    bent = flat.points.copy()
    bent[:, 0] += 2.0 * (bent[:, 1] - 0.015) ** 2
    curved = faying.fe.mesh.Mesh(points=bent, parts=flat.parts, faces=flat.faces, face_part=flat.face_part)
    deck = deck_of(curved, "faces")
    assert sorted(abaqus.decks(deck)) == ["joint_contact.inp", "joint_matrix.inp"]
    same(readers.matrix27(mapdl.decks(deck)["joint_matrix27.inp"])[0], deck, deck.stiffness)
    same(readers.celas2(nastran.decks(deck)["joint_celas2.bdf"])[0], deck, deck.stiffness)
    same(readers.matrix_input(abaqus.matrix(deck))["STIFFNESS"], deck, deck.stiffness)
    for module in (calculix, aster):
        with pytest.raises(faying.InputError, match=r"do not act along one normal; take them node by node"):
            module.decks(deck)
    lumped = deck_of(curved)
    same(readers.one_way(calculix.spring2(lumped)), lumped, lumped.stiffness)
    same(readers.cbush(nastran.cbush(lumped))[0], lumped, lumped.stiffness)


def test_an_open_joint_has_no_springs():
    pairs = deck_of(mesh()).pairs
    deck = deck_of(
        mesh(), pairs=replace(pairs, stiffness=0 * pairs.stiffness, loss=0 * pairs.loss), viscous=None, contact=None
    )
    assert deck.pairs.totals() == (0.0, 0.0)
    assert "*SPRING" not in calculix.spring2(deck)
    assert not readers.matrix27(mapdl.matrix27(deck))[0].any()


@given(arrays(float, (3, 3, 3), elements=st.floats(-1e6, 1e6)))
def test_springs_between_single_directions_add_up(values):
    """Any symmetric blocks, of pairs that share no node: sums of springs whose crossed diagonals cancel."""
    blocks = values + values.transpose(0, 2, 1)
    for p, block in enumerate(blocks):
        A = np.zeros((6, 6))
        for a, c, b, d, k in springs_of(blocks):
            i, j = 3 * a + c, 3 * b + d
            A[[i, j], [i, j]] += k[p]
            A[i, j] -= k[p]
            A[j, i] -= k[p]
        assert np.abs(A - np.block([[block, -block], [-block, block]])).max() <= 1e-9 * max(np.abs(blocks).max(), 1e-9)


@given(st.floats(-1e200, 1e200), st.integers(13, 23))
def test_numbers_fit_their_columns(value, width):
    word = real(value, width)
    assert len(word) <= width
    assert "." in word
    if abs(value) > 1e-200:
        assert float(word) == pytest.approx(value, rel=10.0 ** (9 - width))


def test_a_joint_on_nodes_with_directions_of_their_own_is_not_written(tmp_path):
    """CD of a GRID, *TRANSFORM: a joint acts in the directions of the model."""
    deck = deck_of(mesh())
    turned = np.zeros(len(deck.mesh.points), dtype=bool)
    turned[deck.pairs.second[0]] = True
    deck = replace(deck, mesh=replace(deck.mesh, turned=turned))
    with pytest.raises(faying.InputError, match="1 nodes of the joint have directions of their own in the model, node"):
        write(deck, "nastran", tmp_path)
    assert not list(tmp_path.iterdir())
