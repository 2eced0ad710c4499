"""The areal parameters of ISO 25178-2 beside those of `roughness`: peaks, bearing curve, volumes, autocorrelation."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying.style import Summary
from faying.surface.form import Prepared
from faying.typing import Array
from faying.units import show

CORE = 0.4  # share of the area under the flattest secant, which finds the core (ISO 25178-2, clause on Sk)
PEAK, VALLEY = 0.1, 0.8  # material ratios that part peaks, core and valleys in the volumes (the standard's defaults)
EXTREME, MIDDLE = 0.025, 0.5  # material ratios of Sxp (the standard's defaults)
DECAY = 0.2  # of the autocorrelation, at which Sal and Str are read (the standard's default)
LEAST_OVERLAP = 0.5  # of each side, to which shifts reach: beyond it few pairs of points are left


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class ArealParameters(Summary):
    """Numbers of a levelled scan without a filter, by their names in ISO 25178-2.

    Args:
        Sp, Sv: highest peak above and deepest pit below the mean [m].
        Sk, Spk, Svk: heights of core, reduced peaks and reduced valleys [m].
        Smr1, Smr2: material ratios [-] where the core begins and ends.
        Sxp: from the height at a material ratio of 2.5 % down to that at 50 % [m].
        Vmp, Vmc, Vvc, Vvv: volumes per area [m] of material in peaks (above 10 %) and core (10 to 80 %), of voids in
            core and valleys (below 80 %).
        Sal: least distance [m] at which the autocorrelation falls to 0.2.
        Str: that over the greatest one [-]; NaN where it does not fall so far within half of the scan.

    Source:
        ISO 25178-2:2021.
    """

    Sp: float
    Sv: float
    Sk: float
    Spk: float
    Svk: float
    Smr1: float
    Smr2: float
    Sxp: float
    Vmp: float
    Vmc: float
    Vvc: float
    Vvv: float
    Sal: float
    Str: float

    @classmethod
    def of(cls, ready: Prepared) -> "ArealParameters":
        """Those of a scan that is levelled; points that were filled in count for Sal and Str alone."""
        heights = ready.scan.heights
        known = heights[ready.known]
        sal, longest = _decay(heights - heights.mean(), ready.scan.spacing)
        return cls(**_bearing(np.sort(known - known.mean())[::-1]), Sal=sal, Str=sal / longest)

    def summary(self) -> tuple[str, dict[str, str]]:
        """All numbers, by the groups of the standard."""

        def row(*names: str) -> str:
            return ", ".join(f"{name} {show(getattr(self, name), 'm')}" for name in names)

        return "ISO 25178-2 without a filter", {
            "heights": row("Sp", "Sv", "Sxp"),
            "core": f"{row('Sk', 'Spk', 'Svk')}, Smr1 {self.Smr1:.3g}, Smr2 {self.Smr2:.3g}",
            "volumes": row("Vmp", "Vmc", "Vvc", "Vvv"),
            "lengths": f"{row('Sal')}, Str {self.Str:.3g}".replace("nan", "-"),
        }


def _bearing(falling: Array) -> dict[str, float]:
    """Numbers of the bearing curve, from the heights (n,) [m] in falling order, each of which has 1/n of the area."""
    n = len(falling)
    ratio = (np.arange(n) + 0.5) / n
    width = round(CORE * n)
    drops = falling[: n - width] - falling[width:]
    # of secants that are equally flat the middle one
    start = int(np.median(np.flatnonzero(drops <= drops.min() * (1 + 1e-12))))
    core = slice(start, start + width + 1)  # ISO 13565-2, 4.2: the line of least squares through it
    slope, top = np.polyfit(ratio[core], falling[core], 1).tolist()
    bottom = top + slope
    above, below = np.maximum(falling - top, 0.0), np.maximum(bottom - falling, 0.0)
    peaks, valleys = float(np.mean(falling > top)), float(np.mean(falling < bottom))

    heights = {share: float(np.interp(share, ratio, falling)) for share in (EXTREME, PEAK, MIDDLE, VALLEY)}
    material, void = (
        {share: float(np.maximum(sign * (falling - z), 0.0).mean()) for share, z in heights.items()} for sign in (1, -1)
    )
    return {
        "Sp": float(falling[0]),
        "Sv": float(-falling[-1]),
        "Sk": -slope,
        "Spk": 2 * float(above.mean()) / peaks if peaks else 0.0,  # a triangle of the same area
        "Svk": 2 * float(below.mean()) / valleys if valleys else 0.0,
        "Smr1": peaks,
        "Smr2": 1 - valleys,
        "Sxp": heights[EXTREME] - heights[MIDDLE],
        "Vmp": material[PEAK],
        "Vmc": material[VALLEY] - material[PEAK],
        "Vvc": void[PEAK] - void[VALLEY],
        "Vvv": void[VALLEY],
    }


def _decay(z: Array, spacing: tuple[float, float]) -> tuple[float, float]:
    """Least and greatest distance [m] at which the autocorrelation of z (ny, nx), of mean 0, falls to `DECAY`.

    Of every shift, over the points that overlap. Around the centre; NaN where it does not fall so far.
    """
    from contourpy import contour_generator
    from scipy.fft import fftshift, irfft2, next_fast_len, rfft2

    shape = [next_fast_len(2 * n, real=True) for n in z.shape]
    reach = [int(LEAST_OVERLAP * n) for n in z.shape]
    power = np.abs(rfft2(z, shape)) ** 2
    pairs = [n - np.abs(np.arange(-r, r + 1)) for n, r in zip(z.shape, reach, strict=True)]
    middle = tuple(slice(n // 2 - r, n // 2 + r + 1) for n, r in zip(shape, reach, strict=True))
    along = fftshift(irfft2(power, shape))[middle] / np.multiply.outer(*pairs)
    y, x = (step * np.arange(-r, r + 1) for r, step in zip(reach, spacing[::-1], strict=True))
    lines = contour_generator(x, y, along / along[reach[0], reach[1]]).lines(DECAY)
    radii = [np.hypot(*np.asarray(line).T) for line in lines]
    if not radii:
        return np.nan, np.nan
    nearest = int(np.argmin([one.min() for one in radii]))
    line = np.asarray(lines[nearest])
    closed = np.array_equal(line[0], line[-1])
    return float(radii[nearest].min()), float(radii[nearest].max()) if closed else np.nan
