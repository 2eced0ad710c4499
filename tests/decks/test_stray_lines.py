"""Lines that stand outside of what a format knows: a mark or a heading is missing, and what it led would be lost."""

import re
from pathlib import Path

import pytest

import faying
from faying.text import check_data_sets
from tests.fuzz.seeds import written

SETS = ["    -1", "   151", "title", "    -1", "    -1", "    58b     1", "data", "", "    -1", ""]


def test_data_sets_in_order_are_fine():
    check_data_sets(SETS, "f")
    check_data_sets([*SETS, "\x1a"], "f")
    check_data_sets([], "f")


@pytest.mark.parametrize("missing", [k for k, line in enumerate(SETS) if line.strip() == "-1"][:-1])
def test_a_mark_that_is_missing_or_twice_is_found(missing):
    """The last one shows by the end of the file, which the readers look at themselves."""
    with pytest.raises(faying.ReadError, match="f, line [0-9]+: .*"):
        check_data_sets(SETS[:missing] + SETS[missing + 1 :], "f")
    with pytest.raises(faying.ReadError, match="is not the number of a data set|stands between"):
        check_data_sets(SETS[:missing] + SETS[missing : missing + 1] + SETS[missing:], "f")


@pytest.fixture(scope="module")
def seeds(tmp_path_factory):
    return {path.name: path for _, path in written(tmp_path_factory.mktemp("stray"))}


@pytest.mark.parametrize(
    ("name", "line", "says"),
    [
        ("real.uff", "    -1", "is not the number of a data set|stands between"),
        ("u.unv", "    -1", "has no end"),
        ("four.msh", "$PhysicalNames", "is in no section"),
        ("four.msh", "$EndMeshFormat", "is in no section"),
        ("two.msh", "$EndPhysicalNames", "is in no section"),
        ("two.msh", "6", "announces .* names and holds"),
        ("a.cdb", "CMBLOCK,P0_LEFT", "tells the form of a block, and the line before is no command of one"),
    ],
)
def test_a_file_without_one_of_its_lines_is_refused(seeds, name, line, says):
    path: Path = seeds[name]
    lines = path.read_text().splitlines(keepends=True)
    at = next(k for k, text in enumerate(lines) if text.startswith(line))
    cut = path.with_name(f"cut-{at}-{name}")
    cut.write_text("".join(lines[:at] + lines[at + 1 :]))
    read = faying.read_uff if name.endswith("uff") else lambda file: faying.read_mesh(file, unit="mm")
    read(path)
    with pytest.raises(faying.ReadError, match=says):
        read(cut)


def test_a_property_of_nastran_is_a_whole_number(seeds):
    path = seeds["small.bdf"]
    text = re.sub(r"(?m)^(CTETRA  \d+ +)2( +)", r"\g<1>2.5\g<2>", path.read_text(), count=1)
    assert "2.5" in text
    other = path.with_name("half.bdf")
    other.write_text(text)
    with pytest.raises(faying.ReadError, match="is no whole number"):
        faying.read_mesh(other, unit="mm")


def test_data_sets_that_are_not_read_are_said(seeds):
    path: Path = seeds["real.uff"]
    assert not [one for one in faying.read_uff(path).warnings if "are not read" in one]
    other = path.with_name("other.uff")
    other.write_text(path.read_text().rstrip("\n") + "\n    -1\n  2477\n         1\n    -1\n")
    assert [one for one in faying.read_uff(other).warnings if "data sets 2477 are not read" in one]


def test_a_list_holds_no_infinite_number(tmp_path):
    from faying.form.gap_map import read_heights

    file = tmp_path / "form.csv"
    file.write_text("x [mm],y [mm],z [um]\n0,0,1\n1,0,2\n0,1,-inf\n1,1,nan\n")
    with pytest.raises(faying.ReadError, match="row 3 of the numbers holds an infinite one"):
        read_heights(file)
