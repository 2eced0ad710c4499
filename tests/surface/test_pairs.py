"""Two surfaces combined, and their lay."""

import numpy as np
import pytest

from faying import InputError, fit_fractal
from faying.surface.combine import combine
from faying.surface.form import prepared
from faying.surface.synthesize import spectral


def moments(scan):
    """m0 [m2], m2 [-] and m4 [1/m2] of profiles along x and y, by finite differences on the levelled scan."""
    z, (dx, dy) = prepared(scan).scan.heights, scan.spacing
    m2, m4 = (
        np.mean([np.mean((np.diff(z, k, axis=1) / dx**k) ** 2), np.mean((np.diff(z, k, axis=0) / dy**k) ** 2)])
        for k in (1, 2)
    )
    return {"m0": z.var(), "m2": m2, "m4": m4}


def test_two_like_surfaces_add_up():
    # spectra of the same D add: G^(2D-4) is the sum of both
    D, Ga, Gb = 2.5, 1e-9, 3e-9
    a, b = (spectral((384, 384), spacing=1e-6, D=D, G=g, seed=s) for s, g in ((1, Ga), (2, Gb)))
    both = combine(a, b)
    expected = (Ga ** (2 * D - 4) + Gb ** (2 * D - 4)) ** (1 / (2 * D - 4))
    assert both.fit.D_interval[0] < D < both.fit.D_interval[1]
    assert both.fit.G_interval[0] < expected < both.fit.G_interval[1]
    parts = [moments(s) for s in (a, b)]
    for name in ("m0", "m2", "m4"):
        assert getattr(both, name) == pytest.approx(sum(p[name] for p in parts), rel=1e-12)
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
    assert combine(a, b).Rq == pytest.approx(moments(a)["m0"] ** 0.5, rel=1e-4)


def test_what_cannot_be_combined():
    a = spectral((128, 128), spacing=1e-6, D=2.4, Rq=1e-6)
    with pytest.raises(InputError, match="scan_b is a Profile"):
        combine(a, a.profile("x", 0))
    with pytest.raises(InputError, match="share no band"):
        combine(a, spectral((128, 128), spacing=1e-4, D=2.4, Rq=1e-6))
