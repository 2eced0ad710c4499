"""Curves of all modes by secant passes: beside runs at single levels, harmonic balance, and their own files."""

import csv
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.answer.level_curves import balanced_rows
from faying.answer.run import run
from faying.cli.main import cli
from faying.errors import InputError
from faying.study import Study
from tests.helpers import studies

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """Two blocks under JK on a coarse mesh, at two preloads."""
    path = tmp_path_factory.mktemp("curves") / "study.toml"
    studies.write(path)
    fine = Study.read(path)
    sizes = {name: 2 * size for name, size in fine.geometry.face_size.items()}
    geometry = replace(fine.geometry, size=2 * fine.geometry.size, face_size=sizes)
    return replace(fine, geometry=geometry, modes=replace(fine.modes, count=4))


@pytest.fixture(scope="module")
def curves(study):
    return faying.level_curves(study, 0.2, (10.0, 100.0), rest_damping=1e-4)


def test_a_curve_has_the_values_of_a_run_at_its_levels(study, curves):
    assert curves.levels[[0, -1]] == pytest.approx([10.0, 100.0])
    assert curves.frequencies.shape == (7, 4)
    joints = tuple(replace(joint, friction=0.2) for joint in study.joints)
    modes = replace(study.modes, levels=(10.0,), intervals=False)
    found = run(replace(study, joints=joints, modes=modes))
    # the basis of the curve is made for 100 m/s2, that of the run for 10: damping is right to a hundredth of itself,
    # and what slip takes from a frequency, which is as small as damping, to a few
    slip = found.level_slip[-1]
    assert curves.damping[[0]] - 1e-4 == pytest.approx(slip, rel=1e-2, abs=1e-9)
    assert np.all(abs(curves.frequencies[[0]] / found.level_frequencies[-1] - 1) <= 0.03 * slip + 1e-8)
    assert curves.load == pytest.approx(found.loads[-1])


def test_slip_lowers_frequencies_and_raises_damping(curves):
    moved = curves.damping[-1] > 2e-4
    assert moved.any()
    assert np.all(np.diff(curves.frequencies[:, moved], axis=0) < 0)
    assert np.all(np.diff(curves.damping[:, moved], axis=0) > 0)


def test_a_row_for_each_mode_and_level(curves, tmp_path):
    with curves.to_csv(tmp_path / "curves.csv").open(encoding="utf-8") as file:
        lines = list(csv.DictReader(file))
    assert len(lines) == curves.frequencies.size
    assert float(lines[7]["frequency [Hz]"]) == pytest.approx(curves.frequencies[0, 1], rel=1e-7)
    assert float(lines[7]["damping [%]"]) == pytest.approx(100 * curves.damping[0, 1], rel=1e-7)
    assert "4 modes" in repr(curves)


def test_the_command_writes_and_refuses(tmp_path):
    text = (EXAMPLES / "two-blocks" / "study.toml").read_text(encoding="utf-8")
    text = text.replace('"model.inp"', f'"{(EXAMPLES / "two-blocks" / "model.inp").as_posix()}"')
    toml = tmp_path / "study.toml"
    toml.write_text(text.replace("\n[[bolt]]", "\n[joint.form]\nflat = true\n\n[[bolt]]", 1), encoding="utf-8")
    words = ["backbone", str(toml), "--quick", "--friction", "0.2", "--amplitude", "1 m/s^2:10 m/s^2"]
    done = CliRunner().invoke(
        cli, [*words, "--json", "--out", str(tmp_path / "c.csv"), "--plot", str(tmp_path / "c.svg")]
    )
    assert done.exit_code == 0, done.output
    found = json.loads(done.output)
    assert np.array(found["damping"]["values"]).shape == (7, 5)
    assert Path(found["files"][0]).read_text().startswith("mode,acceleration")
    assert found["files"][1] == str(tmp_path / "c.svg")
    assert "<svg" in (tmp_path / "c.svg").read_text()
    for more in (["--coulomb"], ["--friction", "0.1,0.2"], ["--out", "curves.nc"]):
        refused = CliRunner().invoke(cli, [*words, *more], standalone_mode=False)
        assert isinstance(refused.exception, InputError)


@pytest.mark.slow
def test_harmonic_balance_beside_a_curve(study):
    """Both follow one mode; each row has the frequencies within 0.1 % and the damping within the stated error."""
    plan = replace(study, joints=tuple(replace(joint, friction=0.2) for joint in study.joints))
    curves = faying.level_curves(plan, amplitude=(1.0, 100.0))
    curve = faying.backbone(plan, 3, amplitude=(1.0, 100.0), rest_damping=0.0)
    lines = balanced_rows(curves, curve)[1:]
    assert len(lines) > 8
    for _, quick, balanced, slip, other, error in lines:
        assert float(quick) == pytest.approx(float(balanced), rel=1e-3)
        between = 0.02  # the curve by harmonic balance is interpolated
        assert float(slip) == pytest.approx(float(other), rel=0.01 * float(error) + between)
