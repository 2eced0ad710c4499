"""Identification of a study: a twin whose truth is known, made with another mesh, and what is said of bad questions."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

import faying
from faying.errors import InputError
from faying.identify.identification import Identification
from faying.identify.identify import identify_model
from faying.identify.of_study import StudyModel, _Stage, left_out
from faying.identify.sampling.ensemble import Ensemble
from faying.identify.sampling.evaluate import Reduced
from faying.study import Study
from faying.study.keys import test as keys
from faying.study.keys.law import LawChoice
from tests.identify.test_predict import study_of

EXAMPLE = Path(__file__).parents[2] / "examples" / "two-blocks" / "uncertain.toml"
SCATTER = """
[uncertain]
E = "200 GPa +- 4 GPa"
stiffness = {distribution = "lognormal", median = 1, sd_ln = 0.6}
joint.form.twist = "0 um to 2 um"
"""
TRUTH = {"E": 203e9, "stiffness": 0.6}


def twin(plan, truth=TRUTH, seed=3, model=None):
    """The study, and as its test the frequencies of a finer mesh with other E and stiffness, and noise of .1 %.

    model: the law of the twin, that of the study where None.
    """
    corners = plan_points(plan)
    steel = replace(plan.materials["45 steel"], E=truth["E"])
    finer = {name: 0.75 * size for name, size in plan.geometry.face_size.items()}
    other = replace(
        plan,
        geometry=replace(plan.geometry, size=0.75 * plan.geometry.size, face_size=finer),
        materials={**plan.materials, "45 steel": steel},
        law=plan.law if model is None else LawChoice(model=model),
        uncertain=None,
        test=None,
    )
    from faying.case.case import Case, Progress
    from faying.case.solve import solve

    case = Case.of(other)
    joints = tuple(replace(j, law=replace(j.law, scale=truth["stiffness"])) for j in case.structure.joints)
    case = replace(case, structure=replace(case.structure, joints=joints))
    engine = case.engine("reanalysis")
    states = [solve(case, k, engine, Progress(0)) for k in range(len(plan.loads))]
    truth = np.stack([s.damped.frequencies for s in states])
    noise = np.random.default_rng(seed).normal(0, 1e-3, truth.shape)
    measured = truth * np.exp(noise)
    rows = tuple(tuple(row) for row in measured.tolist())
    test = keys.TestChoice(
        frequencies=rows,
        points=corners,
        direction=(1.0, 0.7, 0.4),
        threshold=1e-3,
        source="twin",
        published=None,
        published_name="",
        kind="model",
    )
    return replace(plan, test=test), measured


def plan_points(plan):
    from faying.case.case import checked_mesh

    points = checked_mesh(plan).points
    directions = np.array([[1, 1, 1], [-1, 1, -1], [1, -1, -1]])
    return tuple(tuple(map(float, points[int(np.argmax(points @ d))])) for d in directions)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    study, measured = twin(study_of(tmp_path_factory.mktemp("twin"), SCATTER))
    return study, measured, faying.identify(study, leave_out=study.loads[-1], seed=2)


@pytest.mark.slow
def test_the_truth_of_a_twin_lies_in_the_intervals(found):
    _, _, result = found
    low, _, high = dict(zip(result.names, result.quantiles((0.01, 0.5, 0.99)).T, strict=True))["joint.stiffness"]
    assert low < TRUTH["stiffness"] < high
    low, _, high = dict(zip(result.names, result.quantiles((0.01, 0.5, 0.99)).T, strict=True))["material.45 steel.E"]
    assert low < TRUTH["E"] < high


@pytest.mark.slow
def test_ten_twins_of_another_mesh_law_and_form(tmp_path):
    """Eight of ten truths or more lie in the intervals of 90 %: E, and the frequencies of the load that was left out.

    The twins have finer meshes, another law than the study, a twist that the study knows, and moduli and factors on the
    stiffness that fill their priors. What the study calls the factor on the stiffness has to take the law's place. A
    preload known to 2 % is told no better by the test, which the identifications say. The bases are made once.
    """
    more = SCATTER.replace('joint.form.twist = "0 um to 2 um"\n', 'preload = {scatter = "2 %"}\n')
    plan = study_of(tmp_path, more)
    path = tmp_path / "study.toml"
    text = path.read_text().replace("flat = true", 'twist = "1 um"')
    # at 16 and 8 mm the error of the mesh in mode 3 is more than the test scatters, and 5 of 10 truths are inside
    path.write_text(text.replace('size = "16 mm"', 'size = "12 mm"').replace('joint" = "8 mm"', 'joint" = "6 mm"'))
    plan = replace(Study.read(path), modes=plan.modes)
    inside, covered, told, unseen = [], [], [], []
    loads, stage, reduced = np.array(plan.loads), _Stage(None), None
    shares = np.random.default_rng(5).permuted(np.tile((np.arange(10) + 0.5) / 10, (2, 1)), axis=1)
    for number, (one, other) in enumerate(shares.T):
        truth = {"E": 200e9 + 4e9 * norm.ppf(one), "stiffness": float(np.exp(0.6 * norm.ppf(other)))}
        study, measured = twin(plan, truth, number, "ME")
        ensemble = Ensemble.of(study, 8, 0)
        reduced = reduced or Reduced(ensemble, report=stage)  # the twins differ in their test alone
        model = StudyModel(ensemble, reduced, stage)
        found = identify_model(model, measured, loads, leave_out=[len(loads) - 1], seed=number, count=400)
        low, _, high = dict(zip(found.names, found.quantiles().T, strict=True))["material.45 steel.E"]
        inside.append(low < truth["E"] < high)
        covered.append((measured[-1] > found.predicted[0, -1]) & (measured[-1] < found.predicted[2, -1]))
        told.append(dict(zip(found.names, found.posterior_contraction, strict=True)))
        unseen.append(any("bolt" in note.text for note in found.notes if note.code == "not-told"))
    assert sum(inside) >= 8
    assert sum(unseen) >= 8
    assert np.all(np.sum(covered, axis=0) >= 8)
    assert np.median([one["material.45 steel.E"] for one in told]) < 0.8


@pytest.mark.slow
def test_what_the_test_sees_is_told_from_what_it_does_not(found):
    _, _, result = found
    told = dict(zip(result.names, result.posterior_contraction, strict=True))
    assert told["joint.stiffness"] < 0.6


@pytest.mark.slow
def test_the_load_that_was_left_out_is_predicted(found):
    _, measured, result = found
    low, _, high = result.predicted
    inside = (measured[-1] > low[-1]) & (measured[-1] < high[-1])
    assert inside.sum() >= len(inside) - 1
    assert result.left_out.tolist() == [False] * (len(measured) - 1) + [True]


@pytest.mark.slow
def test_it_is_written_and_read(found, tmp_path):
    _, _, result = found
    assert Identification.load(result.save(tmp_path / "i.nc")) == result
    assert "joint.stiffness" in result.table()


@pytest.fixture(scope="module")
def blocks(tmp_path_factory):
    """The example of two blocks, whose "test" was made with a joint .7 times as stiff."""
    out = tmp_path_factory.mktemp("blocks") / "identification.nc"
    study = Study.read(EXAMPLE)
    return out, faying.identify(study, leave_out="3 kN", seed=1, count=300, out=out)


@pytest.mark.slow
def test_the_example_gives_back_the_stiffness_that_it_was_made_with(blocks):
    out, result = blocks
    told = dict(zip(result.names, result.posterior_contraction, strict=True))
    low, _, high = dict(zip(result.names, result.quantiles((0.02, 0.5, 0.98)).T, strict=True))["joint.stiffness"]
    assert low < 0.7 < high
    assert told["joint.stiffness"] < 0.4
    assert told["bolt.bolt 1.factor"] > 0.85
    assert "bolt.bolt 1.factor" in next(note.text for note in result.notes if note.code == "not-told")
    assert result.left_out.tolist() == [False, True]
    inside = (result.test[1] > result.predicted[0, 1]) & (result.test[1] < result.predicted[2, 1])
    assert inside.sum() >= 4
    assert Identification.load(out) == result
    assert not out.with_name("identification.nc.part").exists()


@pytest.mark.slow
def test_laws_are_weighed_by_their_evidence(tmp_path):
    """The law that made the test is the likelier one where the factor on its stiffness is known well."""
    study = Study.read(EXAMPLE)
    text = EXAMPLE.read_text().replace("median = 1, sd_ln = 0.6", "median = 0.7, sd_ln = 0.05")
    path = tmp_path / "study.toml"
    path.write_text(text.replace("[uncertain]", '[uncertain]\nlaw.model = ["jk", "me"]'))
    (tmp_path / "model.inp").write_bytes(study.geometry.file.read_bytes())
    result = faying.identify(path, seed=1, count=300)
    weights = {law.name: law.weight for law in result.laws}
    assert weights["JK"] > 0.9
    assert sum(weights.values()) == pytest.approx(1)


@pytest.mark.slow
def test_damping_of_a_test_tells_what_makes_the_loss(tmp_path):
    """The index alpha of JK's elastic-plastic contact sets its loss and hardly its stiffness: only damping tells it."""
    truth, noise = 0.35, np.random.default_rng(2)
    more = '[law]\nmodel = "jk"\n\n[uncertain]\nlaw.alpha = "0.05 to 0.6"'
    text = EXAMPLE.read_text().replace("[uncertain]", more)
    (tmp_path / "model.inp").write_bytes((EXAMPLE.parent / "model.inp").read_bytes())
    path = tmp_path / "study.toml"
    path.write_text(text)
    study = Study.read(path)
    made = replace(study, uncertain=None, law=replace(study.law, given={**study.law.given, "alpha": truth}))
    result = faying.run(made)
    f = result.frequencies * np.exp(noise.normal(0, 2e-3, result.frequencies.shape))
    loss = result.loss_factors * np.exp(noise.normal(0, 0.05, f.shape))
    test = replace(study.test, frequencies=tuple(map(tuple, f.tolist())))
    told = []
    for losses in (None, tuple(map(tuple, loss.tolist()))):
        one = replace(study, test=replace(test, losses=losses))
        found = faying.identify(one, seed=1, count=300)
        told.append(dict(zip(found.names, found.posterior_contraction, strict=True))["law.alpha"])
    low, high = dict(zip(found.names, found.quantiles((0.02, 0.98)).T, strict=True))["law.alpha"]
    assert told[0] > 0.8
    assert told[1] < 0.6
    assert low < truth < high


@pytest.mark.parametrize(("given", "expected"), [(None, ()), ("2 kN", (0,)), (["2 kN"], (0,)), (6000.0, (1,))])
def test_preloads_are_left_out_by_their_value(tmp_path, given, expected):
    plan = study_of(tmp_path)
    loads = plan.loads
    assert loads == (2e3, 6e3)
    assert left_out(plan, given) == expected


def test_questions_without_an_answer_are_refused(tmp_path):
    plan = study_of(tmp_path)
    with pytest.raises(InputError, match="leave_out = 7 kN: the study has no such preload; it has 2 kN, 6 kN"):
        left_out(plan, "7 kN")
    with pytest.raises(InputError, match="names every preload"):
        left_out(plan, ["2 kN", "6 kN"])
    with pytest.raises(InputError, match="an identification needs a test"):
        faying.identify(replace(plan, test=None))
