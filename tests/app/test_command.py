"""The command, as a user starts and ends it."""

import os
import signal
import subprocess
import sys
import urllib.request

import pytest


@pytest.mark.skipif(os.name != "posix", reason="signals as a terminal sends them")
def test_it_prints_its_address_serves_and_ends_when_it_is_stopped(tmp_path):
    command = [sys.executable, "-m", "faying", "app", str(tmp_path), "--no-open"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as started:
        folder, address = started.stdout.readline().strip(), started.stdout.readline().strip()
        assert folder == str(tmp_path.resolve())
        assert address.startswith("http://127.0.0.1:")
        with urllib.request.urlopen(address, timeout=30) as answer:
            assert "<title>Faying</title>" in answer.read().decode()
        started.send_signal(signal.SIGTERM)  # as Ctrl-C, which a process in the background may have been told to ignore
        try:
            _, fault = started.communicate(timeout=60)
        finally:
            started.kill()
        assert started.returncode == 0
        assert fault == ""


def test_a_folder_that_is_not_there(tmp_path):
    done = subprocess.run(
        [sys.executable, "-m", "faying", "app", str(tmp_path / "none"), "--no-open"],
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert "no folder" in done.stderr
