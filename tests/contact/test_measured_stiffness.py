"""The table of measured stiffness and conductance: what stands in it follows from its sources, and laws lie near it."""

import csv
import importlib.util
import re
from math import sqrt
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from faying.contact import PowerLaw
from faying.hardness import VickersHardness
from tests.helpers.published import Published

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def script() -> ModuleType:
    spec = importlib.util.spec_from_file_location(
        "measured_conductance", ROOT / "benchmarks" / "measured_conductance.py"
    )
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    import sys

    sys.modules[spec.name] = module  # its dataclass asks for it
    spec.loader.exec_module(module)
    return module


def rows() -> list[dict[str, str]]:
    with (ROOT / "docs" / "theory" / "measured-stiffness.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_forty_measurements_from_four_sources(script: ModuleType) -> None:
    table = rows()
    assert len(table) >= 40
    assert len({row["source"] for row in table}) >= 4
    known = script.materials()
    for row in table:
        assert {row["first"], row["second"]} <= set(known)
        assert row["branch"] in ("loading", "unloading")
        assert float(row["p low [MPa]"]) <= float(row["p high [MPa]"])
        wide = float(row["p high [MPa]"]) > 3 * float(row["p low [MPa]"])
        assert row["kind"] == ("range" if wide else row["kind"])
        assert row["kind"] in ("point", "curve", "range")


def test_conductances_become_stiffness_by_barber(script: ModuleType) -> None:
    """h = 2 k_n/(E* (1/K1 + 1/K2)), worked out here for 304 on 304: K = 14.9, E* = 200/(2 (1 - 0.09)) GPa."""
    found = [one for one in script.measured() if one.pair.first.name == one.pair.second.name == "304 stainless"]
    assert len(found) == 1
    assert found[0].k_n == pytest.approx(1900 * 200e9 / (2 * 0.91) / 14.9)
    assert found[0].pressure == pytest.approx(sqrt(4 * 7) * 1e6)


def test_curves_are_those_of_their_sources(script: ModuleType) -> None:
    for row in rows():
        p, value = float(row["p low [MPa]"]), float(row["value"])
        if row["source"].startswith("Ito"):
            found = re.search(r"approach ([\d.]+) um p\^([\d.]+);", row["note"])
            assert found is not None
            C, m = (float(number) for number in found.groups())
            law = PowerLaw.measured(C=C, m=m, origin="")
            assert value == pytest.approx(float(law.at_pressure(p * 1e6).k_n) * 1e-12, rel=1e-4)
        if row["source"].startswith("Krolikowski"):
            assert value == pytest.approx(4200 * p / 400, rel=1e-3)
        if row["source"].startswith("Ross"):
            found = re.search(r"roughness ([\d.]+) um of both", row["note"])
            assert found is not None
            R = float(found.group(1)) * 1e-6
            first, second = (script.materials()[row[name]] for name in ("first", "second"))
            k = 2 / (1 / first.conductivity + 1 / second.conductivity)
            a0 = 0.5 * sqrt(0.01)  # 1/2 cm^(1/2)
            assert value == pytest.approx(k * p * 1e6 / (a0 * sqrt(R) * second.hardness), rel=1e-3)
            # Gaussian heights: the rms is 1.253 times the arithmetic mean
            assert float(row["roughness [um]"]) * 1e-6 == pytest.approx(sqrt(np.pi / 2) * R, rel=2e-3)


def test_synthetic_surfaces_have_the_stated_height_and_slope(script: ModuleType) -> None:
    inputs: Any = script.surface(2e-6, 0.15).inputs
    assert inputs.h_rms == pytest.approx(2e-6, rel=0.02)
    assert inputs.mean_slope == pytest.approx(0.15, rel=0.02)


def test_cmy_lies_near_hardened_ground_steel_by_ultrasound(script: ModuleType, published: Published) -> None:
    """Between half and twice the measured line; the source says of theories of summits that they lie 29 to 55 % low."""
    found = [one for one in script.measured() if one.source.startswith("Krolikowski")]
    ratios = [script.predicted("cmy", one) / one.k_n for one in found]
    assert len(ratios) == 6
    published(
        "k_n of ground bearing steel at 10 MPa by ultrasound, law CMY",
        found[0].k_n,
        script.predicted("cmy", found[0]),
        unit="Pa/m",
        source="Krolikowski and Szczepek 1991, Wear",
        rel=0.5,
        why="roughness and slope of the specimens are assumed, 0.3 um and 0.125 (sigma/um)^0.402",
        measured=True,
    )
    assert 0.5 < min(ratios) < max(ratios) < 2


@pytest.mark.slow
def test_the_solved_contact_and_cmy_agree_at_the_same_hardness(script: ModuleType) -> None:
    """One number of hardness in both: on rough soft faces, where spots yield, within a factor of 1.5."""
    from faying.contact import CMY
    from faying.contact.auto import pick

    rough = script.surface(2e-6, 0.2)
    pair = next(one.pair for one in script.measured() if one.pair.first.name == "copper")
    p = np.array([3e6, 10e6])
    solved = pick("half-space", {}, rough, pair).law.at_pressure(p)
    closed = CMY(h_rms=2e-6, mean_slope=0.2, pair=pair).at_pressure(p)
    assert closed.valid.all()
    assert np.all(np.abs(np.log(solved.k_n / closed.k_n)) < np.log(1.5))
    # the size of spots matters as much: with it, hardness and k_n of CMY differ by more than that
    sized = VickersHardness(c1=3e9, c2=-0.25)
    harder = CMY(h_rms=2e-6, mean_slope=0.2, pair=pair, c1=sized.c1, c2=sized.c2).at_pressure(p)
    assert np.all(closed.k_n / harder.k_n > 1.3)
