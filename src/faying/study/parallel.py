"""Chunks of evaluations, here, in processes of this machine or on a Dask cluster."""

from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
from typing import Any

from faying.errors import InputError
from faying.typing import Array

Rows = dict[str, Array]
Work = Callable[[Sequence[int]], Rows]


def each(
    work: Work, chunks: Sequence[Sequence[int]], jobs: int, dask: str | None
) -> Iterable[tuple[Sequence[int], Rows]]:
    """Evaluate chunk by chunk and yield indices and rows as they come.

    Args:
        work: Makes the rows of some indices; it can be pickled where there are other processes.
        chunks: The indices of each chunk.
        jobs: Processes on this machine.
        dask: Address of a Dask scheduler, in place of processes.

    Raises:
        InputError: No Dask scheduler answers, or its package is missing.
    """
    if dask is None and jobs == 1:
        for indices in chunks:
            yield indices, work(indices)
        return
    if dask is not None:
        try:
            distributed: Any = import_module("distributed")
        except ImportError:
            raise InputError("--dask needs the package distributed: add --extra dask to uv run") from None
        try:
            client = distributed.Client(dask, timeout="10s")
        except OSError as fault:
            raise InputError(f"no Dask scheduler answers at {dask} ({fault}); start one with: dask scheduler") from None
        with client:
            there = client.scatter(work, broadcast=True)
            futures = {client.submit(_done, there, list(indices)): indices for indices in chunks}
            for future in distributed.as_completed(futures):
                yield futures[future], future.result()[1]
        return
    from joblib import Parallel, delayed

    yield from Parallel(n_jobs=jobs, return_as="generator_unordered")(delayed(_done)(work, c) for c in chunks)


def _done(work: Work, indices: Sequence[int]) -> tuple[Sequence[int], Rows]:
    return indices, work(indices)
