"""Names of parts in STEP files: of solids, of products, given twice; and what a bare machine is told."""

import builtins
import re

import pytest

import faying
from faying.geometry.cad import decoded, files_of, kernel, read_parts, read_products
from faying.geometry.geometry import mesh_step
from faying.geometry.selectors import Selector


def assembly(tmp_path, *parts, loose=False):
    """A STEP file of several products in one assembly, one block each, on top of each other.

    parts: (name of the product, name of its solid); loose: without the assembly.
    """
    from netgen.occ import Box, Pnt

    bodies, head = [], ""
    for number, (product, solid) in enumerate(parts):
        low = 10 * number
        box = next(iter(Box(Pnt(0, 0, low), Pnt(20, 20, low + 10)).solids))
        box.name = "the-solid"
        for face in box.faces:
            flat = abs(face.center.z - low - 5) > 1
            face.name = f"{number}.{'top' if face.center.z > low + 9 else 'bottom'}" if flat else ""
        path = tmp_path / f"one-{number}.step"
        box.WriteStep(str(path))
        head, _, rest = path.read_text().partition("DATA;")
        body = rest.partition("ENDSEC;")[0]
        assert "MANIFOLD_SOLID_BREP('the-solid'" in body
        body = body.replace("MANIFOLD_SOLID_BREP('the-solid'", f"MANIFOLD_SOLID_BREP('{solid}'")
        body = re.sub(r"PRODUCT\('[^']*',\s*'[^']*'", f"PRODUCT('{product}','{product}'", body)
        bodies.append(re.sub(r"#(\d+)", lambda found, by=100_000 * number: f"#{int(found[1]) + by}", body))
    path = tmp_path / "assembly.step"
    whole = "" if loose else joined(bodies)
    path.write_text(f"{head}DATA;{''.join(bodies)}{whole}ENDSEC;\nEND-ISO-10303-21;\n")
    return path


def joined(bodies):
    """The entities of an assembly of the products of several files, each where it is."""

    def of(body, pattern):
        return re.search(pattern, body, re.DOTALL).groups()

    lines, axes = [], []
    for k, body in enumerate(bodies):
        (definition,) = of(body, r"#(\d+)\s*=\s*PRODUCT_DEFINITION\(")
        (rep,) = of(body, r"SHAPE_DEFINITION_REPRESENTATION\(#\d+,\s*#(\d+)\)")
        axis, context = of(body, rf"#{rep}\s*=\s*ADVANCED_BREP_SHAPE_REPRESENTATION\('',\s*\(#(\d+).*?\),\s*#(\d+)\)")
        n = 900_000 + 10 * k
        lines += [
            f"#{n}=NEXT_ASSEMBLY_USAGE_OCCURRENCE('{k}','','',#990004,#{definition},$);",
            f"#{n + 1}=PRODUCT_DEFINITION_SHAPE('','',#{n});",
            f"#{n + 2}=ITEM_DEFINED_TRANSFORMATION('','',#{axis},#{axis});",
            f"#{n + 3}=(REPRESENTATION_RELATIONSHIP('','',#{rep},#990007)"
            f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{n + 2})SHAPE_REPRESENTATION_RELATIONSHIP());",
            f"#{n + 4}=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{n + 3},#{n + 1});",
        ]
        axes.append(f"#{axis}")
    kind, of_definition = of(bodies[0], r"#(\d+)\s*=\s*PRODUCT_CONTEXT\(.*?#(\d+)\s*=\s*PRODUCT_DEFINITION_CONTEXT\(")
    return "\n".join(
        [
            *lines,
            f"#990002=PRODUCT('whole','whole','',(#{kind}));",
            "#990003=PRODUCT_DEFINITION_FORMATION('','',#990002);",
            f"#990004=PRODUCT_DEFINITION('design','',#990003,#{of_definition});",
            "#990005=PRODUCT_DEFINITION_SHAPE('','',#990004);",
            f"#990007=SHAPE_REPRESENTATION('',({','.join(axes)}),#{context});",
            "#990006=SHAPE_DEFINITION_REPRESENTATION(#990005,#990007);\n",
        ]
    )


def test_parts_of_an_assembly_have_the_names_of_their_products(tmp_path):
    path = assembly(tmp_path, ("upper arm", "Boss"), ("lower arm", "Pad"))
    given = {
        "low": Selector(part="upper arm", nearest=(10e-3, 10e-3, 0.0)),
        "high": Selector(part="lower arm", nearest=(10e-3, 10e-3, 20e-3)),
    }
    mesh = mesh_step(path, size=8e-3, faces=given)
    assert not mesh.notes
    heights = [mesh.points[mesh.part_nodes(name), 2].mean() for name in ("upper arm", "lower arm")]
    assert heights == pytest.approx([5e-3, 15e-3], abs=1e-3)
    assert area_of(mesh, "low") == pytest.approx(400e-6, rel=1e-9)


