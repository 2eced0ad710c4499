"""The error of the mesh: it holds what finer meshes say, enters the interval, and is refined to a tolerance."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.answer.refine import refined, tolerance_of
from faying.answer.run import run
from faying.case.mesh_error import MESH_NOTED, MeshError, size_for
from faying.cli.main import cli
from faying.errors import InputError
from faying.study import Study
from tests.helpers import assemblies
from tests.helpers.proposed import proposed

EXAMPLES = Path(__file__).parents[2] / "examples"


def finer(study: Study, ratio: float) -> Study:
    geometry = study.geometry
    sizes = {name: ratio * one for name, one in geometry.face_size.items()}
    return replace(study, geometry=replace(geometry, size=ratio * geometry.size, face_size=sizes))


def plain(study: Study) -> Study:
    """Without what the mesh does not change."""
    return replace(study, alternatives=(), modes=replace(study.modes, levels=()), backbone=None, response=None)


@pytest.fixture(scope="module")
def lap(tmp_path_factory):
    source = EXAMPLES / "plates-and-bolts"
    text = (source / "plates.toml").read_text(encoding="utf-8")
    for old, new in (
        ('"plates.step"', f'"{(source / "plates.step").as_posix()}"'),
        ('scan = "../t-specimen/milled.x3p"', 'D = 2.39\nG = "1.53e-10 m"\nscan_area = "16 mm^2"\n#'),
        ('size = "12 mm"', 'size = "20 mm"'),
        ('"upper.joint" = "5 mm"', '"upper.joint" = "10 mm"'),
        ("[[bolt]]", "[joint.form]\nflat = true\n[[bolt]]"),
        ("count = 8", "count = 4\nlevels = []"),
    ):
        assert old in text
        text = text.replace(old, new, 1)
    path = tmp_path_factory.mktemp("lap") / "lap.toml"
    path.write_text(text.replace('["8 kN", "16 kN"]', '["16 kN"]'), encoding="utf-8")
    return Study.read(path)


@pytest.fixture(scope="module")
def coarse(lap):
    return run(lap)


def holds(found, fine) -> np.ndarray:
    """Whether twice the estimate holds a finer mesh's frequencies, at each load and mode."""
    moved = np.log(fine.frequencies / found.frequencies)
    return (-2 * found.mesh_error <= moved) & (moved <= found.mesh_error)


@pytest.mark.slow
def test_a_lap_holds_the_frequencies_of_smaller_elements(lap, coarse):
    fine = run(replace(finer(lap, 0.6), modes=replace(lap.modes, intervals=False)))
    assert holds(coarse, fine).all()
    assert np.all(fine.frequencies <= coarse.frequencies)  # closed faces: the parts are too stiff


def test_the_error_stands_in_result_table_and_note(coarse, tmp_path):
    low, high = coarse.interval.offsets[coarse.interval.sources.index("mesh")]
    assert coarse.mesh_error == pytest.approx((high - low) / 2)
    assert np.all(coarse.mesh_error > 0)
    again = faying.load(coarse.save(tmp_path / "result.nc"))
    assert np.array_equal(again.mesh_error, coarse.mesh_error)
    rows = coarse.csv_text().splitlines()
    column = rows[0].split(",").index("error of the mesh [-]")
    assert float(rows[1].split(",")[column]) == pytest.approx(coarse.mesh_error[0, 0], rel=1e-6)
    assert coarse.to_dict()["mesh_error"]["values"] == coarse.mesh_error.tolist()
    noted = [note for note in coarse.notes if note.code == "mesh-error"]
    assert bool(noted) == bool(coarse.mesh_error.max() > MESH_NOTED)


