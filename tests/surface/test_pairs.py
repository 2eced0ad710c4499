"""Two surfaces combined; lay and summits; a second reader's opinion."""

import numpy as np
import pytest

from faying import InputError, Scan, fit_fractal
from faying.surface.combine import combine
from faying.surface.lay import find_lay
from faying.surface.summits import cutoff_study, summits
from faying.surface.synthesize import spectral


def test_two_like_surfaces_add_up():
    # spectra of the same D add: G^(2D-4) is the sum of both
    D, Ga, Gb = 2.5, 1e-9, 3e-9
    a, b = (spectral((384, 384), spacing=1e-6, D=D, G=g, seed=s) for s, g in ((1, Ga), (2, Gb)))
    both = combine(a, b)
    expected = (Ga ** (2 * D - 4) + Gb ** (2 * D - 4)) ** (1 / (2 * D - 4))
    assert both.fit.D_interval[0] < D < both.fit.D_interval[1]
    assert both.fit.G_interval[0] < expected < both.fit.G_interval[1]
    parts = [summits(s) for s in (a, b)]
    for name in ("m0", "m2", "m4"):
        assert getattr(both, name) == pytest.approx(sum(getattr(p, name) for p in parts), rel=1e-12)
    assert both.Rq == pytest.approx(both.m0**0.5)


def test_combining_is_symmetric_and_works_across_sizes():
    a = spectral((256, 256), spacing=1e-6, D=2.4, Rq=1e-6, seed=1)
    b = spectral((300, 200), spacing=(1.5e-6, 1.5e-6), D=2.4, Rq=1e-6, seed=2)
    ab, ba = combine(a, b).fit, combine(b, a).fit
    assert pytest.approx(ba.D, abs=0.05) == ab.D
    assert np.log(ab.G) == pytest.approx(np.log(ba.G), abs=2.5)


def test_a_smooth_partner_changes_nothing():
    a = spectral((256, 256), spacing=1e-6, D=2.5, Rq=1e-6, seed=1)
    b = spectral((256, 256), spacing=1e-6, D=2.5, Rq=1e-9, seed=2)
    assert pytest.approx(fit_fractal(a).D, abs=0.01) == combine(a, b).fit.D
    assert combine(a, b).Rq == pytest.approx(summits(a).m0 ** 0.5, rel=1e-4)


def test_what_cannot_be_combined():
    a = spectral((128, 128), spacing=1e-6, D=2.4, Rq=1e-6)
    with pytest.raises(InputError, match="scan_b is a Profile"):
        combine(a, a.profile("x", 0))
    with pytest.raises(InputError, match="share no band"):
        combine(a, spectral((128, 128), spacing=1e-4, D=2.4, Rq=1e-6))


@pytest.mark.parametrize("angle", [0.0, 0.6, 1.5, 2.6])
def test_the_lay_is_found(angle):
    lay = find_lay(spectral((256, 256), spacing=1e-6, D=2.4, Rq=1e-6, lay=(angle, 2.0), seed=3))
    assert lay.present
    assert abs((lay.angle - angle + np.pi / 2) % np.pi - np.pi / 2) < 0.08


def test_an_isotropic_surface_has_none():
    for seed in range(5):
        scan = spectral((192, 192), spacing=1e-6, D=2.4, Rq=1e-6, seed=seed)
        assert not find_lay(scan).present


def test_moments_and_summits_of_an_egg_box():
    n, wave, a = 240, 24, 1e-6
    y, x = np.mgrid[0:n, 0:n]
    z = a * np.cos(2 * np.pi * (x + 0.5) / wave) * np.cos(2 * np.pi * (y + 0.5) / wave)
    s = summits(Scan(heights=z, spacing=(1e-6, 1e-6)))
    k = 2 * np.pi / (wave * 1e-6)
    assert s.m0 == pytest.approx(a**2 / 4, rel=1e-3)
    assert s.m2 == pytest.approx(a**2 * k**2 / 4, rel=0.02)
    assert s.m4 == pytest.approx(a**2 * k**4 / 4, rel=0.03)


def test_summits_of_a_gaussian_surface_follow_nayak():
    # a band-limited isotropic surface, well sampled: Nayak's density of summits is m4/(6 pi 3^.5 m2)
    scan = spectral((512, 512), spacing=1e-6, D=2.3, Rq=1e-6, shortest=12e-6, longest=24e-6, periodic=True, seed=4)
    s = summits(scan)
    assert s.density == pytest.approx(s.m4 / s.m2 / (6 * np.pi * 3**0.5), rel=0.06)
    assert s.bandwidth > 1.5
    # mean curvature of summits and their mean height are positive, and the radius fits (3 pi^.5/8) / m4^.5 roughly
    assert s.radius == pytest.approx(3 * np.pi**0.5 / 8 / s.m4**0.5, rel=0.25)
    assert s.mean_height > 0


def test_moments_depend_on_the_cutoff_as_a_fractal_s_do():
    D = 2.4
    scan = spectral((512, 512), spacing=1e-6, D=D, Rq=1e-6, seed=1)
    cutoffs, found = cutoff_study(scan, [6e-6, 12e-6, 24e-6])
    m2 = [s.m2 for s in found]
    slope = np.polyfit(np.log(cutoffs), np.log(m2), 1)[0]
    # m2 ~ cutoff^-(2D-4)
    assert slope == pytest.approx(-(2 * D - 4), abs=0.15)
    assert found[0].density > 3 * found[2].density
    assert len(cutoff_study(scan)[0]) == 4


def test_a_plane_has_no_summit():
    x = np.arange(32) * 1e-6
    ramp = Scan(heights=np.tile(np.exp(x / 1e-5) * 1e-6, (32, 1)), spacing=(1e-6, 1e-6))
    with pytest.raises(InputError, match="no summit"):
        summits(ramp)
