"""Chunks on a Dask cluster of real processes: workers die, differ, or never come."""

import pickle
import sys
import time
from functools import partial

import numpy as np
import pytest

from faying.errors import FayingError, InputError, NotConverged, ReadError
from faying.study.declaration.reader import StudyFaults
from faying.sweeps import cluster as module
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
    here = module.versions()["faying"]
    other = module.versions() | {"faying": "0.0.9"}
    monkeypatch.setattr(module, "versions", lambda: other)
    with pytest.raises(
        InputError, match=f"the scheduler of the Dask cluster has faying {here}, and this process faying 0"
    ):
        done(squares, pair.address)


def test_versions_are_compared_where_they_matter():
    one = {"python": "3.12.4.final.0", "faying": "0.1.0", "numpy": "2.4.6", "scipy": "1.17.1"}
    module._compare("x", one, {"python": "3.12.9", "faying": "0.1.0", "numpy": "2.4.0", "scipy": "1.17.0"})
    with pytest.raises(InputError, match="has faying none, and this process faying 0.1.0"):
        module._compare("x", {**one, "faying": None}, one)
    with pytest.raises(InputError, match="has numpy 2.3, and this process numpy 2.4"):
        module._compare("x", {**one, "numpy": "2.3.9"}, one)


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
        with pytest.raises(FayingError, match=r"has no worker, and gave nothing for 2 s: .* the points that are left"):
            done(deadly, cluster.address)
        with pytest.raises(FayingError, match=r"gave nothing for 2 s: start workers .* the samples that are left"):
            list(each(squares, CHUNKS, 1, cluster.address, "samples"))
        cluster.add(1)
        with pytest.raises(FayingError, match="went away, was restarted, or cancelled the work; the same command"):
            done(partial(slow, tmp_path), cluster.address, meanwhile=cluster.scheduler.kill)
        with pytest.raises(InputError, match=r"no Dask scheduler answers at tcp://.*; start one with: dask scheduler"):
            done(squares, cluster.address)


def test_work_that_kills_every_worker(tmp_path):
    with cluster_of(tmp_path, 2, DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES="0") as cluster:
        found = {}
        with pytest.raises(FayingError, match=r"every worker died that evaluated \d+ of the points") as fault:
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
