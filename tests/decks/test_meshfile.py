"""Mesh files: the same two blocks in every format give the same mesh, and every fault is told."""

import re
import subprocess

import numpy as np
import pytest

import faying
from faying.decks import mapdl
from faying.decks.bulk import number
from faying.decks.vocabulary import CONTACT, WORDS
from faying.fe.elasticity import assemble
from faying.fe.interface import join
from faying.fe.sides import face_centre
from tests.helpers import meshfiles
from tests.helpers.boxes import SOLID_KINDS, row

STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0)
MIXED = ("hex20", "tet10")


def two(kinds=("hex8", "hex8"), gap=0.0, move=(0.1, 1)):
    return row(
        [0.05, 0.04], [2, 1], kinds=kinds, sections=((2, 1), (2, 1)), width=0.02, height=0.01, gap=gap, move=move
    )


def same(mesh, expected, rename=lambda name: name, parts=None, digits=1e-9):
    """Same parts, faces (area, normal, centre, part), mass matrix, stiffness and node numbers."""
    names = parts or {part: part for part in expected.parts}
    assert list(mesh.parts) == [names[part] for part in expected.parts]
    for name in expected.faces:
        assert mesh.face_part[rename(name)] == names[expected.face_part[name]]
        for got, want in zip(
            face_centre(mesh.points, mesh.face(rename(name))),
            face_centre(expected.points, expected.faces[name]),
            strict=True,
        ):
            assert got == pytest.approx(want, abs=digits)
    rigid = np.tile([1.0, 0, 0], len(mesh.points))
    _, M = assemble(mesh, dict.fromkeys(mesh.parts, STEEL))
    assert rigid @ (M @ rigid) == pytest.approx(7800 * 0.09 * 0.02 * 0.01, rel=1e3 * digits)
    order = np.lexsort(np.round(mesh.points, 9).T)
    assert mesh.points[order] == pytest.approx(expected.points[np.lexsort(np.round(expected.points, 9).T)], abs=digits)
    stretch = [(m.points @ np.diag([1, 2, 3])).ravel() for m in (mesh, expected)]
    energy = [
        u @ (assemble(m, dict.fromkeys(m.parts, STEEL))[0] @ u) for u, m in zip(stretch, (mesh, expected), strict=True)
    ]
    assert energy[0] == pytest.approx(energy[1], rel=1e4 * digits)


def written(tmp_path, text, name):
    path = tmp_path / name
    path.write_text(text)
    return path


ALL = [(kind, kind) for kind in SOLID_KINDS] + [MIXED]


@pytest.mark.parametrize("kinds", ALL, ids="-".join)
@pytest.mark.parametrize("faces", ["surface", "nodes"])
def test_abaqus(tmp_path, kinds, faces):
    expected = two(kinds, gap=1e-4)
    mesh = faying.read_mesh(written(tmp_path, meshfiles.abaqus(expected, faces=faces), "m.inp"), unit="mm")
    same(mesh, expected)
    assert sorted(mesh.numbers) == sorted(meshfiles.numbers(expected))
    assert np.array_equal(mesh.numbers, meshfiles.numbers(expected))
    assert join(mesh, "p0.right", "p1.left").area == pytest.approx(2e-4, rel=1e-8)


@pytest.mark.parametrize("kinds", ALL, ids="-".join)
@pytest.mark.parametrize(("field", "faces"), [("small", "load"), ("large", "set"), ("free", "load"), ("free", "case")])
def test_nastran(tmp_path, kinds, field, faces):
    expected = two(kinds, gap=1e-4)
    text = meshfiles.nastran(expected, field=field, faces=faces)
    mesh = faying.read_mesh(written(tmp_path, text, "m.bdf"), unit="mm")
    face = {name: f"{'PLOAD4_' if faces == 'load' else 'SET'}{k + 1}" for k, name in enumerate(expected.faces)}
    same(mesh, expected, face.get, {"p0": "part1", "p1": "part2"}, digits=1e-8)
    assert set(mesh.numbers) == set(meshfiles.numbers(expected))


@pytest.mark.parametrize("kinds", ALL, ids="-".join)
@pytest.mark.parametrize("version", ["2.2", "4.1"])
def test_gmsh(tmp_path, kinds, version):
    expected = two(kinds, gap=1e-4)
    mesh = faying.read_mesh(written(tmp_path, meshfiles.gmsh(expected, version=version), "m.msh"), unit="mm")
    same(mesh, expected)
    assert set(mesh.numbers) == set(meshfiles.numbers(expected))


