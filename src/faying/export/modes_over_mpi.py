"""Lowest modes of assembled matrices over the processes of mpiexec, which solve where `lowest_modes` factorises."""

from typing import Any

import numpy as np

from faying.errors import InputError
from faying.fe.elasticity import rigid_motions
from faying.mpi.over_mpi import OverMpi
from faying.numerics.modal_reanalysis import refined_modes
from faying.numerics.modes import Modes, check_shift, lowest_modes
from faying.numerics.shifted import Shifted
from faying.typing import Array

MIN_RESISTANCE = 1e-9  # of the forces that a rigid motion would meet under the diagonal alone: below it is rounding


def modes_over_mpi(
    stiffness: Any, mass: Any, count: int, *, shift_frequency: float, processes: int, points: Array | None = None
) -> tuple[Modes, OverMpi]:
    """Find the `count` lowest modes by solutions over several processes.

    Args:
        stiffness: [N/m], sparse (n, n).
        mass: [kg], sparse (n, n).
        count: how many modes, rigid motions among them.
        shift_frequency: [Hz], as `lowest_modes` takes it.
        processes: how many, 1 or more.
        points: coordinates (n / 3, 3) [m] of the nodes, as `OverMpi` takes them.

    Returns:
        The modes, and what solved over the processes, which end with it.

    Raises:
        InputError: as `OverMpi` and `lowest_modes` do.
        NotConverged: an iteration stops short.
        FayingError: a process ended before its time.
    """
    n = stiffness.shape[0]
    if points is not None and 3 * len(points) != n:
        raise InputError(
            f"{len(points)} points for {n} unknowns: each node has three unknowns that follow each other, x, y, z"
        )
    if n < 100 * count:
        raise InputError(f"{count} modes of {n:,} unknowns: a structure so small is solved without MPI")
    check_shift(stiffness, mass, shift_frequency)
    solver = OverMpi(points, processes, n)
    if points is not None:
        motions = rigid_motions(points)
        _, size, right = np.linalg.svd(stiffness @ motions, full_matrices=False)
        most = np.linalg.norm(stiffness.diagonal()[:, None] * motions)
        rigid = motions @ right[size < MIN_RESISTANCE * most].T  # what the stiffness does not resist
        return refined_modes(
            stiffness, mass, count, rigid=rigid, shift_frequency=shift_frequency, solver=solver
        ), solver
    matrix = Shifted(stiffness=stiffness.tocsr(), mass=mass.tocsr(), shift=(2 * np.pi * shift_frequency) ** 2)
    factor = solver.factorise(matrix, single=False)
    return lowest_modes(stiffness, mass, count, shift_frequency=shift_frequency, factor=factor), solver
