"""[[load]] in a study: its keys, the command, the record, and what is refused."""

import json

import numpy as np
import pytest

import faying
from faying.case.case import build
from faying.cli.main import main
from faying.fe.sides import face_centre
from faying.loads.table import terminal
from faying.study import Study
from tests.helpers.studies import write

LOADS = """
[[support]]
face = { part = "lower", normal = "-z", all = true }

[[load]]
name = "10 g"
acceleration = ["0 m/s^2", "0 m/s^2", "98.1 m/s^2"]

[[load]]
name = "pull"
[[load.force]]
face = "upper.seat"
force = ["0 N", "0 N", "1.5 kN"]

[[load]]
name = "push"
after = "pull"
combine = { "10 g" = 1.5 }
temperature = { bolt = "20 K", upper = "5 K" }
increments = 3
[[load.force]]
face = { part = "upper", normal = "+x" }
force = ["300 N", "0 N", "0 N"]
moment = ["0 N*m", "3 N*m", "0 N*m"]
point = ["40 mm", "0 mm", "12 mm"]
[[load.pressure]]
face = "upper.seat"
pressure = "0.1 MPa"
"""


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    """Two blocks under a bolt with a shank, coarsely meshed, with three load cases."""
    file = tmp_path_factory.mktemp("loads") / "study.toml"
    write(file)
    text = file.read_text().replace('"upper.joint" = "8 mm"\n', "", 1)
    text = text.replace("[geometry.face_size]", "# no finer faces", 1).replace("count = 6", "count = 3")
    text = text.replace('springs = "per-area"', "friction = 0.25")
    for key in ("diameter", "material", "grade"):
        text = text.replace(f"# {key} = ", f"{key} = ", 1) if key != "material" else text
    text = text.replace('# material = "45 steel"\n# grade', 'material = "45 steel"\ngrade').replace(
        '# material = "45 steel"', 'material = "45 steel"'
    )
    file.write_text(text + LOADS)
    return file


@pytest.fixture(scope="module")
def found(study):
    return faying.load_cases(study)


def test_the_keys_say_what_acts(study):
    plan = Study.read(study)
    assert [load.name for load in plan.load_cases] == ["10 g", "pull", "push"]
    push = plan.load_cases[2]
    assert push.after == "pull"
    assert push.combine == {"10 g": 1.5}
    assert push.temperature == {"bolt": 20.0, "upper": 5.0}
    assert push.increments == 3
    [force] = push.forces
    assert (force.force, force.moment, force.point) == ((300, 0, 0), (0, 3, 0), (0.04, 0, 0.012))
    assert push.pressures[0].pressure == 1e5
    assert plan.load_cases[0].acceleration == (0, 0, 98.1)


def test_the_joint_carries_what_acts_on_the_upper_block(found, study):
    """Equilibrium across the joint: its shear and its loss of normal force, with the bolt's, are the outer force."""
    mesh = build(Study.read(study)).mesh
    area = face_centre(mesh.points, mesh.face("upper.seat"))[2]
    change = found.bolt_force[:, 0] - found.bolt_preload[0]
    apart = change - (found.normal_force[:, 0] - found.normal_preload[0])
    assert apart == pytest.approx(found.working_load[:, 0], rel=1e-9)
    assert apart[1] == pytest.approx(1500.0, rel=1e-6)
    weight = -apart[0]  # the inertia under 10 g upwards presses the block on the lower one
    assert 0.9 < weight / (7800 * 0.08 * 0.03 * 0.015 * 98.1) < 1.2  # with half of the bolt
    assert apart[2] == pytest.approx(-1.5 * weight - 1e5 * area, rel=1e-5)
    # across: 300 N, less what the shank takes
    assert abs(found.shear_force[2, 0] - 300) < 1.01 * found.bolt_shear[2, 0] + 1e-3
    assert found.slip_margin[2, 0] == pytest.approx(0.25 * found.normal_force[2, 0] / found.shear_force[2, 0])


