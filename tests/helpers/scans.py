"""Twenty rough surfaces of known make, each as a fine map and as what an instrument would see of it."""

from collections.abc import Iterator

import numpy as np

from faying.surface.scan import Scan

FINE, SIDE = 512, 1e-3  # points a side of the fine map, and its side [m]
COARSER = 4  # points of the fine map that one point of the scan averages over, each way
UM, MM = 1e-6, 1e-3

# Hurst exponent, longest and shortest wavelength [mm], rms height [um]
GAUSSIAN = [
    (0.8, 0.25, 0.02, 1.0),
    (0.8, 0.25, 0.008, 1.0),
    (0.8, 0.25, 0.0, 1.0),
    (0.5, 0.25, 0.0, 1.0),
    (0.9, 0.5, 0.0, 3.0),
    (0.8, 0.1, 0.0, 0.3),
    (0.7, 0.06, 0.0, 0.5),
    (0.8, 0.25, 0.0, 10.0),
    (0.6, 1.0, 0.0, 20.0),
    (0.8, 0.12, 0.01, 0.1),
]


def gaussian(hurst, longest, shortest, rms, seed, *, stretch=1.0, points=FINE, side=SIDE):
    """Self-affine Gaussian heights [m] between two wavelengths [m], a plateau above the longest; `stretch` of a lay."""
    rng = np.random.default_rng(seed)
    f = np.fft.fftfreq(points, side / points)
    fx, fy = np.meshgrid(f, f)
    q = np.hypot(fx, fy * stretch)
    q[0, 0] = 1
    amplitude = np.maximum(q, 1 / longest) ** -(1 + hurst)
    amplitude[(q > 1 / shortest) if shortest else False] = 0
    amplitude[0, 0] = 0
    z = np.fft.ifft2(np.fft.fft2(rng.standard_normal((points, points))) * amplitude).real
    return z * rms / z.std()


def marks(seed, rms, feed):
    """Marks of a round tool, `feed` [m] apart."""
    x = np.arange(FINE) * SIDE / FINE / feed + np.random.default_rng(seed).uniform()
    profile = (x % 1 - 0.5) ** 2
    profile -= profile.mean()
    return np.tile(profile / profile.std() * rms, (FINE, 1))


def averaged(z, by):
    """Heights of points that each see the mean of by x by points."""
    n = len(z) // by
    return z.reshape(n, by, n, by).mean(axis=(1, 3))


def twenty(seed: int) -> Iterator[tuple[str, Scan, Scan]]:
    """Name, fine map and scan of each surface."""
    made = {}
    for k, (hurst, longest, shortest, rms) in enumerate(GAUSSIAN):
        z = gaussian(hurst, longest * MM, shortest * MM, rms * UM, seed + k)
        made[f"Gaussian, H {hurst}, {longest} mm to {shortest} mm, {rms} um"] = z, 0.0
    z = gaussian(0.8, 0.2 * MM, 0, UM, seed + 20)
    made["plateaus, as honed"] = np.where(z > 0.3 * UM, 0.3 * UM + (z - 0.3 * UM) * 0.2, z), 0.0
    made["lognormal, high peaks"] = (np.exp(gaussian(0.8, 0.2 * MM, 0, 0.5, seed + 21)) - 1) * UM, 0.0
    made["lognormal, deep valleys"] = (1 - np.exp(gaussian(0.8, 0.2 * MM, 0, 0.5, seed + 22))) * UM, 0.0
    made["lay, 5 to 1"] = gaussian(0.8, 0.25 * MM, 0, UM, seed + 23, stretch=0.2), 0.0
    made["ground, 10 to 1"] = gaussian(0.7, 0.1 * MM, 0, 0.4 * UM, seed + 24, stretch=0.1), 0.0
    made["milled"] = marks(seed + 25, UM, 0.2 * MM) + gaussian(0.8, 0.1 * MM, 0, 0.3 * UM, seed + 25), 0.0
    made["turned"] = marks(seed + 26, 2 * UM, 0.1 * MM) + gaussian(0.8, 0.1 * MM, 0.01 * MM, 0.2 * UM, seed + 26), 0.0
    made["noise of 20 nm"] = gaussian(0.8, 0.25 * MM, 0.03 * MM, UM, seed + 27), 20e-9
    made["noise of 100 nm"] = gaussian(0.8, 0.25 * MM, 0.03 * MM, UM, seed + 28), 100e-9
    made["lapped"] = gaussian(0.8, 0.2 * MM, 0.02 * MM, 0.03 * UM, seed + 29), 0.0
    for name, (z, noise) in made.items():
        seen = averaged(z, COARSER)
        seen = seen + noise * np.random.default_rng(seed).standard_normal(seen.shape)
        step = SIDE / FINE
        yield (
            name,
            Scan(heights=z, spacing=(step, step), source=name),
            Scan(heights=seen, spacing=(COARSER * step, COARSER * step), source=name),
        )
