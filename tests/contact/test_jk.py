"""The JK law beyond its printed totals: the consistent closure, limits, losses, inversion, and what it refuses."""

import warnings
from collections.abc import Callable
from math import inf, log, pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import brentq

from faying import JK, RIGID, ContactPair, InputError, Material
from faying.contact.models.jk import asperity_regimes, slip_share

STEEL = Material(name="45 steel", E=200e9, nu=0.3, density=7800.0, yield_strength=355e6, hardness=994e6, friction=0.25)
PAIR = ContactPair(STEEL, RIGID)
LAW = JK(D=2.39, G=1.53e-10, pair=PAIR, scan_area=16e-6)
TOTALS = ("pressure", "area", "k_n", "k_t", "energy_n")


def materials() -> st.SearchStrategy[Material]:
    return st.builds(
        lambda E, nu, share: Material(name="m", E=E, nu=nu, hardness=share * E, friction=0.25),
        st.floats(1e9, 6e11),
        st.floats(0, 0.5),
        st.floats(1e-3, 0.05),
    )


def laws(**fixed: object) -> st.SearchStrategy[JK]:
    return st.builds(
        lambda D, logG, m, lam, **more: JK(
            D=D, G=10**logG, pair=ContactPair(m, RIGID), scan_area=16e-6, substrate=lam, **(more | fixed)
        ),
        st.floats(2.1, 2.9),
        st.floats(-13, -8),
        materials(),
        st.floats(0.3, 1),
        cutoff=st.floats(1e-4, 0.01),
    )


def across_the_stages(law: JK, points: int, room: float = 3.0) -> np.ndarray:
    """Largest areas from deep in the small stage to deep in the large one, on a logarithmic grid."""
    al1, al2, _ = law.limits
    return np.geomspace(al1 * (al1 / al2) ** (room / 3), al2 * (al2 / al1) ** (room / 3), points)


# ---- one asperity ----


@given(st.floats(0, 0.5))
def test_asperity_is_continuous_for_any_poissons_ratio(nu: float) -> None:
    x_p, (elastic, mixed, plastic) = asperity_regimes(0.454 + 0.41 * nu, printed=False)

    def at(terms: tuple[tuple[float, float], ...], y: float) -> float:
        return sum(c * y**p for c, p in terms)

    for name in ("force", "area", "energy_n"):
        assert at(getattr(elastic, name), 1.0) == pytest.approx(at(getattr(mixed, name), 1.0), rel=1e-13)
        assert at(getattr(mixed, name), x_p) == pytest.approx(at(getattr(plastic, name), x_p), rel=1e-12)
    for name in ("k_t", "energy_t"):
        assert at(getattr(elastic, name), 1.0) == pytest.approx(at(getattr(mixed, name), 1.0), rel=1e-13)


def test_consistent_asperity_at_poissons_ratio_of_the_print() -> None:
    # 400 K/3 = 76.8 at K = .576, nu = .2976; there the exponents are 1.16 and 1.38 to three digits
    x_p, (_, mixed, _) = asperity_regimes(0.576, printed=False)
    assert x_p == pytest.approx(76.8, rel=1e-12)
    assert mixed.area[0][1] == pytest.approx(1.16, abs=5e-3)
    assert mixed.force[0][1] == pytest.approx(1.38, abs=5e-3)


def test_printed_asperity_keeps_its_jumps_in_energy() -> None:
    # its elastic-plastic energy is integrated from zero: at d2c the plastic one exceeds it by 19 %
    x_p, (_, mixed, plastic) = asperity_regimes(0.577, printed=True)
    ratio = plastic.energy_n[0][0] * x_p**2 / (mixed.energy_n[0][0] * x_p**2.38)
    assert ratio == pytest.approx(1.19, abs=0.005)


