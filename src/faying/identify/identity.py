"""Which mode of a sample is which: that of the median whose shape it has; and which of them are those of the test.

To pair every sample with the test by itself would be a choice that jumps: where frequencies fall far, the mode above
takes the place of the one that is meant. So a mode keeps its name over all samples, by its shape. The samples that come
nearest to the test say which names the test's modes have, and they have them in every sample.
"""

from collections import Counter
from collections.abc import Sequence
from typing import Any

import numpy as np

from faying.measured.mac import mac
from faying.measured.pairing import FARTHEST
from faying.numerics.follow import LIKE, partners
from faying.sweeps.parallel import Rows
from faying.typing import Array, Index

NEAREST, MIN_SAMPLES = 0.1, 8  # share of the samples, and their number, that say which modes are the test's


def named(reference: Sequence[Any], shapes: Sequence[Any], mass: Array) -> Index:
    """Index (load, m) of the mode that has the shape of each of the median's modes, -1 where none has.

    reference, shapes: of the modes of the median and of the sample at each load (d, m); mass: in the basis (d, d).
    """
    pairs = zip(reference, shapes, strict=True)
    return np.array([partners(mac(old.T, new.T, mass), LIKE) for old, new in pairs], dtype=np.int64)


def by_name(values: Array, names: Index) -> Array:
    """Values (load, m) of the modes by name, NaN where a name has none."""
    return np.where(names < 0, np.nan, np.take_along_axis(values, np.maximum(names, 0), axis=1))


def paired_modes(test: Array, rows: Rows) -> Index:
    """Names (t,) of the test's modes, -1 for none: as most of the samples pair them that come nearest to the test.

    test: frequencies [Hz] (load, t); rows: `named` (n, load, m) and `modes` (n, t), the names by which each sample
    pairs the test, NaN where a sample has no answer.
    """
    misfits, all_names = [], []
    for frequencies, modes in zip(rows["named"], rows["modes"], strict=True):
        if np.isnan(modes).any():
            continue
        apart = np.log(paired(frequencies[None], modes.astype(np.int64))[0] / test)
        misfits.append(float(np.mean(np.where(np.isnan(apart), np.log1p(FARTHEST), apart) ** 2)))
        all_names.append(tuple(modes.astype(np.int64).tolist()))
    if not misfits:
        return np.full(test.shape[1], -1)
    nearest = np.argsort(misfits, kind="stable")[: max(MIN_SAMPLES, int(NEAREST * len(misfits)))]
    votes = Counter(all_names[k] for k in nearest)
    return np.array(votes.most_common(1)[0][0], dtype=np.int64)


def paired(values: Array, names: Index) -> Array:
    """Values (n, load, t) of the test's modes from those of all names (n, load, m); NaN where there is no partner."""
    return np.where(names < 0, np.nan, values[:, :, names])
