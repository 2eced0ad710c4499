"""CalculiX on the very same mesh: matrices entry by entry, and frequencies of two blocks bare and joined by springs."""

import shutil

import ccx
import numpy as np
import pytest
from blocks import SOLID_KINDS, block, row
from scipy.linalg import eigh
from scipy.sparse import coo_array, diags_array

import faying
from faying.fe.elasticity import assemble
from faying.fe.interface import join
from faying.fe.matrices import arranged, read_matrices
from faying.fe.mesh import Mesh
from faying.fe.modes import lowest_modes

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

    Bricks: from the matrices that CalculiX stores, its bubbles condensed out of the stiffness as ours are. It gives them
    a mass too.
    """
    held = np.concatenate([mesh.face_nodes("p0.left"), mesh.face_nodes("p1.right")])
    step = ["*BOUNDARY", *(f"{n + 1},1,3" for n in held), "*STEP", "*FREQUENCY,SOLVER=ARPACK", f"{count}", "*END STEP"]
    free = np.setdiff1d(np.arange(mesh.unknowns), (3 * held[:, None] + np.arange(3)).ravel())
    ours = lowest_modes(K[free][:, free], M[free][:, free], count, shift_frequency=100.0).frequencies
    if len(mesh.blocks[0][0]) == 8:
        stiff, mass = (A[np.ix_(free, free)] for A in matrices(tmp_path, mesh, materials, springs))
        return ours, np.sqrt(eigh(stiff, mass, eigvals_only=True, subset_by_index=[0, count - 1])) / (2 * np.pi)
    ccx.run(tmp_path, ccx.deck(mesh, materials, springs, step=step))
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
    springs = [(int(a), int(b), (n * w, t * w, t * w)) for a, b, n, t, w in zip(
        nodes.first_nodes[:, 0], nodes.second_nodes[:, 0], k_n, k_t, nodes.weights, strict=True)]  # fmt: skip
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
        step = ["*BOUNDARY", *(f"{k + 1},1,3" for k in held), "*STEP", "*FREQUENCY,SOLVER=ARPACK", "3", "*END STEP"]
        ccx.run(tmp_path, ccx.deck(mesh, materials, step=step))
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
