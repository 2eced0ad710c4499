"""Nothing that stands in a text of numbers is lost: words above them, cells without a number, units in words."""

import shutil
import zipfile

import numpy as np
import pytest

from faying import InputError, ReadError, read_scan
from tests.surface.test_foreign_texts import NX, NY, STEP, WAVES, rows, text

LINE = "".join(f"{0.5 * k:g}\t{np.sin(k / 3):.6f}\n" for k in range(100))
HEAD = "Instrument A\nMeasured on Monday\nX\tZ\n"


def read(path, content, **given):
    path.write_text(content, encoding="utf-8")
    return read_scan(path, **({"xy_unit": "um", "z_unit": "um"} | given))


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16"])
def test_a_micro_sign_is_read_in_the_encoding_of_the_instrument(tmp_path, encoding):
    path = tmp_path / "p.txt"
    path.write_bytes(f"X [µm]\tZ [µm]\n{LINE}".encode(encoding))
    found = read_scan(path)
    assert found.heights[50] == pytest.approx(1e-6 * np.sin(50 / 3), abs=1e-12)
    assert found.length == pytest.approx(50e-6)


@pytest.mark.parametrize("head", ["µm µm\n100\n", "x in µm, y in µm\n", "mm and um\n"])
def test_a_unit_in_the_head_is_spoken_of_where_it_is_not_read(tmp_path, head):
    with pytest.raises(InputError, match="is in words that are not read"):
        read(tmp_path / "p.txt", head + LINE, xy_unit=None, z_unit=None)
    assert "the unit is the one given" in read(tmp_path / "p.txt", head + LINE).notes[-1]


def test_a_text_of_one_number_in_a_line_and_one_cut_in_a_letter_are_refused_as_such(tmp_path):
    with pytest.raises(ReadError, match="no row of two numbers or more"):
        read(tmp_path / "z.txt", "".join(f"{k}\n" for k in range(9)))
    path = tmp_path / "cut.txt"
    path.write_bytes(LINE.encode("utf-16")[:-1])
    with pytest.raises(ReadError, match="line 100 .* is not"):
        read_scan(path, xy_unit="um", z_unit="um")


@pytest.mark.parametrize("word", ["***", "BAD", "nan"])
def test_a_missing_height_under_several_lines_of_words_is_one_missing_point(tmp_path, word):
    lines = LINE.splitlines()
    lines[30] = f"15\t{word}"
    found = read(tmp_path / "p.txt", HEAD + "\n".join(lines) + "\n")
    assert found.heights.shape == (100,)
    assert np.flatnonzero(np.isnan(found.heights)).tolist() == [30]
    assert found.heights[50] == pytest.approx(1e-6 * np.sin(50 / 3), abs=1e-12)


def test_a_word_among_the_numbers_is_refused_by_its_line(tmp_path):
    with pytest.raises(ReadError, match='line 104 "Trace 2"'):
        read(tmp_path / "two.txt", HEAD + LINE + "Trace 2\n" + LINE)
    with pytest.raises(ReadError, match='line 34 "15.INVALID"'):
        read(tmp_path / "bad.txt", HEAD + LINE.replace("15\t-0.544021", "15\tINVALID"))


def test_steps_that_differ_under_a_head_are_interpolated_with_a_note(tmp_path):
    x = np.cumsum(np.linspace(0.5, 1.5, 100)) * 1e-6
    lines = "".join(f"{a:.9e} {1e-7 * np.sin(1e6 * a):.6e}\n" for a in x)
    found = read(tmp_path / "p.txt", "A trace\nof one\n" + lines, xy_unit="m", z_unit="m")
    assert "heights are interpolated at even steps" in found.notes[0]


def test_rows_of_a_matrix_under_words_do_not_move_up(tmp_path):
    """The reader of any text took a row with a word in it for one of the head."""
    lines = text(WAVES, mark=" ").splitlines()
    lines[7] = lines[7].replace(lines[7].split()[4], "***")
    lengths = {"xy_unit": None, "size": (NX * STEP * 1e-6, NY * STEP * 1e-6)}
    with pytest.raises(ReadError, match=f"{NX * (NY - 1)} heights were read of {NY} rows"):
        read(tmp_path / "m.txt", "Topography\n" + "\n".join(lines), **lengths)
    with pytest.raises(ReadError, match="decimal commas"):
        read(tmp_path / "c.txt", "Topography\n" + text(WAVES, mark="\t").replace(".", ","), **lengths)


