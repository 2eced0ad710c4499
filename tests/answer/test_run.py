"""The pipeline on the study that `faying init` writes."""

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import faying
from faying.answer.run import run
from faying.case.case import Case, build
from faying.joint.attachments import PointMass, Support
from faying.joint.modal import ModesChoice
from faying.study import Study
from faying.study.keys.law import LawChoice
from faying.study.keys.surface import SurfaceChoice
from tests.helpers.loads import bolt_load
from tests.helpers.preloads import pulled
from tests.helpers.studies import write


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    path = tmp_path_factory.mktemp("study") / "study.toml"
    write(path)
    return Study.read(path)


@pytest.fixture(scope="module")
def result(study):
    return run(study)


def test_shapes_and_bounds(result):
    assert result.loads.tolist() == [2000.0, 6000.0]
    assert result.frequencies.shape == result.loss_factors.shape == (2, 6)
    assert result.rigid.shape == (6,)
    # squared frequencies are rounded at some 1e-16 of the stiffness over mass of an element, 1e5 times those of mode 1
    assert result.rigid.max() < 1e-5 * result.frequencies.min()
    assert np.all(result.frequencies > 1.0)
    assert np.all(result.frequencies >= result.free * (1 - 1e-9))
    assert np.all(result.loss_factors > 0)
    assert np.all(result.loss_factors < 0.25)  # never more than the joint's own
    # complex modes stiffen a little: compare the undamped bound with room for eta^2
    assert np.all(result.frequencies <= result.bonded * (1 + result.loss_factors**2))


def test_bolt_force_balance(result):
    for load, pressure in zip(result.loads, result.pressure, strict=True):
        assert result.weights @ pressure == pytest.approx(load, rel=1e-8)


def test_stiffness_at_the_points_is_that_of_the_law(study, result):
    steel = study.materials["45 steel"]
    law = faying.JK(D=2.39, G=1.53e-10, pair=faying.ContactPair(steel, steel), scan_area=16e-6)
    # read between points 1 % apart in pressure, at a kink of the law
    assert result.k_n == pytest.approx(law.at_pressure(result.pressure).k_n, rel=2e-5)
    assert result.k_t == pytest.approx(law.at_pressure(result.pressure).k_t, rel=2e-5)


@pytest.mark.slow
def test_sum_of_springs_does_not_depend_on_the_mesh(study, result):
    """Refined twice: the total of the joint's springs stays within 1 %."""

    def total(size):
        structure = build(
            replace(study, geometry=replace(study.geometry, size=size, face_size={"upper.joint": size / 2}))
        )
        found = structure.assembly().solve(6000 * bolt_load(structure, *study.bolts[0].faces))
        return structure.springs(found.pressures)[0].total()[0]

    totals = np.array([total(size) for size in (11e-3, 8e-3, 5.5e-3)])
    assert np.abs(totals / totals[-1] - 1).max() < 0.01


def test_flags_are_carried(result):
    assert any("outside its validity range" in line for line in result.warnings)
    assert any("10.3390/fractalfract8100611" in line for line in result.sources)


def test_a_result_that_is_read_is_the_one_that_was_written(result, tmp_path):
    path = result.save(tmp_path / "r.nc")
    again = faying.Result.load(path)
    assert again == result
    assert again.notes == result.notes
    assert replace(again, frequencies=again.frequencies * (1 + 1e-15)) != result
    assert faying.Result.load(again.save(tmp_path / "again.nc")) == result


def test_xarray_opens_a_result_by_its_coordinates(result, tmp_path):
    import xarray

    with xarray.open_datatree(result.save(tmp_path / "r.nc")) as tree:
        chosen = tree["modes"].sel(load="6 kN", mode=2)
        assert float(chosen.frequency) == result.frequencies[1, 1]
        assert tree["points"].pressure.attrs["units"] == "Pa"
        assert tree["modes"].frequency.dims == ("load", "mode")
        assert list(tree.joint.values) == list(result.joints)
        assert list(tree.axis.values) == ["x", "y", "z"]
        assert any("outside its validity range" in note["text"] for note in json.loads(tree.attrs["notes"]))
    assert result.to_xarray().equals(xarray.open_datatree(tmp_path / "r.nc").load())


def test_a_result_says_what_it_was_made_from(study, result):
    made = result.provenance
    assert made.study == study.text
    digest = hashlib.sha256((study.folder / "two-blocks.step").read_bytes()).hexdigest()
    assert made.files == {"two-blocks.step": digest}
    assert made.versions["faying"] == faying.__version__
    assert len(repr(result).splitlines()) <= 12


def test_csv_and_json(result, tmp_path):
    lines = result.to_csv(tmp_path / "r.csv").read_text().splitlines()
    assert lines[0] == "preload [N],mode,frequency [Hz],loss factor [-],free [Hz],bonded [Hz]"
    assert len(lines) == 1 + 2 * 6
    assert float(lines[1].split(",")[2]) == pytest.approx(result.frequencies[0, 0], rel=1e-7)
    again = json.loads(json.dumps(result.to_dict()))
    assert again["frequencies"]["values"] == result.frequencies.tolist()


