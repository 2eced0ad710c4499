"""Text with units: what it means, and what is refused before it can mean something else."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from faying import InputError, units


@pytest.mark.parametrize(
    ("text", "unit", "value"),
    [
        ("12 kN", "N", 12e3),
        ("12kN", "N", 12e3),
        ("-3 um", "m", -3e-6),
        (".4 mm", "m", 0.4e-3),
        ("1e6 1/m^2", "1/m^2", 1e6),
        ("7.8 g/cm^3", "kg/m^3", 7800.0),
        ("7.8 g/cm³", "kg/m^3", 7800.0),
        ("9 N*m", "N*m", 9.0),
        ("9 N m", "N*m", 9.0),
        ("9 N·m", "N*m", 9.0),
        ("50 MPa/um", "Pa/m", 50e12),
        ("180 deg", "rad", 3.141592653589793),
        ("5 %", "", 0.05),
        ("3000 rpm", "Hz", 50.0),
        ("360 deg/s", "Hz", 1.0),
        ("6.283185307179586 rad/s", "Hz", 1.0),
        ("1 N^2/(rad/s)", "N^2/Hz", 6.283185307179586),
        ("1 t", "kg", 1000.0),
    ],
)
def test_quantities(text, unit, value):
    assert units.parse(text, unit) == pytest.approx(value, rel=1e-14)


@pytest.mark.parametrize("text", ["4,5 kN", "1.000,5 N", "1,000 N", "8,5 mm", "4 kN,"])
def test_every_comma_is_refused_with_the_right_form(text):
    """A decimal comma was dropped once: "4,5 kN" was 45 kN."""
    with pytest.raises(
        InputError,
        match='has a comma; use a decimal point, and no mark for thousands: write for example "12 kN"',
    ):
        units.parse(text, "N")


@pytest.mark.parametrize(
    "text",
    [
        "10**10**10 N",
        "9**9**9 mm",
        "5 mm*1000",
        "3 5 N",
        "2*3 N",
        "(3 N)",
        "kN",
        "",
        "N 3",
        "1e N",
        "0x10 N",
        "3 N/0",
        "1_000 N",
    ],
)
def test_units_are_names_and_one_number_not_expressions(text):
    with pytest.raises(InputError, match="value ="):
        units.parse(text, "N")


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("12", "no unit"),
        (12, "no unit"),
        (True, "no unit"),
        ("3 mm^2", "not in a unit like m"),
        ("1e400 m", "not a finite"),
        ("3 florps", "not the name of a unit"),
        ("3 ton", "a metric, a short or a long ton; write t"),
        ("3 " + 50 * "m" + "$", "not the name of a unit"),  # no search through all the ways to divide the letters
        ("3 m" + 1_000_000 * " " + "$", "not the name of a unit"),
    ],
)
def test_faults_name_the_value_and_the_form(text, why):
    with pytest.raises(InputError, match=rf"width = .*{why}.*for example .0.4 mm"):
        units.parse(text, "m", name="width")


@pytest.mark.parametrize("text", ["5 mm", "mm*1000", "kg", "9**9**9 mm", "", "1000"])
def test_the_unit_of_a_file_is_a_name(text):
    with pytest.raises(InputError, match="unit"):
        units.scale(text, "m")
    assert units.scale("um", "m") == 1e-6


@given(st.text(max_size=30))
def test_any_text_gives_a_number_or_an_input_error(text):
    try:
        assert isinstance(units.parse(text, "m"), float)
    except InputError as fault:
        assert len(str(fault)) < 400  # noqa: PT017


@given(st.floats(-1e12, 1e12, allow_subnormal=False), st.sampled_from(["m", "mm", "um", "km", "inch"]))
def test_any_number_keeps_its_digits(number, unit):
    assert units.parse(f"{number!r} {unit}", "m") == pytest.approx(number * units.scale(unit, "m"), rel=1e-15)


def test_one_length_or_two():
    assert units.lengths("4 mm x 3 mm") == pytest.approx((4e-3, 3e-3))
    assert units.lengths("5 um") == pytest.approx(5e-6)
    for text, why in (("4 x 3 mm", "no unit"), ("1 mm x 2 mm x 3 mm", "one length or two"), ("0 mm", "positive")):
        with pytest.raises(InputError, match=why):
            units.lengths(text)


@pytest.mark.parametrize(("unit", "name"), [(unit, name) for unit, names in units.COMMON.items() for name in names])
def test_common_units_are_those_of_pint(unit, name):
    name_of_pint = name.replace("g", "g_0") if "s^2" in unit else name  # where an acceleration is meant
    assert units.COMMON[unit][name] == pytest.approx(units._pint_factor(name_of_pint, unit), rel=1e-15, abs=0)
