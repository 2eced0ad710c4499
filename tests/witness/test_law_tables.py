"""A law as a surface interaction: what CalculiX makes of it is the closure and the flow of heat of the law."""

import re
import shutil
from itertools import pairwise

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.cli.scan.law import command
from faying.contact.conductance import heat_conductance
from faying.contact.models.greenwood_williamson import GreenwoodWilliamson
from faying.export.law_tables import law_tables
from faying.joint.joint_law import JointLaw
from tests.helpers.boxes import row
from tests.helpers.ccx import deck, run
from tests.helpers.ccx_contact import read, surface

STEEL = faying.Material(name="steel", E=206e9, nu=0.0, hardness=2e9, density=7850.0, conductivity=50.0, friction=0.2)
PAIR = faying.ContactPair(STEEL, STEEL)
LAW = GreenwoodWilliamson(density=2e10, radius=20e-6, sigma=0.5e-6, pair=PAIR, asperity="KogutEtsion")
LENGTH = 0.02
needs_ccx = pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")


def numbers(text, keyword):
    """Rows under a keyword."""
    block = text.split(keyword + "\n")[1].split("*")[0]
    return np.array([[float(word) for word in line.split(",")] for line in block.splitlines()])


def test_a_table_is_the_law_in_the_units_of_the_model():
    """Closure against quadrature of dp/k_n, conductance against Barber's, both in mm, N, s."""
    text = law_tables(LAW, "calculix", unit="mm")
    closure = numbers(text, "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TABULAR")
    assert tuple(closure[0]) == (0, 0)
    assert np.all(np.diff(closure, axis=0) > 0)
    for (p, w), (q, v) in pairwise(closure[20:24]):
        middle = np.geomspace(p, q, 201)
        exact = np.trapezoid(1 / LAW.at_pressure(middle * 1e6).k_n, middle * 1e6)
        assert (v - w) * 1e-3 == pytest.approx(exact, rel=1e-3)
    h, p = numbers(text, "*GAP CONDUCTANCE")[20]
    wanted = heat_conductance(LAW.at_pressure(p * 1e6).k_n, PAIR)  # 1 W/(m2 K) is 1e-3 mW/(mm2 K), t/(s3 K)
    assert h == pytest.approx(1e-3 * float(wanted), rel=1e-4)
    assert "*FRICTION\n0.2," in text
    assert max(map(len, text.splitlines())) < 80


def test_friction_sticks_with_the_stiffness_of_the_pressure_that_is_given():
    """It was that of the middle of the table, whatever the pressure."""
    for pressure in (1e6, 20e6):
        text = law_tables(LAW, "calculix", unit="mm", pressure=pressure)
        shear = float(re.search(r"\*FRICTION\n0.2,(\S+)", text)[1])
        assert shear == pytest.approx(1e-9 * float(JointLaw(model=LAW).stiffness(np.array([pressure]))[1][0]))
        assert f"friction sticks with k_t at {pressure / 1e6:g} N/mm2" in text
    with pytest.raises(faying.InputError, match="at most 1e.08"):
        law_tables(LAW, "calculix", unit="mm", pressure="5 GPa")


def test_abaqus_has_its_own_words_for_sticking_and_pressure():
    text = law_tables(LAW, "abaqus", unit="m", name="FLANGE", friction=0.1)
    assert "*SURFACE INTERACTION,NAME=FLANGE" in text
    assert "*GAP CONDUCTANCE,PRESSURE" in text
    assert re.search(r"\*FRICTION,ELASTIC SLIP=\S+\n0.1\n", text)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"program": "comsol"}, "allowed: .abaqus., .calculix."),
        ({"unit": "kg"}, "unit of length"),
        ({"friction": -1.0}, "friction"),
    ],
)
def test_what_does_not_fit_is_said(given, words):
    given = {"program": "abaqus", "unit": "mm"} | given
    with pytest.raises(faying.InputError, match=words):
        law_tables(LAW, given.pop("program"), **given)


