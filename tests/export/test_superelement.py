"""A superelement against the full model: its modes from the files, its mass, a mass hung on it, its loss."""

import json
import os
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from scipy.io import mmread
from scipy.linalg import eigh, expm, sqrtm
from scipy.sparse import load_npz

import faying
from faying.cli.main import cli
from faying.export.superelement import superelement
from tests.helpers.examples import ROOT

PLACES = ["upper.seat", {"part": "lower", "normal": "-x"}, ("40 mm", "15 mm", "15 mm")]
UP_TO = 30e3


@pytest.fixture(scope="module")
def found(file):
    return superelement(file, PLACES, up_to=UP_TO, preload="2 kN")


@pytest.fixture(scope="module")
def full(file):
    """Frequencies [Hz] of the full model at its first preload, 2 kN, and its mass [kg]."""
    modes = faying.matrix_modes(file, count=40)
    return modes.frequencies, modes.mass[0]


def frequencies(K, M):
    return np.sqrt(np.abs(eigh(K, M, eigvals_only=True))) / (2 * np.pi)


def same_below(mine, full, limit, error=1e-3):
    """Elastic modes up to a frequency are those of the full model; how many there are."""
    count = int(np.count_nonzero(full <= limit))
    assert mine[6:count] == pytest.approx(full[6:count], rel=error)
    return count - 6


def test_what_it_says_of_itself(found, full):
    count = same_below(frequencies(found.stiffness, found.mass), full[0], UP_TO)
    assert count == len(found.frequencies) >= 5
    assert found.reduced == pytest.approx(full[0][6 : 6 + count], rel=1e-3)
    assert found.error == pytest.approx(np.abs(found.reduced / full[0][6 : 6 + count] - 1).max(), abs=1e-8)
    # Rayleigh quotients: a smaller space of motions has no lower frequencies
    assert np.all(found.reduced >= full[0][6 : 6 + count] * (1 - 1e-7))
    assert [tuple(row) for row in found.dofs[:7]] == [(1, 1), (1, 2), (1, 3), (1, 4), (1, 5), (1, 6), (2, 1)]
    assert np.count_nonzero(found.dofs[:, 1]) == 15


def rigid(found):
    """The six rigid motions (n, 6) of the interfaces about the origin, modes at rest."""
    out = np.zeros((len(found.dofs), 6))
    for k, (interface, direction) in enumerate(found.dofs):
        if 1 <= direction <= 3:
            arm = found.points[interface - 1]
            out[k] = [*np.eye(3)[direction - 1], *[np.cross(e, arm)[direction - 1] for e in np.eye(3)]]
        elif direction > 3:
            out[k, direction - 1] = 1.0
    return out


def test_rigid_motions_cost_nothing_and_move_the_whole_mass(found, full):
    """They are combinations of the static shapes, so that mass and centre are those of the structure, to rounding."""
    motion = rigid(found)
    scale = np.sqrt(np.diag(found.stiffness))
    assert np.abs((found.stiffness @ motion) / (scale[:, None] * (scale @ np.abs(motion)))).max() < 1e-7
    inertia = motion.T @ found.mass @ motion
    assert np.diag(inertia)[:3] == pytest.approx(full[1], rel=1e-8)
    assert inertia[:3, :3] == pytest.approx(full[1] * np.eye(3), abs=1e-8 * full[1])


def test_a_mass_on_an_interface_is_the_mass_of_a_study_on_that_face(file, found, tmp_path):
    """[[mass]] follows the mean motion of a face, too: modes with 2 kg more than the structure's own weight."""
    study = file.with_name("heavy.toml")
    study.write_text(file.read_text() + '\n[[mass]]\nmass = "2 kg"\nface = "upper.seat"\n')
    heavy = faying.matrix_modes(study, count=16).frequencies
    mass = found.mass.copy()
    mass[[0, 1, 2], [0, 1, 2]] += 2.0
    assert same_below(frequencies(found.stiffness, mass), heavy, UP_TO) >= 5


def test_loss_is_that_of_the_joint(file, found):
    """Loss factors to first order: those of the full model, which `condense` gives of its only joint."""
    known = faying.condense(file, preload="2 kN")
    values, shapes = eigh(found.stiffness, found.mass)
    lost = np.einsum("im,ij,jm->m", shapes, found.loss, shapes)[6:] / values[6:]
    assert lost[: len(known.loss)] == pytest.approx(known.loss, rel=1e-2)