@pytest.mark.parametrize("kinds", ALL, ids="-".join)
@pytest.mark.parametrize("version", ["2.2", "4.1"])
@pytest.mark.parametrize("order", ["<", ">"])
def test_gmsh_in_binary(tmp_path, kinds, version, order):
    expected = two(kinds, gap=1e-4)
    path = tmp_path / "m.msh"
    path.write_bytes(meshfiles.gmsh_binary(expected, version=version, order=order))
    mesh = faying.read_mesh(path, unit="mm")
    same(mesh, expected)
    assert set(mesh.numbers) == set(meshfiles.numbers(expected))


def test_binary_gmsh_cut_short(tmp_path):
    """Any cut is seen: the sections have ends, and the counts are those of the records."""
    for version in ("2.2", "4.1"):
        data = meshfiles.gmsh_binary(two(gap=1e-4), version=version)
        path = tmp_path / "m.msh"
        for share in np.linspace(0.05, 0.99, 25):
            path.write_bytes(data[: int(share * len(data))])
            with pytest.raises(faying.ReadError):
                faying.read_mesh(path, unit="mm")
        end = data.index(b"$EndElements")
        path.write_bytes(data[: end - 60] + data[end:])
        with pytest.raises(faying.ReadError, match="middle of a record"):
            faying.read_mesh(path, unit="mm")


@pytest.mark.parametrize("kinds", ALL, ids="-".join)
@pytest.mark.parametrize("faces", ["shells", "nodes"])
def test_universal_files(tmp_path, kinds, faces):
    expected = two(kinds, gap=1e-4)
    mesh = faying.read_mesh(written(tmp_path, meshfiles.unv(expected, faces=faces), "m.unv"), unit="mm")
    same(mesh, expected)
    assert set(mesh.numbers) == set(meshfiles.numbers(expected))
    fault(tmp_path, meshfiles.unv(expected)[:-200], "has no end .-1.; the file is cut short", "m.unv")


MESHIO = {"tet4": "tetra", "tet10": "tetra10", "hex8": "hexahedron", "hex20": "hexahedron20", "wedge6": "wedge"}
MESHIO |= {"wedge15": "wedge15", 3: "triangle", 4: "quad", 6: "triangle6", 8: "quad8"}


def cells_of(kinds, mesh):
    """Blocks for meshio, and the part or face of each."""
    cells = [(MESHIO[kind], block) for kind, block in zip(kinds, mesh.blocks, strict=True)]
    names = list(mesh.parts)
    for name, face in mesh.faces.items():
        cells += [(MESHIO[block.shape[1]], block) for block in face]
        names += [name for _ in face]
    return cells, names


@pytest.mark.parametrize("kinds", ALL, ids="-".join)
def test_arrays_of_flags_name_parts_and_faces_of_a_vtu(tmp_path, kinds):
    meshio = pytest.importorskip("meshio")
    meshio._mesh.topological_dimension["wedge15"] = 3
    expected = two(kinds, gap=1e-4)
    cells, names = cells_of(kinds, expected)
    data = {
        name: [np.full(len(block), int(name == of)) for (_, block), of in zip(cells, names, strict=True)]
        for name in dict.fromkeys(names)
    }
    meshio.Mesh(expected.points * 1e3, cells, cell_data=data).write(tmp_path / "m.vtu")
    same(faying.read_mesh(tmp_path / "m.vtu", unit="mm"), expected)


MIRRORED = {  # as MED has them: corners the other way round, middle nodes along its own list of edges
    "tet4": [0, 2, 1, 3],
    "tet10": [0, 2, 1, 3, 6, 5, 4, 7, 9, 8],
    "hex8": [0, 3, 2, 1, 4, 7, 6, 5],
    "hex20": [0, 3, 2, 1, 4, 7, 6, 5, 11, 10, 9, 8, 15, 14, 13, 12, 16, 19, 18, 17],
    "wedge6": [0, 2, 1, 3, 5, 4],
    "wedge15": [0, 2, 1, 3, 5, 4, 8, 7, 6, 11, 10, 9, 12, 14, 13],
}


@pytest.mark.parametrize("kinds", [k for k in ALL if k[0] != k[1]] or ALL, ids="-".join)
@pytest.mark.parametrize("turned", [True, False])
def test_med(tmp_path, kinds, turned):
    """MED's cells run the other way round than VTK's; groups name parts and faces."""
    meshio = pytest.importorskip("meshio")
    meshio._mesh.topological_dimension["wedge15"] = 3
    expected = two(kinds, gap=1e-4)
    cells, names = cells_of(kinds, expected)
    if turned:
        back = {MESHIO[kind]: order for kind, order in MIRRORED.items()}
        cells = [(kind, block[:, back[kind]] if kind in back else block) for kind, block in cells]
    family = {name: -1 - k for k, name in enumerate(dict.fromkeys(names))}
    tags = {}
    for (kind, block), name in zip(cells, names, strict=True):  # MED holds one block of a kind
        tags.setdefault(kind, []).append((block, np.full(len(block), family[name])))
    merged = [(kind, np.concatenate([b for b, _ in some])) for kind, some in tags.items()]
    data = {"cell_tags": [np.concatenate([t for _, t in some]) for some in tags.values()]}
    out = meshio.Mesh(expected.points * 1e3, merged, cell_data=data)
    out.cell_tags = {number: [name] for name, number in family.items()}
    out.write(tmp_path / "m.med")
    same(faying.read_mesh(tmp_path / "m.med", unit="mm"), expected)


