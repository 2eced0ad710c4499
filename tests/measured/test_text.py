import warnings

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


@pytest.mark.parametrize("encoding", ["utf-8", "latin-1", "utf-16"])
def test_degrees_and_squares_are_read_in_the_encoding_of_the_instrument(tmp_path, encoding):
    file = tmp_path / "a.csv"
    file.write_bytes("frequency [Hz],magnitude [m/s²/N],phase [°]\n1,2,90\n2,3,180\n".encode(encoding))
    frf = read_frf_text([file], quantity="accelerance")
    np.testing.assert_allclose(frf.values.ravel(), [2j, -3], atol=1e-12)


def test_an_frf_in_two_forms_is_one(tmp_path):
    values = 1e-9 * np.array([1 + 2j, -3 + 1j, 2 - 7.5j])
    file = tmp_path / "a.csv"
    for size, count in ((1.0, 1), (1.1, 2)):
        rows = [f"{v.real},{v.imag},{20 * np.log10(size * abs(v)):.3f},{np.angle(v, deg=True):.2f}" for v in values]
        head = "frequency [Hz],real [m/N],imaginary [m/N],magnitude [dB re 1 m/N],phase [deg]\n"
        file.write_text(head + "".join(f"{k},{row}\n" for k, row in enumerate(rows, start=1)))
        frf = read_frf_text([file], quantity="receptance")
        np.testing.assert_array_equal(frf.values[0, 0], values)
        assert len(frf.outputs) == count
        assert len(frf.warnings) == 2 - count


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
        ("0,1,2\n1,1e300,3\n", InputError, "no structure answers so"),
        ("0,1\n1,2\n", ReadError, "lines of 2 numbers"),
        ("0,1,2\n1,2\n", ReadError, "expected frequency"),
        ("0,1,2\n1,2,x\n", ReadError, "'x' is not a number"),
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
    (assumed,) = read_frf_text([path, path], quantity="accelerance").warnings
    assert assumed == "no heading: the columns are taken as frequency in Hz, then real and imaginary parts in m/(N*s^2)"
    path.write_text("1 2 3\n2 3 4\n3 4 5")
    assert "may be cut short" in read_frf_text([path], quantity="accelerance").warnings[1]


@pytest.mark.parametrize("line", ["1,5;2,5;3,5", "1,5 2,5 3"])
def test_decimal_commas_are_refused(tmp_path, line):
    path = tmp_path / "frf.txt"
    path.write_text(f"{line}\n" * 4)
    with pytest.raises(ReadError, match="decimal commas; write decimal points"):
        read_frf_text([path], quantity="accelerance")


LINES = np.array([1.0, 2.5, 40.0, 95.0])
TRUE = np.array([1 + 2j, -3e-4 + 1e-3j, 2 - 7.5j, -0.25 - 1e-6j])  # m/s^2/N
PHASE = np.degrees(np.angle(TRUE))
G = 9.80665


@pytest.mark.parametrize(
    ("head", "columns"),
    [
        ("Frequency (Hz),Magnitude (m/s^2/N),Phase (deg)", (LINES, abs(TRUE), PHASE)),
        ("Frequency [Hz];Phase [rad];Amplitude [g/N]", (LINES, np.angle(TRUE), abs(TRUE) / G)),
        ("f/kHz,|H| mag/dB,phase/°", (LINES / 1e3, 20 * np.log10(abs(TRUE)), PHASE)),
        ("Freq [Hz],Mag [dB re 1 g/N],Phase [deg]", (LINES, 20 * np.log10(abs(TRUE) / G), PHASE)),
        ("f [Hz],Accelerance [dB re 1e-6 (m/s^2)/(1 N)],Phase [deg]", (LINES, 20 * np.log10(abs(TRUE)) + 120, PHASE)),
        ("f [Hz];Magnitude [dB/10.0u (m/s²)/N];Phase [°]", (LINES, 20 * np.log10(abs(TRUE)) + 100, PHASE)),
        ("Frequency kHz,dB re 1 m/s^2/N,Phase deg", (LINES / 1e3, 20 * np.log10(abs(TRUE)), PHASE)),
        ("f [Hz],Mag dB (re 10 (m/s^2)/kN),Phase [deg]", (LINES, 20 * np.log10(abs(TRUE)) + 40, PHASE)),
        ("Frequency Hz,Real m/s^2/N,Imag m/s^2/N", (LINES, TRUE.real, TRUE.imag)),
        ("f Hz,Mag mm/s²/N,Phase °", (LINES, 1e3 * abs(TRUE), PHASE)),
        ("omega [rad/s]\tRe [mm/s^2/N]\tIm [mm/s^2/N]", (2 * np.pi * LINES, 1e3 * TRUE.real, 1e3 * TRUE.imag)),
        ("imag [m/(N*s^2)],real [m/(N*s^2)],frequency [rpm]", (TRUE.imag, TRUE.real, 60 * LINES)),
        ("Frequency_kHz,H_re [m/s^2/kN],H_im [m/s^2/kN]", (LINES / 1e3, 1e3 * TRUE.real, 1e3 * TRUE.imag)),
        ("# Frequency [kHz], H_re [m/s^2/kN], H_im [m/s^2/kN]", (LINES / 1e3, 1e3 * TRUE.real, 1e3 * TRUE.imag)),
        ("title of a test\nfrequency [Hz],re,im", (LINES, TRUE.real, TRUE.imag)),
        ("", (LINES, TRUE.real, TRUE.imag)),
    ],
)
def test_a_heading_says_how_frfs_are_written(tmp_path, head, columns):
    mark = next((m for m in ";\t" if m in head), ",")
    rows = [mark.join(repr(float(v)) for v in row) for row in zip(*columns, strict=True)]
    path = tmp_path / "frf.csv"
    path.write_text("\n".join([head, *rows, ""]))
    found = read_frf_text([path], quantity="accelerance")
    np.testing.assert_allclose(found.frequency, LINES, rtol=1e-12)
    np.testing.assert_allclose(found.values[0, 0], TRUE, rtol=1e-9, atol=1e-12)


