"""What a study may say of bolts, supports, masses, gaps, friction, tightening, response and damping."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

import faying
from faying.bolt.bolt import torque_to_preload
from faying.study import Study
from faying.sweeps.variant_builder import StudyVariant
from tests.helpers.studies import TEXT


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "b.step").write_text("ISO-10303-21;")
    (tmp_path / "gap.csv").write_text("0,0,1\n1,0,1\n0,1,1\n1,1,1\n")
    (tmp_path / "heights.csv").write_text("0,0\n10,1\n20,0\n")
    return tmp_path


def study(folder, text="", **changes):
    """The template with more tables at its end; changes are top-level keys, None leaves one out."""
    data = tomllib.loads(TEXT.format(name="s.toml", step="b.step") + text)
    for key, value in changes.items():
        if value is None:
            del data[key]
        else:
            data[key] = value
    return Study.from_dict(data, folder=folder)


MILLED = Path(__file__).parents[2] / "examples" / "t-specimen" / "milled.x3p"
BOLT = {"name": "b1", "faces": ["upper.seat", "lower.seat"]}
SHANK = {"diameter": "8 mm", "material": "45 steel"}
WASHER = {"outer": "16 mm", "inner": "8.4 mm", "thickness": "1.6 mm", "material": "45 steel"}


def test_a_bolt_with_everything(folder):
    given = (
        BOLT
        | SHANK
        | {
            "torque": ["10 N m", "20 N m"],
            "nut_factor": 0.2,
            "at": ["0 mm", "1 mm", "2 mm"],
            "seat": ["8.4 mm", "16 mm"],
            "washer": [WASHER, WASHER],
            "head_mass": "5 g",
            "nut_mass": "4 g",
        }
    )
    made = study(folder, bolt=[given])
    bolt = made.bolts[0]
    assert made.loads == pytest.approx((10 / (0.2 * 8e-3), 20 / (0.2 * 8e-3)))
    assert bolt.at == pytest.approx((0.0, 1e-3, 2e-3))
    assert bolt.seat == pytest.approx((8.4e-3, 16e-3))
    assert len(bolt.washers) == 2
    assert bolt.washers[0].thickness == pytest.approx(1.6e-3)
    assert (bolt.head_mass, bolt.nut_mass) == pytest.approx((5e-3, 4e-3))


def test_a_solid_bolt(folder):
    given = {"name": "b1", "part": "bolt", "faces": ["bolt.head", "bolt.nut"]}
    bolt = study(folder, bolt=[given | {"preload": "2 kN"}]).bolts[0]
    assert (bolt.part, bolt.faces) == ("bolt", ("bolt.head", "bolt.nut"))
    by_torque = {"torque": "20 N m", "diameter": "8 mm", "nut_factor": 0.2}
    assert study(folder, bolt=[given | by_torque]).loads == pytest.approx((12.5e3,))
    with pytest.raises(faying.InputError, match=r"the part 'bolt', whose mesh has shank.*; leave out material, seat$"):
        study(folder, bolt=[given | {"torque": "20 N m", "nut_factor": 0.2} | SHANK | {"seat": ["9 mm", "16 mm"]}])
    with pytest.raises(faying.InputError, match=r"1 fault\n.*leave out material$"):
        study(folder, bolt=[given | {"preload": "2 kN", "material": "45 steel"}])
    with pytest.raises(faying.InputError, match=r"bolt\[1\].diameter is for torque only, since the part 'bolt'"):
        study(folder, bolt=[given | {"preload": "2 kN", "diameter": "8 mm"}])


SUMMITS = {"model": "gw", "density": "3e9 1/m^2", "radius": "60 um", "sigma": "0.3 um"}
LAW_TABLE = "pressure [MPa],k_n [MPa/um],k_t [MPa/um]\n0.01,1,0.5\n50,900,400\n"


def law_named(folder, **law):
    from faying.materials import CATALOGUE
    from faying.study.keys.surface import NO_SURFACE

    made = study(folder, surface=None, law=law)
    steel = CATALOGUE["45 steel"]
    return made.law.make(NO_SURFACE, steel, steel).law


def test_laws_given_in_full_need_no_surface(folder):
    """Each against the law made by hand."""
    from faying.contact.models.greenwood_williamson import GreenwoodWilliamson
    from faying.contact.models.power_law import PowerLaw
    from faying.contact.models.tabulated import TabulatedLaw
    from faying.materials import CATALOGUE, ContactPair

    steel = CATALOGUE["45 steel"]
    pair = ContactPair(steel, steel)
    (folder / "law.csv").write_text(LAW_TABLE)
    summits = {"density": "3e9 1/m^2", "radius": "60 um", "sigma": "0.3 um"}
    for made, by_hand in (
        (
            law_named(folder, model="gw", **summits),
            GreenwoodWilliamson(density=3e9, radius=60e-6, sigma=3e-7, pair=pair),
        ),
        (
            law_named(folder, model="gw-ke", **summits),
            GreenwoodWilliamson(density=3e9, radius=60e-6, sigma=3e-7, asperity="KogutEtsion", pair=pair),
        ),
        (
            law_named(folder, model="power law", C=2e-10, m=0.5, greatest="20 MPa"),
            PowerLaw(C=2e-10, m=0.5, greatest=2e7),
        ),
        (law_named(folder, model="table", file="law.csv"), TabulatedLaw.from_csv(folder / "law.csv")),
    ):
        assert type(made) is type(by_hand)
        for p in (1e5, 3e6):
            assert made.at_pressure(p).k_n == pytest.approx(by_hand.at_pressure(p).k_n, rel=1e-9)


@pytest.mark.parametrize(
    ("law", "fault"),
    [
        (
            SUMMITS | {"sigma": None},
            r"law: GW needs sigma \(standard deviation of the summit heights, m\); give it, or a surface with a scan",
        ),
        (
            {"model": "gw"},
            r"law: GW needs density \(summits per area, 1/m\^2\) and radius \(.*, m\) and sigma \(.*, m\); give "
            r"them, or a surface with a scan",
        ),
        ({"model": "power law", "C": 2e-10}, r"law: Power law needs m \(power of pressure\); give it$"),
        (SUMMITS | {"sigma": 0.3}, "law.sigma = 0.3 .*unit"),
        (SUMMITS | {"sigma": "0.3 s"}, "law.sigma .*not in a unit like m"),
        (SUMMITS | {"sigma": None, "sigmo": "0.3 um"}, "law.sigmo is not a key that a study has; did you mean sigma"),
        (SUMMITS | {"model": "gv"}, "no contact law 'gv'"),
        (
            SUMMITS | {"model": "gw-ke", "asperity": "JacksonGreen"},
            'law: asperity is for model = "gw"; "gw-ke" has the asperity KogutEtsion',
        ),
        ({"model": "jk"}, r"\[surface\] is missing"),
        ({"model": "mb"}, r'\[surface\] is missing; model = "mb" takes its inputs from a surface there'),
        ({"model": "table", "file": "none.csv"}, "law.file: no file"),
        ({"model": "table", "file": "heights.csv"}, "heights.csv, line 1: no head"),
        (SUMMITS | {"slope": 0.1}, 'law.slope is for model = "persson", not "gw"'),
        (SUMMITS | {"slop": "x"}, "law.slop is not a key that a study has"),
        ({"model": "table"}, "law: Table needs file"),
        ({"model": "jk", "file": "heights.csv"}, 'law.file is for model = "table", not "jk"'),
    ],
)
def test_laws_that_lack_something(folder, law, fault):
    """One fault each, of [law] and of a joint's own law alike."""
    law = {key: value for key, value in law.items() if value is not None}
    with pytest.raises(faying.InputError, match=r"1 fault\n(.|\n)*" + fault):
        study(folder, surface=None, law=law)
    of_joint = fault.replace("law.", r"joint\[1\].law.", 1).replace("law:", r"joint\[1\].law:", 1)
    with pytest.raises(faying.InputError, match=r"1 fault\n(.|\n)*" + of_joint):
        study(folder, surface=None, joint=joint(law=law))


