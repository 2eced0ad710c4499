"""Steps of a bolt sheet against published tables, a worked example and geometry."""

from math import inf, pi, sqrt, tan

import pytest

from faying.bolt.threads import CLASSES, Fastener, Thread
from faying.bolt.vdi2230 import greatest_preload
from faying.sheet.rows import Quantity, Step, evaluate
from faying.sheet.steps import endurance, engagement, reduced_stress, steps, thread_torque, working_stress

# thread, friction in thread and under head, preload [kN] and torque [N m] of class 8.8 at 90 % of yield
FINE = [
    ("M8x1", 0.10, 20.7, 22.8),
    ("M8x1", 0.12, 20.2, 26.1),
    ("M8x1", 0.14, 19.7, 29.2),
    ("M10x1.25", 0.12, 31.6, 51),
    ("M12x1.25", 0.10, 49.1, 79),
    ("M16x1.5", 0.12, 87.6, 218),
    ("M24x2", 0.14, 204, 865),
]


@pytest.mark.parametrize(("size", "mu", "force", "torque"), FINE)
def test_stress_and_torque_of_tightening_are_those_of_the_guidelines_table(size, mu, force, torque):
    """VDI 2230:2001, fine threads of class 8.8: tabled preload and torque use 90 % of the stress at yield.

    The table's heads bear on 1.25 to 1.34 d; 1.3 d is taken, which moves the torque by 2 %. The rounded 0.16 and 0.58
    of the guideline's formula add 0.5 %.
    """
    bolt = Fastener(thread=Thread.parse(size), grade="8.8")
    thread = bolt.thread
    d_0 = (thread.pitch_diameter + thread.minor_diameter) / 2
    shank = thread_torque(force * 1e3, thread.pitch, thread.pitch_diameter, mu)
    assert reduced_stress(force * 1e3, d_0, shank) == pytest.approx(0.9 * bolt.yield_stress, rel=0.005)
    assert greatest_preload(thread, bolt.yield_stress, scatter=0.28, friction=mu) == pytest.approx(
        force * 1e3 / 1.28, rel=0.005
    )
    whole = shank + force * 1e3 * 1.3 * thread.diameter * mu / 2
    assert whole == pytest.approx(torque, rel=0.026)


def test_without_friction_and_pitch_there_is_tension_alone():
    area = pi / 4 * 7e-3**2
    assert thread_torque(1e4, 0.0, 7e-3, 0.0) == 0
    assert reduced_stress(1e4, 7e-3, 0.0) == pytest.approx(1e4 / area)
    assert working_stress(1e4, 7e-3, 0.0) == pytest.approx(1e4 / area)


def test_shear_of_a_round_section():
    """Elastic: torque over pi d^3/16 at the surface, 4/3 of that of a section that flows everywhere."""
    torque, d = 10.0, 7e-3
    elastic = torque / (pi * d**4 / 32) * d / 2
    assert working_stress(0.0, d, torque) == pytest.approx(sqrt(3) * elastic / 2)
    assert reduced_stress(0.0, d, torque) == pytest.approx(sqrt(3) * elastic * 3 / 4)


def test_strengths_of_the_classes():
    """ISO 898-1:2013, Table 3: stress under proof load is 0.88 to 0.94 of the stress at yield, which is below R_m."""
    printed = {"4.6": 0.94, "4.8": 0.91, "5.6": 0.93, "5.8": 0.90, "6.8": 0.92, "8.8": 0.91, "9.8": 0.90}
    for grade, (tensile, yielding, proof) in CLASSES.items():
        assert proof / yielding == pytest.approx(printed.get(grade, 0.88), abs=0.006), grade
        assert 0.6 <= yielding / tensile < 0.91
        # the class names R_m/100 and ten times the ratio of nominal values
        assert tensile == pytest.approx(float(grade.split(".")[0]) * 1e8, rel=0.05)
    thick = Fastener(thread=Thread.parse("M20"), grade="8.8")
    assert (thick.tensile_strength, thick.yield_stress) == (830e6, 660e6)
    assert thick.proof_stress / thick.yield_stress == pytest.approx(0.91, abs=0.006)


def test_a_tapped_thread_strips_where_its_teeth_are_as_wide_as_the_flanks_say():
    """A tooth of the tapped part is P/2 wide at the pitch diameter and widens by 2 tan 30 degrees a depth."""
    thread, R_m, tau = Thread.parse("M10"), 800e6, 250e6
    d, d_2, P = thread.diameter, thread.pitch_diameter, thread.pitch
    m = engagement(R_m=R_m, A_S=thread.stress_area, tau_B=tau, d=d, d_2=d_2, P=P)
    width = P / 2 + 2 * tan(pi / 6) * (d - d_2) / 2
    assert 0.897 * tau * pi * d * width * m / P == pytest.approx(R_m * thread.stress_area, rel=1e-12)
    # of a sharp profile the tooth would fill the pitch at the outer apex, P sqrt(3)/4 beyond the pitch cylinder
    assert P / 2 + 2 * tan(pi / 6) * P * sqrt(3) / 4 == pytest.approx(P)
    assert 0.7 * d < m < 1.0 * d


def test_endurance_falls_with_the_diameter():
    """0.85 (150/d + 45) MPa: 54 MPa for M8, 51 for M10, 47 for M16."""
    assert [round(endurance(d) * 1e-6) for d in (8e-3, 10e-3, 16e-3)] == [54, 51, 46]


def known(**values):
    """Quantities of values; those that are None are missing under their own symbol."""
    return {
        symbol: Quantity(symbol=symbol, name=symbol, unit="", value=value, missing=(symbol,) if value is None else ())
        for symbol, value in values.items()
    }


