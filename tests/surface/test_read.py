"""Files in and out: X3P, text, units, faults."""

import hashlib
import importlib.util
import zipfile
from pathlib import Path

import numpy as np
import pytest

from faying import InputError, ReadError, Scan, fit_fractal, read_scan
from faying.files import end_of
from faying.surface.files.read import plausible
from faying.surface.files.write import write_scan
from faying.surface.scan import Profile
from faying.surface.synthesize import spectral
from tests.helpers.imperfect import with_missing


@pytest.fixture
def rough():
    return with_missing(spectral((40, 56), spacing=(2e-6, 3e-6), D=2.4, Rq=1e-6, seed=1), share=0.02)


@pytest.mark.parametrize(("precision", "tolerance"), [("F", 1e-6), ("D", 0.0)])
def test_x3p_returns_what_was_written(rough, tmp_path, precision, tolerance):
    back = read_scan(write_scan(rough, tmp_path / "a.x3p", precision=precision))
    assert isinstance(back, Scan)
    assert back.spacing == pytest.approx(rough.spacing, rel=1e-15)
    assert np.array_equal(np.isnan(back.heights), np.isnan(rough.heights))
    assert np.nanmax(np.abs(back.heights - rough.heights)) <= tolerance * 1e-5


@pytest.mark.parametrize(("precision", "steps"), [("I", 2**16), ("L", 2**32)])
def test_integer_x3p_is_true_to_half_a_step(tmp_path, precision, steps):
    scan = spectral((40, 40), spacing=1e-6, D=2.4, Rq=1e-6, seed=1)
    back = read_scan(write_scan(scan, tmp_path / "a.x3p", precision=precision))
    assert np.abs(back.heights - scan.heights).max() <= 0.51 * np.ptp(scan.heights) / (steps - 4)


def test_writing_twice_gives_the_same_bytes(rough, tmp_path):
    a, b = write_scan(rough, tmp_path / "a.x3p"), write_scan(rough, tmp_path / "b.x3p")
    assert a.read_bytes() == b.read_bytes()


def test_profiles_go_through_x3p_and_text(tmp_path):
    line = spectral(300, spacing=0.5e-6, D=2.4, Rq=1e-6)
    back = read_scan(write_scan(line, tmp_path / "a.x3p", precision="D"))
    assert isinstance(back, Profile)
    assert np.array_equal(back.heights, line.heights)
    text = read_scan(write_scan(line, tmp_path / "a.txt", xy_unit="um", z_unit="nm"), xy_unit="um", z_unit="nm")
    assert isinstance(text, Profile)
    assert text.spacing == pytest.approx(line.spacing, rel=1e-9)
    assert np.allclose(text.heights, line.heights, atol=1e-16)


def test_text_returns_what_was_written_in_any_order_of_lines(rough, tmp_path):
    path = write_scan(rough, tmp_path / "a.csv", xy_unit="mm", z_unit="um")
    lines = path.read_text().splitlines()
    np.random.default_rng(0).shuffle(lines)
    path.write_text("\n".join(lines))
    back = read_scan(path, xy_unit="mm", z_unit="um")
    assert back.spacing == pytest.approx(rough.spacing, rel=1e-6)
    assert np.allclose(back.heights, rough.heights, atol=1e-14, equal_nan=True)


@pytest.mark.parametrize("separator", [",", ";", " ", "\t"])
def test_separators(tmp_path, separator):
    path = tmp_path / "a.txt"
    path.write_text("\n".join(separator.join(map(str, (x, y, x + 2 * y))) for y in range(4) for x in range(3)))
    assert read_scan(path, "um", "um").heights[3, 2] == pytest.approx(8e-6)


def test_text_without_unit_is_asked_for_it(rough, tmp_path):
    path = write_scan(rough, tmp_path / "a.csv", xy_unit="mm", z_unit="um")
    with pytest.raises(InputError, match=r"states no unit; give xy_unit and z_unit.*--xy-unit mm --z-unit um"):
        read_scan(path)
    with pytest.raises(InputError, match="give z_unit"):
        read_scan(path, xy_unit="mm")
    with pytest.raises(InputError, match="xy_unit"):
        read_scan(path, xy_unit="kg", z_unit="um")