@pytest.mark.parametrize("model", ["jk", "mb", "wk", "yk", "me", "js"])
def test_the_fractal_parameters_go_under_surface(folder, model):
    text = "law.G is not a key of the law; D, G and scan_area go under [surface]"
    with pytest.raises(faying.InputError, match=re.escape(text)):
        study(folder, law={"model": model, "D": 2.4, "G": "1e-10 m"})


def test_laws_that_a_scan_gives_are_read_with_what_changes_them(folder):
    law = {"model": "gw", "sigma": "1 um"}
    (folder / "scan.x3p").write_bytes(MILLED.read_bytes())
    found = study(folder, law=law, surface={"scan": "scan.x3p"})
    assert (found.law.given, found.law.needs_surface) == ({"sigma": pytest.approx(1e-6)}, True)
    assert folder / "scan.x3p" in found.files
    # D, G and area give no summits: that shows before anything is read or meshed
    with pytest.raises(
        faying.InputError, match=r"law: GW needs density .* and radius .*; give them, or a surface with"
    ):
        study(folder, law=law)


@pytest.mark.parametrize(
    ("given", "diameter", "pitch", "bearing"),
    [
        ({}, 8e-3, 1.25e-3, 10.4e-3),
        ({"seat": ["9 mm", "16 mm"]}, 8e-3, 1.25e-3, 12.5e-3),
        ({"thread": "M8x1"}, 8e-3, 1e-3, 10.4e-3),
        ({"washer": [WASHER]}, 8e-3, 1.25e-3, 12.2e-3),
        ({"diameter": "6.8 mm", "thread": "M8"}, 8e-3, 1.25e-3, 10.4e-3),
        ({"diameter": "6.8 mm", "thread": "M8", "grade": "8.8"}, 8e-3, 1.25e-3, 10.4e-3),
    ],
)
def test_a_torque_turns_the_thread_and_the_seat_that_are_given(folder, given, diameter, pitch, bearing):
    """VDI 2230, R13, the other way: T = F (0.16 P + 0.58 d2 mu_G + D_Km/2 mu_K)."""
    frictions = {"torque": "20 N m", "thread_friction": 0.12, "head_friction": 0.14}
    found = study(folder, bolt=[BOLT | SHANK | frictions | given]).loads
    arm = 0.16 * pitch + 0.58 * (diameter - 0.64952 * pitch) * 0.12 + bearing / 2 * 0.14
    assert found == pytest.approx((20.0 / arm,), rel=1e-9)
    factor = {"torque": "20 N m", "nut_factor": 0.2}
    found = study(folder, bolt=[BOLT | SHANK | factor | given]).loads
    assert found == pytest.approx((20.0 / (0.2 * diameter),))