def test_nothing_half_written_is_left(result, tmp_path):
    with pytest.raises(faying.InputError, match="no folder"):
        result.save(tmp_path / "none" / "r.nc")
    (tmp_path / "r.nc").mkdir()
    with pytest.raises(faying.InputError, match="cannot write"):
        result.save(tmp_path / "r.nc")
    assert [p.name for p in tmp_path.iterdir()] == ["r.nc"]


def test_names_that_do_not_fit_the_geometry_are_reported_together_before_a_contact_is_solved(study, monkeypatch):
    monkeypatch.setattr("faying.case.case.joint_law", lambda *_: pytest.fail("a contact was solved"))
    study = replace(study, law=LawChoice(model="half-space"))
    bolt = replace(study.bolts[0], faces=("upper.seat", "lower.nut"))
    joint = replace(study.joints[0], faces=("upper.joint", "floor"))
    with pytest.raises(faying.InputError) as caught:
        run(replace(study, bolts=(bolt,), joints=(joint,), parts={"upper": "45 steel", "base": "45 steel"}))
    text = str(caught.value)
    assert "bolt 'bolt' names the face 'lower.nut', which does not exist; the faces are" in text
    assert "joint 'joint' names the face 'floor'" in text
    assert "part 'base' is not in two-blocks.step" in text
    assert "[part] has no entry for 'lower'" in text


def test_a_preload_that_the_law_covers_has_one_answer(result):
    assert result.above_range is None
    assert not any(note.code.startswith("beyond-law") for note in result.notes)


def test_a_preload_that_the_law_does_not_cover_has_two_answers(study):
    """Held below, bonded above; what goes on rising beyond the law lies between them."""
    found = run(pulled(study, 1e3, 5e5))
    assert found.above_range.frequencies[0] == pytest.approx(found.frequencies[0], rel=1e-12)  # inside the law
    assert np.all(found.above_range.frequencies[1] >= found.frequencies[1])
    assert np.all(
        found.above_range.frequencies[1] <= found.bonded * (1 + found.above_range.loss_factors[1] ** 2) * (1 + 1e-4)
    )
    assert np.all(found.above_range.loss_factors[1] <= found.loss_factors[1].max())
    notes = {note.code: note for note in found.notes if note.code.startswith("beyond")}
    assert set(notes) == {"beyond-law", "beyond-law-matters"}
    assert all(note.load == 5e5 for note in notes.values())
    change = found.above_range.frequencies[1] / found.frequencies[1] - 1
    assert f"{change.max():.1%}" in notes["beyond-law-matters"].text
    assert "JK cannot answer" in notes["beyond-law-matters"].text


@pytest.mark.slow
@pytest.mark.parametrize(
    ("changes", "count"),
    [
        ({}, 1),
        ({"supports": (Support(face="lower.seat", directions=("x",)),)}, 1),
        ({"masses": (PointMass(mass=0.2, point=(0.04, 0.015, 0.015)),)}, 2),
    ],
    ids=["free", "supported", "with a mass"],
)
def test_the_modes_take_the_factorisation_of_the_preload_where_it_is_of_what_vibrates(
    study, monkeypatch, changes, count
):
    from faying.case.case import Case, Progress
    from faying.case.solve import solve
    from faying.joint import preload
    from faying.numerics import modal_reanalysis
    from faying.numerics.modes import lowest_modes

    made = []
    for module in (preload, modal_reanalysis):
        factorise = module.factorise_roughly
        monkeypatch.setattr(module, "factorise_roughly", lambda *a, f=factorise, **k: made.append(a[0]) or f(*a, **k))
    case = Case.of(study)
    case = replace(case, structure=replace(case.structure, **changes))
    structure = case.structure
    state = solve(case, 0, case.engine("reanalysis"), Progress(0), ranges=False)
    assert sum(matrix.shape[0] == structure.mesh.unknowns for matrix in made) == count
    K, _ = structure.coupled(state.springs)
    exact = lowest_modes(K, structure.dynamic_matrices[1], case.modal.mode_count, shift_frequency=case.shift_frequency)
    elastic = slice(case.rigid_count, case.rigid_count + study.modes.count)
    assert state.modes.frequencies[elastic] == pytest.approx(exact.frequencies[elastic], rel=5e-9)


@pytest.mark.slow
@pytest.mark.parametrize("factor", [2.0, 30.0, 3000.0])
def test_any_continuation_beyond_the_law_lies_in_the_bracket(study, factor):
    """The springs beyond the law made stiffer by any factor: each frequency stays between held and bonded."""
    from faying.case.above_range import bonded_above_range
    from faying.case.case import Case, Progress
    from faying.case.solve import solve
    from faying.numerics.modes import lowest_modes

    small = replace(pulled(study, 5e5), modes=ModesChoice(count=4))
    case = Case.of(small)
    structure = case.structure
    state = solve(case, 0, case.engine("reanalysis"), Progress(0))
    springs = state.springs[0]
    past = springs.pressure > structure.joints[0].law.model.greatest_pressure
    assert 0 < past.mean() < 1
    stiffer = replace(springs, k_n=np.where(past, factor, 1) * springs.k_n, k_t=np.where(past, factor, 1) * springs.k_t)
    K, _ = structure.coupled([stiffer])
    modes = lowest_modes(K, structure.dynamic_matrices[1], case.modal.mode_count, shift_frequency=case.shift_frequency)
    held, found = state.modes.frequencies[6:10], modes.frequencies[6:10]
    bonded = bonded_above_range(
        case, 5e5, [replace(springs, loss_n=0 * springs.k_n, loss_t=0 * springs.k_n)], state.damped
    )
    assert np.all(found >= held * (1 - 1e-9))
    assert np.all(found <= bonded.frequencies * (1 + 1e-9))


