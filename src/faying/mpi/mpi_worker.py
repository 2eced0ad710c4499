"""Lowest modes by SLEPc over the processes of mpiexec; `faying.mpi.modes` starts it and reads what it leaves.

    mpiexec -n 4 python3 mpi_worker.py FOLDER

Imports only NumPy, petsc4py, slepc4py, and lobpcg.py and mpi_petsc.py beside it, so that it runs in a Python without
Faying, such as Debian's. FOLDER holds order.json and one folder for each process, as `faying.mpi.partition` writes
them; each process reads its own alone.

The pencil is (A, M) with A = K + s M, whose eigenvalues are those of K raised by s. Where the coordinates of the nodes
are known it is solved by LOBPCG (Knyazev 2001, doi:10.1137/S1064827500366124), preconditioned by smoothed aggregation
with the rigid motions as near null space (PETSc's GAMG); elsewhere by Krylov-Schur and MUMPS.
"""

import json
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from faying.mpi.lobpcg import Lobpcg
    from faying.mpi.mpi_petsc import check_size, guarded, load, multigrid, peak_memory, read_matrix, rigid_motions
else:  # beside this file, which is run as a script
    from lobpcg import Lobpcg
    from mpi_petsc import check_size, guarded, load, multigrid, peak_memory, read_matrix, rigid_motions

GUARDS = 8  # vectors of the block beyond the modes that are wanted, 6 or more
SEED = 20240611
FIRST = 0.1  # of the tolerance: what the preconditioner estimates falls short of the error by about that much
ATTEMPTS, MAX_STEPS = 4, 500
EXACT = 1e-12  # residual that is asked of a factorisation
GAP = 0.3  # of the eigenvalue of the last mode, to the first beyond its block


