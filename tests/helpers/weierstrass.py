"""The surface of Weierstrass and Mandelbrot: fractal heights that are not Gaussian, of known D and G."""

from math import floor, log, pi

import numpy as np

from faying.surface.convention import prefactor
from faying.surface.scan import Profile, Scan


def weierstrass_mandelbrot(
    shape, *, spacing, D, G, gamma=1.5, ridges=10, length=None, shortest=None, convention="yan-komvopoulos", seed=0
):
    """A Scan of (ny, nx) points or a Profile of n, one spacing [m] in all directions; seed None: phases of zero.

    z = L (G/L)^(D-2) (ln gamma / M)^(1/2) sum_m sum_n gamma^((D-3)n) {cos phi_mn - cos[2 pi gamma^n r/L cos(theta -
    pi m/M) + phi_mn]}, n from 0 to log(L/shortest)/log(gamma); doi:10.1063/1.368536, eq. (5).
    """
    counts = shape if isinstance(shape, tuple) else (shape,)
    M = ridges if len(counts) == 2 else 1
    L = max(counts) * spacing if length is None else length
    n = np.arange(floor(log(L / (shortest or 2 * spacing)) / log(gamma) + 1e-12) + 1)
    phase = np.zeros((M, len(n))) if seed is None else np.random.default_rng(seed).uniform(0, 2 * pi, (M, len(n)))
    # c ln(gamma) is ln(gamma) for Yan-Komvopoulos and 1 for Majumdar-Bhushan
    amplitude = L * (G / L) ** (D - 2) * (prefactor(convention, gamma) * log(gamma) / M) ** 0.5 * gamma ** ((D - 3) * n)
    k, angle = 2 * pi / L * gamma**n, pi * np.arange(M)[:, None] / M
    weight, shift = np.broadcast_to(amplitude, phase.shape).ravel(), phase.ravel()
    start, x = np.sum(amplitude * np.cos(phase)), np.arange(counts[-1]) * spacing
    if len(counts) == 1:
        return Profile(heights=start - np.cos(np.outer(x, k) + shift) @ weight, spacing=spacing)
    kx, ky = (k * np.cos(angle)).ravel(), (k * np.sin(angle)).ravel()
    # cos(a + b) = cos a cos b - sin a sin b makes the double sum two matrix products
    a, b = np.outer(np.arange(counts[0]) * spacing, ky) + shift, np.outer(kx, x)
    waves = (np.cos(a) * weight) @ np.cos(b) - (np.sin(a) * weight) @ np.sin(b)
    return Scan(heights=start - waves, spacing=(spacing, spacing))
