"""The contact law computed on a scan, and the contact of real scans at the hardness of steel."""

import os
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from faying.contact.law import ContactLaw
from faying.contact.models.half_space import HalfSpace
from faying.contact.pressure_series import is_twofold, quarters, solve_series
from faying.errors import InputError
from faying.halfspace import error_bound, solve_half_space
from faying.halfspace.solve import halved_map
from faying.materials import CATALOGUE, RIGID, ContactPair, Material
from tests.helpers.scans import gaussian

STEEL = replace(CATALOGUE["45 steel"], brinell=None, vickers=None)  # one hardness for spots of every size
PAIR = ContactPair(STEEL, RIGID)
N = 96


def scan_of(rough, n=N, seed=0, size=1e-3):
    return SimpleNamespace(heights=rough(n, seed) * size, spacing=(size / n, size / n))


@pytest.fixture(scope="module")
def law(rough):
    return HalfSpace(scan_of(rough), PAIR, points=8, lowest=2e6, highest=400e6)


def test_at_a_solved_pressure_the_law_is_the_contact_itself(law):
    for pressure in np.geomspace(2e6, 400e6, 8)[[0, 3, 7]]:
        said = law.at_pressure(pressure)
        contact = solve_half_space(
            law.scan.heights, law.scan.spacing, E_star=PAIR.E_star, pressure=pressure, hardness=PAIR.hardness
        )
        tangent = contact.tangent()
        assert isinstance(law, ContactLaw)
        assert said.area == pytest.approx(contact.area_corrected, rel=3e-3)  # a cell more or less, at another tolerance
        assert said.k_n == pytest.approx(tangent.k_n_unloading, rel=2e-3)
        assert said.k_t == pytest.approx(tangent.k_t, rel=2e-3)
        assert said.energy_n == pytest.approx(contact.elastic_energy, rel=1e-3)
        # a small swing of the load is elastic and without slip: no loss is predicted
        assert said.loss_n is None
        assert said.loss_t is None


def test_between_solved_pressures_the_law_is_near_the_contact(law):
    pressure = 37e6
    contact = law.contact_at(pressure)
    said = law.at_pressure(pressure)
    assert said.area == pytest.approx(contact.area_corrected, rel=0.05)
    assert said.k_n == pytest.approx(contact.tangent().k_n_unloading, rel=0.05)


def test_the_law_rises_with_pressure_and_keeps_shape(law):
    p = np.geomspace(2e6, 400e6, 12).reshape(3, 4)
    said = law.at_pressure(p)
    assert said.area.shape == (3, 4)
    assert said.pressure == pytest.approx(p, rel=1e-12)
    assert np.all(np.diff(said.area.ravel()) > 0)
    assert np.all(np.diff(said.k_n.ravel()) > 0)
    assert law.at_pressure(0.0).k_n == 0
    assert law.greatest_pressure == pytest.approx(400e6)


@pytest.mark.slow
def test_choices_of_area_and_stiffness(law):
    p = 100e6
    said = law.at_pressure(p)
    assert law.with_(area="counted").at_pressure(p).area > said.area
    first = law.with_(stiffness="loading").at_pressure(p)
    contact = law.contact_at(p)
    assert first.k_n < said.k_n
    assert first.loss_n == pytest.approx(contact.plastic_work / (2 * np.pi * contact.elastic_energy), rel=0.05)
    assert first.energy_n == pytest.approx(contact.plastic_work + contact.elastic_energy, rel=0.05)
    elastic = law.with_(elastic=True, stiffness="loading").at_pressure(p)
    assert elastic.loss_n == 0
    assert elastic.area < said.area


def test_shear_brings_loss_and_takes_stiffness(law):
    slipping = law.with_(points=4, shear_ratio=0.5)
    p, said = 80e6, law.at_pressure(80e6)
    under = slipping.at_pressure(p)
    assert 0 < under.k_t < said.k_t
    # Mindlin's sphere has the loss factor .0482 at X = .5 (his curve with Masing's rule); at hardness the pressure is
    # nearly even up to the rim, so less slips
    assert 0.0482 / 4 < under.loss_t < 0.0482
    assert under.energy_t > 0
    frictionless = ContactPair(Material(name="none", E=2e11, nu=0.3, hardness=1e9), RIGID)
    with pytest.raises(InputError, match="no friction coefficient"):
        slipping.with_(pair=frictionless)


