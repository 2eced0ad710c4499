"""CalculiX on the very same mesh: matrices entry by entry, and frequencies of two blocks bare and joined by springs."""

import shutil

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.sparse import coo_array, diags_array
from scipy.sparse.linalg import spsolve

import faying
from faying.bolt.solid_bolt import SolidBolt
from faying.decks.matrices import arranged, read_matrices
from faying.fe.elasticity import assemble
from faying.fe.interface import join
from faying.fe.mesh import Mesh
from faying.joint.assembled_parts import unknowns_of
from faying.numerics.constraint import constrain
from faying.numerics.modes import lowest_modes
from tests.helpers import ccx
from tests.helpers.boxes import SOLID_KINDS, block, row
from tests.helpers.voxels import bolted

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed"),
]
STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0)
ALU = faying.Material(name="alu", E=70e9, nu=0.33, density=2700.0)
SIZE = (0.05, 0.04, 0.03)


def stored(folder, name, nodes):
    """A symmetric matrix that CalculiX stored, in the order of our unknowns; bricks have more, for their bubbles."""
    table = np.loadtxt(folder / name)
    i, j = table[:, 0].astype(int) - 1, table[:, 1].astype(int) - 1
    upper = coo_array((table[:, 2], (i, j)), shape=(max(i.max(), j.max()) + 1,) * 2).tocsr()
    dof = np.array([word.split(".") for word in (folder / "job.dof").read_text().split()], dtype=int)
    order = np.lexsort((dof[:, 1], dof[:, 0]))
    whole = (upper + upper.T - diags_array(upper.diagonal())).toarray()[np.ix_(order, order)]
    return whole, 3 * nodes


def matrices(tmp_path, mesh, materials=None, springs=()):
    step = ["*STEP", "*FREQUENCY,SOLVER=MATRIXSTORAGE", "1", "*END STEP"]
    ccx.run(tmp_path, ccx.deck(mesh, materials or dict.fromkeys(mesh.parts, STEEL), springs, step=step))
    K, n = stored(tmp_path, "job.sti", len(mesh.points))
    M, _ = stored(tmp_path, "job.mas", len(mesh.points))
    if len(K) > n:
        K = K[:n, :n] - K[:n, n:] @ np.linalg.solve(K[n:, n:], K[n:, :n])
    return K * 1e3, M[:n, :n] * 1e3


@pytest.mark.parametrize("kind", [k for k in SOLID_KINDS if k != "wedge6"])
def test_matrices(tmp_path, kind):
    """Distorted elements, but for bricks: CalculiX leaves out the determinants of Taylor's correction."""
    points, cells = block(kind, (2, 2, 2), SIZE, move=None if kind == "hex8" else (0.25, 1))
    mesh = Mesh(points=points, parts={"p": cells}, faces={}, face_part={})
    K, M = assemble(mesh, {"p": STEEL}, mass="stiffness")
    theirs, weight = matrices(tmp_path, mesh)
    assert np.abs(K - theirs).max() < 1e-9 * np.abs(theirs).max()
    assert np.abs(M - weight).max() < 1e-9 * np.abs(weight).max()


def test_stored_matrices_are_read(tmp_path):
    points, cells = block("tet10", (2, 1, 1), SIZE, move=(0.1, 1))
    mesh = Mesh(points=points, parts={"p": cells}, faces={}, face_part={})
    matrices(tmp_path, mesh)
    read = read_matrices(tmp_path / "job.sti", stiffness_unit="N/mm", mass_unit="t")
    for got, want in zip(arranged(read, mesh), assemble(mesh, {"p": STEEL}, mass="stiffness"), strict=True):
        assert np.abs(got - want).max() < 1e-9 * np.abs(want).max()


def test_two_points_in_a_wedge_leave_a_motion_free(tmp_path):
    """Why wedge6 is not CalculiX's C3D6: one element of theirs has seven motions that cost nothing, ours six."""
    points, cells = block("wedge6", (1, 1, 1), SIZE)
    used, inverse = np.unique(cells[0], return_inverse=True)
    mesh = Mesh(points=points[used], parts={"p": inverse.reshape(1, -1)}, faces={}, face_part={})
    theirs = np.linalg.eigvalsh(matrices(tmp_path, mesh)[0])
    ours = np.linalg.eigvalsh(assemble(mesh, {"p": STEEL})[0].toarray())
    assert np.sum(np.abs(theirs) < 1e-10 * theirs[-1]) == 7
    assert np.sum(np.abs(ours) < 1e-10 * ours[-1]) == 6


