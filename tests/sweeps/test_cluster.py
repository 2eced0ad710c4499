"""Chunks on a Dask cluster of real processes: workers die, differ, or never come."""

import pickle
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import cloudpickle
import numpy as np
import pytest

from faying.errors import FayingError, InputError, NotConverged, ReadError
from faying.study.declaration.reader import StudyFaults
from faying.sweeps import cluster as module
from faying.sweeps.cluster import Parcel
from faying.sweeps.parallel import each
from tests.helpers.cluster import cluster_of, deadly, dying, slow, squares, threads

pytest.importorskip("distributed", reason="the extra dask is not installed")

CHUNKS = [[2 * i, 2 * i + 1] for i in range(8)]  # the second holds index 3


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    """Two workers that allow for more threads than they should take."""
    more = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "2")
    with cluster_of(tmp_path_factory.mktemp("cluster"), 2, **more) as cluster:
        yield cluster


def done(work, address, chunks=CHUNKS, found=None, meanwhile=lambda: None):
    """All rows by index; something may happen after every chunk."""
    found = {} if found is None else found
    for indices, rows in each(work, chunks, 1, address):
        found |= dict(zip(indices, *rows.values(), strict=True))
        meanwhile()
    return found


def expected(chunks=CHUNKS):
    return {i: i * i for chunk in chunks for i in chunk}


def test_a_cluster_does_all_chunks_and_keeps_nothing(pair):
    import distributed

    assert done(squares, pair.address) == expected()
    assert done(squares, pair.address, []) == {}
    with distributed.Client(pair.address, set_as_default=False) as client:
        end = time.monotonic() + 10
        while any(client.has_what().values()) and time.monotonic() < end:
            time.sleep(0.1)
        assert not any(client.has_what().values())


def test_libraries_take_one_thread_for_each_of_the_worker(pair):
    assert set(done(threads, pair.address).values()) == {1}


def test_what_the_work_raises_comes_as_itself(pair):
    def fails(indices):
        raise NotConverged("no equilibrium after 50 steps")

    with pytest.raises(NotConverged, match=r"^no equilibrium after 50 steps$"):
        done(fails, pair.address)

    def wrong(indices):
        return {"squares": np.array([1 / 0])}

    with pytest.raises(ZeroDivisionError):
        done(wrong, pair.address)


def test_every_error_of_ours_comes_through_a_process():
    plain = [FayingError("a"), InputError("a"), ReadError("a"), NotConverged("a")]
    for fault in (*plain, StudyFaults("study.toml", ["bolt: no", "law: no"])):
        again = pickle.loads(pickle.dumps(fault))
        assert type(again) is type(fault)
        assert str(again) == str(fault)
        assert vars(again) == vars(fault)


def test_an_interruption_takes_the_work_from_the_cluster(pair, tmp_path):
    def stop():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        done(partial(slow, tmp_path), pair.address, [[i] for i in range(40)], meanwhile=stop)
    time.sleep(1)  # what a worker is at comes to its end
    begun = len(list(tmp_path.iterdir()))
    time.sleep(1)
    assert len(list(tmp_path.iterdir())) == begun < 20


def test_other_versions_are_refused_before_the_work(pair, monkeypatch):
    other = module.versions() | {"faying": "0.0.9"}
    monkeypatch.setattr(module, "versions", lambda: other)
    here = module.metadata.version("faying")
    with pytest.raises(
        InputError, match=f"the scheduler of the Dask cluster has faying {here}, and this process faying 0"
    ):
        done(squares, pair.address)
    # as on a worker that came after they were compared
    monkeypatch.setattr(module, "_check_versions", lambda client: None)
    with pytest.raises(InputError, match=rf"worker tcp://[0-9.:]* of the Dask cluster has faying {here}, and this"):
        done(squares, pair.address)


def test_versions_are_compared_where_they_matter():
    one = module._short({"python": "3.12.4.final.0", "faying": "0.1.0", "numpy": "2.4.6", "scipy": "1.17.1"})
    assert one == module._short({"python": "3.12.9", "faying": "0.1.0", "numpy": "2.4.0", "scipy": "1.17.0"})
    assert module._difference("x", one, one) == ""
    assert "has faying none, and this process faying 0.1.0" in module._difference(
        "x", module._short({**one, "faying": None}), one
    )


def test_threads_of_a_worker_do_not_share_the_work():
    """Two that are at it at once have a copy each, and take it up again."""
    meet = threading.Barrier(2, timeout=20)
    parcel = Parcel(cloudpickle.dumps(Counting()))

    def run(_):
        meet.wait()
        return parcel.rows([0])["calls"][0]

    with ThreadPoolExecutor(2) as pool:
        assert list(pool.map(run, range(2))) == [1, 1]
    assert parcel.rows([0])["calls"][0] == 2
    assert sys.getsizeof(parcel) >= len(parcel.pickled)


class Counting:
    """Counts its calls, as a recipe keeps its laws."""

    def __init__(self):
        self.calls = 0

    def __call__(self, indices):
        self.calls += 1
        time.sleep(0.2)
        return {"calls": np.array([self.calls for _ in indices])}


def test_work_of_a_dead_worker_is_done_by_another(pair, tmp_path):
    (tmp_path / "once").touch()
    pair.add(1)
    assert done(partial(dying, tmp_path), pair.address) == expected()
    assert len(pair.alive()) == 2


def test_nobody_is_left(tmp_path, monkeypatch):
    """One worker, and work that kills it; then none at all; then no scheduler."""
    monkeypatch.setattr(module, "WAIT", 2.0)
    monkeypatch.setattr(module, "ANSWER", 3.0)
    with cluster_of(tmp_path, 1) as cluster:
        with pytest.raises(FayingError, match=r"has had no worker for 2 s, and points .* are left: start workers"):
            done(deadly, cluster.address)
        with pytest.raises(FayingError, match="has had no worker for 2 s, and samples 0 to 15 are left"):
            list(each(squares, CHUNKS, 1, cluster.address, "samples"))
        cluster.add(1)
        with pytest.raises(FayingError, match="went away, was restarted, or cancelled the work; the same command"):
            done(partial(slow, tmp_path), cluster.address, meanwhile=cluster.scheduler.kill)
        with pytest.raises(InputError, match=r"no Dask scheduler answers at tcp://.*; start one with: dask scheduler"):
            done(squares, cluster.address)


def test_work_that_kills_every_worker_is_named(tmp_path):
    with cluster_of(tmp_path, 2, DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0") as cluster:
        found = {}
        with pytest.raises(FayingError, match=r"every worker died that evaluated points .*2 to 3") as fault:
            done(deadly, cluster.address, found=found)
        assert "All other points are done" in str(fault.value)
        assert len(cluster.alive()) == 1
        # whoever waited at the same worker falls with it
        assert len(found) >= 10
        assert found == {i: i * i for i in found}


def test_an_address_that_is_none():
    with pytest.raises(InputError, match="no Dask scheduler answers at nonsense://here"):
        done(squares, "nonsense://here")


def test_the_package_is_missing(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(InputError, match="--dask needs the package distributed: add --extra dask"):
        done(squares, "tcp://127.0.0.1:1")


def test_indices_in_messages():
    assert module._ranges([[9, 7, 8], [3], [5]]) == "3, 5, 7 to 9"
    assert module._ranges([range(0, 40, 2)]).endswith("14, and so on (20 in all)")
