"""Matrices of other programs: written by hand and read back, in every format, with their faults."""

import numpy as np
import pytest
from scipy.io import mmwrite
from scipy.sparse import diags_array

import faying
from faying.decks.matrices import arranged, read_matrices
from faying.fe.elasticity import assemble
from faying.fe.mesh import Mesh
from tests.helpers.boxes import block

STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0)
UNITS = {"stiffness_unit": "N/mm", "mass_unit": "t"}


@pytest.fixture(scope="module")
def model():
    """A small mesh with its own node numbers, and its matrices in N/mm and tonnes, unknowns shuffled."""
    points, cells = block("hex8", (2, 1, 1), (0.04, 0.02, 0.01), move=(0.1, 1))
    mesh = Mesh(points=points, parts={"p": cells}, faces={}, face_part={}, node_numbers=50 + 7 * np.arange(len(points)))
    K, M = assemble(mesh, {"p": STEEL})
    order = np.random.default_rng(0).permutation(mesh.unknowns)
    dofs = np.column_stack([np.repeat(mesh.numbers, 3), np.tile([1, 2, 3], len(points))])[order]
    return mesh, (K, M), (K[order][:, order] * 1e-3, M[order][:, order] * 1e-3, dofs)


def agrees(model, read):
    mesh, (K, M), _ = model
    stiff, mass = arranged(read, mesh)
    assert np.abs(stiff - K).max() < 1e-9 * np.abs(K).max()
    assert np.abs(mass - M).max() < 1e-9 * np.abs(M).max()


def calculix(folder, K, M, dofs):
    for name, A in (("job.sti", K), ("job.mas", M)):
        A = A.tocoo()
        lines = [f"{i + 1} {j + 1} {v:.16e}" for i, j, v in zip(A.row, A.col, A.data, strict=True) if i <= j]
        (folder / name).write_text("\n".join(lines) + "\n")
    (folder / "job.dof").write_text("".join(f"{a}.{b}\n" for a, b in dofs))
    return folder / "job.sti"


def market(folder, K, M, dofs, symmetry="symmetric"):
    mmwrite(folder / "k.mtx", K, symmetry=symmetry, precision=16)
    mmwrite(folder / "m.mtx", M, symmetry=symmetry, precision=16)
    (folder / "dofs.txt").write_text("".join(f"{a} {b}\n" for a, b in dofs))
    return {"path": folder / "k.mtx", "mass": folder / "m.mtx", "dofs": folder / "dofs.txt"}


def dmig(folder, K, M, dofs, form=6, wide=True):
    lines = []
    for name, A in (("KAAX", K), ("MAAX", M)):
        lines.append(f"DMIG    {name:<8}{0:8d}{form:8d}{2:8d}{0:8d}{'':8}{'':8}{len(dofs):8d}")
        A = A.tocsc()
        for j in range(len(dofs)):
            column = slice(A.indptr[j], A.indptr[j + 1])
            rows = [(i, v) for i, v in zip(A.indices[column], A.data[column], strict=True) if form == 1 or i >= j]
            if wide:
                lines.append(f"DMIG*   {name:<16}{dofs[j, 0]:16d}{dofs[j, 1]:16d}{'':16}")
                lines += [f"*       {dofs[i, 0]:16d}{dofs[i, 1]:16d}{v:16.9E}".replace("E", "D") for i, v in rows]
            else:
                words = ["DMIG", name, *map(str, dofs[j]), ""]
                words += [w for i, v in rows for w in (str(dofs[i, 0]), str(dofs[i, 1]), f"{v:.10e}", "")]
                lines += [",".join(["+" if k else "DMIG", *words[1 + k : 9 + k]]) for k in range(0, len(words) - 1, 8)]
    (folder / "m.pch").write_text("\n".join(lines) + "\n")
    return folder / "m.pch"


def test_calculix(model, tmp_path):
    agrees(model, read_matrices(calculix(tmp_path, *model[2]), **UNITS))


@pytest.mark.parametrize("symmetry", ["symmetric", "general"])
def test_matrix_market(model, tmp_path, symmetry):
    agrees(model, read_matrices(**market(tmp_path, *model[2], symmetry), **UNITS))


