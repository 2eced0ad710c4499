"""Modes over two processes of mpiexec, against a factorisation of the whole."""

import shutil
import time
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse import diags_array

import faying
from faying.export.modes_over_mpi import modes_over_mpi
from faying.fe.elasticity import assemble
from faying.fe.interface import join
from faying.numerics.constraint import constrain
from faying.numerics.modal_reanalysis import REFINED
from faying.numerics.modes import lowest_modes
from tests.helpers.boxes import stack
from tests.helpers.mpi import mpi as mpi

STEEL = faying.CATALOGUE["45 steel"]
SHIFT = 300.0


def bars(cells, stiffness, width=0.02):
    """Two bars end to end on springs [Pa/m], of so many cells along the shortest side: points, K, M."""
    across = (round(cells * width / 0.02), cells)
    mesh = stack([0.06, 0.06], [4 * cells] * 2, width=width, height=0.02, sections=[across] * 2)
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, STEEL))
    joint = join(mesh, "p0.right", "p1.left")
    ones = np.ones(len(joint.weights))
    return mesh.points, (K + joint.springs(stiffness * ones, 0.5 * stiffness * ones)).tocsr(), M


def both(points, K, M, count, *, processes=2):
    over, _ = modes_over_mpi(K, M, count, shift_frequency=SHIFT, processes=processes, points=points)
    return over, lowest_modes(K, M, count, shift_frequency=SHIFT).frequencies


def agree(over, direct, rigid):
    assert np.all(over.frequencies[:rigid] < 0.1)
    assert over.frequencies[rigid:] == pytest.approx(direct[rigid:], rel=1e-8)
    apart = np.abs((over.frequencies[rigid:] / direct[rigid:]) ** 2 - 1)
    assert np.all(apart < 3 * over.error[rigid:] + 1e-10)  # the estimate holds; rounding of the direct solution
    assert over.error.max() <= REFINED


def test_modes_of_a_joint_and_what_they_take(mpi):
    """A square section has its bending modes in pairs: one of them is the last that is asked for."""
    points, K, M = bars(3, 1e13)
    over, solver = modes_over_mpi(K, M, 9, shift_frequency=SHIFT, processes=2, points=points)
    direct = lowest_modes(K, M, 9, shift_frequency=SHIFT).frequencies
    agree(over, direct, 6)
    assert direct[6] == pytest.approx(direct[7], rel=1e-2)
    assert solver.cpu.shape == solver.peak.shape == (2,)
    assert np.all(solver.peak > 1e7)
    assert "GAMG" in over.factorisation.name
    del over, solver
    assert not list(mpi.iterdir()), "pieces are left behind"


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [1e9, 1e11, 1e16])
def test_soft_and_stiff_joints(mpi, stiffness):
    agree(*both(*bars(3, stiffness, width=0.03), 16), 6)


@pytest.mark.slow
def test_nodes_held_by_a_support(mpi):
    """Fixed unknowns have no mass; no rigid motion is free."""
    points, K, M = bars(3, 1e12)
    fixed = (3 * np.flatnonzero(points[:, 0] < 1e-9)[:, None] + np.arange(3)).ravel()
    agree(*both(points, constrain(K, fixed), constrain(M, fixed, 0.0), 6), 0)


@pytest.mark.slow
def test_iterations_hardly_grow_with_the_mesh(mpi):
    """Smoothed aggregation with the rigid motions: from 6,600 to 39,000 unknowns, at most half as many again."""
    steps = []
    for cells in (3, 4, 6):
        points, K, M = bars(cells, 1e13)
        steps.append(
            modes_over_mpi(K, M, 10, shift_frequency=SHIFT, processes=1 + (cells > 3), points=points)[1].most_steps
        )
    assert max(steps) <= 1.5 * min(steps)


@pytest.mark.slow
def test_without_coordinates_a_factorisation(mpi):
    _, K, M = bars(3, 1e13)
    over, direct = both(None, K, M, 9)
    assert "MUMPS" in over.factorisation.name
    assert over.frequencies[6:] == pytest.approx(direct[6:], rel=1e-10)


def test_coordinates_that_do_not_fit(mpi):
    points, K, M = bars(3, 1e13)
    with pytest.raises(faying.InputError, match="points for .* unknowns"):
        modes_over_mpi(K, M, 9, shift_frequency=SHIFT, processes=2, points=points[1:])


def test_more_processes_than_the_structure_feeds(mpi):
    points, K, M = bars(3, 1e13)
    with pytest.raises(faying.InputError, match="solved without MPI"):
        modes_over_mpi(K, M, 9, shift_frequency=SHIFT, processes=50, points=points)
    with pytest.raises(faying.InputError, match="above all modes"):
        modes_over_mpi(K, M, 9, shift_frequency=1e12, processes=2, points=points)


def test_what_is_missing_is_named(monkeypatch):
    _, K, M = bars(3, 1e13)
    monkeypatch.setattr(shutil, "which", lambda name: None)
    with pytest.raises(faying.InputError, match=r"needs mpiexec.*mpi-default-bin"):
        modes_over_mpi(K, M, 9, shift_frequency=SHIFT, processes=2)
    monkeypatch.setattr(shutil, "which", lambda name: f"/somewhere/{name}")
    monkeypatch.setenv("FAYING_MPI_PYTHON", "/nowhere/python3")
    with pytest.raises(faying.InputError, match=r"/nowhere/python3, as FAYING_MPI_PYTHON says.*python3-petsc4py-real"):
        modes_over_mpi(K, M, 9, shift_frequency=SHIFT, processes=2)


@pytest.mark.slow
@pytest.mark.parametrize("known", [True, False])
def test_an_unstable_structure(mpi, known):
    """A spring that pushes away at one end."""
    points, K, M = bars(3, 1e13)
    ends = 3 * np.flatnonzero(points[:, 0] < 1e-9)
    push = np.zeros(K.shape[0])
    push[ends] = -1e9 / len(ends)
    with pytest.raises(faying.FayingError, match="structure (is )?unstable"):
        modes_over_mpi(
            K + diags_array(push), M, 9, shift_frequency=SHIFT, processes=2, points=points if known else None
        )


def awaited(found, most=120.0):
    end = time.monotonic() + most
    while not (out := found()) and time.monotonic() < end:
        time.sleep(0.2)
    return out


def running(folder):
    """Processes whose command names a folder."""
    lines = [path.read_bytes() for path in Path("/proc").glob("[0-9]*/cmdline") if path.exists()]
    return [line for line in lines if str(folder).encode() in line]