def test_loss_of_the_parts(file, found):
    """structural_loss adds that share of their stiffness: all of a held mode's that does not move the joint."""
    damped, place = file.with_name("damped.toml"), '{ point = ["40 mm", "15 mm", "15 mm"], direction = [0, 0, 1] }'
    damped.write_text(
        file.read_text()
        + '\n[response]\nstructural_loss = 0.01\nfrom = "100 Hz"\nto = "1 kHz"\n'
        + f"input = [{place}]\noutput = [{place}]\n"
    )
    more = superelement(damped, PLACES, up_to=UP_TO, preload="2 kN")
    values, shapes = eigh(found.stiffness, found.mass)
    added = np.einsum("im,ij,jm->m", shapes, more.loss - found.loss, shapes)[6:] / values[6:]
    # the springs of the joint have the rest of the energy
    assert np.all((added[:5] > 1e-4) & (added[:5] < 0.01 * (1 + 1e-6)))


def test_files_of_scipy(found, full, tmp_path):
    names = {path.name for path in found.write("npz", tmp_path)}
    assert names == {"stiffness.npz", "mass.npz", "loss.npz", "dofs.txt", "points.txt"}
    K, M = (load_npz(tmp_path / f"{name}.npz").toarray() for name in ("stiffness", "mass"))
    same_below(frequencies(K, M), full[0], UP_TO)
    again = faying.matrix_modes(tmp_path / "stiffness.npz", tmp_path / "mass.npz", count=12)
    assert again.frequencies[6:] == pytest.approx(frequencies(K, M)[6:12], rel=1e-7)


def test_files_of_matrix_market(found, full, tmp_path):
    """In N, mm and tonnes the frequencies are the same, and each row is known."""
    found.write("market", tmp_path, unit="mm")
    K, M, loss = (mmread(tmp_path / f"{name}.mtx").toarray() for name in ("stiffness", "mass", "loss"))
    same_below(frequencies(K, M), full[0], UP_TO)
    assert K[0, 0] == pytest.approx(found.stiffness[0, 0] * 1e-3, rel=1e-12)
    assert K[3, 3] == pytest.approx(found.stiffness[3, 3] * 1e3, rel=1e-12)
    assert M[0, 0] == pytest.approx(found.mass[0, 0] * 1e-3, rel=1e-12)
    assert loss[0, 0] / K[0, 0] == pytest.approx(found.loss[0, 0] / found.stiffness[0, 0], rel=1e-12)
    assert M[-1, -1] == pytest.approx(1.0)
    rows = (tmp_path / "dofs.txt").read_text().split()
    assert len(rows) == len(K)
    assert rows[:2] == ["900001.1", "900001.2"]
    assert rows[-1].endswith(".1")


def test_nastran_is_read_back(found, full, tmp_path):
    """By the reader of DMIG in Faying; sixteen columns hold ten digits."""
    (file,) = found.write("nastran", tmp_path, unit="mm", node=41)
    K, M, dofs = faying.read_matrices(file, stiffness_unit="N/mm", mass_unit="t")
    order = [dofs.tolist().index(row) for row in (found.dofs + np.array([40, 0])).tolist()]
    K, M = K.toarray()[np.ix_(order, order)], M.toarray()[np.ix_(order, order)]
    same_below(frequencies(K, M), full[0], UP_TO)
    text = file.read_text()
    assert text.count("SPOINT*") == np.count_nonzero(found.dofs[:, 1] == 0)
    assert text.count("GRID*") == 3
    assert all(f"case control: {line}" in text for line in ("K2GG = KAAX", "M2GG = MAAX", "K42GG = K4AAX"))


READ = """
import sys, json
from pyNastran.bdf.bdf import read_bdf
model = read_bdf(sys.argv[1], xref=False, punch=True, debug=None)
read = {}
for name, matrix in model.dmig.items():
    A, rows, _ = matrix.get_matrix(is_sparse=False)
    read[name] = [A.tolist(), [[int(i) for i in rows[k]] for k in range(len(A))]]
print(json.dumps(read))
"""


def test_nastran_is_read_by_pynastran(found, full, tmp_path):
    python = os.environ.get("FAYING_PYNASTRAN")
    if not python:
        pytest.skip("FAYING_PYNASTRAN names no Python with pyNastran, which wants a numpy below 2")
    (file,) = found.write("nastran", tmp_path, unit="mm", node=41)
    read = json.loads(subprocess.run([python, "-c", READ, str(file)], capture_output=True, check=True).stdout)
    (K, rows), (M, columns) = read["KAAX"], read["MAAX"]
    order = [columns.index(row) for row in rows]
    same_below(frequencies(np.array(K), np.array(M)[np.ix_(order, order)]), full[0], UP_TO)