def test_refinement_ends_below_its_tolerance(lap, coarse):
    """With an error that falls with the square of the size in place of a run."""
    sizes = []

    def solved(study):
        sizes.append((study.geometry.size, *study.geometry.face_size.values()))
        return replace(coarse, mesh_error=np.full(coarse.frequencies.shape, 25.0 * study.geometry.size**2), notes=())

    found = refined(lap, 2e-3, solved)
    assert found.mesh_error.max() <= 2e-3
    assert np.all(np.diff(np.array(sizes), axis=0) < 0)
    assert 25.0 * sizes[-2][0] ** 2 > 2e-3  # no run more than it takes
    assert [note.code for note in found.notes] == ["mesh-refined"]
    assert f"{1e3 * sizes[-1][0]:.3g} mm" in found.notes[0].text
    still = refined(lap, 1e-4, lambda study: replace(coarse, mesh_error=np.full((1, 4), 0.01), notes=()))
    assert "after 5 meshes is still 1 %" in still.notes[0].text
    assert still.notes[0].severity == "limit"


def test_a_tolerance_is_a_share_within_reason():
    assert tolerance_of("0.2%") == tolerance_of("0.2 %") == tolerance_of(0.002) == pytest.approx(0.002)
    for wrong in ("2 mm", 0.0, "20 %", "fine"):
        with pytest.raises(InputError):
            tolerance_of(wrong)
    assert size_for(10e-3, 8e-3, 4e-3) == pytest.approx(10e-3 / 2 ** (2 / 3))
    assert size_for(10e-3, 8e-3, 1e-3) == pytest.approx(10e-3 * 0.3)


def test_a_finer_mesh_has_no_frequency_higher_but_by_what_it_does_to_the_contact():
    """Rayleigh and Ritz: more functions lower a frequency; points of a joint move it either way."""
    found = MeshError(parts=np.array([[0.02, 0.02]]), contact=np.array([[0.0, 0.005]]))
    low, high = found.middle + found.offsets
    assert high[0] == pytest.approx([0.0, 0.005])
    assert low[0] == pytest.approx([-0.04, -0.045])


def test_a_mesh_that_is_ready_is_not_refined():
    done = CliRunner().invoke(cli, ["run", str(EXAMPLES / "two-blocks" / "study.toml"), "--refine", "0.2%"])
    assert done.exit_code != 0
    assert "model.inp is a mesh that is ready" in str(done.exception) + done.output


@pytest.fixture(scope="module")
def of_examples():
    @cache
    def made(name, ratio):
        study = plain(Study.read(EXAMPLES / name))
        return run(finer(replace(study, modes=replace(study.modes, intervals=ratio == 1)), ratio))

    return made


@pytest.mark.slow
@pytest.mark.parametrize(
    "name", ["plates-and-bolts/plates.toml", "plates-and-bolts/flanges.toml", "t-specimen/study.toml"]
)
def test_the_interval_of_the_mesh_holds_nine_of_ten_finer_frequencies(of_examples, name):
    assert holds(of_examples(name, 1), of_examples(name, 0.6)).mean() >= 0.9


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in assemblies.SIZES if "-" not in name])
def test_assemblies_hold_nine_of_ten_finer_frequencies(tmp_path, name):
    study = Study.read(proposed(assemblies.made(name, tmp_path / f"{name}.step"), assemblies.SIZES[name]))
    study = plain(replace(study, modes=replace(study.modes, count=8)))
    found = run(replace(study, modes=replace(study.modes, intervals=True)))
    fine = run(finer(replace(study, modes=replace(study.modes, intervals=False)), 0.7))
    assert holds(found, fine).mean() >= 0.9


@pytest.mark.slow
def test_a_pair_of_a_symmetric_ring_differs_by_less_than_the_error_of_the_mesh(tmp_path):
    """Two modes of a flange that differ by a turn alone have one frequency on the exact structure."""
    study = Study.read(proposed(assemblies.flanges(tmp_path / "flanges.step"), "16 mm"))
    found = run(replace(study, modes=replace(study.modes, count=8)))
    first, second = found.frequencies[-1, :2]
    assert abs(second / first - 1) < found.mesh_error[-1, :2].sum()
