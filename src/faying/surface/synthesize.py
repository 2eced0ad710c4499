"""Surfaces and profiles of known D and G: spectral (Gaussian) and Weierstrass-Mandelbrot."""

from math import ceil, cos, floor, log, pi, sin

import numpy as np

from faying.errors import InputError
from faying.surface.convention import G_from_Rq, check_dimension, density, prefactor
from faying.surface.scan import Profile, Scan
from faying.typing import Array


def _grid(
    shape: int | tuple[int, int], spacing: float | tuple[float, float]
) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Counts and spacings in the order of the axes of the heights (y, x), or (x,)."""
    counts = (shape,) if isinstance(shape, int) else tuple(shape)
    steps = tuple(float(s) for s in spacing) if isinstance(spacing, (tuple, list)) else (float(spacing),) * len(counts)
    if len(counts) not in (1, 2) or min(counts) < 2:
        raise InputError(f"shape = {shape!r}: give (ny, nx) for a scan or n for a profile, 2 points at least")
    if len(steps) != len(counts) or min(steps) <= 0:
        raise InputError(f"spacing = {spacing!r}: give positive distances in metres, one or (dx, dy)")
    return counts, steps[::-1]


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
    seed: int | np.random.Generator = 0,
) -> Scan | Profile:
    """Return Gaussian heights whose spectrum is S(f) = c G^(2Ds-2)/2 f^-(5-2Ds) (see `faying.surface.convention`).

    `shape` = (ny, nx) for a Scan, n for a Profile; `spacing` [m]. Give `G` [m], or `Rq` [m]: then the heights are
    scaled to that rms value. `longest` and `shortest` [m] are the wavelengths where the law rolls off to a plateau and
    where it ends (default: none; the Nyquist wavelength of the grid, in a circle). `lay` = (angle [rad], stretch >= 1):
    wavelengths along the angle (from x) are longer by the stretch than those across it, the power of all directions
    together being that of G.
    `periodic` makes a surface that repeats over the window; else it is cut from one twice as long each way.
    Raises InputError for D outside (2, 3), both or neither of G and Rq, and values that are not positive.
    """
    check_dimension(D)
    counts, steps = _grid(shape, spacing)
    if (G is None) == (Rq is None):
        raise InputError("give either G (fractal roughness, metres) or Rq (rms height, metres), one of them")
    for name, value in (("G", G), ("Rq", Rq), ("longest", longest), ("shortest", shortest)):
        if value is not None and not 0 < value < float("inf"):
            raise InputError(f"{name} = {value}: give a positive length in metres")
    angle, stretch = lay if lay is not None else (0.0, 1.0)
    if not 1 <= stretch < float("inf"):
        raise InputError(f"lay = {lay!r}: give (angle in radians, stretch), the stretch 1 or more")
    rng = np.random.default_rng(seed)
    total = counts if periodic else tuple(2 * n for n in counts)
    from scipy import fft

    frequencies = [np.fft.fftfreq(n, d) for n, d in zip(total[:-1], steps[:-1], strict=True)]
    frequencies.append(np.fft.rfftfreq(total[-1], steps[-1]))
    c = prefactor(convention, gamma)
    level = density(D, G, c) if G is not None else density(D, G_from_Rq(D, 1e-6, 1e-3, c), c)
    exponent = 7 - 2 * D
    uneven = 1.0
    if len(counts) == 2:
        # mean over directions, so that the power of all directions together is that of G
        turn = (np.arange(720) + 0.5) * pi / 720
        uneven = float(np.mean((stretch * np.cos(turn) ** 2 + np.sin(turn) ** 2 / stretch) ** (D - 4)))
        fy, fx = frequencies[0][:, None], frequencies[1][None, :]
        along, across = fx * cos(angle) + fy * sin(angle), -fx * sin(angle) + fy * cos(angle)
        f = np.hypot(along * stretch**0.5, across / stretch**0.5)
        real = np.hypot(fx, fy)
    else:
        f = real = frequencies[0]
    cut = 0.5 / max(steps) if shortest is None else 1 / shortest
    effective = np.maximum(f, 1 / longest) if longest is not None else f
    with np.errstate(divide="ignore"):
        power = level / uneven * effective**-exponent / (2 * pi * effective if len(counts) == 2 else 2.0)
    power[(real > cut * (1 + 1e-12)) | (real == 0)] = 0.0
    noise = rng.standard_normal(total)
    area = float(np.prod(steps))
    z = fft.irfftn(fft.rfftn(noise) * np.sqrt(power / area), total)
    z = np.ascontiguousarray(z[tuple(slice(0, n) for n in counts)])
    z -= z.mean()
    if Rq is not None:
        z *= Rq / z.std()
    what = f"G {G:.4g} m" if G is not None else f"Rq {Rq:.4g} m"
    return _output(z, steps, f"spectral surface, D {D}, {what}, {convention}")


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
    seed: int | np.random.Generator | None = 0,
) -> Scan | Profile:
    """Return the Weierstrass-Mandelbrot surface of Yan and Komvopoulos (doi:10.1063/1.368536, eq. 5), or its profile.

    z = L (G/L)^(D-2) (ln gamma / M)^(1/2) sum_m sum_n gamma^((D-3)n) {cos phi_mn - cos[2 pi gamma^n r/L cos(theta -
    pi m/M) + phi_mn]}, L = `length` [m] (default: the longest side), M = `ridges`, n from 0 to
    log(L/shortest)/log(gamma), `shortest` [m] twice the coarser spacing unless given. A profile (shape an int) has one
    ridge, and `D` = Ds + 1 still. Phases are uniform from `seed`, all zero with seed=None.
    convention="majumdar-bhushan" leaves out the factor (ln gamma)^(1/2).
    Raises InputError for D outside (2, 3), gamma <= 1, and lengths that are not positive.
    """
    check_dimension(D)
    c = prefactor(convention, gamma)
    counts, steps = _grid(shape, spacing)
    L = max(n * d for n, d in zip(counts, steps, strict=True)) if length is None else length
    end = 2 * max(steps) if shortest is None else shortest
    if not (G > 0 and L > 0 and 0 < end < L) or ridges < 1:
        raise InputError(
            f"G = {G}, length = {L}, shortest = {end}, ridges = {ridges}: all positive, shortest below length"
        )
    M = ridges if len(counts) == 2 else 1
    terms = floor(log(L / end) / log(gamma) + 1e-12) + 1
    n = np.arange(terms)
    rng = np.random.default_rng(seed if seed is not None else 0)
    phase = rng.uniform(0, 2 * pi, (M, terms)) if seed is not None else np.zeros((M, terms))
    # eq. (5); c ln(gamma) is ln(gamma) for Yan-Komvopoulos and 1 for Majumdar-Bhushan
    amplitude = L * (G / L) ** (D - 2) * (c * log(gamma) / M) ** 0.5 * gamma ** ((D - 3) * n)
    k = (2 * pi / L * gamma**n)[None, :]
    direction = pi * np.arange(M)[:, None] / M
    x = np.arange(counts[-1]) * steps[-1]
    constant = float(np.sum(amplitude * np.cos(phase)))
    weight = np.broadcast_to(amplitude, (M, terms)).ravel()
    shift = phase.ravel()
    kx = (k * np.cos(direction)).ravel() if len(counts) == 2 else k.ravel()
    if len(counts) == 1:
        z = constant - np.cos(np.outer(x, kx) + shift) @ weight
        return _output(z, steps, f"Weierstrass-Mandelbrot profile, D {D}, G {G:.4g} m, gamma {gamma}, {convention}")
    y = np.arange(counts[0]) * steps[0]
    ky = (k * np.sin(direction)).ravel()
    # cos(a + b) = cos a cos b - sin a sin b makes the double sum two matrix products
    a, b = np.outer(y, ky) + shift, np.outer(kx, x)
    z = constant - (np.cos(a) * weight) @ np.cos(b) + (np.sin(a) * weight) @ np.sin(b)
    return _output(z, steps, f"Weierstrass-Mandelbrot surface, D {D}, G {G:.4g} m, gamma {gamma}, {convention}")


def with_noise(scan: Scan, *, rms: float, seed: int = 0) -> Scan:
    """Add white Gaussian noise of `rms` [m] to every known point."""
    rng = np.random.default_rng(seed)
    return scan.with_heights(scan.heights + rng.normal(0, rms, scan.shape), f"white noise of {rms:.3g} m added")


def with_missing(scan: Scan, *, share: float, seed: int = 0) -> Scan:
    """Make a random `share` (0..1) of the points missing."""
    if not 0 <= share < 1:
        raise InputError(f"share = {share}: the share of missing points lies between 0 and 1")
    rng = np.random.default_rng(seed)
    count = ceil(share * scan.heights.size - 1e-9)
    z = scan.heights.ravel().copy()
    z[rng.choice(z.size, count, replace=False)] = np.nan
    return scan.with_heights(z.reshape(scan.shape), f"{count} points made missing")