@pytest.mark.parametrize("kind", ["quad9", "pyramid13"])
def test_med_with_nodes_in_the_middle_of_sides(tmp_path, monkeypatch, kind):
    """A brick of 20 x 20 x 10 mm whose top is a quadrangle of 9 nodes, 400 mm2; a pyramid is refused by its name."""
    meshio = pytest.importorskip("meshio")
    corners = np.array([[x, y, z] for z in (0, 10) for x, y in ((0, 0), (20, 0), (20, 20), (0, 20))], float)
    middles = [[10, 0, 10], [20, 10, 10], [10, 20, 10], [0, 10, 10], [10, 10, 10]]
    more = [[4, 5, 6, 7, *range(8, 13)]] if kind == "quad9" else [list(range(13))]
    monkeypatch.setitem(meshio.med._med.meshio_to_med_type, "quad9", "QU9")
    monkeypatch.setitem(meshio._mesh.topological_dimension, "pyramid13", 3)
    mesh = meshio.Mesh(np.vstack([corners, middles]), [("hexahedron", [list(range(8))]), (kind, more)])
    mesh.write(tmp_path / "m.med")
    if kind == "pyramid13":
        with pytest.raises(faying.ReadError, match="cells of type pyramid13 are not known"):
            faying.read_mesh(tmp_path / "m.med", unit="mm")
    else:
        (face,) = faying.faces(tmp_path / "m.med", unit="mm").faces
        assert face.area == pytest.approx(4e-4)


@pytest.mark.parametrize("kinds", ALL, ids="-".join)
def test_ansys(tmp_path, kinds):
    expected = two(kinds, gap=1e-4)
    mesh = faying.read_mesh(written(tmp_path, meshfiles.ansys(expected), "m.cdb"), unit="mm")
    same(mesh, expected, lambda name: name.replace(".", "_").upper(), {"p0": "P0", "p1": "P1"})
    assert set(mesh.numbers) == set(meshfiles.numbers(expected))


@pytest.mark.parametrize("kinds", ALL, ids="-".join)
@pytest.mark.parametrize("name", ["m.vtu", "m.vtk", "m.msh", "m.inp"])
def test_files_that_meshio_writes(tmp_path, kinds, name):
    """A writer that is not ours: node orders of VTK, Gmsh and Abaqus as meshio has them."""
    meshio = pytest.importorskip("meshio")
    meshio._mesh.topological_dimension["wedge15"] = 3  # forgotten in meshio 5.3.5
    expected = two(kinds, gap=1e-4)
    names = {
        "tet4": "tetra",
        "tet10": "tetra10",
        "hex8": "hexahedron",
        "hex20": "hexahedron20",
        "wedge6": "wedge",
        "wedge15": "wedge15",
        3: "triangle",
        4: "quad",
        6: "triangle6",
        8: "quad8",
    }
    cells = [(names[kind], block) for kind, block in zip(kinds, expected.blocks, strict=True)]
    labels = [np.full(len(block), 10 + i) for i, (_, block) in enumerate(cells)]
    if not name.endswith("inp"):
        for i, face in enumerate(expected.faces.values()):
            cells += [(names[block.shape[1]], block) for block in face]
            labels += [np.full(len(block), i) for block in face]
    data = {"gmsh:physical" if name.endswith("msh") else "region": labels}
    if name.endswith("msh"):
        data["gmsh:geometrical"] = labels
    out = meshio.Mesh(expected.points * 1e3, cells, cell_data=data)
    if name.endswith("inp"):
        out = meshio.Mesh(expected.points * 1e3, cells)
    out.write(tmp_path / name, **({"file_format": "gmsh22", "binary": False} if name.endswith("msh") else {}))
    mesh = faying.read_mesh(tmp_path / name, unit="mm")
    if name.endswith("inp"):
        assert list(mesh.parts) == ["part1", "part2"]
        assert not mesh.faces
        return
    face = {label: f"face{i}" if i or not name.endswith("msh") else "face0" for i, label in enumerate(expected.faces)}
    if name.endswith("msh"):  # Gmsh's group 0 is none
        expected = faying.fe.mesh.Mesh(
            points=expected.points,
            parts=expected.parts,
            face_part=expected.face_part,
            faces={k: v for k, v in expected.faces.items() if face[k] != "face0"},
        )
    same(mesh, expected, face.get, {"p0": "part10", "p1": "part11"})


