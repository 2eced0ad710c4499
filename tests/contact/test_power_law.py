"""The approach law of measured joints."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from faying import InputError
from faying.contact import PowerLaw

LAW = PowerLaw.measured(C=0.046, m=0.48, origin="S45C mean")


def test_stiffness_of_itos_mean_joint() -> None:
    # Ito's table: 45 MPa/um at 1 MPa, 117 at 6.25 MPa
    assert LAW.at_pressure([1e6, 6.25e6]).k_n * 1e-12 == pytest.approx([45.3, 117.4], rel=5e-3)


@given(st.floats(1e-9, 1e-4), st.floats(0.05, 0.95), st.floats(0.01, 1))
def test_stiffness_and_energy_belong_to_the_approach(approach: float, m: float, share: float) -> None:
    C = approach / PowerLaw.greatest**m
    law = PowerLaw(C=C, m=m)
    p = share * law.greatest
    u = C * p**m
    h = 1e-4 * u
    slope = float(np.diff(law.at_closure([u - h, u + h]).pressure)[0]) / (2 * h)
    at = law.at_closure(u)
    assert float(at.pressure) == pytest.approx(p, rel=1e-9)
    assert float(at.k_n) == pytest.approx(slope, rel=1e-4)
    x = np.linspace(0, u, 20_001)
    assert float(at.energy_n) == pytest.approx(np.trapezoid((x / C) ** (1 / m), x), rel=1e-4)
    assert at.area is None
    assert float(law.at_pressure(p).k_n) == pytest.approx(p ** (1 - m) / (C * m), rel=1e-9)


def test_beyond_the_measurement() -> None:
    with pytest.raises(InputError, match="more than Power law covers"):
        LAW.at_pressure(1e8)
    assert not LAW.at_closure(1e-6).valid
    assert LAW.at_pressure(9.7e6).valid


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"C": 0.0}, "C = "),
        ({"m": 1.0}, "between 0 and 1"),
        ({"m": 0.0}, "between 0 and 1"),
        ({"greatest": -1.0}, "greatest"),
        ({"greatest": 999.0}, "it must be at least 1000"),
        ({"C": 1e300}, "an approach of"),
        ({"C": 1.01e-3 / 9.8e6**0.48}, "a joint has 100 pm to 1 mm"),
        ({"C": 0.99e-10 / 9.8e6**0.48}, "a joint has 100 pm to 1 mm"),
        ({"C": 1e-9, "m": 1e-9}, "at most 1e\\+22 Pa/m"),
    ],
)
def test_parameters_out_of_range_are_refused(change: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        LAW.with_(**change)
