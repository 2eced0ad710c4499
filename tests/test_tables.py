"""Tables of numbers: read in one go where they are clean, line by line where something is to be said, always alike."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from faying import columns as tables
from faying.columns import read_columns, read_numbers
from faying.errors import InputError, ReadError
from faying.export import attach
from faying.measured.mapping import read_points

FORM = "three numbers are due"
NUMBER = st.one_of(st.floats(-1e300, 1e300).map(repr), st.integers(-999, 999).map(str))
# a separator, blanks around it, and now and then another one, a word, nothing
ROW = st.tuples(st.lists(NUMBER, min_size=2, max_size=4), st.sampled_from([",", ", ", ";", " ", "\t", " ;"]))
LINE = st.one_of(
    ROW.map(lambda row: row[1].join(row[0])),
    ROW.map(lambda row: row[1].join(row[0]) + "  # a comment"),
    st.sampled_from(
        ["", "# 1, 2, 3", "x, y, gap", "1 2, 3", "nan, 1, 2", "1,2,inf", "4,5; 1,5; 2", "1_0 2 3", "1,2,,"]
    ),
)


def answer(path):
    try:
        return read_numbers(path, 3, FORM).tolist()
    except ReadError as fault:
        return str(fault)


@given(
    lines=st.lists(LINE, max_size=6), mark=st.sampled_from(["", "\ufeff"]), end=st.sampled_from(["\n", "\r\n", "\r"])
)
def test_both_ways_of_reading_agree(tmp_path_factory, lines, mark, end):
    path = tmp_path_factory.mktemp("table") / "t.csv"
    path.write_bytes((mark + end.join(lines)).encode())
    quick = answer(path)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(tables, "table_in_one_go", lambda *_, **__: None)
        assert repr(answer(path)) == repr(quick)  # NaN, too


def test_a_mark_of_unicode_does_not_hide_the_first_row(tmp_path):
    path = tmp_path / "t.csv"
    path.write_bytes(b"\xef\xbb\xbf1,2,3\n4,5,6\n")
    assert read_numbers(path, 3, FORM).tolist() == [[1, 2, 3], [4, 5, 6]]


def test_rows_of_a_record_keep_their_values_and_lines(tmp_path):
    path = tmp_path / "r.csv"
    path.write_text("# a sensor\ntime [ms],acceleration [m/s^2]\n1,2\n\n2,3  # and so on\n3,nan\n")
    known = {"time": "s", "acceleration": "m/s^2"}
    with pytest.raises(ReadError, match=r"line 6: .*acceleration"):
        read_columns(path, known, needed="time", form=FORM)
    path.write_text(path.read_text().replace("nan", "4"))
    found = read_columns(path, known, needed="time", form=FORM)
    assert found.lines == [3, 5, 6]
    assert found.values["time"] == pytest.approx([1e-3, 2e-3, 3e-3], rel=1e-15)
    assert found.values["acceleration"].tolist() == [2, 3, 4]


@pytest.mark.parametrize(
    "read",
    [
        lambda path: read_numbers(path, 2, FORM),
        lambda path: read_columns(path, {"node": "", "pressure": "Pa"}, needed="pressure", form=FORM),
        attach._table,
        read_points,
    ],
)
def test_the_memory_is_asked_before_the_file_is_read(read, tmp_path, monkeypatch):
    path = tmp_path / "t.csv"
    path.write_text("node,pressure [MPa]\n" + "\n".join(f"{k},{k}" for k in np.arange(1, 4000)) + "\n")
    monkeypatch.setenv("FAYING_MEMORY", "0.001")
    with pytest.raises(InputError, match=r"t.csv: 0.0378 MB of numbers need about 0.00191 GB and 0.001 GB are free"):
        read(path)
