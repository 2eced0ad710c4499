"""The loading curve of the default law, its hardness over the size of spots, and what a scan resolves."""

import os
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

import faying
from faying import CATALOGUE, ContactPair, Mates
from faying.contact.models.half_space import HalfSpace
from faying.errors import InputError
from faying.halfspace import solve_half_space
from faying.halfspace.sized import solve_with_size
from faying.halfspace.solve import halved_map
from faying.halfspace.spots import Spots
from faying.hardness import VickersHardness
from faying.joint.joint_law import JointLaw
from faying.setup import template
from faying.surface.scan import Scan

ROOT = Path(__file__).parents[2]
DATA = Path(os.environ.get("FAYING_DATA", ROOT.parent / "shared" / "data")) / "scans"
STEEL = CATALOGUE["45 steel"]
PAIR = ContactPair(STEEL, STEEL)
PRESSURES = 1e6, 3e6, 10e6, 30e6


def self_affine(points: int, hurst: float, *, full: int = 1024, side: float = 1e-3, Rq: float = 1e-6) -> Scan:
    """A Gaussian surface with waves from a quarter of its side on, as `points` see it: means over what one covers."""
    rng = np.random.default_rng(3)
    k = np.fft.fftfreq(full, 1 / full)
    q = np.hypot(k[:, None], k[None, :])
    amplitude = np.where((q >= 4) & (q <= full / 2), np.maximum(q, 1) ** -(hurst + 1), 0.0)
    z = np.fft.ifft2(amplitude * np.fft.fft2(rng.standard_normal((full, full)))).real
    z *= Rq / z.std()
    block = full // points
    z = z.reshape(points, block, points, block).mean(axis=(1, 3))
    return Scan(heights=z, spacing=(side / points, side / points), source=f"self-affine, Hurst {hurst}")


def scan_named(name: str, folder: Path) -> Scan:
    if name == "init":
        template.surface(folder / "surface.x3p")
        return faying.read_scan(folder / "surface.x3p")
    if name == "milled":
        return faying.read_scan(ROOT / "examples" / "t-specimen" / "milled.x3p")
    if name.startswith("Hurst"):
        return self_affine(256, float(name.split()[1]))
    file = DATA / ("opengps/SkiInfiniteFocus.x3p" if name == "ski" else f"nanovea-st400/{name}.csv")
    if not file.exists():
        pytest.skip("no measured scans: set FAYING_DATA")
    return faying.read_scan(file) if name == "ski" else faying.read_scan(file, xy_unit="mm", z_unit="um")


# Between solved pressures the loading curve is a monotone cubic, with pressures added until it is right to 1 % of what
# a threefold pressure closes. Where fewer than 10 spots touch it jumps as they merge, and the law says that it is not
# valid.
@pytest.mark.parametrize(
    "name",
    [
        pytest.param("init", marks=pytest.mark.slow),
        pytest.param("Hurst 0.5", marks=pytest.mark.slow),
        pytest.param("Hurst 0.8", marks=pytest.mark.slow),
        pytest.param("test1", marks=pytest.mark.slow),
        "test2",
        pytest.param("test4", marks=pytest.mark.slow),
        pytest.param("milled", marks=pytest.mark.slow),
        pytest.param("ski", marks=pytest.mark.slow),
    ],
)
def test_the_loading_stiffness_is_the_slope_of_the_solved_approach(name, tmp_path):
    law = Mates(scan_named(name, tmp_path), materials="45 steel").law("half-space")
    assert isinstance(law, HalfSpace)
    contact, approach, spots = None, [], []
    for p in PRESSURES:
        contact = law.contact_at(p, start=contact)
        approach.append(contact.approach)
        spots.append(contact.spots.count)
    compared = 0
    for i, (first, last) in enumerate(pairwise(PRESSURES)):
        if spots[i] < 10:
            assert not law.at_pressure(first).valid
            continue
        p = np.geomspace(first, last, 2000)
        closed = np.trapezoid(p / law.at_pressure(p).k_load, np.log(p))
        assert closed == pytest.approx(approach[i + 1] - approach[i], rel=0.01)
        assert closed == pytest.approx(float(law.closing(last) - law.closing(first)), rel=5e-3)
        compared += 1
    assert compared >= 1


@pytest.mark.slow
def test_a_joint_closes_as_the_solved_contact_does():
    law = Mates(self_affine(128, 0.8), materials="45 steel").law("half-space")
    joint = JointLaw(model=law)
    low, high = law.contact_at(5e6), law.contact_at(50e6)
    found = joint.approach(50e6) - joint.approach(5e6)
    assert found == pytest.approx(high.approach - low.approach, rel=0.03)