def test_abaqus_parts_and_instances(tmp_path):
    """Instances moved and turned, numbers that clash, sets of an instance, and an included file."""
    expected = two(MIXED, gap=1e-4)
    text = meshfiles.assembly(expected)
    cut = text.index("*Assembly")
    written(tmp_path, text[:cut], "parts.inp")
    path = written(tmp_path, "*Include, input=parts.inp\n" + text[cut:], "m.inp")
    mesh = faying.read_mesh(path, unit="mm")
    same(mesh, expected, lambda name: name.replace(".", "-"))
    assert len(np.unique(mesh.numbers)) == len(mesh.points)


@pytest.mark.parametrize("kind", SOLID_KINDS)
def test_parts_that_share_nodes_are_split_at_a_named_face(tmp_path, kind):
    """The two blocks bonded at x = 50 mm; one set of nodes names the joint on both."""
    apart = two((kind, kind), move=None)
    merged = meshfiles.abaqus(apart, faces="nodes")
    n = meshfiles.numbers(apart)
    for node in apart.face_nodes("p1.left"):
        twin = next(k for k in apart.face_nodes("p0.right") if np.allclose(apart.points[k], apart.points[node]))
        nodes, rest = merged.split("*Element", 1)
        merged = re.sub(rf"^{n[node]}, .*\n", "", nodes, flags=re.M) + "*Element" + rest
        merged = re.sub(rf"(?<![\d.-]){n[node]}(?![\d.])", str(n[twin]), merged)
    mesh = faying.read_mesh(written(tmp_path, merged, "m.inp"), unit="mm")
    assert len(mesh.points) == len(apart.points)
    assert len(np.unique(mesh.numbers)) == len(mesh.points)
    assert {"p0.p0.right", "p1.p0.right"} <= set(mesh.faces)
    assert join(mesh, "p0.p0.right", "p1.p0.right").area == pytest.approx(2e-4, rel=1e-9)
    by_sides = [f"{number}, S{side + 1}" for number, side, *_ in meshfiles.sides(apart, "p0.right")]
    alone = re.sub(r",\n elset=p\d", "", merged) + "\n".join(["*SURFACE, NAME=mid, TYPE=ELEMENT", *by_sides]) + "\n"
    inside = faying.read_mesh(written(tmp_path, alone, "m.inp"), unit="mm")
    assert "mid" not in inside.faces
    assert "'mid' lies inside its part" in inside.notes[0].text
    assert "put the elements on each side into an element set of their own" in inside.notes[0].text
    skin = next(f"{number}, S{side + 1}" for number, side, *_ in meshfiles.sides(apart, "p0.left"))
    partly = faying.read_mesh(written(tmp_path, f"{alone}{skin}\n", "m.inp"), unit="mm")
    assert "mid" not in partly.faces
    assert re.search("'mid' are not on the outside .* on each side into an element set", partly.notes[0].text)
    unnamed = merged[: merged.index("*NSET")]
    assert "*NSET" not in unnamed
    whole = faying.read_mesh(written(tmp_path, unnamed, "m.inp"), unit="mm")
    assert whole.bodies == (("p0", "p1"),)
    assert len(whole.points) == len(apart.points) - len(apart.face_nodes("p0.right"))
    assert "'p0' and 'p1'" in whole.notes[0].text
    one_sided = f"{unnamed}*SURFACE, NAME=mid, TYPE=NODE\n{n[apart.face_nodes('p0.right')[0]]}\n"  # no side of it
    assert faying.read_mesh(written(tmp_path, one_sided, "m.inp"), unit="mm").bodies == (("p0", "p1"),)


def test_parts_by_choice_by_set_and_by_connection(tmp_path):
    text = meshfiles.abaqus(two(gap=1e-4))
    path = written(tmp_path, text, "m.inp")
    chosen = faying.read_mesh(path, unit="mm", parts={"upper": "p0", "lower": "p1"})
    assert list(chosen.parts) == ["upper", "lower"]
    assert chosen.face_part["p0.right"] == "upper"
    assert list(faying.read_mesh(path, unit="mm", parts=["p1", "p0"]).parts) == ["p1", "p0"]
    bare = re.sub(r",\n elset=p\d", "", text)
    assert list(faying.read_mesh(written(tmp_path, bare, "b.inp"), unit="mm").parts) == ["part1", "part2"]
    both = text.replace("elset=p0", "elset=all").replace("elset=p1", "elset=all")
    both += "*SOLID SECTION, ELSET=ALL, MATERIAL=steel\n"
    assert list(faying.read_mesh(written(tmp_path, both, "c.inp"), unit="mm").parts) == ["ALL_1", "ALL_2"]
    with pytest.raises(faying.InputError, match=r"part 'roof' names the element set 'roof'; the file holds .*'p0'"):
        faying.read_mesh(path, unit="mm", parts=["roof"])
    with pytest.raises(faying.InputError, match="do not divide the elements"):
        faying.read_mesh(path, unit="mm", parts=["p0"])


