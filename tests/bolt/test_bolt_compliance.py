"""delta_S of VDI 2230 against cylinders by hand."""

from math import pi

import numpy as np
import pytest

import faying
from faying.bolt.bolt import Bolt, Washer
from faying.bolt.threads import METRIC, Fastener, Thread
from faying.bolt.vdi2230 import bolt_sections
from tests.helpers.plates import stacked

E = 210e9
STEEL = faying.Material(name="steel", E=E, nu=0.3, density=7850.0)
SOFT = faying.Material(name="soft", E=70e9, nu=0.33, density=2700.0)


def delta(thread, free, **given):
    return sum(s.compliance for s in bolt_sections(Thread.parse(thread), free=free, E=E, **given))


def by_hand(d, pitch, free, shank=0.0, head=0.5, end=0.4, ratio=1.0, engaged=None):
    nominal, minor = pi / 4 * d**2, pi / 4 * (d - 1.22687 * pitch) ** 2
    inside = 0.5 * d if engaged is None else engaged
    return ((head + end * ratio) * d / nominal + shank / nominal + (free - shank + inside) / minor) / E


@pytest.mark.parametrize(
    ("thread", "free", "shank", "printed"),
    [("M6", 6.35e-3, 0.0, 3.40e-9), ("M6", 6.35e-3, 6.35e-3, 2.78e-9), ("M8", 20e-3, 0.0, 4.2e-9)],
)
def test_short_bolts_with_nuts(thread, free, shank, printed):
    """1.07 and 1.89 um/kN is what l/(E A_N) alone gives of 3.40, 2.78 and 4.2."""
    assert delta(thread, free, shank=shank) == pytest.approx(printed, rel=0.01)


@pytest.mark.parametrize(
    ("given", "hand"),
    [
        ({}, {}),
        ({"shank": 12e-3}, {"shank": 12e-3}),
        ({"head": "socket"}, {"head": 0.4}),
        ({"E_tapped": 70e9, "engaged": 15e-3}, {"end": 0.33, "ratio": 3.0}),
        ({"E_tapped": 210e9, "engaged": 3e-3}, {"end": 0.33, "engaged": 3e-3}),
    ],
)
def test_cylinders_in_series(given, hand):
    assert delta("M10", 30e-3, **given) == pytest.approx(by_hand(10e-3, 1.5e-3, 30e-3, **hand), rel=1e-12)


@pytest.mark.parametrize(
    ("diameter", "printed"),
    [
        (None, {"head": 0.303, "shank": 1.213, "free thread": 0.546, "engaged thread": 0.455, "nut": 0.243, "": 2.760}),
        (7e-3, {"shank": 2.475, "": 4.02}),
    ],
)
def test_an_m10_piece_by_piece(diameter, printed):
    """20 mm of shank and 6 mm of free thread, hexagon head and nut of steel; then with a shank of 7 mm [um/kN].

    Source: worked example and exercise 2 of public notes to the lecture Bauelemente der Luftfahrzeuge (V5.0.16), 9.11.
    """
    sections = bolt_sections(Thread.parse("M10"), free=26e-3, E=E, diameter=diameter, shank=20e-3)
    found = {s.name: 1e9 * s.compliance for s in sections} | {"": 1e9 * sum(s.compliance for s in sections)}
    for name, value in printed.items():
        assert found[name] == pytest.approx(value, rel=3e-3), name


def test_a_fine_thread_is_stiffer_and_a_reduced_shank_softer():
    assert delta("M10x1.25", 30e-3) == pytest.approx(by_hand(10e-3, 1.25e-3, 30e-3), rel=1e-12)
    assert delta("M10x1.25", 30e-3) < delta("M10", 30e-3)
    thin = delta("M10", 30e-3, diameter=7e-3, shank=30e-3)
    plain = delta("M10", 30e-3, shank=30e-3)
    assert thin - plain == pytest.approx(30e-3 / E * 4 / pi * (1 / 7e-3**2 - 1 / 10e-3**2), rel=1e-10)


def test_a_long_bolt_is_a_rod():
    """Head, thread and nut matter less, the longer the bolt is: 1.4 d and 15 um of 100 d."""
    assert delta("M12", 1.2, shank=1.2) == pytest.approx(1.2 / (E * pi / 4 * 12e-3**2), rel=0.02)


def test_what_no_bolt_is():
    for given, text in (
        ({"shank": 31e-3}, "the shank is 31 mm long, but only 30 mm are"),
        ({"shank": -1e-3}, "give a length from 0"),
        ({"head": "round"}, 'give "hexagon" or "socket"'),
        ({"E_tapped": 0.0}, "moduli above 0"),
    ):
        with pytest.raises(faying.InputError, match=text):
            delta("M10", 30e-3, **given)
    with pytest.raises(faying.InputError, match="free length"):
        delta("M10", 0.0)


