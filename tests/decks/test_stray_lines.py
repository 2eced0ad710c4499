"""Lines that stand outside of what a format knows: a mark or a heading is missing, and what it led would be lost."""

import re
from pathlib import Path

import pytest

import faying
from faying.data_sets import check_data_sets
from faying.measured.text import read_frf_text
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
    with pytest.raises(faying.ReadError, match="is not the number of a data set|is between"):
        check_data_sets(SETS[:missing] + SETS[missing : missing + 1] + SETS[missing:], "f")


@pytest.mark.parametrize("line", ["    5500000", "   58x", "    x"])
def test_a_number_of_a_data_set_stands_alone(line):
    with pytest.raises(faying.ReadError, match="line 2: .* is not the number of a data set"):
        check_data_sets(["    -1", line, "data", "    -1"], "f")


@pytest.mark.parametrize("line", ["    -1*    -1", "    58", "  2411  "])
def test_a_data_set_that_begins_inside_another_is_found(line):
    with pytest.raises(faying.ReadError, match="line 3: .* looks like the beginning of another"):
        check_data_sets([*SETS[:2], line, *SETS[2:]], "f")


def test_a_header_has_seven_lines():
    header = ["    -1", "   151", *["title"] * 7, "    -1"]
    check_data_sets(header, "f")
    with pytest.raises(faying.ReadError, match="line 10: '1.0 2.0' is one line too many for a header"):
        check_data_sets([*header[:-1], "1.0 2.0", "    -1"], "f")


def test_units_have_three_lines():
    units = ["    -1", "   164", "         1SI", "1.0 1.0 1.0", "273.15", "    -1"]
    check_data_sets(units, "f")
    check_data_sets([*units[:4], *units[5:]], "f")
    with pytest.raises(faying.ReadError, match=r"line 6: '273.15' is one line too many for units \(data set 164\)"):
        check_data_sets([*units[:5], *units[4:]], "f")


def test_numbers_inside_a_data_set_are_no_beginning():
    check_data_sets(["    -1", "    82", "        58", "    -1.5  2.0", "    -1    -1", "    -1"], "f")


@pytest.fixture(scope="module")
def seeds(tmp_path_factory):
    return {path.name: path for _, path in written(tmp_path_factory.mktemp("stray"))}


def spoilt(path, begins, change, after=0):
    """The file with one line replaced: the first that begins so, or one `after` it."""
    lines = path.read_text().splitlines()
    at = next(k for k, line in enumerate(lines) if line.startswith(begins)) + after
    other = path.with_name(f"spoilt-{path.name}")
    other.write_text("\n".join([*lines[:at], *change(lines[at]), *lines[at + 1 :]]) + "\n")
    return other


def reworded(path, old, new):
    """The file with one piece of its text replaced, where it stands first."""
    text = path.read_text()
    assert old in text
    other = path.with_name(f"reworded-{path.name}")
    other.write_text(text.replace(old, new, 1))
    return other


@pytest.mark.parametrize(
    ("name", "line", "says"),
    [
        ("real.uff", "    -1", "is not the number of a data set|is between"),
        ("u.unv", "    -1", "has no end"),
        ("four.msh", "$PhysicalNames", "is in no section"),
        ("four.msh", "$EndMeshFormat", "is in no section"),
        ("two.msh", "$EndPhysicalNames", "is in no section"),
        ("two.msh", "6", "announces .* names and has"),
        ("assembly.inp", "*End Instance", "comes before the .END INSTANCE of what began before it"),
        ("assembly.inp", "*End Part", "comes before the .END PART of what began before it"),
        ("a.cdb", "CMBLOCK,P0_LEFT", "gives the form of a block, but the line before is not a command of one"),
    ],
)
def test_a_file_without_one_of_its_lines_is_refused(seeds, name, line, says):
    path: Path = seeds[name]
    cut = spoilt(path, line, lambda found: [])
    read = faying.read_uff if name.endswith("uff") else lambda file: faying.read_mesh(file, unit="mm")
    read(path)
    with pytest.raises(faying.ReadError, match=says):
        read(cut)


