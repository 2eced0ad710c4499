"""Texts and archives as instruments and people write them: positions in matrices, more columns, missing heights."""

import gzip
import io
import re
import struct
import zipfile
import zlib

import numpy as np
import pytest

from faying import InputError, ReadError, read_scan
from faying.surface.files.write import write_scan
from faying.surface.scan import Scan

RNG = np.random.default_rng(8)
NY, NX = 24, 32
WAVES = np.sin(np.arange(NX) / 2.0) + 0.4 * np.cos(np.arange(NY)[:, None] / 3) + 0.1 * RNG.normal(size=(NY, NX))  # um
STEP = 1.5  # um


def rows(heights=WAVES, order=("y", "x"), skip=()):
    """Lines x, y, z, the inner index last in `order`."""
    ny, nx = heights.shape
    cells = [(i, j) for j in range(ny) for i in range(nx)]
    if order == ("x", "y"):
        cells = [(i, j) for i in range(nx) for j in range(ny)]
    return [(STEP * i, STEP * j, heights[j, i]) for i, j in cells if (i, j) not in skip]


def text(lines, mark=","):
    return "\n".join(mark.join("" if np.isnan(v) else f"{v:.9g}" for v in row) for row in lines) + "\n"


def read(path, content, **given):
    path.write_text(content)
    return read_scan(path, **({"xy_unit": "um", "z_unit": "um"} | given))


def matrix(path, table):
    return read(path, text(table), xy_unit=None, size=(NX * STEP * 1e-6, NY * STEP * 1e-6))


@pytest.mark.parametrize(
    ("x", "y", "match"),
    [
        (STEP * np.arange(NX), STEP * np.arange(NY), "the first row and the first column of the matrix rise evenly"),
        (None, 1 + np.arange(NY), "the first column of the matrix rises evenly"),
        (None, -0.37 * np.arange(NY), "the first column of the matrix rises evenly"),
        (100 + 0.25 * np.arange(NX), None, "the first row of the matrix rises evenly"),
    ],
)
def test_positions_in_a_matrix_are_refused(tmp_path, x, y, match):
    table = WAVES if y is None else np.column_stack([y, WAVES])
    if x is not None:
        table = np.vstack([x if y is None else np.append(0.0, x), table])
    with pytest.raises(ReadError, match=match):
        matrix(tmp_path / "m.csv", table)


@pytest.mark.parametrize("corner", ["y/x", "um", ""])
@pytest.mark.parametrize("mark", ["\t", ";", ","])
@pytest.mark.parametrize("down", [1, -1])
def test_positions_around_a_corner_are_no_heights(tmp_path, corner, mark, down):
    """Tabs, semicolons and commas; rows from the top down are put in the order of their positions."""
    x, y = 0.25 + STEP * np.arange(NX), -3 + 2 * STEP * np.arange(NY)
    head = mark.join([corner, *(f"{value:g}" for value in x)])
    content = head + "\n" + text(np.column_stack([y, WAVES])[::down], mark)
    scan = read(tmp_path / "m.txt", content)
    np.testing.assert_allclose(scan.heights, 1e-6 * WAVES, rtol=1e-7)
    assert scan.spacing == pytest.approx((STEP * 1e-6, 2 * STEP * 1e-6))
    sized = read(tmp_path / "m.txt", content, xy_unit=None, spacing=(2e-6, 3e-6))
    np.testing.assert_array_equal(sized.heights, scan.heights)
    assert sized.spacing == (2e-6, 3e-6)
    with pytest.raises(InputError, match="give xy_unit"):
        read(tmp_path / "m.txt", content, xy_unit=None)
    with pytest.raises(InputError, match="leave out channel"):
        read(tmp_path / "m.txt", content, channel="A")


