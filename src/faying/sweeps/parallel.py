"""Chunks of evaluations, here or in processes of this machine: what they take and give."""

import os
import threading
import time
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from faying.apart import in_processes
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


LOOK = 0.5  # s between two looks of a worker for its parent


def each(work: Work, chunks: Sequence[Sequence[int]], jobs: int) -> Iterable[tuple[Sequence[int], Rows]]:
    """Evaluate chunk by chunk and yield indices and rows as they come.

    Args:
        work: Makes the rows of some indices; it can be pickled where there are other processes.
        chunks: The indices of each chunk.
        jobs: Processes on this machine.

    Raises:
        FayingError: A process was ended from outside.
    """
    if jobs == 1:
        for indices in chunks:
            yield indices, work(indices)
        return
    calls = [(work, chunk) for chunk in chunks]
    yield from in_processes(_done, calls, jobs, initializer=end_with, initargs=(os.getpid(),))


def _done(work: Work, indices: Sequence[int]) -> tuple[Sequence[int], Rows]:
    return indices, work(indices)


def end_with(parent: int) -> None:
    """End this process soon after its parent, who may be killed in the middle of a chunk that takes minutes.

    Windows keeps the number of a parent that is gone: there, a worker ends with its chunk.
    """

    def watch() -> None:
        while os.getppid() == parent:
            time.sleep(LOOK)
        os._exit(1)

    threading.Thread(target=watch, name=f"parent {parent}", daemon=True).start()