def test_units(tmp_path):
    path = written(tmp_path, meshfiles.abaqus(two(gap=1e-4)), "m.inp")
    with pytest.raises(faying.InputError, match='does not state the unit of its coordinates.* unit = "mm"'):
        faying.read_mesh(path)
    with pytest.raises(faying.InputError, match="unit of the mesh"):
        faying.read_mesh(path, unit="kN")
    with pytest.raises(faying.InputError, match=r"in um the structure is 9.*e-05 m long; is that its unit\?"):
        faying.read_mesh(path, unit="um")
    with pytest.raises(faying.InputError, match=r"in km the structure is .* m long"):
        faying.read_mesh(path, unit="km")
    assert faying.read_mesh(path, unit="inch").size == pytest.approx(25.4 * faying.read_mesh(path, unit="mm").size)


@pytest.mark.parametrize("unit", ["5 mm", "mm*1000", "0.001", "mm 5", "9**9**9 mm", "", "mm, m"])
def test_a_unit_is_a_name(tmp_path, unit):
    path = written(tmp_path, meshfiles.abaqus(two(gap=1e-4)), "m.inp")
    with pytest.raises(faying.InputError, match="unit of the mesh.*write (its name alone, )?for example mm"):
        faying.read_mesh(path, unit=unit)


def fault(tmp_path, text, match, name="m.inp", kind=faying.InputError):
    with pytest.raises(kind, match=match):
        faying.read_mesh(written(tmp_path, text, name), unit="mm")


def test_faults_of_a_mesh_file(tmp_path):
    mesh = two(gap=1e-4)
    good = meshfiles.abaqus(mesh)
    first = next(iter(meshfiles.solids(mesh)))
    line = ", ".join(map(str, [first[1], *first[3]]))[:20]
    at = good.index(line)
    end = good.index("\n", good.index("\n", at) + 1)
    turned = ", ".join(map(str, [first[1], *first[3][4:], *first[3][:4]]))
    fault(tmp_path, good[:at] + turned + good[end:], r"1 elements have no or negative volume: 9; repair")
    fault(
        tmp_path,
        good.replace("nset=NALL\n", "nset=NALL\n" + "".join(f"{k}, 1., 2., 3.\n" for k in range(1, 41))),
        r"40 of \d+ nodes belong to no element: 1, 2, 3, 4, 5, ...; delete them",
    )
    fault(tmp_path, good + "*ELEMENT, TYPE=C3D8\n" + turned + "\n", "element 9 is given twice")
    again = ", ".join(map(str, [90001, *first[3]]))
    fault(tmp_path, good + f"*ELEMENT, TYPE=C3D8\n{again}\n", "1 elements have the nodes of another one and.*: 90001")
    fault(tmp_path, good.replace("C3D8I", "C3D27"), "elements of type C3D27 are not known; the known ones are C3D4")
    fault(
        tmp_path,
        good.replace("C3D8I", "C3D20"),
        "the lines of element 9 hold 26 numbers, where one of type C3D20 has 21",
    )
    fault(tmp_path, good[: good.index("*Element")], "0 kinds of solid elements")
    fault(tmp_path, good[: at + 20], r"is the file complete", kind=faying.ReadError)
    fault(
        tmp_path,
        good.replace("_p0.left_S6, S6", "_p0.front_S6, S6"),
        "element set '_p0.front_S6', which is not in m.inp",
    )
    fault(tmp_path, good.replace("_p0.left_S6, S6", "_p0.left_S6, S9"), "side 'S9'; the sides of solids are S1 to S6")
    fault(tmp_path, good + "*NSET, NSET=x\ny\n", r"set 'x' names the set 'y', which is not in the file")
    fault(tmp_path, good + "*NSET, NSET=x\n5\n", "the set 'x' names node 5, which is not in the file")
    fault(tmp_path, good + "*NSET\n5\n", r"\*NSET without a name")
    fault(tmp_path, good + "*INCLUDE, INPUT=none.inp\n", "cannot read .*none.inp")
    fault(tmp_path, good + "*INCLUDE, INPUT=m.inp\n", "includes itself")
    fault(tmp_path, "1, 2, 3\n", "data before the first keyword")
    fault(tmp_path, good.replace("100, 0,", "100, zero,"), r"\*NODE has something that is not a number")
    fault(tmp_path, "", "is not a Gmsh mesh file", name="m.msh")
    with pytest.raises(faying.ReadError, match="no file"):
        faying.read_mesh(tmp_path / "none.inp", unit="mm")
    with pytest.raises(faying.ReadError, match=r"files of the kind \.stl are not known; the known ones are .*\.inp"):
        faying.read_mesh(written(tmp_path, "", "m.stl"), unit="mm")


