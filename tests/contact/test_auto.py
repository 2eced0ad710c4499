"""The law that is taken where none is named, and its range, on surfaces of known make."""

import numpy as np
import pytest

import faying
from faying.contact.auto import CLOSE, pick
from faying.contact.inputs import FractalSurface, RoughSurface
from faying.contact.models.half_space import HalfSpace
from faying.contact.stability import COARSE, FULL, stability
from faying.contact.two_faces import faces_of
from faying.errors import InputError
from faying.surface.scan import Scan
from tests.helpers.scans import averaged, gaussian, twenty

STEEL = faying.CATALOGUE["45 steel"]
PAIR = faying.ContactPair(STEEL, STEEL)
MIDDLE = 1e-2 * PAIR.bulk_hardness  # where `pick` compares


def count_inside(seed, pressures, thin, step=1):
    """Surfaces whose k_n at four times the resolution lies in the range stated on the scan; the worst ratios."""
    inside, taken = 0, []
    for name, fine, scan in list(twenty(seed))[::step]:
        if thin > 1:
            fine, scan = (
                Scan(heights=averaged(s.heights, thin), spacing=(thin * s.spacing[0],) * 2, source=name)
                for s in (fine, scan)
            )
        surface = faces_of(scan, "smooth").rough
        choice = pick("auto", {}, surface, PAIR)
        exact = HalfSpace(surface.scan, PAIR)
        asked = np.minimum(pressures, 0.8 * exact.greatest_pressure)  # some maps touch everywhere below ten times it
        said = exact.at_pressure(asked)
        truth = HalfSpace(faces_of(fine, "smooth").rough.scan, PAIR)
        known = np.array([truth.contact_at(p).normal_stiffness(loading=False) for p in asked])
        inside += bool(np.all((said.k_n_low <= known) & (known <= said.k_n_high)))
        if choice.law.name != exact.name:
            taken.append(float(choice.law.at_pressure(MIDDLE).k_n / exact.at_pressure(MIDDLE).k_n))
        assert choice.reason
    return inside, taken


@pytest.mark.slow
@pytest.mark.parametrize(("step", "count"), [(5, 4), (1, 20)])
def test_the_range_holds_the_stiffness_at_four_times_the_resolution(step, count):
    """Surfaces of other seeds than those on which the range was made."""
    inside, taken = count_inside(300, [MIDDLE], 2, step)
    assert inside >= int(0.9 * count)
    assert all(1 / CLOSE <= ratio <= CLOSE for ratio in taken)


@pytest.mark.slow
@pytest.mark.parametrize("seed", [100, 200])
def test_the_range_holds_on_larger_maps_and_over_two_decades(seed):
    assert count_inside(seed, [MIDDLE], 1)[0] >= 18
    assert count_inside(seed, [MIDDLE, 10 * MIDDLE], 1)[0] >= 17


@pytest.mark.slow
def test_the_default_does_not_hang_on_the_window():
    """Parts of .5, 1 and 2 mm of one stationary surface, at equal sampling; JK moves by factors."""
    z = gaussian(0.8, 0.04e-3, 6e-6, 1e-6, 11, points=1024, side=2e-3)
    scan = Scan(heights=z, spacing=(2e-3 / 1024,) * 2)
    k_n = {"auto": [], "jk": []}
    for share in (0.25, 0.5, 1.0):
        for model, row in k_n.items():
            law = faying.Mates(scan.cropped(share), materials=PAIR, other="smooth").law(model)
            row.append(float(law.at_pressure(MIDDLE).k_n))
    assert max(k_n["auto"]) / min(k_n["auto"]) < 1.1
    assert max(k_n["jk"]) / min(k_n["jk"]) > 1.5


def test_where_the_scan_is_too_coarse_a_closed_law_near_it_stands_in_for_the_contact():
    """A map of 40 by 40 points, of which 16 touch at a hundredth of the hardness."""
    z = gaussian(0.8, 0.06e-3, 0, 0.5e-6, 4, points=40, side=0.5e-3)
    surface = faces_of(Scan(heights=z, spacing=(0.5e-3 / 40,) * 2), "smooth").rough
    choice = pick("auto", {}, surface, PAIR)
    exact = HalfSpace(surface.scan, PAIR).at_pressure(MIDDLE)
    assert not exact.valid
    words = any(text in choice.reason for text in ("fewer than 10 spots", "more than 25%", "fewer than 4 points"))
    assert words
    near = [r for r in choice.ratios.values() if 1 / CLOSE <= r <= CLOSE]
    if choice.law.name.startswith("GW"):
        assert choice.law.at_pressure(MIDDLE).k_n / exact.k_n == pytest.approx(1, abs=CLOSE - 1)
    else:
        assert "no analytic law is within 30%" in choice.reason
    assert len(near) <= len(choice.ratios) == 4


def test_d_and_g_alone_give_jk_and_no_surface_is_refused():
    surface = RoughSurface(inputs=FractalSurface(D=2.39, G=1.53e-10, scan_area=16e-6))
    choice = pick("auto", {}, surface, PAIR)
    assert choice.law == faying.JK(D=2.39, G=1.53e-10, scan_area=16e-6, pair=PAIR)
    assert "no areal scan" in choice.reason
    with pytest.raises(InputError, match="give \\[surface\\] with a scan"):
        pick("auto", {}, None, PAIR)
    named = pick("jk", {}, surface, PAIR)
    assert (named.law, named.reason) == (choice.law, "")


