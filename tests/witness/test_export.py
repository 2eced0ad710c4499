"""Exported decks run or read by other programs: CalculiX, MYSTRAN, pyNastran, mapdl-archive.

pyNastran wants numpy below 2 and MYSTRAN Python 3.12, so both run apart: FAYING_PYNASTRAN and FAYING_MAPDL_ARCHIVE name
a Python that has pyNastran and mapdl-archive, FAYING_MYSTRAN the program mystran.
"""

import json
import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import faying
from faying.decks import calculix, mapdl, nastran
from faying.fe.elasticity import assemble
from faying.fe.interface import join
from faying.numerics.modes import lowest_modes
from tests.helpers import ccx, meshfiles, readers
from tests.helpers.loads import face_load
from tests.helpers.models import FACES, deck_of, two

pytestmark = pytest.mark.slow
HERE = Path(__file__).parent
STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0)
needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")


def program(variable):
    found = os.environ.get(variable)
    if not found:
        pytest.skip(f"{variable} names no program")
    return found


def held(mesh, *faces):
    return np.concatenate([mesh.face_nodes(name) for name in faces])


def frequencies(mesh, joint, fixed, count, rule="stiffness"):
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, STEEL), mass=rule)
    free = np.setdiff1d(np.arange(mesh.unknowns), (3 * fixed[:, None] + np.arange(3)).ravel())
    K, M = (A.tocsr()[free][:, free] for A in (K + joint, M))
    return lowest_modes(K, M, count, shift_frequency=100.0).frequencies


@needs_ccx
@pytest.mark.parametrize("kind", ["tet10", "hex20"])
@pytest.mark.parametrize("angle", [0.0, np.pi / 6])
@pytest.mark.parametrize("coupling", ["nodes", "faces"])
def test_calculix_runs_the_springs(tmp_path, kind, angle, coupling):
    """SPRING2 in the axes of the face: six digits of ten frequencies."""
    sections = ((3, 2), (3, 2)) if coupling == "nodes" else ((3, 2), (2, 2))
    mesh = two((kind, kind), sections, angle, numbers=False)
    deck = deck_of(mesh, coupling)
    fixed = held(mesh, "p0.left", "p1.right")
    step = [
        calculix.spring2(deck),
        "*BOUNDARY",
        *(f"{n + 1},1,3" for n in fixed),
        "*STEP",
        "*FREQUENCY,SOLVER=ARPACK",
        "10",
        "*END STEP",
    ]
    ccx.run(tmp_path, ccx.deck(mesh, dict.fromkeys(mesh.parts, STEEL), step=step))
    assert frequencies(mesh, deck.pairs.matrix(), fixed, 10) == pytest.approx(
        np.sort(ccx.frequencies(tmp_path))[:10], rel=1e-6
    )


def contact_step(mesh, traction, fixed, modes):
    """Traction on the free end, then modes about that state.

    Nothing but the contact holds the second block sideways.
    """
    area = 0.03 * 0.02 * 1e6
    force = face_load(mesh.points, mesh.face("p1.right"), np.array([0.1, 0.015, 0.01]), np.array([-1.0, 0, 0]))
    loads = [f"{i // 3 + 1},{i % 3 + 1},{f * traction * area:.12e}" for i, f in enumerate(force) if f]
    out = ["*BOUNDARY", *(f"{n + 1},1,3" for n in fixed), "*STEP,NLGEOM", "*STATIC", "1.,1.", "*CLOAD", *loads]
    out += ["*NODE FILE", "U", "*NODE PRINT,NSET=SLAVES", "U", "*END STEP"]
    return out + (["*STEP,PERTURBATION", "*FREQUENCY,SOLVER=ARPACK", str(modes), "*END STEP"] if modes else [])


def about_a_state(folder):
    """Frequencies [Hz] of a perturbation step; with contact the table has no column of eigenvalues."""
    text = (folder / "job.dat").read_text()
    return np.array([float(v) for v in re.findall(r"^ +\d+(?: +\S+)? +\S+ +(\S+) +0\.0000000E\+00$", text, re.M)])


def surfaces(mesh):
    lines = []
    elements = {}
    number = 0
    for blocks in mesh.parts.values():
        for cells in blocks:
            for cell in cells:
                number += 1
                elements[number] = cell
    from faying.fe.elements import KINDS
    from faying.fe.solids import kind_of

    for name in FACES:
        corners = {frozenset(f[:4].tolist()) for block in mesh.face(name) for f in block}
        lines.append(f"*SURFACE,NAME={name.upper().replace('.', '')}")
        for n, cell in elements.items():
            kind = KINDS[kind_of(cell[None])]
            for s, side in enumerate(kind.sides):
                if frozenset(int(cell[i]) for i in side[:4]) in corners:
                    lines.append(f"{n},S{s + 1}")
    return lines


