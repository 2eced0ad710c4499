"""What an evaluation of points takes and gives: indices, and rows of arrays."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from faying.errors import FayingError
from faying.typing import Array

Rows = dict[str, Array]
Work = Callable[[Sequence[int]], Rows]


def rows_of(points: Iterable[int], answer: Callable[[int], Mapping[str, Any]], nothing: Mapping[str, Any]) -> Rows:
    """Rows of some points: what `answer` gives of each, `nothing` where there is no answer, and `reasons` why."""
    rows: dict[str, list[Any]] = {name: [] for name in (*nothing, "reasons")}
    for point in points:
        found, reason = nothing, ""
        try:
            found = answer(point)
        except FayingError as fault:
            reason = str(fault)
        for name, value in {**found, "reasons": reason}.items():
            rows[name].append(value)
    return {name: np.array(values) for name, values in rows.items()}
