"""Stiffness and mass matrices that other programs have assembled: CalculiX, Matrix Market, Nastran DMIG."""

from pathlib import Path
from typing import Any

import numpy as np

from faying import units
from faying.decks.programs import MATRICES, reader_of
from faying.decks.raw import Matrices, read_dofs
from faying.errors import InputError, ReadError
from faying.fe.mesh import Mesh
from faying.typing import Index

SYMMETRIC = 1e-8  # largest difference from the transpose, relative to the largest entry


def read_matrices(
    path: str | Path,
    *,
    stiffness_unit: str | None = None,
    mass_unit: str | None = None,
    mass: str | Path | None = None,
    dofs: str | Path | None = None,
    names: tuple[str, str] = ("KAAX", "MAAX"),
) -> Matrices:
    """Read the stiffness and the mass that another program has assembled.

    Args:
        path: job.sti of CalculiX's SOLVER=MATRIXSTORAGE, with job.mas and job.dof beside it; or the stiffness as Matrix
            Market (.mtx); or Nastran bulk data (.bdf, .nas, .dat, .pch) with DMIG entries.
        stiffness_unit: Unit of the stiffness, such as "N/mm"; no format says it.
        mass_unit: Unit of the mass, such as "t".
        mass: With .mtx, the mass as another such file.
        dofs: With .mtx, a text file with "node direction" or "node.direction" in each line.
        names: With DMIG, names of stiffness and mass.

    Returns:
        K [N/m] and M [kg], sparse CSR (n, n), and dofs (n, 2): number of the node, direction 1, 2, 3.

    Raises:
        ReadError: A file is missing, damaged or cut short.
        InputError: Matrices are not square, of one size, real and symmetric, or unknowns have no stiffness.
    """
    file = Path(path)
    if stiffness_unit is None or mass_unit is None:
        raise InputError(
            f'{file.name} does not say its units; say them, for example stiffness_unit = "N/mm", mass_unit = "t"'
        )
    scales = units.scale(stiffness_unit, "N/m", name="stiffness_unit"), units.scale(mass_unit, "kg", name="mass_unit")
    if file.suffix.lower() == ".mtx":
        if mass is None or dofs is None:
            raise InputError(
                f"{file.name}: Matrix Market holds one matrix and no nodes; name the mass and the dofs too"
            )
        K, M, table = _market(file), _market(Path(mass)), read_dofs(Path(dofs))
    else:
        K, M, table = reader_of(file, MATRICES, (".mtx",)).read_matrices(file, names)
    _check(file.name, K, M, table)
    return (K * scales[0]).tocsr(), (M * scales[1]).tocsr(), table


def read_pair(
    stiffness: str | Path, mass: str | Path | None = None, *, stiffness_unit: str, mass_unit: str
) -> Matrices:
    """Read K [N/m], M [kg] and dofs as `read_matrices` does, with no list of unknowns for Matrix Market and SciPy's .npz.

    Without a list, each unknown counts as direction 1 of a node of its own. Raises what `read_matrices` raises.
    """
    file = Path(stiffness)
    kinds = {".mtx": _market, ".npz": _npz}
    if file.suffix.lower() not in kinds:
        if mass is not None:
            raise InputError(f"{file.name} brings its mass with it; leave out {mass}")
        return read_matrices(file, stiffness_unit=stiffness_unit, mass_unit=mass_unit)
    if mass is None:
        raise InputError(f"{file.name} holds the stiffness alone; name the mass too, .mtx or .npz")
    other = Path(mass)
    if other.suffix.lower() not in kinds:
        raise ReadError(f"{other}: the mass should be .mtx or .npz")
    K = kinds[file.suffix.lower()](file) * units.scale(stiffness_unit, "N/m", name="stiffness unit")
    M = kinds[other.suffix.lower()](other) * units.scale(mass_unit, "kg", name="mass unit")
    table = np.column_stack([np.arange(1, K.shape[0] + 1), np.ones(K.shape[0], dtype=np.int64)])
    _check(file.name, K, M, table)
    return K.tocsr(), M.tocsr(), table


def _npz(path: Path) -> Any:
    from scipy.sparse import csr_array, load_npz

    if not path.is_file():
        raise ReadError(f"no file {path}")
    try:
        return csr_array(load_npz(path))
    except Exception as fault:  # zip, pickle and key errors
        raise ReadError(f"{path} cannot be read as a sparse matrix of SciPy ({fault})") from None


def arranged(matrices: Matrices, mesh: Mesh) -> tuple[Any, Any]:
    """K and M in the order of a mesh's unknowns, node by node x, y, z, through the numbers of its nodes.

    Raises InputError where the matrices hold other nodes or directions than the mesh.
    """
    K, M, dofs = matrices
    wanted = np.column_stack([np.repeat(mesh.numbers, 3), np.tile([1, 2, 3], len(mesh.numbers))])
    place = {(int(node), int(axis)): i for i, (node, axis) in enumerate(dofs)}
    lost = [(int(node), int(axis)) for node, axis in wanted if (int(node), int(axis)) not in place]
    if lost or len(dofs) != len(wanted):
        what = f"node {lost[0][0]} direction {lost[0][1]} of the mesh is missing" if lost else "the matrices hold more"
        raise InputError(
            f"the matrices have {len(dofs)} unknowns and the mesh {len(wanted)}: {what}; export both from one model, "
            "without supports"
        )
    order = np.array([place[int(node), int(axis)] for node, axis in wanted])
    return K[order][:, order].tocsr(), M[order][:, order].tocsr()


def _market(path: Path) -> Any:
    from scipy.io import mmread
    from scipy.sparse import csr_array

    if not path.is_file():
        raise ReadError(f"no file {path}")
    try:
        return csr_array(mmread(path))
    except Exception as fault:  # a reader in C++ that raises many kinds
        raise ReadError(f"{path} cannot be read as Matrix Market ({fault})") from None


def _check(name: str, K: Any, M: Any, dofs: Index) -> None:
    for what, A in (("stiffness", K), ("mass", M)):
        if A.shape != (len(dofs), len(dofs)):
            raise InputError(
                f"{name}: the {what} matrix is {A.shape[0]} x {A.shape[1]} for {len(dofs)} unknowns; all must be of "
                "one model"
            )
        if not np.all(np.isfinite(A.data)):
            raise InputError(f"{name}: the {what} matrix holds numbers that are not finite")
        differ = abs(A - A.T)
        if A.nnz and differ.max() > SYMMETRIC * abs(A).max():
            i = int(np.argmax(differ.max(axis=1).toarray().ravel()))
            raise InputError(
                f"{name}: the {what} matrix is not symmetric ({differ.max() / abs(A).max():.1e} of its largest entry, "
                f"at node {dofs[i, 0]} direction {dofs[i, 1]}); export it without contact, friction or rotors"
            )
    pairs, count = np.unique(dofs, axis=0, return_counts=True)
    if np.any(count > 1):
        node, axis = pairs[count > 1][0]
        raise InputError(f"{name}: node {node} direction {axis} is listed twice")
    for what, values in (("stiffness", K.diagonal()), ("mass", M.diagonal())):
        bad = values <= 0 if what == "stiffness" else values < 0
        if np.any(bad):
            node, axis = dofs[bad][0]
            raise InputError(
                f"{name}: {np.count_nonzero(bad)} unknowns have no positive {what}, node {node} direction {axis} for "
                "one, so that the matrix is singular; leave such nodes out of the export"
            )
    if M.nnz == 0 or M.diagonal().sum() <= 0:
        raise InputError(f"{name}: the mass matrix is zero; give the material a density")
