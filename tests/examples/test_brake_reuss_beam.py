"""The Brake-Reuss beam with its measured interface beside the published model of the same interface."""

import os
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from faying.answer.run import run
from faying.study import Study

ROOT = Path(__file__).parent.parent.parent
EXAMPLE = ROOT / "examples" / "brake-reuss-beam"
DATA = (
    Path(os.environ.get("FAYING_DATA", ROOT.parent / "shared" / "data")) / "brake-reuss-beam" / "brb_surface_data.mat"
)
PUBLISHED = {"flat": [168.50, 580.41, 1177.65], "measured-form": [180.63, 595.28, 1199.90]}
needs_data = pytest.mark.skipif(not DATA.is_file(), reason=f"the measured interface is absent: {DATA}; set FAYING_DATA")


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    target = tmp_path_factory.mktemp("example") / "brake-reuss-beam"
    shutil.copytree(EXAMPLE, target, ignore=shutil.ignore_patterns("results", "data"))
    return target


def extract(folder, *words):
    return subprocess.run(
        [sys.executable, str(folder / "make_data.py"), *words], capture_output=True, text=True, check=False
    )


def test_without_the_measurement_it_says_where_to_get_it(folder):
    done = extract(folder, str(folder / "none.mat"))
    assert done.returncode != 0
    assert "get brb_surface_data.mat from https://github.com/tmd-lab/tmdsimpy" in done.stderr


def test_the_joint_has_the_area_of_the_published_mesh(folder):
    """2921 mm2 in the reduced published mesh, whose holes are polygons: within 0.3 %."""
    from faying.geometry.cad import read_parts

    areas = {
        face.name: face.mass for solid in read_parts(folder / "brake-reuss-beam.step").solids for face in solid.faces
    }
    assert areas["left.joint"] == pytest.approx(2921.0, rel=0.003)
    assert areas["right.joint"] == pytest.approx(areas["left.joint"], rel=1e-9)


@pytest.fixture(scope="module")
def results(folder):
    assert extract(folder, str(DATA)).returncode == 0
    return {name: run(Study.read(folder / f"{name}.toml")) for name in PUBLISHED}


@needs_data
@pytest.mark.slow
def test_bending_modes_lie_near_the_published_ones(results, published):
    """2 %: the published bolts are not ours (docs/brake-reuss-beam.md: bolt masses alone move mode 1 by 1.7 %)."""
    for name, theirs in PUBLISHED.items():
        comparison = results[name].comparison
        for number, (value, ours) in enumerate(zip(theirs, comparison.predicted[0], strict=True), start=1):
            published(
                f"Brake-Reuss beam, {name}: bending mode {number}",
                value,
                ours,
                unit="Hz",
                rel=0.02,
                source="doi:10.1016/j.ymssp.2023.110210",
                why="the masses of the published bolts are not ours: they alone move mode 1 by 1.7 %",
            )
        assert comparison.modes[0].tolist() == [0, 2, 4]  # bending in the other plane lies between, as published


@needs_data
@pytest.mark.slow
def test_form_error_stiffens_mode_one_by_seven_percent_or_so(results):
    ratio = results["measured-form"].frequencies[0, 0] / results["flat"].frequencies[0, 0] - 1
    assert ratio == pytest.approx(180.63 / 168.50 - 1, abs=0.02)


@needs_data
@pytest.mark.slow
def test_bolts_balance_and_form_moves_pressure_outwards(results):
    far = {}
    for name, result in results.items():
        assert result.weights @ result.pressure[0] == pytest.approx(12002 + 12075 + 12670, rel=1e-6)
        outside = np.abs(result.points[:, 0]) > 0.045
        far[name] = float(result.weights[outside] @ result.pressure[0][outside])
    assert far["measured-form"] > 1.5 * far["flat"]


BACKBONES = DATA.parent.parent / "brake-reuss-backbones"
# acceleration [m/s2], damping ratio of the published curves less their viscous part of .087 %
CURVES = {"flat": "brb_epmc_flat.yaml", "measured-form": "brb_epmc_meso.yaml"}


