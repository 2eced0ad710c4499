"""A structure factorised part by part, against the whole one."""

import os

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import faying
from faying.errors import NotConverged
from faying.fe.elasticity import assemble, rigid_motions
from faying.fe.interface import join
from faying.joint.assembled_parts import unknowns_of
from faying.numerics.by_parts import PartByPart
from faying.numerics.constraint import constrain
from faying.numerics.modal_reanalysis import refined_modes
from faying.numerics.modes import lowest_modes
from faying.numerics.shifted import Shifted
from faying.numerics.single import Single
from faying.numerics.solve import available, factorise
from tests.helpers.boxes import stack

STEEL = faying.CATALOGUE["45 steel"]
SHIFT = 300.0
S = (2 * np.pi * SHIFT) ** 2
pytestmark = pytest.mark.skipif("pardiso" not in available(), reason="only PARDISO factorises part by part")


class Chain:
    """Bars end to end with springs between them; sections: cells across each."""

    def __init__(self, sections):
        count = len(sections)
        self.mesh = stack([0.05] * count, [4] * count, width=0.02, height=0.015, sections=sections)
        self.K, self.M = assemble(self.mesh, dict.fromkeys(self.mesh.parts, STEEL))
        self.joints = [join(self.mesh, f"p{k}.right", f"p{k + 1}.left") for k in range(count - 1)]
        self.parts = [unknowns_of(self.mesh.part_nodes(part)) for part in self.mesh.parts]
        self.rigid = rigid_motions(self.mesh.points)

    def sprung(self, *levels):
        K = self.K
        for joint, level in zip(self.joints, levels, strict=True):
            ones = np.ones(len(joint.weights))
            K = K + joint.springs(level * ones, 0.5 * level * ones)
        return K.tocsr()

    def way(self, **options):
        return PartByPart(self.parts, np.zeros(0, dtype=int), self.rigid, **options)


@pytest.fixture(scope="module")
def unlike():
    return Chain([(2, 2), (3, 2), (2, 3)])


@pytest.fixture(scope="module")
def alike():
    return Chain([(2, 2)] * 4)


def force(chain):
    return np.random.default_rng(3).standard_normal((chain.K.shape[0], 3))


@pytest.mark.parametrize("stored", [False, True])
def test_it_solves_what_the_whole_one_solves(unlike, stored):
    A = (unlike.sprung(1e13, 1e12) + S * unlike.M).tocsr()
    found = unlike.way(stored=stored).factorise(A, single=False)
    b = force(unlike)
    exact = factorise(A, "pardiso").solve(b)
    assert found.solve(b) == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())
    assert found.solve(b[:, 1]) == pytest.approx(exact[:, 1], abs=1e-9 * np.abs(exact).max())


def test_alike_parts_are_factorised_once(alike):
    A = (alike.sprung(1e13, 3e12, 1e13) + S * alike.M).tocsr()
    b = force(alike)
    once, each = (alike.way(alike=same).factorise(A, single=False) for same in (True, False))
    # the parts inside touch others at both ends, those outside at one: all four share one factor
    assert once.memory < 0.6 * each.memory
    exact = factorise(A, "pardiso").solve(b)
    for found in (once, each):
        assert found.solve(b) == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())


def test_a_part_of_another_material_is_not_alike(alike):
    mesh = alike.mesh
    softer = dict.fromkeys(mesh.parts, STEEL) | {"p2": faying.CATALOGUE["EN AW-6082 T6"]}
    K, M = assemble(mesh, softer)
    A = (K + (alike.sprung(1e13, 1e13, 1e13) - alike.K) + S * M).tocsr()
    b = force(alike)
    exact = factorise(A, "pardiso").solve(b)
    assert alike.way().factorise(A, single=False).solve(b) == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())


