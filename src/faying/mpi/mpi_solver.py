"""Solutions of A x = b by PETSc over the processes of mpiexec, as often as they are asked for.

    mpiexec -n 4 python3 mpi_solver.py FOLDER 4

`faying.mpi.over_mpi` starts it. Imports only NumPy and petsc4py, so that it runs in a Python without Faying, such as
Debian's. FOLDER holds one folder for each process, with the coordinates of its nodes where they are known and, as they
come, its rows of matrices and of right-hand sides; and the file `order`, one line that is written anew for each order:

    NUMBER WORD MATRIX REDUCTION NUMBER

MATRIX is a number. WORD is `matrix` (take its rows from operator_*.npy, and make its multigrid, or without coordinates
its factor by MUMPS), `drop` (give it up), `solve` (right.npy, each column until its residual has fallen by REDUCTION,
to solved.npy) or `end`. All processes look for the next order, asleep in between: to wait inside MPI would take a core.
Once all are through, the first says so in one line of its output, which begins with `ANSWER`.
"""

import glob
import json
import os
import shutil
import sys
import threading
import time
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

ANSWER = "faying-answer "  # how an answer begins among other lines of the processes
THRESHOLD = 0.01  # of GAMG: weaker couplings do not make aggregates, so that none reaches across a soft joint
MAX_STEPS = 1000
SOON, LATER, SLOWER = 2e-4, 1e-2, 1.3  # s between two looks for an order: at first, at most, and the growth between


def load() -> Any:
    """petsc4py.PETSc. Raises ImportError where there is none, or none that fits this NumPy."""
    sys.path += glob.glob("/usr/lib/petscdir/petsc*/*-real/lib/python3/dist-packages")  # where Debian keeps it
    try:
        import petsc4py

        petsc4py.init(["faying"])
        from petsc4py import PETSc
    except ValueError as fault:
        raise ImportError(str(fault)) from None
    return PETSc


def peak_memory() -> float:
    """Most memory [B] that this process has held; NaN where the system does not say it."""
    try:
        import resource
    except ImportError:
        return float("nan")
    unit = 1.0 if sys.platform == "darwin" else 1024.0
    return unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def read_matrix(PETSc: Any, place: Path, block: int) -> Any:
    """A symmetric positive definite matrix of all processes, of whose rows this one reads its own, once.

    place: the folder of this process, as `faying.mpi.partition` writes it; block: unknowns of a node.
    """
    csr = []
    for what, kind in {"starts": PETSc.IntType, "columns": PETSc.IntType, "values": float}.items():
        file = place / f"operator_{what}.npy"
        csr.append(np.load(file).astype(kind, copy=False))
        file.unlink()
    rows = len(csr[0]) - 1
    made = PETSc.Mat().createAIJ(size=((rows, None), (rows, None)), bsize=block, csr=tuple(csr), comm=PETSc.COMM_WORLD)
    made.setOption(PETSc.Mat.Option.SYMMETRIC, True)
    made.setOption(PETSc.Mat.Option.SPD, block > 1)  # MUMPS then counts negative eigenvalues
    return made


def rigid_motions(matrix: Any, points: Any) -> list[Any]:
    """Six rigid motions of the whole, orthonormal; points (nodes, 3): those of this process."""
    x, y, z = points.T
    none, one = np.zeros_like(x), np.ones_like(x)
    fields = [(one, none, none), (none, one, none), (none, none, one)]
    fields += [(none, -z, y), (z, none, -x), (-y, x, none)]
    out: list[Any] = []
    for field in fields:
        motion = matrix.createVecRight()
        motion.setArray(np.stack(field, axis=1).ravel())
        for _ in range(2):
            for other in out:
                motion.axpy(-motion.dot(other), other)
        motion.normalize()
        out.append(motion)
    return out


def multigrid(PETSc: Any, matrix: Any, motions: list[Any]) -> Any:
    """Smoothed aggregation for a matrix, with the rigid motions as near null space."""
    matrix.setNearNullSpace(PETSc.NullSpace().create(vectors=motions, comm=PETSc.COMM_WORLD))
    PETSc.Options().setValue("pc_gamg_threshold", THRESHOLD)
    made = PETSc.PC().create(PETSc.COMM_WORLD)
    made.setOperators(matrix)
    made.setType("gamg")
    made.setFromOptions()
    made.setUp()
    return made


def _watch(folder: Path) -> None:
    """End this process, and with it all others, when the one that started them is gone: its pipe then closes.

    folder: what that one would have removed.
    """
    if sys.stdin.readline():  # a launcher that hands no input on has nothing to watch
        sys.stdin.read()
        shutil.rmtree(folder, ignore_errors=True)
        os._exit(1)


def guarded(folder: Path, work: Callable[[], None]) -> None:
    """Do the work of this process in a folder; where that fails, end it at once with what is wrong."""
    threading.Thread(target=_watch, args=[folder], daemon=True).start()
    try:
        work()
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)  # no waiting for the others, whom mpiexec ends


