"""Integrals over frequency of what a few modes answer: nodes and weights that follow their resonances."""

import numpy as np

from faying.service.mode_curve import resistance
from faying.study.vibration import InputTable
from faying.typing import Array, Complex

GAUSS = 10  # nodes of a stretch: its end is as far from the nearest pole as it is long, or farther, which leaves 1e-12
PLACES, WEIGHTS = np.polynomial.legendre.leggauss(GAUSS)


def rule(table: InputTable, speeds: Array, dampings: Array) -> tuple[Array, Array]:
    """Frequencies [Hz] (n,) and weights [Hz] (n,) for integrals over the band of a table.

    Stretches end at the rows of the table and at distances of 1, 2, 4 ... half widths from each resonance.

    Args:
        table: Of the input.
        speeds, dampings: Circular frequencies [rad/s] and damping ratios [-] of the modes (m,).
    """
    first, last = table.frequencies[[0, -1]]
    ends = [table.frequencies]
    for f, zeta in zip(speeds / (2 * np.pi), dampings, strict=True):
        if f > 0 and zeta > 0:
            most = np.log2(max(last, f) / (zeta * f)) + 1
            away = zeta * f * np.concatenate([[0.0], 2.0 ** np.arange(np.ceil(most))])
            ends += [f - away, f + away]
    every = np.unique(np.clip(np.concatenate(ends), first, last))
    middle, half = (every[1:] + every[:-1]) / 2, np.diff(every) / 2
    return (middle[:, None] + half[:, None] * PLACES).ravel(), (half[:, None] * WEIGHTS).ravel()


def resonance(speed: Array | float, damping: Array | float, frequencies: Array) -> Complex:
    """The coordinate of modes (m, n) [s2] under a unit force of frequencies [Hz] (n,)."""
    return 1 / resistance(np.atleast_1d(speed)[:, None], np.atleast_1d(damping)[:, None], 2 * np.pi * frequencies)


def variance(table: InputTable, force: float, speed: float, damping: float) -> float:
    """Mean square of the coordinate of one mode under a density of the input, by its modal force per unit of it."""
    f, weights = rule(table, np.array([speed]), np.array([damping]))
    return float(force**2 * (weights * table.at(f)) @ np.abs(resonance(speed, damping, f)[0]) ** 2)


def greatest(products: Array) -> Array:
    """Root of the greatest eigenvalue of matrices (..., k, k): rms, or amplitude, along the worst direction."""
    return np.asarray(np.sqrt(np.maximum(np.linalg.eigvalsh(products)[..., -1], 0.0)))
