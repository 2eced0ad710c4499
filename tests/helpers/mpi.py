"""Whether PETSc over MPI is here, and an environment in which Open MPI starts wherever tests run."""

import shutil
import stat
from functools import cache

import pytest

import faying
from faying.mpi.over_mpi import programs


@cache
def missing_mpi():
    """What is missing for processes of MPI, in words; None where nothing is."""
    try:
        programs()
    except faying.InputError as fault:
        return str(fault)
    return None


@pytest.fixture
def mpi(monkeypatch, tmp_path):
    """The folder where the pieces lie meanwhile; two processes may share a core, started by root."""
    if missing_mpi():
        pytest.skip(missing_mpi())
    monkeypatch.setenv("OMPI_ALLOW_RUN_AS_ROOT", "1")
    monkeypatch.setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1")
    monkeypatch.setenv("OMPI_MCA_rmaps_base_oversubscribe", "1")
    monkeypatch.setenv("OMPI_MCA_mpi_yield_when_idle", "1")
    monkeypatch.setenv("OMPI_MCA_hwloc_base_binding_policy", "none")
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    return tmp_path


def stand_ins(monkeypatch, tmp_path, **bodies):
    """Shell scripts in the place of programs, python3 and mpiexec; pieces go to tmp_path / "pieces"."""
    for name, body in bodies.items():
        (tmp_path / name).write_text(f"#!/bin/sh\n{body}\n")
        (tmp_path / name).chmod(stat.S_IRWXU)
    monkeypatch.setenv("FAYING_MPI_PYTHON", str(tmp_path / "python3"))
    monkeypatch.setattr(shutil, "which", lambda name: str(tmp_path / name))
    (tmp_path / "pieces").mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / "pieces"))
