"""Chunks of evaluations on a Dask cluster, whose workers may come, die and differ."""

import pickle
from collections.abc import Generator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from importlib import import_module
from queue import Empty, SimpleQueue
from typing import Any

from faying.errors import FayingError, InputError
from faying.progress import duration
from faying.sweeps.work import Rows, Work

ANSWER = 10.0  # s that the scheduler is given to answer
WAIT = 300.0  # s without a result after which there has to be a worker: a batch system takes its time to start one
PACKAGES = ("python", "faying", "numpy", "scipy")  # make the numbers, and read what is sent


def on_cluster(
    work: Work, chunks: Sequence[Sequence[int]], address: str, what: str
) -> Generator[tuple[Sequence[int], Rows]]:
    """Evaluate chunk by chunk on a cluster and yield indices and rows as they come.

    What a dead worker leaves is done again by others, as often as the scheduler allows failures. joblib has a backend
    for Dask, which is not used here: it never returns where a chunk has killed its workers.

    Args:
        work: Makes the rows of some indices; it can be pickled.
        chunks: The indices of each chunk.
        address: Of the scheduler.
        what: What the indices count, in messages.

    Raises:
        InputError: No scheduler answers, its package is missing, or the cluster runs other versions than this process.
        FayingError: No worker for a while, chunks that kill their workers, or a scheduler that went away; what the work
            itself raised comes as it is.
    """
    try:
        dask, distributed, cloudpickle = map(import_module, ("dask", "distributed", "cloudpickle"))
    except ImportError:
        raise InputError("--dask needs the package distributed: add --extra dask to uv run") from None
    try:
        client = distributed.Client(address, timeout=ANSWER, set_as_default=False)
    except (OSError, ValueError) as fault:
        raise InputError(f"no Dask scheduler answers at {address} ({fault}); start one with: dask scheduler") from None
    with client:
        found = client.get_versions(packages=list(PACKAGES[1:]))
        _compare("the scheduler", found["scheduler"]["packages"], versions())
        for worker, known in found["workers"].items():
            _compare(f"worker {worker}", known["packages"], versions())
        # A task and not scattered data: the scheduler makes it anew where its holders die, and starts workers for it.
        with dask.config.set({"distributed.admin.large-graph-warning-threshold": "1 TiB"}):
            pickled = client.submit(bytes, cloudpickle.dumps(work), pure=False)
        lists = [list(indices) for indices in chunks]
        futures = client.map(evaluated, lists, pickled=pickled, needed=versions(), pure=False, key="faying-chunk")
        left = dict(zip(futures, chunks, strict=True))
        del futures  # results leave the cluster as they leave `left`
        try:
            yield from _collected(client, left, what)
        finally:
            with suppress(Exception):  # there may be no cluster any more
                client.cancel([*left, pickled])


def evaluated(indices: Sequence[int], *, pickled: bytes, needed: Mapping[str, str]) -> Rows:
    """Rows of some indices on a worker, by one thread: Dask has others at work on other chunks.

    Threads do not share the work, since it keeps what it made lately.

    Args:
        indices: Of the chunk.
        pickled: The work.
        needed: Versions of the process that sent it.

    Raises:
        InputError: This worker, which may have come late, has others.
    """
    _compare(f"worker {import_module('distributed').get_worker().address}", versions(), needed)
    with import_module("threadpoolctl").threadpool_limits(limits=1):
        rows: Rows = pickle.loads(pickled)(indices)
        return rows


def _collected(client: Any, left: dict[Any, Sequence[int]], what: str) -> Generator[tuple[Sequence[int], Rows]]:
    """Take results out of `left` as they come, and ask for workers where none comes."""
    cancelled = import_module("distributed").CancelledError
    killed = import_module("distributed.scheduler").KilledWorker
    address = client.scheduler.address
    deadly = 0
    ready: SimpleQueue[Any] = SimpleQueue()
    for future in left:
        future.add_done_callback(ready.put)
    while left:
        try:
            future = ready.get(timeout=WAIT)
            rows = future.result(timeout=WAIT)
        except (Empty, TimeoutError) as nothing:
            if isinstance(nothing, TimeoutError):
                if future.status == "error":
                    raise
                future.add_done_callback(ready.put)  # its worker died with the result, which is made again
            if not client.nthreads():
                raise FayingError(
                    f"the Dask scheduler at {address} has no worker, and gave nothing for {duration(WAIT)}: start "
                    f"workers with: dask worker {address}. If those that were there died, their logs say why. The "
                    f"same command takes up the {what} that are left"
                ) from None
        except killed:
            deadly += len(left.pop(future))
        except cancelled:
            raise FayingError(
                f"the Dask scheduler at {address} went away, was restarted, or cancelled the work; the same command "
                f"takes up the {what} that are left"
            ) from None
        else:
            yield left.pop(future), rows
    if deadly:
        raise FayingError(
            f"every worker died that evaluated {deadly} of the {what}: their logs say why, most often for lack of "
            f"memory (give each more, or fewer threads). All other {what} are done; the same command takes up these"
        )


@cache
def versions() -> dict[str, str | None]:
    """Versions of this process, as Dask finds those of a cluster."""
    known: dict[str, str | None] = import_module("distributed.versions").get_versions(list(PACKAGES[1:]))["packages"]
    return {name: known.get(name) for name in PACKAGES}


def _compare(place: str, there: Mapping[str, str | None], needed: Mapping[str, str | None]) -> None:
    """Raise InputError where Faying differs at a place, or the first two numbers of another package."""

    def short(name: str, version: str | None) -> str:
        return version or "none" if name == "faying" else ".".join((version or "none").split(".")[:2])

    pairs = {name: (short(name, there.get(name)), short(name, needed[name])) for name in needed}
    wrong = {name: pair for name, pair in pairs.items() if pair[0] != pair[1]}
    if wrong:
        has, here = (", ".join(f"{name} {pair[k]}" for name, pair in wrong.items()) for k in (0, 1))
        raise InputError(f"{place} of the Dask cluster has {has}, and this process {here}: install the same everywhere")