@pytest.mark.parametrize(
    ("occurrences", "names"),
    [
        (("", ""), ["plate_1", "plate_2"]),
        (("NAUO1", "NAUO2"), ["plate_1", "plate_2"]),
        (("front plate", "rear plate"), ["front plate", "rear plate"]),
        (("same", "same"), ["plate_1", "plate_2"]),
    ],
)
def test_a_product_that_occurs_twice_is_called_by_its_occurrences(tmp_path, occurrences, names):
    """Names of occurrences that only count them say nothing, so that the product's name is numbered in their place."""
    path = assembly(tmp_path, ("plate", "a"), ("plate", "b"))
    text = path.read_text()
    for number, word in enumerate(occurrences):
        text = text.replace(f"OCCURRENCE('{number}','',", f"OCCURRENCE('{number}','{word}',")
    path.write_text(text)
    held = read_parts(path)
    assert held.names == names
    assert [note.code for note in held.notes] == ([] if "plate_1" not in names else ["numbered-parts"])


def test_a_product_within_an_assembly_within_an_assembly(tmp_path):
    """The chain of occurrences is followed: the name is that of the last product, not of those on the way."""
    path = assembly(tmp_path, ("upper", "a"), ("lower", "b"))
    text = path.read_text()
    outer = re.search(r"#(\d+)\s*=\s*PRODUCT_CONTEXT", text)[1]
    axis = re.search(r"ITEM_DEFINED_TRANSFORMATION\('','',#(\d+)", text)[1]
    context = re.search(r"#990007=SHAPE_REPRESENTATION\('',\(.*?\),#(\d+)\)", text)[1]
    of = re.search(r"PRODUCT_DEFINITION\('design','',#990003,#(\d+)\)", text)[1]
    more = f"""#991002=PRODUCT('all','all','',(#{outer}));
#991003=PRODUCT_DEFINITION_FORMATION('','',#991002);
#991004=PRODUCT_DEFINITION('design','',#991003,#{of});
#991005=PRODUCT_DEFINITION_SHAPE('','',#991004);
#991007=SHAPE_REPRESENTATION('',(#{axis}),#{context});
#991006=SHAPE_DEFINITION_REPRESENTATION(#991005,#991007);
#992000=NEXT_ASSEMBLY_USAGE_OCCURRENCE('7','','',#991004,#990004,$);
#992001=PRODUCT_DEFINITION_SHAPE('','',#992000);
#992002=ITEM_DEFINED_TRANSFORMATION('','',#{axis},#{axis});
#992003=(REPRESENTATION_RELATIONSHIP('','',#990007,#991007)
REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#992002)SHAPE_REPRESENTATION_RELATIONSHIP());
#992004=CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#992003,#992001);
"""
    path.write_text(text.replace("#990005=", f"{more}#990005=", 1))
    assert read_parts(path).names == ["upper", "lower"]


def test_a_name_on_several_parts_names_no_face(tmp_path):
    from netgen.occ import Box, Compound, Pnt

    solids = [next(iter(Box(Pnt(0, 0, z), Pnt(20, 20, z + 10)).solids)) for z in (0, 10)]
    for solid, part in zip(solids, ("lower", "upper"), strict=True):
        solid.name = part
        for face in solid.faces:
            face.name = {0.0: "under", 10.0: "middle", 20.0: "over"}.get(round(face.center.z, 6), "")
    Compound(solids).WriteStep(str(tmp_path / "two.step"))
    mesh = mesh_step(tmp_path / "two.step", size=10e-3)
    assert sorted(mesh.faces) == ["over", "under"]
    (note,) = mesh.notes
    assert note.code == "shared-names"
    assert "'middle' (lower, upper)" in note.text


def test_a_word_for_no_name_is_no_name(tmp_path):
    """Some exporters write NONE where a body or a face has no name: two parts with it would have a face in common."""
    from netgen.occ import Box, Compound, Pnt

    solids = [next(iter(Box(Pnt(0, 0, z), Pnt(20, 20, z + 10)).solids)) for z in (0, 10)]
    for solid in solids:
        solid.name = "NONE"
        for face in solid.faces:
            face.name = "NONE"
    Compound(solids).WriteStep(str(tmp_path / "two.step"))
    mesh = mesh_step(tmp_path / "two.step", size=10e-3, faces={"top": Selector(part="part2", normal=(0.0, 0.0, 1.0))})
    assert list(mesh.parts) == ["part1", "part2"]
    assert list(mesh.faces) == ["top"]


