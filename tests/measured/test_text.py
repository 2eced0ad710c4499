import numpy as np
import pytest

from faying import InputError, ReadError
from faying.measured.text import read_frf_text


def test_columns_and_lists_of_complex_numbers_agree(tmp_path):
    values = np.array([1 + 2j, -3e-4 + 1j, 2 - 7.5j])
    listed, table = tmp_path / "a.txt", tmp_path / "b.csv"
    listed.write_text("\n".join(f"({v.real}{v.imag:+}j)" for v in values))
    table.write_text("frequency [Hz],re,im\n" + "\n".join(f"{2.5 * k},{v.real},{v.imag}" for k, v in enumerate(values)))
    a = read_frf_text([listed], quantity="mobility", frequency_step=2.5)
    b = read_frf_text([table], quantity="mobility")
    np.testing.assert_array_equal(a.values, b.values)
    np.testing.assert_array_equal(a.frequency, b.frequency)
    np.testing.assert_array_equal(a.values[0, 0], values)


def test_several_frfs_in_one_table(tmp_path):
    file = tmp_path / "a.txt"
    file.write_text("# two FRFs\n0 1 2 3 4\n1; 5; 6; 7; 8\n")
    frf = read_frf_text([file], quantity="receptance", direction="x")
    np.testing.assert_array_equal(frf.values[:, 0], [[1 + 2j, 5 + 6j], [3 + 4j, 7 + 8j]])
    assert [str(d) for d in frf.outputs] == ["1+x", "2+x"]


@pytest.mark.parametrize(
    ("text", "error", "match"),
    [
        ("", ReadError, "no FRF in it"),
        ("(1+2j)\n(3+4j)\n", InputError, "--frequency-step"),
        ("0,1\n1,2\n", ReadError, "lines of 2 numbers"),
        ("0,1,2\n1,2\n", ReadError, "expected frequency"),
        ("0,1,2\n1,2,x\n", ReadError, "'x' is no number"),
    ],
)
def test_bad_files(tmp_path, text, error, match):
    file = tmp_path / "a.txt"
    file.write_text(text)
    with pytest.raises(error, match=match):
        read_frf_text([file], quantity="receptance")


def test_files_that_do_not_fit_together(tmp_path):
    a, b = tmp_path / "a.csv", tmp_path / "b.csv"
    a.write_text("0,1,2\n1,2,3\n")
    b.write_text("0,1,2\n2,2,3\n")
    with pytest.raises(InputError, match="give files of one test"):
        read_frf_text([a, b], quantity="receptance")
    with pytest.raises(InputError, match="no file"):
        read_frf_text([], quantity="receptance")
    with pytest.raises(ReadError, match="cannot be read"):
        read_frf_text([tmp_path / "absent.csv"], quantity="receptance")


def test_a_file_without_an_end_of_line_may_be_cut_short(tmp_path):
    path = tmp_path / "frf.txt"
    path.write_text("1 2 3\n2 3 4\n3 4 5\n")
    assert read_frf_text([path], quantity="accelerance").warnings == ()
    path.write_text("1 2 3\n2 3 4\n3 4 5")
    assert "may be cut short" in read_frf_text([path], quantity="accelerance").warnings[0]


@pytest.mark.parametrize("line", ["1,5;2,5;3,5", "1,5 2,5 3"])
def test_decimal_commas_are_refused(tmp_path, line):
    path = tmp_path / "frf.txt"
    path.write_text(f"{line}\n" * 4)
    with pytest.raises(ReadError, match="decimal commas; write decimal points"):
        read_frf_text([path], quantity="accelerance")