M10 = Fastener(thread=Thread.parse("M10"), grade="10.9")
EXAMPLE = {
    "F_V": 20e3,
    "s": 0.0,
    "delta_S": 2.760e-9,
    "delta_P": 1.166e-9,
    "delta_Pc": None,
    "n": 1.0,
    "F_Au": 0.0,
    "F_Ao": 8e3,
    "f_Z": 9.5e-6,
    "f_law": None,
    "f_Zd": 0.0,
    "F_th": None,
    "F_thd": 0.0,
    "F_thg": 0.0,
    "dF_u": 0.0,
    "dF_o": 0.0,
    "dF_P": 0.0,
    "dF_M": 0.0,
    "sigma_b": 0.0,
    "F_Q": 0.0,
    "F_KP": 0.0,
    "mu_T": 0.2,
    "mu_G": 0.12,
    "mu_K": 0.12,
    "d": 10e-3,
    "P": 1.5e-3,
    "d_2": M10.thread.pitch_diameter,
    "d_0": 8.593e-3,
    "A_S": M10.thread.stress_area,
    "S_p": M10.proof_stress,
    "F_p": M10.proof_load,
    "R_m": M10.tensile_strength,
    "R_p": M10.yield_stress,
    "R_p09": 0.9 * M10.yield_stress,
    "tau_BS": 0.6 * M10.tensile_strength,
    "A_p": pi / 4 * (16e-3**2 - 10.5e-3**2),
    "p_G": None,
    "D_Km": 13.25e-3,
    "m": None,
    "tau_B": None,
}


def sheet(*, tapped=False, rolled_after=False, **changes):
    rows = evaluate(steps(tapped=tapped, rolled_after=rolled_after), known(**(EXAMPLE | changes)))
    return {row.result.symbol: row for row in rows}


def test_an_m10_in_aluminium_under_8_kn():
    """Load factor, loss by embedding, bolt and clamp force, alternating stress.

    Source: worked example of public notes to the lecture Bauelemente der Luftfahrzeuge (V5.0.16), 9.11.
    """
    found = sheet()
    for symbol, printed in {
        "Phi": 0.297,
        "F_Z": 2420,
        "F_Smax": 22376,
        "F_PA": 5624,
        "F_KRmin": 14376,
        "sigma_a": 20.5e6,
    }.items():
        assert found[symbol].result.value == pytest.approx(printed, rel=2e-3), symbol
    assert found["sigma_a"].verdict == "ok"


def test_a_load_that_opens_the_joint_is_exceeded():
    """20 kN/(1 - 0.297) = 28.4 kN opens it (the same source)."""
    assert sheet(F_Ao=28.3e3)["F_PA"].verdict == "ok"
    assert sheet(F_Ao=28.6e3)["F_PA"].verdict == "exceeded"
    assert sheet(F_Ao=28.6e3, F_Q=100.0)["F_KQs"].utilisation == inf


def test_tightening_factor_and_range():
    found = sheet(s=0.23)
    assert found["alpha_A"].result.value == pytest.approx(1.6, rel=2e-3)  # 1.4 to 1.6 in the guideline's table
    ratio = found["F_Mmax"].result.value / found["F_Mmin"].result.value
    assert ratio == pytest.approx(found["alpha_A"].result.value)
    assert (found["F_Mmax"].result.value + found["F_Mmin"].result.value) / 2 == pytest.approx(20e3)


def test_a_thread_rolled_after_heat_treatment_bears_more_the_less_it_is_pulled():
    before = sheet()["sigma_ASV"].result.value
    at_yield = sheet(rolled_after=True, F_V=M10.yield_stress * M10.thread.stress_area, F_Ao=0.0)
    assert at_yield["sigma_ASG"].result.value == pytest.approx(before)
    half = sheet(rolled_after=True, F_V=0.5 * M10.yield_stress * M10.thread.stress_area, F_Ao=0.0)
    assert half["sigma_ASG"].result.value == pytest.approx(1.5 * before)


def test_what_is_missing_is_named_and_passed_on():
    found = sheet(F_Ao=None, mu_T=None, F_Q=2e3)
    assert found["F_PA"].verdict == "not known"
    assert found["F_PA"].missing == ("F_Ao",)
    assert found["F_Mreq"].missing == ("mu_T", "F_Ao")
    assert found["F_Mreq"].utilisation is None
    assert found["p_M"].missing == ("p_G",)
    assert found["p_M"].result.value is not None
    assert found["alpha_A"].verdict == "value"
    assert found["M_A"].verdict == "value"


def test_steps_come_in_their_order_and_find_their_inputs():
    for tapped in (False, True):
        order = [int(step.step[1:]) for step in steps(tapped=tapped, rolled_after=False)]
        assert order == sorted(order)
        assert set(order) == set(range(14))


def test_a_limit_below_nothing_is_used_up():
    step = Step(
        step="R0",
        symbol="x",
        name="x",
        unit="",
        formula="x",
        inputs=("a",),
        function=lambda a: a,
        limit="b",
        source="-",
    )
    for a, b, verdict in ((1.0, -1.0, "exceeded"), (1.0, 2.0, "ok"), (0.0, -1.0, "exceeded"), (2.0, 1.0, "exceeded")):
        (row,) = evaluate([step], known(a=a, b=b))
        assert row.verdict == verdict
        assert row.to_dict()["verdict"] == verdict


def test_a_bolt_that_heat_tightens_carries_the_gain():
    plain, hot = sheet(), sheet(F_thg=500.0)
    assert hot["F_Smax"].result.value == pytest.approx(plain["F_Smax"].result.value + 500.0)
    assert hot["p_B"].result.value > plain["p_B"].result.value