def test_torque_with_friction(folder):
    given = BOLT | SHANK | {"torque": "20 N m", "pitch": "1.25 mm", "thread_friction": 0.12, "head_friction": 0.14}
    exact = torque_to_preload(20.0, 8e-3, pitch=1.25e-3, thread_friction=0.12, head_friction=0.14)
    assert study(folder, bolt=[given]).loads == pytest.approx((exact,))


@pytest.mark.parametrize(
    ("more", "text"),
    [
        ({"counter": "smooth", "method": "psd"}, "surface: method and counter would say how a scan is read"),
        (
            {"scan": "scan.x3p", "G": None, "scan_area": None},
            "G and scan_area would be those of the scan; give D and G",
        ),
        ({"scan": "scan.x3p", "G": None, "D": None}, "D and G would be those of the scan"),
    ],
)
def test_numbers_of_a_surface_are_those_of_its_scan_or_given(folder, more, text):
    (folder / "scan.x3p").write_bytes(MILLED.read_bytes())
    given = {"D": 2.39, "G": "1.53e-10 m", "scan_area": "16 mm^2"} | more
    with pytest.raises(faying.InputError, match=text):
        study(folder, surface={key: value for key, value in given.items() if value is not None})


def test_a_number_of_one_owner_counts_above_that_of_all(folder):
    """In either order of the keys."""
    plan = study(folder, bolt=[BOLT | SHANK | {"preload": "4 kN"}])
    point = StudyVariant(study=plan, surfaces=(), forces=np.array([4e3]))
    keys = {"bolt.b1.preload": 1e3, "bolt.preload": 9e3}
    for some in (keys, dict(reversed(keys.items()))):
        assert point.with_values(some).forces.tolist() == [1e3]


@pytest.mark.parametrize(
    ("values", "force"),
    [
        ({"bolt.factor": 0.5, "bolt.preload": 2e3}, 1e3),
        ({"bolt.factor": 0.5, "bolt.BOLT.preload": 2e3}, 1e3),
        ({"bolt.BOLT.factor": 0.5, "bolt.preload": 2e3}, 1e3),
        ({"bolt.factor": 0.5, "bolt.BOLT.factor": 0.25}, 1e3),  # of the two the one that names its owner
    ],
)
def test_a_factor_on_a_preload_is_on_that_which_is_given_with_it(values, force, folder):
    """An axis of factors before one of preloads changed no answer of a sweep."""
    plan = study(folder, bolt=[BOLT | SHANK | {"preload": "4 kN"}])
    point = StudyVariant(study=plan, surfaces=(), forces=np.array([4e3]))
    named = {key.replace("BOLT", plan.bolts[0].name): value for key, value in values.items()}
    for keys in (list(named), list(reversed(named))):
        assert point.with_values({key: named[key] for key in keys}).forces.tolist() == [force]