def test_nodes_that_should_be_one(tmp_path):
    """Two blocks that touch, in one element set by choice: nothing joins them, and that is told."""
    text = meshfiles.abaqus(two(move=None)).replace("elset=p0", "elset=all").replace("elset=p1", "elset=all")
    path = written(tmp_path, text, "m.inp")
    assert list(faying.read_mesh(path, unit="mm").parts) == ["part1", "part2"]
    with pytest.raises(faying.InputError, match=r"6 pairs of nodes of part 'all' coincide \(\d+ and \d+, for one\)"):
        faying.read_mesh(path, unit="mm", parts=["all"])


def test_faults_of_other_formats(tmp_path):
    mesh = two(MIXED, gap=1e-4)
    bulk = meshfiles.nastran(mesh, field="free")
    fault(tmp_path, bulk.replace("GRID,100,,", "GRID,100,5,"), "coordinate system 5 is not in the file", "m.bdf")
    fault(
        tmp_path, bulk.replace("CTETRA", "CTETRX"), "elements CTETRX are not known; the known ones are CTETRA", "m.bdf"
    )
    fault(tmp_path, bulk[: bulk.index("PLOAD4")].rsplit(",", 3)[0] + "\n", "has 7 nodes; 4 or 10 are known", "m.bdf")
    fault(tmp_path, bulk.replace("GRID,100,,", "GRID,100,,x"), "GRID 100 cannot be read", "m.bdf")
    fault(tmp_path, "BEGIN BULK\nENDDATA\n", "holds 0 GRID cards", "m.bdf")
    text = meshfiles.gmsh(mesh)
    fault(tmp_path, text.replace("2.2 0 8", "2.2 1 8"), "is a binary file of unknown byte order", "m.msh")
    fault(tmp_path, text.replace("2.2 0 8", "3 0 8"), "has format '3 0 8'; save it in 4.1 or 2.2", "m.msh")
    fault(tmp_path, text[:-100], "has no .EndElements; the file is cut short", "m.msh")
    fault(tmp_path, re.sub(r"^(\d+) 17 2", r"\1 12 2", text, flags=re.M), "bricks of 27 nodes are not known", "m.msh")
    fault(
        tmp_path,
        text.replace("$EndElements", "").replace(text[-60:-14], "") + "$EndElements\n",
        "is the file complete",
        "m.msh",
    )
    archive = meshfiles.ansys(mesh)
    fault(tmp_path, archive.replace("SOLID186", "SOLID226"), "is of type 226; the known ones are SOLID185", "m.cdb")
    fault(tmp_path, archive[: archive.index("EBLOCK") + 900], "is the archive complete", "m.cdb")
    fault(tmp_path, archive.replace("EBLOCK,19,SOLID", "EBLOCK,10,COMPACT"), "EBLOCK without the key SOLID", "m.cdb")
    line = next(line for line in archive.splitlines() if line.startswith("      100"))
    fault(tmp_path, archive.replace(line, f"{line}\n{line}"), "is the archive complete", "m.cdb")
    fault(tmp_path, "FINISH\n", "holds 0 nodes in NBLOCK", "m.cdb")
    for command in ("NSCALE,,ALL,,,25.4,25.4,25.4", "NMODIF,1,0.1", "EDELE,1", "ESYM,,100,ALL", "CDREAD,DB,more,cdb"):
        changed = archive.replace("FINISH", f"{command}\nFINISH")
        fault(tmp_path, changed, f"{command.partition(',')[0]} changes nodes or elements", "m.cdb")
    if pytest.importorskip("meshio"):
        fault(tmp_path, "nonsense", "cannot be read as VTK", "m.vtu")


def test_elements_of_pressures_and_contacts_in_compact_blocks_are_left_out(tmp_path):
    """As Workbench writes them into ds.dat: no key SOLID, five numbers before the nodes, types by parameters."""
    archive = meshfiles.ansys(two())
    row = "".join(f"{number:9d}" for number in (90001, 7, 7, 7, 0, 1, 2, 3, 4))
    more = f"*set,tid,7\net,tid,174\neblock,10,,,1\n(15i9)\n{row}\n-1\n"
    plain, changed = tmp_path / "plain.dat", tmp_path / "ds.dat"
    plain.write_text(archive)
    changed.write_text(archive.replace("FINISH", more + "FINISH"))
    without, found = (mapdl.read(path) for path in (plain, changed))
    assert {k: v.tolist() for k, (_, v) in found.elements.items()} == {
        k: v.tolist() for k, (_, v) in without.elements.items()
    }
    assert [note for note in found.notes if note not in without.notes] == [f"CONTA174 (1): {WORDS[CONTACT]}"]
    changed.write_text(archive.replace("FINISH", more.replace("et,tid,174", "et,tid,185") + "FINISH"))
    with pytest.raises(faying.ReadError, match="type 7 is 185; write the archive"):
        mapdl.read(changed)


