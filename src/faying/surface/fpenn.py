"""FPENN: D and G from the spectral moments m0, m2, m4 of a Weierstrass-Mandelbrot series by a small neural network.

After Jiang, Liu, Tian, Zhang and Yang (doi:10.1016/j.chaos.2022.112440), who trained a back-propagation network on
moments of ideal series and tuned it by NSGA-II; its layers and data are not in the published abstract. Ours is a
multilayer perceptron (two hidden layers, tanh) trained by `benchmarks/surface_fpenn_train.py` with L-BFGS on the exact
moments, and its weights are in `fpenn.npz`. Inputs ln(m0/L^2), ln(m2), ln(m4 L^2) and the number of terms; outputs Ds
and (2 Ds - 2) ln(G/L), which is smooth where ln G is not. The exact root of `moments.from_series_moments` does the same
without error, so the network is here to compare with the paper, and its errors against that root are stored with it.
"""

from dataclasses import dataclass, fields
from functools import cache
from math import exp, log
from pathlib import Path
from typing import Any, final

import numpy as np

from faying.errors import InputError
from faying.typing import Array

GAMMA = 1.5  # the ratio of the series' frequencies that the network was trained for
WEIGHTS = Path(__file__).with_name("fpenn.npz")


@final
@dataclass(frozen=True, kw_only=True)
class TrainedRange:
    """Where the network was trained, and its error there against the exact inversion (fresh random cases).

    `D`, `terms` and `log_ratio` (ln(G/L)) are (low, high); `error_D` is the largest and `rms_D` the rms error of D,
    `error_log_level` and `rms_log_level` those of (2 Ds - 2) ln(G/L).
    """

    D: tuple[float, float]
    terms: tuple[int, int]
    log_ratio: tuple[float, float]
    error_D: float
    rms_D: float
    error_log_level: float
    rms_log_level: float


@cache
def _weights() -> dict[str, Any]:
    with np.load(WEIGHTS) as data:
        return {name: data[name] for name in data.files}


def trained_range() -> TrainedRange:
    """Return the range and the errors stored with the weights."""
    stored: dict[str, Any] = {one.name: _weights()[one.name].tolist() for one in fields(TrainedRange)}
    return TrainedRange(**stored | {name: tuple(stored[name]) for name in ("D", "terms", "log_ratio")})


def network(inputs: Array, weights: dict[str, Any]) -> Array:
    """Evaluate the perceptron: `inputs` (n, 4) to outputs (n, 2), in the units of the module's text."""
    h = (inputs - weights["input_mean"]) / weights["input_scale"]
    h = np.tanh(h @ weights["w1"] + weights["b1"])
    h = np.tanh(h @ weights["w2"] + weights["b2"])
    return np.asarray((h @ weights["w3"] + weights["b3"]) * weights["output_scale"] + weights["output_mean"], float)


def from_series_moments(m0: float, m2: float, m4: float, *, length: float, terms: int) -> tuple[float, float]:
    """Return (D, G [m]) that the network sees in the moments m0 [m2], m2 [-], m4 [1/m2] of a series (gamma 1.5).

    `length` [m] is the longest wavelength, `terms` the number of frequencies; Yan-Komvopoulos convention.
    Raises InputError for moments that are not positive or a number of terms that the network was not trained for.
    """
    if not (m0 > 0 and m2 > 0 and m4 > 0 and length > 0):
        raise InputError(f"m0 = {m0}, m2 = {m2}, m4 = {m4}, length = {length}: all must be positive")
    low, high = trained_range().terms
    if not low <= terms <= high:
        raise InputError(
            f"terms = {terms}: the network was trained for {low} to {high} frequencies; use method moments"
        )
    x = np.array([[log(m0 / length**2), log(m2), log(m4 * length**2), float(terms)]])
    Ds, level = network(x, _weights())[0]
    return float(Ds) + 1, length * exp(max(min(float(level / (2 * Ds - 2)), 600.0), -600.0)) if Ds > 1 else 0.0
