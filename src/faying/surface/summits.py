"""Spectral moments and summits of a scan, and how much they depend on the shortest wavelength that is kept."""

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import ArrayLike

from faying.errors import InputError
from faying.surface.filters import gaussian_lowpass
from faying.surface.form import Prepared, prepared
from faying.surface.scan import Scan
from faying.typing import Array


@final
@dataclass(frozen=True, kw_only=True)
class Summits:
    """m0 [m2], m2 [-], m4 [1/m2]: mean square height, slope and curvature of profiles (mean of those along x and y);

    `density` [1/m2] of summits (points above their eight neighbours), their mean `radius` [m] (over the mean of the two
    curvatures) and mean and rms height above the mean plane [m]; `bandwidth` m0 m4/m2^2 [-] (Nayak's alpha).
    """

    m0: float
    m2: float
    m4: float
    density: float
    radius: float
    mean_height: float
    rms_height: float

    @property
    def bandwidth(self) -> float:
        """Nayak's alpha, m0 m4/m2^2 [-] (doi:10.1115/1.3451608)."""
        return self.m0 * self.m4 / self.m2**2


def summits(scan: Scan | Prepared) -> Summits:
    """Return the moments and summits by finite differences on the scan's own grid (levelled, spikes out, filled).

    For a fractal surface every one of them but m0 is set by the shortest wavelength: see `cutoff_study`.
    Raises InputError as `prepared` does, and where there is no summit.
    """
    from scipy.ndimage import maximum_filter

    ready = scan if isinstance(scan, Prepared) else prepared(scan)
    z, (dx, dy) = ready.scan.heights, ready.scan.spacing
    slopes = [np.diff(z, axis=1) / dx, np.diff(z, axis=0) / dy]
    bends = [np.diff(z, 2, axis=1) / dx**2, np.diff(z, 2, axis=0) / dy**2]
    ring = np.ones((3, 3), bool)
    ring[1, 1] = False
    inner = (slice(1, -1), slice(1, -1))
    peak = z[inner] > maximum_filter(z, footprint=ring, mode="nearest")[inner]
    if not peak.any():
        raise InputError(f"{ready.scan.source}: no point is above its neighbours; the scan has no summit")
    curvature = -(bends[0][1:-1, :][peak] + bends[1][:, 1:-1][peak]) / 2
    tops = z[inner][peak] - z.mean()
    return Summits(
        m0=float(z.var()),
        m2=float(np.mean([np.mean(s**2) for s in slopes])),
        m4=float(np.mean([np.mean(b**2) for b in bends])),
        density=float(peak.sum() / (peak.size * dx * dy)),
        radius=float(1 / curvature.mean()),
        mean_height=float(tops.mean()),
        rms_height=float(tops.std()),
    )


def cutoff_study(scan: Scan, cutoffs: ArrayLike | None = None) -> tuple[Array, list[Summits]]:
    """Return cut-off wavelengths [m] (n) and the moments and summits after a Gaussian low-pass at each.

    Default cut-offs: 4 spacings to a sixteenth of the side, by factors of 2. Errors as in `gaussian_lowpass`.
    """
    ready = prepared(scan)
    if cutoffs is None:
        low, high = 4 * max(scan.spacing), min(scan.size) / 16
        values = np.asarray(low * 2.0 ** np.arange(max(1, int(np.log2(max(high / low, 1.0))) + 1)), float)
    else:
        values = np.atleast_1d(np.asarray(cutoffs, float))
    known = np.ones(scan.shape, bool)
    out = [
        summits(
            Prepared(
                scan=gaussian_lowpass(ready.scan, float(v)), known=known, missing=ready.missing, spikes=ready.spikes
            )
        )
        for v in values
    ]
    return values, out