@given(st.floats(1e-12, 1 - 1e-9))
def test_slip_share_is_the_printed_function(X: float) -> None:
    printed = 3 / 5 - (1 - X) ** (2 / 3) + 2 / 5 * (1 - X) ** (5 / 3)
    assert float(slip_share(X)) == pytest.approx(printed, abs=5e-16, rel=1e-13)
    if X < 1e-3:  # the print has lost its digits there; B = X^2/3 + 2 X^3/27 + ...
        assert float(slip_share(X)) == pytest.approx(X**2 / 3 + 2 * X**3 / 27, rel=X**2 + 1e-13)


# ---- continuity and growth over the stages ----


@settings(max_examples=60, deadline=None)
@given(laws())
def test_consistent_totals_grow_strictly(law: JK) -> None:
    response = law.at_closure(across_the_stages(law, 400))
    for name in TOTALS:
        assert np.all(np.diff(np.log(response.quantities()[name])) > 0), name


def test_a_large_cutoff_makes_stiffness_fall_in_the_meso_stage() -> None:
    # as the module's text warns
    for D, cutoff, falls in ((2.74, 0.1, False), (2.8, 0.1, True), (2.45, 0.3, False), (2.6, 0.3, True)):
        law = LAW.with_(D=D, cutoff=cutoff)
        k_n = law.at_closure(across_the_stages(law, 400)).k_n
        assert bool(np.any(np.diff(k_n) < 0)) is falls


@settings(max_examples=60, deadline=None)
@given(laws(), st.sampled_from([0, 1]))
def test_consistent_totals_are_continuous_at_the_stage_limits(law: JK, which: int) -> None:
    limit = law.limits[which]
    response = law.at_closure(limit * np.array([1 - 1e-9, 1 + 1e-9]))
    for name in (*TOTALS, "loss_n"):
        below, above = response.quantities()[name]
        assert above == pytest.approx(below, rel=1e-6), name


@pytest.mark.parametrize("printed", [True, False])
@given(D=st.floats(2.1, 2.9))
def test_stages_are_entered_at_the_limits(D: float, printed: bool) -> None:
    # without plastic or elastic-plastic asperities the literal loss is a known function
    law = LAW.with_(D=D, closure="printed" if printed else "consistent", loss="literal")
    _, al2, _ = law.limits
    loss = law.at_closure(np.array([al2 * 1.001, al2 * 0.999])).loss_n
    assert loss is not None
    assert abs(loss[0]) < 1e-14 < loss[1]


# ---- stiffness ratio ----


def ratio(law: JK, al: object) -> np.ndarray:
    response = law.at_closure(al)
    assert response.k_t is not None
    assert response.k_n is not None
    return np.asarray(response.k_t / response.k_n)


@pytest.mark.parametrize(
    ("D", "printed", "ours"), [(2.3, 0.9544, 0.9512), (2.39, 0.9324, 0.9297), (2.5, 0.9096, 0.9075)]
)
def test_stiffness_ratio_has_the_two_plateaus(D: float, printed: float, ours: float) -> None:
    # in the consistent closure the borders lie at delta_a = d1c, 1.06 lam away from a1c': hence its own plateau
    for closure, plateau in (("printed", printed), ("consistent", ours)):
        law = LAW.with_(D=D, closure=closure)
        al1, al2, _ = law.limits
        small = ratio(law, al1 * np.array([1e-12, 1e-6, 0.999]))
        large = ratio(law, al2 * np.array([1.001, 1e3, 1e9]))
        assert small == pytest.approx(np.full(3, plateau), abs=5.1e-5)
        assert large == pytest.approx(np.full(3, 2 * 0.7 / 1.7), rel=1e-12)


