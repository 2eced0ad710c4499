"""Files for ParaView, read back by meshio and by the standard library: the numbers of the result, in their places."""

import json
import shutil
import subprocess
from base64 import b64decode
from xml.etree import ElementTree

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.cli.main import cli
from faying.result.maps import joint_map_of
from tests.helpers.results import small_result
from tests.helpers.scenes import two_boxes

meshio = pytest.importorskip("meshio", reason="the package meshio is not installed")


@pytest.fixture(scope="module")
def result():
    """Two boxes with an awkward title."""
    return two_boxes(title='boxes -- <b> & "c"')


@pytest.fixture(scope="module")
def files(result, tmp_path_factory):
    return result.save_vtu(tmp_path_factory.mktemp("vtu") / "new" / "boxes.pvd")


def numbers(element):
    """What an array of a file holds, by the format's own words."""
    raw = b64decode(element.text)
    size = int(np.frombuffer(raw[:8], "<u8")[0])
    assert size == len(raw) - 8
    types = {"Float64": "<f8", "Int64": "<i8", "UInt8": "u1"}
    return np.frombuffer(raw[8:], types[element.get("type")])


def test_the_collection_names_a_file_for_each_preload(result, files):
    pvd, *every = files
    found = ElementTree.parse(pvd).getroot().findall("./Collection/DataSet")
    assert [float(one.get("timestep")) for one in found] == result.loads.tolist()
    assert [pvd.parent / one.get("file") for one in found] == every
    assert all(file.is_file() for file in every)


@pytest.mark.parametrize("load", [0, 1])
def test_meshio_reads_shapes_and_maps(result, files, load):
    read = meshio.read(files[1 + load])
    found = joint_map_of(result, 0)
    nodes, count = len(result.outline), len(found.parents)
    assert len(read.points) == nodes + count
    np.testing.assert_array_equal(read.points[:nodes], result.outline)
    np.testing.assert_allclose(read.points[nodes:], result.outline[found.parents].mean(axis=1))
    (cells,) = [block.data for block in read.cells]
    np.testing.assert_array_equal(cells[: len(result.triangles)], result.triangles)
    np.testing.assert_array_equal(cells[len(result.triangles) :], found.triangles + nodes)
    for mode in range(3):
        for part, shapes in (("real", result.shapes), ("imaginary", result.shapes_imaginary)):
            shape = read.point_data[f"mode {mode + 1} {part}"]
            np.testing.assert_allclose(shape[:nodes], shapes[load, mode])
            np.testing.assert_allclose(shape[nodes:], shapes[load, mode][found.parents].mean(axis=1), atol=1e-6)
    for name, unit in (("pressure", "Pa"), ("slip", "m"), ("k_n", "Pa/m"), ("k_t", "Pa/m")):
        values = read.point_data[f"{name} [{unit}]"]
        assert np.isnan(values[:nodes]).all()
        np.testing.assert_array_equal(values[nodes:], found.fields[name][load])
    joints = read.cell_data["joint"][0]
    assert (joints[: len(result.triangles)] == -1).all()
    assert (joints[len(result.triangles) :] == 0).all()
    np.testing.assert_array_equal(read.cell_data["part"][0][: len(result.triangles)], result.part_of_triangle)