@pytest.mark.parametrize(
    ("written", "read"),
    [
        ("it''s", "it's"),
        (r"\X2\00FC\X0\ber", "\u00fcber"),
        (r"\X\FCber", "\u00fcber"),
        (r"\S\|ber", "\u00fcber"),
        (r"a\\b", r"a\b"),
    ],
)
def test_letters_outside_of_ascii(written, read):
    """ISO 10303-21, 6.4.3: coded letters, and the doubled marks."""
    assert decoded(written) == read


def test_an_entity_may_hold_comments_and_brackets_in_its_texts():
    text = "#1=PRODUCT('i','a ); b',/* no, 'c' */'',(#9)); #2=PRODUCT_DEFINITION_FORMATION('','',#1); "
    text += "#3 = PRODUCT_DEFINITION ( 'design', '', #2 , #8 );"
    assert read_products(text).names == {3: "a ); b"}


def area_of(mesh, name):
    from faying.fe.sides import face_centre

    return face_centre(mesh.points, mesh.face(name))[2]


def test_equal_names_are_numbered_with_a_note(tmp_path):
    from netgen.occ import Box, Compound, Pnt

    solids = [next(iter(Box(Pnt(0, 0, z), Pnt(20, 20, z + 10)).solids)) for z in (0, 10)]
    for solid in solids:
        solid.name = "plate"
    Compound(solids).WriteStep(str(tmp_path / "two.step"))
    mesh = mesh_step(tmp_path / "two.step", size=8e-3)
    assert sorted(mesh.parts) == ["plate_1", "plate_2"]
    (note,) = mesh.notes
    assert note.code == "numbered-parts"
    assert "'plate' is plate_1, plate_2" in note.text


def test_solids_that_are_in_no_assembly_are_all_read(tmp_path):
    mesh = mesh_step(assembly(tmp_path, ("a", "a"), ("b", "b"), loose=True), size=8e-3)
    assert sorted(mesh.parts) == ["a", "b"]


def outside(master):
    """Move the shapes of an assembly into its files one-0.step, one-1.step, to which it refers then."""
    text = master.read_text()
    parts = [int(one) for one in re.findall(r"#(\d+)\s*=\s*PRODUCT_DEFINITION\(", text) if one != "990004"]
    text = re.sub(r"ADVANCED_BREP_SHAPE_REPRESENTATION\('',\s*\((#\d+),#\d+\)", r"SHAPE_REPRESENTATION('',(\1)", text)
    text = re.sub(r"#\d+\s*=\s*MANIFOLD_SOLID_BREP\([^;]*;", "", text)
    lines = ["#980001=APPLICATION_CONTEXT('');", "#980002=PRODUCT_CONTEXT('',#980001,'');"]
    lines.append("#980003=PRODUCT_DEFINITION_CONTEXT('digital document definition',#980001,'');")
    for k, definition in enumerate(parts):
        n, name = 970_000 + 100 * k, f"one-{k}.step"
        lines += [
            f"#{n}=DOCUMENT_FILE('{name}','',$,#{n + 1},'',$);",
            f"#{n + 1}=DOCUMENT_TYPE('');",
            f"#{n + 2}=PRODUCT('{n}','{name}-Doc','',(#980002));",
            f"#{n + 3}=PRODUCT_DEFINITION_FORMATION('1','',#{n + 2});",
            f"#{n + 4}=PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS('1','',#{n + 3},#980003,(#{n}));",
            f"#{n + 5}=DOCUMENT('','',$,#{n + 6});",
            f"#{n + 6}=DOCUMENT_TYPE('configuration controlled document version');",
            f"#{n + 7}=DOCUMENT_PRODUCT_EQUIVALENCE('equivalence',$,#{n + 5},#{n + 3});",
            f"#{n + 8}=APPLIED_DOCUMENT_REFERENCE(#{n + 5},'',(#{definition}));",
            f"#{n + 9}=OBJECT_ROLE('mandatory',$);",
            f"#{n + 10}=ROLE_ASSOCIATION(#{n + 9},#{n + 8});",
            f"#{n + 11}=IDENTIFICATION_ROLE('external document id and location',$);",
            f"#{n + 12}=EXTERNAL_SOURCE(IDENTIFIER('{name}'));",
            f"#{n + 13}=APPLIED_EXTERNAL_IDENTIFICATION_ASSIGNMENT('{name}',#{n + 11},#{n + 12},(#{n}));",
            f"#{n + 14}=REPRESENTATION_CONTEXT('','document parameters');",
            f"#{n + 15}=DESCRIPTIVE_REPRESENTATION_ITEM('data format','STEP AP214');",
            f"#{n + 16}=REPRESENTATION('document format',(#{n + 15}),#{n + 14});",
            f"#{n + 17}=PROPERTY_DEFINITION('document property','',#{n});",
            f"#{n + 18}=PROPERTY_DEFINITION_REPRESENTATION(#{n + 17},#{n + 16});",
        ]
    master.write_text(text.replace("ENDSEC;\nEND-ISO", "\n".join([*lines, ""]) + "ENDSEC;\nEND-ISO"))
    return master


