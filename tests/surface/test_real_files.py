"""Every real scan read and analysed: sizes and heights as stated with the files."""

import importlib.util
import random

import numpy as np
import pytest

from faying import FayingError, InputError, ReadError, Scan, fit_fractal, read_scan
from faying.surface.form import levelled, prepared
from faying.surface.fractal import fit_all
from faying.surface.roughness import roughness

NANOVEA = {"xy_unit": "mm", "z_unit": "um"}
TOPOGRAPHY = importlib.util.find_spec("SurfaceTopography") is not None
needs_library = pytest.mark.skipif(not TOPOGRAPHY, reason="SurfaceTopography is not installed (group peers)")


@pytest.mark.parametrize("name", ["test1.csv", "test2.csv", "test4.csv"])
def test_nanovea_grid_and_missing_unit(scans, name):
    path = scans / "nanovea-st400" / name
    with pytest.raises(InputError, match="states no unit"):
        read_scan(path)
    scan = read_scan(path, **NANOVEA)
    assert scan.shape == (101, 101)
    assert scan.spacing == pytest.approx((5e-6, 5e-6), rel=1e-9)


# rms height after removal of a second-degree form, as stated with the files to two digits
@pytest.mark.parametrize(("name", "Sq"), [("test1.csv", 4.5e-6), ("test2.csv", 9.9e-6), ("test4.csv", 9.5e-6)])
def test_nanovea_heights(scans, name, Sq):
    ready = prepared(read_scan(scans / "nanovea-st400" / name, **NANOVEA), degree=2, spikes=False)
    assert roughness(ready).Sq == pytest.approx(Sq, rel=0.06)


def test_the_spike_of_test4_is_found(scans):
    scan = read_scan(scans / "nanovea-st400" / "test4.csv", **NANOVEA)
    row, column = np.unravel_index(np.argmin(scan.heights), scan.shape)
    assert levelled(scan).heights[row, column] == pytest.approx(-491e-6, rel=2e-3)
    ready = prepared(scan)
    assert not ready.known[row, column]
    assert np.abs(ready.scan.heights).max() < 60e-6


def test_ski_scan(scans):
    scan = read_scan(scans / "opengps" / "SkiInfiniteFocus.x3p")
    assert scan.shape == (940, 1197)
    assert scan.size == pytest.approx((4.40e-3, 3.46e-3), rel=2e-3)
    assert scan.missing / scan.heights.size == pytest.approx(0.004, abs=5e-4)
    assert roughness(scan).Sq == pytest.approx(18.1e-6, rel=5e-3)
    assert "Alicona" in scan.instrument.name


@needs_library
@pytest.mark.parametrize(
    ("name", "points", "size", "deviation", "degree"),
    [
        ("plu-1.plu", (576, 768), (1.275e-3, 0.956e-3), 18e-9, 2),
        ("metropro-1.dat", (480, 640), (0.703e-3, 0.527e-3), 75.3e-9, None),
        ("sur-2.sur", (484, 563), (1.96e-3, 1.69e-3), 11e-9, 2),
        ("al3d-1.al3d", (296, 200), (87.6e-6, 129.7e-6), 7.69e-6, None),
        ("al3d-1.al3d", (296, 200), (87.6e-6, 129.7e-6), 0.26e-6, 2),
        ("dektak-1.csv", (9600,), (1.5e-3,), None, 1),
        ("hfm-1.hfm", (9600,), (4.8e-3,), None, 1),
    ],
)
def test_other_instruments(scans, name, points, size, deviation, degree):
    scan = read_scan(scans / "surfacetopography" / name)
    assert scan.heights.shape == points
    assert (scan.size if isinstance(scan, Scan) else (scan.length,)) == pytest.approx(size, rel=4e-3)
    if degree is None:
        assert np.nanstd(scan.heights) == pytest.approx(deviation, rel=2e-3)
    elif deviation is not None:
        # stated to two digits after removal of form, spikes left in
        assert roughness(prepared(scan, degree=degree, spikes=False)).Rq == pytest.approx(deviation, rel=0.05)


@needs_library
def test_the_tip_radius_of_the_stylus_is_carried_along(scans):
    scan = read_scan(scans / "surfacetopography" / "dektak-1.csv")
    assert scan.instrument.tip_radius == pytest.approx(2.5e-6)