def test_what_a_heading_leaves_open_is_noted(tmp_path):
    path = tmp_path / "frf.csv"
    path.write_text("frequency [Hz],mag [dB],phase [deg]\n1,0,90\n2,20,-90\n")
    found = read_frf_text([path], quantity="mobility")
    np.testing.assert_allclose(found.values[0, 0], [1j, -10j], atol=1e-14)
    assert ['"mag [dB]" states no reference; 0 dB is taken as 1 m/(N*s)' in w for w in found.warnings] == [True]
    path.write_text("frequency,re,im\n1,0,90\n2,20,-90\n")
    assert any('"re" states no unit; m/N is taken' in w for w in read_frf_text([path], quantity="receptance").warnings)


@pytest.mark.parametrize(
    ("head", "match"),
    [
        ("frequency [Hz],real [m/s/N],imag [m/s/N]", 'line 1: "m/s/N" of the column .* unit of mobility, give that'),
        ("frequency [Hz],real [mV/N],imag [mV/N]", '"mV/N" of the column "real .mV/N." is not a unit of accelerance'),
        ("frequency [Hz],real [g/N],imag", "only one of .* states a unit"),
        ("frequency [Hz],magnitude,phase", '"phase" states no unit of angle'),
        ("frequency [Hz],mag [dB re 20 uPa],phase [deg]", '"20 uPa" is not a reference'),
        ("frequency [Hz],real,magnitude", 'real" and "magnitude" of the heading make no FRF'),
        ("frequency [Hz],real,imag,noise", 'the column "noise" is unknown'),
        ("frequency [Hz],real,imag,real,imag,coherence", "1 columns of coherence for 2 FRFs"),
        ("frequency [Hz],mag [dB re 20],phase [deg]", "is not a reference"),
        ("frequency [Hz],mag [dB re 0 m/s^2/N],phase [deg]", "is not a reference"),
        ("time [s],real,imag", 'the column "time .s." is unknown'),
        ("omega,real,imag", '"omega" states no unit'),
        ("frequency [m],real,imag", '"frequency .m." states no unit'),
        ("real,imag", "0 columns of frequency"),
        ("# frequency,magnitude,phase", 'the column "phase" states no unit of angle'),
        ("# omega,real,imag", '"omega" states no unit'),
        ("# f,real (V/N),imag (V/N)", "is not a unit of accelerance"),
        ("frequency [Hz],magnitude [dB] (g/N),phase [deg]", "states two units"),
        ("frequency [Hz],magnitude (g/N) [dB],phase [deg]", "states two units"),
        ("# frequency [kHz], response, g", 'the column "response" is unknown'),
        ("units: g/N\nfrequency [Hz],real,imag", 'line 1: "units: g/N" mentions units'),
    ],
)
def test_headings_that_are_not_read_are_refused(tmp_path, head, match):
    path = tmp_path / "frf.csv"
    path.write_text(f"{head}\n1,2,3\n2,3,4\n3,4,5\n")
    with pytest.raises(ReadError, match=match):
        read_frf_text([path], quantity="accelerance")


def test_units_above_complex_numbers_are_refused(tmp_path):
    path = tmp_path / "frf.txt"
    path.write_text("FRF [g/N]\n(1+2j)\n(3+4j)\n")
    with pytest.raises(ReadError, match=r'line 1: "FRF \[g/N\]" mentions units'):
        read_frf_text([path], quantity="accelerance", frequency_step=1.0)


