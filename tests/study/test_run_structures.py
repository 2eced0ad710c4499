"""A study with shank, support, mass, friction, order, response: what comes out, and its way through NetCDF."""

import tomllib

import numpy as np
import pytest

import faying
from faying.answer.run import run
from faying.case.case import build
from faying.numerics.solve import available
from faying.study import Study
from tests.helpers.studies import write

MORE = """
[tightening]
order = ["bolt"]

[[support]]
face = "lower.seat"
stiffness = "50 MPa/um"

[[mass]]
mass = "50 g"
point = ["40 mm", "0 mm", "15 mm"]

[response]
from = "200 Hz"
to = "6 kHz"
points = 30
structural_loss = 0.01
[[response.input]]
point = ["40 mm", "15 mm", "15 mm"]
direction = [0, 0, 2]
[[response.output]]
point = ["40 mm", "15 mm", "15 mm"]
direction = [0, 0, 1]
[[response.output]]
point = ["-40 mm", "15 mm", "15 mm"]
direction = [0, 0, 1]
"""


def data(folder, more=MORE):
    path = folder / "study.toml"
    write(path, force=True)
    given = tomllib.loads(path.read_text() + more)
    given["bolt"][0] |= {"diameter": "8 mm", "material": "45 steel"}
    given["joint"][0]["friction"] = 0.2
    return given


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("structures")


@pytest.fixture(scope="module")
def result(folder):
    return run(Study.from_dict(data(folder), folder=folder))


def test_shapes_and_bounds(result):
    assert result.bolt_forces == pytest.approx(np.array([[2000.0], [6000.0]]))
    assert result.slipping.shape == (2, 1)
    assert np.all((result.slipping >= 0) & (result.slipping <= 1))
    assert result.rigid.size == 0  # springs hold the whole
    assert result.mac.shape == (2, 6, 6)
    assert np.diagonal(result.mac[0]) == pytest.approx(np.ones(6))
    assert np.all((result.mac >= 0) & (result.mac <= 1 + 1e-12))


def test_mac_follows_the_modes_to_the_next_load(result):
    """Between 2 and 6 kN a mode keeps its shape: its row's largest entry is near 1."""
    assert result.mac[1].max(axis=1).min() > 0.6


def test_the_response_peaks_at_the_modes(result):
    one = result.response
    assert one.values.shape == (2, 30, 2, 1)
    assert one.error.max() < 0.05
    assert np.all(one.values[:, :, 0, 0].imag < 0)  # at the driving point a passive structure only takes energy
    assert one.inputs[0][1] == (0.0, 0.0, 2.0)


def test_netcdf(result, tmp_path):
    import xarray

    path = result.save(tmp_path / "r.nc")
    assert type(result).load(path) == result
    with xarray.open_dataset(path, group="response") as found:
        assert found.values_real.dims == ("load", "response_frequency", "output", "input")
        assert found.values_real.attrs["units"] == "m/N"
        assert found.frequencies.values == pytest.approx(np.linspace(200, 6000, 30))
        assert found.output_points.values == pytest.approx(np.array([[0.04, 0.015, 0.015], [-0.04, 0.015, 0.015]]))


def test_json_names_bolts_and_slip(result):
    found = result.to_dict()
    assert found["bolt_forces"] == {"unit": "N", "values": [[2000.0], [6000.0]]}
    assert found["bolts"] == ["bolt"]
    assert found["slipping"]["values"] == result.slipping.tolist()


@pytest.mark.slow
def test_the_same_without_response_has_the_same_modes_and_a_heavier_one_lower(folder, result):
    given = data(folder)
    del given["response"]
    given["mass"][0]["mass"] = "80 g"
    heavier = run(Study.from_dict(given, folder=folder))
    assert heavier.response is None
    assert np.all(heavier.frequencies <= result.frequencies * (1 + 1e-9))


@pytest.mark.slow
def test_viscous_dampers_say_that_they_depend_on_the_mesh(folder):
    given = data(folder, "")
    given["modes"]["damping"] = "viscous"
    given["modes"]["count"] = 3
    found = run(Study.from_dict(given, folder=folder))
    assert any("loss factors depend on the mesh" in note for note in found.warnings)
    assert np.all(found.loss_factors > 0)


def test_a_joint_with_its_own_law_and_gap_differs(folder):
    given = data(folder, "")
    grid = [f"{x},{y},{0.02 * abs(x)}" for x in range(-40, 41, 8) for y in range(-15, 16, 5)]
    (folder / "gap.csv").write_text("\n".join(grid))
    given["joint"][0]["form"] = {"gap": {"file": "gap.csv", "xy_unit": "mm", "gap_unit": "um"}}
    structure = build(Study.from_dict(given, folder=folder))
    interface = structure.joints[0].interface
    assert interface.gap == pytest.approx(0.02e-6 * np.abs(interface.positions[:, 0] * 1e3), abs=8e-9)
    assert structure.joints[0].friction == 0.2


def test_names_that_do_not_exist(folder):
    given = data(folder)
    given["support"][0]["face"] = "nowhere"
    given["mass"][0] = {"mass": "1 g", "face": "nobody"}
    with pytest.raises(faying.InputError) as caught:
        build(Study.from_dict(given, folder=folder))
    assert "support 'nowhere' names the face 'nowhere'" in str(caught.value)
    assert "mass 'nobody' names the face 'nobody'" in str(caught.value)


def test_a_point_far_from_the_structure(folder):
    given = data(folder)
    given["response"]["input"][0]["point"] = ["4 m", "0 mm", "0 mm"]
    with pytest.raises(faying.InputError, match="point of the response: the nearest node to"):
        run(Study.from_dict(given, folder=folder))


def test_a_point_of_the_test_far_from_the_structure(folder):
    given = data(folder)
    rows = [["1 kHz"]] * len(given["bolt"][0]["preload"])
    given["test"] = {"source": "s", "direction": [1, 0, 0], "points": [["80 m", "0 mm", "0 mm"]], "frequencies": rows}
    with pytest.raises(faying.InputError, match=r"test.points\[1\]: the nearest node to .* check the point"):
        run(Study.from_dict(given, folder=folder))


@pytest.mark.slow  # test_engines has a plainer structure part by part
@pytest.mark.skipif("pardiso" not in available(), reason="only PARDISO factorises part by part")
def test_part_by_part_gives_the_same_answer(folder, result):
    """Shank, elastic support, point mass, slip and response: none of them is lost between the parts."""
    given = data(folder)
    given["bolt"][0]["preload"] = ["2 kN"]
    given.setdefault("modes", {})["solver"] = "pardiso-by-parts"
    found = run(Study.from_dict(given, folder=folder))
    assert found.frequencies == pytest.approx(result.frequencies[:1], rel=1e-7)
    assert found.loss_factors == pytest.approx(result.loss_factors[:1], rel=1e-5)
    assert found.free == pytest.approx(result.free, rel=1e-8)
    assert found.bonded == pytest.approx(result.bonded, rel=1e-8)
    assert {note.code for note in found.notes} <= {note.code for note in result.notes}  # result has a further load
    assert found.bolt_forces == pytest.approx(result.bolt_forces[:1], rel=1e-7)
    assert found.pressure == pytest.approx(result.pressure[:1], rel=1e-5, abs=1e-5 * result.pressure.max())
    size = np.abs(result.response.values).max()
    # two shapes are in each term, each found to 1e-4 (`faying.joint.modal.EXACT`)
    assert found.response.values == pytest.approx(result.response.values[:1], abs=2e-4 * size)
