"""How hard a metal is against small indentations: Vickers hardness as a power of the diagonal."""

from dataclasses import dataclass, replace
from typing import Self, final

import numpy as np
from numpy.typing import ArrayLike

from faying.checks import number
from faying.errors import InputError
from faying.typing import Array

MICROMETRE = 1e-6
BRINELL_UNIT = 3.178e9  # Pa, H0 of Sridhar and Yovanovich
BRINELL_RANGE = (1.3e9, 7.6e9)  # Pa, of the steels that they fitted
STEEPEST = 1.0  # |c2|; measured values lie between -0.5 and 0.1


@final
@dataclass(frozen=True, kw_only=True)
class VickersHardness:
    """H = c1 (d/1 um)^c2 over the diagonal d of an indentation; small indentations are harder where c2 < 0.

    Args:
        c1: hardness at a diagonal of 1 um [Pa], greater than 0.
        c2: power of the diagonal [-], between -1 and 1; 0 is a hardness without a size.
        least: hardness of the bulk [Pa], which large indentations have; 0 sets no lower end.
        source: where the numbers come from.

    Raises:
        InputError: for values out of range.

    Source:
        Yovanovich 2005, doi:10.1109/TCAPT.2005.848483.
    """

    c1: float
    c2: float
    least: float = 0.0
    source: str = ""

    def __post_init__(self) -> None:
        number(self.c1, "Vickers hardness: c1", "Pa", least=0)
        number(self.least, "Vickers hardness: least", "Pa", least=0, ends="[)")
        number(self.c2, "Vickers hardness: c2", least=-STEEPEST, greatest=STEEPEST)

    @classmethod
    def from_brinell(cls, brinell: float) -> Self:
        """Return the law of size that steels of a Brinell hardness have on average.

        c1 = H0 (4.0 - 5.77 k + 4.0 k^2 - 0.61 k^3), c2 = -0.37 + 0.442 HB/c1, with k = HB/H0 and H0 = 3.178 GPa.

        Args:
            brinell: Brinell hardness HB [Pa], 1.3e9 to 7.6e9; HB 170 is 170 x 9.80665e6 Pa = 1.67e9 Pa.

        Returns:
            The law.

        Raises:
            InputError: the hardness lies outside the range of the fit.

        Source:
            Sridhar and Yovanovich 1996, Wear 193, 91-98, as printed in Yovanovich 2005, doi:10.1109/TCAPT.2005.848483.
        """
        low, high = BRINELL_RANGE
        if not low <= brinell <= high:
            raise InputError(
                f"Brinell hardness {brinell * 1e-9:.4g} GPa: the fit covers {low * 1e-9:g} to {high * 1e-9:g} GPa; "
                "give c1 and c2 measured on your material, or one hardness"
            )
        k = brinell / BRINELL_UNIT
        c1 = BRINELL_UNIT * (4.0 - 5.77 * k + 4.0 * k**2 - 0.61 * k**3)
        text = f"from HB {brinell * 1e-9:.4g} GPa: Sridhar and Yovanovich 1996, Wear 193, 91-98"
        return cls(c1=c1, c2=-0.37 + 0.442 * brinell / c1, least=brinell, source=text)

    def times(self, factor: float) -> Self:
        """Return the law with every hardness times a factor [-]."""
        return replace(self, c1=factor * self.c1, least=factor * self.least)

    def at(self, diagonal: ArrayLike) -> Array:
        """Return the hardness [Pa] of indentations with diagonals [m], any shape; InputError unless positive.

        At least that of the bulk: the power law is measured on small indentations and would fall without end.
        """
        d = np.asarray(diagonal, dtype=float)
        if not np.all((d > 0) & np.isfinite(d)):
            raise InputError("Vickers hardness: the diagonal of an indentation must be positive and finite, in m")
        return np.asarray(np.maximum(self.c1 * (d / MICROMETRE) ** self.c2, self.least))

    def at_share(self, share: float, sigma: float, slope: float) -> float:
        """Return H_c [Pa] of `contact` at the pressure share H_c; share [-], between 0 and 1."""
        mean = self.c1 * (1.62 * sigma / slope / MICROMETRE) ** self.c2
        return float(max(mean * share ** (0.071 * self.c2), self.least))

    def contact(self, pressure: ArrayLike, sigma: float, slope: float) -> Array:
        """Return the hardness H_c that the spots of a rough contact have on average at nominal pressures.

        p/H_c = [p/(c1 (1.62 (sigma/1 um)/m)^c2)]^(1/(1 + 0.071 c2)): the hardness at the size of the mean spot, whose
        diagonal is 1.62 (sigma/m) (p/H_c)^0.071, a Vickers indentation of equal area.

        Args:
            pressure: nominal pressures [Pa], any shape, greater than 0.
            sigma: rms height of both faces together [m].
            slope: mean absolute slope m of profiles of both faces together [-].

        Returns:
            H_c [Pa], of the shape of the pressures.

        Raises:
            InputError: a value is not positive.

        Source:
            Yovanovich 2005, doi:10.1109/TCAPT.2005.848483; Song and Yovanovich 1988, J. Thermophysics 2, 43-47.
        """
        p = np.asarray(pressure, dtype=float)
        if not (np.all((p > 0) & np.isfinite(p)) and 0 < sigma < np.inf and 0 < slope < np.inf):
            raise InputError(
                f"hardness of a contact: pressures, sigma = {sigma:g} m and slope = {slope:g} must be positive and "
                "finite"
            )
        size = self.c1 * (1.62 * sigma / slope / MICROMETRE) ** self.c2
        return np.asarray(np.maximum(p / (p / size) ** (1 / (1 + 0.071 * self.c2)), self.least))
