"""A law on two faces of a user's model: pressures from everywhere, modes from matrices, and every fault told."""

import json
from dataclasses import replace

import numpy as np
import pytest
from scipy.io import mmwrite

import faying
from faying.answer.run import run
from faying.cli.main import main
from faying.export.attach import attach
from faying.fe.elasticity import assemble
from faying.fe.mesh import Mesh
from faying.joint.preload_case import PreloadCase
from faying.numerics.modes import lowest_modes
from faying.study import Study
from tests.helpers import meshfiles
from tests.helpers.boxes import row
from tests.helpers.models import two
from tests.helpers.preloads import pulled

FACES = ("p0.right", "p1.left")
TEXT = meshfiles.STUDY
BRASS = """material = "brass"
[material.brass]
E = "100 GPa"
nu = 0.33
density = "8500 kg/m^3"
yield_strength = "200 MPa"
"""


def model(folder, mesh=None, text=TEXT):
    """A model, its study, and the mesh with the numbers of the file."""
    mesh = mesh or two(("hex8", "hex8"), ((2, 2), (2, 2)), counts=(2, 2))
    (folder / "model.inp").write_text(meshfiles.abaqus(mesh))
    (folder / "study.toml").write_text(text)
    return folder / "model.inp", Study.read(folder / "study.toml")


def attached(folder, pressure="5 MPa", mesh=None, text=TEXT, faces=FACES, unit="mm", **more):
    file, study = model(folder, mesh, text)
    return attach(file, faces, unit=unit, study=study, pressure=pressure, **more)


def csv(folder, mesh, name="p0.right", unit="MPa", value=lambda x: 5 + 100 * x[:, 1], head="node,pressure [{}]"):
    nodes = mesh.face_nodes(name)
    scale = {"MPa": 1.0, "Pa": 1e6}[unit]
    rows = [
        f"{meshfiles.numbers(mesh)[i]},{v * scale:.12g}" for i, v in zip(nodes, value(mesh.points[nodes]), strict=True)
    ]
    path = folder / "p.csv"
    path.write_text("# from a static run\n" + head.format(unit) + "\n" + "\n".join(rows) + "\n")
    return path


def test_springs_are_those_of_the_law(tmp_path):
    law = faying.JK(D=2.39, G=1.53e-10, scan_area=16e-6, pair=faying.ContactPair(*2 * (faying.CATALOGUE["45 steel"],)))
    answer = law.at_pressure(5e6)
    for mesh in (None, two(("hex20", "tet10"), ((2, 2), (3, 2)))):
        k_n, k_t = attached(tmp_path, mesh=mesh).pairs.totals()
        assert k_n == pytest.approx(answer.k_n * 6e-4, rel=1e-10)
        assert k_t == pytest.approx(answer.k_t * 6e-4, rel=1e-10)
    lost = attached(tmp_path).pairs
    assert lost.own(lost.loss)[:, 0] == pytest.approx(answer.loss_n * lost.own(lost.stiffness)[:, 0])


@pytest.mark.parametrize("face", FACES)
@pytest.mark.parametrize("unit", ["MPa", "Pa"])
def test_pressure_from_a_file(tmp_path, face, unit):
    """A pressure linear along y, on either face: at the nodes again, to the second order of the mesh."""
    mesh = two(("hex20", "hex20"), ((6, 2), (6, 2)))
    path = csv(tmp_path, mesh, face, unit)
    found = attached(tmp_path, path, mesh)
    assert found.pairs.pressure == pytest.approx(1e6 * (5 + 100 * mesh.points[found.pairs.first][:, 1]), rel=0.06)
    assert found.pairs.area @ found.pairs.pressure == pytest.approx(6.5e6 * 6e-4, rel=1e-9)
    apart = attached(tmp_path, path, mesh, coupling="faces")
    assert not apart.pairs.lumped
    assert apart.pairs.totals()[0] == pytest.approx(found.pairs.totals()[0], rel=1e-3)


