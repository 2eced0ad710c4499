"""Decks of bolted joints as other programs write them: what is not geometry is noted, not refused and not lost."""

import re

import numpy as np
import pytest

import faying
from faying.decks.conforming import bodies
from faying.decks.vocabulary import ANSYS_LEFT_OUT, ANSYS_SURFACES, abaqus_kind, nastran_kind

SQUARE = [(0, 0), (20, 0), (20, 20), (0, 20)]


def nodes(first, bottom, height=10.0):
    return {first + k: (*SQUARE[k % 4], bottom + height * (k // 4)) for k in range(8)}


LOW, UP = nodes(1, 0.0), nodes(9, 10.0)  # faces that touch, with nodes of their own


def inp(more="", stacks=(LOW, UP), names=("low", "up")):
    text = "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for some in stacks for n, (x, y, z) in some.items())
    for k, (some, name) in enumerate(zip(stacks, names, strict=True), 1):
        text += f"*ELEMENT, TYPE=C3D8, ELSET={name}\n{k}, " + ", ".join(map(str, some)) + "\n"
    return text + "*NSET, NSET=lowtop\n5, 6, 7, 8\n" + more


def read(tmp_path, text, name="m.inp", **given):
    path = tmp_path / name
    path.write_text(text)
    return faying.read_mesh(path, unit="mm", **given)


def said(mesh):
    return " | ".join(note.text for note in mesh.notes)


def area(mesh, face):
    """Area [m2] of flat quadrangles by the shoelace formula."""
    total = 0.0
    for block in mesh.faces[face]:
        for p in mesh.points[block]:
            total += np.linalg.norm(np.cross(p[1] - p[0], p[2] - p[0])) / 2
            total += np.linalg.norm(np.cross(p[2] - p[0], p[3] - p[0])) / 2
    return total


# Abaqus and CalculiX


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("*NODE\n301, 1, 1, 1\n*MPC\nMEANROT, 13, 301\n", ["*MPC (1): couplings", "no element and are left out: 301"]),
        ("*NODE\n301, 1, 1, 1\n*EQUATION\n2\n13,1,1.,301,1,-1.\n*EQUATION\n2\n13,2,1.,301,2,-1.\n", ["*EQUATION (2)"]),
        ("*NODE\n301, 1, 1, 1\n", ["1 nodes belong to no element and are left out: 301"]),
        ("*NODE\n201,1,1,9\n202,1,1,8\n*RIGID BODY, NSET=lowtop, REF NODE=201, ROT NODE=202\n", ["2 reference points"]),
        ("*SURFACE, NAME=a\n1, S2\n*SURFACE, NAME=b\n2, S1\n*TIE, NAME=t\nb, a\n", ["*TIE (1): contact and ties"]),
        ("*CONTACT PAIR, INTERACTION=i\nx, y\n*CLEARANCE, MASTER=x, SLAVE=y, VALUE=0\n", ["*CONTACT PAIR (1), *CLEAR"]),
        ("*BOLT TENSIONER, SPEED=3\n1, 2\n", ["*BOLT TENSIONER: not known, and passed over"]),
        ("*NSET, NSET=far, GENERATE\n5, 900, 1\n", ["'far' is generated up to 900", "those in the file, 12"]),
        ("*NODE\n401,0,0,-5\n402,20,0,-5\n403,20,20,-5\n404,0,20,-5\n*ELEMENT, TYPE=S4, ELSET=floor\n"
         "77,401,402,403,404\n*SURFACE, NAME=fl\nfloor, SPOS\n*SURFACE, NAME=one\n77, SNEG\n",
         ["the surface 'fl' lies on elements that are not solids", "surface 'one'", "shells 'floor' are not on"]),
        ("*NODE\n501,5,5,0\n502,5,5,20\n*ELEMENT, TYPE=B31, ELSET=bolt\n11,501,502\n*ELSET, ELSET=all\nlow,up,bolt\n",
         ["1 elements B31 are left out"]),
    ],
)  # fmt: skip
def test_what_is_no_geometry_is_noted(tmp_path, more, words):
    mesh = read(tmp_path, inp(more))
    assert list(mesh.parts) == ["low", "up"]
    assert area(mesh, "lowtop") == pytest.approx(4e-4)
    for word in words:
        assert word in said(mesh)


def test_nothing_is_noted_where_nothing_is_left_out(tmp_path):
    more = "*MATERIAL, NAME=s\n*ELASTIC\n210000., .3\n*STEP\n*STATIC\n*BOUNDARY\nlowtop, 1\n*NODE FILE\nU\n*END STEP\n"
    assert not read(tmp_path, inp(more)).notes


def test_a_pre_tension_section_is_quoted_and_its_cut_left_out(tmp_path):
    bolt = {**LOW, **{n: at for n, at in nodes(5, 10.0).items() if n > 8}}
    text = "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in bolt.items()) + "99, 0, 0, 0\n"
    text += "*ELEMENT, TYPE=C3D8, ELSET=shank\n1,1,2,3,4,5,6,7,8\n2,5,6,7,8,9,10,11,12\n*NSET, NSET=head\n9,10,11,12\n"
    text += "*SURFACE, NAME=Cut\n1, S2\n*PRE-TENSION SECTION, SURFACE=CUT, NODE=99\n0., 0., 1.\n"
    mesh = read(tmp_path, text)
    assert list(mesh.parts) == ["shank"]
    assert list(mesh.faces) == ["head"]
    assert "*PRE-TENSION SECTION, SURFACE=CUT, NODE=99, direction 0., 0., 1." in said(mesh)
    assert "give the bolt in [[bolt]]" in said(mesh)


def test_instances_by_dot_and_number_and_in_other_case(tmp_path):
    body = "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in LOW.items())
    part = f"*PART, NAME=Block\n*NODE\n{body}*ELEMENT, TYPE=C3D8R, ELSET=e\n1, 1,2,3,4,5,6,7,8\n*END PART\n"
    text = part + "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=Lower, PART=BLOCK\n*END INSTANCE\n"
    text += "*INSTANCE, NAME=Upper, PART=block\n0, 0, 10\n*END INSTANCE\n"
    text += "*NSET, NSET=s1\nlower.5, Lower.6, LOWER.7, Lower.8\n*SURFACE, NAME=su\nupper.1, S1\n"
    text += "*NSET, NSET=s3, INSTANCE=UPPER, GENERATE\n5, 40\n*END ASSEMBLY\n"
    mesh = read(tmp_path, text)
    assert list(mesh.parts) == ["Lower", "Upper"]
    for face, part, height in (("s1", "Lower", 0.01), ("su", "Upper", 0.01), ("s3", "Upper", 0.02)):
        assert mesh.face_part[face] == part
        assert area(mesh, face) == pytest.approx(4e-4)
        assert mesh.points[np.concatenate([b.ravel() for b in mesh.faces[face]])][:, 2] == pytest.approx(height)
    with pytest.raises(faying.ReadError, match="names the set 'Middle.5'"):
        read(tmp_path, text.replace("lower.5", "Middle.5"))


@pytest.mark.parametrize(
    ("more", "faces"),
    [
        ("*SURFACE, NAME=lowtop, TYPE=NODE\nlowtop\n", {"lowtop"}),
        ("*SURFACE, NAME=LOWTOP, TYPE=NODE\nlowtop,\n", {"lowtop"}),
        (
            "*NSET, NSET=foot\n1,2,3,4\n*SURFACE, NAME=lowtop, TYPE=NODE\nfoot, 1.\n",
            {"lowtop", "foot", "lowtop_SURFACE"},
        ),
    ],
)
def test_surfaces_of_nodes_have_names_of_their_own(tmp_path, more, faces):
    mesh = read(tmp_path, inp(more))
    assert set(mesh.faces) == faces


def test_a_surface_on_all_of_a_part_does_not_hide_it(tmp_path):
    mesh = read(tmp_path, inp("*SURFACE, NAME=skin\nlow,\n"))
    assert list(mesh.parts) == ["low", "up"]
    assert area(mesh, "skin") == pytest.approx(2 * 4e-4 + 4 * 2e-4)


@pytest.mark.parametrize(
    ("mangled", "read_as"),
    [
        (lambda text: "\ufeff" + text, 1),  # a mark of the encoding
        (lambda text: ">**\n  a title\n" + text, 1),
        (lambda text: text.replace("*NSET", " \t*NSET").replace("*ELEMENT", "  *Element"), 1),
        (lambda text: text + "  ** a comment, 12\n ****\n*NSET, NSET=b\n1\n", 1),
    ],
)
def test_blanks_titles_and_marks_before_keywords_change_nothing(tmp_path, mangled, read_as):
    mesh = read(tmp_path, mangled(inp()))
    assert list(mesh.parts) == ["low", "up"]
    assert len(mesh.points) == 16 * read_as
    assert area(mesh, "lowtop") == pytest.approx(4e-4)


def test_numbers_before_the_first_keyword_are_not_passed_over(tmp_path):
    with pytest.raises(faying.ReadError, match="line 1: data before the first keyword"):
        read(tmp_path, "17, 0., 0., 0.\n" + inp())


def test_elements_keep_to_lines_of_their_own(tmp_path):
    """Nine lines of ten numbers are ninety: ten elements of eight nodes, none of which is in the file."""
    rows = "".join(f"{k}, " + ", ".join(str(k + j) for j in range(9)) + "\n" for k in range(1, 10))
    text = "*NODE\n" + "".join(f"{k}, {k}, {k % 3}, {k % 5}\n" for k in range(1, 20)) + "*ELEMENT, TYPE=C3D8\n" + rows
    with pytest.raises(faying.ReadError, match="the lines of element 1 hold 10 numbers, where one of type C3D8 has 9"):
        read(tmp_path, text)
    split = inp().replace("1, 1, 2, 3, 4, 5,", "1, 1, 2, 3, 4,\n 5,")  # two lines make one element
    assert len(read(tmp_path, split).points) == 16


def test_elements_of_fluids_and_users_are_left_out_with_a_note(tmp_path):
    mesh = read(tmp_path, inp("*ELEMENT, TYPE=D, ELSET=gas\n21, 1, 2, 3\n*ELEMENT, TYPE=U1\n22, 1, 9\n"))
    assert list(mesh.parts) == ["low", "up"]
    assert "1 elements D are left out" in said(mesh)
    assert "1 elements U1 are left out" in said(mesh)


TWO = {n: at for n, at in nodes(5, 10.0).items() if n > 8}


SECTIONS = "*SOLID SECTION, ELSET=steel, MATERIAL=s\n*SOLID SECTION, ELSET=alu, MATERIAL=a\n"


def column(more=""):
    """Two cubes that share four nodes, each with a section of its own."""
    text = "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in {**LOW, **TWO}.items())
    text += "*ELEMENT, TYPE=C3D8, ELSET=steel\n1,1,2,3,4,5,6,7,8\n"
    return text + f"*ELEMENT, TYPE=C3D8, ELSET=alu\n2,5,6,7,8,9,10,11,12\n{SECTIONS}{more}"


def test_sections_that_share_nodes_are_parts_of_one_body(tmp_path):
    """Springs in series: a force F lengthens the column by F (L/E1 A + L/E2 A) where nothing contracts."""
    from faying.fe.elasticity import assemble

    mesh = read(tmp_path, column())
    assert mesh.bodies == (("steel", "alu"),)
    assert "'steel' and 'alu' (4 nodes)" in said(mesh)
    assert set(mesh.faces) == {"steel.alu", "alu.steel"}
    assert mesh.is_shared("steel.alu")
    E = {"steel": 200e9, "alu": 70e9}
    made = {part: faying.Material(name=part, E=value, nu=0.0, density=1.0) for part, value in E.items()}
    K = assemble(mesh, made)[0].toarray()
    free = np.flatnonzero(np.repeat(mesh.points[:, 2] > 1e-9, 3))
    pull = np.zeros(len(K))
    top = np.flatnonzero(mesh.points[:, 2] > 0.019)
    pull[3 * top + 2] = 1000.0 / len(top)
    moved = np.zeros(len(K))
    moved[free] = np.linalg.solve(K[np.ix_(free, free)], pull[free])
    assert moved[3 * top + 2] == pytest.approx(1000 * sum(0.01 / (one * 4e-4) for one in E.values()), rel=1e-9)


@pytest.mark.parametrize(
    ("more", "apart"),
    [
        ("*NSET, NSET=mid\n5,6,7,8\n", True),  # on both parts
        ("*SURFACE, NAME=a\n1, S2\n*SURFACE, NAME=b\n2, S1\n", True),
        ("*NSET, NSET=side\n1,2,6,5\n*SURFACE, NAME=top\n2, S2\n", False),  # they only meet the edge of the interface
        ("*SURFACE, NAME=skin\nsteel,\n", False),  # the free faces
        ("*NSET, NSET=all_of_steel\n1,2,3,4,5,6,7,8\n", False),  # the whole skin names no side
    ],
)
def test_a_face_named_between_parts_that_share_nodes_is_a_joint(tmp_path, more, apart):
    mesh = read(tmp_path, column(more))
    assert len(mesh.bodies) == (2 if apart else 1)
    assert len(mesh.points) == (16 if apart else 12)


@pytest.mark.parametrize("named", ["steel", "alu"])
def test_a_face_named_on_one_side_alone_bonds_nothing(named):
    """Two cubes on each other; the side between them as a face of one of them."""
    blocks = {"steel": (np.arange(8)[None],), "alu": (np.arange(4, 12)[None],)}
    faces = {"mid": (np.array([[4, 5, 6, 7]]),)}
    assert bodies(blocks, faces, {"mid": named}, 12).pairs == ()
    assert bodies(blocks, {}, {}, 12).pairs == (("steel", "alu"),)


def test_a_set_of_the_file_keeps_its_name(tmp_path):
    mesh = read(tmp_path, column("*NSET, NSET=steel.alu\n1,2,3,4\n"))
    assert mesh.points[mesh.face_nodes("steel.alu")][:, 2] == pytest.approx(0)
    assert mesh.is_shared("alu.steel")


def test_a_face_on_a_part_of_what_is_shared_is_refused(tmp_path):
    """Half of an interface bonded and half of it a joint is what a node forgotten in a set would make."""
    wide = {**LOW, **{20 + n: (x + 20, y, z) for n, (x, y, z) in LOW.items() if x == 20}}
    over = {30 + n: (x, y, z + 20) for n, (x, y, z) in wide.items() if z == 0}
    text = "*NODE\n" + "".join(f"{n}, {x}, {y}, {z}\n" for n, (x, y, z) in {**wide, **over}.items())
    text += "*ELEMENT, TYPE=C3D8, ELSET=low\n1,1,2,3,4,5,6,7,8\n2,2,22,23,3,6,26,27,7\n"
    text += "*ELEMENT, TYPE=C3D8, ELSET=up\n3,5,6,7,8,31,32,33,34\n4,6,26,27,7,32,52,53,33\n"
    assert read(tmp_path, text).bodies == (("low", "up"),)
    with pytest.raises(faying.InputError, match="part 'low' shares 4 nodes with other parts .* with 'up'"):
        read(tmp_path, text + "*NSET, NSET=mid\n5,6,7,8\n")


def test_sets_of_one_body_are_joined_by_a_plus(tmp_path):
    text = column()
    assert read(tmp_path, text).bodies == (("steel", "alu"),)
    mesh = read(tmp_path, text, parts={"body": "steel + alu"})
    assert list(mesh.parts) == ["body"]
    assert sum(len(block) for block in mesh.parts["body"]) == 2
    with pytest.raises(faying.InputError, match="names the element set 'brass'"):
        read(tmp_path, text, parts={"body": "steel+brass"})


def test_keywords_are_of_one_kind():
    assert [abaqus_kind(word) for word in ("TIE", "PRE-TENSION SECTION", "MPC", "STATIC", "NODE", "FOO")] == [
        "contact",
        "bolt",
        "constraint",
        "",
        "",
        None,
    ]
    assert [nastran_kind(word) for word in ("BCTABLE", "BOLT", "MPC", "GRID")] == [
        "contact",
        "bolt",
        "constraint",
        None,
    ]
    assert not set(ANSYS_LEFT_OUT) & set(ANSYS_SURFACES)
    assert not ({185, 186, 187, 285, 45, 95, 92} & (set(ANSYS_LEFT_OUT) | set(ANSYS_SURFACES)))


# Nastran


def bdf(case="", more=""):
    grids = "".join(f"GRID,{n},,{x:.1f},{y:.1f},{z:.1f}\n" for n, (x, y, z) in LOW.items())
    return f"SOL 103\nCEND\n{case}BEGIN BULK\n{grids}CHEXA,101,1,1,2,3,4,5,6\n+,7,8\nPSOLID,1,1\n{more}ENDDATA\n"


@pytest.mark.parametrize(
    ("case", "faces", "words"),
    [
        ("SET 80 = 101\nSTRESS(PLOT) = 80\n", set(), "SET80 of the case control holds elements, as STRESS = 80 says"),
        ("SET 80 = 1,2,3,4\nSTRESS(PLOT) = 80\n", set(), "SET80 of the case control holds elements"),
        ("SET 7 = 5 THRU 8\nELFORCE(SORT1,REAL) = 7 $ bolts\n", set(), "as ELFORCE = 7 says"),
        ("SET 80 = 1,2,3,4\nDISP(PLOT) = 80\n", {"SET80"}, ""),
        ("SET 80 = 1,2,3,4\n", {"SET80"}, ""),
        ("SET 80 = 1,2,101\n", set(), "SET80 of the case control has something that is not a grid"),
    ],
)
def test_sets_of_the_case_control(tmp_path, case, faces, words):
    mesh = read(tmp_path, bdf(case), "m.bdf")
    assert set(mesh.faces) == faces
    assert words in said(mesh)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("GRID,21,,50.,0.,0.\nGRID,22,,10.,10.,0.\nGRID,23,,10.,10.,9.\nCBAR,201,2,22,23,21\n", "1 cards CBAR"),
        ("GRID,21,,50.,0.,0.\nGRID,22,,10.,10.,0.\nGRID,23,,10.,10.,9.\nCBEAM,201,2,22,23,21\n", "1 cards CBEAM"),
        ("GRID,22,,10.,10.,0.\nGRID,23,,10.,10.,9.\nCBAR,201,2,22,23,1.,0.,0.\n", "1 cards CBAR"),
        ("MPC,1,5,1,1.,6,1,-1.\n", "MPC (1): couplings and constraints are left out"),
        ("BOLT,1,1,5,6\nBOLTFOR,2,1000.,1\n", "BOLT (1), BOLTFOR (1): the preload of bolts is left out"),
        ("CSHEAR,301,3,1,2,3,4\n", "1 cards CSHEAR"),
        ("GRID,31,,30.,0.,0.\nCQUAD,302,3,1,2,3,4,31\n", "1 cards CQUAD"),
        ("CHBDYE,303,101,2\nCONV,303,9\nCLOAD,1,1.\nCBARAO,1,LE\n", "1 cards CHBDYE"),
        ("DEQATN  301     Z(A,B,C,D,E,F,G,H,I,J)=SUM(A,B,C,D,E,F,G,H)\n        +A*B,C,1,2,3,4,5,6,7,8,9\n", ""),
        ("BCTABLE,1,SLAVE,3\nBSURF,3,101\n", "BCTABLE (1), BSURF (1): contact and ties are left out"),
    ],
)
def test_cards_that_are_left_out(tmp_path, more, words):
    mesh = read(tmp_path, bdf("", more), "m.bdf")
    assert len(mesh.points) == 8
    assert words in said(mesh)