def test_pyramids_in_an_archive_are_named(tmp_path):
    mesh = two(("hex8", "hex8"), gap=1e-4)
    archive = meshfiles.ansys(mesh)
    _, number_, _, nodes = next(iter(meshfiles.solids(mesh)))
    whole = "".join(f"{w:9d}" for w in nodes)
    pyramid = "".join(f"{w:9d}" for w in [*nodes[:4], *[nodes[4]] * 4])
    fault(tmp_path, archive.replace(whole, pyramid), rf"element {number_} \(SOLID185\) is a pyramid", "m.cdb")


@pytest.mark.parametrize(
    ("text", "value"),
    [("1.5", 1.5), ("1.5+3", 1500.0), ("-2.-1", -0.2), ("1.5D3", 1500.0), (".7E-2", 0.007), ("-7", -7.0)],
)
def test_reals_of_nastran(text, value):
    assert number(text) == pytest.approx(value, rel=1e-15)


def test_vtk_needs_meshio(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "meshio", None)
    fault(tmp_path, "x", "VTK files are read by meshio; add --extra vtk to uv run, or pip install meshio", "m.vtk")


def test_the_core_does_not_load_meshio():
    code = "import faying, sys; faying.read_mesh; assert 'meshio' not in sys.modules and 'scipy' not in sys.modules"
    assert subprocess.run([__import__("sys").executable, "-c", code], check=False).returncode == 0


def test_an_archive_with_other_elements_and_turned_nodes(tmp_path):
    """NBLOCK carries three angles behind the coordinates; masses and rigid spiders are left out by name."""
    mesh = two(("hex8", "hex8"), gap=1e-4)
    archive = meshfiles.ansys(mesh)
    line = next(line for line in archive.splitlines() if line.startswith("      103"))
    turned = line[:27].ljust(27) + "".join(
        f"{x:21.13E}".replace("E+", "E+0").replace("E-", "E-0")[-21:] for x in (0, 0, 10, 0, 30.0, 0)
    )
    archive = archive.replace(line, turned)
    found = faying.read_mesh(written(tmp_path, archive, "m.cdb"), unit="mm")
    assert found.numbers[found.turned].tolist() == [103]
    count = len(list(meshfiles.solids(mesh)))
    spider = "".join(f"{w:9d}" for w in (1, 9, 1, 1, 0, 0, 0, 0, 2, 0, 9999, 100, 103))
    more = archive.replace("/PREP7\n", "/PREP7\nET,9,MPC184\n").replace(f"{-1:9d}\n", f"{spider}\n{-1:9d}\n", 1)
    with pytest.raises(
        faying.ReadError, match=f"EBLOCK says {count} elements and has {count + 1}; is the archive complete"
    ):
        faying.read_mesh(written(tmp_path, more, "m.cdb"), unit="mm")
    head = next(line for line in more.splitlines() if line.startswith("EBLOCK"))
    more = more.replace(head, head.replace(f",{count}", f",{count + 1}"))
    notes = faying.read_mesh(written(tmp_path, more, "m.cdb"), unit="mm").notes
    assert [note.text for note in notes] == [
        "1 elements of type 184 (rigid or multipoint elements) are left out, with their stiffness and mass"
    ]
    gone = "\n".join(one for one in archive.splitlines() if one != turned) + "\n"
    with pytest.raises(faying.ReadError, match="NBLOCK says .* nodes and has .*; is the archive complete"):
        faying.read_mesh(written(tmp_path, gone, "m.cdb"), unit="mm")


@pytest.mark.parametrize(("old", "new"), [("100 ", "-100 "), ("100 ", "1" + 30 * "0" + " "), ("100 ", "1e9 ")])
def test_wild_numbers_in_gmsh(tmp_path, old, new):
    text = meshfiles.gmsh(two(gap=1e-4))
    at = text.index(old, text.index("$Nodes"))
    with pytest.raises(faying.InputError):
        faying.read_mesh(written(tmp_path, text[:at] + new + text[at + len(old) :], "m.msh"), unit="mm")


