"""What contact models take from a measured surface: plain numbers, and the levelled heights."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from math import inf, isnan, log, nan, pi, sqrt
from pathlib import Path
from typing import ClassVar, Protocol, Self, final

import numpy as np
from numpy.typing import ArrayLike

from faying.checks import instance, number, real
from faying.contact.parameter import Parameter
from faying.errors import InputError, shown
from faying.materials import ContactPair
from faying.typing import Array

UNITS_OF_SURFACE = {"G": "m", "scan_area": "m^2", "m0": "m^2", "m4": "1/m^2", "h_rms": "m", "shortest": "m"}
AT_SHARE = 0.01  # of the hardness: the pressure at which the size of spots is taken
OF_SCAN = ("scan", "cache", "progress")  # what a law takes from a scan beside numbers


class HeightMap(Protocol):
    """Levelled heights [m] without missing points, and the distances (dx, dy) [m] between them."""

    @property
    def heights(self) -> Array:
        """Heights [m]."""

    @property
    def spacing(self) -> tuple[float, float]:
        """Distances (dx, dy) [m]."""


@dataclass(frozen=True, kw_only=True)
class FractalSurface:
    """D [-] and G [m] in the convention of Yan and Komvopoulos (that of JK), scan_area [m2], gamma, frequency index.

    D and G are NaN where the scan could not be fitted. Raises InputError unless all others are positive and finite.
    """

    D: float
    G: float
    scan_area: float
    gamma: float = 1.5

    def __post_init__(self) -> None:
        for name in tuple(vars(self)):
            value = real(vars(self)[name], f"surface: {name}", UNITS_OF_SURFACE.get(name, ""))
            object.__setattr__(self, name, value)
            if not 0 < value < inf and not (isnan(value) and name in ("D", "G")):
                raise InputError(f"surface: {name} = {value}; it must be positive and finite")

    @property
    def side(self) -> float:
        """Side of the scan [m]."""
        return sqrt(self.scan_area)

    @property
    def G_majumdar_bhushan(self) -> float:
        """G [m] in the convention of Majumdar and Bhushan, whose series lacks the factor ln(gamma)."""
        return float(self.G * log(self.gamma) ** (1 / (2 * (self.D - 2))))


@final
@dataclass(frozen=True, kw_only=True)
class SurfaceInputs(FractalSurface):
    """Numbers of one scan that the models need; SI.

    D, G, scan_area, gamma as in `FractalSurface`; m0 [m2], m2 [-], m4 [1/m2] the moments of a profile, mean over both
    directions; slope, the rms gradient of the surface [-]; h_rms [m]; shortest wavelength that the scan resolves [m];
    mean_slope, the mean absolute slope of a profile [-], mean over both directions, of two faces the root of the sum of
    the squares; not given it is that of Gaussian heights, sqrt(2 m2/pi). Raises InputError unless all are positive.

    m2, m4, slope and mean_slope grow without end as the spacing of the scan falls, if the surface is fractal: they
    belong to it.
    """

    m0: float
    m2: float
    m4: float
    slope: float
    h_rms: float
    shortest: float
    mean_slope: float = nan

    def __post_init__(self) -> None:
        slope, m2 = real(self.mean_slope, "surface: mean_slope"), real(self.m2, "surface: m2")
        if isnan(slope) and m2 > 0:
            object.__setattr__(self, "mean_slope", sqrt(2 * m2 / pi))
        super().__post_init__()
        if self.alpha <= 0.8968:
            raise InputError(
                f"surface: m0 m4/m2^2 = {self.alpha:.4g}; for a random surface it exceeds 1.5: the heights are "
                "smoothed or the form is not removed"
            )

    @classmethod
    def from_heights(cls, heights: ArrayLike, spacing: tuple[float, float], *, D: float, G: float) -> Self:
        """Return the inputs from levelled heights [iy, ix] [m], NaN where missing, and spacing (dx, dy) [m].

        Slopes and curvatures by differences of neighbours, so that the shortest wavelength is twice the
        spacing. Raises InputError for fewer than 5 points a side.
        """
        try:
            given = np.asarray(heights)
        except ValueError:
            given = np.asarray("rows of unequal length")
        z = given.astype(float) if given.dtype.kind in "fiu" else np.zeros(0)
        if not isinstance(spacing, list | tuple | np.ndarray) or len(spacing) != 2:
            raise InputError(f"spacing = {shown(spacing)}; give the two distances (dx, dy) in metres")
        dx, dy = (number(step, "spacing", "m", least=0) for step in spacing)
        if z.ndim != 2 or min(z.shape) < 5:
            raise InputError(f"heights: {shown(heights)}; give a grid of at least 5 x 5 points")
        z = z - np.nanmean(z)
        m2, m4, absolute = [], [], []
        for axis, step in ((1, dx), (0, dy)):
            first = np.diff(z, axis=axis) / step
            second = np.diff(z, 2, axis=axis) / step**2
            m2.append(float(np.nanmean(first**2)))
            absolute.append(float(np.nanmean(np.abs(first))))
            m4.append(float(np.nanmean(second**2)))
        m0 = float(np.nanmean(z**2))
        return cls(
            D=D,
            G=G,
            scan_area=float(z.shape[0] * dy * z.shape[1] * dx),
            m0=m0,
            m2=sum(m2) / 2,
            m4=sum(m4) / 2,
            slope=sqrt(sum(m2)),
            h_rms=sqrt(m0),
            shortest=2 * max(dx, dy),
            mean_slope=sum(absolute) / 2,
        )

    @classmethod
    def from_fractal(cls, *, D: float, G: float, scan_area: float, shortest: float, gamma: float = 1.5) -> Self:
        """Return the inputs of an ideal isotropic fractal surface, summed over its waves down to `shortest` [m].

        Waves l_n = sqrt(scan_area)/gamma^n of variance G^(2D-4) ln(gamma) l^(6-2D)/2 (Yan and Komvopoulos). A profile
        of an isotropic surface has half its squared gradient and 3/8 of its fourth moment. Raises InputError as the
        class, and for D outside 2 to 3 or a shortest wave not below the side.
        """
        lengths = (("G", G, "m"), ("scan_area", scan_area, "m^2"), ("shortest", shortest, "m"))
        G, scan_area, shortest = (number(value, name, unit, least=0) for name, value, unit in lengths)
        D, gamma, side = number(D, "D"), number(gamma, "gamma"), sqrt(scan_area)
        if not (2 < D < 3 and 0 < shortest < side and gamma > 1):
            raise InputError(
                f"D = {D}, G = {G:.6g} m, scan_area = {scan_area:.6g} m2, shortest = {shortest:.6g} m, gamma = "
                f"{gamma}; need D between 2 and 3, G positive, gamma above 1 and the shortest below the side"
            )
        length = side / gamma ** np.arange(int(log(side / shortest) / log(gamma)) + 1)
        variance = G ** (2 * D - 4) * log(gamma) * length ** (6 - 2 * D) / 2
        q = 2 * pi / length
        m0, gradient, fourth = (float(np.sum(variance * q**k)) for k in (0, 2, 4))
        return cls(
            D=D,
            G=G,
            scan_area=scan_area,
            m0=m0,
            m2=gradient / 2,
            m4=3 / 8 * fourth,
            slope=sqrt(gradient),
            h_rms=sqrt(m0),
            shortest=shortest,
            gamma=gamma,
        )

    @property
    def alpha(self) -> float:
        """Bandwidth of Nayak, m0 m4/m2^2 [-]."""
        return self.m0 * self.m4 / self.m2**2

    @property
    def summit_density(self) -> float:
        """Summits per area, (m4/m2)/(6 pi sqrt 3) [1/m2]; McCool 1986, doi:10.1016/0043-1648(86)90045-1."""
        return self.m4 / self.m2 / (6 * pi * sqrt(3))

    @property
    def summit_radius(self) -> float:
        """Mean radius of summits, (3/8) sqrt(pi/m4) [m]."""
        return 3 / 8 * sqrt(pi / self.m4)

    @property
    def summit_deviation(self) -> float:
        """Standard deviation of summit heights, sqrt((1 - 0.8968/alpha) m0) [m]."""
        return sqrt((1 - 0.8968 / self.alpha) * self.m0)


@final
@dataclass(frozen=True, kw_only=True)
class RoughSurface:
    """All that a law can be made from: numbers of a surface, and the levelled scan where there is one.

    Args:
        inputs: `SurfaceInputs` of a scan, or a `FractalSurface` where only D, G and scan_area are known.
        scan: levelled heights with missing points filled in; None where there is no areal scan.
        cache: folder that keeps solved contacts of the scan; None keeps nothing.
        unfitted: why the scan has no D and G; empty where it has.
        progress: called with (solutions done, solutions in all) while contacts of the scan are solved.
    """

    inputs: FractalSurface
    scan: HeightMap | None = None
    cache: Path | None = None
    unfitted: str = ""
    progress: Callable[[int, int], object] | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        instance(self.inputs, FractalSurface, "inputs", "give SurfaceInputs or a FractalSurface")

    FRACTAL: ClassVar = ("D", "G", "scan_area", "gamma", "side", "G_majumdar_bhushan")

    @classmethod
    def needed_for(cls, numbers: Iterable[str]) -> str:
        """What has to be measured for these numbers: "scan", "moments", "fractal" or "nothing"."""
        wanted = set(numbers) - {""}
        if "scan" in wanted:
            return "scan"
        return "moments" if wanted - set(cls.FRACTAL) else "fractal" if wanted else "nothing"

    def indented(self, pair: ContactPair) -> ContactPair:
        """The pair with the hardness that the spots of this surface have at a hundredth of it.

        As it is where the pair has no hardness over the size of an indentation, or the surface no moments. The
        hardness hardly depends on the pressure: for steel it is 4 % higher at a tenth of it.
        """
        law = pair.vickers
        if law is None or law.c2 == 0 or not isinstance(self.inputs, SurfaceInputs):
            return pair
        hardness = law.at_share(AT_SHARE, self.inputs.h_rms, self.inputs.mean_slope)
        first, second = (
            m if m.is_rigid else replace(m, hardness=hardness, brinell=None, vickers=None)
            for m in (pair.first, pair.second)
        )
        return ContactPair(first, second)

    def supplies(self, parameters: Mapping[str, Parameter]) -> dict[str, object]:
        """Values of those parameters that this surface gives."""
        out: dict[str, object] = {}
        for name, parameter in parameters.items():
            if parameter.surface in OF_SCAN:
                value = getattr(self, parameter.surface)
                if value is not None:
                    out[name] = value
            elif parameter.surface in self.FRACTAL or (parameter.surface and isinstance(self.inputs, SurfaceInputs)):
                number = getattr(self.inputs, parameter.surface)
                if not isnan(number):
                    out[name] = number
        return out