def test_modes_follow_the_pressure(found):
    """A load that parts the joint lowers the frequencies, one that presses it raises them."""
    assert found.frequency_change is not None
    press, pull, _ = found.frequency_change[:, :2]
    assert np.all(pull < 0)
    assert np.all(press > 0)
    assert np.all(found.likeness[:2, :2] > 0.9)


def test_the_record_comes_back_from_its_file(found, tmp_path):
    path = found.save(tmp_path / "loads.nc")
    assert faying.load(path) == found
    assert faying.LoadCases.load(path) == found
    table = found.to_dataframe("joints")
    assert table.loc[("pull", "joint"), "normal_force"] == found.normal_force[1, 0]
    tree = found.to_xarray()
    assert tree["bolts"]["bolt_force"].sel(case="push", bolt="bolt") == found.bolt_force[2, 0]


def test_the_table_fits_a_terminal(found):
    lines = terminal(found).splitlines()
    tables = [line for line in lines if "  " in line.strip()]
    assert tables
    assert max(map(len, lines)) <= 80
    assert any(line.startswith("load 'push' after 'pull'") for line in lines)
    assert len(repr(found).splitlines()) <= 12


def test_the_command(study, tmp_path, capsys):
    out = tmp_path / "cases.nc"
    with pytest.raises(SystemExit) as end:
        main(["loads", str(study), "--preload", "2 kN", "--no-modes", "--json", "--out", str(out)])
    assert end.value.code == 0
    said = json.loads(capsys.readouterr().out)
    assert said["cases"] == ["10 g", "pull", "push"]
    assert said["after"] == [None, None, "pull"]
    assert said["preload"] == {"unit": "N", "values": 2000.0}
    assert said["files"] == [str(out)]
    kept = faying.LoadCases.load(out)
    assert said["bolt_force"]["values"] == kept.bolt_force.tolist()
    assert kept.frequency is None


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (('after = "pull"', 'after = "push"'), "name each other in a circle"),
        (('after = "pull"', 'after = "pul"'), "names the load 'pul', which is not there; give one of '10 g', 'pull'"),
        (('name = "push"', 'name = "pull"'), "two loads are called 'pull'"),
        (('temperature = { bolt = "20 K"', 'temperature = { bolt = "20"'), 'temperature.bolt = "20" has no unit'),
        (
            ('temperature = { bolt = "20 K"', 'temperature = { bolt = "20 degC"'),
            "has a zero of its own; give a difference",
        ),
        (
            ('temperature = { bolt = "20 K"', 'temperature = { bolt = "20 kK"'),
            "changes by 20000 K; give a change since",
        ),
        (
            ('combine = { "10 g" = 1.5 }', 'combine = { "10 g" = 1500 }'),
            "'10 g' 1500 times; give a factor from -1000 to",
        ),
        (('force = ["300 N", "0 N", "0 N"]', 'force = ["300 N", "0 N"]'), "should be three components, for example"),
        (("increments = 3", "increment = 3"), "increment is not a key that a study has; did you mean increments"),
        (('face = "upper.seat"\nforce', "force"), "a force needs a face, or a point"),
        (
            ('acceleration = ["0 m/s^2", "0 m/s^2", "98.1 m/s^2"]', ""),
            "nothing acts; give forces, pressures, an acceleration",
        ),
    ],
)
def test_faults_are_named(study, tmp_path, change, said):
    text = study.read_text()
    assert change[0] in text
    other = tmp_path / "study.toml"
    (tmp_path / "two-blocks.step").write_bytes((study.parent / "two-blocks.step").read_bytes())
    other.write_text(text.replace(*change, 1))
    with pytest.raises(faying.InputError) as fault:
        Study.read(other)
    assert said in str(fault.value)


def test_names_that_the_geometry_lacks_are_named(study, tmp_path):
    text = study.read_text().replace('face = "upper.seat"\npressure', 'face = "upper.sea"\npressure')
    text = text.replace('bolt = "20 K"', 'nut = "20 K"')
    text += (
        '\n[[load]]\nname = "lift"\n[[load.displacement]]\nface = "upper.seat"\ndisplacement = ["1 um", "0 m", "0 m"]\n'
    )
    (tmp_path / "two-blocks.step").write_bytes((study.parent / "two-blocks.step").read_bytes())
    (tmp_path / "study.toml").write_text(text)
    with pytest.raises(faying.InputError) as fault:
        faying.load_cases(tmp_path / "study.toml")
    assert "load 'push' names the face 'upper.sea', which does not exist" in str(fault.value).replace('"', "'")
    assert "temperature of 'nut', which is neither a part nor a bolt" in str(fault.value)
    assert "load 'lift' moves the face 'upper.seat' along x, in which no rigid support holds it" in str(fault.value)