@pytest.mark.parametrize("form", [1, 6])
@pytest.mark.parametrize("wide", [True, False])
def test_nastran_dmig(model, tmp_path, form, wide):
    agrees(model, read_matrices(dmig(tmp_path, *model[2], form, wide), **UNITS))


def test_units_must_be_said(model, tmp_path):
    path = calculix(tmp_path, *model[2])
    with pytest.raises(
        faying.InputError, match='does not state its units; .* stiffness_unit = "N/mm", mass_unit = "t"'
    ):
        read_matrices(path)
    K, _, _ = read_matrices(path, stiffness_unit="N/m", mass_unit="kg")
    assert np.abs(K - model[2][0]).max() < 1e-9 * np.abs(K).max()


def refused(match, *args, **kwargs):
    with pytest.raises(faying.InputError, match=match):
        read_matrices(*args, **UNITS, **kwargs)


def test_faults(model, tmp_path):
    K, M, dofs = model[2]
    lame = K.copy().tolil()
    lame[0, 1] += 0.1 * abs(K).max()
    refused("stiffness matrix is not symmetric", **market(tmp_path, lame.tocsr(), M, dofs, "general"))
    zero = K.copy().tolil()
    zero[5, :], zero[:, 5] = 0, 0
    refused(
        rf"1 unknowns have no positive stiffness, node {dofs[5, 0]} direction {dofs[5, 1]} for one",
        **market(tmp_path, zero.tocsr(), M, dofs),
    )
    refused("the mass matrix is zero", **market(tmp_path, K, 0 * M, dofs))
    refused("unknowns have no positive mass", **market(tmp_path, K, -1 * M, dofs))
    refused("the stiffness matrix is 36 x 36 for 35 unknowns", **market(tmp_path, K, M, dofs[1:]))
    refused("is listed twice", **market(tmp_path, K, M, np.concatenate([dofs[1:2], dofs[1:]])))
    refused("numbers that are not finite", **market(tmp_path, K * np.nan, M, dofs, "general"))
    good = market(tmp_path, K, M, dofs)
    refused("name the mass and the dofs too", good["path"])
    (tmp_path / "dofs.txt").write_text("12 x\n")
    refused('line 1: "12 x" should be a node and a direction', **good)
    (tmp_path / "k.mtx").write_text("nonsense")
    refused("cannot be read as Matrix Market", **good)
    refused("no file", tmp_path / "none.mtx", mass=tmp_path / "m.mtx", dofs=tmp_path / "dofs.txt")
    refused("cannot read the list of unknowns", tmp_path / "none.sti")
    refused(r"files of the kind \.full are not known", tmp_path / "job.full")
    path = calculix(tmp_path, K, M, dofs)
    (tmp_path / "job.dof").write_text("50.1\n")
    refused("has the row or column 2; there are 1 unknowns, numbered from 1", path)
    path = calculix(tmp_path, K, M, dofs)
    path.write_text(path.read_text().rsplit(maxsplit=1)[0])
    refused("it is cut short", path)
    path = dmig(tmp_path, K, M, dofs)
    refused("has no DMIG K2GG; it has KAAX, MAAX", path, names=("K2GG", "MAAX"))
    path.write_text(path.read_text().replace(f"{6:8d}{2:8d}", f"{6:8d}{4:8d}"))
    refused("DMIG KAAX is complex", path)
    path.write_text("DMIG    KAAX           1       x\n")
    refused("cannot be read", path)