@pytest.mark.slow
def test_unloading_is_stiffer_than_loading_at_every_pressure():
    law = Mates(self_affine(128, 0.5), materials="45 steel").law("half-space")
    said = law.at_pressure(np.geomspace(law.least_pressure, law.greatest_pressure, 500))
    assert np.all(said.k_load <= said.k_n * (1 + 1e-12))
    loading = law.with_(stiffness="loading").at_pressure(20e6)
    assert loading.k_n == pytest.approx(float(law.at_pressure(20e6).k_load), rel=1e-6)


@pytest.mark.parametrize(
    ("hurst", "aim", "fixed_least"), [(0.8, 0.08, 0.08), pytest.param(0.5, 0.26, 0.3, marks=pytest.mark.slow)]
)
def test_hardness_by_size_lets_the_stiffness_settle_with_the_resolution(hurst, aim, fixed_least):
    """k_n at 10 MPa of 1024 over that of 256 points a side; with one hardness of 0.994 GPa it grows by more."""
    one_hardness = ContactPair(*(replace(STEEL, brinell=None, vickers=None),) * 2)
    growth = {}
    for name, pair in (("size", PAIR), ("one", one_hardness)):
        k_n = []
        for points in (256, 1024):
            scan = self_affine(points, hurst)
            law = HalfSpace(scan, pair, tol=1e-4)
            k_n.append(law.contact_at(10e6).normal_stiffness(loading=False))
        growth[name] = k_n[1] / k_n[0] - 1
    assert abs(growth["size"]) < aim
    assert growth["one"] > fixed_least
    assert growth["one"] > growth["size"]


def test_every_spot_has_the_hardness_of_its_size():
    scan = self_affine(256, 0.5)
    law = HalfSpace(scan, PAIR)
    contact = law.contact_at(20e6)
    size = PAIR.vickers
    spots = contact.spots
    plastic = contact.at_hardness
    assert plastic.any()
    expected = size.at(spots.diagonals)[spots.label[plastic] - 1]
    # the hardness is found to 1 % on average over the load
    load = contact.traction[plastic]
    assert np.average(np.abs(np.log(load / expected)), weights=load) < 0.01
    assert contact.residual < law.tol
    assert contact.pressure == pytest.approx(20e6, rel=1e-9)
    # from another start the same
    again = law.contact_at(20e6, start=law.contact_at(35e6))
    assert again.normal_stiffness(loading=False) == pytest.approx(contact.normal_stiffness(loading=False), rel=0.02)


@dataclass
class Pressed:
    """What a size of spots is asked of: points that all carry their hardness."""

    traction: np.ndarray
    spots: Spots

    @property
    def at_hardness(self) -> np.ndarray:
        return self.traction > 0


def test_a_hardness_that_would_alternate_settles_at_its_lower_value():
    size = PAIR.vickers
    # two spots of three points, which a bridge joins to one of seven under their hardness, and leaves under its own
    three, seven = (float(size.at(np.sqrt(2 * n * 1e-12))) for n in (3, 7))
    asked = []

    def solve(hardness, start):
        asked.append(float(hardness[0, 1]))
        touching = np.ones((1, 9), dtype=bool)
        touching[0, [0, 8]] = False
        touching[0, 4] = hardness[0, 1] > (three + seven) / 2
        return Pressed(hardness * touching, Spots.of(touching, (1e-6, 1e-6), periodic=False))

    contact = solve_with_size(solve, (1, 9), (1e-6, 1e-6), size, None)
    assert {three, seven} <= set(asked)
    assert asked[-1] == seven
    assert contact.spots.count == 2


def test_a_map_of_hardness_bounds_each_point():
    rng = np.random.default_rng(0)
    z = rng.standard_normal((48, 48)) * 1e-6
    hardness = np.where(np.arange(48) < 24, 1e9, 3e9) * np.ones((48, 1))
    contact = solve_half_space(z, 1e-6, E_star=110e9, pressure=200e6, hardness=hardness)
    assert np.all(contact.traction <= hardness * (1 + 1e-12))
    assert contact.traction[:, 24:].max() > 2e9
    assert contact.residual < 1e-6
    even = solve_half_space(z, 1e-6, E_star=110e9, pressure=200e6, hardness=np.full(z.shape, 1e9))
    one = solve_half_space(z, 1e-6, E_star=110e9, pressure=200e6, hardness=1e9)
    assert even.approach == pytest.approx(one.approach, rel=1e-4)
    assert even.saturated == pytest.approx(one.saturated, abs=2 / z.size)
    with pytest.raises(InputError, match="one for each point of the map"):
        solve_half_space(z, 1e-6, E_star=110e9, pressure=1e6, hardness=np.ones((3, 3)))
    with pytest.raises(InputError, match="not below the hardness"):
        solve_half_space(z, 1e-6, E_star=110e9, pressure=2.1e9, hardness=hardness)