@pytest.mark.parametrize(
    ("name", "section", "says"),
    [
        ("two.msh", "$Elements", "says 28 records and has 29 lines"),
        ("two.msh", "$Nodes", "says 63 records and has 64 lines"),
        ("four.msh", "$Entities", "continues after its last record|middle of a record"),
    ],
)
def test_a_count_that_stands_twice_is_refused(seeds, name, section, says):
    twice = spoilt(seeds[name], section, lambda count: [count, count], after=1)
    with pytest.raises(faying.ReadError, match=says):
        faying.read_mesh(twice, unit="mm")


def test_a_physical_volume_without_elements_is_said(seeds):
    path: Path = seeds["two.msh"]
    renamed = path.with_name("renamed.msh")
    renamed.write_text(re.sub(r'(?m)^3 50 "', '3 77 "', path.read_text(), count=1))
    assert renamed.read_text() != path.read_text()
    notes = [note.text for note in faying.read_mesh(renamed, unit="mm").notes]
    assert [text for text in notes if "the physical volume 'p0' has no elements" in text], notes


def test_a_line_too_many_in_a_component_is_refused(seeds):
    twice = spoilt(seeds["a.cdb"], "CMBLOCK", lambda numbers: [numbers, numbers], after=2)
    with pytest.raises(faying.ReadError, match="is not in a block"):
        faying.read_mesh(twice, unit="mm")


def test_blocks_that_are_not_read_are_passed(seeds):
    path: Path = seeds["a.cdb"]
    other = path.with_name("rlblock.cdb")
    block = "RLBLOCK,       1,       1,       6,       7\n(2i8,6g16.9)\n(7g16.9)\n"
    block += "       1       2 1.00000000     -1.00000000E-03\n"
    block += "LCURV,       1, 1,       1,       2,   0.0    ,   1.0\n \n   1   2   0   4   2\n   20.0       20.0\n"
    other.write_text(path.read_text().replace("NBLOCK", block + "NBLOCK", 1))
    assert len(faying.read_mesh(other, unit="mm").points) == len(faying.read_mesh(path, unit="mm").points)


def test_points_are_numbered_from_one(tmp_path):
    file = tmp_path / "p.uff"
    line = f"{-1:10d}{0:10d}{0:10d}{8:10d}{0.1:13.5E}{0:13.5E}{0:13.5E}\n"
    file.write_text(f"    -1\n    15\n{line}    -1\n")
    with pytest.raises(faying.ReadError, match="numbers of points begin at 1"):
        faying.read_uff(file)


def test_a_property_of_nastran_is_a_whole_number(seeds):
    path = seeds["small.bdf"]
    text = re.sub(r"(?m)^(CTETRA  \d+ +)2( +)", r"\g<1>2.5\g<2>", path.read_text(), count=1)
    assert "2.5" in text
    other = path.with_name("half.bdf")
    other.write_text(text)
    with pytest.raises(faying.ReadError, match="is not a whole number"):
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
    with pytest.raises(faying.ReadError, match="row 3 of the numbers has an infinite one"):
        read_heights(file)


@pytest.mark.parametrize("place", ["1e300", "-99999999999999999999", "2147483648"])
def test_a_place_that_nothing_has_is_refused(tmp_path, place):
    from faying.measured.mapping import read_points

    file = tmp_path / "points.csv"
    file.write_text(f"point,x [mm],y [mm],z [mm]\n1,1,2,3\n2,1,{place},3\n")
    with pytest.raises(faying.ReadError, match='line 3: .* in the column "y" is damaged'):
        read_points(file)


def test_a_point_of_a_form_that_nothing_has_is_refused(tmp_path):
    from faying.form.gap_map import read_heights

    file = tmp_path / "form.csv"
    file.write_text("x [mm],y [mm],z [um]\n0,0,1\n1,0,2\n99999999999999999999,1,3\n1,1,2\n")
    with pytest.raises(faying.ReadError, match="row 3 of the numbers holds 1e.17 m, which is damaged"):
        read_heights(file)


def test_an_frf_whose_point_cannot_be_read_is_refused(seeds):
    first = "    4         0    0         0       NONE         1   1       NONE         1   3"
    other = spoilt(seeds["frf.uff"], first, lambda header: [first.removesuffix("1   3") + "x   3"])
    with pytest.raises(faying.ReadError, match="an FRF without a reference point, where other FRFs"):
        faying.read_uff(other)