def test_a_unit_against_the_file_is_refused(rough, tmp_path):
    path = write_scan(rough, tmp_path / "a.x3p")
    with pytest.raises(InputError, match="states its units"):
        read_scan(path, xy_unit="mm", z_unit="um")


@pytest.mark.parametrize("wrong", [1e9, 1e-9])
def test_a_unit_wrong_by_1e9_is_noticed(tmp_path, wrong):
    scan = spectral((40, 40), spacing=5e-6, D=2.4, Rq=1e-6)
    heights = write_scan(scan.with_heights(scan.heights * wrong), tmp_path / "z.x3p", precision="D")
    with pytest.raises(ReadError, match="check the unit"):
        read_scan(heights)
    lateral = write_scan(Scan(heights=scan.heights, spacing=(5e-6 * wrong, 5e-6 * wrong)), tmp_path / "x.x3p")
    with pytest.raises(ReadError, match="check the unit"):
        read_scan(lateral)
    plausible(scan)


def test_one_height_that_no_face_has_is_refused(tmp_path):
    scan = spectral((40, 40), spacing=5e-6, D=2.4, Rq=1e-6)
    heights = scan.heights.copy()
    heights[3, 7] = 1e12
    with pytest.raises(ReadError, match="one height of 1e.12 m on a scan of 0.0002 m; the number is damaged"):
        plausible(scan.with_heights(heights))
    heights[3, 7] = 1e-4  # a speck of dust, which the treatment of spikes finds
    plausible(scan.with_heights(heights))


def test_missing_empty_and_unknown_files(tmp_path):
    with pytest.raises(ReadError, match="no such file"):
        read_scan(tmp_path / "none.x3p")
    with pytest.raises(ReadError, match="not a file"):
        read_scan(tmp_path)
    empty = tmp_path / "empty.csv"
    empty.write_text("\n")
    with pytest.raises(ReadError, match="empty"):
        read_scan(empty)
    other = tmp_path / "a.x3p"
    other.write_bytes(b"something else entirely")
    with pytest.raises(ReadError, match="not an X3P"):
        read_scan(other)
    strange = tmp_path / "a.xyzzy"
    strange.write_bytes(bytes(range(256)) * 10)
    with pytest.raises(ReadError, match=r"SurfaceTopography|no format|damaged"):
        read_scan(strange)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("0,0,1\n1,0,2\n0,1,3\n", "3 points"),
        ("0,0,1\n1,0,2\n0,1,3\nx,y,z\n", "line 4"),
        ("0,0,1\n1,0,2\n0,1,3\n1,1,4\n2,0,5\n", "cut off"),
        ("0,0,1\n1,0,2\n0,1,3\n1.4,1,4\n1.7,2,1\n", "not evenly spaced|do not fill"),
        ("0,0,1\n1,0,2\n2,0,3\n3,0,4\n", "all y are the same"),
        ("nan,0,1\n1,0,2\n0,1,3\n1,1,4\n", "some x are missing"),
        ("0,1\n1,2\n1,3\n2,4\n", "share one x"),
        ("0,0,1\n1,0,2\n0,1,3\n1,1,4\n1,1,4\n", "once each"),
    ],
)
def test_faulty_text(tmp_path, text, match):
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(ReadError, match=match):
        read_scan(path, "um", "um")