def test_the_force_of_the_map_is_that_of_the_points(result, files):
    """Pressure of the file, integrated over its triangles, against the sum over the points of the joint: within 2 %."""
    for load, file in enumerate(files[1:]):
        read = meshio.read(file)
        triangles = read.cells[0].data[read.cell_data["joint"][0] == 0]
        a, b, c = (read.points[triangles[:, k]] for k in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
        force = float(area @ read.point_data["pressure [Pa]"][triangles].mean(axis=1))
        assert force == pytest.approx(float(result.pressure[load] @ result.weights), rel=0.02)


def test_facts_of_the_load_stand_in_the_file(result, files):
    root = ElementTree.parse(files[2]).getroot()
    facts = {one.get("Name"): numbers(one) for one in root.find("./UnstructuredGrid/FieldData")}
    np.testing.assert_array_equal(facts["preload [N]"], result.loads[1:])
    np.testing.assert_array_equal(facts["frequency [Hz]"], result.frequencies[1])
    types = {one.get("Name"): numbers(one) for one in root.find("./UnstructuredGrid/Piece/Cells")}
    assert set(types["types"]) == {5}
    assert types["offsets"][-1] == len(types["connectivity"])


def test_a_result_whose_joints_have_no_triangles_has_its_surface_alone(tmp_path):
    """No map, but the shapes."""
    _, first, _ = small_result().save_vtu(tmp_path / "bare.vtu")
    read = meshio.read(first)
    assert len(read.points) == 3
    assert set(read.point_data) == {f"mode {mode} {part}" for mode in (1, 2) for part in ("real", "imaginary")}


def test_what_cannot_be_written_is_refused(result, tmp_path):
    with pytest.raises(faying.InputError, match=r"end in \.pvd or \.vtu; give a name such as a\.pvd"):
        result.save_vtu(tmp_path / "a.vtk")


def test_the_command_writes_them_and_refuses_what_is_no_result(result, tmp_path):
    result.save(tmp_path / "result.nc")
    done = CliRunner().invoke(cli, ["view", str(tmp_path / "result.nc"), "--vtu", str(tmp_path / "a.pvd")])
    assert done.exit_code == 0
    assert {path.name for path in tmp_path.iterdir()} == {"result.nc", "a.pvd", "a-1.vtu", "a-2.vtu"}
    (tmp_path / "s.toml").write_text("", encoding="utf-8")
    refused = CliRunner().invoke(cli, ["view", str(tmp_path / "s.toml"), "--vtu", str(tmp_path / "b.pvd")])
    assert "--vtu writes a result, load cases or a vibration (.nc) for ParaView; s.toml is none" in str(
        refused.exception
    )
    both = ["view", str(tmp_path / "result.nc"), "--vtu", str(tmp_path / "b.pvd"), "--out", "x.html"]
    assert "leave out --out and --unit" in str(CliRunner().invoke(cli, both).exception)


IN_PARAVIEW = """
import json, sys
from paraview import servermanager
from paraview.simple import IntegrateVariables, OpenDataFile, Threshold, UpdatePipeline, WarpByVector

reader = OpenDataFile(sys.argv[1])
out = {"times": list(reader.TimestepValues), "forces": [], "areas": []}
for time in reader.TimestepValues:
    joint = Threshold(Input=reader, Scalars=["CELLS", "joint"], LowerThreshold=-0.5, UpperThreshold=0.5)
    total = IntegrateVariables(Input=joint)
    UpdatePipeline(time=time, proxy=total)
    row = servermanager.Fetch(total)
    out["forces"].append(row.GetPointData().GetArray("pressure [Pa]").GetValue(0))
    out["areas"].append(row.GetCellData().GetArray("Area").GetValue(0))
moved = WarpByVector(Input=reader, Vectors=["POINTS", "mode 1 real"], ScaleFactor=0.25)
UpdatePipeline(time=reader.TimestepValues[0], proxy=moved)
out["bounds"] = list(moved.GetDataInformation().GetBounds())
print(json.dumps(out))
"""


@pytest.mark.skipif(shutil.which("pvbatch") is None, reason="ParaView's pvbatch is not installed")
def test_paraview_opens_it(result, files, tmp_path):
    """ParaView's own integral of the pressure over the joint is the force of the map, at each preload."""
    script = tmp_path / "look.py"
    script.write_text(IN_PARAVIEW)
    done = subprocess.run(["pvbatch", str(script), str(files[0])], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["times"] == result.loads.tolist()
    for force, total, file in zip(found["forces"], found["areas"], files[1:], strict=True):
        read = meshio.read(file)
        triangles = read.cells[0].data[read.cell_data["joint"][0] == 0]
        a, b, c = (read.points[triangles[:, k]] for k in range(3))
        area = np.linalg.norm(np.cross(b - a, c - a), axis=1) / 2
        assert force == pytest.approx(float(area @ read.point_data["pressure [Pa]"][triangles].mean(axis=1)), rel=1e-5)
        assert total == pytest.approx(area.sum(), rel=1e-6)
    read = meshio.read(files[1])
    moved = read.points + 0.25 * read.point_data["mode 1 real"]
    assert found["bounds"] == pytest.approx(np.stack([moved.min(axis=0), moved.max(axis=0)]).T.ravel(), rel=1e-6)
