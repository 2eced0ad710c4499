"""Several laws on one surface."""

from dataclasses import dataclass

import numpy as np
import pytest

from faying import JK, RIGID, ContactPair, InputError, Material, Mates
from faying.contact import (
    GreenwoodWilliamson,
    RoughSurface,
    SurfaceInputs,
    TabulatedLaw,
    compare,
)

PAIR = ContactPair(Material(name="m", E=200e9, nu=0.3, yield_strength=355e6), RIGID)
SURFACE = SurfaceInputs(
    D=2.4, G=1e-11, scan_area=16e-6, m0=1e-12, m2=1e-4, m4=1e6, slope=0.014, h_rms=1e-6, shortest=1e-6
)
P = np.geomspace(1e5, 1e8, 7)


def laws_of_surface(surface, pair, names=None):
    return Mates.of_surface(surface, materials=pair).laws(names)


def test_every_model_that_lives_on_numbers_is_there() -> None:
    made, left_out = laws_of_surface(SURFACE, PAIR)
    assert left_out == {}
    assert {"JK", "MB", "WK", "YK", "ME", "JS", "Persson", "GW", "GW-CEB", "GW-KE", "GW-ZMC", "GW-JG"} <= set(made)
    assert "Table" not in made
    assert made["GW-KE"] == GreenwoodWilliamson.from_surface(SURFACE, PAIR).with_(asperity="KogutEtsion")


def test_named_models_in_any_spelling() -> None:
    made, _ = laws_of_surface(SURFACE, PAIR, names=["jk", "gw-jg", "greenwood-williamson", "persson"])
    assert list(made) == ["JK", "GW-JG", "GW", "Persson"]
    with pytest.raises(InputError, match="no contact law 'cube'"):
        laws_of_surface(SURFACE, PAIR, names=["cube"])


def test_a_model_that_cannot_take_the_surface_is_left_out_with_its_reason() -> None:
    soft = ContactPair(Material(name="m", E=200e9, nu=0.3), RIGID)
    made, left_out = laws_of_surface(SURFACE, soft, names=["jk", "gw"])
    assert list(made) == ["GW"]
    assert "neither hardness nor yield_strength" in left_out["JK"]


def test_spread_is_the_largest_over_the_smallest() -> None:
    laws = {n: TabulatedLaw(pressure=P, k_n=f * P) for n, f in (("a", 1.0), ("b", 3.0), ("c", 2.0))}
    table = compare(laws, P)
    assert table.spread("k_n") == pytest.approx(np.full(7, 3.0), rel=1e-9)
    assert np.isnan(table.spread("k_t")).all()
    assert np.isnan(compare({"a": laws["a"]}, P).spread("k_n")).all()


def test_beyond_a_law_there_is_nothing() -> None:
    short = TabulatedLaw(pressure=P[1:4], k_n=P[1:4])
    jk = JK(D=2.39, G=1.53e-10, pair=PAIR, scan_area=16e-6)
    table = compare({"short": short, "JK": jk}, P)
    r = table.responses["short"]
    assert np.isnan(r.k_n).tolist() == [True, False, False, False, True, True, True]
    assert r.valid.tolist() == [False, True, True, True, False, False, False]
    assert np.isnan(table.spread("k_n")).tolist() == np.isnan(r.k_n).tolist()
    assert table.responses["JK"].k_n[0] == pytest.approx(float(jk.at_pressure(P[0]).k_n), rel=1e-9)


def test_laws_do_not_depend_on_the_units() -> None:
    # lengths in units of 1 mm, forces of 1 kN: every number changes, no dimensionless answer does
    L, S = 1e3, 1e-9  # 1 m = 1000 mm, 1 Pa = 1e-9 kN/mm2
    values = vars(SURFACE)
    other = SurfaceInputs(
        **(
            values
            | {
                "G": values["G"] * L,
                "scan_area": values["scan_area"] * L**2,
                "m0": values["m0"] * L**2,
                "m4": values["m4"] / L**2,
                "h_rms": values["h_rms"] * L,
                "shortest": values["shortest"] * L,
            }
        )
    )
    m = PAIR.first
    pair = ContactPair(Material(name="m", E=m.E * S, nu=m.nu, yield_strength=(m.yield_strength or 0) * S), RIGID)
    units = {
        "pressure": S,
        "area": 1.0,
        "k_n": S / L,
        "k_t": S / L,
        "loss_n": 1.0,
        "loss_t": 1.0,
        "energy_n": S * L,
        "energy_t": S * L,
        "k_load": S / L,
    }
    here = compare(laws_of_surface(SURFACE, PAIR)[0], P)
    there = compare(laws_of_surface(other, pair)[0], P * S)
    assert here.responses.keys() == there.responses.keys()
    for name, response in here.responses.items():
        assert there.responses[name].valid.tolist() == response.valid.tolist(), name
        for quantity, value in response.quantities().items():
            expected = pytest.approx(value * units[quantity], rel=1e-8, abs=1e-300, nan_ok=True)
            assert there.responses[name].quantities()[quantity] == expected, (name, quantity)


@dataclass(frozen=True)
class Map:
    """Heights with their spacing, as a law of a scan takes them."""

    heights: np.ndarray
    spacing: tuple[float, float]


def test_a_law_of_the_scan_itself_takes_part_when_named() -> None:
    x = np.arange(32) * 1e-6
    waves = 1e-7 * np.cos(2 * np.pi * x / 32e-6)
    rough = RoughSurface(inputs=SURFACE, scan=Map(waves[:, None] + waves, (1e-6, 1e-6)))
    made, left_out = laws_of_surface(rough, PAIR, names=["half-space", "jk"])
    assert left_out == {}
    assert list(made) == ["half-space", "JK"]
    assert "half-space" not in laws_of_surface(SURFACE, PAIR)[0]


def test_pressures_must_be_positive() -> None:
    with pytest.raises(InputError, match="positive"):
        compare({}, [0.0, 1e6])
