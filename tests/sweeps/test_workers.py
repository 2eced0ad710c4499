"""Processes that evaluate chunks: they end with the one that started them, however it ends."""

import os
import pickle
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from faying.errors import FayingError, InputError, NotConverged, ReadError
from faying.study.declaration.reader import StudyFaults
from faying.sweeps.parallel import each
from tests.fuzz.kills import of_session

ROOT = Path(__file__).parents[2]
SCRIPT = """
import signal, sys, time, functools
import numpy as np
from faying.sweeps.parallel import each

def slow(folder, indices):
    open(f"{folder}/{indices[0]}", "w").close()
    time.sleep(60)
    return {"x": np.zeros(len(indices))}

if __name__ == "__main__":
    signal.signal(signal.SIGHUP, signal.SIG_DFL)  # nohup hands on that it is ignored
    list(each(functools.partial(slow, sys.argv[1]), [[0], [1]], 2))
"""


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="looks for processes in /proc")
@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGHUP])
def test_no_worker_outlives_its_parent_by_two_seconds(tmp_path, number):
    script = tmp_path / "slow.py"
    script.write_text(SCRIPT)
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([str(ROOT / "src"), os.environ.get("PYTHONPATH", "")])}
    process = subprocess.Popen([sys.executable, script, tmp_path], env=environment, start_new_session=True)
    end = time.monotonic() + 60
    while not all((tmp_path / name).exists() for name in "01"):  # both workers are in the middle of their chunk
        assert time.monotonic() < end
        time.sleep(0.05)
    assert len(of_session(process.pid)) > 2
    process.send_signal(number)
    process.wait(10)
    end = time.monotonic() + 2
    while of_session(process.pid) and time.monotonic() < end:
        time.sleep(0.05)
    left = of_session(process.pid)
    for one in left:
        os.kill(one, signal.SIGKILL)
    assert not left


def killed(indices):
    """A chunk of a sweep whose second process is killed, as the kernel does where memory ends."""
    if indices[0] == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    return {"x": np.zeros(len(indices))}


def test_a_worker_that_is_killed_is_a_fault_in_words():
    with pytest.raises(FayingError, match="one of 2 processes was ended from outside, often for lack of memory"):
        list(each(killed, [[0], [1], [2]], 2))


def test_every_error_of_ours_comes_through_a_process():
    plain = [FayingError("a"), InputError("a"), ReadError("a"), NotConverged("a")]
    for fault in (*plain, StudyFaults("study.toml", ["bolt: no", "law: no"])):
        again = pickle.loads(pickle.dumps(fault))
        assert type(again) is type(fault)
        assert str(again) == str(fault)
        assert vars(again) == vars(fault)