def test_a_diameter_without_material_is_the_size_of_the_thread(folder):
    """It had no effect without a word: the sheet did not know the thread."""
    bolt = study(folder, bolt=[BOLT | {"preload": "1 kN", "diameter": "8 mm"}]).bolts[0]
    assert (str(bolt.metric), bolt.size, bolt.diameter) == ("M8x1.25", 8e-3, None)


@pytest.mark.parametrize(
    ("bolt", "text"),
    [
        ({}, r'preload is missing; give a force such as "12 kN", or torque = "20 N m"'),
        ({"preload": "1 kN", "torque": "1 N m"} | SHANK, "both preload and torque"),
        ({"preload": "1 kN", "nut_factor": 0.2}, "nut_factor turns a torque into a preload, which is given; leave it"),
        (
            {"torque": "1 N m", "nut_factor": 0.2, "thread_friction": 0.1} | SHANK,
            "nut_factor and thread_friction, which all turn its torque into a preload; give nut_factor, or the",
        ),
        ({"preload": "1 kN", "head_mass": "5 g"}, "has head_mass, but no diameter and material"),
        ({"torque": "1 N m", "nut_factor": 0.2}, "only with the thread's diameter; add diameter"),
        ({"torque": "1 N m"} | SHANK, "add nut_factor"),
        ({"torque": "1 N m", "nut_factor": 7} | SHANK, "nut_factor = 7 should be a plain number from 0.02 to 1"),
        ({"preload": "1 kN", "material": "45 steel"}, "has a material but no diameter"),
        ({"preload": "1 kN", "diameter": "8 mm", "material": "cheese"}, 'material "cheese" is unknown'),
        ({"preload": "1 kN", "washer": [WASHER | {"material": "cheese"}]} | SHANK, 'material "cheese" is unknown'),
        ({"preload": "1 kN", "washer": [{"outer": "3 mm"}]}, r"washer\[1\].inner is missing"),
        ({"preload": "1 kN", "seat": ["3 mm"]}, "should be inner and outer diameter"),
        ({"preload": "1 kN", "at": ["3 mm"]}, "should be three lengths"),
        ({"preload": "1 kN", "head_mass": "3 mm"}, "is not in a unit like kg"),
        ({"preload": "1 kN", "hed_mass": "3 g"}, "did you mean head_mass"),
    ],
)
def test_bolt_faults(folder, bolt, text):
    with pytest.raises(faying.InputError, match=text):
        study(folder, bolt=[BOLT | bolt])


def test_supports_and_masses(folder):
    text = """
[[support]]
face = "lower.end"
[[support]]
face = "upper.end"
directions = ["z"]
stiffness = "2 MPa/um"
[[mass]]
mass = "20 g"
face = "upper.end"
offset = ["0 mm", "0 mm", "5 mm"]
[[mass]]
mass = "1 kg"
point = ["1 mm", "2 mm", "3 mm"]
"""
    found = study(folder, text)
    assert found.supports[0].directions == ("x", "y", "z")
    assert found.supports[0].stiffness is None
    assert found.supports[1].stiffness == pytest.approx(2e12)
    assert found.masses[0].offset == pytest.approx((0, 0, 5e-3))
    assert found.masses[1].point == pytest.approx((1e-3, 2e-3, 3e-3))


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ('[[support]]\nface = "a"\ndirections = ["w"]', 'should be some of "x", "y", "z"'),
        ('[[support]]\nface = "a"\nstiffness = "-1 Pa/m"', "must be positive"),
        ("[[support]]", r"support\[1\].face is missing"),
        ('[[mass]]\nmass = "1 kg"', "on a face or at a point; give one of the two"),
        ('[[mass]]\nface = "a"', r"mass\[1\].mass is missing"),
        ('[tightening]\norder = ["bolt", "nut"]', "should name every bolt: 'bolt'"),
        ('[tightening]\norder = ["bolt"]\npasses = 0', "whole number from 1 to"),
        ("[tightening]\npasses = 2", "tightening.order is missing"),
    ],
)
def test_other_faults(folder, text, fault):
    with pytest.raises(faying.InputError, match=fault):
        study(folder, text)


