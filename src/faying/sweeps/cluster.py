"""Chunks of evaluations on a Dask cluster, whose workers may come, die and differ."""

import pickle
from collections.abc import Collection, Generator, Mapping, Sequence
from contextlib import suppress
from functools import cache
from importlib import import_module, metadata
from itertools import chain
from platform import python_version
from queue import Empty, SimpleQueue
from time import monotonic
from typing import Any

from faying.errors import FayingError, InputError
from faying.progress import duration
from faying.sweeps.work import Rows, Work

ANSWER = 10.0  # s that the cluster is given to answer
LOOK = 1.0  # s between two looks at the cluster while nothing comes
WAIT = 300.0  # s without a single worker after which the work is given up: a batch system takes its time to start one
MAX_RANGES = 8  # of indices, in a message
PACKAGES = ("faying", "numpy", "scipy")  # make the numbers, and read what is sent


class Parcel:
    """Work on its way to workers: pickled, and one copy of it for every thread that is at it.

    Threads do not share a copy, since work keeps what it made lately. The copies go with the parcel, which Dask lets go
    of once nobody needs it.

    Args:
        pickled: The work.
    """

    def __init__(self, pickled: bytes) -> None:
        self.pickled = pickled
        self._idle: list[Work] = []

    def __reduce__(self) -> tuple[type["Parcel"], tuple[bytes]]:
        return Parcel, (self.pickled,)

    def __sizeof__(self) -> int:
        return len(self.pickled)  # by this Dask weighs what it sends and keeps

    def rows(self, indices: Sequence[int]) -> Rows:
        """Rows of some indices."""
        try:
            work = self._idle.pop()
        except IndexError:
            work = pickle.loads(self.pickled)
        try:
            return work(indices)
        finally:
            self._idle.append(work)