@pytest.mark.parametrize(
    ("node", "match"),
    [
        ("-50.1", "line 1: .-50.1. should be a node and a direction"),
        ("0.1", "line 1: node 0 direction 1; nodes are numbered from 1"),
        (f"{10**13}.1", "line 1: node 10000000000000 direction 1; nodes are numbered from 1"),
        ("9" * 5000 + ".1", "line 1: .9+. should be a node and a direction"),
        ("50.0", "directions from 1 to 6"),
        ("50.-1", "should be a node and a direction"),
        ("50.7", "directions from 1 to 6"),
        ("1e3.1", "should be a node and a direction"),
        ("\N{SUPERSCRIPT TWO}.1", "should be a node and a direction"),
    ],
    ids=["negative", "zero", "huge", "endless", "no direction", "negative direction", "seventh", "real", "superscript"],
)
def test_numbers_of_nodes_that_cannot_be(model, tmp_path, node, match):
    path = calculix(tmp_path, *model[2])
    dofs = path.with_suffix(".dof")
    dofs.write_text("\n".join([node, *dofs.read_text().splitlines()[1:]]) + "\n", encoding="utf-8")
    refused(match, path)


@pytest.mark.parametrize("suffix", [".sti", ".mas"])
@pytest.mark.parametrize(
    ("place", "match"),
    [
        ("-1 1", "has the row or column -1; there are 36 unknowns, numbered from 1"),
        ("1 0", "has the row or column 0"),
        ("1 37", "has the row or column 37"),
        ("1 1e300", r"has the row or column 1e\+300"),
        ("1.7 2", "has the row or column 1.7"),
        ("nan 2", "has the row or column nan"),
    ],
)
def test_rows_and_columns_that_cannot_be(model, tmp_path, suffix, place, match):
    path = calculix(tmp_path, *model[2]).with_suffix(suffix)
    first, *others = path.read_text().splitlines()
    path.write_text("\n".join([f"{place} {first.split()[2]}", *others]) + "\n")
    refused(match, tmp_path / "job.sti")


@pytest.mark.parametrize("suffix", [".sti", ".mas", ".dof"])
@pytest.mark.parametrize("turned", [False, True])
def test_what_is_given_twice(model, tmp_path, suffix, turned):
    """An entry and itself, or its mirror image; a list of unknowns knows no mirror."""
    path = calculix(tmp_path, *model[2]).with_suffix(suffix)
    lines = path.read_text().splitlines()
    if suffix == ".dof":
        lines[1] = lines[0]
        match = "is listed twice"
    else:
        entry = next(line.split() for line in lines if line.split()[0] != line.split()[1])
        lines.append(" ".join([entry[1], entry[0], entry[2]] if turned else entry))
        match = f"row {entry[0]}, column {entry[1]} is given twice"
    path.write_text("\n".join(lines) + "\n")
    refused(match, tmp_path / "job.sti")


@pytest.mark.parametrize("kind", ["sti", "mas", "dof", "mtx", "dmig", "dmig all"])
def test_a_file_cut_short_is_refused_or_whole(model, tmp_path, kind):
    """Cut at the end of lines all over, and inside some: an error, or all that was written."""
    K, M, dofs = model[2]
    order = np.lexsort((dofs[:, 1], dofs[:, 0])) if "dmig" in kind else np.arange(len(dofs))
    K, M, dofs = K[order][:, order], M[order][:, order], dofs[order]
    if kind in ("sti", "mas", "dof"):
        given, file = {"path": calculix(tmp_path, K, M, dofs)}, tmp_path / f"job.{kind}"
    elif kind == "mtx":
        given = market(tmp_path, K, M, dofs)
        file = given["mass"]
    else:
        given = {"path": dmig(tmp_path, K, M, dofs, form=6 if kind == "dmig" else 1)}
        file = given["path"]
    whole = file.read_bytes()
    lines = np.flatnonzero(np.frombuffer(whole, dtype=np.uint8) == 10) + 1
    cuts = [
        *lines[:-1][:: max(1, len(lines) // 40)],
        *lines[-12:-1],
        *range(len(whole) - 24, len(whole) - 1),
        *range(0, len(whole), 2999),
    ]
    passed = []
    for cut in cuts:
        file.write_bytes(whole[:cut])
        try:
            read = read_matrices(**given, **UNITS)
        except faying.InputError:
            continue
        passed.append((cut, abs(read[0] - K * 1e6).max() if read[0].shape == K.shape else np.inf))
    assert not passed, f"{len(passed)} of {len(cuts)} cuts are read, for one {whole[passed[0][0] - 80 : passed[0][0]]}"


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("3 3 2\n1 1 1.0\n", "has 3 numbers where its head says 6"),
        ("3 3 1\n4 1 1.0\n", "has the row or column 4; there are 3 unknowns"),
        ("3 3 1\n0 1 1.0\n", "has the row or column 0"),
        ("3 3 1\n1.7 1 1.0\n", r"has the row or column 1\.7"),
        ("3 3 2\n1 1 1.0\n1 1 1.0\n", "row 1, column 1 is given twice"),
        ("3 3 1\n1 2 1.0\n", "is symmetric, so that it should have the lower triangle alone"),
        ("3 3 1\n1 1 1.0", "ends in the middle of a line"),
        ("3 3 1\n1 1 1.0E\n", "has words that are not numbers"),
        ("3 3\n", "is not the size of a matrix"),
        ("3 3 1000000000\n1 1 1.0\n", "has 3 numbers where its head says 3,000,000,000"),
    ],
)
def test_damaged_matrix_market(model, tmp_path, text, match):
    good = market(tmp_path, *model[2])
    good["path"].write_text("%%MatrixMarket matrix coordinate real symmetric\n" + text)
    refused(match, **good)
    good["path"].write_text("%%MatrixMarket matrix coordinate complex general\n" + text)
    refused("is coordinate complex general; stiffness and mass are real", **good)


