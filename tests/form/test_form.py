"""Form of faces: shapes, random forms, flatness, maps of both faces; what does not depend on mesh or unit."""

import json
import zipfile
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import faying
from faying.cli import main
from faying.form.face_axes import FaceAxes
from faying.form.fit import minimum_zone
from faying.form.form import Form, random_depth
from faying.form.gap_map import FaceMap, GapMap, read_heights
from tests.helpers.plates import plates, stacked

FACES = ("low.top", "high.bottom")
L, W = 0.08, 0.04


def gap_of(form, mesh=None):
    """Places in the middle of the face's own box, and the gap of a form there."""
    mesh = mesh or stacked()
    interface = plates(mesh).joints[0].interface
    laid = form.on(interface, mesh, FACES)
    return interface.positions[:, :2] - [L / 2, W / 2], laid.gap - interface.gap


@pytest.mark.parametrize("kind", ["hex20", "hex8", "tet10"])
def test_named_shapes_are_their_formulas(kind):
    mesh = stacked(kind=kind)
    place, gap = gap_of(Form(crown_along=14e-6), mesh)
    assert gap == pytest.approx(14e-6 * (2 * place[:, 0] / L) ** 2, abs=1e-18)
    _, gap = gap_of(Form(crown_across=3e-6), mesh)
    assert gap == pytest.approx(3e-6 * (2 * place[:, 1] / W) ** 2, abs=1e-18)
    _, gap = gap_of(Form(twist=4e-6), mesh)
    assert gap == pytest.approx(4e-6 * (1 + 4 * place[:, 0] * place[:, 1] / (L * W)), abs=1e-18)
    _, gap = gap_of(Form(wave=2e-6, wave_length=0.03), mesh)
    assert gap == pytest.approx(1e-6 * (1 - np.cos(2 * np.pi * place[:, 0] / 0.03)), abs=1e-18)


def test_negative_amplitudes_are_hollow_and_only_move_the_parts_as_wholes():
    for name in ("crown_along", "crown_across", "twist", "wave"):
        _, up = gap_of(Form(**{name: 5e-6}, wave_length=0.05))
        _, down = gap_of(Form(**{name: -5e-6}, wave_length=0.05))
        assert np.ptp(up + down) < 1e-18  # each other's negative but for a constant
        assert min(up.min(), down.min()) >= 0


def test_shapes_add():
    one, other = Form(crown_along=5e-6, twist=-2e-6), Form(flatness=8e-6, seed=3)
    both = replace(one, flatness=8e-6, seed=3)
    assert gap_of(both)[1] == pytest.approx(gap_of(one)[1] + gap_of(other)[1], abs=1e-18)


@settings(max_examples=20, deadline=None)
@given(offset=st.floats(-1e-3, 1e-3), slopes=st.tuples(*2 * [st.floats(-1e-3, 1e-3)]), crown=st.floats(1e-7, 1e-4))
def test_flatness_is_that_of_the_shape_whatever_the_tilt(offset, slopes, crown):
    """A crown of height c over the box lies between planes c apart: the chord's and the tangent's."""
    place = np.stack(np.meshgrid(np.linspace(-1, 1, 21), np.linspace(-1, 1, 11), indexing="ij"), -1).reshape(-1, 2)
    heights = crown * place[:, 0] ** 2
    tilted = heights + offset + place * [L / 2, W / 2] @ slopes
    found = minimum_zone(place * [L / 2, W / 2], tilted)
    assert found.flatness == pytest.approx(crown, rel=1e-6, abs=1e-12)
    assert found.depth(place * [L / 2, W / 2], tilted) == pytest.approx(crown - heights, abs=1e-6 * crown + 1e-12)


def test_flatness_of_a_saddle():
    """Four corners in turn up and down: no plane does better than the one through the middle (Chebyshev)."""
    corner = np.array([[-1, -1], [-1, 1], [1, -1], [1, 1]], dtype=float)
    assert minimum_zone(corner, corner[:, 0] * corner[:, 1] * 2e-6).flatness == pytest.approx(4e-6, rel=1e-9)


def test_flatness_is_least_over_all_planes():
    generator = np.random.default_rng(5)
    place, heights = generator.uniform(-0.1, 0.1, (3000, 2)), generator.normal(0, 1e-6, 3000)
    found = minimum_zone(place, heights)
    rest = heights - found.middle(place)
    assert np.ptp(rest) == pytest.approx(found.flatness, rel=1e-8)
    for tilt in generator.normal(0, 1e-6, (50, 2)):
        assert np.ptp(rest - place @ tilt) >= found.flatness * (1 - 1e-9)


