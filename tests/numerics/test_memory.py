"""Memory is asked for before a factorisation: what is there, what is needed, and what is said where it is short."""

import numpy as np
import pytest

import faying
from faying import memory as machine
from faying.fe.elasticity import assemble
from faying.numerics import memory
from faying.numerics.modes import lowest_modes
from faying.numerics.solve import available, factorise
from tests.helpers.boxes import stack

STEEL = faying.CATALOGUE["45 steel"]


@pytest.fixture(scope="module")
def matrix():
    mesh = stack([0.05, 0.05], [4, 4], width=0.04, height=0.04, sections=[(3, 3), (3, 3)])
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, STEEL))
    return K, M, (K + 1e7 * M).tocsr()


@pytest.mark.parametrize("name", available())
def test_too_large_a_factor_is_refused_before_it_is_made(matrix, name, monkeypatch):
    monkeypatch.setenv("FAYING_MEMORY", "0.001")
    with pytest.raises(
        faying.InputError, match=r"needs .* GB to factorise .* 0.001 GB are free; choose .*coarser mesh"
    ):
        factorise(matrix[2], name)
    monkeypatch.setenv("FAYING_MEMORY", "inf")
    assert factorise(matrix[2], name).memory > 1e6


def test_without_pardiso_the_advice_names_it(monkeypatch):
    monkeypatch.setenv("FAYING_MEMORY", "1")
    with pytest.raises(faying.InputError, match="SuperLU needs 2 GB .* choose PARDISO, which needs less"):
        memory.check(2e9, 1000, "SuperLU")
    memory.check(0.9e9, 1000, "SuperLU")


@pytest.mark.parametrize("text", ["much", "-3", "0"])
def test_a_limit_that_is_no_number(text, monkeypatch):
    monkeypatch.setenv("FAYING_MEMORY", text)
    with pytest.raises(faying.InputError, match="should be a number of gigabytes"):
        machine.available()


def test_the_estimates_cover_the_entries_of_the_factor(matrix):
    """SuperLU counts the entries of its factors; the guess for it lies above them, and not by a factor of ten."""
    factor = factorise(matrix[2], "superlu")
    held = 8 * factor._factor.nnz
    assert held < factor.memory < 10 * held


@pytest.mark.skipif("pardiso" not in available(), reason="PARDISO is not installed")
def test_pardiso_estimates_at_least_the_entries_of_its_factor(matrix):
    factor = factorise(matrix[2], "pardiso")
    assert factor._block == 3  # counted in blocks of nodes then
    entries = 8 * 9 * int(factor._iparm[17])
    assert entries < factor.memory < 4 * entries


def test_a_container_that_has_little_left(tmp_path, monkeypatch):
    """Control groups: the limit less what is used, with pages of files that can be dropped; version 2, then 1."""
    monkeypatch.delenv("FAYING_MEMORY", raising=False)
    monkeypatch.setattr(machine, "CGROUP", tmp_path)
    assert machine._container() is None
    old = tmp_path / "memory"
    old.mkdir()
    (old / "memory.limit_in_bytes").write_text("5000000\n")
    (old / "memory.usage_in_bytes").write_text("3000000\n")
    (old / "memory.stat").write_text("total_inactive_file 500000\n")
    assert machine.available() == 2.5e6
    (tmp_path / "memory.max").write_text("4000000\n")
    (tmp_path / "memory.current").write_text("3000000\n")
    (tmp_path / "memory.stat").write_text("anon 1\ninactive_file 0\n")
    assert machine.available() == 1e6
    (tmp_path / "memory.max").write_text("max\n")
    assert machine._container() == np.inf


def test_a_matrix_that_is_not_positive_definite(matrix):
    K, M, _ = matrix
    for name in set(available()) & {"pardiso"}:
        with pytest.raises(faying.NotConverged, match="not positive definite; is a part free to move"):
            factorise((K - 1e12 * M).tocsr(), name)


def test_an_unknown_without_stiffness(matrix):
    from scipy.sparse import block_diag, csr_array

    wider = csr_array(block_diag([matrix[2], csr_array((1, 1))]))
    if "pardiso" in available():
        with pytest.raises(faying.NotConverged, match="1 unknowns have no stiffness at all"):
            factorise(wider, "pardiso")


def test_repeated_modes_beyond_the_width_of_a_block():
    """Five loose cubes have thirty rigid motions, and every elastic mode comes at least five times."""
    cubes = stack([0.01] * 5, [1] * 5, width=0.01, height=0.01, sections=[(1, 1)] * 5, gap=0.01)
    K, M = assemble(cubes, dict.fromkeys(cubes.parts, STEEL))
    found = lowest_modes(K, M, 40, shift_frequency=5e3).frequencies
    assert np.all(found[:30] < 1.0)
    assert found[30:35] == pytest.approx(np.full(5, found[30]), rel=1e-8)
    one = stack([0.01], [1], width=0.01, height=0.01, sections=[(1, 1)])
    alone = lowest_modes(*assemble(one, {"p0": STEEL}), 8, shift_frequency=5e3).frequencies
    assert found[30] == pytest.approx(alone[6], rel=1e-8)


def test_shapes_are_orthonormal_and_solve_the_equations(matrix):
    K, M, _ = matrix
    found = lowest_modes(K, M, 24, shift_frequency=500.0)
    assert found.shapes.T @ (M @ found.shapes) == pytest.approx(np.eye(24), abs=1e-10)
    squared = (2 * np.pi * found.frequencies) ** 2
    miss = K @ found.shapes - (M @ found.shapes) * squared
    size = np.linalg.norm(K @ found.shapes, axis=0)
    assert np.all(np.linalg.norm(miss, axis=0)[12:] < 1e-6 * size[12:])


@pytest.mark.parametrize("count", [0, 10**6])
def test_more_modes_than_there_are(matrix, count):
    K, M, _ = matrix
    with pytest.raises(faying.InputError, match=f"{count} modes of a structure with .* ask for 1 to"):
        lowest_modes(K, M, count, shift_frequency=500.0)
