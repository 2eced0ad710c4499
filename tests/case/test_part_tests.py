"""Tests of parts alone: factors of a part from its own test, shares of energy, intervals of twins of an assembly."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

import faying
from faying.answer.interval import elastic_modes, intervals
from faying.answer.run import run
from faying.case.bounds import bounds
from faying.case.case import Case, Progress
from faying.case.part_tests import BALANCE_SD, LEAST_SD, KnownParts, PartAlone, PartFactors, energy_shares, same_modes
from faying.case.solve import solve
from faying.distribution import Distribution
from faying.joint.structure import Structure
from faying.measured.frf import Dof
from faying.measured.modes import ModeSet
from faying.measured.uff_write import write_uff
from faying.numerics.follow import follow
from faying.result.interval import Interval
from faying.study.keys import test as keys
from faying.study.keys.material import PartTestChoice
from faying.study.keys.uncertain import Input
from tests.helpers.meshfiles import LOW_AND_HIGH, abaqus
from tests.helpers.plates import STEEL, plates, stacked

LAW_FACTOR = 1.5  # of the joint's stiffness to 5 and 95 %
MODES, NOISE, WEIGHED = 8, 1e-3, 5e-4  # asked for; sd of ln of a measured frequency, and of a weighed mass
STUDY = (
    LOW_AND_HIGH
    + f"""[[joint]]