def on_cluster(
    work: Work, chunks: Sequence[Sequence[int]], address: str, what: str
) -> Generator[tuple[Sequence[int], Rows]]:
    """Evaluate chunk by chunk on a cluster and yield indices and rows as they come.

    What a dead worker leaves is done again by others, as often as the scheduler allows failures.

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
        _check_versions(client)
        # A task and not scattered data: the scheduler makes it anew where its holders die, and starts workers for it.
        with dask.config.set({"distributed.admin.large-graph-warning-threshold": "1 TiB"}):
            parcel = client.submit(Parcel, cloudpickle.dumps(work), pure=False)
        lists = [list(indices) for indices in chunks]
        futures = client.map(evaluated, lists, parcel=parcel, needed=versions(), pure=False, key="faying-chunk")
        left = dict(zip(futures, chunks, strict=True))
        del futures  # results leave the cluster as they leave `left`
        try:
            yield from _collected(client, left, parcel.key, what)
        finally:
            with suppress(Exception):  # there may be no cluster any more
                client.cancel([*left, parcel])


def evaluated(indices: Sequence[int], *, parcel: Parcel, needed: Mapping[str, str]) -> Rows:
    """Rows of some indices on a worker, by one thread: Dask has others at work on other chunks.

    Args:
        indices: Of the chunk.
        parcel: The work.
        needed: Versions of the process that sent it.

    Raises:
        InputError: This worker, which may have come late, has others.
    """
    limits = import_module("threadpoolctl").threadpool_limits
    fault = _difference(f"worker {import_module('distributed').get_worker().address}", versions(), needed)
    if fault:
        raise InputError(fault)
    with limits(limits=1):
        return parcel.rows(indices)


def _collected(
    client: Any, left: dict[Any, Sequence[int]], parcel: str, what: str
) -> Generator[tuple[Sequence[int], Rows]]:
    """Take results out of `left` as they come, and look after the cluster while none does."""
    distributed = import_module("distributed")
    scheduler = import_module("distributed.scheduler")
    address = client.scheduler.address
    ready: SimpleQueue[Any] = SimpleQueue()
    for future in left:
        future.add_done_callback(ready.put)
    deadly: list[Sequence[int]] = []
    seen = monotonic()
    while left:
        try:
            future = ready.get(timeout=LOOK)
            rows = future.result(timeout=ANSWER)
        except (Empty, TimeoutError) as nothing:
            if isinstance(nothing, TimeoutError):
                if future.status == "error":
                    raise
                future.add_done_callback(ready.put)  # its worker died with the result, which is made again
            seen = monotonic() if _has_workers(client) else seen
            if monotonic() - seen > WAIT:
                raise FayingError(_no_workers(address, left.values(), what)) from None
        except scheduler.KilledWorker as fault:
            indices = left.pop(future)
            deadly.append(indices)
            if fault.args[0] == parcel:
                raise FayingError(
                    f"every worker died that took up the work, for {what} {_ranges(deadly)} among others: their logs "
                    "say why, most often for lack of memory; give each more"
                ) from None
        except scheduler.NoValidWorkerError:
            raise FayingError(_no_workers(address, left.values(), what)) from None
        except distributed.CancelledError:
            raise FayingError(
                f"the Dask scheduler at {address} went away, was restarted, or cancelled the work; the same command "
                f"takes up the {what} that are left"
            ) from None
        except (ImportError, RuntimeError) as fault:
            if isinstance(fault, FayingError) or not (
                isinstance(fault, ImportError) or "deserialization" in str(fault)
            ):
                raise
            raise InputError(
                f"the cluster at {address} cannot read what it is sent ({str(fault).strip()}): install the same "
                "packages on its scheduler and all its workers as here, Faying with its extra dask among them"
            ) from fault
        else:
            seen = monotonic()
            yield left.pop(future), rows
    if deadly:
        raise FayingError(
            f"every worker died that evaluated {what} {_ranges(deadly)}: their logs say why, most often for lack of "
            f"memory (give each more, or fewer threads). All other {what} are done; the same command takes up these"
        )


def _has_workers(client: Any) -> bool:
    try:
        return bool(client.nthreads())
    except OSError:  # the scheduler has gone: that comes as cancelled work, unless it returns
        return False


def _no_workers(address: str, left: Collection[Sequence[int]], what: str) -> str:
    return (
        f"the Dask scheduler at {address} has had no worker for {duration(WAIT)}, and {what} {_ranges(left)} are left: "
        f"start workers with: dask worker {address}. If those that were there died, their logs say why. The same "
        f"command takes up what is left"
    )


def _ranges(chunks: Collection[Sequence[int]]) -> str:
    """Indices as a text, such as 3, 5 to 9."""
    indices = set(chain.from_iterable(chunks))
    starts = sorted(i for i in indices if i - 1 not in indices)
    ends = sorted(i for i in indices if i + 1 not in indices)
    texts = [f"{a}" if a == b else f"{a} to {b}" for a, b in zip(starts, ends, strict=True)]
    more = [f"and so on ({len(indices)} in all)"] if len(texts) > MAX_RANGES else []
    return ", ".join([*texts[:MAX_RANGES], *more])


def _check_versions(client: Any) -> None:
    """Compare versions on the scheduler and the workers that are there with those of this process."""
    found = client.get_versions(packages=list(PACKAGES))
    needed = versions()
    places = {"the scheduler": found["scheduler"]} | {f"worker {key}": v for key, v in found["workers"].items()}
    for place, known in places.items():
        fault = _difference(place, _short(known["packages"]), needed)
        if fault:
            raise InputError(fault)


@cache
def versions() -> dict[str, str]:
    """Versions of this process that have to be those of the workers."""
    known: dict[str, str | None] = {"python": python_version()}
    for name in PACKAGES:
        with suppress(metadata.PackageNotFoundError):
            known[name] = metadata.version(name)
    return _short(known)


def _short(known: Mapping[str, str | None]) -> dict[str, str]:
    """Versions as they are compared: Faying's in full, of the others the first two numbers."""
    out = {}
    for name in ("python", *PACKAGES):
        version = known.get(name) or "none"
        out[name] = version if name == "faying" else ".".join(version.split(".")[:2])
    return out


def _difference(place: str, there: Mapping[str, str], needed: Mapping[str, str]) -> str:
    """What is wrong with the versions at a place; empty where nothing is."""
    wrong = [name for name in needed if there.get(name) != needed[name]]
    if not wrong:
        return ""
    has, here = (", ".join(f"{name} {of.get(name, 'none')}" for name in wrong) for of in (there, needed))
    return f"{place} of the Dask cluster has {has}, and this process {here}: install the same everywhere"