def test_a_row_that_is_left_out_stays_empty_and_one_twice_is_refused(tmp_path):
    """Far down a file, where nobody has looked at the positions while its layout was found."""
    heights = np.random.default_rng(1).normal(size=(60, 8))
    rows = [f"{k}," + ",".join(f"{value:.9g}" for value in row) for k, row in enumerate(heights)]
    head = "um," + ",".join(str(k) for k in range(8))
    found = read(tmp_path / "m.csv", "\n".join([head, *rows[:50], *rows[51:]]) + "\n").heights
    assert np.isnan(found[50]).all()
    np.testing.assert_allclose(np.delete(found, 50, 0), 1e-6 * np.delete(heights, 50, 0), rtol=1e-7)
    with pytest.raises(ReadError, match="have one position"):
        read(tmp_path / "m.csv", "\n".join([head, *rows[:50], *rows[49:]]) + "\n")


def test_scans_packed_by_gzip_are_read(tmp_path):
    for name, content in (("a.csv", text(rows()).encode()), ("a.x3p", None)):
        plain = tmp_path / name
        if content is None:
            write_scan(Scan(heights=1e-6 * WAVES, spacing=(1e-6, 2e-6)), plain)
            units = {}
        else:
            plain.write_bytes(content)
            units = {"xy_unit": "um", "z_unit": "um"}
        packed = tmp_path / f"{name}.gz"
        packed.write_bytes(gzip.compress(plain.read_bytes()))
        scan = read_scan(packed, **units)
        np.testing.assert_array_equal(scan.heights, read_scan(plain, **units).heights)
        assert scan.source == str(packed)
        packed.write_bytes(packed.read_bytes()[:-40])
        with pytest.raises(ReadError, match=rf"{name}.gz: it is compressed, and damaged or cut short"):
            read_scan(packed, **units)
    (tmp_path / "b.csv.gz").write_bytes(gzip.compress(b"0,0,1\n1,0,2\n0,1,3\nx,y,z\n"))
    with pytest.raises(ReadError, match=rf"^{re.escape(str(tmp_path))}/b.csv.gz: line 4"):
        read_scan(tmp_path / "b.csv.gz", xy_unit="um", z_unit="um")


