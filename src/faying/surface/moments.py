"""The slope of a power law from the ratio of two spectral moments.

The finite Weierstrass-Mandelbrot series with frequencies f_n and amplitudes A_n^2 = c G^(2Ds-2) ln(gamma) f_n^-(4-2Ds)
has m_2k = (2 pi)^(2k) sum_n A_n^2 f_n^(2k) / 2. m2/m0 depends on Ds alone, so one root gives Ds; so it is in a band of
a surface's spectrum. The network of Jiang et al. (FPENN, doi:10.1016/
j.chaos.2022.112440), from which the JK model has D and G, learns this same map.
"""

from math import log

import numpy as np
from numpy.typing import ArrayLike

from faying.errors import InputError

# Ds is looked for in this range; the power law has no finite variance per octave outside (1, 2)
LOWEST_DS, HIGHEST_DS = 0.5, 2.5


def invert_ratio(ratio: float, frequency: ArrayLike, weight: ArrayLike) -> float:
    """Return the slope b for which sum(weight f^(2-b)) / sum(weight f^-b) = ratio; a one-dimensional root.

    Raises InputError where no slope between 5 - 2*2.5 and 5 - 2*0.5 has this ratio.
    """
    from scipy.optimize import brentq

    f, w = np.asarray(frequency, float), np.asarray(weight, float)
    scale = float(np.exp(np.mean(np.log(f))))
    x = np.log(f / scale)
    target = log(ratio) - 2 * log(scale)

    def excess(b: float) -> float:
        a = w * np.exp(-b * x)
        return float(np.log(np.sum(a * np.exp(2 * x)) / np.sum(a))) - target

    low, high = 5 - 2 * HIGHEST_DS, 5 - 2 * LOWEST_DS
    if excess(low) < 0 or excess(high) > 0:
        raise InputError(
            f"the ratio of spectral moments {ratio:.4g} fits no dimension between 1 and 2 over the wavelengths "
            f"{1 / f.max():.3g} .. {1 / f.min():.3g} m; check the band and the unit of the heights"
        )
    return float(brentq(excess, low, high, xtol=1e-15, rtol=8.9e-16))