def test_order_and_passes(folder):
    two = [BOLT | SHANK | {"preload": "1 kN"}, BOLT | SHANK | {"name": "b2", "preload": "1 kN"}]
    assert study(folder, '[tightening]\norder = ["b2", "b1"]\npasses = 2', bolt=two).preloads[0].order == (1, 0, 1, 0)
    assert study(folder).preloads[0].order is None


def joint(**more):
    return [{"name": "j", "faces": ["upper.joint", "lower.joint"]} | more]


def test_a_joint_of_its_own(folder):
    gap = {
        "file": "gap.csv",
        "xy_unit": "mm",
        "gap_unit": "um",
        "origin": ["1 mm", "0 mm", "0 mm"],
        "x_axis": [0, 1, 0],
        "y_axis": [-1, 0, 0],
    }
    surface = {"D": 2.5, "G": "1e-10 m", "scan_area": "4 mm^2"}
    given = joint(friction=0.2, search_distance="2 mm", form={"gap": gap}, surface=surface, law={"model": "mb"})
    found = study(folder, joint=given).joints[0]
    assert (found.friction, found.search_distance) == (0.2, pytest.approx(2e-3))
    assert found.form.gap.origin == pytest.approx((1e-3, 0, 0))
    assert found.form.gap.x_axis == (0.0, 1.0, 0.0)
    assert found.surface.D == 2.5
    assert found.law.model == "MB"


def test_measured_heights_need_no_surface(folder):
    law = {
        "model": "gw-measured",
        "gaps": "heights.csv",
        "gaps_unit": "um",
        "density": "1e6 1/m^2",
        "radius": "1 mm",
        "tangent_ratio": 0.01,
        "asperity": "Ghaednia",
    }
    found = study(folder, law=law, surface=None)
    assert found.surface is None
    assert found.law.given == {
        "gaps": folder / "heights.csv",
        "gaps_unit": "um",
        "density": pytest.approx(1e6),
        "radius": pytest.approx(1e-3),
        "tangent_ratio": 0.01,
        "asperity": "Ghaednia",
    }
    assert folder / "heights.csv" in found.files
    with pytest.raises(faying.InputError, match=r"\[surface\] is missing"):
        study(folder, surface=None)
    with pytest.raises(faying.InputError, match="needs gaps_unit"):
        study(folder, law={key: value for key, value in law.items() if key != "gaps_unit"})
    with pytest.raises(faying.InputError, match='law.gaps is for model = "gw-measured", not "jk"'):
        study(folder, law={"model": "jk", "gaps": "heights.csv"})
    with pytest.raises(faying.InputError, match="law.gaps: no file"):
        study(folder, law=law | {"gaps": "none.csv"})


def test_heights_become_a_law(folder):
    given = {"gaps": "heights.csv", "gaps_unit": "um", "density": "1e6 1/m^2", "radius": "1 mm"}
    law = law_named(folder, model="gw-measured", **given)
    assert law.gaps == pytest.approx([0, 10e-6, 20e-6])
    (folder / "heights.csv").write_text("no numbers")
    with pytest.raises(faying.InputError, match="measured heights have the columns gap and probability density"):
        study(folder, surface=None, law={"model": "gw-measured", **given})


GAP = {"file": "gap.csv", "xy_unit": "mm", "gap_unit": "um"}


@pytest.mark.parametrize(
    ("more", "text"),
    [
        ({"form": {"gap": {"file": "none.csv", "xy_unit": "mm", "gap_unit": "um"}}}, "gap.file: no file"),
        ({"form": {"gap": {"file": "gap.csv", "gap_unit": "um"}}}, "states no unit of x; give xy_unit"),
        (
            {"form": {"gap": {"file": "gap.csv", "xy_unit": "mm", "gap_unit": "um", "x_axis": [0, 0, 0]}}},
            "has no length",
        ),
        (
            {"form": {"gap": {"file": "gap.csv", "xy_unit": "mm", "gap_unit": "um", "y_axis": [1, 0]}}},
            "should be three numbers",
        ),
        ({"friction": "much"}, "should be a plain finite number"),
        ({"surface": {"D": 2.5}}, r"give scan, or D, G and scan_area \(G, scan_area missing\)"),
        ({"law": {"model": "cube"}}, "the known ones are"),
    ],
)
def test_joint_faults(folder, more, text):
    with pytest.raises(faying.InputError, match=text):
        study(folder, joint=joint(**more))


