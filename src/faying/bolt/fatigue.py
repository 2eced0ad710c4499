"""Fatigue of bolts: stress that repeats, the curve of cycles that a bolt bears, and the damage of a load spectrum.

All stresses are amplitudes, half of a range. Damage adds linearly: 1 is failure (Palmgren 1924, Miner 1945).
"""

from dataclasses import dataclass
from math import gamma, log, pi, sqrt
from typing import Self

import numpy as np

from faying.checks import number
from faying.misuse import checked_call
from faying.typing import Array

KNEE = 2e6  # cycles at which both guidelines give their stress
SLOPE = 3.0  # of a bolt's curve above the knee, VDI 2230 Part 1:2015, section 5.5.3, and IEC 61400-6:2020, 6.7.4
DETAIL = 36e6  # Pa, range at the knee of a bolt in tension, EN 1993-1-9:2005, Table 8.1, detail 14
LARGE = 30e-3  # m: bolts beyond have (30 mm/d)^0.25 of it
NODES = 64  # Gauss-Laguerre: damage of a curve of one slope to rounding, of two to 1e-4


@checked_call
@dataclass(frozen=True, kw_only=True)
class FatigueCurve:
    """Cycles that a bolt bears at an amplitude of stress: N = knee (endurance/amplitude)^slope, straight in logarithms.

    Args:
        endurance: Amplitude at the knee [Pa].
        knee: Cycles there.
        slope: Above the endurance.
        slope_below: Below it; infinite where smaller amplitudes do no damage. 0 stands for 2 slope - 1, for loads that
            vary (Haibach 1970).
        source: What it rests on.

    Raises:
        InputError: One of them is not above 0.
    """

    endurance: float
    knee: float = KNEE
    slope: float = SLOPE
    slope_below: float = 0.0
    source: str = "given"

    def __post_init__(self) -> None:
        for name in ("endurance", "knee", "slope"):
            number(getattr(self, name), name, least=0)
        if not self.slope_below:
            object.__setattr__(self, "slope_below", 2 * self.slope - 1)

    @classmethod
    def vdi(cls, diameter: float) -> Self:
        """The curve of a thread rolled before heat treatment, by its diameter [m].

        Source:
            VDI 2230 Part 1:2015, section 5.5.3.
        """
        return cls(endurance=endurance(diameter), source="VDI 2230")

    @classmethod
    def iec(cls, diameter: float) -> Self:
        """The curve of detail category 36 with the effect of size, by the diameter [m].

        Source:
            IEC 61400-6:2020, 6.7.4; EN 1993-1-9:2005, Table 8.1.
        """
        size = min(LARGE / diameter, 1.0) ** 0.25
        return cls(endurance=DETAIL / 2 * size, slope_below=5.0, source="IEC 61400-6")

    def cycles(self, amplitude: Array) -> Array:
        """Cycles to failure at amplitudes of stress [Pa] of any shape; infinite at 0."""
        ratio = np.asarray(amplitude, dtype=float) / self.endurance
        slope = np.where(ratio >= 1, self.slope, self.slope_below)
        with np.errstate(divide="ignore", over="ignore"):
            return np.asarray(self.knee * np.where(ratio > 0, np.maximum(ratio, 0.0), 0.0) ** -slope)

    def damage(self, amplitude: Array, cycles: Array) -> float:
        """Damage [-] of cycles at amplitudes [Pa]."""
        return float(np.sum(np.asarray(cycles, dtype=float) / self.cycles(amplitude)))


def rolled_after(endurance: float, share: float) -> float:
    """Endurance [Pa] of a thread rolled after heat treatment; share: its mean force over that at yield [-]."""
    return endurance * max(2 - share, 1.0)  # VDI 2230 Part 1:2015, section 5.5.3


def endurance(d: float) -> float:
    """Stress amplitude [Pa] that a thread rolled before heat treatment bears 2e6 times and more; d: diameter [m]."""
    return 0.85 * (150 / (1e3 * d) + 45) * 1e6


def narrow_band(curve: FatigueCurve, sigma: float, rate: float) -> float:
    """Damage [1/s] of a Gaussian stress of one frequency: its amplitudes have Rayleigh's distribution.

    Args:
        curve: Of the bolt.
        sigma: Its rms [Pa].
        rate: Cycles a second [Hz].

    Source:
        Miles 1954, doi:10.2514/8.3199; with two slopes by incomplete gamma functions.
    """
    from scipy.special import gammainc, gammaincc

    if sigma <= 0:
        return 0.0
    # E[1/N] with x = a^2/(2 sigma^2) exponential: (2 sigma^2/S^2)^(k/2) times Gamma(1 + k/2) on either side of the knee
    knee = curve.endurance**2 / (2 * sigma**2)

    def side(slope: float, share: float) -> float:
        return float(knee ** (-slope / 2) * gamma(1 + slope / 2) * share)

    above = side(curve.slope, float(gammaincc(1 + curve.slope / 2, knee)))
    low = curve.slope_below
    below = side(low, float(gammainc(1 + low / 2, knee))) if np.isfinite(low) else 0.0
    return rate / curve.knee * (above + below)


def dirlik(curve: FatigueCurve, moments: Array) -> float:
    """Damage [1/s] of a Gaussian stress of any spectrum.

    Args:
        curve: Of the bolt.
        moments: Of its one-sided density [Pa2/Hz]: the integrals of f^n G(f) over f [Hz], n = 0, 1, 2, 4.

    Source:
        Dirlik 1985, thesis, University of Warwick: the distribution of rainflow amplitudes; as in Benasciutti and
        Tovo 2005, doi:10.1016/j.ijfatigue.2004.10.007.
    """
    m0, m1, m2, m4 = (float(one) for one in moments)
    if m0 <= 0:
        return 0.0
    peaks, irregular = sqrt(m4 / m2), m2 / sqrt(m0 * m4)
    mean = m1 / m0 * sqrt(m2 / m4)
    d1 = 2 * (mean - irregular**2) / (1 + irregular**2)
    if irregular > 1 - 1e-9 or not 0 < d1 < 1:
        return narrow_band(curve, sqrt(m0), sqrt(m2 / m0))
    r = (irregular - mean - d1**2) / (1 - irregular - d1 + d1**2)
    d2 = (1 - irregular - d1 + d1**2) / (1 - r) if r < 1 else 0.0
    d3 = 1 - d1 - d2
    q = 1.25 * (irregular - d3 - d2 * r) / d1
    sigma = sqrt(m0)
    # three parts: exponential, and Rayleigh of two widths; z is amplitude over sigma
    exponential, weights = np.polynomial.laguerre.laggauss(NODES)
    first = d1 * float(weights @ (1 / curve.cycles(q * sigma * exponential)))
    second = d2 * narrow_band(curve, abs(r) * sigma, 1.0)
    third = d3 * narrow_band(curve, sigma, 1.0)
    return peaks * (first + second + third)


def sweep_cycles(first: Array | float, last: Array | float, rate: float) -> Array:
    """Cycles of a sine sweep from frequencies [Hz] to others at a rate [octaves/min]."""
    return np.asarray(60 * np.abs(last - first) / (rate * log(2)))


def bending_modulus(area: float) -> float:
    """Modulus in bending [m3] of a round section of an area [m2]."""
    return pi / 32 * sqrt(4 * area / pi) ** 3
