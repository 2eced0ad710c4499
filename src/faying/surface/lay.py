"""The lay of a scan: its direction and strength, and profiles across and along it."""

from dataclasses import dataclass
from math import cos, hypot, pi, sin
from typing import final

import numpy as np

from faying.errors import InputError
from faying.surface.form import prepared
from faying.surface.scan import Profile, Scan
from faying.surface.spectrum import periodogram
from faying.typing import Array


@final
@dataclass(frozen=True, kw_only=True)
class Lay:
    """`angle` [rad] of the lay (grooves run along it) from x towards y, in [0, pi); `strength` 0 (isotropic) to 1.

    `present` tells whether the strength exceeds what an isotropic surface of this size shows by chance.
    """

    angle: float
    strength: float
    present: bool


def find_lay(scan: Scan) -> Lay:
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
    use[:, 0] = False  # held twice in the half-plane
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


def sections(scan: Scan, angle: float, count: int = 32) -> list[Profile]:
    """Return `count` straight profiles at `angle` [rad] from x, evenly spread over the scan, through its full width.

    Sampled by linear interpolation with the smaller spacing; a point next to a missing one is missing. Lines with
    fewer than 16 points are left out. Raises InputError where no line fits.
    """
    from scipy.ndimage import map_coordinates

    step = min(scan.spacing)
    width, height = ((n - 1) * d for n, d in zip(scan.shape[::-1], scan.spacing, strict=True))
    direction, normal = np.array([cos(angle), sin(angle)]), np.array([-sin(angle), cos(angle)])
    centre = np.array([width, height]) / 2
    reach = (abs(normal[0]) * width + abs(normal[1]) * height) / 2
    out = []
    for offset in (np.arange(count) + 0.5) / count * 2 * reach - reach:
        start, end = _clip(centre + offset * normal, direction, width, height)
        points = int((end - start) / step) + 1
        if points < 16:
            continue
        line = (centre + offset * normal)[:, None] + direction[:, None] * (start + step * np.arange(points))
        where = np.array([line[1] / scan.spacing[1], line[0] / scan.spacing[0]])
        z: Array = map_coordinates(scan.heights, where, order=1, mode="nearest")
        note = f"section at {np.degrees(angle):.1f} deg"
        out.append(
            Profile(
                heights=z, spacing=step, source=scan.source, instrument=scan.instrument, history=(*scan.history, note)
            )
        )
    if not out:
        raise InputError(f"{scan.source}: no line of 16 points at {np.degrees(angle):.1f} deg fits into the scan")
    return out


def _clip(point: Array, direction: Array, width: float, height: float) -> tuple[float, float]:
    """Range of t for which point + t direction lies inside the rectangle."""
    low, high = -np.inf, np.inf
    for p, d, size in zip(point, direction, (width, height), strict=True):
        if abs(d) > 1e-12:
            a, b = sorted(((0 - p) / d, (size - p) / d))
            low, high = max(low, a), min(high, b)
    return float(low), float(high)


def across_and_along(scan: Scan, count: int = 32) -> tuple[list[Profile], list[Profile]]:
    """Return profiles across and along the lay; InputError where the scan has none."""
    lay = find_lay(scan)
    if not lay.present:
        raise InputError(f"{scan.source}: no lay (strength {lay.strength:.3f}); take profiles along x and y instead")
    return sections(scan, lay.angle + pi / 2, count), sections(scan, lay.angle, count)
