"""One structure taken apart and bolted together again: limits, other routes to the same numbers, words."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.case.case import Case
from faying.case.clearance import clearances
from faying.cli.measured.predict import command
from faying.errors import InputError
from faying.identify.assemblies import Assemblies
from faying.identify.reassembly import Assembler
from faying.study import Study
from faying.study.keys.geometry import mesh_of
from tests.helpers.meshfiles import LOW_AND_HIGH, abaqus
from tests.helpers.plates import LAW, stacked

FLAT, WAVES = "flat = true", "waviness = {Wq = '2 um', shortest = '20 mm', longest = '80 mm'}"
SHANK = 'diameter = "8 mm"\nmaterial = "45 steel"\n'
SMALL = "preload = {scatter = '4 %'}"  # two standard deviations


def study_of(folder, *, places=(20, 60), shank="", form=FLAT, scatter=SMALL, preload='"4 kN"', more=""):
    """Two plates of 80 x 40 x 10 mm on each other, with bolts along their middle."""
    (folder / "model.inp").write_text(abaqus(stacked()))
    bolts = "".join(
        f'[[bolt]]\nname = "{k}"\nfaces = ["high.top", "low.bottom"]\nat = ["{x} mm", "20 mm", "10 mm"]\n'
        f'seat = ["0 mm", "16 mm"]\n{shank}preload = {preload}\n'
        for k, x in enumerate(places, 1)
    )
    path = folder / "study.toml"
    path.write_text(
        f'title = "plates"\n{LOW_AND_HIGH}[[joint]]\nname = "j"\nfaces = ["low.top", "high.bottom"]\n[joint.form]\n'
        f"{form}\n{bolts}[modes]\ncount = 4\nlevels = []\nintervals = false\n[uncertain]\n{scatter}\n{more}"
    )
    return Study.read(path)


@pytest.fixture(scope="module")
def all_drawn(tmp_path_factory):
    folder = tmp_path_factory.mktemp("all")
    study = study_of(folder, shank=SHANK, form=WAVES, scatter="preload = {scatter = '30 %'}")
    return study, faying.predict(study, assemblies=6, seed=3)


def test_a_bolt_that_does_not_scatter_on_flat_faces_has_no_scatter(tmp_path):
    found = faying.predict(
        study_of(tmp_path, places=(40,), shank=SHANK, scatter="preload = {scatter = '0.0001 %'}"), assemblies=4
    )
    assert found.sources == ("force",)
    assert found.deviation.max() < 1e-6
    assert {note.code for note in found.notes} == {"few-samples", "assembly-left-out"}


def test_two_bolts_scatter_a_frequency_by_its_slope_over_the_root_of_two(tmp_path):
    """On a symmetric joint each bolt has half of dlnf/dlnF, and the two scatter apart."""
    found = faying.predict(study_of(tmp_path), assemblies=64, seed=1)
    ends = faying.run(study_of(tmp_path, preload='["3.9 kN", "4.1 kN"]')).frequencies
    slope = np.log(ends[1] / ends[0]) / np.log(4.1 / 3.9)
    mean = found.forces.mean(axis=2)[:, 0] / 4e3
    assert mean.std(ddof=1) == pytest.approx(0.02 / np.sqrt(2), rel=0.1)
    assert found.deviation[0] == pytest.approx(np.abs(slope) * 0.02 / np.sqrt(2), rel=0.1)


@pytest.mark.slow
def test_an_assembly_in_its_order_is_that_of_the_structure(all_drawn):
    study, found = all_drawn
    assert found.sources == ("force", "order", "position")
    assert [sorted(order) for order in found.orders.tolist()] == [[1, 2]] * 6
    structure = Case.of(study).structure
    joint, choice = structure.joints[0], study.joints[0].form
    work = Assembler.of(Case.of(study), 6, 3)
    moved = structure.with_joints(gaps=[work.faces[0].gap(found.shifts[2, 0])])
    assert np.abs(moved.joints[0].interface.gap - joint.interface.gap).max() > 0.01 * choice.waviness.Wq
    forces = dict(zip(found.bolts, found.forces[2, 0].tolist(), strict=True))
    order = [found.bolts[k - 1] for k in found.orders[2]]
    state = moved.solve(forces, modes=4, order=order, engine="direct")
    assert found.frequencies[2, 0] == pytest.approx(state.frequencies, rel=1e-6)
    assert found.left[2, 0] == pytest.approx(state.preload.bolt_forces, rel=1e-6)
    assert found.modelled[0] == pytest.approx(structure.solve("4 kN", modes=4, engine="direct").frequencies, rel=1e-6)


@pytest.mark.slow
def test_draws_are_the_same_in_any_number_of_processes(all_drawn):
    study, found = all_drawn
    again = faying.predict(study, assemblies=6, seed=3, jobs=2)
    assert replace(again, provenance=None) == replace(found, provenance=None)  # which has the time of the work
    assert not np.array_equal(faying.predict(study, assemblies=2, seed=4).forces, found.forces[:2])


@pytest.mark.slow
def test_interrupted_work_goes_on(all_drawn, tmp_path, monkeypatch):
    study, found = all_drawn

    def stop(stage, done, total):
        if stage == "assemblies" and done:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        faying.predict(study, assemblies=6, seed=3, out=tmp_path / "a.nc", report=stop)
    asked, once = [], Assembler._one
    monkeypatch.setattr(Assembler, "_one", lambda self, *args: asked.append(args[1]) or once(self, *args))
    again = faying.predict(study, assemblies=6, seed=3, out=tmp_path / "a.nc")
    assert asked == list(range(8, 24))
    assert replace(again, provenance=None) == replace(found, provenance=None)
    assert not (tmp_path / "a.nc.part").exists()


def test_places_fill_a_disk_as_wide_as_the_holes_leave(all_drawn):
    """Holes that are not drawn are medium ones of ISO 273: 8.8 mm for 8 mm, and each part has its own play."""
    study, _ = all_drawn
    case = Case.of(study)
    (play,) = clearances(case.structure)
    assert play.joints == ((0, 1),)
    assert play.reach == pytest.approx(0.8e-3)
    shifts = Assembler.of(case, 256, 0).drawn.shifts[:, 0]
    radius = np.linalg.norm(shifts, axis=1)
    assert radius.max() < 0.8e-3
    assert np.mean(radius**2) == pytest.approx(0.8e-3**2 / 2, rel=0.02)
    assert np.abs(shifts.mean(axis=0)).max() < 0.02e-3
    assert np.abs(shifts[:, 2]).max() < 1e-12


def test_holes_that_are_drawn_say_the_play_themselves():
    """M8 in holes of 9 mm: each plate moves by 0.5 mm against the bolt. One bolt without play is enough for none."""
    study = Study.read(Path(__file__).parents[2] / "examples" / "plates-and-bolts" / "plates.toml")
    mesh = mesh_of(replace(study.geometry, size=40e-3, face_size={}))
    joint = faying.Joint(("upper.joint", "lower.joint"), LAW)

    def reach(*diameters):
        bolts = [
            faying.Bolt(bolt.name, bolt.faces, diameter=d, material="45 steel")
            for bolt, d in zip(study.bolts, diameters, strict=True)
        ]
        return [one.reach for one in clearances(faying.Structure(mesh, "45 steel", [joint], bolts))]

    assert reach("8 mm", "8 mm") == pytest.approx([1e-3], rel=1e-3)
    assert reach("8 mm", "8.6 mm") == pytest.approx([0.4e-3], rel=1e-2)
    assert reach("8 mm", "9.1 mm") == []


def test_bolts_of_the_studys_passes_change_their_places_alone(tmp_path):
    study = study_of(tmp_path, shank=SHANK, more='[tightening]\norder = ["2", "1"]\npasses = 2\n')
    orders = Assembler.of(Case.of(study), 16, 0).drawn.orders
    assert {tuple(order) for order in orders.tolist()} == {(0, 1, 0, 1), (1, 0, 1, 0)}


def test_assemblies_are_written_shown_and_read(all_drawn, tmp_path):
    study, found = all_drawn
    assert faying.load(found.save(tmp_path / "assemblies.nc")) == found
    assert len(repr(found).splitlines()) <= 12
    low, high = found.quantiles()
    assert np.all((low < high) & (low > 0))
    assert found.deviation_alone.shape == (3, 1, 4)
    assert np.isnan(found.part_of_interval).all()
    given = ["--assemblies", "2", "--jobs", "1", "--out", str(tmp_path / "two.nc")]
    done = CliRunner().invoke(command, [str(study.folder / "study.toml"), *given], catch_exceptions=False)
    assert max(map(len, done.stdout.splitlines()[:-1])) <= 80
    assert "position alone [%]" in done.stdout
    told = json.loads(CliRunner().invoke(command, [str(study.folder / "study.toml"), *given, "--json"]).stdout)
    assert told["modelled"]["values"] == found.modelled.tolist()
    assert np.shape(told["deviation_alone"]["values"]) == (3, 1, 4)
    assert Assemblies.load(tmp_path / "two.nc").frequencies.shape == (2, 1, 4)


def test_words(all_drawn, tmp_path):
    study, _ = all_drawn
    with pytest.raises(InputError, match="whole number from 2"):
        faying.predict(study, assemblies=1)
    with pytest.raises(InputError, match="joints that bolts press"):
        faying.predict(replace(study, joints=(), bolts=()), assemblies=4)
    with pytest.raises(InputError, match="--samples: --assemblies gives tables and a file; leave it out"):
        CliRunner().invoke(
            command, [str(study.folder / "study.toml"), "--assemblies", "4", "--samples", "64"], catch_exceptions=False
        )
