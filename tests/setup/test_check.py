"""faying check: what it finds in studies with one thing wrong, and what it expects beside what a run finds."""

import json
import re
from dataclasses import replace
from math import pi
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

import faying
from faying.bolt.solid_bolt import SolidBolt
from faying.bolt.vdi2230 import cone_angle, cone_pressure
from faying.case.case import Case, build
from faying.case.places import _within
from faying.cli.main import cli, main
from faying.form.form import Form
from faying.geometry.face_facts import read_facts
from faying.geometry.geometry import mesh_step
from faying.setup import new, template
from faying.setup.check import check
from faying.setup.edit import edited
from faying.setup.expected import Expected, unknowns_of
from faying.study import Study
from faying.study.keys.geometry import mesh_of
from tests.helpers import studies
from tests.helpers.assemblies import bracket
from tests.helpers.boxes import row
from tests.helpers.examples import ROOT
from tests.helpers.laps import lapped
from tests.helpers.meshfiles import STUDY, abaqus
from tests.helpers.preloads import pulled
from tests.helpers.proposed import proposed

JOINED = 'faces = ["lower.joint", "upper.joint"]'


@pytest.fixture(autouse=True)
def read_once(monkeypatch):
    """The facts of an unchanged file are those that were read."""
    kept = KEPT

    def facts(path, *, points=None, overlaps=False, leave_out=(), unite=()):
        key = path, path.stat().st_mtime_ns, str(points), overlaps, leave_out, unite
        if key not in kept:
            kept[key] = read_facts(path, points=points, overlaps=overlaps, leave_out=leave_out, unite=unite)
        return kept[key]

    monkeypatch.setattr("faying.setup.check.read_facts", facts)