def digital_surf(heights, step, unit=b"\xb5m", pieces=0):
    """A file of Digital Surf of heights in whole nm, with points packed in so many pieces, none packed where 0."""
    values = np.rint(heights * 1e9).astype("<i4")
    (ny, nx), data = values.shape, values.tobytes()
    head = struct.pack(
        "<12s4H30s30s5H8xH", b"DSCOMPRESSED" if pieces else b"DIGITAL SURF", *[0, 1, 1, 2], *[b""] * 2, *[0] * 5, 32
    )
    head += struct.pack("<4iI3f", values.min(), values.max(), nx, ny, nx * ny, 1e6 * step, 1e6 * step, 1e-3)
    head += struct.pack("<9s39x" + "16s" * 6, b"", *[unit] * 6) + struct.pack(
        "<3f3H12x7Hf10x", 1, 1, 1, *[0] * 3, *[1] * 6, 2024, 0
    )
    head += struct.pack("<2H128s3f34x", 3, 5, b"", 0, 0, 0) + b"com" + b"priva"
    if not pieces:
        return head + data
    cuts = [data[k * len(data) // pieces : (k + 1) * len(data) // pieces] for k in range(pieces)]
    packed = [zlib.compress(cut) for cut in cuts]
    sizes = b"".join(struct.pack("<2I", len(cut), len(some)) for cut, some in zip(cuts, packed, strict=True))
    return head + struct.pack("<I", pieces) + sizes + b"".join(packed)


@pytest.mark.parametrize("unit", [b"\xb5m", "µm".encode(), b"um"])
def test_digital_surf_with_packed_points(tmp_path, unit):
    pytest.importorskip("SurfaceTopography", reason="reads Digital Surf")
    plain, path = tmp_path / "plain.sur", tmp_path / "packed.sur"
    plain.write_bytes(digital_surf(1e-6 * WAVES, 2e-6, unit))
    expected = read_scan(plain)
    assert np.abs(expected.heights - 1e-6 * WAVES).max() < 0.51e-9
    for pieces in (1, 3):
        path.write_bytes(digital_surf(1e-6 * WAVES, 2e-6, unit, pieces))
        scan = read_scan(path)
        np.testing.assert_array_equal(scan.heights, expected.heights)
        assert scan.spacing == pytest.approx((2e-6, 2e-6))
    path.write_bytes(path.read_bytes()[:-30])
    with pytest.raises(ReadError, match=r"packed.sur: it is compressed, and damaged or cut short"):
        read_scan(path)


def test_a_unit_that_is_none_is_said_with_its_file(tmp_path):
    pytest.importorskip("SurfaceTopography", reason="reads Digital Surf")
    path = tmp_path / "a.sur"
    path.write_bytes(digital_surf(1e-6 * WAVES, 2e-6, b"V"))
    with pytest.raises(InputError, match=r"a\.sur: its unit = .V. is not a unit like m"):
        read_scan(path)


def test_one_of_several_maps_of_heights_is_to_be_named(tmp_path):
    h5py = pytest.importorskip("h5py")
    pytest.importorskip("SurfaceTopography", reason="reads HDF5")
    path = tmp_path / "two.h5"
    with h5py.File(path, "w") as file:
        file["forward"], file["backward"] = WAVES, -WAVES
    units = {"size": (NX * STEP * 1e-6, NY * STEP * 1e-6), "z_unit": "um"}
    with pytest.raises(InputError, match=r"two.h5 holds 2 maps of heights: .*'forward'.*name one.*--channel"):
        read_scan(path, **units)
    with pytest.raises(InputError, match="there is no 'up'"):
        read_scan(path, channel="up", **units)
    found = [read_scan(path, channel=name, **units).heights for name in ("forward", "backward")]
    np.testing.assert_array_equal(found[0], -found[1])
    assert np.ptp(found[0]) == pytest.approx(1e-6 * np.ptp(WAVES))


@pytest.mark.parametrize("count", [1, 2])
def test_containers_of_contact_engineering(tmp_path, count):
    pytest.importorskip("SurfaceTopography", reason="reads containers")
    lines = ["surfaces:", "- name: one", "  topographies:"]
    path = tmp_path / "container.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for k in range(count):
            lines += [
                f"  - name: scan {k}",
                f"    datafile: {{original: {k}.txt}}",
                "    unit: um",
                "    size: [64, 48]",
                *["    detrend_mode: curvature"] * k,  # of the view, not of the heights
            ]
            archive.writestr(f"{k}.txt", text((k + 1) * WAVES, " "))
        archive.writestr("meta.yml", "\n".join(lines) + "\n")
    if count > 1:
        with pytest.raises(InputError, match="2 maps of heights: 'scan 0', 'scan 1'"):
            read_scan(path)
    scan = read_scan(path, channel=f"scan {count - 1}")
    assert sorted(scan.heights.shape) == sorted(WAVES.shape)
    assert np.nanstd(scan.heights) == pytest.approx(count * 1e-6 * WAVES.std())
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("meta.yml", "surfaces: 7\n")
    with pytest.raises(ReadError, match="the container is damaged"):
        read_scan(path)


def test_matrices_of_heights_alone_are_read(tmp_path):
    tilted = WAVES + 0.3 * np.arange(NX) - 0.2 * np.arange(NY)[:, None]
    plane = np.add.outer(0.2 * np.arange(NY), 0.1 * np.arange(NX))
    for table in (WAVES, tilted, plane):
        np.testing.assert_allclose(matrix(tmp_path / "m.csv", table).heights, 1e-6 * table, rtol=1e-7, atol=1e-15)


@pytest.mark.parametrize("order", [("y", "x"), ("x", "y")])
@pytest.mark.parametrize("more", [1, 2, 3])
def test_columns_beyond_x_y_z_are_refused(tmp_path, order, more):
    lines = [(*row, *([7.0 + k] * more)) for k, row in enumerate(rows(order=order))]
    with pytest.raises(ReadError, match=f"rows of {3 + more} numbers, .* x, y, z and {more} column"):
        read(tmp_path / "a.csv", text(lines))
    with pytest.raises(ReadError, match="the column .intensity. *.*which is not read"):
        read(tmp_path / "a.csv", "x (um),y (um),z (um),intensity\n" + text(lines), xy_unit=None, z_unit=None)


@pytest.mark.parametrize(
    ("head", "order", "factors", "given"),
    [
        ("z [nm],y [mm],x [um]\n", (2, 1, 0), (1, 1e-3, 1e3), {"xy_unit": None, "z_unit": None}),
        ("Y,X,Z\n", (1, 0, 2), (1, 1, 1), {}),
        ("x/um,y/um,Height/um\n", (0, 1, 2), (1, 1, 1), {"xy_unit": None, "z_unit": None}),
    ],
)
def test_points_are_read_by_the_names_of_their_heading(tmp_path, head, order, factors, given):
    lines = [tuple(row[k] * factors[k] for k in order) for row in rows()]
    scan = read(tmp_path / "a.csv", head + text(lines), **given)
    np.testing.assert_allclose(scan.heights, 1e-6 * WAVES, rtol=1e-7)
    assert scan.spacing == pytest.approx((1e-6 * STEP, 1e-6 * STEP))


def test_a_unit_for_some_columns_only_is_refused(tmp_path):
    with pytest.raises(ReadError, match='the column "y" of the heading states no unit'):
        read(tmp_path / "a.csv", "x [um],y,z [um]\n" + text(rows()), xy_unit=None, z_unit=None)


@pytest.mark.parametrize("missing", [1, 20, 40])
def test_heights_that_are_blank_from_the_first_line_on(tmp_path, missing):
    table = WAVES.copy()
    table.ravel()[:missing] = np.nan
    scan = read(tmp_path / "a.csv", text(rows(table)))
    np.testing.assert_array_equal(np.isnan(scan.heights), np.isnan(table))
    np.testing.assert_allclose(scan.heights[~np.isnan(table)], 1e-6 * table[~np.isnan(table)], rtol=1e-7)


def test_a_comma_at_the_end_of_each_line_is_no_column(tmp_path):
    scan = read(tmp_path / "a.csv", text(rows()).replace("\n", ",\n"))
    np.testing.assert_allclose(scan.heights, 1e-6 * WAVES, rtol=1e-7)


@pytest.mark.parametrize("order", [("y", "x"), ("x", "y")])
def test_holes_of_the_last_row_are_no_cut(tmp_path, order):
    hole = {(NX - 1, NY - 5)} if order == ("x", "y") else {(5, NY - 1), (6, NY - 1)}
    scan = read(tmp_path / "a.csv", text(rows(order=order, skip=hole)))
    assert scan.heights.shape == (NY, NX)
    assert {(int(i), int(j)) for j, i in np.argwhere(np.isnan(scan.heights))} == hole
    lines = rows(order=order)
    for lost in (1, 7):
        with pytest.raises(ReadError, match="the file is cut off"):
            read(tmp_path / "a.csv", text(lines[:-lost]))


@pytest.mark.parametrize("value", [-9999.0, 0.0, 1e4, -79.5])
@pytest.mark.parametrize("where", ["patch", "row"])
def test_one_value_far_from_all_others_is_missing(tmp_path, value, where):
    true = 79.0 + WAVES
    gone = np.zeros(WAVES.shape, bool)
    gone[(slice(3, 9), slice(10, 20)) if where == "patch" else 0] = True
    scan = read(tmp_path / "a.csv", text(rows(np.where(gone, value, true))))
    np.testing.assert_array_equal(np.isnan(scan.heights), gone)
    assert f"{gone.sum()} points are exactly" in scan.notes[0]
    assert "taken as missing" in scan.notes[0]


def test_a_value_that_most_points_have_is_missing_where_it_is_very_far(tmp_path):
    for far, missing in ((-1000.0, 14 * NX), (-8.0, 0)):
        scan = read(tmp_path / "a.csv", text(rows(np.where(np.arange(NY)[:, None] < 14, far, WAVES))))
        assert np.isnan(scan.heights).sum() == missing
    nearly_all = np.where(np.arange(NY)[:, None] < NY - 1, -1000.0, WAVES)
    assert not np.isnan(read(tmp_path / "a.csv", text(rows(nearly_all))).heights).any()


def test_values_on_both_ends_are_missing(tmp_path):
    table = WAVES.copy()
    table[2, 3:8], table[10, 3:8] = -1e3, 1e3
    scan = read(tmp_path / "a.csv", text(rows(table)))
    assert np.isnan(scan.heights).sum() == 10


@pytest.mark.parametrize(
    "heights",
    [
        np.maximum(WAVES, -0.8),  # clipped valleys
        np.where(np.arange(NX) % 8 < 3, 0.0, 1.0) + 0 * WAVES,  # a grating without noise
        WAVES + np.where((np.arange(NX) == 4) & (np.arange(NY)[:, None] == 7), 500.0, 0),  # one spike
        WAVES + 30.0 * (np.arange(NX) > 20),  # a step with its roughness
    ],
)
def test_other_heights_stay(tmp_path, heights):
    scan = read(tmp_path / "a.csv", text(rows(heights)))
    assert not np.isnan(scan.heights).any()
    assert not scan.notes


@pytest.mark.parametrize("prefix", ["sample/", "./", "a/b/", ""])
def test_x3p_archives_in_a_folder(tmp_path, prefix):
    plain = tmp_path / "plain.x3p"
    write_scan(Scan(heights=1e-6 * WAVES, spacing=(1e-6, 2e-6)), plain)
    path = tmp_path / "made.x3p"
    with zipfile.ZipFile(plain) as old, zipfile.ZipFile(path, "w") as new:
        for name in old.namelist():
            new.writestr(prefix + name, old.read(name))
        if prefix:
            new.writestr(f"__MACOSX/{prefix}main.xml", b"resource fork")
    np.testing.assert_array_equal(read_scan(path).heights, read_scan(plain).heights)
    path.rename(tmp_path / "made.zip")
    np.testing.assert_array_equal(read_scan(tmp_path / "made.zip").heights, read_scan(plain).heights)


def test_uneven_steps_of_a_line_are_interpolated(tmp_path):
    pytest.importorskip("SurfaceTopography", reason="reads such lines")
    x = np.cumsum(np.tile([0.55, 1.45], 100))
    path = tmp_path / "line.csv"
    buffer = io.StringIO("X_(microns),y1\n")
    path.write_text(buffer.getvalue() + text(np.column_stack([x - x[0], 0.05 * (x - x[0])])))
    line = read_scan(path, xy_unit="um", z_unit="um")
    straight = np.polyval(np.polyfit(np.arange(200), line.heights, 1), np.arange(200))
    assert np.abs(line.heights - straight).max() < 1e-15
    assert "the steps of the line are 5.5e-07 to 1.45e-06 m" in line.notes[0]
    own = read(tmp_path / "own.csv", "x,z\n" + text(np.column_stack([x - x[0], 0.05 * (x - x[0])])[::-1]))
    np.testing.assert_allclose(own.heights, line.heights, rtol=1e-12, atol=1e-20)
    assert own.spacing == pytest.approx(line.spacing)
    assert "the steps of the line are 5.5e-07 to 1.45e-06 m" in own.notes[0]