@needs_ccx
def test_calculix_runs_the_contact_table(tmp_path):
    """Node-to-surface contact with the law's table, under a uniform pressure, against SPRING2: 1e-3."""
    law = faying.JK(
        D=2.39,
        G=1.53e-10,
        scan_area=16e-6,
        pair=faying.ContactPair(faying.CATALOGUE["45 steel"], faying.CATALOGUE["45 steel"]),
    )
    from faying.export.attach import _contact
    from faying.joint.joint_law import JointLaw
    from faying.joint.pairs import lumped
    from faying.study.keys.joint import JointChoice

    mesh = two(("hex8", "hex8"), ((3, 2), (3, 2)), numbers=False)
    joined = JointLaw(model=law)
    pressure = 5e6
    nodes = join(mesh, *FACES).at_nodes()
    p = np.full(len(nodes.weights), pressure)
    pairs = lumped(nodes, (*joined.stiffness(p), *joined.loss(p)), p)
    spec = JointChoice(name="j", faces=FACES, friction=0.9)
    deck = deck_of(
        mesh,
        pairs=pairs,
        viscous=None,
        contact=_contact(joined, spec, pressure, pressure),
        faces=tuple(name.upper().replace(".", "") for name in FACES),
    )
    fixed = held(mesh, "p0.left")
    slaves = ["*NSET,NSET=SLAVES", *(f"{n + 1}," for n in mesh.face_nodes(FACES[0]))]
    materials = dict.fromkeys(mesh.parts, STEEL)
    first, second = tmp_path / "springs", tmp_path / "contact"
    first.mkdir(), second.mkdir()
    # both under the load, which lowers the first mode of the slender body by 1.4e-3
    state = contact_step(mesh, pressure * 1e-6, fixed, 5)
    ccx.run(first, ccx.deck(mesh, materials, step=[*slaves, calculix.spring2(deck), *state]))
    ccx.run(second, ccx.deck(mesh, materials, step=[*surfaces(mesh), *slaves, calculix.contact(deck), *state]))
    a, b = about_a_state(first)[:5], about_a_state(second)[:5]
    assert len(a) == 5
    assert b == pytest.approx(a, rel=1e-3)


@pytest.mark.parametrize("angle", [0.0, np.pi / 6])
def test_pynastran_reads_the_same_matrix(tmp_path, angle):
    """CBUSH, CELAS2 and DMIG read by pyNastran: the matrix of the pairs."""
    python = program("FAYING_PYNASTRAN")
    deck = deck_of(two(("hex8", "hex8"), ((2, 2), (2, 2)), angle, counts=(1, 1)))
    grids = [
        line
        for n, x in zip(deck.mesh.numbers, deck.mesh.points * 1e3, strict=True)
        for line in nastran.card("GRID", int(n), "", *map(float, x))
    ]
    for name, text in nastran.decks(deck).items():
        path = tmp_path / name
        path.write_text("\n".join(["SOL 103", "CEND", "BEGIN BULK", *grids, text, "ENDDATA"]) + "\n")
        done = subprocess.run(
            [python, str(HERE.parent / "helpers" / "read_nastran.py"), str(path)],
            capture_output=True,
            text=True,
            check=False,
        )
        assert done.returncode == 0, done.stderr
        found = json.loads(done.stdout)
        place = readers.places(*deck.ends)
        for kind, blocks in (("stiffness", deck.stiffness), ("loss", deck.loss)):
            A = np.zeros((len(place),) * 2)
            for n1, c1, n2, c2, value in found[kind]:
                A[place[n1, c1], place[n2, c2]] += value
            want = readers.expected(deck, blocks)
            assert np.abs(A - want).max() < 1e-9 * np.abs(want).max(), (name, kind)