def test_a_missing_line_among_even_steps_is_said(tmp_path):
    rows = ["frequency [Hz],re [m/s/N],im [m/s/N]", *(f"{0.5 * k},{k},1" for k in range(40))]
    file = tmp_path / "a.csv"
    file.write_text("\n".join(rows) + "\n")
    assert read_frf_text([file], quantity="mobility").warnings == ()
    del rows[8]
    file.write_text("\n".join(rows) + "\n")
    (said,) = read_frf_text([file], quantity="mobility").warnings
    assert "steps of 0.5 Hz, but from 3 to 4 Hz there is none; is a line missing?" in said


def test_frequencies_of_uneven_steps_are_fine(tmp_path):
    file = tmp_path / "a.csv"
    file.write_text("".join(f"{1.1**k:.6f},{k},1\n" for k in range(40)))
    assert not any("missing" in note for note in read_frf_text([file], quantity="mobility").warnings)


@pytest.mark.parametrize("line", ["(3j)", "(-0.2751630801031998j)", "(1+2)", "(1+2j", "7943-1.195j)"])
def test_a_complex_number_in_brackets_has_two_parts(tmp_path, line):
    file = tmp_path / "a.txt"
    file.write_text(f"(1+2j)\n{line}\n")
    with pytest.raises(ReadError, match="not a complex number of two parts"):
        read_frf_text([file], quantity="receptance", frequency_step=1.0)


@pytest.mark.parametrize("line", ["(1e-3-2.5e+02j)", "(-.5+1j)", "( 1.0e+00 +2.0e+00j)", "1-2j", "3j"])
def test_complex_numbers_as_programs_write_them(tmp_path, line):
    file = tmp_path / "a.txt"
    file.write_text(f"(1+2j)\n{line}\n")
    frf = read_frf_text([file], quantity="receptance", frequency_step=1.0)
    assert frf.values[0, 0, 1] == complex(line.replace(" ", "").strip("()"))


def test_a_column_of_coherence_goes_with_its_frf(tmp_path):
    coherence = np.array([0.5, 0.9, 1.0, 0.75])
    path = tmp_path / "frf.csv"
    head = "Frequency [Hz];Coherence [-];Real [m/s^2/N];Imag [m/s^2/N]"
    rows = [f"{f};{c};{v.real};{v.imag}" for f, c, v in zip(LINES, coherence, TRUE, strict=True)]
    path.write_text("\n".join([head, *rows, ""]))
    found = read_frf_text([path], quantity="accelerance")
    np.testing.assert_array_equal(found.coherence, [[coherence]])
    np.testing.assert_array_equal(found.values, [[TRUE]])
    other = tmp_path / "other.csv"
    other.write_text("\n".join(f"{f},{v.real},{v.imag}" for f, v in zip(LINES, TRUE, strict=True)) + "\n")
    both = read_frf_text([other, path], quantity="accelerance")
    np.testing.assert_array_equal(np.isnan(both.coherence[:, 0]), [[True] * 4, [False] * 4])


def test_a_line_at_0_hz_without_a_number_is_left_out(tmp_path):
    path = tmp_path / "frf.csv"
    path.write_text("frequency [Hz],mag [m/N],phase [deg]\n0,inf,0\n1,2,90\n2,3,0\n")
    np.testing.assert_allclose(read_frf_text([path], quantity="receptance").values[0, 0], [2j, 3], atol=1e-15)
    for first in ("(nan+nanj)", "nan+nanj", "(inf+0j)", "(0+nanj)"):
        path.write_text(f"{first}\n(2+3j)\n(3+4j)\n")
        listed = read_frf_text([path], quantity="receptance", frequency_step=1.0)
        np.testing.assert_array_equal(listed.frequency, [1, 2])
        np.testing.assert_array_equal(listed.values[0, 0], [2 + 3j, 3 + 4j])
    path.write_text("frequency [Hz],re [m/N],im [m/N]\n0,inf,-inf\n1,2,3\n2,3,4\n")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        read_frf_text([path], quantity="receptance")
    path.write_text("frequency [Hz],re [m/N],im [m/N]\n0,NaN,NaN\n1,2,3\n2,3,4\n")
    found = read_frf_text([path], quantity="receptance")
    np.testing.assert_array_equal(found.frequency, [1, 2])
    np.testing.assert_array_equal(found.values[0, 0], [2 + 3j, 3 + 4j])
    assert "the line at 0 Hz, which holds no number, is left out" in found.warnings[0]
    path.write_text("frequency [Hz],re [m/N],im [m/N]\n0,1,2\n1,NaN,3\n2,3,4\n")
    with pytest.raises(InputError, match="NaN at some of its frequencies"):
        read_frf_text([path], quantity="receptance")
