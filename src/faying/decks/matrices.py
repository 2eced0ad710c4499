"""Stiffness and mass matrices that other programs have assembled: CalculiX, Matrix Market, Nastran DMIG."""

from pathlib import Path
from typing import Any

import numpy as np

from faying import units
from faying.decks.programs import reader_of
from faying.decks.raw import Matrices, both_triangles, numbers_of, once, read_dofs, read_text, room, whole
from faying.errors import InputError, ReadError
from faying.fe.mesh import Mesh
from faying.file_kinds import MARKET, SPARSE, kind_of
from faying.misuse import checked_call
from faying.typing import Array, Index

RESISTED = 1e-7  # of the energy of a translation without signs: digits that a file leaves out
ALONE = (MARKET, SPARSE)  # files of one matrix, without its nodes
SYMMETRIC = 1e-8  # largest difference from the transpose, relative to the largest entry


@checked_call
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
            Market (.mtx) or of SciPy (.npz); or Nastran bulk data (.bdf, .nas, .dat, .pch) with DMIG entries.
        stiffness_unit: Unit of the stiffness, such as "N/mm"; no format says it.
        mass_unit: Unit of the mass, such as "t".
        mass: With .mtx and .npz, the mass as another such file.
        dofs: With .mtx and .npz, a text file with "node direction" or "node.direction" in each line.
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
            f'{file.name} does not state its units; give them, for example stiffness_unit = "N/mm", mass_unit = "t"'
        )
    scales = units.scale(stiffness_unit, "N/m", name="stiffness_unit"), units.scale(mass_unit, "kg", name="mass_unit")
    if kind_of(file) in ALONE:
        if mass is None or dofs is None:
            raise InputError(f"{file.name} holds one matrix and no nodes; name the mass and the dofs too")
        K, M, table = _matrix(file), _matrix(Path(mass)), read_dofs(Path(dofs))
    else:
        K, M, table = reader_of(file, "matrices").read_matrices(file, names)
    _check(file.name, K, M, table)
    _check_mass(file.name, M, table)
    return (K * scales[0]).tocsr(), (M * scales[1]).tocsr(), table


def total_mass(mass: Any, dofs: Index, stiffness: Any = None) -> Array:
    """Total mass along x, y and z (3,), in the unit of the matrix: what a motion of all nodes as one meets.

    NaN along what no unknown is said to move in, and where the stiffness resists it: supports take mass with them.
    """
    moved = (dofs[:, 1:] == np.array([1, 2, 3])).astype(float)
    known = moved.any(axis=0)
    if stiffness is not None:
        energy, own = (np.einsum("ij,ij->j", moved, K @ moved) for K in (stiffness, abs(stiffness)))
        known &= energy <= RESISTED * own
    return np.where(known, np.einsum("ij,ij->j", moved, mass @ moved), np.nan)


def _check_mass(name: str, M: Any, dofs: Index) -> None:
    """Where every node moves in x, y and z, all three meet one mass; a matrix cut short has different ones."""
    _, count = np.unique(dofs[:, 0], return_counts=True)
    if set(dofs[:, 1].tolist()) != {1, 2, 3} or not np.all(count == 3):
        return
    totals = total_mass(M, dofs)
    if np.ptp(totals) > SYMMETRIC * 100 * totals.max():
        raise InputError(
            f"{name}: the mass that moves along x, y and z is {', '.join(f'{m:.6g}' for m in totals)}; they should be "
            "equal: is the mass matrix complete?"
        )


def read_pair(
    stiffness: str | Path, mass: str | Path | None = None, *, stiffness_unit: str, mass_unit: str
) -> Matrices:
    """Read K [N/m], M [kg] and dofs as `read_matrices` does, also .mtx and .npz without a list of dofs.

    Without a list, each unknown is a node of its own, and moves in direction 0: in one that is not known. Raises what
    `read_matrices` raises.
    """
    file = Path(stiffness)
    if kind_of(file) not in ALONE:
        if mass is not None:
            raise InputError(f"{file.name} brings its mass with it; leave out {mass}")
        return read_matrices(file, stiffness_unit=stiffness_unit, mass_unit=mass_unit)
    if mass is None:
        raise InputError(f"{file.name} holds the stiffness alone; name the mass too, .mtx or .npz")
    K = _matrix(file) * units.scale(stiffness_unit, "N/m", name="stiffness unit")
    M = _matrix(Path(mass)) * units.scale(mass_unit, "kg", name="mass unit")
    table = np.column_stack([np.arange(1, K.shape[0] + 1), np.zeros(K.shape[0], dtype=np.int64)])
    _check(file.name, K, M, table)
    return K.tocsr(), M.tocsr(), table