KEPT = {}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Two named plates with three holes; their study with numbers of a surface in place of a scan."""
    folder = tmp_path_factory.mktemp("check")
    step = lapped(folder / "lap.step", names=("lower", "upper"))
    text, _ = new.study_text(new.find(step), step, folder / "study.toml", new.Answers())
    start, end = text.index("# The rough surface"), text.index("[[joint]]")
    surface = '[surface]\nD = 2.39\nG = "1.53e-10 m"\nscan_area = "16 mm^2"\n\n[law]\nmodel = "jk"\n\n'
    (folder / "study.toml").write_text(text[:start] + surface + text[end:])
    return folder


def looked(folder, *changes):
    """The check of the study after replacements in its text."""
    text = (folder / "study.toml").read_text()
    for old, other in changes:
        assert old in text
        text = text.replace(old, other)
    path = folder / "changed.toml"
    path.write_text(text)
    return check(path, mesh=False), text.splitlines()


def test_a_sound_study(folder):
    found, lines = looked(folder)
    assert not found.faults
    by_code = {one.code: one for one in found.findings}
    assert by_code["contact"].level == "ok"
    said = float(by_code["contact"].text.split("over ")[1].split()[0].replace(",", ""))
    assert said == pytest.approx(4000 - 3 * pi * 4.5**2, rel=1e-3)
    assert "22 mm between seats that are a ring of 9 mm to 16 mm" in by_code["bolt"].text
    assert "faces = " in lines[by_code["contact"].line - 1]
    assert found.expected.unknowns > 10_000


@pytest.mark.parametrize(
    ("more", "warns"),
    [
        ("", False),
        ('[[alternative]]\nlaw = { model = "gw" }\n', False),
        ('[[alternative]]\nlaw = { model = "jk" }\n', True),
        ('[joint.form]\nwaviness = { from = "scan" }\n', True),
    ],
)
def test_the_fit_of_D_and_G_is_doubted_where_it_is_used(tmp_path, more, warns):
    """The study of `faying init`, whose surface obeys no power law: the half-space takes its heights."""
    template.write(tmp_path / "study.toml")
    text = (tmp_path / "study.toml").read_text()
    (tmp_path / "study.toml").write_text(text.replace("\n[[bolt]]", f"\n{more}\n[[bolt]]", 1))
    notes = [one.text for one in check(tmp_path / "study.toml", mesh=False).findings if one.code == "surface"]
    assert any("power law" in text for text in notes) == warns


@pytest.mark.parametrize(
    ("old", "other", "code", "words", "line"),
    [
        ('size = "5 mm"', "size = 5", "keys", "geometry.size = 5", "size = 5"),
        ('preload = "14.5 kN"', 'preload = "14.5 mm"', "keys", "bolt[1].preload", "preload"),
        ('"upper.seat" = {', '"upper.seat" = { up = 3,', "keys", "up is not a key", '"upper.seat"'),
        ('[part."upper"]', '[part."uper"]', "names", "[part] has no entry for 'upper'", "[part."),
        ('normal = "+z"', "normal = [0, 1, 1]", "selector", "no face of 'upper' fits", '"upper.seat"'),
        ('faces = ["lower.joint", "upper.joint"]', 'faces = ["lower.joint", "top"]', "names", "'top'", "faces = "),
        (
            'faces = ["lower.joint", "upper.joint"]',
            'faces = ["lower.joint", "upper.seat"]',
            "contact",
            "do not look",
            "f",
        ),
        (
            'at = ["50 mm", "20 mm", "11 mm"]',
            'at = ["53 mm", "20 mm", "11 mm"]',
            "bolt",
            "3 mm away from the centre",
            "at =",
        ),
        ('model = "jk"', 'model = "gw"', "keys", "law", "["),
        ("[modes]", "[modes", "toml", "is not TOML", "[modes"),
    ],
)
def test_a_fault_is_found_where_it_stands(folder, old, other, code, words, line):
    found, lines = looked(folder, (old, other))
    fault = next(one for one in found.faults if words in one.text)
    assert fault.code == code
    assert line in lines[fault.line - 1]


def test_what_check_refuses_run_refuses_and_says_alike(folder):
    """One door: the words are those with which a run stops."""
    for old, other in (
        ('[part."upper"]', '[part."uper"]'),
        ('at = ["50 mm", "20 mm", "11 mm"]', 'at = ["53 mm", "20 mm", "11 mm"]'),
        ('normal = "+z"', "normal = [0, 1, 1]"),
    ):
        found, _ = looked(folder, (old, other), ('size = "5 mm"', 'size = "20 mm"'))
        with pytest.raises(faying.InputError) as stopped:
            faying.run(folder / "changed.toml")
        first = found.faults[0].text.split(" is ")[0].split(": it has")[0]
        assert first in str(stopped.value)


@pytest.mark.slow
def test_gaps_overlaps_and_odd_bolts(tmp_path):
    step = lapped(tmp_path / "gap.step", gap=0.2, names=("lower", "upper"))
    new.write(new.find(step), step, tmp_path / "s.toml", new.Answers())
    text = (tmp_path / "s.toml").read_text().replace('"lower.joint" = { part = "lower", touching = "upper" }', "")
    text = text.replace('"upper.joint" = { part = "upper", touching = "lower" }', "").replace('snap = "210 um"', "")
    text = text.replace('"lower.joint", "upper.joint"', '{part="lower", normal="+z"}, {part="upper", normal="-z"}')
    (tmp_path / "s.toml").write_text(text)
    gap = next(one for one in check(tmp_path / "s.toml", mesh=False).findings if one.code == "gap")
    assert "a gap of 200 um between its faces about (50, 20, 10) mm" in gap.text
    lapped(tmp_path / "gap.step", gap=-0.2, names=("lower", "upper"))
    overlap = next(one for one in check(tmp_path / "s.toml", mesh=False).faults if one.code == "overlap")
    assert "share 100 x 40 x 0.2 mm" in overlap.text


def test_a_joint_or_a_bolt_twice_is_a_fault(tmp_path):
    """As for run, which doubled stiffness and preload once."""
    template.write(tmp_path / "s.toml")
    text = (tmp_path / "s.toml").read_text()
    joint = '[[joint]]\nname = "k"\nfaces = ["lower.joint", "upper.joint"]\n'
    bolt = '[[bolt]]\nname = "c"\nfaces = ["upper.seat", "lower.seat"]\npreload = ["2 kN", "6 kN"]\n'
    (tmp_path / "s.toml").write_text(text + joint + bolt)
    told = " ".join(one.text for one in check(tmp_path / "s.toml", mesh=False).faults)
    assert "joints 'joint' and 'k' join the same faces" in told
    assert "bolts 'bolt' and 'c' run through one place" in told


TABLES = {
    "test": """[test]
source = "s"
direction = [0, 0, 1]
points = [[{}]]
frequencies = [["1 kHz"], ["1 kHz"]]
""",
    "response": """[response]
from = "5 kHz"
to = "20 kHz"
points = 4
[[response.input]]
point = [{}]
direction = [0, 0, 1]
[[response.output]]
point = [{}]
direction = [0, 0, 1]
""",
    "mass": """[[mass]]
