"""Roughness parameters of levelled heights (ISO 21920 and ISO 25178 names), over the known points."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying.surface.form import Prepared, prepared
from faying.surface.scan import Profile, Scan


@final
@dataclass(frozen=True, kw_only=True)
class Roughness:
    """Rq (rms), Ra (mean absolute), Rz (highest minus lowest height) [m]; skewness, kurtosis, Rdq (rms slope) [-].

    For a scan these are Sq, Sa, Sz, Ssk, Sku and Sdq of ISO 25178-2, taken over the whole area without a filter; the
    slope is the rms gradient of forward differences, hence tied to the pixel. For a profile they are Rq .. Rdq.
    """

    Rq: float
    Ra: float
    Rz: float
    skewness: float
    kurtosis: float
    Rdq: float

    @property
    def Sq(self) -> float:
        """Rms height of an areal scan [m]."""
        return self.Rq

    @property
    def Sa(self) -> float:
        """Mean absolute height of an areal scan [m]."""
        return self.Ra

    @property
    def Sdq(self) -> float:
        """Rms gradient of an areal scan [-]."""
        return self.Rdq


def roughness(scan: Scan | Profile | Prepared, *, degree: int = 1) -> Roughness:
    """Return the roughness of a scan or profile after levelling by a polynomial of `degree` and without its spikes.

    Missing points are left out, not filled. Raises InputError as `faying.surface.form.prepared` does.
    """
    ready = scan if isinstance(scan, Prepared) else prepared(scan, degree=degree)
    z = ready.scan.heights
    known = z[ready.known]
    known = known - known.mean()
    rq = float(np.sqrt(np.mean(known**2)))
    holes = np.where(ready.known, z, np.nan)
    steps = [ready.scan.spacing] if z.ndim == 1 else [ready.scan.spacing[1], ready.scan.spacing[0]]
    slope2 = sum(float(np.nanmean((np.diff(holes, axis=i) / d) ** 2)) for i, d in enumerate(steps))
    return Roughness(
        Rq=rq,
        Ra=float(np.mean(np.abs(known))),
        Rz=float(np.ptp(known)),
        skewness=float(np.mean(known**3)) / rq**3,
        kurtosis=float(np.mean(known**4)) / rq**4,
        Rdq=slope2**0.5,
    )


LENGTHS = 5  # sampling lengths in a line


def mean_peak_to_valley(scan: Scan | Profile | Prepared) -> float:
    """Return Rz [m], the mean of highest minus lowest height over five parts of each line, without a filter.

    For an areal scan the larger of that along x and along y: across the lay. Lines are as long as the scan is, be it
    five times the cut-off or not. Points that were filled in count. Raises InputError as `prepared` does.
    """
    ready = scan if isinstance(scan, Prepared) else prepared(scan)
    z = ready.scan.heights
    found = []
    for lines in (z[None],) if z.ndim == 1 else (z, z.T):
        parts = [part for part in np.array_split(lines, LENGTHS, axis=1) if part.shape[1]]
        found.append(float(np.mean([np.ptp(part, axis=1).mean() for part in parts])))
    return max(found)
