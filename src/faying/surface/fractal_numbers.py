"""D and G of a surface with their intervals, as an estimator gives them."""

from dataclasses import dataclass, field

from faying import units
from faying.style import Summary
from faying.surface.convention import cut_factor
from faying.surface.estimators.base import EstimateScatter
from faying.surface.heights import AreaHeights, LineHeights
from faying.surface.spectrum import Spectrum


@dataclass(frozen=True, kw_only=True, repr=False)
class FractalNumbers(Summary):
    """The fields of `FractalFit`, which says what they are, and what follows from them."""

    method: str
    D: float
    G: float
    D_interval: tuple[float, float]
    G_interval: tuple[float, float]
    band: tuple[float, float]
    Rq: float
    Ra: float
    implied_Rq: float
    convention: str
    noise: float
    misfit: float
    missing: int
    spikes: int
    warnings: tuple[str, ...] = ()
    scatter: EstimateScatter | None = None
    c: float = 1.0
    areal: bool = True
    drawn: AreaHeights | LineHeights | Spectrum | None = field(default=None, compare=False)

    @property
    def surface_G(self) -> float:
        """G [m] of the surface: that of a scan itself; of a profile that of the isotropic surface it is cut from.

        The power of a profile is a part of that of its surface, the mean of |cos|^(6 - 2 D) over all directions, and
        G^(2 D - 4) goes with it. NaN where a profile has no D between 2 and 3.
        """
        if self.areal:
            return self.G
        return self.G * cut_factor(self.D) ** (-1 / (2 * self.D - 4)) if 2 < self.D < 3 else float("nan")

    def summary(self) -> tuple[str, dict[str, str]]:
        """D and G with their intervals, the band, the rms heights, the convention, and what the user ought to know."""
        (low, high), (least, most) = self.D_interval, self.G_interval
        rms = "Sq" if self.areal else "Rq"
        rows = {
            "D": f"{self.D:.4g}, 95 % interval {low:.4g} to {high:.4g}",
            "G": f"{metres(self.G)}, 95 % interval {metres(least)} to {metres(most)}",
            "band": f"wavelengths from {metres(self.band[0])} to {metres(self.band[1])}",
            rms: f"{metres(self.Rq)}; D and G imply {metres(self.implied_Rq)}",
            "convention": self.convention,
        }
        if self.missing or self.spikes:
            rows["filled in"] = f"{self.missing} missing points and {self.spikes} spikes"
        if self.warnings:
            rows["warnings"] = "; ".join(self.warnings)
        return f"Fractal fit of a {'scan' if self.areal else 'profile'} by {self.method}", rows


def metres(metres: float) -> str:
    """A length [m] as text."""
    return units.show(metres, "m", digits=3)
