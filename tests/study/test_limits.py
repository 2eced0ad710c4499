"""Numbers that no bolted structure has, and studies that would run into nothing: refused, with what was given."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import faying
from faying.form.face_axes import FaceAxes
from faying.form.form import Form
from faying.setup import check

BLOCKS = Path(__file__).parents[2] / "examples" / "two-blocks"
TEXT = (BLOCKS / "study.toml").read_text()


def faults(tmp_path, text):
    shutil.copy(BLOCKS / "model.inp", tmp_path / "model.inp")
    file = tmp_path / "study.toml"
    file.write_text(text)
    return " | ".join(one.text for one in check.check(file).faults)


def changed(old, new):
    assert old in TEXT
    return TEXT.replace(old, new)


FACES = 'faces = ["FACE_A", "FACE_B"]\n'
MATERIAL = '\n[material.odd]\nE = "{}"\nnu = 0.3\ndensity = "{}"\nfriction = {}\n'
TEST = '\n[test]\nfrequencies = [["{}"], ["100 Hz"]]\npoints = [["0 mm", "0 mm", "0 mm"]]\n'
RESPONSE = '\n[response]\nfrom = "10 Hz"\nto = "{}"\nstructural_loss = {}\n'
WRENCH = 'torque = "9 N m"\ndiameter = "8 mm"\npitch = "1.25 mm"\nthread_friction = 1.0\nhead_friction = 0.12'
END = 'point = ["0 mm", "0 mm", "0 mm"]\ndirection = {}\n'


@pytest.mark.parametrize(
    ("text", "words"),
    [
        (changed(FACES, FACES + "friction = 9e18\n"), "friction = 9e+18 should be a plain number from 0 to 2"),
        (changed(FACES, FACES + "friction = -0.1\n"), "friction = -0.1 should be a plain number from 0"),
        (TEXT + MATERIAL.format("200 GPa", "7800 kg/m^3", "1e3"), "friction = 1000 should be"),
        (TEXT + MATERIAL.format("1 mPa", "7800 kg/m^3", "0.2"), '"1 mPa" is beyond what a bolted structure has, 1 kPa'),
        (TEXT + MATERIAL.format("200 EPa", "7800 kg/m^3", "0.2"), '"200 EPa" is beyond what a bolted structure has'),
        (TEXT + MATERIAL.format("200 GPa", "7800 Gg/m^3", "0.2"), '"7800 Gg/m^3" is beyond'),
        (changed('"1 kN"', '"1e-300 kN"'), '"1e-300 kN" is beyond what a bolted structure has, 1 uN to 10 GN'),
        (changed('"1 kN"', '"1e9 kN"'), '"1e9 kN" is beyond'),
        (TEXT + TEST.format("100 Hz").replace("[[\"0 mm", "[[\"-20 km"), '"-20 km" is beyond'),
        (TEXT + TEST.format("1e308 Hz"), 'frequencies = "1e308 Hz" is beyond'),
        (TEXT + TEST.format('9 kHz", "3 Hz').replace('"100', '"9 Hz", "100'), "3 Hz stands after 9000 Hz"),
        (TEXT + TEST.format("1 kHz") + "threshold = 1e30\n", "threshold = 1e+30 should be a plain number from 0 to 1"),
        (TEXT + '[[mass]]\nface = "END_A"\nmass = "1e9 kg"\n', '"1e9 kg" is beyond'),
        (TEXT + '[[load]]\nname = "cold"\ntemperature = {block_a = "-500 K"}\n', "changes by -500 K"),
        (changed("count = 5", 'count = 5\nlevels = ["1e9 m/s^2"]'), '"1e9 m/s^2" is beyond'),
        (changed('preload = ["1 kN", "3 kN"]', WRENCH), "friction = 1 should be a plain number from 0.02 to 0.8"),
        (TEXT + RESPONSE.format("1 kHz", "1e12"), "structural_loss = 1e+12 should be a plain number from 0 to 2"),
        (
            TEXT + RESPONSE.format("1 kHz", "0.01") + "[[response.input]]\n" + END.format("[1e-300, 0, 0]"),
            "is only a direction; write numbers about 1",
        ),
        (changed('G = "1.53e-10 m"', 'G = "1.53e-10 m"\n[uncertain]\nE = {}\n'), "E = {} is not a distribution"),
        (TEXT + "[uncertain]\npreload = {}\n", "uncertain.preload = {} should be {tightening"),
        (TEXT + "[uncertain.material]\n", "uncertain.material cannot scatter"),
        (
            changed('[part.block_b]\nmaterial = "45 steel"', "[part.block_b]") + '[uncertain]\nE = "2 GPa +- 1 GPa"\n',
            "part.block_b.material is missing",
        ),
        (
            TEXT + '[[support]]\nface = "END_A"\n[[support]]\nface = "END_B"\n',
            "a [[support]] holds each of them: its preload goes into the supports",
        ),
    ],
)  # fmt: skip
def test_numbers_and_studies_that_cannot_be(tmp_path, text, words):
    assert words in faults(tmp_path, text)


@pytest.mark.parametrize(
    "more",
    [
        '[[support]]\nface = "END_A"\n',
        '[[support]]\nface = "END_A"\n[[support]]\nface = "END_B"\nstiffness = "10 MPa/mm"\n',
        '[[support]]\nface = "END_A"\n[[support]]\nface = "END_B"\ndirections = ["y"]\n',
    ],
)
def test_supports_that_leave_the_bolt_its_pull(tmp_path, more):
    assert not faults(tmp_path, TEXT + more)


@pytest.mark.parametrize(("value", "words"), [("1 m", "crown_along = 1000 mm on a face that is"), ("5 um", "")])
def test_check_says_that_a_crown_is_too_high(tmp_path, value, words):
    found = faults(tmp_path, changed(FACES, FACES + f'[joint.form]\ncrown_along = "{value}"\n'))
    assert found.startswith(f"joint 'joint': {words}" if words else "")
    assert bool(found) == bool(words)


def test_check_names_a_part_without_a_joint(tmp_path):
    places = [(x, y, z) for z in (0, 10) for x, y in ((0, 0), (20, 0), (20, 20), (0, 20))]
    deck = "*NODE\n" + "".join(
        f"{8 * k + i}, {x}, {y}, {z + 10 * k}\n" for k in range(3) for i, (x, y, z) in enumerate(places, 1)
    )
    for k, name in enumerate(("low", "up", "cap")):
        deck += f"*ELEMENT, TYPE=C3D8, ELSET={name}\n{k + 1}, " + ", ".join(str(8 * k + i) for i in range(1, 9)) + "\n"
        deck += f"*SURFACE, NAME={name}_bottom\n{k + 1}, S1\n*SURFACE, NAME={name}_top\n{k + 1}, S2\n"
    (tmp_path / "d.inp").write_text(deck)
    parts = "".join(f'[part.{name}]\nmaterial = "45 steel"\n' for name in ("low", "up", "cap"))
    head = TEXT[: TEXT.index("[part")].replace("model.inp", "d.inp")
    surface = TEXT[TEXT.index("[surface]") : TEXT.index("[[joint]]")]
    joint = '[[joint]]\nfaces = ["low_top", "up_bottom"]\n'
    bolt = '[[bolt]]\nfaces = ["low_bottom", "up_top"]\npreload = "3 kN"\n[modes]\ncount = 4\n'
    file = tmp_path / "study.toml"
    file.write_text(head + parts + surface + joint + bolt)
    found = [one.text for one in check.check(file).faults]
    (fault,) = found
    assert fault.startswith("part cap has no joint; add a [[joint]] of one of its faces")
    file.write_text(head + parts + surface + joint + '[[joint]]\nfaces = ["up_top", "cap_bottom"]\n' + bolt)
    assert not check.check(file).faults


@pytest.mark.parametrize("name", ["crown_along", "crown_across", "twist", "flatness"])
@pytest.mark.parametrize("value", [1.0, 2.1e-3, -2.1e-3])
def test_a_form_as_high_as_its_face_is_long(name, value):
    x, y, z = np.eye(3)
    side = {"lengths": (0.02, 0.02), "certain": True, "flat": True, "spacing": 1e-3}
    axes = FaceAxes(origin=np.zeros(3), x_axis=x, y_axis=y, normal=z, **side)
    if name == "flatness" and value < 0:
        return
    with pytest.raises(faying.InputError, match=f"{name} = .* mm on a face that is 20 mm long there"):
        Form(**{name: value}).at(np.zeros((1, 3)), axes)
    Form(**{name: abs(value) / 1e3}).at(np.zeros((1, 3)), axes)