def test_a_point_in_a_system_that_is_not_there_is_refused(seeds):
    point = "         2         1"
    other = spoilt(seeds["systems.uff"], point, lambda line: [line.replace(point, "         2        -1", 1)])
    with pytest.raises(faying.ReadError, match="point 2 is given in the system -1, which the file does not define"):
        faying.read_uff(other)


def test_an_option_that_is_not_known_is_said(seeds):
    path: Path = seeds["flat.inp"]
    other = path.with_name("option.inp")
    other.write_text(path.read_text().replace(" elset=p1", " e,set=p1", 1))
    assert other.read_text() != path.read_text()
    notes = [note.text for note in faying.read_mesh(other, unit="mm").notes]
    assert [text for text in notes if "*ELEMENT: not known, and passed over: E, SET" in text], notes


def test_a_data_set_without_its_number_is_refused(seeds):
    other = spoilt(seeds["systems.uff"], "    18", lambda number: [])
    with pytest.raises(faying.ReadError, match="is not the number of a data set"):
        faying.read_uff(other)


def test_a_response_over_time_has_no_frequencies(seeds):
    other = spoilt(seeds["frf.uff"], "    4   ", lambda header: ["    1" + header[5:]])
    with pytest.raises(faying.ReadError, match="a time response over frequency"):
        faying.read_uff(other)


def test_a_group_of_elements_that_are_not_there_is_said(seeds):
    path: Path = seeds["u.unv"]
    lines = path.read_text().splitlines()
    assert not [note for note in faying.read_mesh(path, unit="mm").notes if "not in the file" in note.text]
    at = next(k for k, line in enumerate(lines) if line.startswith("         9       115"))
    other = path.with_name("lost.unv")
    other.write_text("\n".join(lines[:at] + lines[at + 2 :]) + "\n")
    notes = [note.text for note in faying.read_mesh(other, unit="mm").notes]
    assert "the group 'p0' names elements that are not in the file: 9" in notes


def test_a_group_with_a_wrong_count_is_refused(seeds):
    other = spoilt(seeds["u.unv"], "p1.right", lambda head: [head[:-1] + "0"], after=-1)
    with pytest.raises(faying.ReadError, match="is where a group has its name|names .* things and has"):
        faying.read_mesh(other, unit="mm")


def test_a_set_of_numbers_that_are_not_there_is_said(seeds):
    other = seeds["flat.inp"].with_name("absent.inp")
    other.write_text(seeds["flat.inp"].read_text() + "*ELSET, ELSET=mine\n17, 1939\n")
    notes = [note.text for note in faying.read_mesh(other, unit="mm").notes]
    assert "the set 'mine' names numbers that are not in the file: 1939" in notes


@pytest.mark.parametrize(
    ("name", "begins", "change", "match"),
    [
        ("u.unv", "       103", lambda line: [line.replace("1         1", "1         x")], "should be 4 whole numbers"),
        ("u.unv", "       103", lambda line: [f"{line}        77"], "should be 4 whole numbers"),
        ("a.cdb", "      103", lambda line: [line.replace("0        0", "0        x", 1)], "should be 3 whole numbers"),
        ("a.cdb", "      103", lambda line: [line.ljust(27 + 6 * 21) + "7"], "should be 3 whole numbers and up to 6"),
        ("two.msh", "2.2 0 8", lambda line: [line, "2.2 0 8"], "is in .MeshFormat, which has one line"),
    ],
)
def test_a_line_with_more_than_it_holds_is_refused(seeds, name, begins, change, match):
    with pytest.raises(faying.ReadError, match=match):
        faying.read_mesh(spoilt(seeds[name], begins, change), unit="mm")


def test_nodes_in_columns_of_several_widths_are_read(seeds):
    path: Path = seeds["a.cdb"]
    other = path.with_name("widths.cdb")
    text = path.read_text().replace("(3i9,6e21.13e3)", "(1i7,2i9,6e21.13e3)")
    other.write_text(re.sub(r"^  (.{7}(?: {8}0){2}.*)$", r"\1", text, flags=re.M))
    assert other.read_text() != text
    one, same = (faying.read_mesh(file, unit="mm") for file in (path, other))
    assert (one.points == same.points).all()


