import tomllib

import numpy as np
import pytest

import faying
from faying.study import Study
from tests.helpers.studies import TEXT


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "b.step").write_text("ISO-10303-21;")
    return tmp_path


def study(folder, **changes):
    """The template as nested dictionaries; changes are dotted keys."""
    data = tomllib.loads(TEXT.format(name="s.toml", step="b.step"))
    for key, value in changes.items():
        *path, last = key.split("__")
        table = data
        for step in path:
            table = table[int(step)] if isinstance(table, list) else table[step]
        if value is None:
            del table[last]
        else:
            table[last] = value
    return Study.from_dict(data, folder=folder)


def test_the_template_is_a_study(folder):
    s = study(folder)
    assert s.loads == (2000.0, 6000.0)
    assert s.geometry.size == pytest.approx(16e-3)
    assert s.geometry.face_size == {"upper.joint": pytest.approx(8e-3)}
    assert s.surface.G == pytest.approx(1.53e-10)
    assert s.law.given["closure"] == "consistent"
    assert s.loads == (2000.0, 6000.0)


@pytest.mark.parametrize(
    ("changes", "text"),
    [
        ({"bolt__0__preload": 12}, r'bolt\[1\].preload = 12 has no unit; write .* "12 kN"'),
        ({"bolt__0__preload": "12"}, r'preload = "12" has no unit'),
        ({"bolt__0__preload": "12 mm"}, r'preload = "12 mm" is not in a unit like N'),
        ({"bolt__0__preload": "-4 kN"}, "must be positive"),
        ({"bolt__0__preload": ["8 kN", "8 kN"]}, "two in a row are the same; leave one out"),
        ({"bolt__0__preload": []}, "is empty"),
        ({"bolt__0__preload": "nan kN"}, "is not a quantity"),
        (
            {
                "material": {"rubber": {"E": "1 MPa", "nu": 0.5, "density": "1 g/cm^3"}},
                "part__upper__material": "rubber",
            },
            "nu = 0.5, and solid elements lock near 0.5; give at most 0.495",
        ),
        ({"surface__D": 3.2}, "surface.D = 3.2: the dimension of a surface is between 2 and 3"),
        ({"surface__D": float("nan")}, "surface.D = nan should be a plain finite number"),
        ({"surface__G": "1.53e-10"}, r'surface.G = "1.53e-10" has no unit'),
        ({"surface__D": None}, r"give scan, or D, G and scan_area \(D missing\)"),
        ({"surface__scan": "none.x3p"}, "surface.scan: no file"),
        ({"geometry__step": "none.step"}, "geometry.step: no file"),
        ({"geometry__size": "-1 mm"}, "must be positive"),
        ({"geometry__size": None}, "geometry.size is missing"),
        (
            {"part__upper__material": "cheese"},
            'part.upper.material = "cheese" is unknown; the known ones are "45 steel"',
        ),
        ({"joint__0__faces": ["a"]}, "should be a list of 2 names"),
        ({"joint__0__springs": "per-atom"}, "should be one of per-area, per-node"),
        ({"law__closure": "wrong"}, 'allowed is "consistent" or "printed"'),
        ({"law__substrate": "soft"}, "law.substrate = 'soft' should be a plain finite number"),
        ({"modes__count": 0}, "whole number from 1 to"),
        ({"bolt": None}, r"\[\[bolt\]\] is missing"),
        ({"part": None}, r"\[part\] is missing"),
        ({"part": "x"}, "should be a table"),
        ({"bolts": []}, "bolts is not a key that a study has; did you mean bolt?"),
    ],
)
def test_faults(folder, changes, text):
    with pytest.raises(faying.InputError, match=text):
        study(folder, **changes)


@pytest.mark.parametrize("share", ["exact", 0.9])
def test_what_the_substrate_takes(folder, share):
    assert study(folder, law__substrate=share).law.given["substrate"] == share


def test_faces_that_are_missing_are_one_fault(folder):
    with pytest.raises(faying.InputError) as caught:
        study(folder, bolt__0__faces=None)
    assert str(caught.value).splitlines()[1:] == ["  - bolt[1].faces is missing"]


def test_all_faults_are_reported_in_one_go(folder):
    with pytest.raises(faying.InputError) as caught:
        study(folder, geometry__sice="3 mm", law__modle="jk", joint__0__name=3, surface__D=1.0, bolt__0__preload="4")
    text = str(caught.value)
    assert "5 faults" in text
    for part in (
        "geometry.sice is not a key that a study has; did you mean size?",
        "law.modle",
        "joint[1].name = 3",
        "surface.D = 1.0",
        'bolt[1].preload = "4" has no unit',
    ):
        assert part in text