@pytest.mark.slow
def test_intervals_follow_preload_and_friction(study, tmp_path):
    """A force of the bolt is its preload and a change that hardly moves; use of friction goes as 1/(mu F)."""
    text = study.read_text().replace("friction = 0.25", 'friction = "0.25 +- 0.02"')
    text = text.replace('preload = ["2 kN", "6 kN"]', 'preload = "6 kN"')
    start, end = text.index('[[load]]\nname = "push"'), len(text)
    text = text[:start] + PUSH + text[end:] + "\n[[bolt_sheet]]\ntightening_factor = 1.5\nhead_friction = 0.1\n"
    (tmp_path / "two-blocks.step").write_bytes((study.parent / "two-blocks.step").read_bytes())
    file = tmp_path / "study.toml"
    file.write_text(text)
    found = faying.load_cases(file, modes=False, intervals=True)
    some, scatter = found.intervals, 0.5 / 2.5  # (alpha - 1)/(alpha + 1), two standard deviations
    half = 1.6449 * scatter / 2
    row = found.cases.index("aside")
    low, high = some.bolt_force[:, row, 0]
    assert (high - low) / 2 == pytest.approx(half * 6000, rel=0.02)
    assert (high + low) / 2 == pytest.approx(found.bolt_force[row, 0], rel=1e-12)
    # one input at its end: mu at its 5 % end, F at its own; their logarithms add in squares
    wide = np.hypot(np.log(1 - half), np.log(1 - 1.6449 * 0.02 / 0.25))
    use = found.friction_needed_worst[row, 0] / 0.25
    assert np.log(some.slip_use[:, row, 0] / use) == pytest.approx([-wide, wide], rel=0.03)
    assert np.all(some.slip_margin[0] <= found.slip_margin_worst * (1 + 1e-9))
    assert np.all(some.slip_margin[1] >= found.slip_margin_worst * (1 - 1e-9))
    assert some.check[row] < 0.03
    assert len(some.inputs) == 2
    # of next to no load: no division by nothing, no width for a use of friction that is counted as LEAST
    row = found.cases.index("whisper")
    use = found.friction_needed_worst[row, 0] / 0.25
    assert 0 < use < 1e-10
    assert some.slip_use[:, row, 0] == pytest.approx([use, use], rel=1e-12)
    assert some.bolt_force[:, row, 0] == pytest.approx([(1 - half) * 6000, (1 + half) * 6000], rel=1e-6)
    assert some.check[row] < 1e-6
    assert (found.opened[row, 0], found.sliding[row, 0]) == (0, 0)
    assert found.superposition[row] < 1e-3
    assert np.isnan(found.load_factor[row, 0])
    assert faying.LoadCases.load(found.save(tmp_path / "kept.nc")) == found
    assert "90 % intervals over preload of bolt +-20%" in " ".join(terminal(found).split())


PUSH = """
[[load]]
name = "aside"
[[load.force]]
face = { part = "upper", normal = "+x" }
force = ["200 N", "0 N", "0 N"]
point = ["40 mm", "0 mm", "0 mm"]

[[load]]
name = "whisper"
[[load.force]]
face = { part = "upper", normal = "+x" }
force = ["1e-9 N", "0 N", "0 N"]
point = ["40 mm", "0 mm", "0 mm"]
"""


def test_a_run_says_that_it_leaves_loads_out(study):
    from faying.answer.run import _closing_notes

    plan = Study.read(study)
    [note] = [one for one in _closing_notes(plan, np.zeros(0), 1.0) if one.code == "load-cases"]
    assert "'10 g', 'pull', 'push'" in note.text
    assert "faying loads" in note.text