@pytest.mark.parametrize("suffix", ["bdf", "msh", "cdb"])
def test_models_of_every_format(tmp_path, suffix):
    """The same blocks as Nastran, Gmsh and ANSYS give the pairs of Abaqus, in the same node numbers."""
    mesh = two(("hex20", "hex20"), ((2, 2), (2, 2)), counts=(2, 2))
    expected = attached(tmp_path, mesh=mesh)
    study = Study.read(tmp_path / "study.toml")
    if suffix == "bdf":
        text, faces = meshfiles.nastran(mesh, field="large"), ("PLOAD4_2", "PLOAD4_3")
    elif suffix == "msh":
        text, faces = meshfiles.gmsh(mesh), FACES
    else:
        text, faces = meshfiles.ansys(mesh), ("P0_RIGHT", "P1_LEFT")
    file = tmp_path / f"model.{suffix}"
    file.write_text(text)
    found = faying.attach(file, faces, unit="mm", study=study, pressure="5 MPa")
    (a, b), (c, d) = found.deck.ends, expected.deck.ends
    assert dict(zip(a.tolist(), b.tolist(), strict=True)) == dict(zip(c.tolist(), d.tolist(), strict=True))
    area = dict(zip(c.tolist(), expected.pairs.area, strict=True))
    assert found.pairs.area == pytest.approx([area[n] for n in a.tolist()], rel=1e-6)
    assert found.deck.first_element > max(number for _, number, *_ in meshfiles.solids(mesh))


def test_sets_of_the_study_are_the_parts_whatever_gives_the_pressure(tmp_path):
    """Parts that the study names by element sets are those of a given pressure, too, with their materials."""
    text = TEXT.replace('unit = "mm"\n', 'unit = "mm"\nsets = {upper = "p0", lower = "p1"}\n', 1)
    text = text.replace("[part.p0]", "[part.upper]").replace(
        '[part.p1]\nmaterial = "45 steel"', "[part.lower]\n" + BRASS
    )
    solved = attached(tmp_path, "solve", text=text, preload="3 kN")
    given = attached(tmp_path, "5 MPa", text=text)
    assert {name: one.name for name, one in given.materials.items()} == {"upper": "45 steel", "lower": "brass"}
    assert given.materials == solved.materials
    pair = faying.ContactPair(given.materials["upper"], given.materials["lower"])
    law = faying.JK(D=2.39, G=1.53e-10, scan_area=16e-6, pair=pair)
    assert given.pairs.totals()[0] == pytest.approx(law.at_pressure(5e6).k_n * 6e-4, rel=1e-10)
    with pytest.raises(faying.InputError, match="part 'upper' names the element set 'p7'; the file holds 'p0', 'p1'"):
        attached(tmp_path, text=text.replace('"p0"', '"p7"', 1))


def test_coarse_faces_with_springs_at_nodes_are_told_how_much_stiffer_they_turn(tmp_path):
    """The trapezoidal rule with n elements a side has 1 + 2/n^2 of the second moment of a square."""

    def said(n, **more):
        mesh = two(("hex8", "hex8"), ((n, n), (n, n)), counts=(2, 2))
        return [note for note in attached(tmp_path, mesh=mesh, **more).notes if "resist a turn" in note]

    assert "by 50% more than the joint" in said(2)[0]
    assert "by 12% more" in said(4)[0]
    assert not said(8) + said(2, coupling="faces")


def test_bent_faces_have_no_contact_table_and_flat_ones_do(tmp_path):
    def of(form):
        found = attached(tmp_path, text=TEXT.replace('"p1.left"]\n', f'"p1.left"]\n[joint.form]\n{form}\n', 1))
        return found.deck.contact is not None, [note for note in found.notes if "no contact table" in note]

    assert of("flat = true") == (True, [])
    written, notes = of('twist = "1 um"')
    assert not written
    assert len(notes) == 1


def test_friction_of_a_contact_table_is_that_of_the_joint_or_of_its_materials(tmp_path):
    """As the tables of a law alone have it; the deck says where no joint gives it."""
    joint = attached(tmp_path, text=TEXT.replace('"p1.left"]\n', '"p1.left"]\nfriction = 0.3\n', 1)).deck.contact
    assert (joint.friction, joint.given) == (0.3, True)
    contact = attached(tmp_path).deck.contact
    assert (contact.friction, contact.given) == (faying.CATALOGUE["45 steel"].friction, False)


def test_pressure_from_our_preload(tmp_path):
    found = attached(tmp_path, "solve", preload="3 kN")
    assert found.pairs.area @ found.pairs.pressure == pytest.approx(3000, rel=1e-8)
    assert "bolts at 3 kN" in " ".join(found.deck.facts)
    with pytest.raises(faying.InputError, match="the study has the preloads 1 kN, 3 kN; say which by preload"):
        attached(tmp_path, "solve")
    with pytest.raises(faying.InputError, match="preload = 2 kN: the study has no such preload; it has 1 kN, 3 kN"):
        attached(tmp_path, "solve", preload="2 kN")