class Solver:
    """What one process does: its rows of the matrices, and of the solutions that it finds with the others."""

    def __init__(self, folder: Path, processes: int) -> None:
        self.PETSc = load()
        self.world = self.PETSc.COMM_WORLD
        if self.world.getSize() != processes:
            raise RuntimeError(
                f"mpiexec started {processes} processes and petsc4py sees {self.world.getSize()}: they belong to "
                "different MPIs"
            )
        self.rank = self.world.getRank()
        self.file, self.place = folder / "order", folder / str(self.rank)
        points = self.place / "points.npy"
        self.points = np.load(points) if points.is_file() else None
        self.matrices: dict[int, tuple[Any, Any]] = {}  # with their solvers
        self._costs = self.PETSc.Vec().createMPI((2, None), comm=self.world)
        self._gather, self._everybody = self.PETSc.Scatter.toAll(self._costs)

    def serve(self) -> None:
        """Follow the orders until the last."""
        number = 0
        while True:
            number, word, matrix, reduction = self._next(number)
            if word == "end":
                return
            answer: dict[str, Any] = {"number": number}
            if word == "matrix":
                answer["fault"] = self._take(matrix)
            elif word == "drop":
                for thing in self.matrices.pop(matrix):
                    thing.destroy()
            else:
                answer |= self._solve(matrix, reduction)
            costs = self._everyones()  # all are through
            if self.rank == 0:
                answer |= {"cpu": costs[:, 0].tolist(), "peak": costs[:, 1].tolist()}
                print(ANSWER + json.dumps(answer), flush=True)

    def _next(self, last: int) -> tuple[int, str, int, float]:
        pause = SOON
        while True:
            words = self.file.read_text(encoding="utf-8").split()
            if len(words) == 5 and words[0] == words[4] and int(words[0]) > last:
                return int(words[0]), words[1], int(words[2]), float(words[3])
            time.sleep(pause)
            pause = min(SLOWER * pause, LATER)

    def _take(self, number: int) -> str | None:
        """What is wrong with the matrix, which all processes meet alike; None where nothing is known to be."""
        matrix = read_matrix(self.PETSc, self.place, 1 if self.points is None else 3)
        solver = self.PETSc.KSP().create(self.world)
        solver.setOperators(matrix)
        if self.points is None:
            solver.setType("preonly")
            solver.getPC().setType("cholesky")
            solver.getPC().setFactorSolverType("mumps")
            solver.getPC().setFactorSetUpSolverType()
            solver.getPC().getFactorMatrix().setMumpsIcntl(13, 1)  # to count negative pivots at its root, too
            solver.setUp()
            negative = solver.getPC().getFactorMatrix().getMumpsInfog(12)
        else:
            solver.setType("cg")
            solver.setNormType(self.PETSc.KSP.NormType.NATURAL)  # r' B r, as the error has energy, on any mesh
            solver.setPC(multigrid(self.PETSc, matrix, rigid_motions(matrix, self.points)))
            negative = 0
        self.matrices[number] = matrix, solver
        return f"{negative} eigenvalues of the matrix are negative" if negative else None

    def _solve(self, number: int, reduction: float) -> dict[str, Any]:
        """Steps for each column; and the fault, which all processes meet alike, where one has no solution."""
        matrix, solver = self.matrices[number]
        solver.setTolerances(rtol=reduction, atol=0.0, max_it=MAX_STEPS)
        given = np.load(self.place / "right.npy")
        solved, steps, fault = np.empty(given.shape, order="F"), [], None
        right, answer = matrix.createVecLeft(), matrix.createVecRight()
        for column in range(given.shape[1]):
            right.setArray(given[:, column])
            solver.solve(right, answer)
            solved[:, column] = answer.getArray()
            steps.append(solver.getIterationNumber())
            reason = solver.getConvergedReason()
            if reason < 0 and fault is None:
                fault = f"they stop after {steps[-1]} steps (PETSc's reason {reason})"
        right.destroy()
        answer.destroy()
        np.save(self.place / "solved.npy", solved)
        return {"steps": steps, "fault": fault}

    def _everyones(self) -> Any:
        """CPU time [s] and peak memory [B] of every process (processes, 2)."""
        self._costs.setArray(np.array([time.process_time(), peak_memory()]))
        self._gather.scatter(self._costs, self._everybody)
        return self._everybody.getArray().copy().reshape(-1, 2)


def main() -> None:
    """Serve the folder of the command line, for so many processes; without one, end well where this Python can."""
    if len(sys.argv) < 2:
        load()
        return
    folder, processes = Path(sys.argv[1]), int(sys.argv[2])
    guarded(folder, lambda: Solver(folder, processes).serve())


if __name__ == "__main__":
    main()
