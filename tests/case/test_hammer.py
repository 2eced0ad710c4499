"""A hammer test in the study: the example's, its full response against a direct solution, and the files that are
written."""

import json
import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse.linalg import splu

import faying
from faying import compare_modes, read_model_modes, read_uff
from faying.answer.run import run
from faying.case.case import build
from faying.case.response import LoadedStructure, poor
from faying.cli import main
from faying.export import universal
from faying.joint.modal import Vibration
from faying.joint.tighten import tighten
from faying.numerics.damped import damped_modes
from faying.numerics.modes import lowest_modes
from faying.study import Study

EXAMPLE = Path(__file__).parents[2] / "examples" / "hammer-test" / "study.toml"


@pytest.fixture(scope="module")
def plan():
    return Study.read(EXAMPLE)


@pytest.fixture(scope="module")
def result(plan):
    """Without intervals and levels, which are tested elsewhere and take two thirds of the time."""
    return run(replace(plan, modes=replace(plan.modes, intervals=False, levels=())))


@pytest.fixture(scope="module")
def files(result, tmp_path_factory):
    folder = tmp_path_factory.mktemp("uff")
    universal.write(result, folder)
    result.save(folder / "result.nc")
    return folder


@pytest.fixture(scope="module")
def solved(plan):
    """The example still coarser, for direct solutions."""
    coarse = replace(plan, geometry=replace(plan.geometry, size=2e-2, face_size={}))
    structure = build(coarse)
    preload = tighten(structure, structure.assembly(), [6e3])
    stiffness, loss = structure.coupled(structure.springs(preload.pressures))
    mass = structure.dynamic_matrices[1]
    modes = lowest_modes(stiffness, mass, 30, shift_frequency=structure.shift_frequency)
    damped = damped_modes(modes, stiffness, mass, loss, rigid=6, count=18)
    found = Vibration(modes=modes, damped=damped, stiffness=stiffness, loss=loss)
    return LoadedStructure(study=coarse, structure=structure, found=found)


@pytest.mark.slow
def test_full_response_answers_the_full_equations(solved):
    """Against a factorisation of K (1 + ..) + iC - w2 M at each frequency, without any basis."""
    rng = np.random.default_rng(0)
    nodes = rng.choice(solved.structure.outline()[0], 4, replace=False)
    axes = np.linalg.qr(rng.standard_normal((3, 3)))[0][[0, 1, 2, 0]]
    outputs, inputs = (nodes[:3], axes[:3]), (nodes[3:], axes[3:])
    lines = np.array([700.0, 9800.0, 13000.0])
    full, _ = solved.at_test(lines, outputs, inputs)
    push, read = solved._columns(*inputs), solved._columns(*outputs)
    mass = solved.structure.dynamic_matrices[1]
    for k, f in enumerate(lines):
        matrix = (solved.found.stiffness + 1j * solved.found.loss - (2 * np.pi * f) ** 2 * mass).tocsc()
        direct = read.T @ splu(matrix).solve(push.astype(complex))
        assert np.linalg.norm(full.receptance[:, :, k] - direct) < 2e-3 * np.linalg.norm(direct)


def test_many_inputs_are_solved_the_other_way_round(solved):
    nodes = solved.structure.outline()[0][[3, 40, 90]]
    many, one = (nodes, np.eye(3)), (nodes[:1], np.eye(3)[2:])
    lines = np.array([5000.0, 9000.0])
    straight, _ = solved.at_test(lines, many, one)
    turned, _ = solved.at_test(lines, one, many)
    np.testing.assert_allclose(turned.receptance, straight.receptance.transpose(1, 0, 2), rtol=1e-10)
    np.testing.assert_array_equal(turned.inputs[0], straight.outputs[0])


def test_a_poor_response_is_noted():
    assert poor(np.array([1.0, 2]), np.array([0.001, 0.002]), "of the study") == []
    (note,) = poor(np.array([100.0, 200]), np.array([0.001, 0.3]), "of the study")
    assert "30.0% at 200 Hz" in note.text
    assert "raise modes.count" in note.text


def test_the_study_carries_the_comparison(result):
    """What is hammered in the example is stiffer by 3 % and tighter by 1 kN: every mode finds its partner, 0 to 2 %
    off."""
    found = result.hammer
    assert found.model.load == 6e3
    assert found.pairs.tolist() == [[k, k] for k in range(7)]
    assert np.all((found.frequency_difference < 0) & (found.frequency_difference > -0.02))
    assert np.diag(found.mac).min() > 0.9
    assert found.full.all()
    assert json.loads(json.dumps(result.to_dict()))["hammer_test"]["frac"][0]["model"] == "full response"
    assert any("modes are identified from its FRFs" in note for note in found.notes)


def test_rigid_motion_is_in_the_overlay(result):
    """Far below the first mode the parts move as one: accelerance sums over a rigid body of the blocks' mass."""
    found = result.hammer
    body, at = result.outline, result.outline[found.point_map.nodes[1]]
    push = found.point_map.transform.directions(np.eye(3)[2])
    size = np.array([80e-3, 30e-3, 30e-3])
    hole, density = 9e-3, 7890.0
    mass = density * (size.prod() - np.pi / 4 * hole**2 * size[2])
    inertia = mass / 12 * (np.sum(size**2) - size**2)  # the hole takes some per mille
    arm = np.cross(at, push)
    expected = push @ push / mass + arm @ (arm / inertia)
    k = [str(d) for d in found.frf.outputs].index("1+z")
    assert np.allclose(body.mean(axis=0), 0, atol=5e-3)
    assert found.predicted[k, 0, 0].real == pytest.approx(expected, rel=0.03)