def arranged(matrices: Matrices, mesh: Mesh) -> tuple[Any, Any]:
    """K and M in the order of a mesh's unknowns, node by node x, y, z, through the numbers of its nodes.

    Raises InputError where the matrices hold other nodes or directions than the mesh.
    """
    K, M, dofs = matrices
    wanted = [(node, axis) for node in mesh.numbers.tolist() for axis in (1, 2, 3)]
    place = {(node, axis): i for i, (node, axis) in enumerate(dofs.tolist())}
    lost = [one for one in wanted if one not in place]
    if lost or len(dofs) != len(wanted):
        what = f"node {lost[0][0]} direction {lost[0][1]} of the mesh is missing" if lost else "the matrices have more"
        raise InputError(
            f"the matrices have {len(dofs)} unknowns and the mesh {len(wanted)}: {what}; export both from one model, "
            "without supports"
        )
    order = [place[one] for one in wanted]
    return K[order][:, order].tocsr(), M[order][:, order].tocsr()


def _matrix(path: Path) -> Any:
    """The one matrix of a file. Raises ReadError where it is none."""
    kind = kind_of(path)
    if kind not in ALONE:
        raise ReadError(f"{path} does not hold one matrix; give it as .mtx or .npz")
    if not path.is_file():
        raise ReadError(f"no file {path}")
    return _market(path) if kind is MARKET else _npz(path)


def _npz(path: Path) -> Any:
    """A matrix that SciPy has saved; what SciPy would take without a word is checked."""
    from scipy.sparse import load_npz

    try:
        _check_members(path)
        found = load_npz(path)
        if found.format in ("csr", "csc", "bsr"):
            found.check_format(full_check=True)
        entries = found.tocoo()
        if np.any(np.imag(entries.data)):
            raise InputError(f"{path} is complex; stiffness and mass are real, a loss is a matrix of its own")
        return _from_entries(path, entries.row, entries.col, np.real(entries.data).astype(float), entries.shape)
    except InputError:
        raise
    except Exception as fault:  # of zip, zlib, heads of arrays and SciPy's checks
        raise ReadError(f"{path} cannot be read as a sparse matrix of SciPy ({fault!r}); save it again") from None


def _check_members(path: Path) -> None:
    """Raise ReadError where an array of a .npz is shorter than it says or its indices are not whole numbers.

    Raises InputError where they do not fit into the memory.
    """
    from zipfile import ZipFile

    from numpy.lib import format as npy

    with ZipFile(path) as archive:
        room(sum(member.file_size for member in archive.infolist()), path.name)
        for member in archive.infolist():
            with archive.open(member) as stream:
                read = npy.read_array_header_1_0 if npy.read_magic(stream) == (1, 0) else npy.read_array_header_2_0
                shape, _, kind = read(stream)
                if int(np.prod(shape, dtype=object)) * kind.itemsize != member.file_size - stream.tell():
                    raise ReadError(f"{path}: {member.filename} is not as long as it says; save it again")
            name = member.filename.removesuffix(".npy")
            if name in ("indices", "indptr", "row", "col", "coords") and not np.issubdtype(kind, np.integer):
                raise ReadError(f"{path}: its {name} are {kind}, not a row of whole numbers; save it again")


def _from_entries(path: Path, rows: Index, columns: Index, values: Any, shape: tuple[int, ...]) -> Any:
    from scipy.sparse import coo_array

    once(path.name, rows, columns, shape[1])
    return coo_array((values, (rows, columns)), shape=shape).tocsr()


