"""What kind a file is: the same content is taken for the same thing under every name, and refused by what it is."""

import gzip
import zipfile

import numpy as np
import pytest

import faying
from faying.decks.included import included
from faying.file_kinds import ABAQUS, NASTRAN, RESULT, STUDY, kind_held, kind_of, taken
from faying.geometry.cad import check_head
from faying.netcdf import Group, Variable, write
from tests.helpers import meshfiles
from tests.helpers.boxes import row

NAMES = ("m.inp", "ds.dat", "all.msh", "m.cdb", "m.bdf", "m.unv", "m.vtu", "m.csv", "m.x3p", "m.step", "m", "m.txt")
TEXTS = {
    "abaqus": meshfiles.abaqus,
    "assembly": meshfiles.assembly,
    "nastran": meshfiles.nastran,
    "gmsh": meshfiles.gmsh,
    "unv": meshfiles.unv,
    "ansys": meshfiles.ansys,
}
CUBE = [(0, 0, 0), (20, 0, 0), (20, 20, 0), (0, 20, 0), (0, 0, 10), (20, 0, 10), (20, 20, 10), (0, 20, 10)]  # mm


def two():
    return row(
        [0.05, 0.04], [2, 1], kinds=("hex8", "hex8"), sections=((2, 1), (2, 1)), width=0.02, height=0.01, gap=1e-4
    )


@pytest.mark.parametrize("form", TEXTS)
def test_a_mesh_is_the_same_under_every_name(tmp_path, form):
    text = TEXTS[form](two())
    for number, name in enumerate(NAMES):
        for ends in ("\n", "\r\n"):
            place = tmp_path / f"{number}{ends == chr(10)}"
            place.mkdir()
            (place / name).write_text(text, newline=ends)
            mesh = faying.read_mesh(place / name, unit="mm")
            assert len(mesh.parts) == 2
            assert np.ptp(mesh.points, axis=0) == pytest.approx([0.0901, 0.02, 0.01], rel=1e-6)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('(0 "GAMBIT to Fluent File")\n(2 3)\n(10 (0 1 8 0))\n', "a mesh of Ansys Fluent"),
        ("*KEYWORD\n*NODE\n1, 0., 0., 0.\n", "LS-DYNA"),
        (f"{'':72}S      1\n1H,,1H;,4HSLOT,\n", "an IGES file"),
        ("ISO-10303-21;\nHEADER;\n", "a STEP file"),
        ("%%MatrixMarket matrix coordinate real symmetric\n", "Matrix Market"),
        ("version https://git-lfs.github.com/spec/v1\noid sha256:0a\nsize 12\n", "a pointer of Git LFS"),
        ("# of AVS\n8 1 0 0 0\n1 0 0 0\n2 20 0 0\n", "a UCD file of AVS"),
    ],
)
def test_what_a_mesh_command_does_not_read_is_refused_by_what_it_is(tmp_path, text, says):
    path = tmp_path / ("all.inp" if "AVS" in says else "all.msh")
    path.write_text(text)
    with pytest.raises(faying.ReadError, match=f"{says}.*not read here.*a mesh of Gmsh") as refusal:
        taken(path, "mesh")
    assert path.name in str(refusal.value)


@pytest.mark.parametrize("form", ["abaqus", "nastran", "gmsh", "unv", "ansys"])
def test_a_mesh_is_no_scan_and_no_step_file(tmp_path, form):
    path = tmp_path / "scan.txt"
    path.write_text(TEXTS[form](two()))
    with pytest.raises(faying.ReadError, match=r"scan.txt is (an input|a mesh|a universal).* an X3P file"):
        faying.read_scan(path, xy_unit="mm", z_unit="um")
    with pytest.raises(faying.ReadError, match=r"is not a STEP file \(it is (an input|a mesh|a universal)"):
        check_head(path)


def test_scans_are_scans_under_the_names_of_decks(tmp_path):
    rows = [f"{x},{y},{(x * y) % 3}" for y in range(8) for x in range(8)]
    expected = None
    for name in ("s.csv", "s.dat", "s.msh", "s"):
        for head in ("", "x,y,z\n", "# exported\n\n"):
            (tmp_path / name).write_text(head + "\n".join(rows) + "\n")
            heights = faying.read_scan(tmp_path / name, xy_unit="um", z_unit="nm").heights
            expected = heights if expected is None else expected
            assert np.array_equal(heights, expected)


def test_a_suffix_decides_where_the_content_fits_several_kinds_or_none(tmp_path):
    for name, says in (("a.sti", "CalculiX"), ("a.inp", "Abaqus"), ("a.xyz", "points"), ("a.what", "points")):
        (tmp_path / name).write_text("1 1 2.5e3\n2 1 -1.\n")
        assert says in kind_of(tmp_path / name).says
    (tmp_path / "frf.dat").write_text("Frequency response of a beam\n")
    assert kind_held(tmp_path / "frf.dat") is None
    assert kind_of(tmp_path / "frf.dat") is NASTRAN
    assert taken(tmp_path / "frf.dat", "test").says == "a table as text"
    assert kind_of(tmp_path / "none.inp") is ABAQUS
    assert kind_of(tmp_path) is None


