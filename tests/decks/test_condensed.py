"""A condensed joint in each program's words, read back: matrices, units, nodes."""

import re

import numpy as np
import pytest

import faying
from faying.decks.deck import CondensedDeck, UnitSystem, six_each, write_condensed
from faying.decks.programs import CONDENSED, module_of
from faying.fe.elasticity import unit_motions

NODES = (7, 12)


def spd(seed, scale):
    a = np.random.default_rng(seed).standard_normal((6, 9))
    size = np.repeat([1.0, 0.01], 3)
    return scale * (a @ a.T) * np.outer(size, size)


def deck(unit="mm", force="N", first=(0.01, -0.02, 0.03), second=(0.01, -0.02, 0.05), K=None, lossy=True):
    """Between two points, about the middle of them."""
    K = spd(1, 1e9) if K is None else K
    C = 0.03 * K if lossy else 0 * K
    points = np.array([first, second])
    turn = np.zeros((6, 12))
    for k, sign in ((0, -1), (1, 1)):
        block = np.eye(6)
        block[:3] = unit_motions(points.mean(axis=0) - points[k])
        turn[:, 6 * k : 6 * k + 6] = sign * block
    return CondensedDeck(
        points=points,
        nodes=NODES,
        element=40,
        entries=six_each(NODES),
        stiffness=turn.T @ K @ turn,
        loss=turn.T @ C @ turn,
        system=UnitSystem(unit, force),
        facts=("a joint",),
    )


def wide(text):
    """Logical lines of Nastran's wide fields: name and words of 16 columns."""
    out = []
    for line in text.splitlines():
        if line.startswith("$"):
            continue
        words = [line[k : k + 16].strip() for k in range(8, len(line), 16)]
        words += [""] * (4 - len(words))
        if line.startswith("*"):
            out[-1] += words
        else:
            out.append([line[:8].strip().rstrip("*"), *words])
    return out


def place(node, direction):
    return 6 * NODES.index(int(node)) + int(direction) - 1


def full(entries):
    out = np.zeros((12, 12))
    for i, j, value in entries:
        out[i, j] = out[j, i] = value
    return out


def dmig(text, name):
    entries = []
    for head, *words in wide(text):
        if head == "DMIG" and words[0] == name and words[1] != "0":
            column = place(*words[1:3])
            for k in range(4, len(words) - 2, 4):
                if words[k]:
                    entries.append((place(*words[k : k + 2]), column, float(words[k + 2])))
    return full(entries)


def matrix27(text):
    words = [w for line in text.splitlines() if re.match(r"R,|RMORE", line) for w in line.split(",")[1:]]
    values = [float(w) for w in words[1:]]  # after the number of the set
    return full(zip(*np.triu_indices(12), values, strict=True))


def abaqus(text, name):
    block = text.split(f"NAME={name},TYPE=SYMMETRIC\n")[1].split("*")[0]
    rows = [line.split(",") for line in block.splitlines()]
    return full((place(a, b), place(c, d), float(v)) for a, b, c, d, v in rows)


READ = {
    "nastran": ("condensed_dmig.bdf", lambda t: dmig(t, "KJOINT"), lambda t: dmig(t, "K4JOINT")),
    "mapdl": ("condensed_matrix27.inp", matrix27, None),
    "abaqus": ("condensed_matrix.inp", lambda t: abaqus(t, "KJ"), lambda t: abaqus(t, "SJ")),
}


def test_every_program_that_writes_one_is_read_here():
    assert set(READ) == set(CONDENSED)