mass = "1 g"
point = [{}]
""",
    "backbone": """[backbone]
mode = 1
amplitude = ["1 m/s^2", "2 m/s^2"]
at = [{}]
""",
}


def with_points(folder, tables, place):
    """The template's study under JK with points of some tables at a place."""
    studies.write(folder / "s.toml")
    text = (folder / "s.toml").read_text() + "".join(TABLES[one].replace("{}", place) for one in tables)
    (folder / "s.toml").write_text(text)
    return folder / "s.toml"


def test_points_on_the_structure(tmp_path):
    study = with_points(tmp_path, TABLES, '"40 mm", "15 mm", "-15 mm"')
    assert [one.text for one in check(study, mesh=False).faults] == []
    Case.of(Study.read(study))


@pytest.mark.parametrize(
    ("table", "place"),
    [(table, '"80 m", "0 mm", "0 mm"') for table in TABLES] + [("test", '"90 mm", "22 mm", "-50 mm"')],
)
def test_points_far_from_the_structure(tmp_path, table, place):
    """In the words of `faying run`, which meshes first; check has no nodes and measures from the faces."""
    path = with_points(tmp_path, [table], place)
    told = [one.text for one in check(path, mesh=False).faults]
    with pytest.raises(faying.InputError) as fault:
        Case.of(Study.read(path))
    before, said, after = r"(?P<a>.*nearest node to )", told[0], r" mm away; (?P<b>.*)"
    shapes = [re.match(before + r"(?P<p>\(.*?\) mm is) (?P<d>\S+)" + after, t) for t in (said, str(fault.value))]
    assert shapes[0] is not None
    assert [shapes[0][k] for k in "apb"] == [shapes[1][k] for k in "apb"]
    assert float(shapes[0]["d"]) <= float(shapes[1]["d"]) <= 1.05 * float(shapes[0]["d"]) + 10


def test_a_point_deep_inside_a_part_is_on_the_structure():
    """A ball of chords: the middle is a radius from every face, and within; beside it is without."""
    angle, turn = np.meshgrid(np.linspace(0, np.pi, 13), np.linspace(0, 2 * np.pi, 25), indexing="ij")
    ball = np.stack([np.sin(angle) * np.cos(turn), np.sin(angle) * np.sin(turn), np.cos(angle)], axis=-1)
    a, b, c, d = ball[:-1, :-1], ball[1:, :-1], ball[1:, 1:], ball[:-1, 1:]
    corners = np.concatenate([np.stack(three, axis=2).reshape(-1, 3, 3) for three in ((a, b, c), (a, c, d))])
    for x in (0.0, 0.3, 0.9):
        assert _within(np.array([x, 0.1, 0.2]), corners)
    for x in (1.05, 1.2, 40.0):
        assert not _within(np.array([x, 0.1, 0.2]), corners)


def test_the_mean_pressure_beside_the_end_of_the_law(folder):
    """The forces of three bolts over the area that touches; JK ends below that at many times the preload."""
    found, _ = looked(folder)
    pressure = next(one for one in found.findings if one.code in ("pressure", "law-reach"))
    mean = 3 * 14500 / ((4000 - 3 * pi * 4.5**2) * 1e-6)
    assert f"press {mean / 1e6:.3g} MPa" in pressure.text
    found, _ = looked(folder, ('"14.5 kN"', '"1450 kN"'))
    beyond = next(one for one in found.findings if one.code == "law-reach")
    assert "below the mean" in beyond.text
    assert any(one.code == "beyond-proof" for one in found.findings)


def test_the_pressure_of_a_cone_carries_the_force():
    """Both profiles hold the force; the second by quadrature, and its edge is the cone of the guideline."""
    F, depth, length, seat, hole, outer = 15e3, 10e-3, 22e-3, 16e-3, 9e-3, 60e-3
    mean, rim = cone_pressure(F, depth=depth, length=length, seat=seat, hole=hole, outer=outer)
    R, r = seat / 2 + depth * cone_angle(length, seat, outer), hole / 2
    assert mean * pi * (R**2 - r**2) == pytest.approx(F)
    s = np.linspace(r, R, 200_001)
    assert np.trapezoid(rim * (R - s) / (R - r) * 2 * pi * s, s) == pytest.approx(F, rel=1e-8)
    with pytest.raises(faying.InputError, match="narrower than the cone"):
        cone_pressure(F, depth=0.0, length=length, seat=seat, hole=seat, outer=outer)


