"""[[vibration]] in a study: what check and run say before anything is solved."""

from pathlib import Path

import numpy as np
import pytest

import faying
from faying.study.study import Study
from tests.helpers import studies

ROOT = Path(__file__).parents[2]
BASE = """
[[vibration]]
psd = [["20 Hz", "0.01 g^2/Hz"], ["80 Hz", "0.04 g^2/Hz"]]
"""
MINE = """
[material.mine]
E = "200 GPa"
nu = 0.3
density = "7800 kg/m^3"
friction = 0.2
hardness = "1 GPa"
"""


@pytest.fixture
def study(tmp_path):
    path = tmp_path / "study.toml"
    studies.write(path)
    return path


def shaken(path, text):
    path.write_text(path.read_text() + text)
    return path


def test_check_and_run_refuse_a_base_that_is_not_there_in_the_same_words(study):
    path = shaken(study, BASE)
    found = faying.check(path)
    assert any("moves the supports, and there are none" in one.text for one in found.faults)
    with pytest.raises(faying.InputError, match="moves the supports, and there are none"):
        faying.run(path)


HELD = '[[support]]\nface = "lower.under"\ndirections = {}\n'
PUSHED = BASE.replace("g^2/Hz", "N^2/Hz") + 'face = "lower.under"\n'


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (HELD.format(["z"]) + BASE + "direction = [1, 0, 1]\n", r"no support holds the structure along direction"),
        (HELD.format(["x", "y", "z"]) + PUSHED, "its force acts where supports hold"),
        (HELD.format(["z"]) + PUSHED, "its force acts where supports hold"),
        ('[[load]]\nname = "hot"\ntemperature = { lower = "5 K" }\n', "has no expansion; give the material one"),
    ],
)
def test_check_finds_what_shakes_and_heats_nothing(study, text, why):
    path = shaken(study, text)
    path.write_text(path.read_text().replace('material = "45 steel"', 'material = "mine"') + MINE)
    found = faying.check(path)
    assert any(why in one.text for one in found.faults)
    with pytest.raises(faying.InputError, match=why):
        faying.load_cases(path, modes=False) if "[[load]]" in text else faying.run(path)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (BASE + BASE, "two vibrations are called 'vibration'"),
        (BASE.replace("psd", "psdd"), "did you mean psd"),
        (BASE + 'sine = [["20 Hz", "1 g"], ["30 Hz", "1 g"]]\n', "either psd or sine"),
        (BASE.replace('"80 Hz"', '"8 Hz"'), "let frequencies rise"),
        (BASE.replace('"0.04 g^2/Hz"', "0.04"), "with its unit as text"),
        ("[[vibration]]\npsd = 3\n", "with its unit as text"),
        (BASE + 'points = ["0 mm"]\n', "list of points"),
        ('[[vibration]]\npsd = "psd.csv"\n', "no file"),
    ],
)
def test_faults_of_a_table_are_found_when_it_is_read(study, text, why):
    with pytest.raises(faying.InputError, match=why):
        Study.read(shaken(study, text))


def test_a_file_of_a_study_belongs_to_it(study):
    (study.parent / "psd.csv").write_text("frequency [Hz], psd [g^2/Hz]\n20, 0.01\n80, 0.04\n")
    plan = Study.read(shaken(study, '[[vibration]]\npsd = "psd.csv"\n'))
    assert (study.parent / "psd.csv") in plan.files
    assert plan.vibrations[0].table.values[1] == pytest.approx(0.04 * 9.80665**2)


@pytest.mark.slow
def test_a_bracket_that_rocks_is_followed_to_where_its_foot_opens(tmp_path):
    """2 kg under 6 g rms: half of the foot opens and the mode stiffens. The table of levels and the vibration ask the
    same cycles as the curve by harmonic balance, whose basis is made for its own amplitudes."""
    text = (ROOT / "examples/bracket/shaker.toml").read_text()
    text = text[: text.index('[[vibration]]\nname = "sweep"')].replace("0.2 kg", "2 kg").replace("0.0003", "0.04")
    text = text.replace('["10 kN", "15 kN"]', '"10 kN"').replace('"../', f'"{ROOT}/examples/')
    text = text.replace('"bracket.step"', f'"{ROOT}/examples/bracket/bracket.step"')
    path = tmp_path / "study.toml"
    path.write_text(text.replace("[modes]\n", '[modes]\nlevels = ["100 m/s^2", "200 m/s^2", "344 m/s^2"]\n'))
    result = faying.run(path)
    curve = faying.backbone(path, amplitude=(1.0, 500.0), rest_damping=0.0)
    frequency, slip = curve.at_acceleration(result.levels.accelerations)
    assert result.levels.frequencies[0, :, 0] == pytest.approx(frequency, rel=1e-2)
    assert np.all(np.abs(result.levels.slip[0, :, 0] / slip - 1) < np.maximum(result.levels.error[0, :, 0], 0.1))
    (shaken,) = result.vibrations
    level = shaken.level[1, 0]
    assert 300 < level < 450
    # the mean over amplitudes that go beyond the rms
    assert shaken.frequency[1, 0] == pytest.approx(frequency.mean(), rel=0.02)
    assert slip[-1] < shaken.damping[1, 0] - shaken.rest_damping[1, 0] < 2 * slip[-1]