@pytest.mark.parametrize("program", READ)
@pytest.mark.parametrize(("unit", "force", "metre", "newton"), [("m", "N", 1.0, 1.0), ("mm", "kN", 1e3, 1e-3)])
def test_matrices_in_the_units_of_the_deck(program, unit, force, metre, newton):
    """Energy does not depend on units: u in metres and radians and the same u in the deck's."""
    made = deck(unit, force)
    name, stiffness, loss = READ[program]
    text = module_of(program).condensed(made)[name]
    motion = np.random.default_rng(5).standard_normal(12) * np.tile(np.repeat([1e-6, 1e-4], 3), 2)
    theirs = motion * np.tile(np.repeat([metre, 1.0], 3), 2)
    for read, matrix in ((stiffness, made.stiffness), (loss, made.loss)):
        if read is not None:
            found = read(text)
            energy = theirs @ found @ theirs / (newton * metre)
            assert energy == pytest.approx(motion @ matrix @ motion, rel=1e-8)
            assert np.all(
                np.linalg.eigvalsh(found * np.outer(1 / np.sqrt(np.diag(found)), 1 / np.sqrt(np.diag(found)))) > -1e-8
            )


@pytest.mark.parametrize("program", READ)
def test_without_loss_none_is_written(program):
    text = module_of(program).condensed(deck(lossy=False))[READ[program][0]]
    assert not re.search("K4JOINT|SJ|DAMPING", text)


def test_a_cbush_where_little_couples():
    """Its six springs and GE in its own axes, which are turned against the model's, give the matrix back."""
    own = np.array([3e9, 3e9, 5e9, 2e5, 3e5, 4e5])
    axes, _ = np.linalg.qr(np.random.default_rng(2).standard_normal((3, 3)))
    turn = np.kron(np.eye(2), axes)
    # even springs on a face: both tangents alike, so that any axes in the plane do for the translations
    K = turn @ np.diag(own) @ turn.T
    made = deck("mm", first=(0.0, 0.0, 0.0), second=(0.0, 0.0, 0.0), K=K)
    text = module_of("nastran").condensed(made)["condensed_cbush.bdf"]
    cards = {head: words for head, *words in wide(text)}
    z, x = (np.array([float(w) for w in cards["CORD2R"][k : k + 3]]) for k in (5, 8))
    frame = np.stack([x, np.cross(z, x), z], axis=1)
    words = cards["PBUSH"]
    k, ge = (np.array([float(w) for w in words[a : a + 6]]) for a in (2, 10))
    assert words[9] == "GE"
    turned = np.kron(np.eye(2), frame)
    assert turned @ np.diag(k) @ turned.T == pytest.approx(made.in_units(made.stiffness)[6:, 6:], rel=1e-6, abs=1e-2)
    assert ge == pytest.approx(0.03, rel=1e-9)
    assert cards["CBUSH"][:4] == ["40", "40", "7", "12"]


def test_no_cbush_where_points_differ_or_much_couples():
    assert list(module_of("nastran").condensed(deck())) == ["condensed_dmig.bdf"]
    coupled = deck(first=(0.0, 0.0, 0.0), second=(0.0, 0.0, 0.0))
    assert list(module_of("nastran").condensed(coupled)) == ["condensed_dmig.bdf"]


@pytest.mark.parametrize(
    ("program", "pattern"), [("mapdl", r"N,(\d+),(.*)"), ("abaqus", r"^(7|12),([^,]*,[^,]*,[^,]*)$")]
)
def test_nodes_are_where_the_points_are(program, pattern):
    made = deck("mm")
    text = module_of(program).condensed(made)[READ[program][0]]
    found = {int(n): [float(x) for x in at.split(",")] for n, at in re.findall(pattern, text, re.MULTILINE)}
    for node, at in zip(NODES, made.points, strict=True):
        assert found[node] == pytest.approx(1e3 * at)


def test_files_and_programs_that_take_none(tmp_path):
    (file,) = write_condensed(deck(), "abaqus", tmp_path / "joint")
    assert file.read_text().startswith("** a joint")
    with pytest.raises(faying.InputError, match="'calculix' has no exporter for a matrix .* mapdl, abaqus, nastran"):
        write_condensed(deck(), "calculix", tmp_path / "other")