def test_elements_that_may_be_solids_are_never_passed_over(tmp_path):
    with pytest.raises(faying.ReadError, match="elements CPYRAM are not known"):
        read(tmp_path, bdf("", "CPYRAM,7,1,1,2,3,4,5\n"), "m.bdf")


def test_loads_on_shells_with_thru(tmp_path):
    shells = "CQUAD4,301,3,5,6,7,8\nCQUAD4,302,3,1,2,3,4\n"
    mesh = read(tmp_path, bdf("", shells + "PLOAD4,3,301,-500.,,,,THRU,302\n"), "m.bdf")
    assert not any(name.startswith("PLOAD4") for name in mesh.faces)
    with pytest.raises(faying.ReadError, match="PLOAD4 with THRU, which is for shells, names the solid 101"):
        read(tmp_path, bdf("", shells + "PLOAD4,3,100,-500.,,,,THRU,302\n"), "m.bdf")


# ANSYS


def cdb(types="ET,1,185\n", more="", extra=(), blocks=(LOW, UP)):
    every = {n: at for some in blocks for n, at in some.items()} | dict(extra)
    text = "/PREP7\n" + types + f"NBLOCK,6,SOLID,{max(every):9d},{len(every):9d}\n(3i9,6e21.13e3)\n"
    text += "".join(f"{n:9d}{0:9d}{0:9d}" + "".join(f"{v:21.13E}" for v in at) + "\n" for n, at in every.items())
    rows = [(1, some) for some in blocks] + [(2, some) for some in more or ()]
    text += f"N,R5.3,LOC,       -1,\nEBLOCK,19,SOLID,{len(rows):9d},{len(rows):9d}\n(19i9)\n"
    for k, (kind, some) in enumerate(rows, 1):
        text += "".join(f"{v:9d}" for v in (1, kind, 1, 1, 0, 0, 0, 0, len(some), 0, k, *some)) + "\n"
    return (
        text + f"{-1:9d}\nCMBLOCK,TOP     ,NODE,       4\n(8i10)\n" + "".join(f"{n:10d}" for n in range(13, 17)) + "\n"
    )