@settings(max_examples=8, deadline=None)
@given(first=st.floats(9, 15), second=st.floats(9, 15))
def test_other_springs_need_no_other_parts(unlike, first, second):
    """Any springs over six decades: the factors of the parts serve all of them."""
    way = unlike.way()
    way.factorise((unlike.sprung(1e12, 1e12) + S * unlike.M).tocsr(), single=False)
    parts = way._made
    A = (unlike.sprung(10**first, 10**second) + S * unlike.M).tocsr()
    b = force(unlike)
    exact = factorise(A, "pardiso").solve(b)
    found = way.factorise(A, single=False).solve(b)
    assert way._made is parts
    assert np.linalg.norm(A @ found - b) < 1e-6 * np.linalg.norm(b)
    assert found == pytest.approx(exact, abs=1e-6 * np.abs(exact).max())


def test_what_changes_inside_a_part_is_noticed(unlike):
    way = unlike.way()
    A = (unlike.sprung(1e13, 1e13) + S * unlike.M).tocsr()
    way.factorise(A, single=False)
    parts = way._made
    other = (A + 3 * S * unlike.M).tocsr()
    b = force(unlike)
    exact = factorise(other, "pardiso").solve(b)
    assert way.factorise(other, single=False).solve(b) == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())
    assert way._made is not parts


def test_a_part_that_nothing_holds_is_no_silent_answer(unlike):
    with pytest.raises(NotConverged):
        unlike.way().factorise((unlike.K - S * unlike.M).tocsr(), single=False)


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("stored", [False, True])
def test_modes_are_those_of_the_whole(unlike, held, stored):
    K, M, rigid = unlike.sprung(1e13, 2e13), unlike.M, unlike.rigid
    fixed = np.zeros(0, dtype=int)
    if held:
        fixed = unknowns_of(unlike.mesh.face_nodes("p0.left"))
        K, M, rigid = constrain(K, fixed), constrain(M, fixed, 0.0), rigid[:, :0]
    wanted = lowest_modes(K, M, 16, shift_frequency=SHIFT)
    way = PartByPart(unlike.parts, fixed, unlike.rigid, stored=stored)
    found = refined_modes(K, M, 16, rigid=rigid, shift_frequency=SHIFT, solver=way)
    elastic = slice(rigid.shape[1], None)
    assert found.factorisation.name == PartByPart.name
    assert found.frequencies[elastic] == pytest.approx(wanted.frequencies[elastic], rel=1e-8)


def test_what_was_stored_is_deleted(unlike, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    way = unlike.way(stored=True)
    found = way.factorise((unlike.sprung(1e13, 1e13) + S * unlike.M).tocsr(), single=True)
    assert sum(len(files) for _, _, files in os.walk(tmp_path)) == 3
    del way, found
    assert not list(tmp_path.iterdir())


def test_parts_without_an_inside_and_without_touched_unknowns(unlike):
    """A part all of whose unknowns are touched has nothing to eliminate, one that nobody touches is all inside."""
    A = (unlike.sprung(1e13, 0.0) + S * unlike.M).tocsr()
    A.eliminate_zeros()
    b = force(unlike)
    exact = factorise(A, "pardiso").solve(b)
    way = PartByPart(unlike.parts, unlike.parts[0], unlike.rigid)
    assert way.factorise(A, single=False).solve(b) == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())


def test_single_precision_serves_where_the_parts_are_nearly_free(alike):
    """At 3 Hz the shift resists the rigid motions of a part by 1e-13 of its stiffness; they are answered exactly."""
    soft = (2 * np.pi * 3.0) ** 2
    K, M = alike.sprung(1e13, 1e13, 1e13), alike.M
    A = (K + soft * M).tocsr()
    force = M @ np.sin(np.arange(K.shape[0]))[:, None]
    exact = factorise(A, "pardiso").solve(force)
    matrix = Shifted(stiffness=K, mass=M, shift=soft)
    found = Single(matrix, alike.rigid, alike.way()).solve(force)
    assert np.linalg.norm(found - exact) < 1e-3 * np.linalg.norm(exact)
    with pytest.raises(NotConverged):
        Single(matrix, alike.rigid, PartByPart(alike.parts, np.zeros(0, dtype=int), alike.rigid[:, :0]))
