"""Scenes: parts and faces of meshes, results and STEP files, maps on joints, the text form, the vendored library."""

import hashlib
import json
import zlib
from base64 import b64decode
from pathlib import Path

import numpy as np
import pytest

from faying.fe.face_map import joint_map, projection, quartered
from faying.geometry.cad import read_parts
from faying.output import scene as scenes
from faying.output.scene.text import to_dict
from tests.helpers.boxes import stack
from tests.helpers.scenes import two_boxes

EXAMPLES = Path(__file__).parents[2] / "examples"


def array(packed):
    """An array as a reader of the text form gets it, by the rules that faying.output.scene.text states."""
    plain = zlib.decompress(b64decode(packed["data"]))
    return np.frombuffer(plain, "<" + packed["type"]).reshape(packed["shape"]) * packed["scale"]


def grid(n=6, width=0.03):
    """A flat square of triangles, and the points of a rule of degree 2 on each with their areas."""
    x = np.linspace(0, width, n + 1)
    points = np.stack([*np.meshgrid(x, x, indexing="ij"), np.zeros((n + 1, n + 1))], -1).reshape(-1, 3)
    at = np.arange((n + 1) ** 2).reshape(n + 1, n + 1)
    a, b, c, d = (at[i : i + n, j : j + n].ravel() for i, j in ((0, 0), (1, 0), (1, 1), (0, 1)))
    triangles = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    hats = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6
    places = np.einsum("qa,tai->tqi", hats, points[triangles]).reshape(-1, 3)
    return points, triangles, places, np.full(len(places), width**2 / len(places))


def test_quarters_cover_the_triangles_and_keep_their_sense():
    points, triangles, _, _ = grid()
    parents, quarters = quartered(triangles)
    corner = points[parents].mean(axis=1)[quarters]
    cross = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])[:, 2] / 2
    assert np.all(cross > 0)
    assert cross.sum() == pytest.approx(0.03**2)
    assert len(parents) == 13**2  # nodes and middles of the edges, each once


def test_a_map_keeps_constants_the_force_and_the_limits_of_the_values():
    points, triangles, places, weights = grid()
    rng = np.random.default_rng(1)
    values = np.stack([np.full(len(places), 3e6), rng.uniform(1e6, 9e6, len(places))])
    found = joint_map(points, [triangles], places, weights, {"pressure": values})
    at = found.fields["pressure"]
    np.testing.assert_allclose(at[0], 3e6, rtol=1e-12)
    assert at[1].min() >= values[1].min()
    assert at[1].max() <= values[1].max()
    # the force: each corner stands for the area that the projection gave it
    corners = points[found.parents].mean(axis=1)
    lumped = projection(corners, found.triangles, places, weights)
    share = np.linalg.lstsq(lumped.T.toarray(), weights, rcond=None)[0]
    assert share @ at[1] == pytest.approx(weights @ values[1], rel=1e-9)


def test_a_map_converges_to_a_smooth_field():
    """The lumped projection is of second order inside, of first at the rim."""
    errors = []
    for n in (6, 12, 24):
        points, triangles, places, weights = grid(n)
        field = np.exp(-(((places - 0.015) * [1, 1, 0]) ** 2).sum(axis=1) / 0.008**2)
        found = joint_map(points, [triangles], places, weights, {"p": field[None]})
        corners = points[found.parents].mean(axis=1)
        exact = np.exp(-(((corners - 0.015) * [1, 1, 0]) ** 2) @ np.ones(3) / 0.008**2)
        errors.append(np.sqrt(np.mean((found.fields["p"][0] - exact) ** 2)))
    assert errors[1] < errors[0] / 2.5
    assert errors[2] < errors[1] / 2.5


@pytest.mark.parametrize("first", [True, False], ids=["pad first", "plate first"])
def test_a_map_covers_what_touches_and_nothing_else(first):
    """A pad of 10 x 10 mm on a plate of 30 x 30 mm; pads that meet in part cover the elements that they meet on."""
    points, triangles, _, _ = grid(6)
    pad = points / 3 + [0.012, 0.011, 0]
    both = np.concatenate([points, pad])
    faces = [triangles, triangles + len(points)][:: -1 if first else 1]
    places, weights = grid(6)[2] / 3 + [0.012, 0.011, 0], np.full(len(grid(6)[2]), 1.0)
    found = joint_map(both, faces, places, weights, {"p": np.ones((1, len(places)))})
    corner = both[found.parents].mean(axis=1)[found.triangles]
    assert np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])[:, 2].sum() / 2 == pytest.approx(1e-4)
    half = places[:, 0] < 0.017 - 1e-9
    part = joint_map(both, faces, places[half], weights[half], {"p": np.ones((1, half.sum()))})
    corner = both[part.parents].mean(axis=1)
    assert corner[:, 0].max() == pytest.approx(0.017)