@pytest.mark.parametrize("D", [2.3, 2.39, 2.5])
def test_consistent_plateau_follows_from_two_integrals(D: float) -> None:
    # by hand from the asperity laws, borders at y = 1 and y = x_p, in the variable y
    x_p, (_, mixed, _) = asperity_regimes(PAIR.hardness_coefficient, printed=False)
    n, m = mixed.force[0][1], mixed.area[0][1]
    y = np.geomspace(0.01, 1, 200_001)
    z = np.geomspace(1, x_p, 200_001)
    elastic = np.trapezoid(y**0.5 * y ** ((1 - D) / 2), np.log(y))
    k_n = 1.5 * elastic + n * np.trapezoid(z ** (n - 1 + (1 - D) / 2), np.log(z))
    k_t = elastic + np.trapezoid(z ** (m / 2 + (1 - D) / 2), np.log(z))
    expected = 2 * 0.7 / 1.7 * 1.5 * k_t / k_n
    assert float(ratio(LAW.with_(D=D), LAW.with_(D=D).limits[0] * 1e-3)) == pytest.approx(expected, rel=1e-8)


@settings(max_examples=40, deadline=None)
@given(laws())
def test_stiffness_ratio_falls_through_the_meso_stage_to_mindlins(law: JK) -> None:
    al1, al2, _ = law.limits
    meso = ratio(law, np.geomspace(al1, al2, 60))
    nu = law.pair.softer.nu
    assert np.all(np.diff(meso) <= 1e-13)
    assert meso[-1] == pytest.approx(2 * (1 - nu) / (2 - nu), rel=1e-12)


def test_two_equal_bodies_keep_the_ratio_and_halve_the_moduli() -> None:
    al = LAW.limits[1] * 10
    both = LAW.with_(pair=ContactPair(STEEL, STEEL))
    assert ratio(both, both.limits[1] * 10) == pytest.approx(ratio(LAW, al), rel=1e-13)


# ---- invariance, limits ----


@settings(max_examples=40, deadline=None)
@given(laws(), st.floats(-9, 9), st.floats(-9, 9), st.floats(0, 1))
def test_answers_do_not_depend_on_the_units(law: JK, log_length: float, log_force: float, u: float) -> None:
    length, force = 10**log_length, 10**log_force
    stress = force / length**2
    m = law.pair.softer
    other = law.with_(
        G=law.G * length,
        scan_area=law.scan_area * length**2,
        pair=ContactPair(Material(name="m", E=m.E * stress, nu=m.nu, hardness=(m.hardness or 0) * stress), RIGID),
    )
    al1, al2, _ = law.limits
    al = al1 * (al2 / al1) ** (3 * u - 1)
    here, there = law.at_closure(al), other.at_closure(al * length**2)
    units = {
        "pressure": stress,
        "area": 1,
        "k_n": stress / length,
        "k_t": stress / length,
        "loss_n": 1,
        "loss_t": 1,
        "energy_n": force / length,
        "energy_t": 1,
    }
    for name, value in here.quantities().items():
        assert float(there.quantities()[name]) == pytest.approx(float(value) * units[name], rel=1e-9, abs=1e-300), name
    assert other.limits == pytest.approx([v * length**2 for v in law.limits], rel=1e-9)
    assert there.valid == here.valid


@pytest.mark.parametrize("D", [2.2, 2.39, 2.7])
def test_elastic_stage_grows_by_its_known_powers(D: float) -> None:
    # F ~ al'^((D-1)/2) a1c'... all asperities elastic: pressure ~ al'^((4-D)/2), area ~ al', k_n ~ al'^.5
    law = LAW.with_(D=D)
    al = law.limits[1] * np.array([10.0, 1000.0])
    response = law.at_closure(al)
    decades = log(100)
    for name, power in (("pressure", (4 - D) / 2), ("area", 1.0), ("k_n", 0.5), ("k_t", 0.5)):
        a, b = response.quantities()[name]
        assert log(b / a) / decades == pytest.approx(power, rel=1e-12), name


def test_hard_material_stays_elastic_and_soft_one_ends_at_its_hardness() -> None:
    hard = LAW.with_(pair=ContactPair(Material(name="h", E=200e9, nu=0.3, hardness=1e13), RIGID), loss="literal")
    assert float(hard.at_closure(1e-9).loss_n) == pytest.approx(0.0, abs=1e-14)
    soft = LAW.with_(pair=ContactPair(Material(name="s", E=200e9, nu=0.3, hardness=1e5), RIGID))
    response = soft.at_closure(1e-9)
    assert float(response.pressure / response.area) == pytest.approx(1e5, rel=1e-2)


