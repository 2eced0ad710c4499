"""Power spectral density and structure function of prepared heights.

Frequencies are cycles per metre. `Spectrum.density` is the power per radial frequency [m3]: for a scan the sum over
all directions, 2 pi f C(f), with C the two-sided areal density; for a profile the one-sided density. Its integral
over frequency is the mean square height in both cases.
"""

from dataclasses import dataclass
from math import pi
from typing import Any, final

import numpy as np

from faying.surface.heights import AreaHeights, LineHeights, sides_of, steps_of
from faying.typing import Array, Mask

# Hann window: sum of the squared correlations between neighbouring Fourier coefficients, per axis (1 + 2 (4/9 + 1/36))
HANN_CORRELATION = 1 + 2 * (4 / 9 + 1 / 36)


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Spectrum:
    """A power spectrum in bins of frequency (arrays of equal shape, one entry per bin).

    `frequency` [1/m] is the bin's mean frequency, `density` [m3] the mean power per radial frequency, `count` the
    number of Fourier coefficients in the bin, `uneven` the unevenness <C^2>/<C>^2 over directions, `spread` the
    relative standard deviation of the bin's mean (that unevenness and the window's correlation included), `width` the
    bin's width in steps of 1/L.
    `lowest` [1/m] is one cycle over the shortest side, `nyquist` [1/m] the Nyquist frequency of the coarser axis.
    `curvature` [1/m2] is (1/Lx^2 + 1/Ly^2)/2 or 1/L^2, which sets how far the window smears a power law.
    """

    frequency: Array
    density: Array
    count: Array
    spread: Array
    uneven: Array
    width: Array
    lowest: float
    nyquist: float
    curvature: float
    axes: int


def _edges(lowest: float, highest: float, ratio: float) -> Array:
    """Bin edges [steps of 1/L]: half-integers, at least two steps wide, then growing geometrically by `ratio`."""
    edges = [0.5]
    while edges[-1] < highest / lowest * (1 - 1e-9):
        edges.append(max(edges[-1] + 2.0, float(np.ceil(edges[-1] * ratio)) + 0.5))
    return np.array(edges)


def _running_median(values: Array) -> Array:
    """Median over up to 6 bins on either side, not below 1."""
    spans = [values[max(0, i - 6) : i + 7] for i in range(len(values))]
    return np.array([max(1.0, float(np.median(span))) for span in spans])


def white_shape(f: Any, axes: int) -> Any:
    """Density of white noise whose two-sided density, areal for a scan, is 1."""
    return 2 * pi * f if axes == 2 else 2.0 + 0.0 * f


def _hann(count: int) -> Array:
    return 0.5 - 0.5 * np.cos(2 * pi * (np.arange(count) + 0.5) / count)


def spectrum(scan: AreaHeights | LineHeights, *, ratio: float = 1.06) -> Spectrum:
    """Return the Hann-windowed power spectrum of levelled heights without missing points, averaged over directions.

    Bins are two Fourier steps wide at least and grow by `ratio`. No user errors: the heights come from `form.prepared`.
    """
    return binned(scan, *periodogram(scan), ratio=ratio)


def periodogram(scan: AreaHeights | LineHeights) -> tuple[Array, Array, tuple[Array, ...]]:
    """Return the two-sided periodogram [m4 or m3] on the half-plane of rfft, the radial frequency and the axes."""
    from scipy import fft

    z = scan.heights
    if isinstance(scan, LineHeights):
        window = _hann(len(z))
        f = fft.rfftfreq(len(z), scan.spacing)
        scale = scan.spacing / float(np.sum(window**2))
        out = np.abs(fft.rfft((z - np.average(z, weights=window)) * window)) ** 2 * scale
        return out, f, (f,)
    wy, wx = _hann(z.shape[0]), _hann(z.shape[1])
    mean = float(wy @ z @ wx) / float(wy.sum() * wx.sum())
    shaped = z - mean
    shaped *= wy[:, None]
    shaped *= wx[None, :]
    transform = fft.rfft2(shaped, overwrite_x=True)
    power = transform.real**2
    power += transform.imag**2
    power *= scan.spacing[0] * scan.spacing[1] / float(np.sum(wy**2) * np.sum(wx**2))
    fx, fy = fft.rfftfreq(z.shape[1], scan.spacing[0]), fft.fftfreq(z.shape[0], scan.spacing[1])
    return power, np.sqrt(fx[None, :] ** 2 + fy[:, None] ** 2), (fy, fx)