def test_the_command_prints_the_same(tmp_path):
    words = ["--model", "gw-ke", "--set", "density=2e10 1/m^2", "--set", "radius=20 um", "--set", "sigma=0.5 um"]
    words += ["--material", "45 steel"]
    out = CliRunner().invoke(command, [*words, "--to", "calculix", "--unit", "mm"], catch_exceptions=False).stdout
    assert "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TABULAR" in out
    with pytest.raises(faying.InputError, match="--to takes --unit"):
        CliRunner().invoke(command, [*words, "--to", "calculix"], catch_exceptions=False, standalone_mode=False)


def bars(folder, interaction, kind, moved, *, hot=None):
    """Two bars in CalculiX, one end moved [m]: pressure [Pa], closure [m], jump of temperature [K]."""
    mesh = row([LENGTH, LENGTH], [3, 3], kinds=("hex8", "hex8"), sections=((2, 2), (2, 2)), width=0.01, height=0.01)
    points, ends = mesh.points, {}
    for face in ("p0.left", "p0.right", "p1.left", "p1.right"):
        ends[face] = np.unique(np.concatenate([block.ravel() for block in mesh.face(face)]))
    lines = [*surface("A", mesh, "p0.right"), *surface("B", mesh, "p1.left")]
    lines += [f"*CONTACT PAIR,INTERACTION={interaction},TYPE={kind} TO SURFACE", "A,B"]
    lines += [*law_tables(LAW, "calculix", unit="mm").splitlines(), "*BOUNDARY"]
    lines += [f"{node + 1},2,3" for node in range(len(points))]
    lines += [f"{node + 1},1,1" for node in ends["p0.left"]]
    way = "*STATIC" if hot is None else "*COUPLED TEMPERATURE-DISPLACEMENT,STEADY STATE"
    lines += ["*STEP,INC=500", way, "0.05,1.,1e-6,0.1", "*BOUNDARY"]
    lines += [f"{node + 1},1,1,{-moved * 1e3:.12e}" for node in ends["p1.right"]]
    if hot is not None:
        lines += [f"{node + 1},11,11,0." for node in ends["p0.left"]]
        lines += [f"{node + 1},11,11,{hot}" for node in ends["p1.right"]]
    lines += ["*NODE PRINT,NSET=NALL,FREQUENCY=1000", "U" if hot is None else "U,NT", "*END STEP"]
    text = deck(mesh, dict.fromkeys(mesh.parts, STEEL), step=lines).replace("C3D8I", "C3D8")
    if hot is not None:
        text = re.sub(r"(\*MATERIAL,NAME=M\w+\n)", r"\1*CONDUCTIVITY\n50.\n", text)
        text = text.replace("*BOUNDARY", "*INITIAL CONDITIONS,TYPE=TEMPERATURE\nNALL,0.\n*BOUNDARY", 1)
    run(folder, text)
    u = read(folder, len(points))[-1].reshape(-1, 3)[:, 0]
    first, second = u[ends["p0.right"]].mean(), u[ends["p1.left"]].mean()
    jump = None
    if hot is not None:
        rows = (folder / "job.dat").read_text().split("temperatures")[-1].splitlines()
        heat = {int(a): float(b) for a, b in (line.split() for line in rows if len(line.split()) == 2)}
        jump = np.mean([heat[k + 1] for k in ends["p1.left"]]) - np.mean([heat[k + 1] for k in ends["p0.right"]])
    return -STEEL.E * first / LENGTH, first - second, jump


@needs_ccx
@pytest.mark.parametrize("pressure", [2e6, 20e6])
def test_calculix_closes_as_the_law_says(pressure, tmp_path):
    joint = JointLaw(model=LAW)
    found, closed, _ = bars(tmp_path, "JOINT", "NODE", joint.approach(pressure) + 2 * LENGTH * pressure / STEEL.E)
    assert closed == pytest.approx(joint.approach(found), rel=1e-3)
    assert found == pytest.approx(pressure, rel=5e-3)


@needs_ccx
def test_calculix_conducts_as_the_law_says(tmp_path):
    hot = 10.0
    found, _, jump = bars(tmp_path, "JOINT_HEAT", "SURFACE", 6e-6, hot=hot)
    assert 2e6 < found < 50e6
    h = float(heat_conductance(LAW.at_pressure(found).k_n, PAIR))
    resistances = 1 / h, 2 * LENGTH / 50.0
    assert jump == pytest.approx(hot * resistances[0] / sum(resistances), rel=1e-3)