def two_blocks(kind, counts):
    return row([0.05, 0.04], counts, kinds=(kind, kind), sections=((3, 2), (3, 2)), width=0.03, height=0.02)


def both(tmp_path, mesh, springs, K, M, materials, count):
    """Ours and theirs with the outer ends held: rigid motions cost CalculiX's shift digits.

    Bricks: from the matrices that CalculiX stores, its bubbles condensed out of the stiffness as ours are. It gives
    them a mass too.
    """
    held = np.concatenate([mesh.face_nodes("p0.left"), mesh.face_nodes("p1.right")])
    fixed = unknowns_of(held)
    free = np.setdiff1d(np.arange(mesh.unknowns), fixed)
    ours = lowest_modes(K[free][:, free], M[free][:, free], count, shift_frequency=100.0).frequencies
    if len(mesh.blocks[0][0]) == 8:
        stiff, mass = (A[np.ix_(free, free)] for A in matrices(tmp_path, mesh, materials, springs))
        return ours, np.sqrt(eigh(stiff, mass, eigvals_only=True, subset_by_index=[0, count - 1])) / (2 * np.pi)
    ccx.run(tmp_path, ccx.deck(mesh, materials, springs, step=ccx.held_step(fixed, count)))
    return ours, np.sort(ccx.frequencies(tmp_path))[:count]


KINDS = ["tet10", "hex20", "wedge15", "hex8"]


