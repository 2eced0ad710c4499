"""Compliance and load factor of five screws against worked examples of three public sources."""

from math import pi

import pytest

from faying.bolt.threads import Thread
from faying.bolt.vdi2230 import bolt_sections, cone_angle, cone_compliance

NOTES = (
    "worked example and exercises 1 and 2, public notes to the lecture Bauelemente der Luftfahrzeuge (V5.0.16), 9.11"
)
PROGRAM = (
    "worked examples A and B, calculated by hand, in the tests of the public TypeScript program analyseBoltedJoint"
)
PYFLANGE = "pyFlange (KCI The Engineers, Siemens Gamesa, TNO), tests/bolts_test.py, test_axial_stiffness"
PYFLANGE_PARTS = "pyFlange, src/pyflange/flangesegments.py, stiffness of the flange in compression, from its inputs"
ROUNDED = "digits that are printed"
UM_KN = "um/kN"


def delta(thread, **given):
    return sum(one.compliance for one in bolt_sections(thread, **given))


def replacement_cylinder(length, E, seat, hole, outer):
    """delta_P [m/N] of old editions of the guideline, on which the lecture's load factors stand."""
    narrow = pi / 4 * (seat**2 - hole**2)
    wider = pi / 8 * seat * (outer - seat) * (((length * seat / outer**2) ** (1 / 3) + 1) ** 2 - 1)
    return length / (E * (narrow + wider))


@pytest.mark.parametrize(
    ("name", "waist", "plates", "screw", "factor"),
    [
        ("M10, aluminium plates of 26 mm", None, 70e9, 2.760, 0.297),
        ("M10, steel plates of 26 mm", None, 210e9, 2.760, 0.123),
        ("M10 with a shank of 7 mm, aluminium plates of 26 mm", 7e-3, 70e9, 4.02, 0.225),
    ],
)
def test_an_m10_of_a_lecture(published, name, waist, plates, screw, factor):
    ours = delta(Thread.parse("M10"), free=26e-3, E=210e9, diameter=waist, shank=20e-3)
    published(f"delta_S, {name}", screw, ours * 1e9, source=NOTES, unit=UM_KN, rel=3e-3, why=ROUNDED)
    parts = replacement_cylinder(26e-3, plates, 16e-3, 10.5e-3, 32e-3)
    published(
        f"load factor Phi, {name}",
        factor,
        parts / (ours + parts),
        source=NOTES,
        rel=5e-3,
        why="digits that are printed; delta_P by the replacement cylinder of the guideline's old editions",
    )


def test_the_cone_of_the_guideline_is_softer_than_the_cylinder_of_its_old_editions():
    """26 % for the plates of the lecture: its load factors are not those of the edition of 2015."""
    cone = cone_compliance([(26e-3, 70e9)], seat=16e-3, hole=10.5e-3, outer=32e-3)
    old = replacement_cylinder(26e-3, 70e9, 16e-3, 10.5e-3, 32e-3)
    assert old == pytest.approx(1.166e-9, rel=1e-3)
    assert cone == pytest.approx(1.26 * old, rel=5e-3)


@pytest.mark.parametrize(
    ("name", "screw", "parts", "introduced", "printed"),
    [
        (
            "M10, nut, 12 mm of aluminium and 8 mm of steel",
            ("M10", {"free": 20e-3}),
            {"sections": [(12e-3, 71.7e9), (8e-3, 210e9)], "seat": 14.63e-3, "hole": 11e-3, "outer": 30e-3},
            0.5,
            (2.8911, 0.45970, 1.1835, 0.14523),
        ),
        (
            "M12 socket head, tapped hole, 20 mm of steel",
            ("M12", {"free": 20e-3, "head": "socket", "E_tapped": 210e9}),
            {"sections": [(20e-3, 210e9)], "seat": 17.23e-3, "hole": 13.5e-3, "outer": 36e-3, "tapped": True},
            0.7,
            (2.0372, 0.49215, 0.30629, 0.091491),
        ),
    ],
)
def test_screws_of_a_program_for_the_guideline(published, name, screw, parts, introduced, printed):
    thread, given = screw
    ours = delta(Thread.parse(thread), E=205e9, **given)
    length = sum(one for one, _ in parts["sections"])
    angle = cone_angle(length, parts["seat"], parts["outer"], tapped=parts.get("tapped", False))
    clamped = cone_compliance(**parts)
    for quantity, unit, theirs, value in (
        ("delta_S", UM_KN, printed[0], ours * 1e9),
        ("tangent of the cone", "1", printed[1], angle),
        ("delta_P by the cone", UM_KN, printed[2], clamped * 1e9),
        (f"load factor, n = {introduced}", "1", printed[3], introduced * clamped / (ours + clamped)),
    ):
        published(f"{quantity}, {name}", theirs, value, source=PROGRAM, unit=unit, rel=1e-4, why=ROUNDED)


def test_a_flange_bolt_with_a_reduced_shank(published):
    """M80x6, shank of 76.1 mm over 270 mm of 400 mm: 1831 MN/m; E = 210 GPa."""
    thread = Thread(diameter=80e-3, pitch=6e-3)
    stiff = 1e-6 / delta(thread, free=0.4, E=210e9, diameter=76.1e-3, shank=0.27)
    published("1/delta_S, M80 over 400 mm", 1831, stiff, source=PYFLANGE, unit="MN/m", rel=5e-4, why=ROUNDED)


def test_load_factor_of_a_flange_bolt(published):
    """120 bolts M80 in a flange of 7.5 m: parts of 2 x 200 mm, washers of 140 mm, holes of 86 mm.

    The source takes the parts for a sleeve as wide as the washer and a tenth of the clamped length; the cone of the
    guideline is cut at the width of a segment, 2 pi/120 (7.5/2 - 0.072/2 - 0.1665) m.
    """
    length, washer, hole, E = 0.4, 0.14, 0.086, 210e9
    screw = delta(Thread(diameter=80e-3, pitch=6e-3), free=length, E=E, diameter=76.1e-3, shank=0.27)
    sleeve = length / (E * pi / 4 * ((washer + length / 10) ** 2 - hole**2))
    segment = 2 * pi / 120 * (7.5 / 2 - 0.072 / 2 - 0.1665)
    cone = cone_compliance([(length, E)], seat=washer, hole=hole, outer=segment)
    published(
        "load factor Phi, M80 over 400 mm",
        sleeve / (1e-6 / 1831 + sleeve),
        cone / (screw + cone),
        source=PYFLANGE_PARTS,
        rel=0.05,
        why="another model of the parts: a sleeve, with the numbers of the source",
    )
