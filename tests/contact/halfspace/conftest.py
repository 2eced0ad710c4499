import numpy as np
import pytest


def self_affine(n: int, seed: int = 0, *, hurst: float = 0.8, slope: float = 0.1) -> np.ndarray:
    """Random self-affine heights on a unit square, wave numbers 4 to n/8 per side, given rms slope."""
    white = np.fft.rfft2(np.random.default_rng(seed).standard_normal((n, n)))
    ky, kx = np.fft.fftfreq(n, 1 / n)[:, None], np.arange(n // 2 + 1)[None, :]
    k = np.hypot(kx, ky)
    k[0, 0] = np.inf
    spectrum = np.where((k >= 4) & (k <= n / 8), white * k ** -(1 + hurst), 0)
    dx, dy = (np.fft.irfft2(2j * np.pi * q * spectrum, s=(n, n)) for q in (kx, ky))
    return np.fft.irfft2(spectrum, s=(n, n)) * slope / np.sqrt((dx**2 + dy**2).mean())


@pytest.fixture(scope="session")
def rough():
    return self_affine
