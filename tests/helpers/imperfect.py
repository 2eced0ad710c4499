"""Scans with what instruments add and lose: noise and missing points."""

from math import ceil

import numpy as np


def with_noise(scan, *, rms, seed=0):
    """The scan with white Gaussian noise of `rms` [m] at every known point."""
    noise = np.random.default_rng(seed).normal(0, rms, scan.shape)
    return scan.with_heights(scan.heights + noise, f"white noise of {rms:.3g} m added")


def with_missing(scan, *, share, seed=0):
    """The scan with a random share of its points missing."""
    count = ceil(share * scan.heights.size - 1e-9)
    heights = scan.heights.ravel().copy()
    heights[np.random.default_rng(seed).choice(heights.size, count, replace=False)] = np.nan
    return scan.with_heights(heights.reshape(scan.shape), f"{count} points made missing")
