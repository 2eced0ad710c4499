"""A Dask scheduler and its workers as processes of their own, and work that does them harm."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from pathlib import Path

import numpy as np

ROOT = Path(__file__).parents[2]


class Cluster:
    """Without nannies: a worker that dies stays dead."""

    def __init__(self, folder, **settings):
        paths = os.pathsep.join([str(ROOT / "src"), str(ROOT), os.environ.get("PYTHONPATH", "")])
        self.environment = os.environ | {"PYTHONPATH": paths, "PYTHONWARNINGS": "ignore"} | settings
        self.folder, self.workers = folder, {}
        file = folder / "scheduler.json"
        options = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--no-show", "--scheduler-file", str(file)]
        options += ["--idle-timeout", "300s"]  # should the tests be killed
        self.scheduler = self._start("scheduler", *options)
        self._until(lambda: file.exists() and file.read_text().endswith("}"))
        self.address = json.loads(file.read_text())["address"]

    def add(self, count, threads=1, **settings):
        """Start workers, and wait for them."""
        import distributed

        with distributed.Client(self.address, set_as_default=False) as client:
            there = len(client.nthreads())
            for _ in range(count):
                name = f"worker-{len(self.workers)}"
                options = ["--no-nanny", "--nthreads", str(threads), "--no-dashboard", "--memory-limit", "0"]
                options += ["--death-timeout", "20"]
                self.workers[name] = self._start(
                    "worker", self.address, "--name", name, *options, "--local-directory", str(self.folder), **settings
                )
            client.wait_for_workers(there + count, timeout=60)
        return self

    def kill(self, name):
        """End a worker at once, as lack of memory does."""
        self.workers[name].kill()
        self.workers[name].wait()

    def alive(self):
        """Names of the workers that run."""
        return [name for name, process in self.workers.items() if process.poll() is None]

    def close(self):
        """End what still runs."""
        for process in (*self.workers.values(), self.scheduler):
            process.kill()
            process.wait()

    def _start(self, what, *options, **settings):
        log = (self.folder / f"{what}-{len(self.workers)}.log").open("wb")
        command = [sys.executable, "-m", f"distributed.cli.dask_{what}", *options]
        with log:
            return subprocess.Popen(command, env=self.environment | settings, stdout=log, stderr=log)

    def _until(self, true):
        end = time.monotonic() + 60
        while not true():
            assert time.monotonic() < end
            assert self.scheduler.poll() is None, (self.folder / "scheduler-0.log").read_text()
            time.sleep(0.05)


@contextmanager
def cluster_of(folder, workers=2, **settings):
    """A cluster that ends with the block."""
    cluster = Cluster(folder, **settings)
    try:
        yield cluster.add(workers) if workers else cluster
    finally:
        cluster.close()


def squares(indices):
    """Work that does no harm."""
    return {"squares": np.array([i * i for i in indices])}


def dying(folder, indices):
    """Work that kills its worker at index 3, so often as there are files to take from a folder."""
    for file in sorted(folder.iterdir()) if 3 in indices else []:
        file.unlink()
        os.kill(os.getpid(), signal.SIGKILL)
    return squares(indices)


def deadly(indices):
    """Work that kills its worker at index 3, always."""
    if 3 in indices:
        os.kill(os.getpid(), signal.SIGKILL)
    return squares(indices)


def slow(folder, indices):
    """Work that takes its time, and leaves a file for each index."""
    time.sleep(0.3)
    for i in indices:
        (folder / str(i)).touch()
    return squares(indices)


def threads(indices):
    """Threads of every BLAS and OpenMP on the worker, the most."""
    from threadpoolctl import threadpool_info

    return {"threads": np.array([max(pool["num_threads"] for pool in threadpool_info()) for _ in indices])}
