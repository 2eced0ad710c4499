"""Which mode of the test is which of the model: MAC first, frequency second, each mode once."""

from typing import Any

import numpy as np

from faying.errors import InputError
from faying.typing import Index


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
    return np.array([(t, m) for t, m in zip(rows, columns, strict=True) if allowed[t, m]], dtype=np.int64).reshape(
        -1, 2
    )
