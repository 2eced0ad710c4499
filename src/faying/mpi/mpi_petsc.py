"""What the processes of mpiexec share, whatever they are asked: PETSc, their rows of a matrix, multigrid, their end.

Imports only NumPy, petsc4py and slepc4py, so that it runs in a Python without Faying, such as Debian's.
"""

import glob
import os
import shutil
import sys
import threading
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

ANSWER = "faying-answer "  # how an answer begins among other lines of the processes
THRESHOLD = 0.01  # of GAMG: weaker couplings do not make aggregates, so that none reaches across a soft joint


def load() -> tuple[Any, Any]:
    """petsc4py.PETSc and slepc4py.SLEPc. Raises ImportError where there are none, or none that fits this NumPy."""
    for package in ("petsc", "slepc"):  # where Debian keeps them
        sys.path += glob.glob(f"/usr/lib/{package}dir/{package}*/*-real/lib/python3/dist-packages")
    try:
        import slepc4py

        slepc4py.init(["faying"])
        from petsc4py import PETSc
        from slepc4py import SLEPc
    except ValueError as fault:
        raise ImportError(str(fault)) from None
    return PETSc, SLEPc


def peak_memory() -> float:
    """Most memory [B] that this process has held; NaN where the system does not say it."""
    try:
        import resource
    except ImportError:
        return float("nan")
    unit = 1.0 if sys.platform == "darwin" else 1024.0
    return unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def check_size(world: Any, processes: int) -> None:
    """Raise RuntimeError where petsc4py sees other processes than mpiexec has started."""
    if world.getSize() != processes:
        raise RuntimeError(
            f"mpiexec started {processes} processes and petsc4py sees {world.getSize()}: they belong to different MPIs"
        )


def read_matrix(PETSc: Any, place: Path, name: str, block: int) -> Any:
    """A symmetric positive definite matrix of all processes, of whose rows this one reads its own.

    place: the folder of this process, as `faying.mpi.partition` writes it; block: unknowns of a node.
    """
    kinds = {"starts": PETSc.IntType, "columns": PETSc.IntType, "values": float}
    csr = [np.load(place / f"{name}_{what}.npy").astype(kind, copy=False) for what, kind in kinds.items()]
    rows = len(csr[0]) - 1
    made = PETSc.Mat().createAIJ(size=((rows, None), (rows, None)), bsize=block, csr=tuple(csr), comm=PETSc.COMM_WORLD)
    for option in (PETSc.Mat.Option.SYMMETRIC, PETSc.Mat.Option.SPD):
        made.setOption(option, True)
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