class Worker:
    """What one process does: its rows of A and M, and the modes it finds with the others."""

    def __init__(self, folder: Path) -> None:
        self.PETSc, self.SLEPc = load()
        self.world = self.PETSc.COMM_WORLD
        self.order = json.loads((folder / "order.json").read_text(encoding="utf-8"))
        check_size(self.world, self.order["processes"])
        self.place = folder / str(self.world.getRank())
        self.points = np.load(self.place / "points.npy") if self.order["points"] else None
        block = 1 if self.points is None else 3
        self.A, self.M = (read_matrix(self.PETSc, self.place, name, block) for name in ("operator", "mass"))
        self._sums: dict[int, Any] = {}  # vectors that sum so many entries

    def modes(self) -> dict[str, Any]:
        """Eigenvalues of K [1/s2], estimated errors of them, and how they were found."""
        return self._by_factor() if self.points is None else self._by_multigrid()

    def _by_factor(self) -> dict[str, Any]:
        """Krylov-Schur with shift and invert at -s, where A is what is factorised."""
        count = self.order["count"]
        solver = self.SLEPc.EPS().create(self.world)
        solver.setOperators(self.A, self.M)
        solver.setProblemType(self.SLEPc.EPS.ProblemType.GHEP)
        solver.setWhichEigenpairs(self.SLEPc.EPS.Which.TARGET_MAGNITUDE)
        solver.setTarget(0.0)
        solver.setDimensions(count)
        solver.setTolerances(EXACT, MAX_STEPS)
        turned = solver.getST()
        turned.setType("sinvert")
        inner = turned.getKSP()
        inner.setType("preonly")
        inner.getPC().setType("cholesky")
        inner.getPC().setFactorSolverType("mumps")
        solver.solve()
        found = solver.getConverged()
        if found < count:
            raise RuntimeError(f"{found} of {count} modes converged")
        values, vector, image = [], self.A.createVecRight(), self.A.createVecLeft()
        for number in range(count):  # Rayleigh quotients restore what the shifted inverse has lost
            solver.getEigenpair(number, vector)
            self.A.mult(vector, image)
            upper = vector.dot(image)
            self.M.mult(vector, image)
            values.append(upper / vector.dot(image))
        return self._answer(
            "SLEPc Krylov-Schur, MUMPS", np.sort(values), np.full(count, EXACT), solver.getIterationNumber()
        )

    def _by_multigrid(self) -> dict[str, Any]:
        """LOBPCG from the rigid motions and random vectors, until the error is small enough."""
        motions, count, most = rigid_motions(self.A, self.points), self.order["count"], self.order["tolerance"]
        self.multigrid = multigrid(self.PETSc, self.A, motions)
        random = np.random.default_rng([SEED, self.world.getRank()])
        start = random.standard_normal((self.A.getLocalSize()[0], count + GUARDS - len(motions)))
        start = self.precondition(self.mass(start))  # low motions of every shape
        found = Lobpcg(self, np.column_stack([*(motion.getArray() for motion in motions), start]), count)
        goal = FIRST * most
        for _ in range(ATTEMPTS):
            found.run(goal)
            error = np.zeros(count) if found.values[0] <= 0 else self._error(found)  # unstable, which the caller says
            if error.max() < most:
                return self._answer("LOBPCG, PETSc GAMG", found.values[:count], error, found.steps)
            goal *= 0.5 * most / error.max()
        raise RuntimeError(f"the estimated error stays at {error.max():.1e} after {found.steps} iterations")

    def operator(self, vectors: Any) -> Any:
        """A times the vectors (rows, k) of all processes."""
        return self._times(self.A, vectors)

    def mass(self, vectors: Any) -> Any:
        """M times the vectors (rows, k) of all processes."""
        return self._times(self.M, vectors)

    def precondition(self, vectors: Any) -> Any:
        """One cycle of multigrid for each of the vectors (rows, k)."""
        out, answer = np.empty(vectors.shape, order="F"), self.A.createVecRight()
        for column in range(vectors.shape[1]):
            right = self.PETSc.Vec().createWithArray(vectors[:, column], comm=self.world)
            self.multigrid.apply(right, answer)
            out[:, column] = answer.getArray()
            right.destroy()
        answer.destroy()
        return out

    def total(self, share: Any) -> Any:
        """The sum of an array over all processes; each entry is added up by one of them, for all."""
        flat = np.ascontiguousarray(share, dtype=float).ravel()
        if len(flat) not in self._sums:
            made = self.PETSc.Vec().createMPI(len(flat), comm=self.world)
            self._sums[len(flat)] = made, *self.PETSc.Scatter.toAll(made)
        made, gather, everything = self._sums[len(flat)]
        made.set(0.0)
        made.setValues(np.arange(len(flat), dtype=self.PETSc.IntType), flat, addv=True)
        made.assemble()
        gather.scatter(made, everything)
        return everything.getArray().copy().reshape(np.shape(share))

    def _times(self, matrix: Any, vectors: Any) -> Any:
        rows, width = vectors.shape
        given = self.PETSc.Mat().createDense(
            ((rows, None), (None, width)), array=np.asfortranarray(vectors), comm=self.world
        )
        answer = matrix.matMult(given)
        out = np.array(answer.getDenseArray(), order="F")
        given.destroy()
        answer.destroy()
        return out

    def _error(self, found: Lobpcg) -> Any:
        """Estimated relative errors of the eigenvalues of K: r' A^-1 r over their size and over the gap to the next.

        The preconditioner stands for A^-1. By how much it falls short is measured on two of the modes: the worst, and
        the lowest that is not rigid, since low motions are what a preconditioner knows least.
        """
        shift, count = self.order["shift"], self.order["count"]
        values = found.values[:count]
        solver = self.PETSc.KSP().create(self.world)
        solver.setType("cg")
        solver.setOperators(self.A)
        solver.setPC(self.multigrid)
        solver.setTolerances(rtol=1e-2, max_it=MAX_STEPS)
        answer, short = self.A.createVecRight(), 1.0
        lowest = min(int(np.count_nonzero(values < 2 * shift)), count - 1)
        for number in {lowest, int(np.argmax(found.left[:count]))}:
            right = self.PETSc.Vec().createWithArray(found.residual([number])[:, 0], comm=self.world)
            solver.solve(right, answer)
            short = max(short, abs(right.dot(answer)) / (found.values[number] * found.left[number]))
        return found.left[:count] * short * values / np.maximum(values - shift, shift) / GAP

    def _answer(self, solver: str, values: Any, error: Any, steps: int) -> dict[str, Any]:
        values = np.asarray(values) - self.order["shift"]
        return {"solver": solver, "values": values.tolist(), "error": error.tolist(), "iterations": steps}


def work(folder: Path) -> None:
    """Find the modes, and leave what they are and what they took."""
    worker = Worker(folder)
    try:
        answer = worker.modes()
    except RuntimeError as fault:
        if isinstance(fault, worker.PETSc.Error):  # may have met this process alone
            raise
        answer = {"fault": str(fault)}
    cost = {"cpu": time.process_time(), "peak": peak_memory()}
    (worker.place / "cost.json").write_text(json.dumps(cost), encoding="utf-8")
    if worker.world.getRank() == 0:
        (folder / "answer.json").write_text(json.dumps(answer), encoding="utf-8")


def main() -> None:
    """Serve the folder of the command line; without one, say by the exit status whether this Python can."""
    if len(sys.argv) < 2:
        load()
        return
    folder = Path(sys.argv[1])
    guarded(folder, lambda: work(folder))


if __name__ == "__main__":
    main()
