"""Chunks of evaluations, here, in processes of this machine or on a Dask cluster."""

from collections.abc import Callable, Iterable, Sequence

from faying.typing import Array

Rows = dict[str, Array]
Work = Callable[[Sequence[int]], Rows]


def each(
    work: Work, chunks: Sequence[Sequence[int]], jobs: int, dask: str | None, what: str = "points"
) -> Iterable[tuple[Sequence[int], Rows]]:
    """Evaluate chunk by chunk and yield indices and rows as they come.

    Args:
        work: Makes the rows of some indices; it can be pickled where there are other processes.
        chunks: The indices of each chunk.
        jobs: Processes on this machine.
        dask: Address of a Dask scheduler, in place of processes.
        what: What the indices count, in messages.

    Raises:
        InputError: No Dask scheduler answers, its package is missing, or its cluster has other versions.
        FayingError: The cluster could not do the work.
    """
    if dask is None and jobs == 1:
        for indices in chunks:
            yield indices, work(indices)
        return
    if dask is not None:
        from faying.sweeps.cluster import on_cluster

        if chunks:
            yield from on_cluster(work, chunks, dask, what)
        return
    from joblib import Parallel, delayed

    yield from Parallel(n_jobs=jobs, return_as="generator_unordered")(delayed(_done)(work, c) for c in chunks)


def _done(work: Work, indices: Sequence[int]) -> tuple[Sequence[int], Rows]:
    return indices, work(indices)
