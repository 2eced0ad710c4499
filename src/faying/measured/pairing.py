"""Which mode of the test is which of the model, each once: by MAC and frequency, or by frequency and visibility."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.numerics.follow import partners
from faying.typing import Array, Index

FREQUENCY_SCALE = 0.05  # relative difference in frequency that costs 1
FARTHEST = 0.3  # relative difference in frequency up to which modes are paired at all
MIXED = 0.9  # MAC of a mode with its own successor below which it has mixed with others
SHARE = 0.1  # MAC with another from which that one takes part


def follow(macs: Sequence[Any]) -> Index:
    """Follow modes over loads: (loads, m), the index at each load of the modes that are 0 to m-1 at the first.

    macs: MAC (m, m) of the modes at each load with those at the next; of all one-to-one successions the one with the
    greatest sum is taken.
    """
    count = len(macs[0]) if len(macs) else 0
    tracks = [np.arange(count)]
    for table in macs:
        tracks.append(partners(table)[tracks[-1]])
    return np.array(tracks, dtype=np.int64)


def changes(macs: Sequence[Any]) -> tuple[list[tuple[int, int, int]], list[tuple[int, int, int]]]:
    """Name crossings and couplings: lists of (step, mode, mode), modes as indices at the load where the step begins.

    Two modes cross where their order changes from one load to the next; they couple where one of them, at the next
    load, is less than `MIXED` alike to itself and at least `SHARE` alike to the other.
    """
    cross, couple = [], []
    tracks = [follow([table])[1] for table in macs]
    for step, (table, after) in enumerate(zip(macs, tracks, strict=True)):
        for i in range(len(after)):
            for j in range(i + 1, len(after)):
                if after[i] > after[j]:
                    cross.append((step, i, j))
                mixed = min(table[i][after[i]], table[j][after[j]]) < MIXED
                if mixed and max(table[i][after[j]], table[j][after[i]]) >= SHARE:
                    couple.append((step, i, j))
    return cross, couple


def pair_frequencies(test: Any, model: Any, visibility: Any, *, threshold: float = 0.1) -> Index:
    """The model's mode (t,) of each of the test's, -1 where none fits: one assignment over all modes and loads.

    A pair costs the mean over the loads of (d/.05)^2 - 2 lg v, with d the logarithm of the ratio of the frequencies and
    v the visibility. A peak of the response at the point that is hit grows with the square of the motion there; 5 % in
    frequency count as much as a factor of ten in that peak. No pair is made beyond 30 % in
    frequency, the mean over the loads, nor of a mode that no load shows above the threshold; a mode of the test left
    alone costs as much as the farthest pair. The set of pairs with the least sum is taken.

    Args:
        test: frequencies [Hz] (loads, t).
        model: frequencies [Hz] (loads, m), each column one mode followed over the loads.
        visibility: of the model's modes at the points of the test (loads, m) [-], 1 for the one that moves most.
        threshold: least visibility.
    """
    from scipy.optimize import linear_sum_assignment

    test, model, visibility = (np.atleast_2d(np.asarray(x, dtype=float)) for x in (test, model, visibility))
    apart = np.log(model[:, None, :] / test[:, :, None])
    seen = np.maximum(visibility, 1e-300)
    alone = (np.log1p(FARTHEST) / FREQUENCY_SCALE) ** 2 - 2 * np.log10(threshold)
    cost = (apart / FREQUENCY_SCALE) ** 2 - 2 * np.log10(np.maximum(seen, threshold))[:, None, :]
    cost = cost.mean(axis=0)
    barred = (np.abs(apart).mean(axis=0) > np.log1p(FARTHEST)) | (visibility.max(axis=0) < threshold)[None]
    cost = np.where(barred, 1e6, cost)
    spare = np.full((len(cost), len(cost)), alone)
    rows, columns = linear_sum_assignment(np.concatenate([cost, spare], axis=1))
    out = np.full(len(cost), -1, dtype=np.int64)
    paired = columns < cost.shape[1]
    out[rows[paired]] = columns[paired]
    return out


@dataclass(frozen=True, kw_only=True)
class Paired:
    """Modes that are followed over the loads, and which of them are those of a test.

    tracks (load, m): index at each load of the modes that are 0 to m-1 at the first; frequencies [Hz], visibility
    (load, m): of each mode that is followed; modes (t,): which of these each mode of the test is, -1 for none.
    """

    tracks: Index
    frequencies: Array
    visibility: Array
    modes: Index

    @property
    def predicted(self) -> Array:
        """Frequencies (load, t) [Hz] of the test's modes, NaN where one has no partner."""
        return np.where(self.modes < 0, np.nan, self.frequencies[:, self.modes])


def pair_over_loads(
    test: Array, frequencies: Sequence[Array], motion: Sequence[Array], steps: Sequence[Any], *, threshold: float
) -> Paired:
    """Follow modes over the loads and pair them with those of a test; see `follow` and `pair_frequencies`.

    Args:
        test: Frequencies [Hz] (load, t).
        frequencies, motion: Of the modes at each load (m,); motion is the greatest at the points of the test.
        steps: MAC (m, m) of the modes at each load with those at the next.
        threshold: Least visibility, motion over the greatest of all modes at that load.
    """
    tracks = follow(steps) if len(steps) else np.arange(len(frequencies[0]))[None]
    greatest = np.stack(motion)
    visibility = by_track(tracks, greatest / greatest.max(axis=1, keepdims=True))
    followed = by_track(tracks, np.stack(frequencies))
    modes = pair_frequencies(test, followed, visibility, threshold=threshold)
    return Paired(tracks=tracks, frequencies=followed, visibility=visibility, modes=modes)


def by_track(tracks: Index, values: Array) -> Array:
    """Values (loads, m) of each load's own modes, sorted so that each column follows one mode."""
    return np.take_along_axis(values, tracks, axis=1)


def pair_modes(
    mac: Any, test: Any, model: Any, *, least_mac: float = 0.5, greatest_shift: float = 0.3, weight: float = 0.2
) -> Index:
    """Pairs (k, 2) of indices (test, model), in the order of the test.

    mac (t, m); test, model: frequencies [Hz] (t,), (m,). A pair is allowed where MAC is at least least_mac and the
    frequencies differ by at most greatest_shift of the test's. Of all sets of allowed pairs the one with the greatest
    sum of MAC - weight |df| / (greatest_shift f) is taken (optimal assignment), so that frequency decides where shapes
    look alike at the points of the test. Raises InputError for limits that cannot be.
    """
    if not (0 < least_mac <= 1 and greatest_shift > 0 and 0 <= weight < least_mac):
        raise InputError(
            f"least_mac = {least_mac}, greatest_shift = {greatest_shift}, weight = {weight}: "
            "give 0 < least_mac <= 1, a positive shift and a weight from 0 to below least_mac"
        )
    from scipy.optimize import linear_sum_assignment

    mac = np.asarray(mac, float)
    shift = np.abs(np.asarray(model)[None] / np.asarray(test)[:, None] - 1)
    allowed = (mac >= least_mac) & (shift <= greatest_shift)
    gain = np.where(allowed, mac - weight * shift / greatest_shift, 0.0)
    rows, columns = linear_sum_assignment(gain, maximize=True)
    kept = allowed[rows, columns]
    return np.column_stack([rows[kept], columns[kept]])