# greatest pressure [MPa] of the runs, as docs/plates-and-bolts.md has them and tests/examples computes them
@pytest.mark.parametrize(("name", "run"), [("sheets", 135), ("plates", 73), ("flanges", 64)])
def test_the_pressure_at_a_hole_is_near_that_of_a_run(name, run):
    """An estimate before the mesh, by a cone and a straight line: within a quarter, as stated."""
    found = check(Path(__file__).parents[2] / "examples" / "plates-and-bolts" / f"{name}.toml", mesh=False)
    assert not found.faults
    said = next(one.text for one in found.findings if one.code == "pressure")
    estimate = float(said.split(" at its hole")[0].split()[-2])
    assert 0.95 * run < estimate < 1.25 * run


@pytest.mark.parametrize(
    ("size", "diameter"),
    [pytest.param(5e-3, 9.0, marks=pytest.mark.slow), (8e-3, 9.0), pytest.param(6e-3, 5.5, marks=pytest.mark.slow)],
)
def test_unknowns_are_right_within_a_factor_of_two(tmp_path, size, diameter):
    path = lapped(tmp_path / "lap.step", diameter=diameter)
    found = mesh_step(path, size=size).unknowns
    assert 0.5 < unknowns_of(read_facts(path), size) / found < 2


# unknowns, loads, CPU seconds and greatest memory [GB] of `faying run` on one thread, the scan solved before
SOLID_BOLT = 33_786
COMMANDS = (
    (31_971, 2, 25, 0.74),  # examples/plates-and-bolts/plates.toml
    (61_710, 2, 48, 1.61),  # flanges.toml
    (SOLID_BOLT, 2, 62, 0.89),  # examples/solid-bolt
    (47_697, 1, 32, 1.03),  # stepped lap of tests/helpers/assemblies.py, as `new` meshes it
    (42_603, 1, 38, 1.11),  # T-slots
    (85_998, 1, 90, 2.62),  # counterbored
    (369_342, 1, 360, 8.66),  # a column on T-slots, 8 x M12
)


# unknowns, CPU seconds and greatest memory [GB] of benchmarks/assemblies.py: one load, flat faces, no levels of damping
ASSEMBLIES = {
    "flanges": (50_262, 26.4, 1.29),
    "raised_flanges": (58_047, 32.6, 1.42),
    "bracket": (58_428, 37.7, 1.83),
    "t_slots": (24_045, 15.0, 0.58),
    "counterbored": (77_181, 50.3, 2.43),
    "countersunk": (57_249, 35.0, 1.92),
    "studded": (39_276, 23.4, 1.29),
    "spacers": (23_784, 15.5, 0.62),
    "stepped_lap": (27_039, 13.5, 0.69),
    "segments": (114_027, 54.1, 2.86),
    "cover": (145_491, 54.0, 2.83),
    "channel": (31_416, 12.1, 0.69),
    "pipe-flanges-flat": (83_634, 32.8, 1.87),
    "column-on-t-slots": (112_086, 41.9, 2.04),
}


@pytest.mark.parametrize(("unknowns", "loads", "seconds", "memory"), COMMANDS)
def test_time_and_memory_are_those_of_commands(folder, unknowns, loads, seconds, memory):
    """Each within 1.5."""
    study = Study.read(folder / "study.toml")
    study = pulled(study, *[1e3] * loads)
    if unknowns == SOLID_BOLT:
        study = replace(study, bolts=(SolidBolt(name="M8", part="bolt", faces=("a", "b")),))
    expected = Expected.of(study, unknowns)
    assert 1 / 1.5 < expected.memory / (memory * 1e9) < 1.5
    assert 1 / 1.5 < expected.seconds / seconds < 1.5


@pytest.mark.parametrize("name", ASSEMBLIES)
def test_time_and_memory_are_those_of_assemblies(folder, name):
    unknowns, seconds, memory = ASSEMBLIES[name]
    study = Study.read(folder / "study.toml")
    flat = tuple(replace(joint, form=Form()) for joint in study.joints)
    expected = Expected.of(replace(study, joints=flat, modes=replace(study.modes, levels=())), unknowns)
    assert 1 / 1.5 < expected.memory / (memory * 1e9) < 1.5
    assert 1 / 1.5 < expected.seconds / seconds < 1.5