def test_where_every_point_is_at_its_own_hardness_the_bound_is_tight():
    """A nearly closed map: no point is free, and the level of the bound is an order statistic weighted by hardness."""
    rng = np.random.default_rng(1)
    z = rng.standard_normal((32, 32)) * 1e-4
    hardness = rng.uniform(0.5e9, 1.5e9, z.shape)
    contact = solve_half_space(z, 1e-7, E_star=110e9, pressure=0.4 * hardness.mean(), hardness=hardness, tol=1e-4)
    assert contact.residual < 1e-4


def test_spots_join_across_the_borders_of_a_map_that_repeats():
    touching = np.zeros((6, 8), dtype=bool)
    touching[0, 1] = touching[5, 1] = True
    touching[2, 0] = touching[2, 7] = True
    touching[3, 4] = touching[4, 5] = True  # corners alone do not join
    assert Spots.of(touching, (2.0, 3.0), periodic=False).count == 6
    spots = Spots.of(touching, (2.0, 3.0), periodic=True)
    assert sorted(spots.points.tolist()) == [1, 1, 2, 2]
    assert spots.diagonals.max() == pytest.approx(np.sqrt(2 * 2 * 6.0))
    # two of one point, two of two: radii go with the root of the area
    assert spots.share_below(2) == pytest.approx(2 / (2 + 2 * np.sqrt(2)))
    law = VickersHardness(c1=6e9, c2=-0.25)
    at = spots.hardness(law)
    assert at[0, 1] == at[5, 1] == pytest.approx(float(law.at(spots.diagonals.max())))
    assert at[0, 6] == pytest.approx(float(law.at(np.sqrt(12.0))))


def test_one_given_hardness_is_that_of_all_spots():
    given = replace(STEEL, brinell=None, vickers=None)
    contact = HalfSpace(self_affine(64, 0.5), ContactPair(given, given)).contact_at(20e6)
    assert contact.traction.max() <= 0.994e9 * (1 + 1e-12)
    assert ContactPair(given, given).vickers is None


def test_the_softer_body_by_its_bulk_gives_the_hardness_over_size():
    soft, hard = CATALOGUE["EN AW-6082 T6"], STEEL
    for pair in (ContactPair(soft, hard), ContactPair(hard, soft)):
        assert pair.bulk_hardness == soft.brinell
        assert pair.vickers == soft.vickers
        assert pair.vickers.at(1e-6) == pytest.approx(soft.brinell)  # below the range of the fit: one hardness
    assert PAIR.hardness == 994e6  # that of the paper, for the analytic laws of single asperities
    assert PAIR.vickers.at(1e-6) == pytest.approx(6.2e9, rel=0.05)


@pytest.mark.slow
def test_range_widens_with_the_doubt_of_the_hardness():
    law = HalfSpace(self_affine(128, 0.5), PAIR, points=9)
    series = law.series
    assert np.all(series.doubt >= 0)
    middle = np.argmin(np.abs(series.pressure - 20e6))
    harder = replace(STEEL, brinell=None, vickers=PAIR.vickers.times(1.35), hardness=2e9)
    coarsest = halved_map(*halved_map(law.scan.heights, law.scan.spacing))
    k = [
        HalfSpace(law.scan, pair)._solve(*coarsest, float(series.pressure[middle])).normal_stiffness(loading=False)
        for pair in (PAIR, ContactPair(harder, harder))
    ]
    assert series.doubt[middle] > 0.3 * abs(np.log(k[1] / k[0]))
    assert np.all(series.least_factor(loading=False) < 1)
    assert np.all(series.greatest_factor(loading=False) > 1)


@pytest.mark.slow
def test_a_material_without_the_hardness_of_small_spots_is_said_with_its_key(tmp_path):
    """The same steel without brinell: softer spots, a stiffer law, and a sentence that names the key."""
    scan = scan_named("init", tmp_path)
    typed = replace(STEEL, name="typed", brinell=None, vickers=None)
    known = HalfSpace(pair=PAIR, scan=scan, lowest=5e6, highest=2e7)
    plain = HalfSpace(pair=ContactPair(typed, typed), scan=scan, lowest=5e6, highest=2e7)
    assert float(plain.at_pressure(1e7).k_n) > 1.05 * float(known.at_pressure(1e7).k_n)
    assert known.assumptions == ()
    (text,) = plain.assumptions
    assert "the spots have the hardness of typed" in text
    assert "give brinell" in text