def test_abaqus_is_read_back(found, full, tmp_path):
    (file,) = found.write("abaqus", tmp_path, unit="mm", node=41)
    text = file.read_text()
    place = {(a + 40, max(b, 1)): k for k, (a, b) in enumerate(found.dofs.tolist())}
    read = {}
    for name in ("KJ", "MJ", "SJ"):
        read[name] = np.zeros((len(place), len(place)))
        for line in text.split(f"NAME={name},TYPE=SYMMETRIC\n")[1].split("*")[0].splitlines():
            a, b, c, d, value = line.split(",")
            i, j = place[int(a), int(b)], place[int(c), int(d)]
            read[name][i, j] = read[name][j, i] = float(value)
    same_below(frequencies(read["KJ"], read["MJ"]), full[0], UP_TO)
    assert "*MATRIX ASSEMBLE,STIFFNESS=KJ,MASS=MJ,STRUCTURAL DAMPING=SJ" in text
    nodes = text.split("*NODE\n")[1].split("*")[0].splitlines()
    assert {int(line.split(",")[0]) for line in nodes} == {node for node, _ in place}


def test_fmu_is_run_by_fmpy(tmp_path):
    """Answer to a force of one step, in time by exponentials of the matrices, and its FRFs.

    The damping matrix is the root of M^-1 K, found without its modes.
    """
    fmpy = pytest.importorskip("fmpy", reason="FMPy, of the group dev, is not installed")
    from fmpy.fmi2 import FMU2Slave
    from fmpy.validation import validate_fmu

    found = superelement(ROOT / "examples" / "bracket" / "study.toml", ["bracket.top"], up_to="1 kHz")
    loss = 0.05  # so large that the answer has ended after half a second
    (file,) = replace(found, loss=loss * found.stiffness).write("fmu", tmp_path / "out")
    assert validate_fmu(str(file)) == []
    told = fmpy.read_model_description(file)
    number = {variable.name: variable.valueReference for variable in told.modelVariables}
    model = told.coSimulation.modelIdentifier
    unit = FMU2Slave(
        guid=told.guid,
        unzipDirectory=fmpy.extract(file, tmp_path / "unzipped"),
        modelIdentifier=model,
        instanceName="a",
    )
    unit.instantiate()
    unit.setupExperiment(startTime=0.0)
    unit.enterInitializationMode()
    unit.exitInitializationMode()
    h, steps, ways = 2e-5, 25_000, ("x", "y", "z", "rx", "ry", "rz")
    out = [number[f"bracket_top.{what}.{way}"] for what in ("displacement", "velocity", "acceleration") for way in ways]
    motion = np.zeros((steps + 1, 18))
    push = [number["bracket_top.force.z"]]
    unit.setReal(push, [1 / h])
    for k in range(steps):
        unit.doStep(k * h, h)
        unit.setReal(push, [0.0])
        motion[k + 1] = unit.getReal(out)
    unit.terminate()
    unit.freeInstance()
    assert np.abs(motion[-1, :6]).max() < 1e-4 * np.abs(motion[:, :6]).max()
    K, M = found.stiffness, found.mass
    C, time = loss * M @ sqrtm(np.linalg.solve(M, K)).real, h * np.arange(steps + 1)
    n = len(K)
    A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.linalg.solve(M, K), -np.linalg.solve(M, C)]])
    state = np.linalg.solve(A, expm(A * h) - np.eye(2 * n)) @ np.append(np.zeros(n), np.linalg.inv(M)[:, 2] / h)
    for k in (2, 100, 3000):
        there = expm(A * h * (k - 1)) @ state
        then = np.concatenate([there[:6], there[n : n + 6], (A @ there)[n : n + 6]])
        scale = np.abs(motion).max(axis=0).reshape(3, 6).max(axis=1).repeat(6)
        assert np.abs((motion[k] - then) / scale).max() < 1e-7
    for frequency in (50.0, found.frequencies[0], 200.0, found.frequencies[1], 700.0):
        w = 2 * np.pi * frequency
        true = np.linalg.inv(K + 1j * w * C - w**2 * M)[:6, 2]
        pulse = np.sinc(frequency * h) * np.exp(-0.5j * w * h)  # of one step, its integral 1
        seen = h * np.exp(-1j * w * time) @ motion[:, :6] / pulse
        assert np.abs(seen - true).max() < 1e-4 * np.abs(true).max()


def test_a_free_structure_as_fmu_flies_as_its_mass_does(found, full, tmp_path):
    """A constant force through its centre: F t^2 / 2 m, in 50 steps or in 500; its modes move by next to nothing."""
    fmpy = pytest.importorskip("fmpy", reason="FMPy, of the group dev, is not installed")
    (file,) = found.write("fmu", tmp_path)
    for steps in (50, 500):
        rows = fmpy.simulate_fmu(
            str(file),
            stop_time=0.1,
            step_size=0.1 / steps,
            output_interval=0.1 / steps,
            start_values={"upper_seat.force.z": 10.0},
            output=["upper_seat.displacement.z", "upper_seat.velocity.z"],
        )
        _, moved, fast = rows[-1]
        assert moved == pytest.approx(10.0 * 0.1**2 / 2 / full[1], rel=1e-5)
        assert fast == pytest.approx(10.0 * 0.1 / full[1], rel=1e-3)