def test_more_laws_loads_and_damping_take_longer(folder):
    study = Study.read(folder / "study.toml")
    base = Expected.of(study, 100_000).seconds
    assert Expected.of(replace(study, modes=replace(study.modes, levels=())), 100_000).seconds < base
    twice = pulled(study, 1e3, 1e3)
    assert Expected.of(twice, 100_000).seconds > base
    assert Expected.of(study, 200_000).seconds > 2 * base


def test_a_ready_mesh_is_checked_for_its_elements(tmp_path):
    """Blocks of tetrahedra with four nodes, as another program writes them: said before anything is solved."""
    mesh = row((0.06, 0.04), (6, 4), kinds=("tet4", "tet4"), width=0.02, height=0.02, sections=((3, 3), (3, 3)))
    (tmp_path / "model.inp").write_text(abaqus(mesh))
    (tmp_path / "s.toml").write_text(STUDY.replace("[modes]", '[law]\nmodel = "jk"\n[modes]'))
    found = check(tmp_path / "s.toml", mesh=False)
    assert not found.faults
    assert any(one.code == "stiff-elements" for one in found.findings)
    assert found.expected.unknowns == mesh.unknowns


def test_the_mesh_counts_the_unknowns_and_is_kept_for_the_run(folder, monkeypatch):
    study = Study.read(folder / "study.toml")
    found = check(folder / "study.toml", mesh=True)
    assert not found.faults
    assert "about" not in next(one.text for one in found.findings if one.code == "expected")
    assert found.expected.basis.startswith("the unknowns are those of the mesh;")
    monkeypatch.setattr("faying.geometry.geometry.ask_kernel", None)  # nothing is meshed again
    assert mesh_of(study.geometry).unknowns == found.expected.unknowns


def test_what_the_mesher_refuses_is_a_fault(folder, monkeypatch):
    def refuse(spec):
        raise faying.InputError("no mesh")

    monkeypatch.setattr("faying.setup.check.mesh_of", refuse)
    (fault,) = check(folder / "study.toml", mesh=True).faults
    assert (fault.code, fault.key, fault.text) == ("mesh", "geometry.size", "no mesh")
    assert (folder / "study.toml").read_text().splitlines()[fault.line - 1].startswith("size = ")
    monkeypatch.setattr("faying.setup.check.MAX_MESHED", 1000)
    assert not check(folder / "study.toml", mesh=True).faults


def test_the_command_exits_1_on_faults_and_0_on_notes(folder, capsys):
    looked(folder, ('size = "5 mm"', "size = 5"))
    for name, code in (("changed.toml", 1), ("study.toml", 0), ("none.toml", 1)):
        with pytest.raises(SystemExit) as stop:
            main(["check", str(folder / name)])
        assert stop.value.code == code
        out = capsys.readouterr()
        assert max(map(len, out.out.splitlines()), default=0) <= 80 or str(folder) in out.out
    assert "no file" in out.err


def test_json_gives_lines_and_what_is_expected(folder):
    out = json.loads(CliRunner().invoke(cli, ["check", str(folder / "study.toml"), "--json"]).output)
    assert out["faults"] == 0
    assert out["expected"]["memory"]["unit"] == "B"
    bolt = next(one for one in out["findings"] if one["code"] == "bolt")
    assert bolt["key"] == "bolt[1].faces"
    assert "faces" in (folder / "study.toml").read_text().splitlines()[bolt["line"] - 1]


def test_a_meshed_bolt_whose_nut_is_in_no_joint_is_refused_as_by_the_run(tmp_path):
    example = Path(__file__).parents[2] / "examples" / "solid-bolt"
    (tmp_path / "blocks-and-bolt.step").write_bytes((example / "blocks-and-bolt.step").read_bytes())
    text = (example / "study.toml").read_text()
    begin, end = text.index('[[joint]]\nname = "nut"'), text.index("[[bolt]]")
    (tmp_path / "study.toml").write_text(text[:begin] + text[end:])
    faults = [one.text for one in check(tmp_path / "study.toml", mesh=False).faults]
    (fault,) = [text for text in faults if "in no joint" in text]
    assert fault.startswith("bolt 'M8': its face 'bolt.nut' is in no joint; add a [[joint]]")
    with pytest.raises(faying.InputError, match=re.escape(fault)):
        build(Study.read(tmp_path / "study.toml"))