def binned(
    scan: AreaHeights | LineHeights,
    power: Array,
    frequency: Array,
    axes: tuple[Array, ...],
    *,
    ratio: float = 1.06,
    exclude: Mask | None = None,
) -> Spectrum:
    """Average a periodogram over directions and in bins of frequency; see `spectrum`.

    `exclude` is a mask over the half-plane of Fourier coefficients (shape ny, nx//2+1) left out of the averages (peaks
    of machining marks).
    """
    sides = sides_of(scan)
    lowest, nyquist = 1 / min(sides), 0.5 / max(steps_of(scan))
    edges = _edges(lowest, nyquist, ratio)
    # index of the bin: through a table over steps of lowest/8, faster than searching for every coefficient
    table = np.digitize(np.arange(0, int(edges[-1] * 8) + 2) / 8 + 1 / 16, edges)
    # the small shift keeps coefficients that lie on a border on one side of it in every unit
    index = table[np.minimum(frequency * (8 / lowest) + 1e-6, len(table) - 1).astype(np.int32)]
    weight = np.ones(frequency.shape)
    if len(axes) == 2:  # the column fx = 0 (and fx = Nyquist) holds every coefficient twice
        weight[:, 0] = 0.5
        if scan.heights.shape[1] % 2 == 0:
            weight[:, -1] = 0.5
    if exclude is not None:
        weight[exclude] = 0.0
    bins = len(edges) + 1
    flat, w = index.ravel(), weight.ravel()
    p = power.ravel()
    wp = w * p
    count = np.asarray(np.bincount(flat, w, bins)[1:-1], float)
    first = np.bincount(flat, wp, bins)[1:-1]
    second = np.bincount(flat, wp * p, bins)[1:-1]
    centre = np.bincount(flat, w * frequency.ravel(), bins)[1:-1]
    use = count > 0
    count, first, second, centre = count[use], first[use], second[use], centre[use]
    mean = first / count
    # <P^2> is 2 <C^2> for Gaussian heights, so this is the unevenness over directions (and a little of the slope)
    # smoothed over bins: a bin's own value goes with its mean, and weights that do would bias the fit
    uneven = _running_median(second / count / (2 * mean**2)) if len(axes) == 2 else np.ones(len(mean))
    f = centre / count
    return Spectrum(
        frequency=f,
        density=mean * white_shape(f, len(axes)),
        count=count,
        spread=np.sqrt(HANN_CORRELATION ** len(axes) * uneven / count),
        uneven=uneven,
        width=np.diff(edges)[use],
        lowest=lowest,
        nyquist=nyquist,
        curvature=float(np.mean([1 / s**2 for s in sides])),
        axes=len(axes),
    )


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class StructureFunction:
    """Structure function <(z(x + lag) - z(x))^2> [m2] over `lag` [m], averaged over directions; `pairs` counted."""

    lag: Array
    value: Array
    pairs: Array


def _products(z: Array, known: Array, shape: tuple[int, ...]) -> tuple[Array, Array]:
    """Sums of squared differences and numbers of pairs for all lags, by zero-padded transforms of `shape`."""
    from scipy import fft

    a = fft.rfftn(z, shape)
    b = fft.rfftn(z * z, shape)
    m = fft.rfftn(known, shape)
    pairs = fft.irfftn(m.real**2 + m.imag**2, shape)
    cross = b * m.conj()
    total = fft.irfftn(2 * cross.real - 2 * (a.real**2 + a.imag**2), shape)
    return total, pairs


def structure_function(
    scan: AreaHeights | LineHeights, *, known: Mask | None = None, longest: float = 0.125, ratio: float = 1.12
) -> StructureFunction:
    """Return the structure function for lags from one point to `longest` times the shortest side.

    Computed by FFT over all pairs; points that are not `known` (or NaN) take no part. Directions are averaged in
    rings of lag that grow by `ratio`. No user errors: the heights come from `form.prepared`.
    """
    from scipy import fft

    z = scan.heights
    mask = ~np.isnan(z) if known is None else known & ~np.isnan(z)
    values = np.where(mask, z, 0.0)
    values = np.where(mask, values - values.sum() / mask.sum(), 0.0)
    spacing, side = steps_of(scan), min(sides_of(scan))
    reach = [max(2, int(longest * side / d)) for d in spacing]
    shape = tuple(fft.next_fast_len(n + r + 1, real=True) for n, r in zip(z.shape, reach, strict=True))
    total, pairs = _products(values, mask.astype(float), shape)
    if len(spacing) == 1:
        r = np.arange(reach[0] + 1) * spacing[0]
        total, pairs = total[: reach[0] + 1], pairs[: reach[0] + 1]
    else:
        rows = np.r_[-reach[0] : reach[0] + 1]
        total = total[rows % shape[0]][:, : reach[1] + 1]
        pairs = pairs[rows % shape[0]][:, : reach[1] + 1]
        r = np.hypot(rows[:, None] * spacing[0], np.arange(reach[1] + 1)[None, :] * spacing[1])
    pairs = np.asarray(np.rint(pairs), float)
    step = max(spacing)
    edges = [0.5]
    while edges[-1] * step < longest * side:
        edges.append(max(edges[-1] + 1, edges[-1] * ratio))
    bins = np.digitize(r.ravel() / step, np.array(edges))
    use = (pairs.ravel() > 0) & (r.ravel() <= longest * side)
    n = len(edges) + 1
    # every lag vector counts alike, so that missing points do not change the mix of directions
    one = np.where(use, 1.0, 0.0)
    count = np.bincount(bins, one, n)[1:]
    each = np.where(use, total.ravel() / np.maximum(pairs.ravel(), 1), 0.0)
    value = np.bincount(bins, each, n)[1:]
    lag = np.bincount(bins, np.where(use, r.ravel(), 0.0), n)[1:]
    number = np.asarray(np.bincount(bins, np.where(use, pairs.ravel(), 0.0), n)[1:], float)
    good = count > 0
    return StructureFunction(lag=lag[good] / count[good], value=value[good] / count[good], pairs=number[good])