def test_the_first_lines_of_a_file_say_its_kind(tmp_path):
    path = tmp_path / "job.txt"
    path.write_text("$ made for Abaqus\nSOL 103\nBEGIN BULK\n$\n*NODE\n")
    assert kind_of(path) is NASTRAN
    path.write_text("*HEADING\nmodel\n** /PREP7\n/PREP7\nGRID,1\n")
    assert kind_of(path) is ABAQUS
    path.write_text("    -1\n    58\nGRID of points\n    -1\n")
    assert "test" in kind_of(path).serves
    path.write_text("    -1\n  2411\n    -1\n    -1\n    58\n    -1\n")
    assert kind_of(path).serves == ("test",)
    path.write_text("    -1\n  2411\n    -1\n    -1\n  2412\n    -1\n    -1\n    55\n    -1\n")
    assert "mesh" in kind_of(path).serves
    path.write_text("ID,x,y\n1,2,3\n")
    assert kind_held(path) is None
    path.write_text("time [s],acceleration [m/s^2]\n0,1\n")
    assert kind_held(path) is None
    path.write_text("A page on decks.\n*NODE\n1,0,0,0\n[geometry]\nGRID,1\n/PREP7\n")
    assert kind_held(path) is None
    path.write_text("ID JOB,1\nTIME 10\n\nPARAM,POST,-1\nTITLE = joint\nGRID,1,,0.,0.,0.\n")
    assert kind_of(path) is NASTRAN
    path.write_text('name = "a"\n\n[geometry]\nstep = "a.step"\n')
    assert kind_of(path) is STUDY


def test_a_zip_archive_is_what_its_files_say(tmp_path):
    path = tmp_path / "scan.zip"
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("bindata/data.bin", bytes(100_000))
        archive.writestr("folder/main.xml", "<p/>")
    assert kind_of(path).says == "an X3P file"
    path.write_bytes(path.read_bytes()[:2000])
    assert kind_of(path) is None
    with zipfile.ZipFile(path, "w") as archive:
        archive.writestr("meta.yml", "surfaces: []")
    assert kind_of(path).serves == ("scan",)


def test_a_mesh_packed_by_gzip_is_refused_by_what_it_is(tmp_path):
    path = tmp_path / "all.msh"
    path.write_bytes(gzip.compress(meshfiles.gmsh(two()).encode()))
    with pytest.raises(faying.ReadError, match=r"all.msh is a file packed by gzip, which is not read here"):
        faying.read_mesh(path, unit="mm")


def test_a_saved_result_is_one_under_every_name(tmp_path):
    """Long and short ones; the same without the checksum is any HDF5 file, which its suffix decides."""
    for size in (1, 50_000):
        path = tmp_path / "scan.x3p"
        write(path, Group(variables={"a": Variable(dims=("n",), values=np.random.default_rng(1).random(size))}))
        assert kind_of(path) is RESULT
        with pytest.raises(faying.ReadError, match=r"scan.x3p is a result of Faying"):
            faying.read_scan(path)
        path.write_bytes(path.read_bytes()[:-78])
        assert kind_held(path) is None


def deck(*lines):
    nodes = [f"{number}, {x}, {y}, {z}" for number, (x, y, z) in enumerate(CUBE, 1)]
    return "\n".join(["*NODE", *nodes, "*ELEMENT, TYPE=C3D8, ELSET=BODY", "1,1,2,3,4,5,6,7,8", *lines, ""])


def test_data_lines_of_included_files_belong_to_the_keyword_above(tmp_path):
    """The top of a cube of 20 x 20 x 10 mm from a set whose nodes stand in three files, one within another."""
    (tmp_path / "more, of it.txt").write_text("** names\nNB\n*INCLUDE, INPUT=last.bou\n")
    (tmp_path / "last.bou").write_text("8\n")
    path = tmp_path / "m.inp"
    path.write_text(
        deck("*NSET, NSET=NB", "7", "*NSET, NSET=TOP", "5", '*INCLUDE, INPUT="more, of it.txt"', "6", "*STEP")
    )
    mesh = faying.read_mesh(path, unit="mm")
    face = faying.faces(path, unit="mm").faces[0]
    assert list(mesh.faces) == ["TOP"]
    assert face.area == pytest.approx(4e-4)
    assert face.centre == pytest.approx([0.01, 0.01, 0.01])
    assert {file.name for file in included(path)} == {"more, of it.txt", "last.bou"}
    (tmp_path / "last.bou").unlink()
    with pytest.raises(faying.ReadError, match=r"last\.bou"):
        faying.read_mesh(path, unit="mm")