def test_psi_of_one_removes_the_extension() -> None:
    plain, full = LAW.with_(psi=1.0), LAW
    al = 1e-10
    P = full._islands.psi ** ((3 - 2.39) / 2)
    assert float(full.at_closure(al).area) == pytest.approx(P * float(plain.at_closure(al).area), rel=1e-13)


# ---- substrate ----


def test_exact_substrate_lies_between_its_constant_shares() -> None:
    al = np.geomspace(1e-14, 1e-8, 7)
    exact = LAW.with_(substrate="exact").at_closure(al)
    stiff, soft = LAW.with_(substrate=1.0).at_closure(al), LAW.with_(substrate=0.55).at_closure(al)
    assert np.all((soft.pressure < exact.pressure) & (exact.pressure < stiff.pressure))
    assert np.all((soft.area < exact.area) & (exact.area < stiff.area))


@settings(max_examples=15, deadline=None)
@given(
    D=st.floats(2.1, 2.9),
    modulus_ratio=st.floats(0.1, 4),
    u=st.floats(-0.5, 1.5),
    closure=st.sampled_from(["consistent", "printed"]),
    cutoff=st.sampled_from([0.01, 1e-5]),
)
def test_exact_substrate_equals_the_sum_of_asperities(
    D: float, modulus_ratio: float, u: float, closure: str, cutoff: float
) -> None:
    """Each asperity by eq. (1) on its own, summed by the trapezoidal rule on a fine grid in ln a' per regime."""
    from scipy.optimize import brentq

    law = LAW.with_(D=D, substrate="exact", modulus_ratio=modulus_ratio, closure=closure, cutoff=cutoff)
    al1, al2, _ = law.limits
    al = al1 * (al2 / al1) ** u
    h_a, R, d1c = (float(v) for v in law._cap(np.array(al)))
    x_p, regimes = asperity_regimes(PAIR.hardness_coefficient, printed=closure == "printed")

    def sink(x: float) -> float:
        """delta_a of the asperity of area x al': delta = 1.06 h_a x, delta_a (1 + Er xi sqrt(delta_a)) = delta."""
        delta = 1.06 * h_a * x
        xi = 1.5 * sqrt(R) / sqrt(al / pi)
        return float(brentq(lambda d: d * (1 + modulus_ratio * xi * sqrt(d)) - delta, 0, delta, xtol=1e-40, rtol=1e-13))

    if closure == "printed":
        first, second = d1c / h_a, x_p * d1c / h_a
    else:
        first, second = (
            brentq(lambda x, y: sink(x) - y * d1c, 1e-30, 1e30, args=(y,), rtol=1e-14) if y * d1c < sink(1.0) else 1.0
            for y in (1.0, x_p)
        )
    first, second = min(first, 1.0), min(second, 1.0)
    weight = (D - 1) / 2 * law._islands.psi ** ((3 - D) / 2)
    response = law.at_closure(al).quantities()
    KH = PAIR.hardness_coefficient * PAIR.hardness
    unit = {"pressure": 2 / 3 * KH * pi * R * d1c, "k_n": 2 / 3 * KH * pi * R, "k_t": 8 * PAIR.G_star * sqrt(R * d1c)}
    t, w = np.polynomial.legendre.leggauss(40)
    for name, key in (("pressure", "force"), ("k_n", "k_n"), ("k_t", "k_t")):
        low = cutoff * first if key != "force" else first * np.exp(-18 / (1.5 + (1 - D) / 2))
        total = 0.0
        for regime, (a, b) in zip(regimes, ((low, first), (first, second), (second, 1.0)), strict=True):
            for i in range(12):
                span = log(b / a) / 12 if b > a else 0.0
                for ti, wi in zip(t, w, strict=True):
                    x = a * np.exp(span * (i + (ti + 1) / 2))
                    y = sink(x) / d1c if span else 1.0
                    total += span * wi / 2 * x ** ((1 - D) / 2) * sum(c * y**p for c, p in getattr(regime, key))
        assert float(response[name]) == pytest.approx(weight * unit[name] * total / 16e-6, rel=1e-7), name