def test_diameters_of_threads():
    """ISO 724 and ISO 898-1, M8: d_2 = 7.188, d_3 = 6.466 mm, stress area 36.6 mm2."""
    m8 = Thread.parse("M8")
    assert m8.pitch_diameter == pytest.approx(7.188e-3, abs=0.5e-6)
    assert m8.minor_diameter == pytest.approx(6.466e-3, abs=0.5e-6)
    assert m8.minor_area == pytest.approx(32.84e-6, rel=1e-3)
    assert m8.stress_area == pytest.approx(36.6e-6, rel=1e-3)


def test_diameters_between_the_sizes():
    for size, one in METRIC.items():
        assert Thread.near(size * 1e-3).pitch == pytest.approx(one.pitch * 1e-3, rel=1e-12)
        assert Thread.near(size * 1e-3).is_coarse
    nine = Thread.near(9e-3)
    assert nine.pitch == pytest.approx(1.375e-3)
    assert not nine.is_coarse
    assert Thread.near(2e-3).pitch == pytest.approx(0.4e-3)  # ISO 261
    assert Thread.near(1.2e-3).pitch == pytest.approx(1.2e-3 * 0.35 / 1.6)
    assert Thread.near(42e-3).pitch == pytest.approx(4.5e-3)
    assert Thread.near(100e-3).pitch == pytest.approx(6e-3)
    with pytest.raises(faying.InputError, match="M1 to M300"):
        Thread.near(310e-3)


def bolt(**given):
    kept = {"diameter": 8e-3, "material": STEEL, "seat": (8.4e-3, 16e-3)} | given
    return Bolt("b", ("high.top", "low.bottom"), at=(0.04, 0.02, 0.0), **kept)


def fitted(**given):
    return bolt(**given).fitted(stacked(counts=(16, 8, 1), size=(0.08, 0.04, 0.01)))


def test_a_fitted_bolt_has_the_stiffness_of_its_sections():
    """Two plates of 10 mm. Washers add themselves, and their thickness to the free thread."""
    assert 1 / fitted().axial_stiffness == pytest.approx(by_hand(8e-3, 1.25e-3, 20e-3), rel=1e-9)
    assert 1 / fitted(thread="M8x1").axial_stiffness == pytest.approx(by_hand(8e-3, 1e-3, 20e-3), rel=1e-9)
    washer = Washer(outer=16e-3, inner=8.4e-3, thickness=1.6e-3, material=SOFT)
    both = 1 / fitted(washers=(washer, washer), shank=5e-3).axial_stiffness
    hand = by_hand(8e-3, 1.25e-3, 23.2e-3, shank=5e-3) + 2 * 1.6e-3 / (70e9 * pi / 4 * (16e-3**2 - 8.4e-3**2))
    assert both == pytest.approx(hand, rel=1e-9)


def test_a_diameter_that_is_not_the_threads_is_a_reduced_shank():
    thin = fitted(diameter=7e-3, thread="M8")
    assert [s.name for s in thin.sections] == ["head", "shank", "engaged thread", "nut"]
    assert [s.name for s in fitted().sections] == ["head", "free thread", "engaged thread", "nut"]
    assert [s.name for s in fitted(shank=5e-3).sections] == ["head", "shank", "free thread", "engaged thread", "nut"]


def test_threads_that_are_assumed_are_said():
    assert not fitted().notes
    (odd,) = fitted(diameter=9e-3).notes
    assert (odd.code, "a pitch of 1.38 mm is taken" in odd.text) == ("bolt-pitch", True)
    thick = fitted(diameter=0.31)
    assert "counts as a plain cylinder" in thick.notes[-1].text
    assert thick.axial_stiffness == pytest.approx(E * pi / 4 * 0.31**2 / 20e-3, rel=1e-9)


def test_bolts_that_cannot_be():
    with pytest.raises(faying.InputError, match="its shank is 21 mm long, but its thread begins to engage 20 mm"):
        fitted(shank="21 mm")
    with pytest.raises(faying.InputError, match="shank = -1 mm; give 0 or more"):
        bolt(shank=-1e-3)
    with pytest.raises(faying.InputError, match='give "hexagon" or "socket"'):
        bolt(head="countersunk")
    coarse = Fastener(thread=Thread.parse("M8"), grade="8.8")
    with pytest.raises(faying.InputError, match="is not that of its fastener"):
        bolt(thread="M8x1", fastener=coarse)


def test_the_axial_stiffness_is_that_of_the_structure():
    """A unit stretch of the seats stores delta_S^-1 / 2 in the bolt's matrix."""
    mesh = stacked(counts=(16, 8, 1), size=(0.08, 0.04, 0.01))
    one = bolt().fitted(mesh)
    lifted = np.zeros_like(mesh.points)
    lifted[mesh.part_nodes("high"), 2] = 1e-6
    u = lifted.ravel()
    assert u @ (one.stiffness @ u) == pytest.approx(1e-12 / by_hand(8e-3, 1.25e-3, 20e-3), rel=1e-6)
