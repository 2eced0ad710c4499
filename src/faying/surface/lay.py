"""The lay of a scan: its direction and strength."""

from dataclasses import dataclass
from math import hypot, pi
from typing import final

import numpy as np

from faying.surface.form import prepared
from faying.surface.heights import AreaHeights
from faying.surface.spectrum import periodogram


@final
@dataclass(frozen=True, kw_only=True)
class Lay:
    """`angle` [rad] of the lay (grooves run along it) from x towards y, in [0, pi); `strength` 0 (isotropic) to 1.

    `present` tells whether the strength exceeds what an isotropic surface of this size shows by chance.
    """

    angle: float
    strength: float
    present: bool


def find_lay(scan: AreaHeights) -> Lay:
    """Find the lay from the power over directions, each ring of frequency counting alike.

    strength = |sum over rings of <P exp(2 i theta)>/<P>| / rings, between 6 cycles over the side and half the Nyquist
    frequency. `present`: strength above 0.1 and above five times its standard error for an isotropic surface.
    Raises InputError as `prepared` does.
    """
    ready = prepared(scan)
    power, f, (fy, fx) = periodogram(ready.scan)
    lowest = 1 / min(scan.size)
    high = 0.25 / max(scan.spacing)
    low = min(6 * lowest, high / 2)
    use = (f >= low) & (f <= high)
    use[:, 0] = False  # stands twice in the half-plane
    theta = np.broadcast_to(np.arctan2(fy[:, None], fx[None, :]), f.shape)[use]
    p = power[use]
    ring = (np.log2(f[use] / low) * 4).astype(int)
    total = np.bincount(ring, p)
    squares = np.bincount(ring, p**2)
    real = np.bincount(ring, p * np.cos(2 * theta))
    imaginary = np.bincount(ring, p * np.sin(2 * theta))
    good = total > 0
    a, b = float(np.mean(real[good] / total[good])), float(np.mean(imaginary[good] / total[good]))
    error = float(np.sqrt(np.sum(2 * squares[good] / total[good] ** 2)) / good.sum())
    strength = hypot(a, b)
    # the power lies across the grooves
    across = np.arctan2(b, a) / 2
    return Lay(angle=float((across + pi / 2) % pi), strength=strength, present=strength > max(0.1, 5 * error))
