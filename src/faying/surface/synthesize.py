"""Gaussian surfaces and profiles of known D and G."""

from math import cos, pi, sin

import numpy as np

from faying.checks import flag, number, several, shown, whole
from faying.errors import InputError
from faying.surface.convention import G_from_Rq, check_dimension, density, prefactor
from faying.surface.scan import Profile, Scan
from faying.typing import Array

MAX_POINTS = 2**31  # along a side
Seed = int | np.random.Generator


def _generator_of(seed: Seed) -> np.random.Generator:
    """A generator of random numbers; InputError unless a whole number, 0 or more, or a generator is given."""
    if isinstance(seed, np.random.Generator):
        return seed
    return np.random.default_rng(whole(seed, "seed", least=0, greatest=2**128))


def _grid_of(
    shape: int | tuple[int, int], spacing: float | tuple[float, float]
) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Counts and spacings in the order of the axes of the heights (y, x), or (x,)."""
    given = shape if isinstance(shape, list | tuple) else (shape,)
    if len(given) not in (1, 2):
        raise InputError(f"shape = {shown(shape)}: give (ny, nx) for a scan or n for a profile, 2 points at least")
    counts = tuple(whole(n, "shape (points)", least=2, greatest=MAX_POINTS) for n in given)
    return counts, several(spacing, "spacing", len(counts), "m", alike=True, least=0)[::-1]


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
    check_dimension(D)
    counts, steps = _grid_of(shape, spacing)
    lengths = {"G": G, "Rq": Rq, "longest": longest, "shortest": shortest}
    G, Rq, longest, shortest = (v if v is None else number(v, n, "m", least=0) for n, v in lengths.items())
    _scale_of(G, Rq)
    c = prefactor(convention, gamma)
    level = density(D, G, c) if G is not None else density(D, G_from_Rq(D, 1e-6, 1e-3, c), c)
    total = counts if flag(periodic, "periodic") else tuple(2 * n for n in counts)
    f, real, uneven = _frequencies(total, steps, D, lay)
    cut = 0.5 / max(steps) if shortest is None else 1 / shortest
    effective = np.maximum(f, 1 / longest) if longest is not None else f
    with np.errstate(divide="ignore"):
        power = level / uneven * effective ** -(7 - 2 * D) / (2 * pi * effective if len(counts) == 2 else 2.0)
    power[(real > cut * (1 + 1e-12)) | (real == 0)] = 0.0
    z = _coloured(power, total, steps, _generator_of(seed))
    z = np.ascontiguousarray(z[tuple(slice(0, n) for n in counts)])
    z -= z.mean()
    if Rq is not None:
        z *= Rq / z.std()
    return _output(z, steps, f"spectral surface, D {D}, {_scale_of(G, Rq)}, {convention}")


def _scale_of(G: float | None, Rq: float | None) -> str:
    """The scale of the heights in words; InputError unless one of the two is given."""
    if (G is None) == (Rq is None):
        raise InputError("give either G (fractal roughness, metres) or Rq (rms height, metres), one of them")
    return f"G {G:.4g} m" if G is not None else f"Rq {Rq:.4g} m"


def _frequencies(
    total: tuple[int, ...], steps: tuple[float, ...], D: float, lay: tuple[float, float] | None
) -> tuple[Array, Array, float]:
    """Frequencies [1/m] of the half-plane as the spectrum sees them (stretched by the lay) and as they are, and the
    mean over directions that keeps the power of all directions together that of G."""
    if lay is not None and (not isinstance(lay, list | tuple) or len(lay) != 2):
        raise InputError(f"lay = {shown(lay)}: give (angle in radians, stretch), the stretch 1 or more")
    angle, stretch = (number(lay[0], "angle of the lay", "rad"), lay[1]) if lay is not None else (0.0, 1.0)
    number(stretch, "stretch of the lay", least=1, ends="[)")
    last = np.asarray(np.fft.rfftfreq(total[-1], steps[-1]), np.float64)
    if len(total) == 1:
        return last, last, 1.0
    turn = (np.arange(720) + 0.5) * pi / 720
    uneven = float(np.mean((stretch * np.cos(turn) ** 2 + np.sin(turn) ** 2 / stretch) ** (D - 4)))
    fy, fx = np.asarray(np.fft.fftfreq(total[0], steps[0]), np.float64)[:, None], last[None, :]
    along, across = fx * cos(angle) + fy * sin(angle), -fx * sin(angle) + fy * cos(angle)
    return np.hypot(along * stretch**0.5, across / stretch**0.5), np.hypot(fx, fy), uneven


def _coloured(power: Array, total: tuple[int, ...], steps: tuple[float, ...], rng: np.random.Generator) -> Array:
    """White noise given the two-sided power [m4 or m3]."""
    from scipy import fft

    area = float(np.prod(steps))
    return np.asarray(fft.irfftn(fft.rfftn(rng.standard_normal(total)) * np.sqrt(power / area), total))