def test_all_missing_text(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("\n".join(f"{x},{y},nan" for y in range(4) for x in range(4)))
    with pytest.raises(ReadError, match="every point is missing"):
        read_scan(path, "um", "um")


def repacked(source, target, **changes):
    """Copy an X3P with some members replaced (None leaves one out)."""
    with zipfile.ZipFile(source) as old, zipfile.ZipFile(target, "w") as new:
        for name in old.namelist():
            content = changes.get(name.replace("/", "_").replace(".", "_"), old.read(name))
            if content is not None:
                new.writestr(name, content)
    return target


def xml_of(path):
    return zipfile.ZipFile(path).read("main.xml").decode()


def test_damaged_x3p(rough, tmp_path):
    good = write_scan(rough, tmp_path / "good.x3p")
    xml = xml_of(good)
    cases = {
        "has no main.xml": {"main_xml": None},
        "has no bindata": {"bindata_data_bin": None},
        "checksum": {"bindata_data_bin": b"\0" * (40 * 56 * 4)},
        "not well-formed": {"main_xml": xml[:-40]},
        "document type": {"main_xml": xml.replace("<p:ISO", '<!DOCTYPE a [<!ENTITY b "c">]><p:ISO', 1)},
        "whole numbers": {"main_xml": xml.replace("<SizeX>56", "<SizeX>5.6")},
        "cut off": {"main_xml": xml.replace("<SizeX>56", "<SizeX>57")},
        "more than can be read": {"main_xml": xml.replace("<SizeX>56", "<SizeX>99999999")},
        "data type 'Q'": {"main_xml": xml.replace("<DataType>F<", "<DataType>Q<")},
        "only evenly spaced": {"main_xml": xml.replace("<CX><AxisType>I", "<CX><AxisType>A")},
        "is not a number": {"main_xml": xml.replace("<Increment>2e-06", "<Increment>two")},
        "positive and finite": {"main_xml": xml.replace("<Increment>2e-06", "<Increment>-2e-06")},
        "lacks Record1/Axes/CX/Increment": {"main_xml": xml.replace("<Increment>2e-06</Increment>", "")},
    }
    for number, (match, change) in enumerate(cases.items()):
        with pytest.raises(ReadError, match=match):
            read_scan(repacked(good, tmp_path / f"{number}.x3p", **change))
    cut = tmp_path / "cut.x3p"
    cut.write_bytes(good.read_bytes()[:-300])
    with pytest.raises(ReadError, match="cut off or damaged"):
        read_scan(cut)


def test_an_increment_of_z_is_for_whole_numbers_alone(rough, tmp_path):
    """The schema of openGPS: a multiplier of integers; heights in decimals are in metres."""
    good = write_scan(rough, tmp_path / "good.x3p", precision="D")
    xml = zipfile.ZipFile(good).read("main.xml").decode()
    for step, notes in (("1", 0), ("1e-06", 1)):
        stated = xml.replace("</DataType></CZ>", f"</DataType><Increment>{step}</Increment></CZ>")
        assert stated != xml
        back = read_scan(repacked(good, tmp_path / "stated.x3p", main_xml=stated))
        np.testing.assert_array_equal(back.heights, rough.heights)
        assert len(back.notes) == notes


def test_x3p_that_is_neither_a_map_nor_one_profile_is_refused_and_a_turn_is_told(rough, tmp_path):
    good = write_scan(rough, tmp_path / "good.x3p")
    xml = xml_of(good)
    for kind in ("PRF", "PCL"):
        other = repacked(good, tmp_path / f"{kind}.x3p", main_xml=xml.replace(">SUR<", f">{kind}<"))
        with pytest.raises(ReadError, match=f"FeatureType {kind} of"):
            read_scan(other)
    for last, notes in (("1.0", 0), ("-1", 1)):
        turn = "".join(f"<r>{v}</r>" for v in (*"100010", "0", "0", last))
        turned = xml.replace("</Axes>", f"<Rotation>{turn}</Rotation></Axes>")
        assert len(read_scan(repacked(good, tmp_path / "turned.x3p", main_xml=turned)).notes) == notes


def test_x3p_with_a_mask_and_with_heights_in_the_xml(tmp_path):
    scan = spectral((8, 12), spacing=1e-6, D=2.4, Rq=1e-6)
    good = write_scan(scan, tmp_path / "good.x3p", precision="D")
    xml = xml_of(good)
    valid = np.ones((8, 12), bool)
    valid[2, 3] = valid[7, 11] = False
    with zipfile.ZipFile(good, "a") as archive:
        archive.writestr("bindata/valid.bin", np.packbits(valid.ravel(), bitorder="little").tobytes())
    link = "<PointDataLink>bindata/data.bin</PointDataLink>"
    masked = xml.replace(link, link + "<ValidPointsLink>bindata/valid.bin</ValidPointsLink>")
    back = read_scan(repacked(good, tmp_path / "masked.x3p", main_xml=masked))
    assert np.array_equal(~np.isnan(back.heights), valid)
    listed = "<DataList>" + "".join(f"<Datum>{v!r}</Datum>" for v in map(float, scan.heights.ravel())) + "</DataList>"
    start, end = xml.index("<DataLink>"), xml.index("</DataLink>") + len("</DataLink>")
    inline = xml[:start] + listed + xml[end:]
    back = read_scan(repacked(good, tmp_path / "list.x3p", main_xml=inline))
    assert np.array_equal(back.heights, scan.heights)
    with pytest.raises(ReadError, match="lists 95 heights"):
        read_scan(
            repacked(
                good,
                tmp_path / "short.x3p",
                main_xml=inline.replace("<Datum>", "<Other>", 1).replace("</Datum>", "</Other>", 1),
            )
        )


def test_writing_refuses_what_it_cannot_do(rough, tmp_path):
    with pytest.raises(InputError, match="written as"):
        write_scan(rough, tmp_path / "a.sur")
    with pytest.raises(InputError, match="a text file states no unit"):
        write_scan(rough, tmp_path / "a.csv")
    with pytest.raises(InputError, match="cannot mark missing"):
        write_scan(rough, tmp_path / "a.x3p", precision="I")
    with pytest.raises(InputError, match="precision"):
        write_scan(rough, tmp_path / "a.x3p", precision="Z")
    with pytest.raises(InputError, match="cannot be written"):
        write_scan(rough, tmp_path / "none" / "a.x3p")


def test_the_checksum_inside_is_md5_of_the_heights(rough, tmp_path):
    path = write_scan(rough, tmp_path / "a.x3p")
    data = zipfile.ZipFile(path).read("bindata/data.bin")
    assert hashlib.md5(data).hexdigest().upper() in xml_of(path)
    # the checksum of main.xml as OpenGPS writes it, in the format of md5sum
    stated = zipfile.ZipFile(path).read("md5checksum.hex").decode()
    assert stated == hashlib.md5(zipfile.ZipFile(path).read("main.xml")).hexdigest() + " *main.xml\n"


@pytest.mark.parametrize("precision", ["F", "D", "I", "L"])
def test_another_reader_finds_the_same_in_our_x3p(tmp_path, precision):
    topography = pytest.importorskip("SurfaceTopography")
    scan = spectral((24, 36), spacing=(2e-6, 3e-6), D=2.4, Rq=1e-6)
    path = write_scan(scan, tmp_path / "a.x3p", precision=precision)
    seen = topography.read_topography(str(path)).to_unit("m")
    assert np.abs(np.asarray(seen.heights()).T - scan.heights).max() < 1e-4 * np.ptp(scan.heights)
    assert np.array(seen.physical_sizes) / (36, 24) == pytest.approx(scan.spacing, rel=1e-6)


def test_a_zip_archive_without_main_xml_is_no_damaged_x3p(tmp_path):
    # .plux, .xlsx and others are zip archives too: they go to the other readers, which know them or say what to do
    path = tmp_path / "a.plux"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("index.xml", "<xml/>")
    with pytest.raises(ReadError, match="of no format that can be read|install SurfaceTopography"):
        read_scan(path)
    with pytest.raises(ReadError, match=r"has no main.xml"):
        read_scan(path.rename(tmp_path / "a.x3p"))


def sensofar(path, heights):
    """A .plux: micrometres, FOV_X and FOV_Y are the spacing."""
    ny, nx = heights.shape
    index = (
        "<xml><GENERAL>"
        f"<DATE>2024-01-02</DATE><IMAGE_SIZE_X>{nx}</IMAGE_SIZE_X><IMAGE_SIZE_Y>{ny}</IMAGE_SIZE_Y>"
        "<FOV_X>2</FOV_X><FOV_Y>3</FOV_Y></GENERAL>"
        "<LAYER_0><FILENAME_Z>LAYER_0.raw</FILENAME_Z></LAYER_0><INFO><SIZE>0</SIZE></INFO></xml>"
    )
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("index.xml", index)
        archive.writestr("LAYER_0.raw", (heights * 1e6).astype("<f4").tobytes())


def mitutoyo(path, heights):
    """A workbook of SurfTest: a line scan in columns E and F, mm along and um up."""
    book = pytest.importorskip("openpyxl").Workbook()
    data = book.active
    data.title = "DATA"
    data["A1"] = "Ra 0.5 um"
    for k, height in enumerate(heights[0], 1):
        data[f"E{k}"], data[f"F{k}"] = 0.002 * k, float(height * 1e6)
    certificate = book.create_sheet("Certificate")
    certificate["E2"], certificate["E48"] = "2 Jan 2024", "0.8mm"
    book.save(path)


def nmm(path, heights):
    """A scan of the nanomeasuring machine: heights in metres, a pair of files for each line."""
    ny, nx = heights.shape
    rule = "-" * 42
    field = {
        "Number of scans": "1",
        "Number of lines": str(ny),
        "Scan line length": f"{2 * (nx - 1)} [um]",
        "Scan field width": f"{3 * (ny - 1)} [um]",
        "Distance beetween points": "2 [um]",
        "Distance beetween lines": "3 [um]",
    }
    lines = [rule, "Scan procedure description file", "Creation time: 2024-01-02 10:11:12", rule, "1 Scan field"]
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("s.dsc", "\n".join([*lines, *(f"{k}: {v}" for k, v in field.items()), rule, ""]))
        for k, row in enumerate(heights, 1):
            about = f"{rule}\n0 : 10:11:12 : -Lz+Az : {nx} : height\n{rule}\n"
            archive.writestr(f"s_1_{k}.dsc", about)
            archive.writestr(f"s_1_{k}.dat", "".join(f"{h:.9e}\n" for h in row))


@pytest.mark.parametrize(
    ("write", "name"), [(sensofar, "a.plux"), (mitutoyo, "a.xlsx"), (nmm, "a.zip")], ids=["plux", "xlsx", "nmm"]
)
def test_other_zip_formats_come_in_through_the_same_door(tmp_path, write, name):
    pytest.importorskip("SurfaceTopography")
    heights = spectral((24, 36), spacing=(2e-6, 3e-6), D=2.4, Rq=1e-6).heights
    write(tmp_path / name, heights)
    scan = read_scan(tmp_path / name)
    if scan.heights.ndim == 1:
        heights = heights[0]
        assert scan.spacing == pytest.approx(2e-6, rel=1e-3)
    else:
        assert scan.spacing == pytest.approx((2e-6, 3e-6), rel=1e-6)
    assert scan.heights.shape == heights.shape
    off = scan.heights - heights
    assert np.ptp(off) < 1e-5 * np.ptp(heights)


def test_another_version_of_zip_is_refused_in_words(rough, tmp_path):
    path = write_scan(rough, tmp_path / "a.x3p")
    blob = bytearray(path.read_bytes())
    at = blob.index(b"PK\x01\x02")
    blob[at + 6] = 99  # version needed to extract
    path.write_bytes(blob)
    with pytest.raises(ReadError, match="zip"):
        read_scan(path)


def test_a_heading_states_the_units(rough, tmp_path):
    path = write_scan(rough, tmp_path / "a.csv", xy_unit="mm", z_unit="um")
    path.write_text("x [mm],y [mm],z [um]\n" + path.read_text())
    back = read_scan(path)
    assert back.spacing == pytest.approx(rough.spacing, rel=1e-6)
    assert np.allclose(back.heights, rough.heights, atol=1e-14, equal_nan=True)
    with pytest.raises(InputError, match="states its units"):
        read_scan(path, xy_unit="mm", z_unit="um")
    path.write_text("x [mm];z [nm]\n" + "\n".join(f"{0.01 * i};{100 * i % 7}" for i in range(40)))
    line = read_scan(path)
    assert isinstance(line, Profile)
    assert line.spacing == pytest.approx(1e-5)
    assert line.heights[1] == pytest.approx(2e-9)


@pytest.mark.parametrize("given", [{"size": (5.6e-5, 8e-5)}, {"spacing": (1e-6, 2e-6)}])
def test_a_matrix_of_heights_needs_its_size(tmp_path, given):
    z = np.arange(40 * 56, dtype=float).reshape(40, 56) % 37
    path = tmp_path / "matrix.txt"
    np.savetxt(path, z, delimiter="\t")
    with pytest.raises(InputError, match=r"matrix of heights.*give size or spacing.*and z_unit"):
        read_scan(path)
    scan = read_scan(path, z_unit="nm", **given)
    assert scan.spacing == pytest.approx((1e-6, 2e-6))
    assert np.allclose(scan.heights, z * 1e-9)
    path.write_text("\n".join(path.read_text().splitlines()[:-1]) + "\n1\t2\t3\n")
    with pytest.raises(ReadError, match="line 40.*not a row of 56 heights"):
        read_scan(path, z_unit="nm", **given)


def test_a_size_replaces_one_that_cannot_be_and_no_other(tmp_path):
    scan = spectral((40, 40), spacing=1e-6, D=2.4, Rq=1e-8)
    long = write_scan(Scan(heights=scan.heights, spacing=(4.0, 4.0)), tmp_path / "long.x3p")  # 160 m
    with pytest.raises(ReadError, match=r"160 m x 160 m.*true size or spacing in metres"):
        read_scan(long)
    back = read_scan(long, size=160e-6)
    assert back.spacing == pytest.approx((4e-6, 4e-6))
    assert "given by the caller" in back.notes[-1]
    with pytest.raises(InputError, match="the file states its size"):
        read_scan(write_scan(scan, tmp_path / "good.x3p"), size=1e-3)
    assert read_scan(tmp_path / "good.x3p", spacing=1e-6).spacing == pytest.approx((1e-6, 1e-6))


@pytest.mark.parametrize("size", [0.0, -1e-3, float("nan"), (1e-3,), (1e-3, 0.0), "4 kg", (1, 2, 3)])
def test_sizes_that_cannot_be_are_refused(rough, tmp_path, size):
    path = write_scan(rough, tmp_path / "a.x3p")
    with pytest.raises(InputError, match="size = .*(must be positive|give 2 numbers in m|not in a unit like m)"):
        read_scan(path, size=size)
    with pytest.raises(InputError, match="one of the two"):
        read_scan(path, size=1e-3, spacing=1e-6)


@pytest.mark.parametrize("text", ["0,0;0,0;1,5\n1,0;0,0;2,5\n", "0,5\t1,25\t3,5\n1,5\t1,25\t4,5\n", "0,5 1,5 2,5\n"])
def test_decimal_commas_are_refused(tmp_path, text):
    path = tmp_path / "a.csv"
    path.write_text(text * 4)
    with pytest.raises(ReadError, match="decimal comma.*write decimal points"):
        read_scan(path, "um", "um")


def test_a_scan_too_large_for_the_memory_is_refused_before_it_is_unpacked(rough, tmp_path, monkeypatch):
    path = write_scan(rough, tmp_path / "a.x3p")
    monkeypatch.setenv("FAYING_MEMORY", "0.0001")
    with pytest.raises(ReadError, match=r"2.24e\+03 points need about .* GB are free"):
        read_scan(path)
    monkeypatch.setenv("FAYING_MEMORY", "1")
    assert read_scan(path).shape == rough.shape


def test_heights_listed_in_the_xml_are_held_against_the_memory(rough, tmp_path, monkeypatch):
    """64 MB of list took 44 s and gigabytes: a listed height takes more than one in a block, and this is said first."""
    good = write_scan(rough, tmp_path / "good.x3p")
    text = xml_of(good)
    listed = "<DataList>" + "".join(f"<Datum>{v!r}</Datum>" for v in map(float, rough.heights.ravel())) + "</DataList>"
    start, end = text.index("<DataLink>"), text.index("</DataLink>") + len("</DataLink>")
    path = repacked(good, tmp_path / "listed.x3p", main_xml=text[:start] + listed + text[end:])
    monkeypatch.setenv("FAYING_MEMORY", str(1.5 * 160 * rough.heights.size / 1e9))
    assert read_scan(good).shape == rough.shape
    with pytest.raises(ReadError, match="points need about .* GB are free"):
        read_scan(path)
    monkeypatch.setenv("FAYING_MEMORY", str(3 * 160 * rough.heights.size / 1e9))
    assert read_scan(path).shape == rough.shape


@pytest.mark.parametrize("matrix", [True, False])
def test_a_text_too_large_for_the_memory_is_refused_before_it_is_read(tmp_path, monkeypatch, matrix):
    rng = np.random.default_rng(3)
    path = tmp_path / "a.txt"
    n = 60
    if matrix:
        np.savetxt(path, rng.standard_normal((n, n)), fmt="%.5f")
    else:
        x, y = np.meshgrid(np.arange(n), np.arange(n))
        np.savetxt(path, np.column_stack([x.ravel(), y.ravel(), rng.standard_normal(n * n)]), fmt="%.5f")
    given = {"z_unit": "um", "size": 1e-3} if matrix else {"xy_unit": "um", "z_unit": "um"}
    assert read_scan(path, **given).shape == (n, n)
    monkeypatch.setenv("FAYING_MEMORY", str(160 * n * n / 1e9))
    monkeypatch.setattr(np, "loadtxt", None)
    monkeypatch.setattr(Path, "read_text", None)
    with pytest.raises(ReadError, match=r"points need about .* GB are free; crop the scan"):
        read_scan(path, **given)


@pytest.mark.parametrize("delimiter", [",", ";", " ", "\t", ", "])
@pytest.mark.parametrize("words", [{}, {7: "nan"}, {7: "---", 11: "bad"}, {7: "1e-3"}])
def test_reading_in_one_go_and_line_by_line_agree(tmp_path, monkeypatch, delimiter, words):
    x, y = np.meshgrid(np.arange(5.0), np.arange(4.0))
    rows = [
        [f"{a:g}", f"{b:g}", words.get(k, f"{k / 7:.6f}")] for k, (a, b) in enumerate(zip(x.flat, y.flat, strict=True))
    ]
    path = tmp_path / "a.csv"
    path.write_text("# points\n\n" + "".join(delimiter.join(row) + "\n" for row in rows), encoding="utf-8-sig")
    quick = read_scan(path, "um", "um")
    monkeypatch.setattr("faying.surface.files.text._quickly", lambda *_: None)
    slow = read_scan(path, "um", "um")
    assert np.array_equal(quick.heights, slow.heights, equal_nan=True)
    assert slow.missing == sum(word in ("nan", "---", "bad") for word in words.values())


@pytest.mark.parametrize("language", [("Width", "Height"), ("Breite", "H\u00f6he")])
def test_the_comments_of_gwyddion_state_size_and_unit(tmp_path, language):
    """As its text export writes them; without them, three columns of heights would be x, y and z."""
    heights = np.array([[1.0, 1.5, 3.0], [-2.0, -3.0, -6.0], [0.0, 0.0, 0.0], [9.0, 9.0, 9.0]])
    path = tmp_path / "a.txt"
    head = f"# Channel: My name\n# {language[0]}: 12.34 \u00b5m\n# {language[1]}: 5678.9 nm\n# Value units: nm\n"
    path.write_text(head + "".join(" ".join(f"{z:g}" for z in row) + "\n" for row in heights), encoding="utf-8")
    scan = read_scan(path)
    assert scan.size == pytest.approx((12.34e-6, 5.6789e-6))
    assert scan.heights == pytest.approx(heights * 1e-9)
    with pytest.raises(InputError, match="the file states its units"):
        read_scan(path, xy_unit="um", z_unit="um")
    with pytest.raises(InputError, match="the file states its size"):
        read_scan(path, size=4e-3)
    path.write_text(path.read_text("utf-8").replace("12.34", "nan"), encoding="utf-8")
    with pytest.raises(ReadError, match="write a positive number"):
        read_scan(path)


def test_positions_rounded_in_the_file_are_still_even(tmp_path):
    """Steps of 0.0995712 um in six decimals: mostly .0001 mm, at times .000099, so that the median is .4 % too long."""
    step, n = 9.957e-5, 4001
    x = np.arange(n) * step
    z = np.sin(x)
    path = tmp_path / "a.txt"
    np.savetxt(path, np.column_stack([x, z]), fmt="%.6f")
    line = read_scan(path, "mm", "um")
    assert line.heights.shape == (n,)
    assert line.spacing == pytest.approx(step * 1e-3, rel=1e-4)


def test_numbers_behind_a_head_of_text_are_not_cut_short(tmp_path):
    path = tmp_path / "a.di"
    path.write_bytes(b"*File list\r\n" * 400 + bytes(range(256)) * 20)
    assert end_of(path) == ()
    path.write_bytes(b"1 2 3\r\n" * 400 + b"1 2")
    assert len(end_of(path)) == 1


@pytest.mark.skipif(importlib.util.find_spec("SurfaceTopography") is None, reason="SurfaceTopography is not installed")
def test_the_ending_helps_where_the_content_deceives(tmp_path, monkeypatch):
    """One of two .nms of the same instrument begins as MATLAB's files do; the library then finds no data in it."""
    path = tmp_path / "a.nms"
    path.write_bytes(np.array([2, 1, 0, 65535, 0], "<i4").tobytes() + bytes(5000))
    with pytest.raises(ReadError, match="of no format that can be read"):
        read_scan(path)  # and imports the library, without its warnings
    from SurfaceTopography.IO import NMS

    asked = []
    monkeypatch.setattr(NMS.NMSReader, "__init__", lambda *_, **__: asked.append(True))
    with pytest.raises(ReadError, match="of no format that can be read"):
        read_scan(path)
    assert asked


@pytest.mark.skipif(importlib.util.find_spec("SurfaceTopography") is None, reason="SurfaceTopography is not installed")
def test_an_archive_of_several_files_is_to_be_unpacked(tmp_path):
    path = tmp_path / "container.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for name in ("a.txt", "b.txt", "c.txt", "d.txt"):
            archive.writestr(name, "nothing")
    with pytest.raises(ReadError, match=r"zip archive of 4 files \(a.txt, b.txt, c.txt, ...\): unpack it and give one"):
        read_scan(path)


def test_a_text_without_an_end_of_line_may_be_cut_short_and_fits_say_so(tmp_path):
    line = spectral(300, spacing=0.5e-6, D=2.4, Rq=1e-6)
    path = write_scan(line, tmp_path / "a.txt", xy_unit="um", z_unit="nm")
    assert read_scan(path, "um", "nm").notes == ()
    path.write_bytes(path.read_bytes()[:-700])  # in the middle of a line: a shorter line scan
    back = read_scan(path, "um", "nm")
    assert back.heights.size < 300
    assert "may be cut short" in back.notes[0]
    assert back.notes[0] in fit_fractal(back).warnings


@pytest.mark.parametrize("down", [False, True])
@pytest.mark.parametrize("fast", ["x", "y"])
def test_a_grid_cut_within_a_row_is_refused_whichever_way_it_runs(tmp_path, fast, down):
    """7 x 5 points by rows or by columns, upwards or downwards; cut where a row ends, it is a smaller grid."""
    steps = range(4, -1, -1) if down else range(5)
    points = [(k, j) if fast == "x" else (j, k) for j in steps for k in range(7)]
    lines = [f"{x},{y},{np.sin(x + y):.6f}\n" for x, y in points]
    path = tmp_path / "a.csv"
    for count in range(len(lines), 14, -1):
        path.write_text("".join(lines[:count]))
        if count % 7 == 0:
            assert read_scan(path, "um", "nm").heights.size == count
        else:
            with pytest.raises(ReadError, match="cut off"):
                read_scan(path, "um", "nm")


@pytest.mark.parametrize("suffix", ["x3p", "csv"])
def test_a_scan_cut_short_is_refused(rough, tmp_path, suffix):
    path = write_scan(rough, tmp_path / f"a.{suffix}", **({} if suffix == "x3p" else {"xy_unit": "mm", "z_unit": "um"}))
    units = () if suffix == "x3p" else ("mm", "um")
    blob = path.read_bytes()
    for share in np.linspace(0.02, 0.99, 25):
        path.write_bytes(blob[: int(share * len(blob))])
        with pytest.raises(ReadError):
            read_scan(path, *units)