@pytest.mark.parametrize("key", [0, 2])
def test_types_in_blocks(tmp_path, key):
    numbers = [(1, 185), (2, 154), (3, 186)][: 3 if key else 1]
    rows = "".join(f"{a:9d}{b:9d}" + f"{key:9d}" * 18 + "\n" for a, b in numbers)
    mesh = read(tmp_path, cdb(f"ETBLOCK,{len(numbers):9d},{3:9d}\n(2i9,19a9)\n{rows}{-1:9d}\n"), "m.cdb")
    assert len(mesh.parts) == 2
    assert area(mesh, "TOP") == pytest.approx(4e-4)
    with pytest.raises(faying.ReadError, match="ETBLOCK says 7 types and has"):
        read(tmp_path, cdb(f"ETBLOCK,{7:9d},{3:9d}\n(2i9,19a9)\n{rows}{-1:9d}\n"), "m.cdb")


@pytest.mark.parametrize(
    ("kind", "elements", "words"),
    [
        (179, [(5, 9, 99), (6, 10, 99)], "2 elements of type 179 (pretension of bolts) are left out"),
        (39, [(5, 99)], "1 elements of type 39 (springs and dampers)"),
        (40, [(5, 99)], "1 elements of type 40 (springs and dampers)"),
        (178, [(5, 99)], "1 elements of type 178 (contact)"),
        (177, [(5, 99)], "1 elements of type 177 (contact)"),
        (181, [(1, 2, 3, 99)], "1 elements of type 181 (shells)"),
    ],
)
def test_elements_of_ansys_that_are_no_solids(tmp_path, kind, elements, words):
    text = cdb(f"ET,1,185\nET,2,{kind}\n", elements, {99: (10.0, 10.0, 5.0)})
    mesh = read(tmp_path, text + "CE,1,0,5,UX,1\nCP,2,UX,5,6\n", "m.cdb")
    assert len(mesh.points) == 16
    assert words in said(mesh)
    assert "CE (1), CP (1): couplings and constraints are left out" in said(mesh)
    assert ("give the bolts in [[bolt]]" in said(mesh)) == (kind == 179)