# ---- loss and shear ----


def test_held_loss_keeps_the_value_at_the_end_of_the_small_stage() -> None:
    al1, al2, _ = LAW.limits
    al = np.array([al1 * 1e-3, al1, sqrt(al1 * al2), al2 * 1e3])
    held, literal = LAW.at_closure(al), LAW.with_(loss="literal").at_closure(al)
    assert held.loss_n is not None
    assert literal.loss_n is not None
    assert held.loss_n[0] == literal.loss_n[0]
    assert held.loss_n[1:] == pytest.approx(np.full(3, literal.loss_n[1]), rel=1e-12)
    assert np.all(np.diff(literal.loss_n) < 0)
    assert literal.loss_n[3] == pytest.approx(0, abs=1e-14)
    # nearly all energy there is elastic-plastic: alpha/(1 - alpha)
    assert LAW.specific_damping(al[1])[0] == pytest.approx(0.25, rel=0.01)
    assert held.loss_n[1] == pytest.approx(0.25 / (2 * pi), rel=0.01)


@given(st.floats(1e-6, 0.99))
def test_loss_t_does_not_depend_on_a_shear_ratio(X: float) -> None:
    al = np.geomspace(1e-16, 1e-8, 5)
    unloaded, loaded = LAW.at_closure(al), LAW.with_(shear_ratio=X).at_closure(al)
    assert loaded.loss_t == pytest.approx(unloaded.loss_t, rel=1e-12)
    assert unloaded.energy_t == pytest.approx(np.zeros(5), abs=0)
    assert loaded.k_t == pytest.approx(unloaded.k_t * (1 - X) ** (1 / 3), rel=1e-12)
    assert loaded.k_n == pytest.approx(unloaded.k_n, rel=1e-15)


def test_shear_stress_is_a_shear_ratio_per_regime() -> None:
    # deep in the small stage nearly all load is plastic; k_t comes from the others: X there is tau A/(mu F) of each
    al = np.geomspace(LAW.limits[0], LAW.limits[1], 5)
    tau = 1e6
    sheared = LAW.with_(shear_stress=tau).at_closure(al)
    free = LAW.at_closure(al)
    parts = LAW._parts(al)
    expected = sum(
        (1 - tau * area / (0.25 * np.where(force > 0, force, inf))) ** (1 / 3) * k
        for area, force, k in zip(parts["area"], parts["force"], parts["k_t"], strict=True)
    )
    assert sheared.k_t == pytest.approx(expected / 16e-6, rel=1e-12)
    assert np.all(sheared.k_t < free.k_t)
    assert np.all(sheared.energy_t > 0)
    # a vanishing tau leaves the stiffness, and the energies vanish as its square
    faint = [LAW.with_(shear_stress=t).at_closure(al) for t in (1e-3, 1e-4)]
    assert faint[0].k_t == pytest.approx(free.k_t, rel=1e-9)
    assert faint[0].energy_t == pytest.approx(100 * faint[1].energy_t, rel=1e-6)


def test_shear_stress_beyond_friction_slips_and_says_so() -> None:
    response = LAW.with_(shear_stress=1e9).at_closure(LAW.limits[1] * 10)
    assert float(response.k_t) == 0
    assert not response.valid
    assert any("slip" in reason and mask for reason, mask in response.reasons.items())


# ---- pressure in ----


