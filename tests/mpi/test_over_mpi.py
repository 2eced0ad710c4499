"""Conjugate gradients over two processes of mpiexec in place of a factorisation, against one."""

import gc
import os
import subprocess
import sys
import time

import numpy as np
import pytest

import faying
from faying.errors import FayingError
from faying.fe.elasticity import rigid_motions
from faying.mpi.over_mpi import OverMpi, processes_named
from faying.numerics.modal_reanalysis import refined_modes
from faying.numerics.modes import lowest_modes
from faying.numerics.shifted import Shifted
from faying.numerics.single import Single, factorise_roughly
from faying.numerics.solve import chosen, factorise
from tests.helpers.mpi import mpi as mpi
from tests.helpers.mpi import stand_ins
from tests.mpi.test_mpi import SHIFT, awaited, bars, running

S = (2 * np.pi * SHIFT) ** 2


def apart(found, wanted, operator):
    """Relative error in the energy of the operator, for each column."""
    miss = found - wanted
    energy = np.einsum("ij,ij->j", miss, operator @ miss) / np.einsum("ij,ij->j", wanted, operator @ wanted)
    return np.sqrt(energy)


def test_solutions_are_those_of_a_factorisation(mpi):
    """Two matrices are held at once; rigid motions are answered exactly; nothing is left when all is given up."""
    points, K, M = bars(3, 1e13)
    _, softer, _ = bars(3, 1e11)
    over, rigid = OverMpi(points, 2), rigid_motions(points)
    first, second = (Shifted(stiffness=stiffness, mass=M, shift=S) for stiffness in (K, softer))
    rough, other = factorise_roughly(first, rigid=rigid, solver=over), over.factorise(second, single=False)
    assert isinstance(rough, Single)
    right = M @ np.random.default_rng(3).standard_normal((len(rigid), 2))
    right -= M @ rigid @ np.linalg.solve(rigid.T @ (M @ rigid), rigid.T @ right)
    assert np.all(apart(rough.solve(right), factorise(first.assembled()).solve(right), first) < 1e-4)
    exact = factorise(second.assembled()).solve(right)
    assert np.all(apart(other.solve(right), exact, second) < 1e-9)
    del rough
    over.factorise(first, single=True)  # gives up the one, and then itself
    assert other.solve(right[:, 0]) == pytest.approx(exact[:, 0], abs=1e-8 * np.abs(exact).max())
    assert not other.solve(right[:, :0]).size
    moved = Single(first, rigid, over).solve(M @ rigid) * S
    assert moved == pytest.approx(rigid, abs=1e-9 * np.abs(rigid).max())
    assert other.memory > 2e7
    assert len(over.cpu) == 2
    assert "2 processes" in over.summary
    (folder,) = mpi.iterdir()
    del over, other
    gc.collect()
    assert not running(folder)
    assert not list(mpi.iterdir())


@pytest.mark.slow
@pytest.mark.parametrize("stiffness", [1e9, 1e13, 1e16])
def test_refined_modes_are_those_of_a_factorisation(mpi, stiffness):
    points, K, M = bars(3, stiffness)
    over = OverMpi(points, 2)
    found = refined_modes(K, M, 15, rigid=rigid_motions(points), shift_frequency=SHIFT, solver=over)
    direct = lowest_modes(K, M, 15, shift_frequency=SHIFT)
    assert found.frequencies[6:] == pytest.approx(direct.frequencies[6:], rel=1e-9)


def test_how_many_processes(monkeypatch):
    monkeypatch.setenv("FAYING_MPI_PROCESSES", "7")
    assert processes_named("mpi:3") == 3
    assert processes_named("mpi") == 7
    monkeypatch.setenv("FAYING_MPI_PROCESSES", "some")
    with pytest.raises(faying.InputError, match="'some' processes.*whole number"):
        processes_named("mpi")
    monkeypatch.delenv("FAYING_MPI_PROCESSES")
    assert processes_named("mpi") == os.cpu_count()
    with pytest.raises(faying.InputError, match="whole number"):
        processes_named("mpi:0")


def test_what_asks_for_a_factorisation_says_so():
    _, K, _ = bars(3, 1e13)
    assert chosen("mpi:2") == "mpi:2"
    with pytest.raises(faying.InputError, match="asks for a factorisation.*'mpi:2' does not have"):
        factorise(K, "mpi:2")


def test_more_processes_than_the_structure_feeds():
    with pytest.raises(faying.InputError, match="solved without MPI"):
        OverMpi(np.zeros((1500, 3)), 2)


def test_points_that_do_not_fit(mpi):
    points, K, M = bars(3, 1e13)
    with pytest.raises(faying.InputError, match="points for .* unknowns"):
        OverMpi(points[1:], 2).factorise(Shifted(stiffness=K, mass=M, shift=S), single=True)


@pytest.mark.skipif(os.name != "posix", reason="a shell stands in for mpiexec")
def test_processes_that_die_are_an_error_that_stays(monkeypatch, tmp_path):
    """Not one that a solver takes for a matrix without solution, and tries again."""
    stand_ins(
        monkeypatch,
        tmp_path,
        python3="exit 0",
        mpiexec='echo "a process was killed"; exit 137',
    )
    points, K, M = bars(3, 1e13)
    over = OverMpi(points, 2)
    for _ in range(2):
        with pytest.raises(FayingError, match=r"(?s)status 137.*a process was killed") as met:
            factorise_roughly(Shifted(stiffness=K, mass=M, shift=S), rigid=rigid_motions(points), solver=over)
        assert not isinstance(met.value, faying.NotConverged)
    assert not list((tmp_path / "pieces").iterdir())


@pytest.mark.slow
def test_nothing_is_left_when_the_caller_is_killed(mpi):
    code = (
        "import time, tests.mpi.test_over_mpi as t; p, K, M = t.bars(3, 1e13);"
        "over = t.OverMpi(p, 2); f = over.factorise(t.Shifted(stiffness=K, mass=M, shift=t.S), single=True);"
        "print('ready', flush=True); time.sleep(600)"
    )
    with subprocess.Popen(
        [sys.executable, "-c", code], env=os.environ | {"TMPDIR": str(mpi)}, stdout=subprocess.PIPE
    ) as caller:
        try:
            assert caller.stdout is not None
            assert caller.stdout.readline() == b"ready\n"
            (folder,) = mpi.glob("faying-mpi-*")  # MPI keeps files of its own there, too
            assert running(folder)
            time.sleep(0.5)
        finally:
            caller.kill()
    assert awaited(lambda: not running(folder), 30.0)
    assert not folder.exists()