def test_a_file_that_is_not_step(study, tmp_path):
    bad = tmp_path / "x.step"
    bad.write_text("solid, they said")
    with pytest.raises(faying.ReadError, match="is not a STEP file"):
        run(replace(study, geometry=replace(study.geometry, step=bad)))
    bad.write_bytes(study.geometry.step.read_bytes()[:20000])
    with pytest.raises(faying.ReadError):
        run(replace(study, geometry=replace(study.geometry, step=bad)))


def test_faces_can_be_named_by_a_point(study):
    from faying.geometry.geometry import mesh_step
    from faying.geometry.selectors import Selector

    at = {"upper.side": Selector(part="upper", nearest=(0.04, 0.0, 0.0075))}
    mesh = mesh_step(study.geometry.step, size=8e-3, faces=at)
    assert mesh.face_part["upper.side"] == "upper"
    assert mesh.points[np.unique(mesh.face("upper.side")), 0] == pytest.approx(0.04)
    with pytest.raises(faying.InputError, match="no part is called 'roof'"):
        mesh_step(study.geometry.step, size=8e-3, faces={"x": Selector(part="roof", number=1)})


@pytest.mark.slow
def test_the_same_study_gives_the_same_numbers(study, result):
    again = run(study)
    assert again.frequencies == pytest.approx(result.frequencies, rel=1e-9)
    assert again.loss_factors == pytest.approx(result.loss_factors, rel=1e-5)


def test_per_node_and_mindlin_options(study, result):
    joint = replace(study.joints[0], springs="per-node", tangential="mindlin")
    other = run(replace(study, joints=(joint,), modes=ModesChoice(count=3)))
    assert other.frequencies.shape == (2, 3)
    assert other.total_k_n[0] != pytest.approx(result.total_k_n[0], rel=0.01)
    # the maps that are reported are the springs that were assembled
    assert other.k_n @ other.weights == pytest.approx(other.total_k_n[:, 0], rel=1e-12)
    assert other.k_t @ other.weights == pytest.approx(other.total_k_t[:, 0], rel=1e-12)


def on_the_milled_scan(study, model, tangential):
    scan = Path(__file__).parents[2] / "examples" / "t-specimen" / "milled.x3p"
    return build(
        replace(
            study,
            law=LawChoice(model=model),
            surface=SurfaceChoice(scan=scan),
            joints=(replace(study.joints[0], tangential=tangential),),
        )
    )


def test_another_law_presses_the_joint(study):
    """Greenwood and Williamson's sum over Kogut and Etsion's asperity, with Mindlin's ratio for k_t."""
    structure = on_the_milled_scan(study, "gw-ke", "mindlin")
    found = structure.assembly().solve(6000 * bolt_load(structure, *study.bolts[0].faces))
    assert structure.joints[0].interface.weights @ found.pressures[0] == pytest.approx(6000, rel=1e-8)
    springs = structure.springs(found.pressures)[0]
    assert springs.k_t == pytest.approx(springs.k_n * 2 * 0.7 / 1.7)


def test_a_law_that_takes_nothing_from_a_scan_says_so(study):
    with pytest.raises(faying.InputError, match="Power law needs C"):
        on_the_milled_scan(study, "power-law", "law")


def test_a_law_in_proportion_to_pressure_carries_a_joint(study):
    """Persson's stiffness is proportional to pressure at every load: its first touch is taken as a finite way off."""
    structure = on_the_milled_scan(study, "persson", None)
    found = structure.assembly().solve(6000 * bolt_load(structure, *study.bolts[0].faces))
    assert structure.joints[0].interface.weights @ found.pressures[0] == pytest.approx(6000, rel=1e-8)
    assert not structure.joints[0].law.predicts_loss


def test_a_table_without_a_line_break_at_its_end_is_told(tmp_path):
    """A number of its last line may have been cut in two; a scan's own reader says it, a table's has no one to tell."""
    write(tmp_path / "study.toml")
    table = tmp_path / "law.csv"
    table.write_text("pressure [MPa],k_n [MPa/um],k_t [MPa/um]\n0.001,1,1\n100,1000,800\n")
    plan = replace(Study.read(tmp_path / "study.toml"), files=(table,))
    assert "file-end" not in {note.code for note in Case.of(plan).notes}
    table.write_text(table.read_text().rstrip("\n"))
    assert [note.text for note in Case.of(plan).notes if note.code == "file-end"] == [
        f"{table}: the last line has no line break; the file may be cut short"
    ]