def test_random_forms_have_the_stated_flatness():
    """200 draws of each face: mean 2/3 of the tolerance, the sd of a normal of 1/6 cut off at two, never above 1."""
    axis = np.linspace(-1, 1, 33)
    grid = np.stack(np.meshgrid(axis, axis, indexing="ij"), -1).reshape(-1, 2)
    side = np.random.default_rng(0).integers(0, 2, 200)
    found = np.array([minimum_zone(grid, random_depth(grid, 1.0, seed, side[seed])).flatness for seed in range(200)])
    cut = 1 - 4 * np.exp(-2) / np.sqrt(2 * np.pi) / 0.954499736  # variance of a unit normal between -2 and 2
    sd = np.sqrt(cut) / 6
    assert found.mean() == pytest.approx(2 / 3, abs=3 * sd / np.sqrt(200))
    assert found.std(ddof=1) == pytest.approx(sd, rel=3 / np.sqrt(400))
    assert found.max() <= 1 + 1e-9
    assert found.min() >= 1 / 3 - 1e-9


def test_random_forms_depend_on_nothing_but_seed_face_and_place():
    coarse, fine = stacked(counts=(4, 2, 1)), stacked(counts=(4, 2, 1), kind="hex8")
    form = Form(flatness=20e-6, seed=7)
    (place, one), (_, again) = gap_of(form, coarse), gap_of(form, coarse)
    assert np.array_equal(one, again)
    there, other = gap_of(form, fine)
    expected = sum(random_depth(2 * there / [L, W], 20e-6, 7, side) for side in (0, 1))
    assert other == pytest.approx(expected, abs=1e-12)
    assert one == pytest.approx(sum(random_depth(2 * place / [L, W], 20e-6, 7, s) for s in (0, 1)), abs=1e-12)
    assert gap_of(replace(form, flatness=10e-6))[1] == pytest.approx(one / 2, rel=1e-9)
    assert np.abs(gap_of(replace(form, seed=8))[1] - one).max() > 1e-6


@pytest.mark.parametrize("scale", [1e-2, 30.0])
def test_forms_scale_with_the_structure(scale):
    """The same structure and form in another unit of length: the same gaps in that unit."""
    form = Form(crown_along=14e-6, twist=3e-6, wave=2e-6, wave_length=0.03, flatness=9e-6)
    grown = Form(**{n: getattr(form, n) * scale for n in ("crown_along", "twist", "wave", "wave_length", "flatness")})
    mesh = stacked()
    bigger = replace(mesh, points=mesh.points * scale)
    interface = plates(mesh).joints[0].interface
    axes = FaceAxes.of(mesh, FACES, interface)
    there = FaceAxes.of(bigger, FACES, plates(bigger).joints[0].interface)
    assert grown.at(interface.positions * scale, there) == pytest.approx(scale * form.at(interface.positions, axes))