@settings(max_examples=25, deadline=None)
@given(laws(), st.floats(0, 1), st.sampled_from(["consistent", "printed"]))
def test_inversion_to_1e_10(law: JK, u: float, closure: str) -> None:
    law = law.with_(closure=closure)
    first, last = law.closure_range
    al = first * (last / first) ** (0.02 + 0.97 * u)
    straight = law.at_closure(al)
    back = law.at_pressure(float(straight.pressure))
    for name, value in straight.quantities().items():
        assert float(back.quantities()[name]) == pytest.approx(float(value), rel=1e-10, abs=1e-300), name


def test_any_shape_in_same_shape_out() -> None:
    p = np.array([[0.0, 1e5, 1e6], [2e6, 0.0, 5e7]])
    response = LAW.at_pressure(p)
    assert all(value.shape == (2, 3) for value in response.quantities().values())
    assert response.valid.shape == (2, 3)
    one = LAW.at_pressure(2e6)
    assert one.pressure.shape == ()
    assert float(one.k_n) == pytest.approx(response.k_n[1, 0], rel=1e-13)
    assert LAW.at_closure(np.full((2, 1, 3), 1e-10)).k_t.shape == (2, 1, 3)
    assert LAW.at_pressure(np.zeros((0, 3))).k_n.shape == (0, 3)


def test_nothing_touches_at_zero_pressure() -> None:
    response = LAW.at_pressure(0.0)
    assert all(float(value) == 0 for value in response.quantities().values())
    assert bool(response.valid)


def test_areas_over_nominal_one_end_the_law() -> None:
    top = LAW.greatest_pressure
    assert float(LAW.at_pressure(top).area) == pytest.approx(1.0, rel=1e-9)
    with pytest.raises(InputError, match=r"more than JK covers.*at most"):
        LAW.at_pressure(1.001 * top)


def test_every_sign_of_leaving_the_ground_is_reported() -> None:
    def reasons(law: JK, al: float) -> str:
        return " | ".join(text for text, mask in law.at_closure(al).reasons.items() if mask)

    assert LAW.at_closure(1e-10).valid
    assert "0.3 of the nominal area" in reasons(LAW, LAW.closure_range[1])
    assert "stiffness of the bulk" in reasons(LAW.with_(G=1e-16), LAW.with_(G=1e-16).closure_range[1] * 0.1)
    assert "al' above al3'" in reasons(LAW, LAW.limits[2] * 1.01)
    assert "al' above al3'" not in reasons(LAW, LAW.limits[2] * 0.99)
    rough = LAW.with_(D=2.1, G=1e-8)
    assert "not in the order" in reasons(rough, 1e-10)
    assert "D outside" in reasons(LAW.with_(D=2.05), 1e-10)


def test_a_loss_that_no_loop_can_have_is_outside_of_the_ground() -> None:
    """The least loads deform all asperities plastically: dissipated over stored energy grows without limit."""
    pressure = np.geomspace(1e-6, 1e6, 40)
    response = LAW.at_pressure(pressure)
    assert response.loss_n is not None
    assert response.loss_t is not None
    greatest = np.maximum(response.loss_n, response.loss_t)
    assert greatest[0] > 1e4
    assert greatest[-1] < 0.05
    assert response.valid.tolist() == (greatest <= 4 / pi).tolist()