# Gmsh


def test_nodes_of_no_element_in_an_archive_that_counts_are_noted(tmp_path):
    """Its blocks hold as many lines as their heads say, so that it is not cut short."""
    extra = {40 + k: (float(k), 0.0, 0.0) for k in range(30)}
    mesh = read(tmp_path, cdb(extra=extra), "m.cdb")
    assert len(mesh.points) == 16
    assert "30 nodes belong to no element and are left out" in said(mesh)
    lines = cdb(extra=extra).splitlines(keepends=True)
    uncounted = "".join(re.sub(r"^(EBLOCK,19,SOLID).*", r"\1", line) for line in lines)
    with pytest.raises(faying.InputError, match="30 of 46 nodes belong to no element"):
        read(tmp_path, uncounted, "m.cdb")


def test_nodes_of_no_element_in_a_deck_that_ends_with_its_step_are_noted(tmp_path):
    """As in a deck of 8-node bricks with the middle nodes of 20-node ones; without *END STEP it may be cut short."""
    extra = "*NODE\n" + "".join(f"{40 + k}, {k}., 0., 0.\n" for k in range(30))
    mesh = read(tmp_path, inp(extra + "*STEP\n*FREQUENCY\n3\n*END STEP\n"), "m.inp")
    assert "30 nodes belong to no element and are left out" in said(mesh)
    with pytest.raises(faying.InputError, match=r"30 of \d+ nodes belong to no element"):
        read(tmp_path, inp(extra), "m.inp")