def test_too_few_spots_and_closed_surfaces_are_flagged(rough):
    law = HalfSpace(scan_of(rough, 64), PAIR, points=5, lowest=1e4, highest=100e6)
    assert not law.at_pressure(2e4).valid
    assert law.at_pressure(100e6).valid
    smooth = SimpleNamespace(heights=rough(64) * 1e-6, spacing=(1e-3 / 64, 1e-3 / 64))
    closing = HalfSpace(smooth, PAIR, points=9, lowest=1e3, highest=800e6, elastic=True)
    # the law ends before the pressure at which every point touches, and where some are open still
    assert 1e3 < closing.greatest_pressure < 800e6
    last = closing.at_pressure(closing.greatest_pressure)
    assert last.area < 1
    assert np.isfinite(last.k_n)
    assert not np.isfinite(closing.contact_at(800e6).tangent().k_n_unloading)


def test_a_scan_that_does_not_resolve_its_stiffness_is_flagged(rough):
    words = "k_n changes by more than 25% on half the points each way"
    noise = SimpleNamespace(heights=np.random.default_rng(0).standard_normal((64, 64)) * 1e-6, spacing=(1e-6, 1e-6))
    law = HalfSpace(noise, PAIR, points=4, lowest=20e6, highest=400e6)
    pressure = np.geomspace(20e6, 400e6, 4)
    heights, spacing = halved_map(noise.heights, noise.spacing)
    coarse = replace(law, scan=SimpleNamespace(heights=heights, spacing=spacing))
    fine, half = (
        np.array([one.contact_at(float(p)).normal_stiffness(loading=False) for p in pressure]) for one in (law, coarse)
    )
    said = law.at_pressure(pressure)
    assert said.reasons[words].tolist() == (np.abs(np.log(half / fine)) > 0.25).tolist()
    assert said.reasons[words].any()
    smooth = HalfSpace(scan_of(rough, 256), PAIR, elastic=True, points=4, lowest=300e6, highest=900e6)
    assert not smooth.at_pressure(400e6).reasons[words]


def test_the_pair_enters_by_its_compliances():
    # two like bodies: half the modulus of one against a rigid plane, the same Poisson's ratio
    scan = SimpleNamespace(heights=np.eye(8), spacing=(1.0, 1.0))
    assert HalfSpace(scan, ContactPair(STEEL, STEEL)).nu == pytest.approx(STEEL.nu)
    assert HalfSpace(scan, PAIR).nu == pytest.approx(STEEL.nu)
    mixed = HalfSpace(
        scan, ContactPair(STEEL, CATALOGUE["S355"].__class__(name="rubber", E=1e7, nu=0.49, hardness=1e6))
    )
    assert mixed.nu == pytest.approx(0.49, abs=1e-4)
    # Mindlin's ratio 2 (1 - nu)/(2 - nu) from it equals 4 G*/E* of the pair: both are k_t over k_n of a round contact
    for pair in (PAIR, ContactPair(STEEL, STEEL), mixed.pair):
        nu = HalfSpace(scan, pair).nu
        assert 2 * (1 - nu) / (2 - nu) == pytest.approx(4 * pair.G_star / pair.E_star, rel=1e-12)