@needs_data
@pytest.mark.skipif(not BACKBONES.is_dir(), reason=f"the published curves are absent: {BACKBONES}")
@pytest.mark.slow
@pytest.mark.parametrize("name", CURVES)
def test_a_joint_that_slides_loses_what_the_published_one_does(folder, name, published):
    """Above 20 m/s2, where most asperities slide as a whole in both models; nothing is fitted (docs/backbone.md)."""
    import faying

    assert extract(folder, str(DATA)).returncode == 0
    lines = dict(line.split(":", 1) for line in (BACKBONES / CURVES[name]).read_text().splitlines() if ":" in line)
    theirs = {
        key.strip(): np.array([float(v) for v in text.strip(" []").split(",")])
        for key, text in lines.items()
        if "[" in text
    }
    curve = faying.backbone(folder / f"{name}.toml", mode=1, friction=0.03, amplitude=(3.0, 60.0))
    x = np.log(theirs["acceleration_amplitude"])
    for level in (20.0, 40.0, 59.0):
        f, z = (float(v) for v in curve.at_acceleration(level))
        damping = np.exp(np.interp(np.log(level), x, np.log(theirs["damping_factor_frac_crit"]))) - 0.00087
        published(
            f"Brake-Reuss beam, {name}: damping ratio of mode 1 at {level:g} m/s2",
            damping,
            z,
            rel=0.1,
            source="doi:10.1016/j.ymssp.2023.110210, code and curves",
            why="most asperities slide as a whole in both models; below 20 m/s2 the asperities' slip differs",
        )
    frequency = np.interp(np.log(59.0), x, theirs["frequency_rad_per_s"])
    published(
        f"Brake-Reuss beam, {name}: relative fall of the frequency of mode 1 at 59 m/s2",
        1 - frequency / theirs["frequency_rad_per_s"][0],
        1 - f / curve.linear_frequency,
        rel=0.12,
        source="doi:10.1016/j.ymssp.2023.110210, code and curves",
        why="the joint's area that slides at this level depends on the mesh of both models",
    )
    # the two methods part by less than 3 %, and the curve says so where they part by more than 2 %
    assert np.all(np.abs(curve.witness.damping_change) < 0.03)
    assert abs(curve.bounds.points_damping) < 0.03
    assert abs(curve.bounds.samples_damping) < 0.01


@needs_data
@pytest.mark.slow
def test_the_published_frequencies_lie_in_what_is_predicted_before_any_test(folder, published):
    """Preload, form, stiffness and E scatter; the intervals of 32 samples are known to a fifth of their width."""
    import faying

    assert extract(folder, str(DATA)).returncode == 0
    found = faying.predict(folder / "uncertain.toml", samples=32)
    low, median, high = found.quantiles((0.05, 0.5, 0.95)).frequencies[:, 0]
    for number, (mode, theirs) in enumerate(zip((0, 2, 4), PUBLISHED["flat"], strict=True), start=1):
        published(
            f"Brake-Reuss beam, flat, before any test: median of bending mode {number}",
            theirs,
            median[mode],
            unit="Hz",
            tol=0.7 * (high[mode] - low[mode]),
            source="doi:10.1016/j.ymssp.2023.110210, code and curves",
            why="tolerance .7 times the width of the interval from 5 to 95 %",
        )


@needs_data
@pytest.mark.slow
def test_levels_of_three_bending_modes_are_those_of_harmonic_balance(folder):
    """Half a per cent of a damping up to 0.3 %, 2 % above; the frequency to a thousandth up to a damping of 2.5 %.

    The stated error covers every level, also where mode 5 joins mode 3 at twice its frequency: there harmonic balance
    has a third more damping. The frequency is within 2 % of its change from rest up to there.
    """
    import faying

    assert extract(folder, str(DATA)).returncode == 0
    study = Study.read(folder / "measured-form.toml")
    joints = tuple(replace(joint, friction=0.05) for joint in study.joints)
    plan = replace(study, joints=joints, modes=replace(study.modes, count=5, intervals=False, levels=()))
    curves, picked, over = {}, {}, []
    for mode in (1, 3, 5):
        curve = faying.backbone(plan, mode, 0.05, (0.1, 100.0), rest_damping=0.0)
        inside = np.flatnonzero(curve.damping > 2e-6)
        number = 12 if curve.code == "other-modes" else 7
        curves[mode], picked[mode] = curve, inside[np.unique(np.linspace(0, len(inside) - 1, number).astype(int))]
    levels = tuple(sorted({float(a) for mode, curve in curves.items() for a in curve.acceleration[picked[mode]]}))
    found = run(replace(plan, modes=replace(plan.modes, levels=levels)))
    for mode, curve in curves.items():
        k = [levels.index(float(a)) for a in curve.acceleration[picked[mode]]]
        damping, frequency = curve.damping[picked[mode]], curve.frequency[picked[mode]]
        ratio = np.abs(found.levels.slip[0, k, mode - 1] / damping - 1)
        assert np.all(ratio < found.levels.error[0, k, mode - 1] + 2e-3)
        last = curve.acceleration[-1] * (0.55 if curve.code == "other-modes" else 1)
        alone = curve.acceleration[picked[mode]] <= last
        assert np.all(ratio[alone] < np.where(damping < 3e-3, 1e-2, 0.02)[alone])
        over.append(ratio[alone][damping[alone] < 3e-3].max(initial=0.0))
        moved = np.abs(found.levels.frequencies[0, k, mode - 1] - frequency)[alone]
        assert np.all(moved < 0.02 * np.abs(frequency - curve.linear_frequency)[alone] + 1e-7 * frequency[alone])
        assert np.all((moved / frequency[alone])[damping[alone] < 0.025] < 1e-3)
    assert curves[1].damping.max() > 0.035
    assert curves[3].code == "other-modes"
    assert max(over) < 5e-3
