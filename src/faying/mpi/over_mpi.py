"""What stands for a factorisation where one takes too much memory: conjugate gradients with multigrid over processes.

The processes are started by mpiexec when the first matrix comes, and serve all matrices of a structure until the last
of these is given up.
"""

import json
import os
import shutil
import subprocess
import sys
import tempfile
import weakref
from collections import deque
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import FayingError, InputError, NotConverged
from faying.mpi.mpi_solver import ANSWER
from faying.mpi.partition import rows_of_pieces, write_operator, write_points
from faying.numerics.solve import MPI
from faying.typing import Array

SOLVER = Path(__file__).with_name("mpi_solver.py")
ROUGH, FINE = 1e-5, 1e-11  # residual of a solution in the norm of the inverse, relative, in single and in double
DEBIAN = "python3-petsc4py-real mpi-default-bin"
SYSTEM = "/usr/bin/python3"
LAST_WORDS = 12  # lines of the processes that an error repeats
MIN_UNKNOWNS = 3000  # unknowns of each process: with fewer, more processes do not pay
PATIENCE = 60.0  # s until processes that were told to end are made to


class OverMpi:
    """Solves with matrices of one structure over processes that it starts by mpiexec.

    Args:
        points: coordinates (n / 3, 3) [m] of the nodes, whose unknowns follow each other as x, y, z; None: MUMPS
            factorises, which needs more memory than multigrid.
        processes: how many, 1 or more.
        unknowns: n, where there are no points.

    Raises:
        InputError: mpiexec or petsc4py are missing; more processes than the unknowns feed.
    """

    def __init__(self, points: Array | None, processes: int, unknowns: int = 0) -> None:
        unknowns = unknowns if points is None else 3 * len(points)
        if unknowns < MIN_UNKNOWNS * processes:
            raise InputError(
                f"{unknowns:,} unknowns over {processes} processes: a structure so small is solved without MPI"
            )
        self._programs = programs()
        self.points, self.processes, self.unknowns = points, processes, unknowns
        self.cheap = points is not None
        self.rows = rows_of_pieces(unknowns, points, processes)
        self.key = f"{MPI}, {processes} processes"
        self.solutions = self.steps = self.most_steps = 0
        self.cpu, self.peak = np.zeros(processes), np.zeros(processes)
        self._group: _Group | None = None
        self._count = 0
        self._given_up: list[int] = []

    def factorise(self, matrix: Any, *, single: bool) -> "SolvedOverMpi":
        """Stand for the factorisation of a symmetric positive definite `Shifted` (n, n), in single or double precision.

        Raises:
            NotConverged: the matrix is singular.
            FayingError: a process ended before its time.
        """
        if matrix.shape[0] != self.unknowns:
            raise InputError(f"{self.unknowns // 3} points for {matrix.shape[0]} unknowns: each node has three")
        if self._group is None:
            self._group = _Group(self._programs, self.processes)
            # the end of this object, or of the program: whichever comes first
            weakref.finalize(self, self._group.end)
            if self.points is not None:
                write_points(self._group.folder, self.points, self.rows)
            self._group.start()
        self._group.check()
        while self._given_up:
            self._ask("drop", self._given_up.pop())
        self._count += 1
        write_operator(self._group.folder, matrix, self.rows)
        self._ask("matrix", self._count)
        found = SolvedOverMpi(self, self._count, FINE if not single else ROUGH)
        # not asked at once: this may come at any time, in the midst of another order
        weakref.finalize(found, self._given_up.append, self._count)
        return found

    def solve(self, number: int, right: Array, reduction: float) -> Array:
        """Solve with the matrix of a number for right-hand sides (n, m), until their residuals have so fallen."""
        assert self._group is not None
        self._group.check()
        folder = self._group.folder
        for piece, here in enumerate(self.rows):
            np.save(folder / str(piece) / "right.npy", np.asfortranarray(right[here]))
        answer = self._ask("solve", number, reduction)
        self.solutions += len(answer["steps"])
        self.steps += sum(answer["steps"])
        self.most_steps = max(self.most_steps, *answer["steps"])
        found = np.empty(right.shape, order="F")
        for piece, here in enumerate(self.rows):
            found[here] = np.load(folder / str(piece) / "solved.npy")
        return found

    @property
    def summary(self) -> str:
        """What the processes have done so far and what they took."""
        peaks = ", ".join(f"{peak / 1e9:.2g}" for peak in self.peak)
        cpu = ", ".join(f"{seconds:.3g}" for seconds in self.cpu)
        return (
            f"{self.solutions:,} solutions by conjugate gradients and PETSc's multigrid over {self.processes} "
            f"processes, {self.steps / max(self.solutions, 1):.1f} steps each, {self.most_steps} at most; memory of "
            f"each process {peaks} GB, CPU {cpu} s"
        )

    def _ask(self, word: str, matrix: int, reduction: float = 0.0) -> dict[str, Any]:
        assert self._group is not None
        answer = self._group.ask(word, matrix, reduction)
        self.cpu, self.peak = np.array(answer["cpu"]), np.array(answer["peak"])
        if answer.get("fault") is not None:
            raise NotConverged(
                f"solutions over {self.processes} processes: {answer['fault']}; is a part free to move, or the "
                "structure unstable?"
            )
        return answer


