"""The T-specimen as a user writes it in a notebook: a structure, its state, a result; on a coarse mesh and as it is."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

import faying

FOLDER = Path(__file__).parents[2] / "examples" / "t-specimen"
COARSE = "30 mm"


@pytest.fixture(autouse=True)
def closed():
    yield
    import matplotlib.pyplot

    matplotlib.pyplot.close("all")


def drawn(axes, file):
    """Whether axes give a picture of some size."""
    figure = np.ravel(axes)[0].figure
    figure.savefig(file, dpi=50)
    return file.stat().st_size > 3000


def structure_of(law, size):
    mesh = faying.read_mesh(FOLDER / "t-specimen.step", size=size)
    return faying.Structure(
        mesh,
        materials="45 steel",
        joints=[faying.Joint(("upper.joint", "lower.joint"), law)],
        bolts=[
            faying.Bolt("left", ("upper.seat.left", "lower.seat.left")),
            faying.Bolt("right", ("upper.seat.right", "lower.seat.right")),
        ],
    )


def plain_study(tmp_path, size):
    """The study of the example under JK and on faces as they are meshed, at one preload."""
    for name in ("t-specimen.step", "milled.x3p"):
        shutil.copy(FOLDER / name, tmp_path / name)
    text = (FOLDER / "study.toml").read_text(encoding="utf-8").replace('size = "18 mm"', f'size = "{size}"')
    text = re.sub(r"\[geometry.face_size\]\n.*\n", "", text)
    text = re.sub(r"\[joint.form\]\n.*\n", "[joint.form]\nflat = true\n", text)
    text = text[: text.index("# The law of the scan")] + text[text.index("[[bolt]]") : text.index("[test]")]
    text = text.replace('["4 kN", "8 kN", "12 kN"]', '"8 kN"') + '\n[law]\nmodel = "jk"\n'
    path = tmp_path / "study.toml"
    path.write_text(text, encoding="utf-8")
    return path


def check_state_is_that_of_the_study(tmp_path, size):
    scan = faying.read_scan(FOLDER / "milled.x3p")
    structure = structure_of(faying.Mates(scan, materials="45 steel").law("jk"), size)
    state = structure.solve(preload="8 kN", modes=15)
    result = faying.run(str(plain_study(tmp_path, size)))
    assert state.modes.frequencies == pytest.approx(result.frequencies[0], rel=1e-10)
    assert state.modes.loss_factors == pytest.approx(result.loss_factors[0], rel=1e-10)
    assert state.pressures["joint 1"] == pytest.approx(result.pressure[0], rel=1e-9)
    return structure, state, result


def check_everything_is_drawn_and_kept(structure, state, result, tmp_path):
    for one in (structure.mesh, structure, state, state.modes, result):
        assert len(str(one).splitlines()) <= 12
    pictures = structure.plot(), state.plot_pressure(), state.modes.plot(1), result.plot()
    assert all(drawn(axes, tmp_path / f"{k}.png") for k, axes in enumerate(pictures))
    result.save(tmp_path / "t-specimen.nc")
    again = faying.load(tmp_path / "t-specimen.nc")
    assert again == result
    assert result.to_dataframe("modes").frequency["8 kN", 1] == result.frequencies[0, 0]
    found = again.to_xarray()["modes"].frequency.sel(load="8 kN")
    assert np.array_equal(found.values, result.frequencies[0])


@pytest.mark.slow  # joint/test_structure_api and result/test_record have its parts on two blocks
def test_a_structure_and_a_result_on_a_coarse_mesh(tmp_path):
    made = check_state_is_that_of_the_study(tmp_path, COARSE)
    check_everything_is_drawn_and_kept(*made, tmp_path)


@pytest.mark.slow
def test_a_structure_and_a_result_on_the_mesh_of_the_example(tmp_path):
    made = check_state_is_that_of_the_study(tmp_path, "18 mm")
    check_everything_is_drawn_and_kept(*made, tmp_path)


@pytest.mark.slow
def test_the_study_of_the_example_is_a_result_of_a_dozen_lines(tmp_path):
    result = faying.run(FOLDER / "study.toml")
    assert len(str(result).splitlines()) <= 12
    assert drawn(result.plot(), tmp_path / "result.png")
    result.save(tmp_path / "t-specimen.nc")
    again = faying.load(tmp_path / "t-specimen.nc")
    assert again == result
    tree = again.to_xarray()
    assert tree["modes"].frequency.sel(load="8 kN").values.tolist() == result.frequencies[1].tolist()
    assert list(tree["laws"].law.values) == ["JK"]


USER = """
import faying

mesh = faying.read_mesh("part.step", size="18 mm")
law = faying.JK(D=2.4, G=1e-10, pair=faying.ContactPair("45 steel", "45 steel"), scan_area=16e-6)
structure = faying.Structure(
    mesh,
    materials={"upper": "45 steel", "lower": faying.CATALOGUE["S355"]},
    joints=[faying.Joint(("upper.joint", "lower.joint"), law, friction=0.2)],
    bolts=[faying.Bolt("left", ("a", "b"), diameter="8 mm", material="45 steel")],
)
state: faying.State = structure.solve(preload={"left": "8 kN"}, modes=15)
print(state.modes.frequencies.max(), state.modes.damping, state.pressures["joint 1"].mean())
state.plot_pressure().set_title("pressure")
state.modes.plot(1).set_title("mode 1")
result = faying.run("study.toml")
result.plot()[0].set_xlabel("preload")
result.save("result.nc")
again = faying.load("result.nc")
assert isinstance(again, faying.Result)
print(again.to_xarray()["modes"].frequency, again.to_dataframe("modes").head())
"""


@pytest.mark.slow
def test_type_checkers_accept_a_script_of_a_user(tmp_path):
    api = pytest.importorskip("mypy.api")
    script = tmp_path / "script.py"
    script.write_text(USER, encoding="utf-8")
    said, _, status = api.run(["--strict", "--cache-dir", str(tmp_path / "cache"), str(script)])
    assert status == 0, said
