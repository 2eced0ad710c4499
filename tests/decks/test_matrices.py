"""Matrices of other programs: written by hand and read back, in every format, with their faults."""

import numpy as np
import pytest
from scipy.io import mmwrite

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
    with pytest.raises(faying.InputError, match='does not say its units; .* stiffness_unit = "N/mm", mass_unit = "t"'):
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
    refused("has row 36, but the .dof file lists 1 unknowns", path)
    path = calculix(tmp_path, K, M, dofs)
    path.write_text(path.read_text().rsplit(maxsplit=1)[0])
    refused("is it whole", path)
    path = dmig(tmp_path, K, M, dofs)
    refused("holds no DMIG K2GG; it holds KAAX, MAAX", path, names=("K2GG", "MAAX"))
    path.write_text(path.read_text().replace(f"{6:8d}{2:8d}", f"{6:8d}{4:8d}"))
    refused("DMIG KAAX is complex", path)
    path.write_text("DMIG    KAAX           1       x\n")
    refused("cannot be read", path)


def test_matrices_of_another_mesh(model):
    mesh, _, matrices = model
    other = Mesh(points=mesh.points, parts=mesh.parts, faces={}, face_part={})
    with pytest.raises(faying.InputError, match="node 1 direction 1 of the mesh is missing"):
        arranged(matrices, other)
    K, M, dofs = matrices
    with pytest.raises(faying.InputError, match="have 35 unknowns and the mesh 36"):
        arranged((K[1:, 1:], M[1:, 1:], dofs[1:]), mesh)