def test_mapdl_archive_reads_the_same_constants(tmp_path):
    python = program("FAYING_MAPDL_ARCHIVE")
    deck = deck_of(two(("hex8", "hex8"), ((2, 2), (2, 2)), np.pi / 6, counts=(1, 1)))
    path = tmp_path / "joint.cdb"
    path.write_text(mapdl.archive(deck))
    done = subprocess.run(
        [python, str(HERE.parent / "helpers" / "read_cdb.py"), str(path)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    place = readers.places(*deck.ends)
    rows_of = [0, 1, 2, 6, 7, 8]
    out = {4: np.zeros((len(place),) * 2), 5: np.zeros((len(place),) * 2)}
    for kind, real, a, b in found["elements"]:
        A = readers.whole(found["sets"][str(real)])
        rows = [place[n, c] for n in (a, b) for c in (1, 2, 3)]
        out[found["keys"][str(kind)]["3"]][np.ix_(rows, rows)] += A[np.ix_(rows_of, rows_of)]
    for key, blocks in ((4, deck.stiffness), (5, deck.dampers)):
        want = readers.expected(deck, blocks)
        assert np.abs(out[key] - want).max() < 1e-9 * np.abs(want).max()


def nastran_model(mesh, joint, fixed, modes):
    """SOL 103 of the mesh with 10-node tetrahedra or 8-node bricks, in mm, N and tonne."""
    bulk = nastran.card("EIGRL", 1, "", "", modes) + nastran.card("MAT1", 1, 200e3, "", 0.3, 7.8e-9)
    for n, x in zip(mesh.numbers, mesh.points * 1e3, strict=True):
        bulk += nastran.card("GRID", int(n), "", *map(float, x))
    for _, number, kind, nodes in meshfiles.solids(mesh):
        name = meshfiles.NASTRAN["tet" if kind.startswith("tet") else "hex"]
        bulk += nastran.card(name, number, 1, *nodes)
    bulk += ["PSOLID,1,1"]
    bulk += [f"SPC1,1,123,{mesh.numbers[n]}" for n in fixed]
    case = ["SOL 103", "CEND", "SPC = 1", "METHOD = 1", "DISP = ALL", "BEGIN BULK"]
    return "\n".join([*case, *bulk, joint, "ENDDATA"]) + "\n"


def mystran(folder, text):
    """Frequencies [Hz] from MYSTRAN's table of real eigenvalues."""
    (folder / "job.bdf").write_text(text)
    done = subprocess.run(
        [program("FAYING_MYSTRAN"), "job.bdf"], cwd=folder, capture_output=True, text=True, check=False
    )
    out = (folder / "job.F06").read_text()
    rows, inside = [], False
    for line in out.splitlines():
        if "R E A L   E I G E N V A L U E S" in line:
            inside, rows = True, []
        words = line.split()
        if inside and len(words) == 7 and words[0].isdigit():
            rows.append(float(words[4]))
        elif inside and rows and not words:
            break
    assert rows, done.stdout[-2000:] + out[-3000:]
    return np.array(rows)


def renumbered(mesh):
    return faying.fe.mesh.Mesh(
        points=mesh.points,
        parts=mesh.parts,
        faces=mesh.faces,
        face_part=mesh.face_part,
        node_numbers=meshfiles.numbers(mesh),
    )


def test_mystran_runs_cbush_and_celas2(tmp_path):
    """Straight and turned by 30 degrees. MYSTRAN 18's CBUSH depends on how the model is turned, which none should."""
    found, bare = {}, {}
    for angle in (0.0, np.pi / 6):
        mesh = renumbered(two(("tet10", "tet10"), ((2, 2), (2, 2)), angle, counts=(2, 2)))
        deck = deck_of(mesh, seed=1)
        fixed = held(mesh, "p0.left", "p1.right")
        for name, joint in (("cbush", nastran.cbush(deck)), ("celas2", nastran.celas2(deck)), ("bare", "")):
            folder = tmp_path / f"{name}{angle:.1f}"
            folder.mkdir()
            found[name, angle] = mystran(folder, nastran_model(mesh, joint, fixed, 6))
        found["ours", angle] = frequencies(mesh, deck.pairs.matrix(), fixed, 6, "exact")
        bare[angle] = frequencies(mesh, 0.0 * deck.pairs.matrix(), fixed, 6, "exact")
    straight, turned = 0.0, np.pi / 6
    assert found["cbush", straight] == pytest.approx(found["celas2", straight], rel=1e-6)
    assert found["celas2", turned] == pytest.approx(found["celas2", straight], rel=1e-6)
    assert found["cbush", turned] == pytest.approx(found["celas2", turned], rel=5e-4)
    assert found["bare", straight][0] < 0.8 * found["celas2", straight][0]
    # MYSTRAN's tetrahedra are not quite ours: bare, they differ by 1e-3; with the joint by no more than twice that
    assert found["bare", straight] == pytest.approx(bare[straight], rel=1.1e-3)
    assert found["celas2", straight] == pytest.approx(found["ours", straight], rel=2.2e-3)


def study_on(tmp_path, model, faces, bolts, extra=""):
    parts = "".join(f'[part.{p}]\nmaterial = "45 steel"\n' for p in model)
    bolt = "".join(f'[[bolt]]\nfaces = ["{a}", "{b}"]\npreload = ["{force}"]\n' for a, b, force in bolts)
    text = (
        f'[geometry]\nmesh = "model.inp"\nunit = "mm"\n{parts}[surface]\nD = 2.39\nG = "1.53e-10 m"\n'
        f'scan_area = "16 mm^2"\n[[joint]]\nname = "j"\nfaces = ["{faces[0]}", "{faces[1]}"]\n{extra}{bolt}'
    )
    (tmp_path / "study.toml").write_text(text)
    return faying.Study.read(tmp_path / "study.toml")


def calculix_model(mesh, materials):
    text = (
        meshfiles.abaqus(mesh)
        .replace("C3D20R", "C3D20")
        .replace(",\n elset=", ",elset=")
        .replace("p0.", "p0_")
        .replace("p1.", "p1_")
    )
    lines = [text]
    for part in mesh.parts:
        m = materials[part]
        lines += [
            f"*MATRIAL,NAME=M{part}".replace("MATRIAL", "MATERIAL"),
            "*ELASTIC",
            f"{m.E * 1e-6:.12e},{m.nu}",
            "*DENSITY",
            f"{m.density * 1e-12:.12e}",
            f"*SOLID SECTION,ELSET={part},MATERIAL=M{part}",
        ]
    return "\n".join(lines) + "\n"


@needs_ccx
def test_the_t_specimen_in_calculix(tmp_path):
    """From STEP to mesh, from mesh to .inp, from there with `attach` to a deck that CalculiX solves: six digits."""
    from faying.export.attach import attach
    from faying.geometry.geometry import mesh_step

    step = HERE.parent.parent / "examples" / "t-specimen" / "t-specimen.step"
    made = mesh_step(step, size=0.03, local_size={"upper.joint": 0.02})
    (tmp_path / "model.inp").write_text(meshfiles.abaqus(made))
    bolts = [(f"upper.seat.{side}", f"lower.seat.{side}", "8 kN") for side in ("left", "right")]
    study = study_on(tmp_path, ("upper", "lower"), ("upper.joint", "lower.joint"), bolts)
    found = attach(tmp_path / "model.inp", ("upper.joint", "lower.joint"), unit="mm", study=study, pressure="solve")
    mesh = found.deck.mesh
    assert np.ptp(found.pairs.pressure) > 1e6
    steel = faying.CATALOGUE["45 steel"]
    materials = dict.fromkeys(mesh.parts, steel)
    far = mesh.points[:, 2]
    fixed = np.flatnonzero(far > far.max() - 1e-6)  # the end of the upper stem: rigid motions cost CalculiX digits
    K, M = assemble(mesh, materials, mass="stiffness")
    K = K + found.pairs.matrix()
    free = np.setdiff1d(np.arange(mesh.unknowns), (3 * fixed[:, None] + np.arange(3)).ravel())
    ours = lowest_modes(K[free][:, free], M[free][:, free], 8, shift_frequency=20.0).frequencies
    text = calculix_model(made, materials) + calculix.spring2(found.deck)
    text += (
        "\n".join(
            [
                "*BOUNDARY",
                *(f"{mesh.numbers[n]},1,3" for n in fixed),
                "*STEP",
                "*FREQUENCY,SOLVER=ARPACK",
                "8",
                "*END STEP",
            ]
        )
        + "\n"
    )
    ccx.run(tmp_path, text)
    assert ours == pytest.approx(np.sort(ccx.frequencies(tmp_path))[:8], rel=1e-6)


@needs_ccx
def test_modes_of_matrices_that_calculix_stores(tmp_path):
    """Bare parts stored by MATRIXSTORAGE, the joint added here: the frequencies of CalculiX with SPRING2."""
    from faying.export.attach import attach
    from faying.export.matrix_modes import modes_with_joint

    made = two(("hex20", "hex20"), ((2, 2), (2, 2)), counts=(3, 2))
    (tmp_path / "model.inp").write_text(meshfiles.abaqus(made))
    study = study_on(tmp_path, ("p0", "p1"), FACES, [("p1.right", "p0.left", "3 kN")])
    found = attach(tmp_path / "model.inp", FACES, unit="mm", study=study, pressure="5 MPa")
    materials = dict.fromkeys(found.deck.mesh.parts, faying.CATALOGUE["45 steel"])
    text = calculix_model(made, materials)
    ccx.run(tmp_path, text + "*STEP\n*FREQUENCY,SOLVER=MATRIXSTORAGE\n1\n*END STEP\n")
    modes, rigid = modes_with_joint(found, tmp_path / "job.sti", stiffness_unit="N/mm", mass_unit="t", count=6)
    assert rigid == 6
    K, M = assemble(found.deck.mesh, materials, mass="stiffness")
    pairs = found.pairs
    real = lowest_modes(K + pairs.matrix(), M, 12, shift_frequency=1000.0)
    from faying.numerics.damped import damped_modes

    ours = damped_modes(real, K + pairs.matrix(), M, pairs.matrix(pairs.loss), rigid=6, count=6)
    assert modes.frequencies == pytest.approx(ours.frequencies, rel=1e-6)
    assert modes.loss_factors == pytest.approx(ours.loss_factors, rel=1e-3, abs=1e-9)
    (tmp_path / "job.sti").unlink()
    ccx.run(tmp_path, text + calculix.spring2(found.deck) + "*STEP\n*FREQUENCY,SOLVER=ARPACK\n12\n*END STEP\n")
    assert np.sort(ccx.frequencies(tmp_path))[6:12] == pytest.approx(real.frequencies[6:12], rel=1e-5)


@needs_ccx
def test_the_pressure_of_the_preload_in_calculix(tmp_path):
    """Blocks pressed together on half of their backs: our pressure against node-to-surface contact, 2 % in norm."""
    from faying.case.case import build
    from faying.export.attach import attach
    from tests.helpers.sides import sides_on

    made = two(("hex8", "hex8"), ((12, 8), (12, 8)), counts=(10, 8))
    faces, owner = dict(made.faces), dict(made.face_part)
    for name, x in (("p0.left", 0.0), ("p1.right", 0.1)):
        on = np.flatnonzero((np.abs(made.points[:, 0] - x) < 1e-9) & (made.points[:, 1] < 0.0151))
        part = made.face_part[name]
        faces[f"{part}.half"], owner[f"{part}.half"] = sides_on(on, made.parts[part], len(made.points)), part
    made = faying.fe.mesh.Mesh(points=made.points, parts=made.parts, faces=faces, face_part=owner)
    (tmp_path / "model.inp").write_text(meshfiles.abaqus(made))
    study = study_on(tmp_path, ("p0", "p1"), FACES, [("p1.half", "p0.half", "3 kN")], "friction = 0.9\n")
    found = attach(tmp_path / "model.inp", FACES, unit="mm", study=study, pressure="solve")
    ours = found.pairs.pressure
    assert ours.max() > 2 * ours.min()

    structure = build(study)
    mesh = structure.mesh
    n = mesh.numbers
    load = 3000 * structure.loads[:, 0]
    corner = [int(np.argmin(np.linalg.norm(mesh.points - x, axis=1))) for x in ([0, 0, 0], [0, 0.03, 0], [0, 0, 0.02])]
    text = calculix_model(made, dict.fromkeys(mesh.parts, faying.CATALOGUE["45 steel"]))
    text += calculix.contact(found.deck).replace(",".join(FACES), "p0_right,p1_left")
    near = np.concatenate([found.pairs.first, found.pairs.second])
    lines = [
        "*NSET,NSET=BOTH",
        *(f"{n[i]}," for i in near),
        "*BOUNDARY",
        f"{n[corner[0]]},1,3",
        f"{n[corner[1]]},1,1",
        f"{n[corner[1]]},3,3",
        f"{n[corner[2]]},1,1",
        "*STEP,NLGEOM,INC=500",
        "*STATIC",
        "0.1,1.",
        "*CLOAD",
        *(f"{n[i // 3]},{i % 3 + 1},{f:.12e}" for i, f in enumerate(load) if f),
        "*NODE PRINT,NSET=BOTH,FREQUENCY=1000",
        "U",
        "*END STEP",
    ]
    ccx.run(tmp_path, text + "\n".join(lines) + "\n")
    last = (tmp_path / "job.dat").read_text().split("displacements")[-1]
    moved = {int(w[0]): float(w[1]) * 1e-3 for w in map(str.split, last.splitlines()[1:]) if len(w) == 4}
    closing = np.array(
        [moved[int(n[a])] - moved[int(n[b])] for a, b in zip(found.pairs.first, found.pairs.second, strict=True)]
    )
    theirs, _ = structure.joints[0].law.pressure(closing)
    area = found.pairs.area
    assert area @ theirs == pytest.approx(3000, rel=5e-3)
    miss = np.sqrt(area @ (theirs - ours) ** 2 / (area @ ours**2))
    print("pressure", ours.min(), ours.max(), theirs.min(), theirs.max(), miss)
    assert miss < 0.02
