"""A part alone, and parts without bolts: their modes against closed forms, and what a run shows and refuses then."""

import json
import re

import numpy as np
import pytest
from click.testing import CliRunner
from scipy.optimize import brentq

import faying
from faying.answer.run import run
from faying.cli.main import cli
from faying.output.answer import lead
from faying.output.report import html
from faying.setup import new
from tests.geometry.test_face_facts import box, written
from tests.helpers.boxes import row
from tests.helpers.plates import LAW, STEEL

LENGTH, WIDTH, HEIGHT = 0.12, 0.02, 0.008  # m
ROD = faying.Material(name="rod", E=200e9, nu=0.0, density=8000.0)  # without Poisson's ratio a rod is exact
STUDY = """
title = "bar"
[geometry]
step = "bar.step"
size = "6 mm"
[part.bar]
material = "S355"
[modes]
count = 3
"""
PAIR = """
[geometry]
step = "pair.step"
size = "8 mm"
[part.a]
material = "S355"
[part.b]
material = "S355"
[[joint]]
faces = [{ part = "a", touching = "b" }, { part = "b", touching = "a" }]
"""


def bar(*lengths, **given):
    counts = [round(length / 0.01) for length in lengths]
    kinds, sections = ("hex20",) * len(lengths), ((2, 1),) * len(lengths)
    return row(lengths, counts, kinds=kinds, sections=sections, width=WIDTH, height=HEIGHT, **given)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    path = tmp_path_factory.mktemp("alone")
    written(path / "bar.step", box((0, 0, 0), (60, 20, 8), "bar"))
    written(path / "pair.step", box((0, 0, 0), (30, 20, 8), "a"), box((0, 0, 8), (30, 20, 16), "b"))
    (path / "study.toml").write_text(STUDY)
    return path


@pytest.fixture(scope="module")
def result(folder):
    return run(folder / "study.toml")


@pytest.mark.parametrize("engine", ["reanalysis", "direct"])
def test_a_free_bar_vibrates_as_a_rod_and_as_a_beam(engine):
    """Rod: f = c/(2 L). Timoshenko's beam, free at both ends: 22.373 (1 - ...) of Euler's within 1 % at L/h = 15."""
    found = faying.Structure(bar(LENGTH), ROD, []).solve(modes=9, engine=engine).modes.frequencies
    c = np.sqrt(ROD.E / ROD.density)
    assert np.abs(found / (c / (2 * LENGTH)) - 1).min() < 1e-5
    euler = 22.3733 / (2 * np.pi * LENGTH**2) * c * HEIGHT / np.sqrt(12)
    assert 0.98 < found[0] / euler < 1.0  # shear and rotatory inertia soften it


def test_a_held_bar_vibrates_as_a_fixed_rod():
    """f = c/(4 L)."""
    held = faying.Support(face="p0.left")
    found = faying.Structure(bar(LENGTH), ROD, [], supports=[held]).solve(modes=8).frequencies
    assert np.abs(found / (np.sqrt(ROD.E / ROD.density) / (4 * LENGTH)) - 1).min() < 1e-4


@pytest.mark.parametrize("engine", ["reanalysis", "direct"])
def test_parts_on_supports_of_their_own_have_the_modes_of_each(engine):
    """Two like bars that do not touch, each held at one end: every mode of one bar, twice."""
    half, held = LENGTH / 2, [faying.Support(face="p0.left"), faying.Support(face="p1.right")]
    one = faying.Structure(bar(half), ROD, [], supports=held[:1]).solve(modes=3, engine=engine).frequencies
    two = faying.Structure(bar(half, half, gap=1e-3), ROD, [], supports=held).solve(modes=6, engine=engine).frequencies
    np.testing.assert_allclose(two, np.repeat(one, 2), rtol=1e-7)


def test_a_rod_with_a_mass_at_its_end():
    """x tan x = m_rod/m_tip, x = omega L/c, of a rod that is fixed at the other end."""
    rod = ROD.density * LENGTH * WIDTH * HEIGHT
    held, tip = faying.Support(face="p0.left"), faying.PointMass(mass=rod / 2, face="p0.right")
    found = faying.Structure(bar(LENGTH), ROD, [], supports=[held], masses=[tip]).solve(modes=8).frequencies
    x = brentq(lambda x: x * np.tan(x) - 2, 0.1, 1.5)
    expected = x * np.sqrt(ROD.E / ROD.density) / (2 * np.pi * LENGTH)
    assert np.abs(found / expected - 1).min() < 1e-4