def saved(folder, matrix, name="k.npz"):
    from scipy.sparse import save_npz

    save_npz(folder / name, matrix)
    return folder / name


@pytest.mark.parametrize("form", ["csr", "csc", "coo", "bsr"])
@pytest.mark.parametrize("dtype", [float, complex])
def test_npz_of_scipy(model, tmp_path, form, dtype):
    from faying.decks.matrices import read_pair

    K, M, _ = model[2]
    paths = [saved(tmp_path, getattr(A.astype(dtype), f"to{form}")(), f"{k}.npz") for k, A in enumerate((K, M))]
    read = read_pair(*paths, stiffness_unit="N/m", mass_unit="kg")
    assert np.abs(read[0] - K).max() < 1e-12 * np.abs(K).max()
    assert np.abs(read[1] - M).max() < 1e-12 * np.abs(M).max()


def test_npz_of_scipy_with_its_unknowns(model, tmp_path):
    K, M, dofs = model[2]
    given = market(tmp_path, K, M, dofs) | {"path": saved(tmp_path, K, "k.npz"), "mass": saved(tmp_path, M, "m.npz")}
    agrees(model, read_matrices(**given, **UNITS))
    with pytest.raises(faying.InputError, match="k.npz holds one matrix and no nodes; name the mass and the dofs"):
        read_matrices(given["path"], **UNITS)


def parts(matrix, **changes):
    A = matrix.tocsr()
    return {
        "format": np.array(b"csr"),
        "shape": np.array(A.shape),
        "data": A.data,
        "indices": A.indices,
        "indptr": A.indptr,
    } | changes


@pytest.mark.parametrize(
    ("change", "match"),
    [
        (lambda A: {"indices": A.indices + 1000}, "indices must be < 36"),
        (lambda A: {"indices": A.indices - 1}, "indices must be >= 0"),
        (lambda A: {"indices": A.indices + 0.7}, "its indices are float64, not a row of whole numbers"),
        (lambda A: {"indptr": A.indptr[::-1]}, "index pointer should start with 0"),
        (
            lambda A: {"indptr": np.r_[0, 10**15, A.indptr[2:].astype(np.int64)]},
            "indptr must be a non-decreasing",
        ),
        (lambda A: {"indptr": A.indptr[:-1]}, "index pointer size 36 should be 37"),
        (lambda A: {"data": A.data[:-1]}, "indices and data should have the same size"),
        (lambda A: {"data": A.data * (1 + 0.1j)}, "is complex; stiffness and mass are real"),
        (lambda A: {"indices": np.r_[A.indices[1], A.indices[1:]]}, "is given twice"),
        (lambda A: {"format": np.array(b"dia")}, "cannot be read as a sparse matrix of SciPy"),
        (lambda A: {"shape": np.array([36])}, "cannot be read as a sparse matrix of SciPy"),
    ],
)
def test_damaged_npz(model, tmp_path, change, match):
    from faying.decks.matrices import read_pair

    K = model[2][0].tocsr()
    mass = saved(tmp_path, model[2][1], "m.npz")
    np.savez(tmp_path / "k.npz", **parts(K, **change(K)))
    with pytest.raises(faying.InputError, match=match):
        read_pair(tmp_path / "k.npz", mass, stiffness_unit="N/m", mass_unit="kg")