def test_rubber_has_no_hardness_and_meets_elastically():
    rubber = faying.Material(name="rubber", E=2e6, nu=0.49, density=1100, hardness=np.inf)
    pair = faying.ContactPair(rubber, faying.RIGID)
    z = gaussian(0.8, 0.06e-3, 8e-6, 1e-6, 5, points=128, side=0.5e-3)
    scan = Scan(heights=z, spacing=(0.5e-3 / 128,) * 2)
    law = faying.Mates(scan, materials=pair, other="smooth").law()
    assert law.name == "half-space"
    p = law.greatest_pressure / 10
    assert law.contact_at(p).plastic_work == 0
    # Persson: k_n = p/(gamma h_rms) with gamma .4 to .5 where the waves are short beside the window
    assert law.at_pressure(p).k_n * 1e-6 / p == pytest.approx(2.2, rel=0.35)


@pytest.mark.slow
def test_a_series_is_stored_beside_the_scan_and_read_again(tmp_path, monkeypatch):
    monkeypatch.delenv("FAYING_CACHE", raising=False)
    z = gaussian(0.8, 0.06e-3, 8e-6, 1e-6, 6, points=64, side=0.5e-3)
    scan = Scan(heights=z, spacing=(0.5e-3 / 64,) * 2)
    few = {"points": 5, "lowest": MIDDLE / 2, "highest": 2 * MIDDLE, "cache": tmp_path / "kept"}
    solved = []
    law = HalfSpace(scan, PAIR, progress=lambda done, total: solved.append((done, total)), **few)
    first = law.at_pressure(MIDDLE)
    assert solved[-1][0] == solved[-1][1] == len(solved) - 1  # the last call says that all is done
    (file,) = (tmp_path / "kept").iterdir()
    count = len(solved)
    again = law.with_(points=law.points).at_pressure(MIDDLE)
    assert len(solved) == count
    assert again.k_n == first.k_n
    assert again.k_n_low == first.k_n_low
    law.with_(tol=1e-4).series  # noqa: B018  # another question is another file
    assert len(solved) > count
    assert len(list((tmp_path / "kept").iterdir())) == 2
    file.write_bytes(file.read_bytes()[:500])  # damaged: solved anew
    count = len(solved)
    assert law.with_().at_pressure(MIDDLE).k_n == first.k_n
    assert len(solved) > count
    monkeypatch.setenv("FAYING_CACHE", "off")
    count = len(solved)
    assert law.with_().at_pressure(MIDDLE).k_n == first.k_n
    assert len(solved) > count


def test_the_stiffness_of_one_contact_is_kept_and_read_again(tmp_path, monkeypatch):
    monkeypatch.delenv("FAYING_CACHE", raising=False)
    z = gaussian(0.8, 0.06e-3, 8e-6, 1e-6, 6, points=64, side=0.5e-3)
    law = HalfSpace(Scan(heights=z, spacing=(0.5e-3 / 64,) * 2), PAIR, cache=tmp_path / "kept")
    first = law.stiffness_of_contact(MIDDLE)
    assert first == law.contact_at(MIDDLE).normal_stiffness(loading=False)
    assert law.stiffness_of_contact(1.1 * MIDDLE) != first
    assert law.with_(stiffness="loading").stiffness_of_contact(MIDDLE) != first
    assert len(list((tmp_path / "kept").iterdir())) == 3

    def solved(*_, **__):
        raise AssertionError("solved again")

    monkeypatch.setattr(HalfSpace, "contact_at", solved)
    assert law.with_().stiffness_of_contact(MIDDLE) == first


def test_stability_asks_each_part_as_a_scan_of_its_own():
    z = gaussian(0.8, 0.06e-3, 8e-6, 1e-6, 7, points=128, side=0.5e-3)
    scan = Scan(heights=z, spacing=(0.5e-3 / 128,) * 2)
    found = stability(faying.Mates(scan, materials=PAIR), model="jk", pressure=1e6)
    for share, name in ((1.0, FULL), (0.5, "half window")):
        law = faying.Mates(scan.cropped(share), materials=PAIR).law("jk")
        assert found.k_n[name] == pytest.approx(float(law.at_pressure(1e6).k_n), rel=1e-9)
    assert not found.stable
    exact = stability(faying.Mates(scan, materials=PAIR, other="smooth"), model="half-space", pressure=MIDDLE)
    coarse = Scan(heights=averaged(faces_of(scan, "smooth").rough.scan.heights, 2), spacing=(scan.spacing[0] * 2,) * 2)
    law = HalfSpace(faces_of(coarse, "smooth").rough.scan, PAIR)
    assert exact.k_n[COARSE] == pytest.approx(law.contact_at(MIDDLE).normal_stiffness(loading=False), rel=1e-6)
    assert exact.worst[1] != 1


@pytest.mark.slow
def test_large_maps_are_solved_at_fewer_pressures_and_answer_alike():
    """The ladder of a map above 256 points a side, against contacts between and on its rungs."""
    z = gaussian(0.8, 0.06e-3, 8e-6, 1e-6, 8, points=288, side=1e-3)
    law = HalfSpace(Scan(heights=z, spacing=(1e-3 / 288,) * 2), PAIR, lowest=2e6, highest=200e6)
    for p in (6e6, 20e6, 70e6):
        contact = law.contact_at(p)
        tangent = contact.tangent()
        said = law.at_pressure(p)
        assert said.k_n == pytest.approx(tangent.k_n_unloading, rel=0.04)
        assert said.k_t / said.k_n == pytest.approx(tangent.k_t / tangent.k_n_unloading, rel=0.01)
        assert said.area == pytest.approx(contact.area_corrected, rel=0.04)