@pytest.mark.parametrize("n", [64, 65, 320, 321])
def test_a_map_on_its_mirror_image_has_two_quarters_not_four(rough, n):
    h = rough(n)
    laid = h + np.roll(h[:, ::-1], n // 2, axis=0)
    assert is_twofold(laid)
    assert not is_twofold(h)
    assert not is_twofold(h + rough(n, 1))
    assert not is_twofold(np.zeros((n, n)))

    def solve(heights, spacing, pressure, *, start, harder=1.0):
        spots = SimpleNamespace(count=heights.size, share_below=lambda points: 0.0)
        return SimpleNamespace(spots=spots, closing=np.log(pressure), k_n=pressure * heights.std())

    def numbers(contact, detail):
        return {"k_n": contact.k_n, "area": 1.0, "energy_n": 1.0}

    found = solve_series(laid, (1.0, 1.0), np.geomspace(1, 16, 5), solve, numbers)
    whole = halved_map(laid, (1.0, 1.0))[0] if n > 256 else laid
    one, other = (np.log(part.std()) for part, _ in quarters(whole, (1.0, 1.0))[:2])
    # the standard error of a mean of two is half of what they differ by; of four with copies it would be 1/sqrt 12
    error = np.hypot((one - other) / 2, (one + other) / 2 - np.log(whole.std()))
    assert found.window == pytest.approx(np.hypot(error, np.sqrt(2 / n**2)), rel=1e-6)


@pytest.mark.parametrize(
    ("change", "text"),
    [
        ({"stiffness": "sideways"}, 'allowed is "unloading" or "loading"'),
        ({"area": "none"}, 'allowed is "corrected" or "counted"'),
        ({"shear_ratio": 1.0}, "below 1"),
        ({"points": 3}, "a whole number, at least 4"),
        ({"points": 4.5}, "a whole number, at least 4"),
        ({"lowest": 0.0}, "must be positive"),
        ({"highest": 2e9}, "not below the hardness"),
    ],
)
def test_bad_parameters_are_named(change, text):
    scan = SimpleNamespace(heights=np.eye(8), spacing=(1.0, 1.0))
    with pytest.raises(InputError, match=text):
        HalfSpace(scan, PAIR, **change)


def test_below_its_least_pressure_the_law_says_so(law):
    with pytest.raises(InputError, match="below the least that half-space resolves"):
        law.at_pressure(1.0)


DATA = Path(os.environ.get("FAYING_DATA", Path(__file__).parents[2].parent / "shared" / "data")) / "scans"


@pytest.mark.parametrize("name", ["test1", "test2", "test4"])
def test_machined_steel_at_its_hardness(name):
    file = DATA / "nanovea-st400" / f"{name}.csv"
    if not file.exists():
        pytest.skip("no measured scans: set FAYING_DATA")
    z = np.loadtxt(file, delimiter=",")[:, 2].reshape(101, 101) * 1e-6  # the spike of test4 stays: it points down
    E_star = 220e9
    for pressure in (1e6, 30e6, 500e6):
        contact = solve_half_space(z, 5e-6, E_star=E_star, pressure=pressure, hardness=0.0045 * E_star)
        assert contact.residual < 1e-6
        assert contact.pressure == pytest.approx(pressure, rel=1e-9)
        assert error_bound(z, 5e-6, contact.traction, E_star=E_star, hardness=0.0045 * E_star) < 1e-6
        # nearly all that touches is at hardness: the area is little more than pressure over hardness
        assert 1 <= contact.area * 0.0045 * E_star / pressure < 1.1 + 4 / np.count_nonzero(contact.traction)


@pytest.mark.slow
def test_the_error_of_one_window_does_not_shrink_with_the_face():
    """A face of 16 windows has the mean k_n of all; one scanned window misses it as far as windows differ.

    Its range contains the mean. Divided by the root of 16 it would be too narrow: only a mean of 16 scans is so sure.
    """
    heights = gaussian(0.8, 0.125, 0.02, 1e-6, 1, points=256, side=1.0)
    pressure, n = 20e6, 64
    y, x = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n), indexing="ij")
    logs, errors = [], []
    for part in heights.reshape(4, n, 4, n).swapaxes(1, 2).reshape(16, n, n):
        flat = part - part.mean() - x * (x * part).mean() / (x * x).mean() - y * (y * part).mean() / (y * y).mean()
        scan = SimpleNamespace(heights=flat, spacing=(1e-3 / 256, 1e-3 / 256))
        series = HalfSpace(scan, PAIR, points=4, lowest=5e6, highest=80e6, tol=1e-3).series
        at = np.log(pressure), np.log(series.pressure)
        logs.append(np.interp(*at, np.log(series.values["k_n"])))
        errors.append(np.interp(*at, series.window))
    off, error = np.array(logs) - np.log(np.exp(logs).mean()), np.array(errors)
    assert np.mean(np.abs(off) < error) > 0.8
    assert np.sqrt(np.mean(off**2)) > np.sqrt(np.mean((error / 4) ** 2))
    assert np.mean(np.abs(off) < error / 4) < 0.68  # of a standard error that is right