name = "joint"
faces = ["low.top", "high.bottom"]
tangential = 0.6
[joint.form]
flat = true
[[bolt]]
faces = ["high.top", "low.bottom"]
preload = ["8 kN"]
[modes]
count = {MODES}
levels = []
[uncertain]
stiffness = {{ distribution = "lognormal", median = 1, factor = {LAW_FACTOR} }}
preload = {{ scatter = "5 %" }}
"""
)
ALONE = """
[geometry]
step = "bar.step"
size = "6 mm"
[part.bar]
material = "S355"
TEST
[modes]
count = 4
"""


@pytest.fixture(scope="module")
def assembly(tmp_path_factory):
    """A case of two plates that say nothing of their parts, its state, its interval, and the faces apart and bonded."""
    folder = tmp_path_factory.mktemp("twins")
    (folder / "model.inp").write_text(abaqus(stacked(counts=(8, 2, 1), size=(0.12, 0.03, 0.01))))
    (folder / "study.toml").write_text(STUDY)
    case = Case.of(faying.Study.read(folder / "study.toml"))
    states = [solve(case, 0, case.engine("reanalysis"), Progress(1))]
    return case, states, intervals(case, states, None)[1], bounds(case)[0]


def test_the_factors_are_the_mean_and_covariance_of_the_posterior():
    """Against sums over a fine grid of both factors."""
    ratios, errors, mass = np.array([0.021, 0.017, 0.024, 0.02]), np.array([0.0, 1e-3, 2e-3, 1e-3]), 0.004
    found = PartFactors.of(ratios, errors, prior=(0.03, 0.01), mode=0.01, mass=mass)
    e, m = np.meshgrid(np.linspace(0.0, 0.1, 1001), np.linspace(-2e-3, 0.01, 241), indexing="ij")
    exponent = (e / 0.03) ** 2 + (m / 0.01) ** 2 + ((mass - m) / BALANCE_SD) ** 2
    for ratio, error in zip(ratios, errors, strict=True):
        exponent += (ratio - (e - m) / 2) ** 2 / (found.scatter**2 + error**2)
    weight = np.exp(-exponent / 2)
    weight /= weight.sum()
    mean = np.array([(weight * e).sum(), (weight * m).sum()])
    about = np.stack([e - mean[0], m - mean[1]])
    np.testing.assert_allclose(found.mean, mean, rtol=1e-3)
    np.testing.assert_allclose(found.covariance, np.einsum("ab,iab,jab->ij", weight, about, about), rtol=0.01)


@pytest.mark.parametrize(("ratios", "expected"), [([], 0.01), ([0.03], 0.01), ([0.02] * 25, LEAST_SD)])
def test_without_modes_the_scatter_is_the_prior_and_many_that_agree_narrow_it(ratios, expected):
    found = PartFactors.of(np.array(ratios), np.zeros(len(ratios)), prior=(0.03, 0.01), mode=0.01)
    assert found.scatter == pytest.approx(expected)


def test_modes_that_a_test_missed_or_invented_are_left_out():
    computed = np.array([100.0, 104.0, 150.0, 210.0, 260.0, 300.0])
    measured = np.array([103 * 1.03, 150 * 1.031, 180.0, 300 * 1.029]) / [103 / 104, 1, 1, 1]
    rows, columns = same_modes(np.log(measured[:, None] / computed), 0.015, 0.01)
    assert rows.tolist() == [0, 1, 3]
    assert columns.tolist() == [1, 2, 5]


def test_a_bar_is_found_again_from_its_own_test(tmp_path):
    """A bar 6 % stiffer and 2 % heavier: the run of the nominal study finds both, and its frequencies."""
    from tests.geometry.test_face_facts import box, written

    written(tmp_path / "bar.step", box((0, 0, 0), (60, 20, 8), "bar"))
    (tmp_path / "nominal.toml").write_text(ALONE.replace("TEST", ""))
    nominal = run(tmp_path / "nominal.toml")
    truth = nominal.frequencies[0] * (1 - nominal.mesh_error[0]) * np.sqrt(1.06 / 1.02)
    listed = ", ".join(f'"{f:.3f} Hz"' for f in truth)
    mass = 1.02 * nominal.part_masses[0]
    (tmp_path / "rung.toml").write_text(ALONE.replace("TEST", f'mass = "{mass:.6f} kg"\nfrequencies = [{listed}]\n'))
    found = run(tmp_path / "rung.toml")
    (note,) = [note.text for note in found.notes if note.code == "part-test"]
    for what, true in (("stiffness", 1.06), ("mass", 1.02)):
        mean, sd = map(float, re.search(rf"{what} ([\d.]+) \+- ([\d.]+)", note).groups())
        assert abs(mean - true) < sd
    np.testing.assert_allclose(found.interval.best[0], truth, rtol=2e-3)
    assert found.interval.sources == ("mesh", "parts", "mode")
    assert np.all(found.interval.width < 0.5 * nominal.interval.width)


def test_a_file_of_modes_gives_the_frequencies(tmp_path):
    frequencies = [512.0, 1400.0]
    modes = ModeSet(
        frequencies=np.array(frequencies),
        loss_factors=np.full(2, 2e-3),
        shapes=np.array([[1.0], [0.5]]),
        dofs=(Dof(1, "z"),),
        positions={1: (0.0, 0.0, 0.0)},
    )
    file = write_uff(tmp_path / "part.uff", modes)
    part = PartAlone(name="bar", structure=plates(), test=PartTestChoice(file=file).read())
    np.testing.assert_allclose(part.measured, frequencies)


def test_a_file_that_is_no_test_is_named_before_any_work(tmp_path):
    (tmp_path / "model.inp").write_text(abaqus(stacked()))
    (tmp_path / "low.uff").write_text("this is no universal file")
    text = STUDY.replace('[part.low]\nmaterial = "45 steel"\n', '[part.low]\nmaterial = "45 steel"\nfile = "low.uff"\n')
    (tmp_path / "study.toml").write_text(text)
    stages: list[str] = []
    with pytest.raises(faying.FayingError, match="low.uff"):
        run(tmp_path / "study.toml", report=lambda stage, *_: stages.append(stage))
    assert stages == []
    (fault,) = faying.check(tmp_path / "study.toml").faults
    assert (fault.key, "low.uff" in fault.text) == ("part.low.file", True)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ('frequencies = ["1 kHz"]\nfile = "model.inp"\n', "part.low has both file and frequencies"),
        ("frequencies = []\n", r"part.low.frequencies = \[\] should be a list of frequencies"),
        ('frequencies = ["1 kg"]\n', "part.low.frequencies"),
        ('mass = "-1 kg"\n', "part.low.mass"),
    ],
)
def test_what_a_part_cannot_have_is_a_fault_of_the_study(tmp_path, keys, words):
    (tmp_path / "model.inp").write_text("")
    text = STUDY.replace('[part.low]\nmaterial = "45 steel"\n', f'[part.low]\nmaterial = "45 steel"\n{keys}')
    (tmp_path / "study.toml").write_text(text)
    with pytest.raises(faying.InputError, match=words):
        faying.Study.read(tmp_path / "study.toml")


def test_weight_alone_moves_the_best_estimate_by_half_of_it(assembly):
    case, states, interval, _ = assembly
    masses = dict(zip(case.structure.mesh.parts, case.structure.part_masses, strict=True))
    tests = {name: PartTestChoice(mass=1.01 * mass) for name, mass in masses.items()}
    after = narrowed(case, states, interval, tests)
    np.testing.assert_allclose(after.best / interval.best, 1 / np.sqrt(1.01), rtol=3e-4)
    assert "structure" in after.sources  # nothing was rung


def test_a_part_that_weighs_something_else_is_noted(assembly):
    case, states, _, _ = assembly
    study = replace(case.study, part_tests={"low": PartTestChoice(mass=1.3 * case.structure.part_masses[0])})
    known = KnownParts.of(study, case.structure, [elastic_modes(case, one) for one in states])
    assert [note.code for note in known.notes()] == ["part-test", "part-mass"]


def test_the_shares_of_energy_of_bonded_parts_sum_to_one():
    mesh = stacked().bonded_at(("low.top", "high.bottom"))
    strain, kinetic, others = energy_shares(*shares_of(Structure(mesh, STEEL, []), None))
    np.testing.assert_allclose(strain.sum(axis=0), 1, rtol=1e-6)
    np.testing.assert_allclose(kinetic.sum(axis=0), 1, rtol=1e-6)
    np.testing.assert_allclose(others, 0, atol=1e-6)


@pytest.mark.parametrize("change", ["E", "density"])
def test_half_of_a_share_is_what_a_factor_moves_a_mode_by(change):
    """d ln f = (kappa d ln E - mu d ln rho) / 2 of one part, against two solutions with a joint between the parts."""
    bolt = faying.Bolt(faces=("high.top", "low.bottom"), name="bolt")
    structure, *rest = shares_of(plates(bolts=(bolt,)), 5e3)
    strain, kinetic, _ = energy_shares(structure, *rest)
    both = []
    for factor in (0.99, 1.01):
        other = replace(STEEL, **{change: getattr(STEEL, change) * factor})
        made = replace(structure, materials={"low": other, "high": STEEL})
        both.append(made.solve(5e3, modes=6).modes.frequencies)
    moved = np.log(both[1] / both[0]) / np.log(1.01 / 0.99)
    expected = strain[0] / 2 if change == "E" else -kinetic[0] / 2
    np.testing.assert_allclose(moved, expected, atol=4e-3)


def shares_of(structure, preload):
    """A structure, its parts alone, its frequencies and its shapes, as `energy_shares` takes them."""
    state = structure.solve(preload, modes=6)
    parts = [SimpleNamespace(name=name, structure=structure.alone(name)) for name in structure.mesh.parts]
    elastic = slice(structure.rigid_count, structure.rigid_count + len(state.vibration.damped.frequencies))
    modes = state.vibration.modes
    return structure, parts, modes.frequencies[elastic], modes.shapes[:, elastic]


def narrowed(case, states, interval, tests, ends=(None, None)):
    """The interval with tests of parts, from that without."""
    study = replace(case.study, part_tests=tests)
    known = KnownParts.of(study, case.structure, [elastic_modes(case, one) for one in states])
    offsets, moved = known.instead(dict(zip(interval.sources, interval.offsets, strict=True)))
    return Interval.about(interval.best * np.exp(moved), offsets, moved).between(*ends)


def twin(case, states, rng, spread=(0.03, 0.01, 0.02)):
    """Frequencies [Hz] of a true assembly, and the tests of its parts: E, density, thickness and law at random."""
    nominal, materials = case.structure, {}
    stiffer = np.exp(np.log(LAW_FACTOR) / 1.6449 * rng.standard_normal())
    mesh = nominal.mesh
    points, plane = mesh.points.copy(), mesh.points[mesh.part_nodes("low"), 2].max()
    for name in mesh.parts:
        E, density, thickness = np.exp(np.array(spread) * rng.standard_normal(3))
        steel = nominal.materials[name]
        materials[name] = replace(steel, E=steel.E * E, density=steel.density * density)
        nodes = mesh.part_nodes(name)
        points[nodes, 2] = plane + (points[nodes, 2] - plane) * thickness
    joints = [replace(joint, law=joint.law.scaled(stiffer)) for joint in nominal.joints]
    whole, tests = Structure(replace(mesh, points=points), materials, joints, nominal.bolts), {}
    for name in mesh.parts:
        part = whole.alone(name)
        rung = part.solve(modes=10).modes.frequencies * np.exp(NOISE * rng.standard_normal(10))
        mass = part.mass * np.exp(WEIGHED * rng.standard_normal())
        tests[name] = PartTestChoice(mass=mass, frequencies=tuple(rung))
    preload = case.study.loads[0] * (1 + 0.025 * rng.standard_normal())
    true = whole.solve(preload, modes=MODES).modes
    mass = nominal.dynamic_matrices[1]
    order = follow(
        states[0].damped.real_shapes(mass), true.shapes.reshape(MODES, -1).T, mass, states[0].damped.frequencies
    )
    return true.frequencies[order] * np.exp(NOISE * rng.standard_normal(MODES)), tests


@pytest.mark.slow  # a quarter of a minute
def test_intervals_after_the_parts_tests_hold_the_truth_of_fifty_twins(assembly):
    """E, density and thickness of each part by 3, 1 and 2 %, the law by a factor: 85 to 95 %, within 4 % of width."""
    case, states, interval, ends = assembly
    rng, inside, widths = np.random.default_rng(1), [], []
    for _ in range(50):
        truth, tests = twin(case, states, rng)
        after = narrowed(case, states, interval, tests, ends)
        inside.append((after.low[0] <= truth) & (truth <= after.high[0]))
        widths.append(after.width[0])
    assert 0.85 <= np.mean(inside) <= 0.95
    law = interval.offsets[interval.sources.index("law"), :, 0]
    of_law = np.abs(law[1] - law[0])
    assert np.all(np.median(widths, axis=0)[of_law < 0.03] < 0.04)
    assert np.sum(of_law < 0.03) >= 4


def rung(case, stiffer: float, heavier: float) -> dict[str, PartTestChoice]:
    """Tests of both plates of a case, all of whose steel is stiffer and heavier by these factors."""
    tests = {}
    for name in case.structure.mesh.parts:
        alone = PartAlone(name=name, structure=case.structure.alone(name), test=PartTestChoice())
        frequencies, errors = alone.modes(8)
        true = frequencies * (1 - errors) * np.sqrt(stiffer / heavier)
        tests[name] = PartTestChoice(mass=heavier * alone.structure.mass, frequencies=tuple(true))
    return tests


def test_a_run_and_a_prediction_have_one_interval_after_the_tests_of_parts(assembly):
    """E 6 % above and mass 2 % above the model: the tests say more than what is listed of E, which is their prior."""
    case, states, before, _ = assembly
    normal = Distribution(kind="normal", centre=2.1e11, spread=4e9)
    E = Input(key="material.45 steel.E", distribution=normal, unit="Pa")
    uncertain = replace(case.study.uncertain, inputs=(*case.study.uncertain.inputs, E))
    study = replace(case.study, part_tests=rung(case, 1.06, 1.02), uncertain=uncertain)
    stated = intervals(replace(case, study=study), states, None)[1]
    found = faying.predict(study, samples=128)
    drawn = found.quantiles((0.05, 0.5, 0.95)).frequencies
    for ours, theirs in zip((stated.low, stated.best, stated.high), drawn, strict=True):
        assert np.all(np.abs(ours - theirs) < 0.1 * (stated.high - stated.low))
    assert np.all(stated.width < 0.7 * before.width)
    assert {note.code for note in found.notes} >= {"part-test"}


@pytest.mark.slow  # two identifications
def test_an_identification_moves_the_model_by_the_tests_of_its_parts(assembly):
    """A twin of steel 6 % stiffer, whose joint is as modelled: without the parts' tests the joint takes the blame."""
    case, _, _, _ = assembly
    stiff = {name: replace(one, E=1.06 * one.E) for name, one in case.study.materials.items()}
    truth = run(replace(case.study, materials=stiff)).frequencies
    test = keys.TestChoice(
        source="twin",
        frequencies=tuple(map(tuple, truth)),
        published=None,
        published_name="",
        kind="model",
        direction=(1, 1, 1),
        points=((0.0, 0.0, 0.02), (0.12, 0.03, 0.02)),
        threshold=0.02,
    )
    plan = replace(case.study, test=test)
    inputs = tuple(one for one in plan.uncertain.inputs if one.key == "joint.stiffness")
    plan = replace(plan, uncertain=replace(plan.uncertain, inputs=inputs))
    off = []
    for tests in ({}, rung(case, 1.06, 1.0)):
        found = faying.identify(replace(plan, part_tests=tests))
        off.append(abs(np.log(np.median(found.samples[:, 0]))))
    assert off[1] < 0.5 * off[0]