def test_an_npz_that_says_more_than_it_has(model, tmp_path):
    """A header of 1e9 numbers before a few of them: refused by the length of the member, before anything is made."""
    import io
    import zipfile

    from faying.decks.matrices import read_pair

    good = saved(tmp_path, model[2][0])
    head = io.BytesIO()
    np.lib.format.write_array_header_1_0(head, {"descr": "<f8", "fortran_order": False, "shape": (10**9,)})
    with zipfile.ZipFile(good) as old, zipfile.ZipFile(tmp_path / "bad.npz", "w") as new:
        for name in old.namelist():
            new.writestr(name, head.getvalue() + b"0" * 80 if name == "data.npy" else old.read(name))
    with pytest.raises(faying.ReadError, match="data.npy is not as long as it says"):
        read_pair(tmp_path / "bad.npz", good, stiffness_unit="N/m", mass_unit="kg")
    (tmp_path / "cut.npz").write_bytes(good.read_bytes()[:-40])
    with pytest.raises(faying.ReadError, match="cannot be read as a sparse matrix"):
        read_pair(tmp_path / "cut.npz", good, stiffness_unit="N/m", mass_unit="kg")


def test_more_than_the_memory_is_said_first(model, tmp_path, monkeypatch):
    from faying.decks.matrices import read_pair

    path = saved(tmp_path, model[2][0])
    monkeypatch.setenv("FAYING_MEMORY", "1e-6")
    with pytest.raises(faying.InputError, match="k.npz unpacks to .* GB; about .* GB of memory are needed"):
        read_pair(path, path, stiffness_unit="N/m", mass_unit="kg")


def test_total_mass(model):
    """Density times volume, along every axis."""
    from faying.decks.matrices import total_mass

    _, M, dofs = model[2]
    whole = np.full(3, 7800 * 0.04 * 0.02 * 0.01 * 1e-3)
    assert total_mass(M, dofs) == pytest.approx(whole, rel=1e-12)


def test_the_mass_along_what_a_support_holds_is_not_known(model):
    """A support takes rows of the mass with it: what was left came out as the mass along z."""
    from faying.decks.matrices import total_mass

    K, M, dofs = model[2]
    whole = total_mass(M, dofs, K)
    assert np.all(np.isfinite(whole))
    free = ~((dofs[:, 1] == 3) & (dofs[:, 0] <= np.unique(dofs[:, 0])[3]))
    keep = diags_array(free.astype(float)).tocsr()
    held = keep @ K @ keep + diags_array(np.where(free, 0.0, K.diagonal())).tocsr()
    found = total_mass(keep @ M @ keep, dofs, held)
    assert found[:2] == pytest.approx(whole[:2], rel=1e-12)
    assert np.isnan(found[2])


def test_masses_that_differ_along_the_axes_are_refused(model, tmp_path):
    K, M, dofs = model[2]
    odd = M.tolil()
    odd[3, 3] *= 1.5
    refused(
        "the mass that moves along x, y and z is .*; they should be equal", **market(tmp_path, K, odd.tocsr(), dofs)
    )


def test_matrices_of_another_mesh(model):
    mesh, _, matrices = model
    other = Mesh(points=mesh.points, parts=mesh.parts, faces={}, face_part={})
    with pytest.raises(faying.InputError, match="node 1 direction 1 of the mesh is missing"):
        arranged(matrices, other)
    K, M, dofs = matrices
    with pytest.raises(faying.InputError, match="have 35 unknowns and the mesh 36"):
        arranged((K[1:, 1:], M[1:, 1:], dofs[1:]), mesh)