@pytest.mark.parametrize("pressure", ["solve", "5 MPa"])
def test_springs_of_a_joint_that_has_carried_more_are_refused(pressure, tmp_path):
    """Under a pressure that was given they were those of first loading, half as stiff, without a word."""
    file, study = model(tmp_path)
    settled = replace(study, preloads=(PreloadCase((1e3,), after=((3e3,),), settled=True),))
    with pytest.raises(faying.InputError, match="1 kN: springs at nodes are those of first loading"):
        attach(file, FACES, unit="mm", study=settled, pressure=pressure)


def test_frequencies_are_those_of_a_study(tmp_path):
    """Springs per area of `attach` on the bare matrices give the modes of `run`, loss factors too."""
    mesh = two(("hex8", "hex8"), ((2, 2), (2, 2)), counts=(2, 2))
    file, study = model(tmp_path, mesh)
    wanted = run(pulled(study, 3e3))
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, faying.CATALOGUE["45 steel"]))
    mmwrite(tmp_path / "K.mtx", K * 1e-3)
    mmwrite(tmp_path / "M.mtx", M * 1e-3)
    n = meshfiles.numbers(mesh)
    (tmp_path / "dofs").write_text("\n".join(f"{i} {c}" for i in n for c in (1, 2, 3)) + "\n")
    from faying.export.matrix_modes import modes_with_joint

    made = attach(file, FACES, unit="mm", study=study, pressure="solve", preload="3 kN", coupling="faces")
    found, rigid = modes_with_joint(
        made,
        tmp_path / "K.mtx",
        mass=tmp_path / "M.mtx",
        dofs=tmp_path / "dofs",
        stiffness_unit="N/mm",
        mass_unit="t",
        count=3,
    )
    assert rigid == 6
    assert found.frequencies == pytest.approx(wanted.frequencies[0], rel=1e-6)
    assert found.loss_factors == pytest.approx(wanted.loss_factors[0], rel=1e-4)


def common(file):
    return [
        "attach",
        str(file),
        "--face-a",
        FACES[0],
        "--face-b",
        FACES[1],
        "--unit",
        "mm",
        "--law",
        str(file.with_name("study.toml")),
    ]


def invoke(capsys, *words):
    try:
        main(list(map(str, words)))
    except SystemExit as end:
        out = capsys.readouterr()
        return end.code, out.out, out.err
    raise AssertionError


@pytest.mark.parametrize("solver", ["mapdl", "abaqus", "nastran", "calculix", "aster"])
def test_the_command(tmp_path, capsys, solver):
    file, _ = model(tmp_path)
    code, out, err = invoke(
        capsys,
        *common(file),
        "--pressure",
        "5 MPa",
        "--to",
        solver,
        "--out",
        tmp_path / "out",
        "--frequency",
        "500 Hz",
        "--json",
    )
    assert code == 0, err
    document = json.loads(out)
    assert document["pairs"] == 9
    assert document["area [m^2]"] == pytest.approx(6e-4)
    assert len(document["files"]) >= 3
    pairs = (tmp_path / "out" / "joint_pairs.csv").read_text().splitlines()
    body = [line for line in pairs if not line.startswith("#")]
    assert body[0].startswith("node a,node b,x [m]")
    table = np.array([[float(w) for w in line.split(",")] for line in body[1:]])
    assert table[:, 5].sum() == pytest.approx(6e-4)
    assert table[:, 7].sum() == pytest.approx(document["total_k_n [N/m]"], rel=1e-8)


def test_the_command_gives_modes(tmp_path, capsys):
    mesh = two(("hex8", "hex8"), ((2, 2), (2, 2)), counts=(2, 2))
    file, _ = model(tmp_path, mesh)
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, faying.CATALOGUE["45 steel"]))
    mmwrite(tmp_path / "K.mtx", K), mmwrite(tmp_path / "M.mtx", M)
    (tmp_path / "dofs").write_text("\n".join(f"{i}.{c}" for i in meshfiles.numbers(mesh) for c in (1, 2, 3)) + "\n")
    words = [
        *common(file),
        "--pressure",
        "5 MPa",
        "--matrices",
        tmp_path / "K.mtx",
        "--mass",
        tmp_path / "M.mtx",
        "--dofs",
        tmp_path / "dofs",
        "--modes",
        "4",
    ]
    code, out, err = invoke(capsys, *words, "--stiffness-unit", "N/m", "--mass-unit", "kg", "--json")
    assert code == 0, err
    found = json.loads(out)["modes"]
    made = attach(file, FACES, unit="mm", study=Study.read(tmp_path / "study.toml"), pressure="5 MPa")
    want = lowest_modes(K + made.pairs.matrix(), M, 10, shift_frequency=1000.0).frequencies[6:]
    assert found["rigid"] == 6
    assert found["frequencies [Hz]"] == pytest.approx(want, rel=2e-2)  # the loss shifts them by its square
    code, out, _ = invoke(capsys, *words, "--stiffness-unit", "N/m", "--mass-unit", "kg")
    assert len([line for line in out.splitlines() if line.strip()[:1].isdigit()]) >= 4
    code, _, err = invoke(capsys, *words)
    assert code == 1
    assert "does not state its units" in err