def test_a_load_on_an_element_that_is_not_there_is_said(seeds):
    other = spoilt(seeds["small.bdf"], "PLOAD4  3       25 ", lambda card: [card.replace("25   ", "99925", 1)])
    notes = [note.text for note in faying.read_mesh(other, unit="mm").notes]
    assert notes == ["PLOAD4 names elements that are not in the file: 99925"]


def test_a_phase_without_digits_is_refused(seeds):
    other = spoilt(seeds["polar.csv"], "0.017,", lambda line: [line.replace(",30", ",1e20")])
    with pytest.raises(faying.ReadError, match="a phase of 1.75e\\+18 rad has lost its digits"):
        read_frf_text([other], quantity="accelerance", frequency_step=1.0)


NODE = "   0.0000000000000000D+00   0.0000000000000000D+00   1.0000000000000000D+01"


@pytest.mark.parametrize(
    ("name", "old", "new", "match"),
    [
        ("a.cdb", "      244      217", "      244      217      219", "has 11 nodes in place of 10|and has 11"),
        ("a.cdb", "(3i9,6e21.13e3)", "(2147483648i9,6e21.13e3)", "is not a format"),
        ("two.msh", "2.2 0 8", "2.2 0 1.7", "has format '2.2 0 1.7'"),
        ("small.bdf", "PLOAD4  3       31 ", "PLOAD4  3\0      31 ", "are not numbers of a load set, an element and"),
        ("u.unv", "         2\np0.left", "         0         2\np0.left", "heads a group and should be 8"),
        ("u.unv", NODE, f"{NODE}\n       103         1         1        11\n{NODE[:-1]}2", "103 is given twice"),
    ],
)
def test_a_mesh_with_more_than_its_form_is_refused(seeds, name, old, new, match):
    with pytest.raises(faying.ReadError, match=match):
        faying.read_mesh(reworded(seeds[name], old, new), unit="mm")


def test_a_continuation_that_is_there_twice_is_refused(seeds):
    other = spoilt(seeds["small.bdf"], "+       205     208", lambda line: [line, line])
    with pytest.raises(faying.ReadError, match=r"CTETRA \d+ has more than 10 nodes"):
        faying.read_mesh(other, unit="mm")


@pytest.mark.parametrize(
    ("name", "begins", "change", "says"),
    [
        ("a.cdb", "FINISH", lambda line: [], "has no FINISH: it may be cut short"),
        ("a.cdb", "         9        11", lambda line: [line.replace("13", "97")], "'P0' names elements that .*: 97"),
        (
            "two.msh",
            "37 11 2 51 51",
            lambda line: [line.replace("2 51", "2 0")],
            "1 of 16 solids, 37 for one, are in none",
        ),
    ],
)
def test_parts_that_lose_their_name_are_said(seeds, name, begins, change, says):
    assert not faying.read_mesh(seeds[name], unit="mm").notes
    notes = [note.text for note in faying.read_mesh(spoilt(seeds[name], begins, change), unit="mm").notes]
    assert any(re.search(says, text) for text in notes), notes


@pytest.mark.parametrize(
    ("name", "old", "new", "match"),
    [
        ("real.uff", "   1.0000000000000000D+00   1.0", "   1.0000000000000000D-20   1.0", "between 1e-12 and 1e"),
        ("frf.uff", "         1   3", "         1   1.7", "is longer than the 80 columns"),
        ("frf.uff", "         1   3", "         1   0", "an FRF without a reference direction"),
        ("systems.uff", "         2\n  0.00000e+00  0.0", "         1\n  0.00000e+00  0.0", "two motions of point 1"),
        ("systems.uff", "         2\n  0.00000e+00  0.0", "         0\n  0.00000e+00  0.0", "the mode moves point 0"),
        ("systems.uff", "  1.00000e-02  0.0", "  10  1.00000e-02  0.0", "should have two lines of six numbers"),
        ("systems.uff", "         2         1         1", "         2         1        -1", "moves in the system -1"),
        ("real.uff", "    -1\n", "    -1\x0b\n", "is between two data sets|is not the number|is not a universal file"),
    ],
)
def test_a_test_whose_numbers_lost_their_place_is_refused(seeds, name, old, new, match):
    with pytest.raises(faying.ReadError, match=match):
        faying.read_uff(reworded(seeds[name], old, new))
