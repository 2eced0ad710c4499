"""Roughness parameters of levelled heights (ISO 21920 and ISO 25178 names), over the known points."""

from dataclasses import dataclass
from typing import final

import numpy as np

from faying.errors import InputError
from faying.style import Summary
from faying.surface.form import Prepared, prepared
from faying.surface.heights import AreaHeights, LineHeights, steps_of
from faying.typing import Array
from faying.units import show


@final
@dataclass(frozen=True, kw_only=True, repr=False)
class Roughness(Summary):
    """Numbers of levelled heights, without a filter.

    Args:
        Rq: rms height [m].
        Ra: mean absolute height [m].
        Rz: highest minus lowest height [m].
        skewness: mean cube of the heights over Rq^3 [-].
        kurtosis: mean fourth power of the heights over Rq^4 [-].
        Rdq: rms slope [-]; of a scan the rms gradient. By differences of neighbours, hence tied to the spacing.
        Rdr: developed over projected length, less 1 [-]; of a scan developed over projected area, less 1.
        areal: whether the heights are those of a scan: they go by Sq, Sa, Sz, Ssk, Sku, Sdq and Sdr of ISO 25178-2, as
            those of a profile go by Rq, Ra, Rsk, Rku, Rdq and Rdr of ISO 21920-2. Rz here spans the line.

    Asking a profile for a number of a scan raises InputError.
    """

    Rq: float
    Ra: float
    Rz: float
    skewness: float
    kurtosis: float
    Rdq: float
    Rdr: float
    areal: bool

    def _of(self, areal: bool, name: str, value: float) -> float:
        if self.areal != areal:
            one, other, letter = ("a scan", "a profile", "R") if areal else ("a profile", "a scan", "S")
            raise InputError(
                f"{name} is a number of {one}; these heights are those of {other}, which has {letter}{name[1:]}"
            )
        return value

    @property
    def Sq(self) -> float:
        """Rms height of a scan [m]."""
        return self._of(True, "Sq", self.Rq)

    @property
    def Sa(self) -> float:
        """Mean absolute height of a scan [m]."""
        return self._of(True, "Sa", self.Ra)

    @property
    def Sz(self) -> float:
        """Highest minus lowest height of a scan [m]."""
        return self._of(True, "Sz", self.Rz)

    @property
    def Ssk(self) -> float:
        """Skewness of the heights of a scan [-]."""
        return self._of(True, "Ssk", self.skewness)

    @property
    def Sku(self) -> float:
        """Kurtosis of the heights of a scan [-]."""
        return self._of(True, "Sku", self.kurtosis)

    @property
    def Sdq(self) -> float:
        """Rms gradient of a scan [-]."""
        return self._of(True, "Sdq", self.Rdq)

    @property
    def Sdr(self) -> float:
        """Developed area of a scan over its projected area, less 1 [-]."""
        return self._of(True, "Sdr", self.Rdr)

    @property
    def Rsk(self) -> float:
        """Skewness of the heights of a profile [-]."""
        return self._of(False, "Rsk", self.skewness)

    @property
    def Rku(self) -> float:
        """Kurtosis of the heights of a profile [-]."""
        return self._of(False, "Rku", self.kurtosis)

    def summary(self) -> tuple[str, dict[str, str]]:
        """All numbers, by their names in the standard."""
        S = "S" if self.areal else "R"
        standard = "ISO 25178-2" if self.areal else "ISO 21920-2"
        return f"Roughness, {standard} without a filter", {
            f"{S}q": show(self.Rq, "m"),
            f"{S}a": show(self.Ra, "m"),
            f"{S}z": show(self.Rz, "m"),
            f"{S}sk": f"{self.skewness:.4g}",
            f"{S}ku": f"{self.kurtosis:.4g}",
            f"{S}dq": f"{self.Rdq:.4g}",
            f"{S}dr": f"{self.Rdr:.4g}",
        }


def roughness(scan: AreaHeights | LineHeights | Prepared, *, degree: int = 1) -> Roughness:
    """Return the roughness of a scan or profile after levelling by a polynomial of `degree` and without its spikes.

    Missing points are left out, not filled. Raises InputError as `faying.surface.form.prepared` does.
    """
    ready = scan if isinstance(scan, Prepared) else prepared(scan, degree=degree)
    z = ready.scan.heights
    known = z[ready.known]
    known = known - known.mean()
    rq = float(np.sqrt(np.mean(known**2)))
    holes = np.where(ready.known, z, np.nan)
    steps = steps_of(ready.scan)
    slopes = [np.diff(holes, axis=axis) / step for axis, step in enumerate(steps)]
    return Roughness(
        Rq=rq,
        Ra=float(np.mean(np.abs(known))),
        Rz=float(np.ptp(known)),
        skewness=float(np.mean(known**3)) / rq**3,
        kurtosis=float(np.mean(known**4)) / rq**4,
        Rdq=sum(float(np.nanmean(slope**2)) for slope in slopes) ** 0.5,
        Rdr=_developed(slopes),
        areal=z.ndim == 2,
    )


def _developed(slopes: list[Array]) -> float:
    """Developed length or area over the projected one, less 1, from the slopes between neighbours.

    Of a map each cell of four points is two triangles, cut along one diagonal and along the other, in the mean.
    """
    if len(slopes) == 1:
        squares = [slopes[0] ** 2]
    else:
        down, across = slopes
        squares = [a**2 + d**2 for a in (across[:-1], across[1:]) for d in (down[:, :-1], down[:, 1:])]
    # sqrt(1 + s) - 1 without the loss of digits where s is small
    parts = [float(np.nanmean(s / (1 + np.sqrt(1 + s)))) for s in squares]
    return sum(parts) / len(parts)


LENGTHS = 5  # sampling lengths in a line


def mean_peak_to_valley(scan: AreaHeights | LineHeights | Prepared) -> float:
    """Return Rz [m], the mean of highest minus lowest height over five parts of each line, without a filter.

    For an areal scan the larger of that along x and along y: across the lay. Lines are as long as the scan is, be it
    five times the cut-off or not. Points that were filled in count. Raises InputError as `prepared` does.
    """
    ready = scan if isinstance(scan, Prepared) else prepared(scan)
    z = ready.scan.heights

    def mean(lines: Array) -> float:
        parts = (part for part in np.array_split(lines, LENGTHS, axis=1) if part.shape[1])
        return float(np.mean([np.ptp(part, axis=1).mean() for part in parts]))

    return mean(z[None]) if z.ndim == 1 else max(mean(z), mean(z.T))
