"""What scatters by default: beside published models and tests, and what a study says in its place."""

import csv
from collections import defaultdict
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import faying
from faying.answer.interval import Draws, _preload_factors
from faying.case.case import Case
from faying.case.level_damping import REST
from faying.case.scatter import (
    SCORE,
    default,
    discrepancy,
    force_factors,
    known_of,
    mode_sd,
    stated,
    structure_sd,
    with_assumed,
)
from faying.study import Study
from tests.helpers.meshfiles import LOW_AND_HIGH, abaqus
from tests.helpers.plates import stacked

ROOT = Path(__file__).parents[2]
THEORY = ROOT / "docs" / "theory"
BLOCKS = ROOT / "examples" / "two-blocks"


@pytest.fixture(scope="module")
def logs() -> dict[str, np.ndarray]:
    """ln measured over nominal model, by structure, of those whose joint makes no difference."""
    found = defaultdict(list)
    with (THEORY / "model-versus-test.csv").open(encoding="utf-8") as file:
        for row in csv.DictReader(file):
            if row["counts"] == "yes":
                found[row["structure"]].append(float(row["measured [Hz]"]) / float(row["nominal model [Hz]"]))
    return {name: np.log(values) for name, values in found.items()}


def of_two_kinds(logs) -> tuple[float, float]:
    """Root mean square of the means of structures, about none, and of the modes about them."""
    means = np.array([one.mean() for one in logs])
    return float(np.sqrt(np.mean(means**2))), float(np.sqrt(np.mean([one.var(ddof=1) for one in logs])))


def test_the_priors_of_structure_and_mode_are_those_of_published_pairs(logs):
    common, each = of_two_kinds(list(logs.values()))
    # four structures: a chi-square of four degrees holds 90 % from 0.65 to 2.4 times the root
    assert 0.65 * common < default("structure").spread < 2.4 * common
    # nineteen degrees of their modes: 0.79 to 1.37 times
    assert 0.79 * each < default("mode").spread < 1.37 * each


def test_intervals_of_90_percent_hold_them_also_with_the_source_left_out(logs):
    every = np.concatenate(list(logs.values()))
    end = SCORE * np.hypot(default("structure").spread, default("mode").spread)
    assert np.mean(np.abs(every) < end) > 0.8
    inside = []
    for name, values in logs.items():
        others = of_two_kinds([other for key, other in logs.items() if key != name])
        inside += list(np.abs(values) < SCORE * np.hypot(*others))
    assert np.mean(inside) > 0.8


def test_damping_at_rest_of_measured_structures_is_within_its_prior():
    with (THEORY / "damping-at-rest.csv").open(encoding="utf-8") as file:
        ratios = np.array([float(row["damping ratio [%]"]) / 100 for row in csv.DictReader(file)])
    assert np.mean((ratios > REST[0]) & (ratios < REST[2])) > 0.9
    assert np.median(ratios) == pytest.approx(REST[1], rel=0.3)
    assert REST[1] ** 2 == pytest.approx(REST[0] * REST[2], rel=0.1)  # a lognormal


def listed(lines: str, tmp_path, study: str = "study.toml") -> Study:
    """The two blocks with lines of [uncertain]."""
    text = (BLOCKS / study).read_text(encoding="utf-8").replace('"model.inp"', f'"{(BLOCKS / "model.inp").as_posix()}"')
    path = tmp_path / "study.toml"
    path.write_text(f"{text}\n[uncertain]\n{lines}\n", encoding="utf-8")
    return Study.read(path)


def keys(study: Study) -> set[str]:
    return set(known_of(Case.of(study)))


def test_what_is_listed_takes_the_place_of_that_alone(tmp_path):
    plain = Study.read(BLOCKS / "study.toml")
    every = keys(plain)
    named = listed('E = "200 GPa +- 2 GPa"', tmp_path)
    assert keys(named) == every | {"material.steel.E"} or keys(named) - every == {
        one.key for one in named.uncertain.inputs
    }
    assert structure_sd(plain.uncertain) == default("structure").spread
    # the dimensions stay unknown
    assert structure_sd(named.uncertain) == pytest.approx(np.sqrt(0.03**2 - 0.015**2), rel=1e-3)
    assert discrepancy(named.uncertain) == pytest.approx(np.sqrt(0.03**2 - 0.015**2 + mode_sd(None) ** 2), rel=1e-3)


def test_only_leaves_out_what_is_assumed(tmp_path):
    study = listed('only = true\nE = "200 GPa +- 2 GPa"', tmp_path)
    assert known_of(Case.of(study)) == stated(study.uncertain)


def test_the_structure_can_be_known_better(tmp_path):
    study = listed('structure = "0.5 %"', tmp_path)
    assert structure_sd(study.uncertain) == pytest.approx(0.005)
    assert discrepancy(study.uncertain) == pytest.approx(np.hypot(0.005, mode_sd(None)))