@pytest.mark.parametrize(
    ("where", "value", "words"),
    [
        (("crown_across",), "3.05 mm", "crown_across = 3.05 mm on a face that is 30 mm long"),
        (("twist",), "-3.05 mm", "twist = 3.05 mm on a face that is 30 mm long"),
        (("wave",), "8.1 mm", "wave = 8.1 mm on a face that is 80 mm long"),
        (("flatness",), "8.1 mm", "flatness = 8.1 mm on a face that is 80 mm long"),
        (("waviness", "Wq"), "3.05 mm", "waviness = 3.05 mm on a face that is 30 mm long"),
        (("along",), [0, 0, 1], "is at right angles to the faces"),
    ],
)
def test_check_and_run_refuse_the_same_form_in_the_same_words(tmp_path, where, value, words):
    """A tenth of a side of 80 x 30 mm: check knows the sides as the run does, with a mesh and without."""
    file = tmp_path / "study.toml"
    studies.write(file)
    text = edited(edited(file.read_text(), ("joint", 0, "form", "flat"), None), ("joint", 0, "form", *where), value)
    if where == ("wave",):
        text = edited(text, ("joint", 0, "form", "wave_length"), "40 mm")
    if where == ("along",):
        text = edited(text, ("joint", 0, "form", "twist"), "1 um")
    file.write_text(text)
    for mesh in (True, False):
        (fault,) = check(file, mesh=mesh).faults
        assert words in fault.text
    with pytest.raises(faying.InputError, match=re.escape(words)):
        build(Study.read(file))


@pytest.mark.slow
def test_check_lays_bolts_on_the_mesh_as_a_run_does(tmp_path):
    """A thread that engages 5 um of its hole meets no point of the mesh."""
    file = proposed(bracket(tmp_path / "bracket.step"), "14 mm")
    file.write_text(edited(file.read_text(), ("bolt", 1, "engaged"), "5 um"))
    (fault,) = check(file).faults
    assert (fault.key, fault.text[:40]) == ("bolt[2].faces", "the length of thread meets nothing of it")
    with pytest.raises(faying.InputError, match="the length of thread meets nothing of its hole"):
        _ = build(Study.read(file)).fitted_bolts


def test_more_memory_than_there_is_comes_with_the_size_that_fits(folder, monkeypatch):
    fine = 'size = "5 mm"', 'size = "2 mm"'
    need = looked(folder, fine)[0].expected.memory
    monkeypatch.setattr("faying.setup.check.available", lambda: need / 2)
    found, lines = looked(folder, fine)
    (fault,) = found.faults
    assert fault.code == "expected"
    assert lines[fault.line - 1].startswith("size = ")
    size = re.search(r'geometry.size = "(.+?)" fits', fault.text)[1]
    again, _ = looked(folder, ('size = "5 mm"', f'size = "{size}"'))
    assert not again.faults
    assert again.expected.memory < need / 2


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        (
            {"bolt.preload": "1 kN", "tightening.order": ["bolt 1"]},
            "tightening: bolts bolt 1 have no shank, so tightening others cannot change them",
        ),
        (
            {"joint.springs": "per-node", "bolt.preload": ["1 kN", "3 kN", "1 kN"]},
            "has springs per node, which remember no pressure",
        ),
    ],
)
def test_what_a_run_would_refuse_is_a_fault_of_the_study(changes, said):
    study = faying.Study.read(ROOT / "examples" / "two-blocks" / "study.toml")
    *first, (key, value) = changes.items()
    for path, before in first:
        study = study.with_(path, before)
    with pytest.raises(faying.InputError, match=said):
        study.with_(key, value)


def test_more_modes_than_unknowns_are_a_fault(tmp_path):
    study = ROOT / "examples" / "two-blocks" / "study.toml"
    text = study.read_text().replace('"model.inp"', f'"{(study.parent / "model.inp").as_posix()}"')
    assert "[modes]" in text
    (tmp_path / "study.toml").write_text(
        text.replace("[modes]\ncount = ", '[modes]\nsolver = "pardiso"\ncount = 100 # ')
    )
    assert not [one for one in check(tmp_path / "study.toml").findings if one.level == "fault"]
    (tmp_path / "study.toml").write_text(text.replace("[modes]\ncount = ", "[modes]\ncount = 9999 # "))
    (fault,) = [one for one in check(tmp_path / "study.toml").findings if one.level == "fault"]
    assert "ask for fewer modes" in fault.text