def test_modes_and_frfs_come_back_from_universal_files(result, files):
    """What --uff writes, read as a test and set beside the result file: the same modes, the same FRFs."""
    modes, frf = read_uff(files / "modes.uff").modes(), read_uff(files / "frf.uff").frf()
    np.testing.assert_allclose(modes.frequencies, result.frequencies[-1], rtol=1e-5)
    np.testing.assert_allclose(modes.loss_factors, result.loss_factors[-1], rtol=1e-5)
    response = result.response
    omega = 2 * np.pi * response.frequencies[:, None, None]
    assert frf.quantity == "accelerance"
    np.testing.assert_allclose(frf.values, (-(omega**2) * response.values[-1]).transpose(1, 2, 0), rtol=1e-9)
    found = compare_modes(modes, read_model_modes(files / "result.nc"), frf=frf, tolerance=1e-6)
    np.testing.assert_allclose(np.diag(found.mac), 1, atol=1e-6)
    assert found.pairs.tolist() == [[k, k] for k in range(10)]
    assert found.full.all()
    # the file rounds frequencies, which the response of lightly damped modes feels
    np.testing.assert_allclose(found.frac, 1, atol=1e-5)


def test_points_are_spread_over_the_outline_and_begin_with_those_of_the_response(result, files):
    positions = read_uff(files / "modes.uff").modes().positions
    assert positions[1] == pytest.approx((0.04, 0.015, 0.015))
    assert positions[2] == pytest.approx((-0.04, -0.015, -0.015))
    points = np.array(list(positions.values()))
    assert 100 < len(points) <= universal.MAX_POINTS
    outside = result.outline[np.abs(result.outline[:, 2]) > 1e-6]  # the faces of the joint lie at z = 0, in pairs
    away = np.linalg.norm(outside[:, None] - points, axis=2).min(axis=1)
    assert away.max() < 10e-3  # no bare patch wider than a tenth of the blocks
    assert np.abs(points[:, 2]).min() > 1e-6


def test_files_at_the_points_of_the_test_speak_its_numbers_and_frame(plan, result, files):
    test = read_uff(plan.hammer.file).frf()
    modes, frf = read_uff(files / "test_modes.uff").modes(), read_uff(files / "test_frf.uff").frf()
    assert set(frf.outputs) == set(test.outputs)
    for label, place in modes.positions.items():
        assert place == pytest.approx(test.positions[label], abs=1e-12)
    k, j = frf.outputs.index((3, "y")), result.hammer.frf.outputs.index((3, "y"))
    np.testing.assert_allclose(frf.values[k, 0], result.hammer.predicted[j, 0], rtol=1e-9)
    found = compare_modes(modes, result.hammer.model, transform=result.hammer.point_map.transform, tolerance=5e-3)
    np.testing.assert_allclose(np.diag(found.mac), 1, atol=1e-6)


@pytest.mark.slow
def test_the_command_writes_report_figures_and_files(result, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(
        "faying.answer.run.run", lambda plan, report, **_: report("modes free and bonded", 1, 2) or result
    )
    with pytest.raises(SystemExit) as stop:
        main(["run", str(EXAMPLE), "--all", "--uff", "--out", str(tmp_path)])
    out = capsys.readouterr().out
    assert stop.value.code == 0, out
    assert "hammer test at 6 kN" in out
    assert "hysteretic loss" in out
    assert "the model's FRFs are its full response" in " ".join(out.split())
    made = {p.name for p in tmp_path.iterdir()}
    assert made >= {"comparison.csv", "test_mac.svg", "test_frf.svg", "test_shapes.png", "mac.svg"}
    assert made >= {"response.svg", "modes.uff", "frf.uff", "test_modes.uff", "test_frf.uff"}
    page = (tmp_path / "report.html").read_text()
    for heading in ("<h2>Hammer test</h2>", "<h3>Modes at every preload</h3>", "<h3>Joints</h3>"):
        assert page.count(heading) == 1
    assert len(re.findall("<figure[ >]", page)) == 5 + 2 + 3


def test_what_no_universal_file_can_state_is_said_before_the_run(plan, tmp_path, capsys):
    oblique = replace(plan.response, inputs=((plan.response.inputs[0][0], (1.0, 1.0, 0.0)),))
    with pytest.raises(faying.InputError, match="is along none of x, y, z"):
        universal.check(oblique)
    universal.check(plan.response)
    universal.check(None)
    with pytest.raises(SystemExit) as stop:
        main(["run", str(EXAMPLE), "--uff", "--no-files"])
    assert stop.value.code == 1
    assert "--uff writes files and --no-files forbids them" in capsys.readouterr().err


def test_a_test_that_cannot_be_read_or_mapped_stops_before_anything_is_solved(plan, tmp_path):
    said = []
    bad = tmp_path / "bad.uff"
    bad.write_text("no universal file")
    with pytest.raises(faying.ReadError):
        run(replace(plan, hammer=replace(plan.hammer, file=bad)), report=lambda stage, done, total: said.append(stage))
    with pytest.raises(faying.InputError, match="no point of the test is within"):
        run(
            replace(plan, hammer=replace(plan.hammer, frame=None)), report=lambda stage, done, total: said.append(stage)
        )
    assert not any("preload" in text for text in said)
