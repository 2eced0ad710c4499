"""Surfaces and profiles of known D and G: spectral (Gaussian) and Weierstrass-Mandelbrot."""

from math import floor, log, pi

import numpy as np

from faying.checks import number, whole
from faying.errors import InputError
from faying.surface.convention import check_dimension, prefactor
from faying.surface.scan import Profile, Scan
from faying.surface.synthesis import MAX_POINTS, Seed, generator_of, grid_of, spectral_heights
from faying.surface.synthesis import with_missing as with_missing
from faying.surface.synthesis import with_noise as with_noise
from faying.typing import Array


def _output(z: Array, steps: tuple[float, ...], source: str) -> Scan | Profile:
    if z.ndim == 1:
        return Profile(heights=z, spacing=steps[0], source=source)
    return Scan(heights=z, spacing=(steps[1], steps[0]), source=source)


def spectral(
    shape: int | tuple[int, int],
    *,
    spacing: float | tuple[float, float],
    D: float,
    G: float | None = None,
    Rq: float | None = None,
    longest: float | None = None,
    shortest: float | None = None,
    lay: tuple[float, float] | None = None,
    periodic: bool = False,
    convention: str = "yan-komvopoulos",
    gamma: float = 1.5,
    seed: Seed = 0,
) -> Scan | Profile:
    """Return Gaussian heights whose spectrum is S(f) = c G^(2Ds-2)/2 f^-(5-2Ds) (see `faying.surface.convention`).

    Args:
        shape: (ny, nx) for a Scan, n for a Profile.
        spacing: distance between points [m], one number or (dx, dy).
        D: dimension of the surface, 2 < D < 3; a profile has Ds = D - 1.
        G: fractal roughness [m]; or
        Rq: rms height [m] to which the heights are scaled. Give one of the two.
        longest: wavelength [m] beyond which the spectrum is a plateau (default: none).
        shortest: wavelength [m] where the spectrum ends (default: the Nyquist wavelength, in a circle).
        lay: (angle [rad] from x, stretch >= 1); wavelengths along the angle are longer by the stretch than those
            across it, the power of all directions together being that of G.
        periodic: repeat over the window; else the heights are cut from a surface twice as long each way.
        convention: of G, as in `fit_fractal`.
        gamma: ratio of neighbouring frequencies in that series, above 1.
        seed: of the random phases, or a generator.

    Returns:
        Scan, or Profile where `shape` is one number.

    Raises:
        InputError: for D outside (2, 3), both or neither of G and Rq, and values that are not positive.
    """
    return _output(*spectral_heights(**locals()))


def weierstrass_mandelbrot(
    shape: int | tuple[int, int],
    *,
    spacing: float | tuple[float, float],
    D: float,
    G: float,
    gamma: float = 1.5,
    ridges: int = 10,
    length: float | None = None,
    shortest: float | None = None,
    convention: str = "yan-komvopoulos",
    seed: Seed | None = 0,
) -> Scan | Profile:
    """Return the Weierstrass-Mandelbrot surface of Yan and Komvopoulos, or its profile.

    z = L (G/L)^(D-2) (ln gamma / M)^(1/2) sum_m sum_n gamma^((D-3)n) {cos phi_mn - cos[2 pi gamma^n r/L cos(theta -
    pi m/M) + phi_mn]}, n from 0 to log(L/shortest)/log(gamma).

    Args:
        shape: (ny, nx) for a Scan, n for a Profile.
        spacing: distance between points [m], one number or (dx, dy).
        D: dimension of the surface, 2 < D < 3; a profile has Ds = D - 1.
        G: fractal roughness [m].
        gamma: ratio of neighbouring frequencies, above 1.
        ridges: M, the number of directions, 1 or more; a profile has one.
        length: L [m], the longest wavelength (default: the longest side).
        shortest: shortest wavelength [m] (default: twice the coarser spacing).
        convention: "majumdar-bhushan" leaves out the factor (ln gamma)^(1/2).
        seed: of the uniform phases, or a generator; None sets all phases to zero.

    Returns:
        Scan, or Profile where `shape` is one number.

    Raises:
        InputError: for D outside (2, 3), gamma <= 1, and lengths that are not positive.

    Source:
        doi:10.1063/1.368536, eq. (5).
    """
    check_dimension(D)
    c = prefactor(convention, gamma)
    counts, steps = grid_of(shape, spacing)
    G = number(G, "G", "m", least=0)
    side = max(n * d for n, d in zip(counts, steps, strict=True))
    L = side if length is None else number(length, "length", "m", least=0)
    end = 2 * max(steps) if shortest is None else number(shortest, "shortest", "m", least=0)
    whole(ridges, "ridges", least=1, greatest=MAX_POINTS)
    if not end < L:
        raise InputError(f"shortest = {end:.4g} m, length = {L:.4g} m: the shortest wavelength is below the longest")
    M = ridges if len(counts) == 2 else 1
    n = np.arange(floor(log(L / end) / log(gamma) + 1e-12) + 1)
    rng = generator_of(seed if seed is not None else 0)
    phase = rng.uniform(0, 2 * pi, (M, len(n))) if seed is not None else np.zeros((M, len(n)))
    # c ln(gamma) is ln(gamma) for Yan-Komvopoulos and 1 for Majumdar-Bhushan
    amplitude = L * (G / L) ** (D - 2) * (c * log(gamma) / M) ** 0.5 * gamma ** ((D - 3) * n)  # eq. (5)
    k = np.asarray(2 * pi / L * gamma**n, np.float64)
    z = float(np.sum(amplitude * np.cos(phase))) - _waves(k, amplitude, phase, counts, steps)
    what = "surface" if len(counts) == 2 else "profile"
    return _output(z, steps, f"Weierstrass-Mandelbrot {what}, D {D}, G {G:.4g} m, gamma {gamma}, {convention}")


def _waves(k: Array, amplitude: Array, phase: Array, counts: tuple[int, ...], steps: tuple[float, ...]) -> Array:
    """Sum of cosines of wave numbers k [rad/m] in as many directions as `phase` (directions, waves) has rows."""
    weight, shift = np.broadcast_to(amplitude, phase.shape).ravel(), phase.ravel()
    x = np.arange(counts[-1]) * steps[-1]
    if len(counts) == 1:
        return np.asarray(np.cos(np.outer(x, k) + shift) @ weight)
    direction = pi * np.arange(len(phase))[:, None] / len(phase)
    kx, ky = (k * np.cos(direction)).ravel(), (k * np.sin(direction)).ravel()
    # cos(a + b) = cos a cos b - sin a sin b makes the double sum two matrix products
    a, b = np.outer(np.arange(counts[0]) * steps[0], ky) + shift, np.outer(kx, x)
    return np.asarray((np.cos(a) * weight) @ np.cos(b) - (np.sin(a) * weight) @ np.sin(b))
