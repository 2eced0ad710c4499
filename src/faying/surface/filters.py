"""Gaussian filters of ISO 16610-21 (profiles) and ISO 16610-61 (areal): waviness and roughness parted at a cut-off."""

from math import log, pi
from typing import cast

import numpy as np

from faying.errors import InputError
from faying.surface.form import Lines
from faying.surface.heights import sides_of, steps_of

ALPHA = (log(2) / pi) ** 0.5  # half the amplitude passes at the cut-off


def gaussian_lowpass(scan: Lines, cutoff: float) -> Lines:
    """Return the waves longer than `cutoff` [m] (half the amplitude at the cut-off itself).

    The weighting function is s(x) = exp(-pi (x/(a c))^2)/(a c), a = (ln 2/pi)^(1/2) (ISO 16610-21, eq. 1), along both
    axes of a scan. Near borders and missing points it is normalised over the known points; missing points stay so.
    Raises InputError for cut-offs below two spacings or above the side.
    """
    from scipy.ndimage import gaussian_filter

    steps, side = steps_of(scan), min(sides_of(scan))
    if not 2 * max(steps) <= cutoff <= side:
        raise InputError(
            f"cutoff = {cutoff} m: give a wavelength between twice the spacing, {2 * max(steps):.4g} m, and the side, "
            f"{side:.4g} m"
        )
    known = ~np.isnan(scan.heights)
    # exp(-x^2/(2 s^2)) with s = a c/(2 pi)^(1/2)
    sigma = [ALPHA * cutoff / (2 * pi) ** 0.5 / d for d in steps]
    offset = float(scan.heights[known].mean()) if known.any() else 0.0
    smooth = gaussian_filter(np.where(known, scan.heights - offset, 0.0), sigma, mode="constant", truncate=6)
    weight = gaussian_filter(known.astype(float), sigma, mode="constant", truncate=6)
    heights = np.where(known, smooth / np.maximum(weight, 1e-300) + offset, np.nan)
    return cast("Lines", scan.with_heights(heights, f"Gaussian low-pass, cut-off {cutoff:.4g} m"))