def test_an_element_in_two_groups_is_one(tmp_path):
    lines = [f"{n} {x} {y} {z}" for n, (x, y, z) in {**LOW, **UP}.items()]
    cells = []
    for some, groups in ((LOW, (1, 2)), (UP, (3,))):
        cells += [f"5 2 {group} 1 " + " ".join(map(str, some)) for group in groups]
        top = list(some)[4:]
        cells += [f"3 2 {group} 1 " + " ".join(map(str, top)) for group in (4, 5)[: len(groups)]]
    names = ['3 1 "body"', '3 2 "steel"', '3 3 "lid"', '2 4 "top"', '2 5 "loaded"']
    text = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n5\n" + "\n".join(names) + "\n$EndPhysicalNames\n"
    text += f"$Nodes\n{len(lines)}\n" + "\n".join(lines) + f"\n$EndNodes\n$Elements\n{len(cells)}\n"
    text += "\n".join(f"{k} {line}" for k, line in enumerate(cells, 1)) + "\n$EndElements\n"
    mesh = read(tmp_path, text, "m.msh")
    assert set(mesh.parts) == {"body", "lid"}
    assert "'steel' and 'body' have the same elements" in said(mesh)
    for face in ("body.top", "body.loaded"):
        name = face if face in mesh.faces else face.removeprefix("body.")
        assert area(mesh, name) == pytest.approx(4e-4)


def test_a_set_of_all_nodes_of_the_solids_is_no_face(tmp_path):
    every = "*NODE\n301, 1, 1, 1\n*NSET, NSET=NALL, GENERATE\n1, 16\n"
    assert set(read(tmp_path, inp(every)).faces) == {"lowtop"}