def test_a_material_of_ones_own(folder):
    mine = {"E": "110 GPa", "nu": 0.34, "density": "4430 kg/m^3", "yield_strength": "880 MPa"}
    s = study(folder, material={"titanium": mine}, part__upper__material="titanium")
    assert s.materials["titanium"].E == pytest.approx(110e9)
    assert s.materials["titanium"].hardness == pytest.approx(2.8 * 880e6)
    with pytest.raises(faying.InputError, match="nu = 0.9"):
        study(folder, material={"odd": mine | {"nu": 0.9}})
    with pytest.raises(faying.InputError, match="material.odd.E is missing"):
        study(folder, material={"odd": {"nu": 0.3, "density": "1 kg/m^3"}})


def test_bolts_need_the_same_number_of_preloads(folder):
    bolts = [{"faces": ["a", "b"], "preload": ["1 kN", "2 kN"]}, {"faces": ["c", "d"], "preload": "1 kN"}]
    with pytest.raises(faying.InputError, match="the bolts have 1 and 2 preloads"):
        study(folder, bolt=bolts)


def test_a_test_needs_a_row_for_each_preload(folder):
    test = {"frequencies": [["400 Hz"]], "direction": [1, 0, 0], "points": [["0 mm", "0 mm", "1 mm"]]}
    with pytest.raises(faying.InputError, match="1 rows for 2 preloads"):
        study(folder, test=test)
    with pytest.raises(faying.InputError, match="has no length"):
        study(folder, test=test | {"frequencies": [["400 Hz"], ["401 Hz"]], "direction": [0, 0, 0]})


@pytest.fixture
def uff(folder):
    for name in ("t.uff", "frame.csv"):
        (folder / name).write_text("")
    return {"file": "t.uff"}


def test_a_test_in_a_file(folder, uff):
    s = study(
        folder,
        test=uff | {"frame": "frame.csv", "load": "2 kN", "tolerance": "3 mm", "direction": "z", "least_mac": 0.7},
    )
    assert s.test is None
    assert (s.hammer.load, s.hammer.tolerance, s.hammer.least_mac) == (0, pytest.approx(3e-3), 0.7)
    assert s.hammer.frame == folder / "frame.csv"
    assert study(folder, test=uff).hammer.load == 1  # the last


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"file": "none.uff"}, "test.file: no file"),
        ({"frequencies": [["400 Hz"]]}, "both file and frequencies; give one"),
        ({"load": "5 kN"}, "test.load = 5 kN: the study has no such preload; it has 2 kN, 6 kN"),
        ({"load": "5 mm"}, "not in a unit like N"),
        ({"least_mac": 1.2}, "plain number from 0.01 to 1"),
        ({"greatest_shift": 0}, "plain number from 1e-06 to 10"),
        ({"direction": "up"}, "one of x, y, z"),
        ({"quantity": "inertance"}, "one of receptance, mobility, accelerance"),
        ({"tolerance": 5}, "has no unit"),
        ({"frames": "frame.csv"}, "did you mean frame?"),
    ],
)
def test_faults_of_a_test_in_a_file(folder, uff, keys, text):
    with pytest.raises(faying.InputError, match=text):
        study(folder, test=uff | keys)


def test_files(tmp_path):
    with pytest.raises(faying.ReadError, match=r"no file .*none.toml; write one with: faying init"):
        Study.read(tmp_path / "none.toml")
    (tmp_path / "bad.toml").write_text("a = = 1")
    with pytest.raises(faying.ReadError, match="is not TOML"):
        Study.read(tmp_path / "bad.toml")


FREQUENCIES = [["100 Hz", "200 Hz"], ["110 Hz", "210 Hz"]]


@pytest.mark.parametrize(
    ("key", "given", "expected"),
    [
        ("loss_factors", [[2e-3, float("nan")], ["0.3 %", 4e-3]], [2e-3, np.nan, 3e-3, 4e-3]),
        ("damping_ratios", [["0.1 %", 2e-3], [1e-3, 1e-3]], [2e-3, 4e-3, 2e-3, 2e-3]),
    ],
)
def test_damping_of_a_test_stands_beside_its_frequencies(folder, key, given, expected):
    """A loss factor is twice a damping ratio."""
    found = study(
        folder,
        test={"frequencies": FREQUENCIES, key: given, "direction": [1, 0, 0], "points": [["0 mm", "0 mm", "1 mm"]]},
    )
    assert np.ravel(found.test.losses) == pytest.approx(expected, nan_ok=True)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"loss_factors": [[1e-3, 1e-3]]}, "a number for each of the frequencies"),
        ({"loss_factors": [[1e-3, 0], [1e-3, 1e-3]]}, "give a plain number above 0"),
        ({"loss_factors": [[1e-3, "3 Hz"], [1e-3, 1e-3]]}, "loss_factors"),
        ({"loss_factors": [[1e-3] * 2] * 2, "damping_ratios": [[1e-3] * 2] * 2}, "give one of them"),
    ],
)
def test_damping_that_cannot_be_is_refused(folder, wrong, words):
    with pytest.raises(faying.InputError, match=words):
        study(
            folder,
            test={"frequencies": FREQUENCIES, "direction": [1, 0, 0], "points": [["0 mm", "0 mm", "1 mm"]], **wrong},
        )
