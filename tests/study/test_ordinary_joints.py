"""Ordinary bolted joints, from STEP files without names to a result."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.answer.run import run
from faying.bolt.bolt import FittedBolt
from faying.case.acting import acting
from faying.case.case import build
from faying.cli.main import cli
from faying.geometry.selectors import Selector
from faying.study import Study
from tests.helpers.assemblies import bracket, flanges
from tests.helpers.proposed import proposed


@pytest.fixture(scope="module")
def screwed(tmp_path_factory):
    return Study.read(proposed(bracket(tmp_path_factory.mktemp("bracket") / "bracket.step"), "14 mm"))


@pytest.fixture(scope="module")
def fitted(screwed):
    structure = build(screwed)
    return structure, structure.fitted_bolts


def test_a_blind_hole_of_a_tap_drill_takes_a_screw(screwed):
    assert [bolt.fastener.thread.diameter for bolt in screwed.bolts] == pytest.approx([10e-3] * 2)
    assert all(bolt.at is None and bolt.seat == pytest.approx((11e-3, 16e-3)) for bolt in screwed.bolts)


def test_the_screw_lies_on_the_axis_of_its_hole(fitted):
    """From the top of the plate, 52 mm, half a diameter into the thread, whose mouth is at 40 mm."""
    for bolt, x in zip(fitted[1], (25e-3, 75e-3), strict=True):
        assert isinstance(bolt, FittedBolt)
        assert bolt.point == pytest.approx((x, 30e-3, 52e-3), abs=1e-6)
        assert bolt.axis == pytest.approx((0, 0, -1), abs=1e-6)
        assert bolt.length == pytest.approx(12e-3 + 5e-3)
        nominal, minor = pi / 4 * 10e-3**2, pi / 4 * (10e-3 - 1.22687 * 1.5e-3) ** 2
        pieces = (0.4 + 0.33) * 10e-3 / nominal + (12e-3 + 5e-3) / minor  # head, tapped hole; free and engaged thread
        assert bolt.axial_stiffness == pytest.approx(faying.CATALOGUE["S355"].E / pieces)


def test_even_heat_leaves_a_screw_alone(fitted):
    """Its ends are the seat and the middle of the thread, which part as all expands: 12 mm and half of 15 mm."""
    structure, bolts = fitted
    change = dict.fromkeys((*structure.mesh.parts, *(bolt.bolt.name for bolt in bolts)), 50.0)
    heat = acting(structure, [faying.Load("even", temperature=change)])["even"]
    expansion = faying.CATALOGUE["S355"].expansion * 50
    for bolt, longer in zip(bolts, heat.longer, strict=True):
        assert longer == pytest.approx(-bolt.load @ (expansion * structure.mesh.points.ravel()), rel=1e-12)
        assert longer == pytest.approx(expansion * (12e-3 + 7.5e-3), rel=0.08)


def test_the_thread_pulls_evenly_over_the_length_that_it_engages(fitted):
    structure, (bolt, _) = fitted
    force = bolt.load.reshape(-1, 3)
    z = structure.mesh.points[:, 2]
    base = structure.mesh.part_nodes("base")
    assert force.sum(axis=0) == pytest.approx(0, abs=1e-12)
    assert force[base, 2].sum() == pytest.approx(1)
    arms = structure.mesh.points - bolt.point
    assert np.cross(arms, force).sum(axis=0) == pytest.approx(0, abs=1e-12)
    # 15 mm are engaged from 40 mm down: the force acts in the middle, at 32.5 mm, as far as the mesh resolves it
    assert (z[base] @ force[base, 2]) == pytest.approx(32.5e-3, abs=1.5e-3)
    assert bolt.thread.high == pytest.approx(15e-3)


@pytest.mark.slow
def test_the_screwed_joint_carries_its_preload_and_lies_between_free_and_bonded(screwed):
    found = run(replace(screwed, modes=replace(screwed.modes, intervals=False)))
    force = sum(screwed.preloads[0].forces)
    assert found.pressure[0] @ found.weights == pytest.approx(force, rel=1e-6)
    assert np.all(found.free <= found.frequencies[0])
    assert np.all(found.frequencies[0] <= found.bonded)
    assert [note.code for note in found.notes].count("bolt-thread") == 2


def test_a_thread_longer_than_its_hole_is_refused(screwed, fitted):
    mesh = fitted[0].mesh
    deep = replace(screwed.bolts[0], engaged=30e-3)
    with pytest.raises(faying.InputError, match="engaged = 30 mm, but its hole is 25 mm deep"):
        deep.placed(mesh)
    turned = replace(screwed.bolts[0], faces=screwed.bolts[0].faces[::-1])
    with pytest.raises(faying.InputError, match="is the wall of a hole; give the face under the head first"):
        turned.placed(mesh)
    seats = (screwed.bolts[0].faces[0], fitted[0].joints[0].faces[1])
    with pytest.raises(faying.InputError, match="engaged is for a tapped hole"):
        replace(deep, faces=seats).placed(mesh)


@pytest.fixture(scope="module", params=[pytest.param(0.0, marks=pytest.mark.slow), 2.0])
def flanged(request, tmp_path_factory):
    """Flanges with raised faces of so many mm: path, study, structure."""
    folder = tmp_path_factory.mktemp("flanges")
    path = flanges(folder / "flanges.step", raised=request.param, pipe=20.0)
    study = Study.read(proposed(path, "15 mm"))
    return request.param, path, study, build(study)


def test_flanges_have_six_bolts_and_pass_the_check(flanged):
    """A pipe stands on the seats, and raised faces leave 4 mm between the holes of both flanges."""
    raised, path, study, structure = flanged
    assert len(study.joints) == 1
    assert [bolt.fastener.thread.diameter for bolt in study.bolts] == pytest.approx([10e-3] * 6)
    done = CliRunner().invoke(cli, ["check", str(path.with_suffix(".toml"))])
    assert done.exit_code == 0, done.output
    assert "0 faults" in done.output
    lengths = [bolt.length for bolt in structure.fitted_bolts]
    assert lengths == pytest.approx([2e-3 * (12 + raised)] * 6, rel=1e-6)


def test_a_head_over_the_edge_of_a_wide_hole_is_refused(flanged):
    """A bolt whose axis runs inside the pipe has nothing to press on."""
    _, _, study, structure = flanged
    bolt = study.bolts[0]
    inside = (20e-3, 0.0, bolt.at[2])
    with pytest.raises(faying.InputError, match="away from the centre of the hole"):
        replace(bolt, at=inside).placed(structure.mesh)


def test_faces_that_are_meant_together_by_their_numbers():
    assert str(Selector(part="base", number=(3, 5))) == "part = 'base', number = [3, 5]"
    assert Selector(part="base", number=3).numbers == (3,)