def test_nodes_of_an_input_file_may_stand_in_files_that_it_includes(tmp_path):
    whole = deck("*NSET, NSET=TOP", "5, 6, 7, 8")
    nodes = whole.splitlines()[1:9]
    (tmp_path / "half.txt").write_text("\n".join(nodes[4:]))
    (tmp_path / "nodes.txt").write_text("\n".join([*nodes[:4], "*include, input=half.txt"]))
    path = tmp_path / "m.inp"
    path.write_text("*NODE, INPUT=nodes.txt\n" + "\n".join(whole.splitlines()[9:]) + "\n")
    assert np.ptp(faying.read_mesh(path, unit="mm").points, axis=0) == pytest.approx([0.02, 0.02, 0.01])


def test_names_of_included_files_may_differ_in_upper_and_lower_case(tmp_path):
    """A deck written on Windows, where names are alike in both cases and folders stand between backslashes."""
    (tmp_path / "Sets").mkdir()
    (tmp_path / "Sets" / "Top.inc").write_text("5, 6, 7, 8\n")
    path = tmp_path / "m.inp"
    path.write_text(deck("*NSET, NSET=TOP", "*INCLUDE, INPUT=sets\\TOP.INC"))
    assert list(faying.read_mesh(path, unit="mm").faces) == ["TOP"]
    assert included(path) == (tmp_path / "Sets" / "Top.inc",)
    bulk = tmp_path / "m.bdf"
    (tmp_path / "Grids.dat").write_text("".join(f"GRID,{k},,{x}.,{y}.,{z}.\n" for k, (x, y, z) in enumerate(CUBE, 1)))
    bulk.write_text("BEGIN BULK\nINCLUDE 'GRIDS.DAT'\nCHEXA,1,1,1,2,3,4,5,6\n+,7,8\nENDDATA\n")
    assert np.ptp(faying.read_mesh(bulk, unit="mm").points, axis=0) == pytest.approx([0.02, 0.02, 0.01])
    (tmp_path / "Grids.dat").unlink()
    with pytest.raises(faying.ReadError, match=r"cannot read .*GRIDS\.DAT"):
        faying.read_mesh(bulk, unit="mm")


def test_format_1_of_gmsh(tmp_path):
    """Two bricks with their faces, as those of format 2.2; that one has no groups by name."""
    text = meshfiles.gmsh(two(), version="2.2")
    (tmp_path / "two.msh").write_text(text)
    nodes, _, elements = text.partition("$EndPhysicalNames\n")[2].partition("$Elements\n")
    rows = [row.split() for row in elements.splitlines()[1:-1]]
    lines = [" ".join([n, kind, group, own, str(len(corners)), *corners]) for n, kind, _, group, own, *corners in rows]
    old = nodes.replace("$Nodes", "$NOD").replace("$EndNodes", "$ENDNOD")
    for name in ("all.inp", "all.msh"):
        (tmp_path / name).write_text("\n".join([old + "$ELM", str(len(lines)), *lines, "$ENDELM", ""]))
        found = faying.read_mesh(tmp_path / name, unit="mm")
        expected = faying.read_mesh(tmp_path / "two.msh", unit="mm")
        assert np.array_equal(found.points, expected.points)
        assert sorted(found.parts) == ["part50", "part51"]
        assert [len(block) for face in found.faces.values() for block in face] == [
            len(block) for face in expected.faces.values() for block in face
        ]
    lines[0] = lines[0].replace(" 8 ", " 7 ", 1)
    (tmp_path / "wrong.msh").write_text("\n".join([old + "$ELM", str(len(lines)), *lines, "$ENDELM", ""]))
    with pytest.raises(faying.ReadError, match="has 7 nodes, where its kind has 8"):
        faying.read_mesh(tmp_path / "wrong.msh", unit="mm")


def test_earlier_formats_of_gmsh_are_alike(tmp_path):
    text = meshfiles.gmsh(two(), version="2.2")
    meshes = []
    for version in ("2", "2.0", "2.1", "2.2"):
        path = tmp_path / f"m{version}.msh"
        path.write_text(text.replace("2.2 0 8", f"{version} 0 8"))
        meshes.append(faying.read_mesh(path, unit="mm"))
    assert all(np.array_equal(mesh.points, meshes[0].points) for mesh in meshes)
    assert all(sorted(mesh.faces) == sorted(meshes[0].faces) for mesh in meshes)
    (tmp_path / "m.msh").write_text(text.replace("2.2 0 8", "3 0 8"))
    with pytest.raises(faying.ReadError, match="has format '3 0 8'"):
        faying.read_mesh(tmp_path / "m.msh", unit="mm")


@pytest.mark.parametrize(
    "line", ["ID = 1", "A(=)=", " ", "$", "#", "**", "x", "-1", "<?", "$Comments", "[a]", "PK", "(5 1"]
)
def test_long_heads_that_nearly_match_are_passed_over(tmp_path, line):
    """Each line fits a pattern in several ways, and none of the kinds: a search that tries them all would not end."""
    (tmp_path / "a.what").write_text(f"{line}\n" * 20_000 + "!")
    assert kind_of(tmp_path / "a.what") is None
    (tmp_path / "b.what").write_text(line * 20_000 + "!")
    assert kind_of(tmp_path / "b.what") is None