def _market(path: Path) -> Any:
    """A real matrix as Matrix Market, coordinate or array; SciPy's own reader crashes on some that are cut short."""
    head, _, rest = read_text(path, "matrix").partition("\n")
    words = head.lower().split()
    if len(words) != 5 or words[:2] != ["%%matrixmarket", "matrix"]:
        raise ReadError(f"{path} cannot be read as Matrix Market: it does not begin with %%MatrixMarket matrix")
    _, _, form, kind, symmetry = words
    known = ("coordinate", "array"), ("real", "integer"), ("general", "symmetric")
    if not all(word in allowed for word, allowed in zip((form, kind, symmetry), known, strict=True)):
        raise ReadError(f"{path} is {form} {kind} {symmetry}; stiffness and mass are real and general or symmetric")
    while rest.startswith("%") or rest[:1] == "\n":
        rest = rest.partition("\n")[2]
    size, _, body = rest.partition("\n")
    if not size.replace(" ", "").isdigit() or len(size.split()) != (3 if form == "coordinate" else 2):
        raise ReadError(f"{path}: {size.strip()[:60]!r} is not the size of a matrix; is the file complete?")
    rows, columns, *entries = map(int, size.split())
    if form == "array":
        if symmetry != "general":
            raise ReadError(f"{path} is an array of one triangle; write it as coordinate")
        values = numbers_of(path, body, rows * columns).reshape(columns, rows).T
        i, j = np.nonzero(values)
        return _from_entries(path, i, j, values[i, j], (rows, columns))
    table = numbers_of(path, body, 3 * entries[0]).reshape(-1, 3)
    i, j = (whole(path, table[:, k], size) for k, size in ((0, rows), (1, columns)))
    A = _from_entries(path, i, j, table[:, 2], (rows, columns))
    if symmetry == "general":
        return A
    if np.any(i < j):
        raise ReadError(f"{path} is symmetric, so that it should have the lower triangle alone")
    return both_triangles(A)


def _check(name: str, K: Any, M: Any, dofs: Index) -> None:
    for what, A in (("stiffness", K), ("mass", M)):
        if A.shape != (len(dofs), len(dofs)):
            raise InputError(
                f"{name}: the {what} matrix is {A.shape[0]} x {A.shape[1]} for {len(dofs)} unknowns; all must be of "
                "one model"
            )
        if not np.all(np.isfinite(A.data)):
            raise InputError(f"{name}: the {what} matrix has numbers that are not finite")
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
    own = K.diagonal()
    # a motion of a reduced model that nothing resists has a stiffness of 0, of either sign by rounding
    none = (own <= 0) & ((M.diagonal() <= 0) | (abs(K).sum(axis=0) == 0)) | (own < -SYMMETRIC * abs(K).max())
    for what, bad in (("stiffness", none), ("mass", M.diagonal() < 0)):
        if np.any(bad):
            node, axis = dofs[bad][0]
            raise InputError(
                f"{name}: {np.count_nonzero(bad)} unknowns have no positive {what}, node {node} direction {axis} for "
                "one, so that the matrix is singular; leave such nodes out of the export"
            )
    if M.nnz == 0 or M.diagonal().sum() <= 0:
        raise InputError(f"{name}: the mass matrix is zero; give the material a density")
    for what, A in (("stiffness", K), ("mass", M)):
        # no entry of a matrix that costs or stores energy is greater than the mean of its two diagonals
        entries, diagonal = A.tocoo(), A.diagonal()
        allowed = diagonal[entries.row] * diagonal[entries.col] + (SYMMETRIC * abs(A).max()) ** 2
        too_large = entries.data**2 > (1 + SYMMETRIC) * allowed
        if np.any(too_large):
            (a, b), (c, d) = dofs[entries.row[too_large][0]], dofs[entries.col[too_large][0]]
            raise InputError(
                f"{name}: {np.count_nonzero(too_large)} entries of the {what} matrix are greater than their diagonals "
                "allow, that of node "
                f"{a} direction {b} and node {c} direction {d} for one: the matrix is cut short or not positive"
            )