def test_parts_in_files_of_their_own_are_read_with_the_assembly(tmp_path):
    path = outside(assembly(tmp_path, ("lower", ""), ("upper", "")))
    held = read_parts(path)
    assert held.names == ["lower", "upper"]
    assert [solid.mass for solid in held.solids] == pytest.approx([4000, 4000])
    assert [solid.center.z for solid in held.solids] == pytest.approx([5, 15])


def test_names_of_part_files_count_as_windows_writes_them(tmp_path):
    """With backslashes, in capitals, with the folders of another machine; a drawing is no part."""
    path = outside(assembly(tmp_path, ("lower", ""), ("upper", "")))
    (tmp_path / "parts").mkdir()
    (tmp_path / "one-1.step").rename(tmp_path / "parts" / "one-1.step")
    text = (
        path.read_text()
        .replace("'one-0.step'", r"'C:\\jobs\\One-0.STEP'")
        .replace("'one-1.step'", r"'Parts\\one-1.step'")
    )
    path.write_text(text.replace("#980001=", "#980009=DOCUMENT_FILE('plan.pdf','',$,#980008,'',$);\n#980001="))
    held = read_parts(path)
    assert held.names == ["lower", "upper"]
    assert [solid.center.z for solid in held.solids] == pytest.approx([5, 15])
    assert [file.name for file in files_of(path)[1:]] == ["one-0.step", "one-1.step"]


@pytest.mark.parametrize("suffix", [".STEP", ".Stp", ".p21"])
def test_a_step_file_is_read_by_what_it_holds(tmp_path, suffix):
    """SolidWorks writes .STEP, of which the kernel says that it cannot load it."""
    path = assembly(tmp_path, ("lower", ""), ("upper", ""))
    assert read_parts(path.rename(path.with_suffix(suffix))).names == ["lower", "upper"]


def test_a_part_that_its_file_lacks_is_named(tmp_path):
    path = outside(assembly(tmp_path, ("lower", ""), ("upper", "")))
    (tmp_path / "one-1.step").unlink()
    with pytest.raises(faying.ReadError, match="refers to one-1.step for parts and holds no solid of its own; put the"):
        read_parts(path)


def test_a_step_file_without_shapes_is_said_to_have_no_solids(tmp_path):
    path = tmp_path / "empty.step"
    path.write_text(
        assembly(tmp_path, ("a", "a")).read_text().partition("DATA;")[0] + "DATA;\nENDSEC;\nEND-ISO-10303-21;\n"
    )
    with pytest.raises(faying.ReadError, match="has no solids; export solids"):
        read_parts(path)


@pytest.mark.parametrize(
    ("library", "ways"),
    [
        ("libGL.so.1", ["Debian, Ubuntu: apt-get install libgl1", "Fedora: dnf install mesa-libGL", "conda install"]),
        ("libSM.so.6", ["libsm6", "libSM", "xorg-libsm"]),
    ],
)
def test_a_bare_machine_is_told_which_packages_it_needs(monkeypatch, library, ways):
    real = builtins.__import__

    def bare(name, *rest):
        if name.startswith("netgen"):
            raise ImportError(f"{library}: cannot open shared object file: No such file or directory")
        return real(name, *rest)

    monkeypatch.setattr(builtins, "__import__", bare)
    with pytest.raises(faying.InputError) as fault:
        kernel()
    assert f"({library}: cannot open" in str(fault.value)
    for way in ways:
        assert way in str(fault.value)


def test_init_tells_it_too(monkeypatch, tmp_path):
    """The first command on a bare machine, in a process of its own where netgen cannot be loaded."""
    import subprocess
    import sys

    (tmp_path / "netgen").mkdir()
    (tmp_path / "netgen" / "__init__.py").write_text("")
    (tmp_path / "netgen" / "occ.py").write_text(
        "raise ImportError('libGL.so.1: cannot open shared object file: No such file or directory')"
    )
    code = f"import sys; sys.path.insert(0, {str(tmp_path)!r}); from faying.cli import main; main(sys.argv[1:])"
    done = subprocess.run(
        [sys.executable, "-c", code, "init", str(tmp_path / "study.toml")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 1
    assert done.stderr.startswith("faying: the CAD kernel lacks a library of the system (libGL.so.1")
    assert "apt-get install libgl1" in done.stderr
    assert not (tmp_path / "study.toml").exists()
