"""Solutions of A x = b by PETSc over the processes of mpiexec, as often as they are asked for.

    mpiexec -n 4 python3 mpi_solver.py FOLDER 4

`faying.mpi.over_mpi` starts it. Imports only NumPy, petsc4py, slepc4py and mpi_petsc.py beside it, so that it runs in a
Python without Faying. FOLDER holds one folder for each process, with the coordinates of its nodes and, as they come,
its rows of matrices and of right-hand sides; and the file `order`, one line that is written anew for each order:

    NUMBER WORD MATRIX REDUCTION NUMBER

MATRIX is a number. WORD is `matrix` (take its rows from operator_*.npy, and make its multigrid), `drop` (give it up),
`solve` (right.npy, each column until its residual has fallen by REDUCTION, to solved.npy) or `end`. All processes look
for the next order, asleep in between: to wait inside MPI would take a core. Once all are through, the first says so in
one line of its output, which begins with `ANSWER`.
"""

import json
import sys
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from faying.mpi.mpi_petsc import (
        ANSWER,
        check_size,
        guarded,
        load,
        multigrid,
        peak_memory,
        read_matrix,
        rigid_motions,
    )
else:  # beside this file, which is run as a script
    from mpi_petsc import ANSWER, check_size, guarded, load, multigrid, peak_memory, read_matrix, rigid_motions

MAX_STEPS = 1000
SOON, LATER, SLOWER = 2e-4, 1e-2, 1.3  # s between two looks for an order: at first, at most, and the growth between


class Solver:
    """What one process does: its rows of the matrices, and of the solutions that it finds with the others."""

    def __init__(self, folder: Path, processes: int) -> None:
        self.PETSc, _ = load()
        self.world = self.PETSc.COMM_WORLD
        check_size(self.world, processes)
        self.rank = self.world.getRank()
        self.file, self.place = folder / "order", folder / str(self.rank)
        self.points = np.load(self.place / "points.npy")
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
                self._take(matrix)
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

    def _take(self, number: int) -> None:
        matrix = read_matrix(self.PETSc, self.place, "operator", 3)
        for file in self.place.glob("operator_*.npy"):
            file.unlink()
        solver = self.PETSc.KSP().create(self.world)
        solver.setType("cg")
        solver.setNormType(self.PETSc.KSP.NormType.NATURAL)  # r' B r, as the error has energy, on any mesh
        solver.setOperators(matrix)
        solver.setPC(multigrid(self.PETSc, matrix, rigid_motions(matrix, self.points)))
        self.matrices[number] = matrix, solver

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
    """Serve the folder of the command line, for so many processes."""
    folder, processes = Path(sys.argv[1]), int(sys.argv[2])
    guarded(folder, lambda: Solver(folder, processes).serve())


if __name__ == "__main__":
    main()