@pytest.mark.parametrize(
    "head",
    [
        "# Channel: Height\n# Lateral units: µm\n# Value units: nm\n",
        "# x [um] y [um] z [nm]\n",
        "Made by A\nx,y,z\num,um,nm\n",
        "Made by A\nx [um],y [um],z [nm]\n",
    ],
)
def test_units_that_a_head_states_are_read(tmp_path, head):
    found = read(tmp_path / "a.txt", head + text(rows()), xy_unit=None, z_unit=None)
    assert found.heights == pytest.approx(1e-9 * WAVES, abs=1e-15)
    assert found.spacing == pytest.approx((1e-6 * STEP, 1e-6 * STEP))
    with pytest.raises(InputError, match="states its units"):
        read_scan(tmp_path / "a.txt", xy_unit="mm", z_unit="mm")


def test_units_in_words_are_quoted(tmp_path):
    content = "Unit X: um Unit Y: um Unit Z: nm\n" + text(rows())
    with pytest.raises(InputError, match='"Unit X: um Unit Y: um Unit Z: nm" is in words that are not read'):
        read(tmp_path / "a.txt", content, xy_unit=None, z_unit=None)
    (note,) = read(tmp_path / "a.txt", content).notes
    assert '"Unit X: um Unit Y: um Unit Z: nm" is not read; the unit is the one given' in note


@pytest.mark.parametrize(
    ("head", "match"),
    [
        ("Z [nm]\n", '"Z .nm." speaks of a unit'),
        ("ncols 32\nnrows 24\ncellsize 2e-6\n", '"cellsize 2e-6" speaks of a unit'),
    ],
)
def test_a_unit_above_a_matrix_is_refused(tmp_path, head, match):
    with pytest.raises(ReadError, match=match):
        read(tmp_path / "m.txt", head + text(WAVES, mark=" "), xy_unit=None, spacing=1e-6)


def test_two_images_are_not_one(tmp_path):
    one = "# Channel: A\n# Width: 48 µm\n# Height: 36 µm\n# Value units: nm\n" + text(WAVES, mark="\t")
    with pytest.raises(ReadError, match="more than one size"):
        read(tmp_path / "m.txt", one + one, xy_unit=None, z_unit=None)


def test_pixels_are_no_size(tmp_path):
    content = "Image Width: 32 pixels\nImage Height: 24 pixels\n" + text(WAVES, mark=" ")
    found = read(tmp_path / "m.txt", content, xy_unit=None, spacing="2 um")
    assert found.spacing == pytest.approx((2e-6, 2e-6))
    with pytest.raises(InputError, match="does not state its physical size"):
        read(tmp_path / "m.txt", content)


def test_heads_of_profilometers_with_units_that_are_not_known(tmp_path):
    lines = LINE.replace("\t", ",").replace("\n", ",\n")
    head = "Scan Parameters,\nStylus,Radius: 12.5 um\n\nScan Data\n\nLateral um,Raw {},\n"
    found = read(tmp_path / "d.csv", head.format("nm") + lines, xy_unit=None, z_unit=None)
    assert np.abs(found.heights).max() == pytest.approx(1e-9, rel=1e-2)
    with pytest.raises(ReadError, match="Raw Nanometer"):
        read(tmp_path / "d.csv", head.format("Nanometer") + lines, xy_unit=None, z_unit=None)


def test_points_that_a_file_calls_not_valid_are_not_heights(tmp_path):
    lines = [f"{0.0005 * k:.6f};{1e-4 * np.sin(k):.7f};1" for k in range(100)]
    head = "X;Y;valid\n[mm];[mm];[1/0]\n"
    found = read(tmp_path / "a.hfm", head + "\n".join(lines) + "\n", xy_unit=None, z_unit=None)
    assert found.heights.shape == (100,)
    lines[40] = "0.020000;0.0000000;0"
    with pytest.raises(ReadError, match="line 43 is marked as not valid"):
        read(tmp_path / "a.hfm", head + "\n".join(lines) + "\n", xy_unit=None, z_unit=None)


def test_the_mask_of_an_x3p_file_in_a_folder_counts(tmp_path):
    from faying.surface.files.write import write_scan
    from faying.surface.scan import Scan

    heights = np.where(WAVES > 1.2, np.nan, 1e-6 * WAVES)
    write_scan(Scan(heights=heights, spacing=(1e-6, 1e-6)), tmp_path / "a.x3p")
    with zipfile.ZipFile(tmp_path / "a.x3p") as plain, zipfile.ZipFile(tmp_path / "b.x3p", "w") as moved:
        for name in plain.namelist():
            moved.writestr(f"scan/{name}", plain.read(name))
    shutil.move(tmp_path / "b.x3p", tmp_path / "c.x3p")
    assert np.array_equal(read_scan(tmp_path / "c.x3p").heights, read_scan(tmp_path / "a.x3p").heights, equal_nan=True)