def test_faces_with_nodes_without_partner(tmp_path):
    """The second block is half as wide: what sticks out is told, and carries nothing."""
    wide = row([0.06], [2], kinds=("hex8",), sections=((4, 2),), width=0.04, height=0.02)
    thin = row([0.04], [2], kinds=("hex8",), sections=((2, 2),), width=0.02, height=0.02)
    n = len(wide.points)
    mesh = Mesh(
        points=np.concatenate([wide.points, thin.points + np.array([0.06, 0, 0])]),
        parts={"p0": wide.parts["p0"], "p1": tuple(b + n for b in thin.parts["p0"])},
        faces={
            **wide.faces,
            "p1.left": tuple(b + n for b in thin.faces["p0.left"]),
            "p1.right": tuple(b + n for b in thin.faces["p0.right"]),
        },
        face_part={**wide.face_part, "p1.left": "p1", "p1.right": "p1"},
    )
    found = attached(tmp_path, mesh=mesh)
    assert len(found.pairs) == 9
    assert any("6 of 15 nodes of 'p0.right' have no partner" in note for note in found.notes)
    assert found.interface.area == pytest.approx(4e-4)


def fault(tmp_path, match, **given):
    with pytest.raises(faying.InputError, match=match):
        attached(tmp_path, **given)


def test_faults_of_models(tmp_path):
    fault(tmp_path, "no face is called 'roof'; the faces are 'p0.left'", faces=("roof", "p1.left"))
    far = row([0.06, 0.04], [2, 2], sections=((2, 2), (2, 2)), width=0.03, height=0.02, gap=0.005)
    fault(tmp_path, "do not touch: they are 5 mm apart", mesh=far)
    fault(tmp_path, r"turned the same way \(normals \(1, 0, 0\) and \(1, 0, 0\)\)", faces=("p0.right", "p1.right"))
    fault(tmp_path, "both on part 'p0'", faces=("p0.right", "p0.left"))
    mesh = two(("hex8", "hex8"), ((2, 2), (2, 2)), counts=(2, 2))
    fault(tmp_path, "in m the structure is 106 m long; is that its unit", unit="m")
    fault(tmp_path, "in um the structure is .* m long; is that its unit", unit="um")
    thick = Mesh(
        points=mesh.points * np.array([0.5, 1, 1]), parts=mesh.parts, faces=mesh.faces, face_part=mesh.face_part
    )
    fault(tmp_path, r"in m the joint has 600 m2; is that the unit of the model\?.*--any-size", mesh=thick, unit="m")
    assert attached(tmp_path, mesh=thick, unit="m", any_size=True).interface.area == pytest.approx(600)
    near = row([0.06, 0.04], [2, 2], sections=((2, 2), (2, 2)), width=0.03, height=0.02, gap=1e-4)
    assert any("up to 0.1 mm apart" in note for note in attached(tmp_path, mesh=near).notes)
    fault(tmp_path, "do not touch", mesh=near, tolerance=1e-5)
    twice = meshfiles.abaqus(mesh)
    line = next(x for x in twice.splitlines() if x.startswith("103,"))
    file, study = model(tmp_path, mesh)
    file.write_text(twice.replace(line, line + "\n" + line.replace("103,", "9103,")))
    found = attach(file, FACES, unit="mm", study=study, pressure="5 MPa")
    assert any("1 nodes belong to no element and are left out: 9103" in str(note) for note in found.notes)
    with pytest.raises(faying.ReadError, match="no file"):
        attach(tmp_path / "none.inp", FACES, unit="mm", study=study, pressure="5 MPa")