def test_flags_begin_at_their_limits() -> None:
    """Each flag one part in a million on either side of the value that the docstring states."""

    def flagged(law: JK, al: float, text: str) -> bool:
        (mask,) = (mask for reason, mask in law.at_closure(al).reasons.items() if text in reason)
        return bool(mask)

    def where(law: JK, excess: Callable[[float], float]) -> float:
        top = law.closure_range[1]
        return float(np.exp(brentq(lambda x: excess(float(np.exp(x))), np.log(top * 1e-20), np.log(top), xtol=1e-13)))

    crowded = where(LAW, lambda al: float(LAW.at_closure(al).area) - 0.3)
    smooth = LAW.with_(G=1e-16)
    bulk = 2 * PAIR.E_star / sqrt(pi * smooth.scan_area)
    stiff = where(smooth, lambda al: float(smooth.at_closure(al).k_n) - bulk)
    for law, al, text in ((LAW, crowded, "0.3 of the nominal area"), (smooth, stiff, "stiffness of the bulk")):
        assert not flagged(law, al * (1 - 1e-6), text)
        assert flagged(law, al * (1 + 1e-6), text)
    for D, inside in ((2.1 - 1e-6, False), (2.1, True), (2.9, True), (2.9 + 1e-6, False)):
        assert flagged(LAW.with_(D=D), 1e-12, "D outside 2.1 to 2.9") is not inside


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"D": 2.0}, "between 2 and 3"),
        ({"D": 3.0}, "between 2 and 3"),
        ({"D": float("nan")}, "between 2 and 3"),
        ({"G": 0.0}, "positive"),
        ({"G": -1e-10}, "positive"),
        ({"G": inf}, "positive"),
        ({"scan_area": 0.0}, "scan_area"),
        ({"scan_area": float("nan")}, "scan_area"),
        ({"gamma": 1.0}, "above 1"),
        ({"alpha": 1.0}, "below 1"),
        ({"alpha": -0.1}, "at least 0"),
        ({"closure": "other"}, '"consistent" or "printed"'),
        ({"loss": "other"}, '"held" or "literal"'),
        ({"cutoff": 0.0}, "between 0 and 1"),
        ({"cutoff": 1.0}, "between 0 and 1"),
        ({"psi": 0.5}, "at least 1"),
        ({"psi": float("nan")}, "at least 1"),
        ({"substrate": 0.0}, "above 0 and at most 1"),
        ({"substrate": 1.2}, "above 0 and at most 1"),
        ({"substrate": "other"}, 'or "exact"'),
        ({"modulus_ratio": 0.0}, "positive"),
        ({"shear_ratio": -0.1}, "at least 0"),
        ({"shear_ratio": 1.0}, "slips everywhere"),
        ({"shear_stress": -1.0}, "at least 0"),
        ({"shear_stress": 1e6, "shear_ratio": 0.1}, "give one of them"),
        (
            {
                "shear_ratio": 0.1,
                "pair": ContactPair(Material(name="m", E=1e9, nu=0.3, hardness=1e7, friction=0.0), RIGID),
            },
            "friction above 0",
        ),
        ({"pair": ContactPair(Material(name="m", E=1e9, nu=0.3), RIGID)}, "neither hardness nor yield_strength"),
    ],
)
def test_parameters_out_of_range_are_refused(change: dict[str, object], message: str) -> None:
    with pytest.raises(InputError, match=message):
        LAW.with_(**change)


@pytest.mark.parametrize("value", [0.0, -1e-10, float("nan"), inf])
def test_closures_out_of_range_are_refused(value: float) -> None:
    with pytest.raises(InputError, match="al'"):
        LAW.at_closure([1e-10, value])


@pytest.mark.parametrize("value", [-1.0, float("nan"), inf])
def test_pressures_out_of_range_are_refused(value: float) -> None:
    with pytest.raises(InputError, match="pressure"):
        LAW.at_pressure([1e6, value])


def test_extreme_surfaces_raise_no_numerical_warning() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for D in (2.001, 2.01, 2.99, 2.999):
            response = LAW.with_(D=D).at_closure(np.geomspace(1e-30, 1e-6, 9))
            assert np.all(np.isfinite(response.k_n))
            assert np.all(np.isfinite(response.loss_n))


def test_tangential_energy_of_a_sphere_is_the_work_of_mindlins_force():
    """Work of T over u = 3 mu F/(16 G* r) (1 - (1-X)^(2/3)), by quadrature over the displacement."""
    from scipy.integrate import quad

    for X in (0.1, 0.5, 0.95):
        last = 1 - (1 - X) ** (2 / 3)
        work = quad(lambda u: 1 - (1 - u) ** 1.5, 0, last, epsabs=0, epsrel=1e-12)[0]  # in 3 (mu F)^2/(16 G* r)
        assert slip_share(X) == pytest.approx(work, rel=1e-9)
