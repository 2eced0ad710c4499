"""Modes keep their place in an interval though others pass them: two discs, whose torsion falls below their twins."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import faying
from faying.fe.interface import join
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.modal import ModalProblem, ModesChoice, in_order_of
from faying.joint.preload_case import PreloadCase
from faying.joint.state import engine_for
from faying.joint.structure import Structure
from tests.helpers.laws import Given
from tests.helpers.rings import discs

STEEL = faying.Material(name="steel", E=210e9, nu=0.3, density=7850.0)


@pytest.fixture(scope="module")
def structure():
    mesh = discs([5e-3, 12e-3, 20e-3], 16, [0.0, 20e-3, 40e-3])
    joint = FittedJoint(
        name="j",
        faces=("high.bottom", "low.top"),
        interface=join(mesh, "high.bottom", "low.top"),
        law=JointLaw(model=Given(k_n=lambda p: 4e12 + 0 * p, k_t=lambda p: 3e12 + 0 * p)),
    )
    bolt = faying.Bolt("b", ("high.top", "low.bottom"))
    return Structure(mesh=mesh, materials=dict.fromkeys(mesh.parts, STEEL), joints=(joint,), bolts=(bolt,))


def torsion(structure, shapes):
    """Share of the motion of each mode that turns circles about the axis as a whole."""
    x, y, z = structure.mesh.points.T
    r = np.hypot(x, y)
    around = np.stack([-y / r, x / r, 0 * z], axis=1)
    along = np.einsum("ni,nim->nm", around, shapes.reshape(len(x), 3, -1))
    above = np.isin(np.arange(len(x)), structure.mesh.part_nodes("high"))
    ring = np.unique(np.round(np.stack([r, z, above], axis=1), 7), axis=0, return_inverse=True)[1].ravel()
    mean = np.stack([np.bincount(ring, one) for one in along.T], axis=1) / np.bincount(ring)[:, None]
    return (mean[ring] ** 2).sum(axis=0) / (shapes.reshape(len(x), 3, -1) ** 2).sum(axis=(0, 1))


@pytest.mark.parametrize("engine", ["direct", "reanalysis"])
@pytest.mark.parametrize("share", [0.5, 0.1, 0.02])
def test_torsion_and_twins_keep_their_places_when_the_joint_softens(structure, engine, share):
    problem = ModalProblem(structure=structure, choice=ModesChoice(count=8))
    solver = engine_for(engine, problem, [PreloadCase((5e3,))])
    springs = structure.springs(solver.preload(0).pressures)
    modes = solver.vibrate(springs).modes
    rest = slice(problem.rigid_count, problem.rigid_count + 8)
    soft = [replace(one, k_t=share * one.k_t) for one in springs]
    found = solver.frequencies(soft, modes, one_way=True)
    there = engine_for("direct", problem, [PreloadCase((5e3,))]).vibrate(soft).modes
    assert np.sort(found) == pytest.approx(there.frequencies[rest], rel=1e-4)
    before, after = (np.flatnonzero(torsion(structure, one.shapes[:, rest]) > 0.9)[0] for one in (modes, there))
    assert (before, after) == (2, 0)  # it passes the lowest twins
    assert found[before] == pytest.approx(there.frequencies[rest][after], rel=1e-4)
    twins = [
        (a, b) for a, b in zip(range(7), range(1, 8), strict=True) if np.ptp(modes.frequencies[rest][[a, b]]) < 1.0
    ]
    assert len(twins) >= 2
    for a, b in twins:
        assert found[a] == pytest.approx(found[b], rel=1e-3)


@pytest.mark.parametrize("one_way", [True, False])
def test_springs_that_stiffen_and_soften_may_swap_modes_whose_ranges_are_apart(one_way):
    """Masses of 1 kg on springs of 1 and 4 N/m, then of 4.41 and 1.21: only springs that go one way keep the order."""
    problem = SimpleNamespace(
        rigid_count=0, choice=ModesChoice(count=2), structure=SimpleNamespace(dynamic_matrices=(None, np.eye(2)))
    )
    before, after = (
        SimpleNamespace(frequencies=np.array(f), shapes=shapes)
        for f, shapes in (((1.0, 2.0), np.eye(2)), ((1.1, 2.1), np.eye(2)[::-1]))
    )
    found = in_order_of(before, problem, lambda shapes: after, one_way)
    assert found.tolist() == ([1.1, 2.1] if one_way else [2.1, 1.1])