def test_faults_of_studies(tmp_path):
    other = TEXT.replace('faces = ["p0.right", "p1.left"]', 'faces = ["x", "y"]')
    two_joints = other + '[[joint]]\nname = "second"\nfaces = ["u", "v"]\n'
    fault(tmp_path, "the study has the joints 'joint', 'second'; choose whose law to take by joint", text=two_joints)
    assert attached(tmp_path, text=two_joints, joint="second").pairs.lumped
    assert attached(tmp_path, text=other).pairs.lumped
    materials = TEXT.replace('[part.p1]\nmaterial = "45 steel"', '[part.roof]\nmaterial = "brass"')
    brass = (
        materials + '[material.brass]\nE = "100 GPa"\nnu = 0.33\ndensity = "8500 kg/m^3"\nyield_strength = "200 MPa"\n'
    )
    fault(tmp_path, r"has no entry for 'p1', which is in the model, .* add \[part.p1\]", text=brass)


def test_faults_of_pressures(tmp_path):
    mesh = two(("hex8", "hex8"), ((2, 2), (2, 2)), counts=(2, 2))
    fault(tmp_path, "--pressure", pressure="5 mm")
    fault(tmp_path, "must be above 0", pressure="0 Pa")
    fault(tmp_path, "no file .*none.csv; --pressure takes a CSV file", pressure=str(tmp_path / "none.csv"))
    path = csv(tmp_path, mesh, head="n,p")
    fault(tmp_path, "should begin with the heading", pressure=path)
    fault(tmp_path, 'the column "pressure" lacks its unit', pressure=csv(tmp_path, mesh, head="node,pressure"))
    fault(
        tmp_path, '"mm" of the column .* is not a unit like Pa', pressure=csv(tmp_path, mesh, head="node,pressure [mm]")
    )
    fault(
        tmp_path,
        "9 pressures are negative; .* change the sign",
        pressure=csv(tmp_path, mesh, value=lambda x: -1 - x[:, 0]),
    )
    path = csv(tmp_path, mesh)
    lines = path.read_text().splitlines()
    path.write_text("\n".join(lines[:-2]))
    fault(tmp_path, "it lacks 2 of 9 nodes of 'p0.right', .* and 9 of 9 nodes of 'p1.left'", pressure=path)
    path.write_text("\n".join([*lines, lines[-1]]))
    fault(tmp_path, "gives some nodes twice", pressure=path)
    path.write_text("\n".join([*lines, "five,6"]))
    fault(tmp_path, 'line 12: "five" in the column "node" is not a number', pressure=path)
    path.write_text("node,pressure [MPa]\n")
    fault(tmp_path, "has no pressures", pressure=path)


def test_nothing_is_written_after_a_fault(tmp_path, capsys):
    file, _ = model(tmp_path)
    before = sorted(tmp_path.iterdir())
    for words, text in (
        (("--pressure", "5 MPa"), "nothing to do: name a solver with --to"),
        (("--pressure", "5 bananas", "--to", "mapdl"), "--pressure"),
        (("--pressure", "5 MPa", "--to", "mapdl", "--frequency", "0 Hz"), 'frequency = "0 Hz"; it must be positive'),
        (("--pressure", "5 MPa", "--to", "mapdl", "--out", str(file)), "cannot make the folder"),
    ):
        code, _, err = invoke(capsys, *common(file), *words)
        assert code == 1
        assert text in err
        assert sorted(tmp_path.iterdir()) == before


def test_matrices_half_held(tmp_path):
    """Matrices of a model that is held in some directions only are refused."""
    mesh = two(("hex8", "hex8"), ((2, 2), (2, 2)), counts=(2, 2))
    file, study = model(tmp_path, mesh)
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, faying.CATALOGUE["45 steel"]))
    K = K.tolil()
    for i in range(0, K.shape[0], 3):
        K[i, i] += 1e9
    mmwrite(tmp_path / "K.mtx", K.tocsr()), mmwrite(tmp_path / "M.mtx", M)
    (tmp_path / "dofs").write_text("\n".join(f"{i}.{c}" for i in meshfiles.numbers(mesh) for c in (1, 2, 3)) + "\n")
    from faying.export.matrix_modes import modes_with_joint

    made = attach(file, FACES, unit="mm", study=study, pressure="5 MPa")
    with pytest.raises(faying.InputError, match="leave 3 of the six rigid motions free"):
        modes_with_joint(
            made,
            tmp_path / "K.mtx",
            mass=tmp_path / "M.mtx",
            dofs=tmp_path / "dofs",
            stiffness_unit="N/m",
            mass_unit="kg",
        )