def test_counts_below_zero_in_gmsh(tmp_path):
    text = meshfiles.gmsh(two(gap=1e-4))
    body = text[text.index("$Elements") :].splitlines()
    row = body[2].split()
    wild = text.replace(body[2], " ".join([*row[:2], "-5", *row[3:]]))
    with pytest.raises(faying.ReadError, match="ends in the middle of a record"):
        faying.read_mesh(written(tmp_path, wild, "m.msh"), unit="mm")


def test_nodes_and_elements_of_single_commands_of_ansys_are_named(tmp_path):
    path = tmp_path / "m.cdb"
    path.write_text(meshfiles.ansys(two()).replace("FINISH", "N,9001,0.1,0,0\nEN,9001,9001\nFINISH"))
    notes = faying.read_mesh(path, unit="mm").notes
    assert "nodes and elements of the commands N, EN, outside the blocks, are not read" in [note.text for note in notes]


@pytest.mark.parametrize("name", ["m.vtk", "m.vtu", "m.msh", "m.unv"])
def test_lines_that_leave_the_solids_are_counted(tmp_path, name):
    """A cable from a corner to a point off the solids; lines along the edges of solids are none."""
    expected = two()
    a, b = map(int, expected.part_nodes("p0")[:2])
    off = len(expected.points)
    if name == "m.unv":
        text = meshfiles.unv(expected)
        node = f"{9001:10d}{1:10d}{1:10d}{11:10d}\n   0.0D+00   0.0D+00   1.0D+02\n"
        corner, other = meshfiles.numbers(expected)[[a, b]]
        rods = [
            f"{9000 + k:10d}{11:10d}{1:10d}{1:10d}{7:10d}{2:10d}\n{0:10d}{1:10d}{1:10d}\n{corner:10d}{end:10d}\n"
            for k, end in enumerate((other, 9001))
        ]
        text = text.replace("  2411\n", f"  2411\n{node}").replace("  2412\n", "  2412\n" + "".join(rods))
        written(tmp_path, text, name)
    else:
        meshio = pytest.importorskip("meshio")
        points = np.vstack([expected.points * 1e3, [0, 0, 100]])
        cells = [*(("hexahedron", block) for block in expected.blocks), ("line", np.array([[a, b], [a, off]]))]
        data = {"gmsh:physical": [np.full(len(some), 1) for _, some in cells]} if name == "m.msh" else {}
        data |= {"gmsh:geometrical": data["gmsh:physical"]} if data else {}
        out = meshio.Mesh(points, cells, cell_data=data)
        out.write(tmp_path / name, **({"file_format": "gmsh22", "binary": False} if data else {}))
    mesh = faying.read_mesh(tmp_path / name, unit="mm")
    assert len(mesh.points) == off
    (note,) = [note.text for note in mesh.notes if note.text.startswith("lines off all solids")]
    assert re.search(r"left out with 1 nodes: \d+$", note)


def test_names_of_gmsh_2_0_do_not_say_of_what(tmp_path):
    expected = two(gap=1e-4)
    text = meshfiles.gmsh(expected)
    early = re.sub(r"^[23] (\d+) \"", r'\1"', text.replace("2.2 0 8", "2 0 8"), flags=re.M)
    assert early != text.replace("2.2 0 8", "2 0 8")
    same(faying.read_mesh(written(tmp_path, early, "m.msh"), unit="mm"), expected)


def test_a_brick_of_ansys_without_a_middle_node_is_named(tmp_path):
    archive = meshfiles.ansys(two(("hex20", "hex20"), gap=1e-4)).splitlines()
    line = archive.index("(19i9)") + 2
    archive[line] = archive[line][:-9] + f"{0:9d}"
    fault(tmp_path, "\n".join(archive), r"element 9 \(SOLID186\) lacks a node in the middle of an edge", "m.cdb")


def test_a_script_of_ansys_without_a_mesh_is_not_called_damaged(tmp_path):
    script = "/PREP7\nET,1,SOLID185\nET,cid,174\nBLOCK,0,1,0,1,0,1\nVMESH,ALL\n*VWRITE,A\n(1X,F10.3)\nFINISH\n"
    fault(tmp_path, script, "holds 0 nodes in NBLOCK, 0 solids and 0 other elements", "m.cdb")


def test_fields_of_nastran_that_repeat_a_card_are_refused(tmp_path):
    text = meshfiles.nastran(two())
    first = next(line for line in text.splitlines() if line.startswith("GRID"))
    fault(tmp_path, text.replace(first, f"{first}\n=,*(1),=,*(1.),=="), "fields that repeat the card before", "m.bdf")


def test_a_set_of_the_nodes_of_elements_is_refused(tmp_path):
    text = meshfiles.abaqus(two()) + "*NSET, NSET=all, ELSET=p0\n"
    fault(tmp_path, text, "takes the nodes of elements", "m.inp")