def test_faces_of_a_mesh_are_named_ones_then_smooth_regions():
    """Two boxes in a row: of six sides each, left and right have names."""
    found = scenes.of_mesh(stack([1.0, 2.0], [2, 3]))
    assert found.parts == ("p0", "p1")
    for part, length in enumerate((1.0, 2.0)):
        mine = [face for face in found.faces if face.part == part]
        assert [face.number for face in mine] == list(range(1, 7))
        assert [face.name for face in mine[:2]] == [f"p{part}.left", f"p{part}.right"]
        assert all(face.name == "" for face in mine[2:])
        assert sorted(face.area for face in mine) == pytest.approx(sorted([1, 1, *4 * [length]]))
        np.testing.assert_allclose(mine[0].normal, [-1, 0, 0], atol=1e-12)
    assert len(found.edges) == 2 * (4 * 2 + 4 * 2) + 4 * (2 + 3)  # twelve edges a box, divided as the mesh is
    corners = found.points[found.triangles]
    volume = np.einsum("ti,ti->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6
    assert volume == pytest.approx(3.0)  # normals outwards


def test_the_scene_of_a_result_has_what_the_structure_is_made_of():
    result = two_boxes()
    found = scenes.of_result(result)
    (joint,) = found.joints
    assert [found.faces[k].name for k in joint.faces] == ["p0.right", "p1.left"]
    (bolt,) = found.bolts
    np.testing.assert_allclose(bolt.seats, result.bolt_seats[0])
    force = joint.map.fields["pressure"][:, joint.map.triangles].mean(axis=2).mean(axis=1) * 0.05 * 0.04
    assert force == pytest.approx(result.pressure @ result.weights, rel=0.01)  # its triangles are alike


def test_a_result_whose_joints_have_no_triangles_still_has_a_scene():
    from tests.helpers.results import small_result

    found = scenes.of_result(small_result())
    assert [joint.map for joint in found.joints] == [None, None]
    assert scenes.page(found)


def test_the_text_gives_back_points_shapes_and_maps():
    result = two_boxes()
    known = to_dict(scenes.of_result(result))
    assert known == json.loads(scenes.to_text(scenes.of_result(result)))
    arrays = known["arrays"]
    np.testing.assert_allclose(array(arrays["points"]), result.outline, rtol=1e-6)
    np.testing.assert_array_equal(array(arrays["triangles"]), result.triangles)
    step = np.abs(result.shapes[1, 2]).max() / 32767
    np.testing.assert_allclose(array(arrays["real.1.2"]), result.shapes[1, 2], atol=0.51 * step)
    np.testing.assert_allclose(array(arrays["imaginary.1.2"]), result.shapes_imaginary[1, 2], atol=0.51 * step)
    assert array(arrays["map0.pressure"]).shape[0] == 2
    low, high = known["fields"]["pressure"]["range"]
    assert low == 0
    assert high == pytest.approx(array(arrays["map0.pressure"]).max())


@pytest.mark.parametrize("name", ["t-specimen/t-specimen.step", "plates-and-bolts/plates.step"])
def test_faces_of_a_step_file_have_the_numbers_of_the_kernel(name):
    solids = list(read_parts(EXAMPLES / name).solids)
    found = scenes.of_step(EXAMPLES / name)
    assert list(found.parts) == [solid.name for solid in solids]
    for part, solid in enumerate(solids):
        mine = [face for face in found.faces if face.part == part]
        listed = list(solid.faces)
        assert [face.number for face in mine] == list(range(1, len(listed) + 1))
        assert [face.name for face in mine] == [face.name or "" for face in listed]
        for ours, theirs in zip(mine, listed, strict=True):
            centre = np.array([theirs.center.x, theirs.center.y, theirs.center.z])
            np.testing.assert_allclose(ours.centre * 1e3, centre, atol=1e-9)
            drawn = found.points[found.triangles[found.face_of_triangle == found.faces.index(ours)]] * 1e3
            area = np.linalg.norm(np.cross(drawn[:, 1] - drawn[:, 0], drawn[:, 2] - drawn[:, 0]), axis=1).sum() / 2
            assert area == pytest.approx(theirs.mass, rel=0.03)  # round faces are drawn with chords


def test_a_file_that_is_no_step_file_says_so(tmp_path):
    from faying.errors import ReadError

    (tmp_path / "a.step").write_text("hello")
    with pytest.raises(ReadError, match="not a STEP file"):
        scenes.of_step(tmp_path / "a.step")


def test_the_vendored_library_is_the_one_that_was_looked_at():
    """Its hash; that it asks for nothing and evaluates nothing; its licence and how it is made stand beside it."""
    file = scenes.ASSETS["vendor/three.min.js"]
    assert hashlib.sha256(file.read_bytes()).hexdigest() == (
        "35ebe9db120bd45331881a2ef07173ec439067c15d842382e292ed07407a455f"
    )
    assert len(zlib.compress(file.read_bytes(), 9)) < 150e3
    text = file.read_text(encoding="utf-8")
    assert "eval(" not in text
    assert "new Function" not in text
    assert "The MIT License" in (file.parent / "LICENSE.three").read_text(encoding="utf-8")
    assert "REVISION" in (file.parent / "entry.js").read_text()
    assert "three@0.187.0" in (file.parent / "rebuild.sh").read_text()


def test_the_inline_viewer_ends_no_script_and_imports_nothing():
    text = scenes.inline()
    assert "</script" not in text
    assert "<!--" not in text
    assert "import " not in text.split("const VIRIDIS")[1]
    assert "export " not in text.split("const VIRIDIS")[1]