@pytest.mark.parametrize("kind", KINDS)
def test_frequencies_of_two_bare_blocks(tmp_path, kind):
    mesh = two_blocks(kind, [4, 3])
    materials = {"p0": STEEL, "p1": ALU}
    K, M = assemble(mesh, materials, mass="stiffness")
    ours, theirs = both(tmp_path, mesh, (), K, M, materials, 12)
    assert ours == pytest.approx(theirs, rel=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_frequencies_of_two_blocks_and_springs_between_their_nodes(tmp_path, kind):
    mesh = two_blocks(kind, [4, 3])
    materials = {"p0": STEEL, "p1": ALU}
    nodes = join(mesh, "p0.right", "p1.left").at_nodes()
    k_n, k_t = 4e13 * np.ones(len(nodes.weights)), 2e13 * np.ones(len(nodes.weights))
    springs = [
        (int(a), int(b), (n * w, t * w, t * w))
        for a, b, n, t, w in zip(
            nodes.first_nodes[:, 0], nodes.second_nodes[:, 0], k_n, k_t, nodes.weights, strict=True
        )
    ]
    K, M = assemble(mesh, materials, mass="stiffness")
    ours, theirs = both(tmp_path, mesh, springs, K + nodes.springs(k_n, k_t), M, materials, 10)
    assert ours == pytest.approx(theirs, rel=1e-6)


def test_bubbles_with_mass_matter_less_on_finer_meshes(tmp_path):
    """CalculiX gives the bubbles of C3D8I a mass; its printed frequencies meet ours at second order of the mesh."""
    differ = []
    for n in (1, 2):
        mesh = row([0.05, 0.04], [4 * n, 3 * n], sections=((3 * n, 2 * n), (3 * n, 2 * n)), width=0.03, height=0.02)
        materials = dict.fromkeys(mesh.parts, STEEL)
        K, M = assemble(mesh, materials)
        ours, _ = both(tmp_path, mesh, (), K, M, materials, 3)
        held = np.concatenate([mesh.face_nodes("p0.left"), mesh.face_nodes("p1.right")])
        ccx.run(tmp_path, ccx.deck(mesh, materials, step=ccx.held_step(unknowns_of(held), 3)))
        differ.append(np.abs(ours / np.sort(ccx.frequencies(tmp_path))[:3] - 1).max())
    assert differ[0] < 0.02
    assert np.log2(differ[0] / differ[1]) > 1.5


def test_the_mass_rules_differ_less_than_the_mesh(tmp_path):
    """tet10: frequencies with the exact mass and with CalculiX's, next to those of a finer mesh."""
    found = {}
    for n, rule in ((1, "exact"), (1, "stiffness"), (2, "exact")):
        points, cells = block("tet10", (3 * n, 2 * n, 2 * n), SIZE)
        mesh = Mesh(points=points, parts={"p": cells}, faces={}, face_part={})
        K, M = assemble(mesh, {"p": STEEL}, mass=rule)
        found[n, rule] = lowest_modes(K, M, 12, shift_frequency=3000.0).frequencies[6:]
    fine = found[2, "exact"]
    assert np.abs(found[1, "stiffness"] / found[1, "exact"] - 1).max() < 0.02
    assert np.all(found[1, "exact"] > fine)


@pytest.mark.parametrize("height", [5e-3, 10e-3])
def test_pretension_of_a_solid_bolt(tmp_path, height):
    """Our bolt beside *PRE-TENSION SECTION, which parts the mesh between two layers of elements; springs in the joints.

    A linear problem: displacement of every node.
    """
    mesh = bolted(kind="hex8")
    materials = {"lower": STEEL, "upper": ALU, "bolt0": STEEL}
    springs, joined = [], 0
    for pair in (("lower.joint", "upper.joint"), ("bolt0.head", "upper.seat0"), ("bolt0.nut", "lower.seat0")):
        nodes = join(mesh, *pair).at_nodes()
        joined = joined + nodes.springs(np.full(len(nodes.weights), 3e14), np.full(len(nodes.weights), 1e14))
        springs += [
            (int(a), int(b), [k * w for k in (1e14, 1e14, 3e14)])
            for a, b, w in zip(nodes.first_nodes[:, 0], nodes.second_nodes[:, 0], nodes.weights, strict=True)
        ]
    force, n = 5e3, len(mesh.points)
    corners = [int(np.argmin(np.linalg.norm(mesh.points - p, axis=1))) for p in ((0, 0, 0), (0.04, 0, 0), (0, 0.04, 0))]
    fixed = np.array(
        [
            3 * corners[0],
            3 * corners[0] + 1,
            3 * corners[0] + 2,
            3 * corners[1] + 1,
            3 * corners[1] + 2,
            3 * corners[2] + 2,
        ]
    )

    # CalculiX: the sides of the shank's elements at this height, seen from below
    below = [
        i + 1
        for i, cell in enumerate(np.concatenate([b for blocks in mesh.parts.values() for b in blocks]))
        if cell[0] in set(mesh.part_nodes("bolt0")) and np.isclose(mesh.points[cell, 2].max(), height)
    ]
    text = ccx.deck(mesh, materials, springs, step=[])
    text += (
        "\n".join(
            [
                "*NODE",
                f"{n + 1},0,0,0",
                "*SURFACE,NAME=CUT,TYPE=ELEMENT",
                *(f"{e},S2" for e in below),
                f"*PRE-TENSION SECTION,SURFACE=CUT,NODE={n + 1}",
                "0,0,1",  # away from those elements: a positive load is tension
                "*BOUNDARY",
                *(f"{k // 3 + 1},{k % 3 + 1}" for k in fixed),
                "*STEP",
                "*STATIC",
                "*CLOAD",
                f"{n + 1},1,{force}",
                "*NODE PRINT,NSET=NALL",
                "U",
                "*END STEP",
            ]
        )
        + "\n"
    )
    printed = ccx.run(tmp_path, text)
    table = np.array(
        [
            line.split()
            for line in (tmp_path / "job.dat").read_text().splitlines()
            if len(line.split()) == 4 and line.split()[0].isdigit()
        ],
        dtype=float,
    )
    assert len(table) == n, printed[-2000:]
    theirs = table[np.argsort(table[:, 0]), 1:] * 1e-3

    K, _ = assemble(mesh, materials)
    bolt = SolidBolt(name="b", part="bolt0", faces=("bolt0.head", "bolt0.nut"), at=(0.02, 0.02, height + 2.5e-3))
    fitted = bolt.fitted(mesh, K)
    right = force * fitted.load
    right[fixed] = 0
    ours = spsolve(constrain((K + joined - fitted.released).tocsc(), fixed), right).reshape(-1, 3)
    differ, size = ours - theirs, np.abs(theirs).max()
    # CalculiX gives the nodes of the section as those of its other half: off by what the shank is drawn in
    cut = (np.abs(mesh.points[:, 2] - height) < 1e-9) & np.isin(np.arange(n), mesh.part_nodes("bolt0"))
    assert np.abs(differ[~cut]).max() < 1e-6 * size
    drawn = (force - fitted.tension(ours.ravel())) / fitted.rigidity
    assert np.abs(differ[cut] - [0, 0, drawn]).max() < 1e-6 * size