def test_an_fmu_has_no_units_of_its_own(found, tmp_path):
    with pytest.raises(faying.InputError, match="fmu is written in SI units; leave out the units mm and N"):
        found.write("fmu", tmp_path, unit="mm")
    with pytest.raises(faying.InputError, match=r"not told apart in an FMU: \['a_b', 'a_b', 'node_7'\]"):
        replace(found, names=("a.b", "a b", "node 7")).write("fmu", tmp_path)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("program", ["nastran", "npz"])
def test_one_interface_of_a_free_structure_is_read_back(file, full, program, tmp_path):
    """Its static shape is a rigid motion, whose stiffness is rounding about 0."""
    made = superelement(file, PLACES[1:2], up_to=UP_TO, preload="2 kN")
    files = made.write(program, tmp_path)
    stiffness = next(one for one in files if "dmig" in one.name or one.name.startswith("stiffness"))
    mass = next((one for one in files if one.name.startswith("mass")), None)
    found = faying.matrix_modes(stiffness, mass, count=20)
    same_below(found.frequencies, full[0], UP_TO)


def test_the_command(file, tmp_path, capsys):
    given = ["condense", str(file), "--superelement", "--interface", "upper.seat", "--preload", "2 kN"]
    given += ["--interface", '{part = "lower", normal = "-x"}', "--interface", "40 mm; 15 mm; 15 mm"]
    cli.main(args=[*given, "--to", "npz", "--out", str(tmp_path), "--json"], standalone_mode=False)
    printed = json.loads(capsys.readouterr().out)
    assert printed["interfaces"][0] == "upper.seat"
    assert len(printed["frequencies"]["values"]) == 3  # the study's own
    assert str(tmp_path / "mass.npz") in printed["files"]
    cli.main(args=given, standalone_mode=False)
    shown = capsys.readouterr().out
    assert "15 of interfaces" in shown
    assert "superelement [Hz]" in shown


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ([], "needs an interface"),
        (["upper.seat", "upper.seat"], "'upper.seat' is an interface twice"),
        (["nothing"], "interface 1 names the face 'nothing'"),
        ([{"part": "upper"}], "gives a part but no face of it"),
        ([("1 m", "0 m", "0 m")], "the nearest node"),
        ([("1 m", "0 m")], "three components"),
    ],
)
def test_interfaces_that_are_none(file, given, text):
    with pytest.raises(faying.InputError, match=text):
        superelement(file, given, preload="2 kN")


def test_a_face_that_a_support_holds(file):
    held = file.with_name("held.toml")
    held.write_text(file.read_text() + '\n[[support]]\nface = "upper.seat"\n')
    with pytest.raises(faying.InputError, match="a support holds some of the interface 'upper.seat'"):
        superelement(held, ["upper.seat"], preload="2 kN")


@pytest.mark.parametrize(
    ("words", "text"),
    [
        (["--superelement", "--joint", "joint"], "a superelement has --interface"),
        (["--interface", "upper.seat"], "add --superelement"),
        (["--superelement", "--interface", "{part = 1"], "is not a selector"),
        (["--superelement", "--interface", "upper.seat", "--to", "market"], "--to needs --unit"),
    ],
)
def test_faults_of_the_command(file, words, text):
    with pytest.raises(faying.InputError, match=text):
        cli.main(args=["condense", str(file), *words], standalone_mode=False)


def test_a_program_that_takes_none(found, tmp_path):
    with pytest.raises(faying.InputError, match="'mapdl' has no exporter for a superelement; take one of abaqus, nas"):
        found.write("mapdl", tmp_path)
    with pytest.raises(faying.InputError, match="node 0: give a number from 1 on"):
        found.write("nastran", tmp_path, node=0)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("study", "places", "up_to"),
    [
        ("t-specimen", ["upper.end", "lower.end"], None),
        ("bracket", ["bracket.top", {"part": "base", "nearest": ["0 mm", "0 mm", "0 mm"]}], 24e3),
    ],
)
def test_fifteen_modes_from_files(study, places, up_to, tmp_path):
    """Of the examples, from the written files: within 0.1 % of the full model."""
    plan = faying.Study.read(ROOT / "examples" / study / "study.toml")
    made = superelement(plan, places, up_to=up_to, preload=plan.preloads[0].name)
    made.write("market", tmp_path, unit="mm")
    K, M = (mmread(tmp_path / f"{name}.mtx").toarray() for name in ("stiffness", "mass"))
    full = faying.matrix_modes(plan, count=30).frequencies
    rigid = 6 if study == "t-specimen" else 0
    mine = frequencies(K, M)[rigid : rigid + 15]
    assert mine == pytest.approx(full[rigid : rigid + 15], rel=1e-3)