@needs_library
def test_units_against_a_file_that_states_them(scans):
    with pytest.raises(InputError, match="states its units"):
        read_scan(scans / "surfacetopography" / "plu-1.plu", xy_unit="mm", z_unit="um")


def real_files(scans):
    files = [(scans / "nanovea-st400" / f"test{i}.csv", NANOVEA) for i in (1, 2, 4)]
    files.append((scans / "opengps" / "SkiInfiniteFocus.x3p", {}))
    if TOPOGRAPHY:
        names = ("plu-1.plu", "metropro-1.dat", "sur-2.sur", "al3d-1.al3d", "dektak-1.csv", "hfm-1.hfm")
        files += [(scans / "surfacetopography" / name, {}) for name in names]
    return files


def test_every_file_gets_D_and_G_and_a_word_on_their_consistency(scans):
    for path, units in real_files(scans):
        scan = read_scan(path, **units)
        fit = fit_fractal(scan)
        low, high = fit.D_interval
        assert low < fit.D < high
        assert fit.Rq > fit.Ra > 0
        assert fit.band[0] < fit.band[1]
        if 2 < fit.D < 3:
            flagged = any("imply Rq" in word for word in fit.warnings)
            assert flagged == (not 0.5 < fit.implied_Rq / fit.Rq < 2)
        else:
            assert any("not fractal" in word for word in fit.warnings)


def test_all_estimators_answer_or_refuse_in_words(scans):
    scan = read_scan(scans / "nanovea-st400" / "test1.csv", **NANOVEA)
    for fit in fit_all(scan).values():
        assert isinstance(fit, str) or np.isfinite(fit.D)


def mutate(blob, rng):
    """Cut, flip, insert, repeat or blank a piece of a file."""
    kind = rng.choice(["cut", "head", "flip", "zero", "repeat", "swap"])
    at = rng.randrange(len(blob)) if rng.random() < 0.5 else rng.randrange(min(len(blob), 2000))
    span = rng.randrange(1, 200)
    if kind == "cut":
        return blob[:at]
    if kind == "head":
        return blob[at:]
    if kind == "flip":
        out = bytearray(blob)
        for _ in range(rng.randrange(1, 20)):
            out[rng.randrange(min(len(out), 3000) if rng.random() < 0.7 else len(out))] = rng.randrange(256)
        return bytes(out)
    if kind == "zero":
        return blob[:at] + b"\0" * span + blob[at + span :]
    if kind == "repeat":
        return blob[:at] + blob[at : at + span] * rng.randrange(2, 5) + blob[at + span :]
    return blob[at:] + blob[:at]


def fuzz(scans, tmp_path, rounds, seed):
    rng = random.Random(seed)
    read, words = 0, []
    for path, units in real_files(scans):
        blob = path.read_bytes()
        for number in range(rounds):
            broken = tmp_path / f"{number}{path.suffix}"
            broken.write_bytes(mutate(blob, rng))
            try:
                scan = read_scan(broken, **units)
                assert np.isfinite(scan.heights).any()
                read += 1
            except InputError as fault:  # ReadError is one; anything else is a traceback for the user
                words.append(str(fault))
            broken.unlink()
    assert words
    assert all(len(text) > 20 for text in words)
    assert read + len(words) == rounds * len(real_files(scans))


def test_mutated_files_are_read_or_refused_in_words(scans, tmp_path):
    fuzz(scans, tmp_path, 2, 1)


@pytest.mark.slow
def test_many_mutated_files(scans, tmp_path):
    fuzz(scans, tmp_path, 40, 2)


def test_fits_of_mutated_text_scans_end_in_words(scans):
    rng = np.random.default_rng(5)
    scan = read_scan(scans / "nanovea-st400" / "test2.csv", **NANOVEA)
    for _ in range(10):
        z = scan.heights.copy()
        rows = rng.integers(0, 101, 30)
        z[rows] = rng.choice([np.nan, 1.0, -1e-3])
        try:
            assert np.isfinite(fit_fractal(scan.with_heights(z)).D)
        except FayingError:
            continue


def test_the_same_reading_without_the_library(scans, monkeypatch):
    from faying.surface.files import instruments

    monkeypatch.setattr(instruments, "_library", lambda: None)
    with pytest.raises(ReadError, match=r"install SurfaceTopography \(pip install SurfaceTopography\)"):
        read_scan(scans / "surfacetopography" / "plu-1.plu")