class SolvedOverMpi:
    """One matrix that the processes hold, as a `Factorisation`; memory [B]: their peaks together."""

    def __init__(self, solver: OverMpi, number: int, reduction: float) -> None:
        self._solver, self._number, self._reduction = solver, number, reduction
        self.memory = float(solver.peak.sum())
        way = "MUMPS" if solver.points is None else "conjugate gradients, PETSc GAMG"
        self.name = f"{way} over {solver.processes} processes"

    def solve(self, right: Array) -> Array:
        """Solve for one right-hand side (n,) or several (n, m)."""
        if right.ndim == 1:
            return self._solver.solve(self._number, right[:, None], self._reduction)[:, 0]
        if not right.shape[1]:
            return np.zeros(right.shape)
        return self._solver.solve(self._number, right, self._reduction)


class _Group:
    """The processes and their folder."""

    def __init__(self, programs: tuple[str, str], processes: int) -> None:
        self._programs, self._processes, self._owner = programs, processes, os.getpid()
        self.folder = Path(tempfile.mkdtemp(prefix="faying-mpi-"))
        for piece in range(processes):
            (self.folder / str(piece)).mkdir()
        (self.folder / "order").touch()
        self._orders = 0
        self._running: subprocess.Popen[bytes] | None = None
        self._fault = ""

    def start(self) -> None:
        """Start the processes, which then wait for orders, and end when this one is gone."""
        mpiexec, python = self._programs
        command = [mpiexec, "-n", str(self._processes), python, str(SOLVER), str(self.folder), str(self._processes)]
        pipe, environment = subprocess.PIPE, {"OMP_NUM_THREADS": "1"} | os.environ
        self._running = subprocess.Popen(  # unbuffered: what a process that has ended did not take is not written again
            command, env=environment, stdin=pipe, stdout=pipe, stderr=subprocess.STDOUT, bufsize=0
        )
        assert self._running.stdin is not None
        with suppress(OSError):  # what ended at once is told when it is read
            self._running.stdin.write(b"watch\n")

    def check(self) -> None:
        """Raise FayingError where the processes are known to have ended, or are those of another program."""
        if os.getpid() != self._owner:
            raise FayingError("the processes of mpiexec serve the process that started them alone")
        if self._running is None:
            raise FayingError(self._fault or "the processes of mpiexec have been ended")

    def ask(self, word: str, matrix: int, reduction: float) -> dict[str, Any]:
        """Give an order and wait until all processes have followed it. Raises FayingError where they have ended."""
        self.check()
        assert self._running is not None
        assert self._running.stdout is not None
        self._orders += 1
        words: deque[str] = deque(maxlen=LAST_WORDS)
        try:
            self._write(word, matrix, reduction)
            while line := _line(self._running.stdout):
                if line.startswith(ANSWER):
                    answer: dict[str, Any] = json.loads(line[len(ANSWER) :])
                    return answer
                if line.strip(" -\n"):
                    words.append(line.rstrip())
        except BaseException:  # an answer that nobody has waited for would be taken for the next
            self.end(at_once=True)
            raise
        status = self._running.wait()
        mpiexec, python = self._programs
        self._fault = f"{mpiexec} -n {self._processes} {python} ended (status {status}): " + "\n".join(words)
        self.end(at_once=True)
        raise FayingError(self._fault)

    def end(self, *, at_once: bool = False) -> None:
        """Tell the processes to end, or make them, and remove their folder."""
        if os.getpid() != self._owner:
            return
        running, self._running = self._running, None
        if running is not None:
            assert running.stdin is not None
            assert running.stdout is not None
            with running, suppress(OSError):
                if not at_once and running.poll() is None:
                    self._orders += 1
                    self._write("end", 0, 0.0)
                    with suppress(subprocess.TimeoutExpired):
                        running.wait(PATIENCE)
                if running.poll() is None:
                    running.terminate()  # mpiexec then ends its processes
        shutil.rmtree(self.folder, ignore_errors=True)

    def _write(self, word: str, matrix: int, reduction: float) -> None:
        line = f"{self._orders} {word} {matrix} {reduction:g} {self._orders}\n"
        (self.folder / "order").write_text(line, encoding="utf-8")


def _line(stream: Any) -> str:
    """The next line of an unbuffered stream; empty at its end."""
    return str(stream.readline().decode("utf-8", errors="replace"))


def programs() -> tuple[str, str]:
    """mpiexec, and a Python that has petsc4py. Raises InputError where there is none."""
    mpiexec = shutil.which("mpiexec")
    if mpiexec is None:
        raise InputError(f"--mpi needs mpiexec; install an MPI (Debian: {DEBIAN})")
    named = os.environ.get("FAYING_MPI_PYTHON")
    for python in [named] if named else [sys.executable, SYSTEM]:
        try:
            done = subprocess.run([python, str(SOLVER)], capture_output=True, check=False)
        except OSError:
            continue
        if not done.returncode:
            return mpiexec, python
    where = f"{named}, as FAYING_MPI_PYTHON says," if named else f"this Python or {SYSTEM}"
    raise InputError(
        f"--mpi needs petsc4py in {where}; install it (Debian: {DEBIAN}), or name the Python that has it in the "
        "environment's FAYING_MPI_PYTHON"
    )


def processes_named(solver: str) -> int:
    """How many processes a solver `mpi:PROCESSES` means; `mpi` alone: FAYING_MPI_PROCESSES, or as many as cores.

    Raises:
        InputError: that is not a number.
    """
    asked = solver.removeprefix(MPI).removeprefix(":") or os.environ.get("FAYING_MPI_PROCESSES", "").strip()
    if not asked:
        return os.cpu_count() or 1
    if not asked.isdecimal() or not int(asked):
        raise InputError(f"{asked!r} processes of MPI: give a whole number from 1 on, as FAYING_MPI_PROCESSES=8")
    return int(asked)
