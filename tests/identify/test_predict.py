"""Predictions of a small study: against full runs, against what the inputs are, and what is said where they fail."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray

import faying
from faying.answer.run import run
from faying.case.case import Case, Progress
from faying.case.mesh_error import mesh_error
from faying.case.solve import solve
from faying.distribution import Distribution
from faying.errors import FayingError, InputError
from faying.identify import predict as module
from faying.identify.prediction import Prediction
from faying.identify.sampling.ensemble import Ensemble, Inputs
from faying.identify.sampling.evaluate import Evaluator, Reduced
from faying.identify.sampling.store import SampleStore
from faying.joint.modal import ModesChoice
from faying.numerics.damped import damped_modes
from faying.numerics.modes import lowest_modes
from faying.reduction.reduce import Reduction
from faying.study import Study
from tests.helpers.studies import write

EXAMPLES = Path(__file__).parents[2] / "examples"

SCATTER = """
[uncertain]
only = true
E = "200 GPa +- 4 GPa"
preload = {tightening = "torque wrench, friction estimated"}
stiffness = {distribution = "lognormal", median = 1, sd_ln = 0.6}
density = "7800 kg/m^3 +- 40 kg/m^3"
"""


def study_of(folder, more=SCATTER, **keys):
    path = folder / "study.toml"
    write(path)
    path.write_text(path.read_text() + more)
    return replace(Study.read(path), modes=ModesChoice(count=5), **keys)


@pytest.fixture(scope="module")
def plan(tmp_path_factory):
    return study_of(tmp_path_factory.mktemp("study"))


@pytest.fixture(scope="module")
def found(plan):
    return faying.predict(plan, samples=128, seed=1)


@pytest.mark.slow
def test_scales_of_the_parts_scale_every_frequency_of_bonded_like_parts(tmp_path):
    """With a joint a thousand times as stiff nothing but the parts is left: f goes with the root of E over density."""
    more = SCATTER.replace("median = 1, sd_ln = 0.6", "median = 1000, sd_ln = 0.01")
    study = study_of(tmp_path, more)
    finer = {name: 0.8 * size for name, size in study.geometry.face_size.items()}
    geometry = replace(study.geometry, size=0.8 * study.geometry.size, face_size=finer)
    found = faying.predict(replace(study, geometry=geometry), samples=16, seed=3)
    E = found.values[:, found.names.index("material.45 steel.E")]
    density = found.values[:, found.names.index("material.45 steel.density")]
    expected = np.sqrt((E / 200e9) / (density / 7800))
    ratio = found.frequencies[:, -1] / found.frequencies[0, -1]
    assert ratio == pytest.approx(np.broadcast_to((expected / expected[0])[:, None], ratio.shape), rel=2e-3)


@pytest.fixture(scope="module")
def nominal(plan):
    """The case of the medians, solved in full: its frequencies and the error of its mesh."""
    case = Case.of(replace(plan, uncertain=None))
    engine = case.engine("direct")
    states = [solve(case, k, engine, Progress(0)) for k in range(len(plan.loads))]
    return np.stack([one.damped.frequencies for one in states]), mesh_error(case, states)


def test_the_medians_are_near_the_run_and_the_intervals_hold_it(found, nominal):
    # the samples alone: what is not listed is symmetric, and moves the median of a skewed distribution
    low, middle, high = replace(found, discrepancy=0 * found.discrepancy).quantiles().frequencies
    frequencies, mesh = nominal
    nominal = frequencies * np.exp(-mesh.parts)
    assert middle == pytest.approx(nominal, rel=5e-3)
    assert np.all(low < nominal)
    assert np.all(nominal < high)


@pytest.mark.slow
def test_a_run_and_a_prediction_have_one_interval():
    """Of what the study lists, and nothing else: k_t/k_n made a shear mode 1.7 times as uncertain in the run alone."""
    study = Study.read(EXAMPLES / "two-blocks" / "uncertain.toml")
    drawn = faying.predict(study, samples=512).quantiles((0.05, 0.5, 0.95)).frequencies
    stated = run(replace(study, modes=replace(study.modes, levels=()), backbone=None)).interval
    for ours, theirs in zip((stated.low, stated.best, stated.high), drawn, strict=True):
        assert np.all(np.abs(ours - theirs) < 0.1 * (stated.high - stated.low))


OF_PARTS = """title = "parts that are not as the study has them"
[geometry]
mesh = "MESH"
unit = "mm"
[part.block_a]
material = "45 steel"
TEST
[part.block_b]
material = "45 steel"
[surface]
D = 2.39
G = "1.53e-10 m"
scan_area = "16 mm^2"
[[joint]]
name = "joint"
faces = ["FACE_A", "FACE_B"]
tangential = 0.6
[joint.form]
flat = true
[[bolt]]
name = "b"
faces = ["END_B", "END_A"]
preload = "3 kN"
[modes]
count = 5
levels = []
[uncertain]
only = true
structure = "0.1 %"
discrepancy = "0.1 %"
"""


def of_parts(folder, lines, test=""):
    """The two blocks of which little scatters but what these lines list; test: of the first one."""
    mesh = (EXAMPLES / "two-blocks" / "model.inp").as_posix()
    file = folder / "study.toml"
    file.write_text(OF_PARTS.replace("MESH", mesh).replace("TEST", test) + lines)
    return Study.read(file)


@pytest.mark.parametrize(
    ("lines", "test"),
    [
        ('E = "220 GPa +- 2 GPa"', ""),
        ('density = "7000 kg/m^3 +- 50 kg/m^3"', ""),
        ('part.block_a.stiffness = "1.1 +- 0.02"', ""),
        ('part.block_b.stiffness = "1.1 +- 0.02"', ""),
        ('part.block_a.mass = "0.9 +- 0.02"\nE = "205 GPa +- 2 GPa"', ""),
        ('bolt.preload = "1 kN +- 0.05 kN"', ""),
        ('joint.tangential = "0.6 +- 0.01"\nE = "220 GPa +- 2 GPa"', 'mass = "0.2808 kg"'),
        ('joint.tangential = "0.6 +- 0.01"\npart.block_a.stiffness = "1.05 +- 0.01"', 'mass = "0.29 kg"'),
    ],
)
def test_what_is_listed_off_the_study_has_one_interval(lines, test, tmp_path):
    """Its median is that of what is listed; 256 samples leave a twentieth of the width in an end."""
    study = of_parts(tmp_path, lines, test)
    drawn = faying.predict(study, samples=256).quantiles((0.05, 0.5, 0.95)).frequencies
    stated = run(study).interval
    for ours, theirs in zip((stated.low, stated.best, stated.high), drawn, strict=True):
        assert np.all(np.abs(ours - theirs) < 0.1 * (stated.high - stated.low))


def test_the_test_of_a_part_is_not_counted_twice(tmp_path):
    """A weight that agrees with the model says nothing of the stiffness that is listed, and the listed mass little."""
    plain = run(of_parts(tmp_path, 'E = "220 GPa +- 2 GPa"')).interval
    weighed = run(of_parts(tmp_path, 'E = "220 GPa +- 2 GPa"', 'mass = "0.2808 kg"')).interval
    np.testing.assert_allclose(weighed.best, plain.best, rtol=2e-4)
    once = run(of_parts(tmp_path, "", 'mass = "0.29 kg"')).interval
    again = run(of_parts(tmp_path, 'part.block_a.mass = "1.02 +- 0.02"', 'mass = "0.29 kg"')).interval
    np.testing.assert_allclose(again.best, once.best, rtol=2e-4)


@pytest.mark.parametrize(
    ("lines", "twice"),
    [
        ('bolt.factor = "1 +- 0.1"\npreload = {scatter = "5 %"}', "bolt.factor scatters already by bolt.b.factor"),
        ('bolt.preload = "3 kN +- 0.1 kN"\nbolt.factor = "1 +- 0.1"', "bolt.preload scatters already by bolt.factor"),
        ('bolt.b.preload = "3 kN +- 0.1 kN"\nbolt.factor = "1 +- 0.1"', "bolt.b.preload scatters already by bolt.fac"),
        ('bolt.preload = "3 kN +- 0.1 kN"\npreload = {scatter = "5 %"}', "bolt.preload scatters already by bolt.b.fac"),
        ('friction = "0.1 to 0.2"\njoint.joint.friction = "0.1 to 0.3"', "joint.friction scatters already by joint.jo"),
    ],
)
def test_what_scatters_by_two_lines_is_refused(lines, twice, tmp_path):
    with pytest.raises(InputError, match=twice):
        of_parts(tmp_path, lines)


def test_shares_of_stiff_modes_are_those_of_the_parts(found):
    """A mode of the parts alone goes with the root of E and of 1/density: 2 % and .5 %, so 16 to 1 in variance."""
    shares, error = found.shares()
    assert np.all(error < 0.3)
    total = dict(zip(found.blamed, shares.total.T, strict=True))
    low, high = np.log(found.quantiles((0.05, 0.95)).frequencies[:, -1])
    # the discrepancy is normal: its share is the square of its width over that of the interval, where that is normal
    expected = (2 * 1.6449 * found.discrepancy[-1] / (high - low)) ** 2
    assert total["discrepancy"] == pytest.approx(expected, rel=0.15)
    quiet = int(np.argmin(total["joint.stiffness"]))
    assert total["material.45 steel.E"][quiet] == pytest.approx(16 * total["material.45 steel.density"][quiet], rel=0.4)


def test_quantiles_are_those_of_the_samples(found):
    bare = replace(found, discrepancy=0 * found.discrepancy)
    q = bare.quantiles((0.25, 0.75))
    assert q.frequencies.shape == (2, len(found.loads), 5)
    below = (found.frequencies < q.frequencies[1]).mean(axis=0)
    assert below == pytest.approx(0.75, abs=0.01)


def test_the_discrepancy_is_in_every_interval(found, nominal):
    """2.5 % of each mode, normal in ln f, and of the 3 % of the structure what E, which scatters, has not.

    And what is not known of the error of the mesh: a run, which solves its modes anew with half of the points of the
    joint, has the same.
    """
    known, (_, mesh) = 0.025**2 + 0.03**2 - 0.015**2, nominal
    assert np.sqrt(found.discrepancy**2 - known) == pytest.approx((mesh.parts + mesh.contact) / 1.6449, rel=0.05)
    alone = replace(found, frequencies=np.full(found.frequencies.shape, 100.0), paired=None, test=None)
    low, middle, high = alone.quantiles().frequencies
    assert middle == pytest.approx(100.0, rel=1e-6)
    # 25 equal shares of the probability stand for the normal one
    assert np.log(high / low) == pytest.approx(2 * 1.6449 * found.discrepancy, rel=0.06)


def test_levels_of_quantiles_are_shares(found):
    with pytest.raises(InputError, match="shares from 0 to 1"):
        found.quantiles((5, 95))


def test_a_prediction_is_written_and_read(found, tmp_path):
    path = found.save(tmp_path / "prediction.nc")
    assert Prediction.load(path) == found
    with xarray.open_datatree(path) as data:
        assert data["samples"].frequency.dims == ("sample", "load", "mode")
        assert list(data.input.values) == list(found.names)
    assert found.to_xarray()["samples"].frequency.shape == found.frequencies.shape
    assert len(repr(found).splitlines()) <= 12
    assert faying.load(path) == found
    ax = found.plot()
    ax.figure.savefig(tmp_path / "prediction.png")
    assert len(ax.get_yticks()) == found.observed[0].shape[2]


def test_a_prediction_is_one_page(found):
    """The page has every table, the notes and figures, and asks for nothing beyond itself."""
    from faying.output.report_predicted import predicted

    page = predicted(found)
    for words in ("What scatters", "Frequencies, 5% .. median .. 95%", "What makes the scatter", found.notes[0].text):
        assert words in page
    assert page.count("<figure>") == 2
    assert not re.search(r'(src|href)="https?:', page)
    middle = found.quantiles().frequencies[1, 0, 0]
    assert f"{middle:.1f}" in page


@pytest.mark.slow
def test_a_run_says_which_scatter_is_in_its_intervals(tmp_path):
    path = tmp_path / "study.toml"
    write(path)
    path.write_text(path.read_text().replace("[[joint]]", '[[joint]]\nfriction = "0.1 to 0.6"', 1))
    study = Study.read(path)
    notes = run(replace(study, modes=ModesChoice(count=2))).notes
    (note,) = [note for note in notes if note.code == "uncertain"]
    assert f"of joint.{study.joints[0].name}.friction the median is taken" in note.text
    assert f"what [uncertain] says, but for joint.{study.joints[0].name}.friction" in note.text


def test_the_same_seed_gives_the_same_samples(plan, found):
    assert np.array_equal(Ensemble.of(plan, 128, 1).values[-128:], found.values)
    assert not np.array_equal(Ensemble.of(plan, 128, 2).values[-128:], found.values)


@pytest.mark.slow
def test_an_interrupted_prediction_goes_on(plan, tmp_path, monkeypatch):
    out = tmp_path / "p.nc"
    calls = []

    def stops(self, what, number, rows):
        calls.append(number)
        if len(calls) == 2:
            raise KeyboardInterrupt
        kept(self, what, number, rows)

    kept = SampleStore.keep_rows
    monkeypatch.setattr(SampleStore, "keep_rows", stops)
    with pytest.raises(KeyboardInterrupt):
        faying.predict(plan, samples=64, seed=1, out=out)
    monkeypatch.setattr(SampleStore, "keep_rows", kept)
    monkeypatch.setattr(Reduction, "of", None)  # the bases are not made again
    found = faying.predict(plan, samples=64, seed=1, out=out)
    assert found.answered == 64
    assert Prediction.load(out) == found
    assert not out.with_name("p.nc.part").exists()


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ('[uncertain]\nfrictoin = "0.1 to 0.6"', "frictoin cannot scatter"),
        ('[uncertain]\nE = "200 to 210"', "has no unit"),
        ('[uncertain]\nfriction = "-3 to 0.1"', "is for 97% outside"),
        ('[uncertain]\npreload = "10 %"', "should be {tightening"),
        ('[uncertain]\npreload = {tightening = "spanner"}', "is not a way of tightening; the known ones are"),
        ('[uncertain]\njoint.none.friction = "0.1 to 0.2"', "no joint is called 'none'"),
        ("[uncertain]\nsurface.fit = 3", "should be true or false"),
        ('[uncertain]\nlaw.model = ["jk"]', "two laws or more"),
        ("[uncertain]\nlaw.model = {jk = 1, gw = -1}", "a weight is a positive number"),
        ('[uncertain]\nbolt.preload = "1 kN to 2 kN"', "the study has"),
        ('[uncertain]\nflatness = "10 um"\njoint.form.twist = "1 um to 2 um"\njoint.form.flatness = "3 um"', "already"),
    ],
)
def test_faults_of_the_table_are_named(tmp_path, more, words):
    with pytest.raises(FayingError, match="(?s)" + words.replace("{", r"\{")):
        faying.predict(study_of(tmp_path, "\n" + more), samples=16)


def test_counts_that_make_no_prediction_are_refused(plan):
    for samples in (4, 2.5, True):
        with pytest.raises(InputError, match="give a whole number|whole number from 8"):
            faying.predict(plan, samples=samples)
    with pytest.raises(InputError, match="seed"):
        faying.predict(plan, seed=-1)


def test_texts_that_scatter_may_stand_in_the_place_of_the_number(tmp_path):
    path = tmp_path / "study.toml"
    write(path)
    text = path.read_text()
    assert "[[joint]]" in text
    path.write_text(text.replace("[[joint]]", '[[joint]]\nfriction = "0.1 to 0.6"', 1))
    study = Study.read(path)
    assert study.joints[0].friction == pytest.approx(0.35)
    (column,) = study.uncertain.inputs
    assert column.key == f"joint.{study.joints[0].name}.friction"
    assert column.within
    assert column.distribution == Distribution.read("0.1 to 0.6", "")


def test_a_law_at_a_pressure_hardly_knows_the_modulus():
    """So that E may act on the parts alone: its scatter moves k_n by less than half as much."""
    steel = faying.CATALOGUE["45 steel"]
    p = np.array([1e6, 1e7])
    k = [
        faying.JK(D=2.39, G=1.53e-10, pair=faying.ContactPair(one, one), scan_area=16e-6).at_pressure(p).k_n
        for one in (steel, replace(steel, E=1.02 * steel.E))
    ]
    assert np.all(np.abs(k[1] / k[0] - 1) < 0.01)


def test_what_was_cut_is_said(tmp_path):
    study = study_of(tmp_path, '\n[uncertain]\nfriction = "0.2 +- 0.15"')
    (column,) = study.uncertain.inputs
    from scipy.stats import norm

    assert column.cut == pytest.approx(norm.cdf(-0.2 / 0.15), rel=1e-6)
    (note,) = module.cut_notes(Inputs(columns=(column,)).columns)
    assert "left out" in note.text


def test_the_second_degree_of_a_random_form_has_the_flatness_of_its_tolerance():
    """The shapes of [uncertain] flatness: over one face, their mean flatness is two thirds of the tolerance."""
    from faying.form.fit import minimum_zone
    from faying.study.keys.uncertain import SHAPE_SD

    generator = np.random.default_rng(5)
    axis = np.linspace(-1, 1, 13)
    grid = np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)
    x, y = grid.T
    sd = np.array([SHAPE_SD[name] for name in ("crown_along", "crown_across", "twist")]) / 2**0.5
    zones = []
    for a, b, t in sd * generator.standard_normal((400, 3)):
        zones.append(minimum_zone(grid, a * x**2 + b * y**2 + t * x * y).flatness)
    assert np.mean(zones) == pytest.approx(2 / 3, rel=0.08)


def test_samples_that_the_bases_fit_less_well_are_counted():
    assert not module.of_bases(np.array([[9e-4, np.nan], [1e-4, np.nan]]))
    (note,) = module.of_bases(np.array([[5e-3, np.nan], [1e-4, 2e-4]]))
    assert note.code == "bases"
    assert "5.0e-03 at the worst by their own estimate (1 looked at)" in note.text
    assert "2.0e-04 at some others from all over (2 looked at)" in note.text


@pytest.mark.slow
def test_samples_miss_full_solutions_by_less_than_is_said(plan):
    """Solved with the parts' E and density in their materials: the bases have seen scales of two matrices alone."""
    ensemble = Ensemble.of(plan, 4, 5)
    reduced = Reduced(ensemble)
    work = Evaluator(model=reduced.model, builder=reduced.trainer.builder).with_median(0)
    errors = []
    for sample in range(4):
        model, found, _ = work.solved(sample)
        for load, variant in enumerate(found):
            index = (ensemble.training + sample) * ensemble.loads + load
            laws, forces, _ = work.builder.laws(index)
            scales = dict(zip(work.builder.parts, model.scales, strict=True))
            structure = reduced.trainer.structure
            materials = {
                part: replace(solid, E=solid.E * scales[part][0], density=solid.density * scales[part][1])
                for part, solid in structure.materials.items()
            }
            joints = tuple(replace(joint, law=law) for joint, law in zip(structure.joints, laws, strict=True))
            structure = replace(structure, materials=materials, joints=joints)
            pressures = structure.assembly().solve(structure.loads @ forces).pressures
            K, loss = structure.coupled(structure.springs(pressures))
            M, rigid = structure.dynamic_matrices[1], structure.rigid_count
            modes = lowest_modes(K, M, rigid + 15, shift_frequency=structure.shift_frequency)
            full = damped_modes(modes, K, M, loss, rigid=rigid, count=model.count, tolerance=1e-9)
            error = np.abs(variant.frequencies / full.frequencies - 1).max()
            said = reduced.trainer.error(index, reduced.trainer.reduction)
            assert error < 1.5 * said
            assert said < 20 * error
            errors.append(error)
    assert max(errors) > 1e-3  # at a state that the bases were not trained for


def test_every_law_is_drawn_at_its_own_share_and_trained_at_its_median(tmp_path):
    more = SCATTER + 'law.model = {jk = 1, me = 3, "gw-ke" = 2}\n'
    ensemble = Ensemble.of(study_of(tmp_path, more), 8, 0)
    inputs = ensemble.inputs
    names = [name for name, _ in inputs.models]
    assert [inputs.model(inputs.share(law)) for law in range(3)] == names
    medians = [prior.median for prior in inputs.priors[:-1]]
    for law in range(3):
        assert ensemble.values[law, :-1] == pytest.approx(medians)
        assert inputs.model(ensemble.values[law, -1]) == names[law]