def test_a_joint_that_is_listed_leaves_the_others_as_assumed(tmp_path):
    study = listed("", tmp_path)
    joint = study.joints[0]
    two = replace(study, joints=(joint, replace(joint, name="other", number=2)), uncertain=None)
    case = Case.of(study)
    structure = SimpleNamespace(mesh=case.structure.mesh, joints=2 * case.structure.joints)

    def known(plan: Study) -> set[str]:
        return {one.key for one in with_assumed(plan, structure, 2 * case.surfaces).inputs}

    common = known(two)
    assert {"joint.stiffness", "joint.tangential"} <= common
    given = replace(two, joints=(replace(joint, tangential=0.6), two.joints[1]))
    assert known(given) == common - {"joint.tangential"} | {"joint.other.tangential"}
    one = listed(f'joint."{joint.name}".stiffness = "0.5 to 2"', tmp_path).uncertain
    found = known(replace(two, uncertain=one))
    assert found == common - {"joint.stiffness"} | {f"joint.{joint.name}.stiffness", "joint.other.stiffness"}


def test_a_preload_that_is_listed_has_no_factor_as_well(tmp_path):
    path = tmp_path / "study.toml"
    text = (
        (BLOCKS / "study.toml")
        .read_text(encoding="utf-8")
        .replace('"model.inp"', f'"{(BLOCKS / "model.inp").as_posix()}"')
    )
    path.write_text(text.replace('preload = ["1 kN", "3 kN"]', 'preload = "3 kN +- 0.1 kN"'), encoding="utf-8")
    found = keys(Study.read(path))
    assert any(key.endswith(".preload") for key in found)
    assert not any(key.endswith(".factor") for key in found)


def test_seats_of_solid_bolts_have_no_waves_that_nobody_gives():
    study = Study.read(ROOT / "examples" / "solid-bolt" / "study.toml")
    wavy = {key.split(".")[1] for key in keys(study) if "waviness" in key}
    assert wavy < {joint.name for joint in study.joints}


CURVED = (
    LOW_AND_HIGH
    + """[[joint]]
name = "joint"
faces = ["low.top", "high.bottom"]
[[bolt]]
faces = ["high.top", "low.bottom"]
preload = "8 kN"
[modes]
count = 3
levels = []
"""
)


@pytest.mark.parametrize("rise", [0.0, 0.02])
def test_a_prediction_draws_waves_where_a_run_draws_them(tmp_path, rise):
    """Plates bent to a cylinder have none: no key leads to waves that their faces refuse."""
    flat = stacked(counts=(8, 2, 1), size=(0.12, 0.03, 0.01))
    points = flat.points.copy()
    points[:, 2] += rise * (points[:, 0] / 0.06 - 1) ** 2
    (tmp_path / "model.inp").write_text(abaqus(replace(flat, points=points)))
    (tmp_path / "study.toml").write_text(CURVED)
    study = Study.read(tmp_path / "study.toml")
    case = Case.of(study)
    drawn = any(one.endswith("waviness_seed") for one in keys(study))
    assert drawn == bool(Draws.of(case, known_of(case)).drawn) == (rise == 0.0)
    if rise:
        found = faying.predict(study, samples=8)
        assert found.answered == 8
        assert [note.text for note in found.notes if note.code == "no-waves"]


@pytest.mark.parametrize(
    ("lines", "ends"),
    [
        ('E = "200 GPa +- 2 GPa"', [1 - 0.14 * SCORE, 1 + 0.14 * SCORE]),
        ("only = true", [1, 1]),
        ('bolt.factor = "1 +- 0.1"', [1 - 0.1 * SCORE, 1 + 0.1 * SCORE]),
        ('preload = { tightening = "load washer" }', [1 - 0.05 * SCORE, 1 + 0.05 * SCORE]),
        ('bolt.preload = "8 kN +- 0.4 kN"', [1 - 0.05 * SCORE, 1 + 0.05 * SCORE]),
        ('bolt.preload = "4 kN +- 0.4 kN"', [0.5 - 0.05 * SCORE, 0.5 + 0.05 * SCORE]),
    ],
)
def test_a_bolt_scatters_as_the_study_says_else_by_the_default_way(tmp_path, lines, ends):
    (tmp_path / "model.inp").write_text(abaqus(stacked()))
    (tmp_path / "study.toml").write_text(f"{CURVED}[uncertain]\n{lines}\n")
    study = Study.read(tmp_path / "study.toml")
    assert force_factors(known_of(Case.of(study)), study, 0, np.array([0.05, 0.95])) == pytest.approx(ends, abs=1e-4)


def test_a_bolt_that_is_not_listed_scatters_by_default_in_an_interval(tmp_path):
    """One bolt tightened by elongation says nothing of the other one."""
    bolt = (
        '[[bolt]]\nname = "{0}"\nfaces = ["high.top", "low.bottom"]\nat = ["{0}0 mm", "20 mm", "10 mm"]\n'
        'seat = ["0 mm", "16 mm"]\npreload = "8 kN"\n'
    )
    head, tail = CURVED.split("[[bolt]]")[0], CURVED[CURVED.index("[modes]") :]
    (tmp_path / "model.inp").write_text(abaqus(stacked()))
    listed = '[uncertain]\nbolt."2".factor = "1 +- 0.025"\n'
    (tmp_path / "study.toml").write_text(f"{head}{bolt.format(2)}{bolt.format(6)}{tail}{listed}")
    case = Case.of(Study.read(tmp_path / "study.toml"))
    low, middle, high = _preload_factors(case, known_of(case))
    assert middle == pytest.approx([1, 1], abs=1e-12)
    spread = SCORE * np.array([0.025, 0.14])
    assert low == pytest.approx(1 - spread, abs=1e-4)
    assert high == pytest.approx(1 + spread, abs=1e-4)