def test_the_longer_side_is_found_in_any_direction():
    mesh = stacked()
    turn = np.linalg.qr(np.random.default_rng(2).standard_normal((3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    turned = replace(mesh, points=mesh.points @ turn.T)
    axes = FaceAxes.of(turned, FACES, plates(turned).joints[0].interface)
    assert axes.lengths == pytest.approx((L, W))
    assert abs(axes.x_axis @ turn[:, 0]) == pytest.approx(1)
    assert axes.normal == pytest.approx(turn[:, 2])
    assert np.cross(axes.normal, axes.x_axis) == pytest.approx(axes.y_axis)
    assert axes.origin == pytest.approx(turn @ [L / 2, W / 2, 0.01])


def test_a_square_face_asks_which_way():
    mesh = stacked(size=(0.04, 0.04, 0.01))
    interface = plates(mesh).joints[0].interface
    with pytest.raises(faying.InputError, match=r"as long as wide \(40 mm x 40 mm\); say which way with along"):
        Form(crown_along=1e-6).on(interface, mesh, FACES)
    laid = Form(crown_along=1e-6, along=(0, 1, 0)).on(interface, mesh, FACES)
    assert laid.gap == pytest.approx(1e-6 * ((interface.positions[:, 1] - 0.02) / 0.02) ** 2, abs=1e-16)
    with pytest.raises(faying.InputError, match="is at right angles to the faces"):
        Form(crown_along=1e-6, along=(0, 0, 1)).on(interface, mesh, FACES)


def test_both_faces_measured_give_their_gap():
    """A crowned first face and a twisted second one, measured with tilt, offset and their own axes."""
    mesh = stacked()
    interface = plates(mesh).joints[0].interface
    x, y = np.meshgrid(np.linspace(0, L, 41), np.linspace(0, W, 31), indexing="ij")
    s, t = 2 * x / L - 1, 2 * y / W - 1
    places = np.stack([x, y], -1).reshape(-1, 2)
    crowned = FaceMap(places=places, heights=(-8e-6 * s**2 + 1e-3 * x + 5e-5).ravel(), origin=(0.0, 0.0, 0.01))
    # seen from below x still goes to the right, so y goes the other way
    second = FaceMap(places=places, heights=(3e-6 * s * t - 2e-4 * y).ravel())
    gap = Form(first=crowned, second=second).on(interface, mesh, FACES).gap - interface.gap
    s, t = (2 * interface.positions[:, :2] / [L, W] - 1).T
    assert gap == pytest.approx(8e-6 * s**2 + 3e-6 + 3e-6 * s * t, abs=1e-7)  # linear between points 2 mm apart
    assert crowned.placed(FaceAxes.of(mesh, FACES, interface), np.array([0, 0, 1.0])).y_axis == pytest.approx((0, 1, 0))


def test_a_scan_is_averaged_to_its_form(tmp_path):
    generator = np.random.default_rng(3)
    x = np.mgrid[0:300, 0:450][1]
    heights = 5e-6 * (x / 225 - 1) ** 2 + generator.normal(0, 1e-6, x.shape)
    heights[20:23, 40:44] = np.nan
    path = tmp_path / "face.x3p"
    faying.write_scan(faying.Scan(heights=heights, spacing=(2e-4, 1e-4)), path)
    places, found = read_heights(path)
    assert len(found) <= 150 * 150
    assert found == pytest.approx(5e-6 * (places[:, 0] / 2e-4 / 225 - 1) ** 2, abs=3e-6)
    assert np.std(found - 5e-6 * (places[:, 0] / 2e-4 / 225 - 1) ** 2) < 0.5e-6  # six points a cell
    fit = faying.fit_form(places, found)
    assert fit.crown_along == pytest.approx(-5e-6, rel=0.02)
    assert abs(fit.crown_across) < 1e-7


def test_one_of_several_maps_of_heights_is_named(tmp_path, capsys):
    """A container of two scans, a bowl of 10 um and one of twice that; `faying form` takes the one that is named."""
    pytest.importorskip("SurfaceTopography", reason="reads containers")
    y, x = np.mgrid[-1:1:32j, -1:1:32j]
    lines = ["surfaces:", "- name: one", "  topographies:"]
    path = tmp_path / "two.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for k in (1, 2):
            lines += [f"  - {{name: map {k}, datafile: {{original: {k}.txt}}, unit: um, size: [8000, 8000]}}"]
            archive.writestr(
                f"{k}.txt", "\n".join(" ".join(map(str, row)) for row in (10 * k * (x**2 + y**2)).tolist())
            )
        archive.writestr("meta.yml", "\n".join(lines) + "\n")
    with pytest.raises(faying.InputError, match="holds 2 maps of heights: 'map 1', 'map 2'"):
        read_heights(path)
    one, two = (read_heights(path, channel=f"map {k}")[1] for k in (1, 2))
    assert np.ptp(two) == pytest.approx(2 * np.ptp(one))
    with pytest.raises(SystemExit, match="0"):
        main(["form", str(path), "--channel", "map 2", "--json"])
    assert json.loads(capsys.readouterr().out)["crown_along"]["values"] == pytest.approx(-20e-6)


def test_a_fit_finds_the_shapes_of_a_form():
    form = Form(crown_along=14e-6, crown_across=-3e-6, twist=4e-6)
    place, gap = gap_of(form, stacked(counts=(8, 6, 1)))
    corners = np.array([[-L / 2, -W / 2], [L / 2, W / 2], [-L / 2, W / 2], [L / 2, -W / 2]])
    ends = 14e-6 + 4e-6 * (1 + np.sign(corners[:, 0] * corners[:, 1]))  # the crown across is hollow: 0 at its ends
    place, gap = np.concatenate([place, corners]), np.concatenate([gap, ends])
    for turned in (place, place[:, ::-1] * [-1, 1]):  # a quarter turn of the instrument changes nothing
        fit = faying.fit_form(turned, gap, is_gap=True)
        found = fit.crown_along, fit.crown_across, fit.twist
        assert found == pytest.approx((14e-6, -3e-6, 4e-6), rel=1e-9)
        assert fit.rest < 1e-12


def test_messages(tmp_path):
    with pytest.raises(faying.InputError, match="wave needs its length"):
        Form(wave=1e-6)
    with pytest.raises(faying.InputError, match=r"seed = 1\.5; give a whole number"):
        Form(seed=1.5)
    with pytest.raises(faying.InputError, match="flatness = -1e-06 m; it must be at least 0"):
        Form(flatness=-1e-6)
    with pytest.raises(faying.InputError, match="3 points: four or more"):
        minimum_zone(np.eye(3)[:, :2], np.zeros(3))
    with pytest.raises(faying.InputError, match="points on one line"):
        minimum_zone(np.outer(np.arange(5.0), [1, 2]), np.zeros(5))
    file = tmp_path / "a.csv"
    file.write_text("0,0,1\n")
    with pytest.raises(faying.InputError, match="states no unit of x; give xy_unit"):
        read_heights(file, z_unit="um")
    assert minimum_zone(np.random.default_rng(0).uniform(0, 1, (9, 2)), np.full(9, 3.0)).flatness == 0
    assert isinstance(GapMap(places=np.eye(2)[[0, 1, 0, 1]] * [[1], [1], [2], [3]], gaps=np.zeros(4)), GapMap)
