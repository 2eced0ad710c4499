"""The self-affine maps that half-space solvers are compared on, for the benchmark and the tests."""

import numpy as np

from faying.surface.synthesize import spectral


def self_affine(n: int, seed: int = 1, *, hurst: float = 0.8, slope: float = 0.1) -> np.ndarray:
    """Random self-affine heights on a unit square, wave numbers 4 to n/8 per side, rms gradient `slope`.

    Seed 1 gives the reference maps: real areas .0468, .2082 (n 512, p/E* .002, .01), .0444, .2040, .3782 (n 1024,
    p/E* .002, .01, .02).
    """
    heights = spectral((n, n), spacing=1 / n, D=3 - hurst, Rq=1.0, shortest=8 / n, periodic=True, seed=seed).heights
    spectrum = np.fft.rfft2(heights)
    ky, kx = np.fft.fftfreq(n, 1 / n)[:, None], np.arange(n // 2 + 1)[None, :]
    spectrum[np.hypot(kx, ky) < 4] = 0.0  # `spectral` rolls off to a plateau; these maps have no longer waves
    dx, dy = (np.fft.irfft2(2j * np.pi * q * spectrum, s=(n, n)) for q in (kx, ky))
    return np.fft.irfft2(spectrum, s=(n, n)) * slope / np.sqrt((dx**2 + dy**2).mean())
