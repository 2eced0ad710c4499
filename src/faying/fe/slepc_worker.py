"""Lowest modes of assembled matrices by SLEPc, over many processes and machines.

    mpiexec -n 4 python3 slepc_worker.py stiffness.npz mass.npz --count 20 --shift 100

Imports only NumPy, SciPy, petsc4py and slepc4py, so that the file runs in a Python without Faying, such as Debian's
(packages python3-slepc4py and python3-petsc4py). Each process keeps its own rows; the factorisation is MUMPS's, spread
over all of them. Matrices as SciPy's .npz or as Matrix Market, N/m and kg; every process reads the whole files once.
"""

import argparse
import glob
import json
import sys
from typing import Any

import numpy as np

SEED = 20240611


def load() -> tuple[Any, Any]:
    """petsc4py.PETSc and slepc4py.SLEPc. Raises ImportError where there are none, or none that fits this NumPy."""
    try:
        import slepc4py

        slepc4py.init(["faying"])
        from petsc4py import PETSc
        from slepc4py import SLEPc
    except ValueError as fault:
        raise ImportError(str(fault)) from None
    return PETSc, SLEPc


def read(path: str) -> Any:
    """A sparse matrix as CSR."""
    from scipy.io import mmread
    from scipy.sparse import csr_matrix, load_npz

    return csr_matrix(mmread(path) if path.endswith(".mtx") else load_npz(path))


def lowest(stiffness: Any, mass: Any, count: int, shift_frequency: float) -> tuple[Any, dict[str, Any]]:
    """The `count` lowest frequencies [Hz] and what solved them; the same in every process.

    stiffness [N/m], mass [kg]: CSR, the same in every process; shift_frequency [Hz]: the shift -(2 pi f)^2 at which
    K + |shift| M is factorised. Raises RuntimeError where fewer modes converge.
    """
    PETSc, SLEPc = load()
    world = PETSc.COMM_WORLD
    shift = (2 * np.pi * shift_frequency) ** 2
    K, M = _spread(PETSc, stiffness), _spread(PETSc, mass)
    solver = SLEPc.EPS().create(world)
    solver.setOperators(K, M)
    solver.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    solver.setType(SLEPc.EPS.Type.KRYLOVSCHUR)
    solver.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
    solver.setTarget(-shift)
    solver.setDimensions(count)
    solver.setTolerances(1e-12, 500)
    turned = solver.getST()
    turned.setType(SLEPc.ST.Type.SINVERT)
    turned.setShift(-shift)
    inner = turned.getKSP()
    inner.setType(PETSc.KSP.Type.PREONLY)
    inner.getPC().setType(PETSc.PC.Type.CHOLESKY)
    inner.getPC().setFactorSolverType("mumps")
    first = K.createVecLeft()
    begin, end = first.getOwnershipRange()
    first.setArray(np.random.default_rng(SEED).standard_normal(stiffness.shape[0])[begin:end])
    solver.setInitialSpace(first)
    solver.solve()
    found = solver.getConverged()
    if found < count:
        raise RuntimeError(f"{found} of {count} modes converged")
    values, x, Kx, Mx = [], K.createVecRight(), K.createVecLeft(), K.createVecLeft()
    for i in range(count):  # Rayleigh quotients restore what the shifted inverse has lost
        solver.getEigenpair(i, x)
        K.mult(x, Kx)
        M.mult(x, Mx)
        values.append(x.dot(Kx) / x.dot(Mx))
    frequencies = np.sqrt(np.abs(np.sort(values))) / (2 * np.pi)
    return frequencies, {
        "processes": world.getSize(),
        "rank": world.getRank(),
        "solver": "SLEPc Krylov-Schur, MUMPS",
        "unknowns": int(stiffness.shape[0]),
    }


def _spread(PETSc: Any, matrix: Any) -> Any:
    """The rows of this process as a PETSc matrix."""
    n = matrix.shape[0]
    world = PETSc.COMM_WORLD
    size, rank = world.getSize(), world.getRank()
    begin, end = n * rank // size, n * (rank + 1) // size
    low, high = matrix.indptr[begin], matrix.indptr[end]
    rows = (matrix.indptr[begin : end + 1] - low).astype(PETSc.IntType)
    made = PETSc.Mat().createAIJ(
        size=((end - begin, n), (end - begin, n)),
        comm=world,
        csr=(rows, matrix.indices[low:high].astype(PETSc.IntType), matrix.data[low:high]),
    )
    made.assemble()
    return made


def main() -> None:
    """Command line of the file on its own."""
    ask = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    ask.add_argument("stiffness")
    ask.add_argument("mass")
    ask.add_argument("--count", type=int, default=20)
    ask.add_argument("--shift", type=float, required=True, help="Hz, below the first elastic mode")
    given = ask.parse_args()
    for package in ("petsc", "slepc"):  # where Debian keeps them
        sys.path += glob.glob(f"/usr/lib/{package}dir/{package}*/*-real/lib/python3/dist-packages")
    frequencies, facts = lowest(read(given.stiffness), read(given.mass), given.count, given.shift)
    if facts.pop("rank") == 0:
        print(json.dumps(facts | {"frequencies": {"unit": "Hz", "values": frequencies.tolist()}}))


if __name__ == "__main__":
    main()