RESPONSE = """
[response]
from = "100 Hz"
to = "2 kHz"
points = 50
structural_loss = 0.002
[[response.input]]
point = ["0 mm", "0 mm", "15 mm"]
direction = [0, 0, 1]
[[response.output]]
point = ["40 mm", "0 mm", "15 mm"]
direction = [0, 0, 1]
"""


def test_response_and_damping(folder):
    found = study(folder, RESPONSE)
    spec = found.response
    assert (spec.first, spec.last, spec.points, found.parts_loss) == (100.0, 2000.0, 50, 0.002)
    assert spec.inputs == (((0.0, 0.0, pytest.approx(15e-3)), (0.0, 0.0, 1.0)),)
    assert spec.outputs[0][0][0] == pytest.approx(40e-3)
    assert study(folder).response is None
    assert study(folder, modes={"damping": "viscous"}).modes.damping == "viscous"
    assert study(folder).modes.damping == "hysteretic"


@pytest.mark.parametrize(
    ("old", "new", "text"),
    [
        ('to = "2 kHz"', 'to = "50 Hz"', "from = 100 Hz must be below to = 50 Hz"),
        ("[[response.output]]", "[[response.autput]]", r"\[\[response.output\]\] is missing"),
        ('from = "100 Hz"', "", "response.from is missing"),
        ("direction = [0, 0, 1]", "direction = [0, 0, 0]", "has no length"),
        ('from = "100 Hz"', 'from = "-100 Hz"', "must be positive"),
    ],
)
def test_response_faults(folder, old, new, text):
    with pytest.raises(faying.InputError, match=text):
        study(folder, RESPONSE.replace(old, new))


def test_a_damping_that_is_none(folder):
    with pytest.raises(faying.InputError, match="should be one of hysteretic, viscous"):
        study(folder, modes={"damping": "oil"})


DOWEL = {"walls": ["upper.pin", "lower.pin"], "material": "45 steel"}


def test_a_dowel_with_everything(folder):
    given = DOWEL | {"name": "d", "diameter": "6 mm", "ends": [["0 mm", "1 mm", "2 mm"], ["0 mm", "1 mm", "22 mm"]]}
    (dowel,) = study(folder, dowel=[given]).dowels
    assert (dowel.name, dowel.walls) == ("d", ("upper.pin", "lower.pin"))
    assert dowel.diameter == pytest.approx(6e-3)
    assert dowel.ends == (pytest.approx((0.0, 1e-3, 2e-3)), pytest.approx((0.0, 1e-3, 22e-3)))
    assert dowel.material.E == pytest.approx(faying.CATALOGUE["45 steel"].E)


def test_walls_of_a_dowel_may_be_selectors(folder):
    walls = [{"part": part, "number": 3} for part in ("upper", "lower")] + ["lower.pin"]
    found = study(folder, dowel=[DOWEL | {"walls": walls}])
    assert found.dowels[0].walls == ("dowel 1 first", "dowel 1 second", "lower.pin")
    assert found.geometry.face["dowel 1 second"].number == 3


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"walls": ["upper.pin"]}, "should be a list of 2 names or more"),
        ({"walls": ["upper.pin", "upper.pin"]}, "names the wall 'upper.pin' twice"),
        ({"material": "cheese"}, 'material "cheese" is unknown; the known ones are "45 steel"'),
        ({"material": None}, "material is missing"),
        ({"diameter": "-6 mm"}, "diameter"),
        ({"ends": [["0 mm", "0 mm", "0 mm"]]}, "should be a list of two points"),
        ({"ends": [["0 mm", "0 mm", "0 mm"]] * 2}, "both ends are one point"),
        ({"preload": "1 kN"}, "preload is not a key"),
    ],
)
def test_faults_of_a_dowel_are_said(folder, change, words):
    given = {key: value for key, value in (DOWEL | change).items() if value is not None}
    with pytest.raises(faying.InputError, match=re.escape(words)):
        study(folder, dowel=[given])


def test_dowels_of_one_name_are_refused(folder):
    with pytest.raises(faying.InputError, match="two dowels are called 'd'"):
        study(folder, dowel=[DOWEL | {"name": "d"}] * 2)