def test_a_wrong_support_is_answered_in_words():
    with pytest.raises(faying.InputError, match="Support takes no stiff; did you mean stiffness"):
        faying.Support(face="p0.left", stiff=1.0)


def test_a_structure_without_bolts_takes_no_preload_and_one_with_joints_needs_them():
    with pytest.raises(faying.InputError, match="preload = 1000.*; the bolts are none"):
        faying.Structure(bar(LENGTH), ROD, []).solve(1e3)
    halves = faying.Structure(bar(LENGTH / 2, LENGTH / 2), STEEL, [faying.Joint(("p0.right", "p1.left"), law=LAW)])
    with pytest.raises(faying.InputError, match="nothing pulls its joints together"):
        halves.solve()


def test_bonded_parts_are_one_part(folder):
    """Two plates that are bonded have the modes of the block that they make."""
    (folder / "pair.toml").write_text(PAIR + "bonded = true\n[modes]\ncount = 3\nintervals = false\n")
    written(folder / "block.step", box((0, 0, 0), (30, 20, 16), "block"))
    one = STUDY.replace("bar", "block").replace("6 mm", "8 mm")
    (folder / "block.toml").write_text(one)
    pair, block = run(folder / "pair.toml"), run(folder / "block.toml")
    np.testing.assert_allclose(pair.frequencies, block.frequencies, rtol=5e-3)  # meshes differ
    assert pair.free is None


def test_what_has_no_meaning_without_joints_is_absent(result, tmp_path):
    facts = result.to_dict()
    assert not {"pressure", "free", "bonded", "greatest_pressure", "open_share", "bolt_forces", "slipping"} & set(facts)
    heads = result.csv_text().splitlines()[0]
    assert "best [Hz]" in heads
    assert not any(word in heads for word in ("free", "bonded", "loss", "damping"))
    page = html(result)
    assert 'id="modes"' in page
    assert 'id="joints"' not in page
    assert "faces bonded" not in page
    assert result.interval.sources == ("mesh", "structure", "mode")
    assert "no preload" in str(result)
    assert lead(result).startswith("Without bolts, the lowest ")
    assert "NaN" not in json.dumps(facts)
    assert faying.load(result.save(tmp_path / "r.nc")) == result


def test_a_study_and_a_state_without_joints_print_themselves(folder):
    study = faying.Study.read(folder / "study.toml")
    assert not {"joints", "bolts"} & set(study.summary()[1])
    state = faying.Structure(bar(LENGTH), ROD, []).solve(modes=2)
    assert "no preload" in str(state)
    with pytest.raises(faying.InputError, match="the joints are none"):
        state.plot()


def test_the_interval_of_a_part_holds_its_frequency_as_modelled(result):
    assert np.all((result.interval.low < result.frequencies) & (result.frequencies < result.interval.high))


def test_the_command_prints_and_writes_it(folder):
    done = CliRunner().invoke(cli, ["run", str(folder / "study.toml"), "--uff"], catch_exceptions=False)
    assert "no preload [Hz]" in done.output
    names = {path.name for path in (folder / "results").iterdir()}
    assert {"result.nc", "modes.csv", "modes.png", "intervals.svg", "modes.uff"} <= names
    assert not {"pressure.svg", "law.svg", "frequencies.svg"} & names


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (PAIR, r"\[\[bolt\]\] is missing: nothing presses the joints"),
        (STUDY + "[backbone]\n", r"backbone needs a \[\[joint\]\] that bolts press together"),
        (PAIR.partition("[[joint]]")[0], "has no joint"),
    ],
)
def test_what_a_study_cannot_be_is_said_by_check_and_run(folder, text, words):
    path = folder / "wrong.toml"
    path.write_text(text)
    with pytest.raises(faying.InputError, match=words):
        run(path)
    checked = faying.check(path, mesh=False)
    assert any(re.search(words, one.text) for one in checked.faults)


@pytest.mark.parametrize("command", ["predict", "loads", "backbone", "condense"])
def test_work_on_joints_is_refused_without_them(folder, command):
    done = CliRunner().invoke(cli, [command, str(folder / "study.toml")])
    assert "joints that bolts press together" in str(done.exception)


def test_new_writes_a_study_of_one_part(folder):
    out = folder / "fresh" / "bar.toml"
    out.parent.mkdir()
    made = new.new_study(folder / "bar.step", out)
    assert [path.name for path in made.files] == ["bar.toml"]
    assert made.found == "1 part, 0 joints, 0 bolts"
    assert not any(word in out.read_text() for word in ("[surface]", "[[joint]]", "[[bolt]]"))
    assert not faying.check(out).faults
