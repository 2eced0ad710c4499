"""Lowest modes over the processes of mpiexec: matrices in pieces, SLEPc in whichever Python has it."""

import json
import os
import shutil
import subprocess
import sys
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import InputError, NotConverged
from faying.mpi.partition import rows_of_pieces, write_pieces
from faying.numerics.modes import check_shift
from faying.numerics.shifted import Shifted
from faying.typing import Array

TOLERANCE = 5e-9  # estimated relative error of the squared frequencies
DEBIAN = "python3-slepc4py-real python3-petsc4py-real mpi-default-bin"
WORKER = Path(__file__).with_name("mpi_worker.py")
SYSTEM = "/usr/bin/python3"
UNSTABLE = 1e-4  # of the shift: eigenvalues further below zero are not rounding
LAST_WORDS = 12  # lines of the processes that an error repeats
MIN_UNKNOWNS = 3000  # unknowns of each process: with fewer, more processes do not pay


@dataclass(frozen=True, kw_only=True)
class ModesOverMpi:
    """Lowest modes in rising order: frequencies [Hz] (m,), estimated relative error (m,) of their squares.

    solver: what found them; iterations: of the eigensolver; cpu [s] and peak memory [B] of each process (processes,).
    """

    frequencies: Array
    error: Array
    solver: str
    iterations: int
    cpu: Array
    peak: Array


def modes_over_mpi(
    stiffness: Any, mass: Any, count: int, *, shift_frequency: float, processes: int, points: Array | None = None
) -> ModesOverMpi:
    """Find the `count` lowest modes over several processes that this function starts by mpiexec.

    Args:
        stiffness: [N/m], sparse (n, n).
        mass: [kg], sparse (n, n).
        count: how many modes, rigid motions among them.
        shift_frequency: [Hz], f in the matrix K + (2 pi f)^2 M, of the order of the first elastic mode or below.
        processes: how many, 1 or more.
        points: coordinates (n / 3, 3) [m] of the nodes, whose unknowns follow each other as x, y, z: the solver is then
            multigrid, which needs memory in proportion to the unknowns; None: a factorisation by MUMPS.

    Raises:
        InputError: mpiexec, petsc4py or slepc4py are missing; more modes or processes than the unknowns allow; the
            shift is not a frequency or above all modes; the structure is unstable.
        NotConverged: the iteration stops short, or a process ended before its time.
    """
    n = stiffness.shape[0]
    if points is not None and 3 * len(points) != n:
        raise InputError(
            f"{len(points)} points for {n} unknowns: each node has three unknowns that follow each other, x, y, z"
        )
    if n < MIN_UNKNOWNS * processes or n < 100 * count:
        raise InputError(
            f"{count} modes of {n:,} unknowns over {processes} processes: a structure so small is solved without --mpi"
        )
    check_shift(stiffness, mass, shift_frequency)
    mpiexec, python = programs()
    matrix = Shifted(stiffness=stiffness.tocsr(), mass=mass.tocsr(), shift=(2 * np.pi * shift_frequency) ** 2)
    with tempfile.TemporaryDirectory(prefix="faying-mpi-") as name:
        folder = Path(name)
        write_pieces(folder, matrix, points, rows_of_pieces(n, points, processes))
        order = {
            "processes": processes,
            "points": points is not None,
            "count": count,
            "shift": matrix.shift,
            "tolerance": TOLERANCE,
        }
        (folder / "order.json").write_text(json.dumps(order), encoding="utf-8")
        _start([mpiexec, "-n", str(processes), python, str(WORKER), name])
        answer, costs = _read(folder, processes)
    if "fault" in answer:
        raise NotConverged(f"modes over MPI: {answer['fault']}; ask for fewer modes, or give another --shift")
    values = np.array(answer["values"])
    if values[0] < -UNSTABLE * matrix.shift:
        raise InputError(
            f"the structure is unstable: an eigenvalue is -({np.sqrt(-values[0]) / (2 * np.pi):.4g} Hz)^2; check the "
            "signs of the stiffness matrix and of its springs"
        )
    rising = np.argsort(np.abs(values))
    return ModesOverMpi(
        frequencies=np.sqrt(np.abs(values[rising])) / (2 * np.pi),
        error=np.array(answer["error"])[rising],
        solver=answer["solver"],
        iterations=answer["iterations"],
        cpu=np.array([cost["cpu"] for cost in costs]),
        peak=np.array([cost["peak"] for cost in costs]),
    )


def programs() -> tuple[str, str]:
    """mpiexec, and a Python that has petsc4py and slepc4py. Raises InputError where there is none."""
    mpiexec = shutil.which("mpiexec")
    if mpiexec is None:
        raise InputError(f"--mpi needs mpiexec; install an MPI (Debian: {DEBIAN})")
    named = os.environ.get("FAYING_MPI_PYTHON")
    for python in [named] if named else [sys.executable, SYSTEM]:
        try:
            done = subprocess.run([python, str(WORKER)], capture_output=True, check=False)
        except OSError:
            continue
        if not done.returncode:
            return mpiexec, python
    where = f"{named}, as FAYING_MPI_PYTHON says," if named else f"this Python or {SYSTEM}"
    raise InputError(
        f"--mpi needs petsc4py and slepc4py in {where}; install them (Debian: {DEBIAN}), or name the Python that has "
        "them in the environment's FAYING_MPI_PYTHON"
    )


def started(command: list[str]) -> "subprocess.Popen[bytes]":
    """Start mpiexec, whose processes end when this one is gone."""
    pipe, environment = subprocess.PIPE, {"OMP_NUM_THREADS": "1"} | os.environ
    running = subprocess.Popen(  # unbuffered: what a process that has ended did not take is not written again
        command, env=environment, stdin=pipe, stdout=pipe, stderr=subprocess.STDOUT, bufsize=0
    )
    assert running.stdin is not None
    with suppress(OSError):  # what ended at once is told when it is read
        running.stdin.write(b"watch\n")
    return running


def _start(command: list[str]) -> None:
    """Run the processes and wait. Raises NotConverged with their last words where they fail."""
    with started(command) as running:
        assert running.stdout is not None
        try:
            output = running.stdout.read()
        except BaseException:
            running.terminate()  # mpiexec then ends its processes
            raise
    if running.returncode:
        lines = [line for line in output.decode("utf-8", errors="replace").splitlines() if line.strip(" -")]
        raise NotConverged(
            f"{' '.join(command[:3])} failed (status {running.returncode}): " + "\n".join(lines[-LAST_WORDS:])
        )


def _read(folder: Path, processes: int) -> tuple[dict[str, Any], list[dict[str, float]]]:
    answer = json.loads((folder / "answer.json").read_text(encoding="utf-8"))
    costs = [json.loads((folder / str(k) / "cost.json").read_text(encoding="utf-8")) for k in range(processes)]
    return answer, costs
