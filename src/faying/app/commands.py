"""Commands of Faying as processes: short ones that are waited for, and one long job at a time."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, final

from faying.errors import InputError

PROGRAM = (sys.executable, "-m", "faying")
PATIENCE = 600.0  # s that a short command may take
GRACE = 10.0  # s between asking a job to stop and ending it
MAX_LINES = 200  # lines of a job's words


def _environment() -> dict[str, str]:
    """That of this process; the package is found where this process found it."""
    return os.environ | {"PYTHONPATH": os.pathsep.join(path for path in sys.path if path), "NO_COLOR": "1"}


def answer(arguments: Sequence[str], folder: Path) -> dict[str, Any]:
    """Run a short command with --json in a folder, and return what it prints.

    Raises:
        InputError: What the command says where it fails.
    """
    try:
        done = subprocess.run(
            [*PROGRAM, *arguments, "--json"],
            cwd=folder,
            env=_environment(),
            stdin=subprocess.DEVNULL,
            capture_output=True,
            timeout=PATIENCE,
            check=False,
        )
    except subprocess.TimeoutExpired:
        raise InputError(f"faying {arguments[0]} took more than {PATIENCE:g} s and was ended") from None
    out = done.stdout.decode("utf-8", errors="replace")
    try:
        found = json.loads(out)
    except json.JSONDecodeError:
        words = done.stderr.decode("utf-8", errors="replace").strip()
        raise InputError(words.rpartition("faying: ")[2] or f"faying {arguments[0]} failed") from None
    return dict(found)


def _event(line: str) -> dict[str, Any] | None:
    """What a line of progress says; None for other words."""
    with suppress(json.JSONDecodeError):
        return dict(json.loads(line)) if line.startswith("{") else None
    return None


@final
class Job:
    """One long command, its progress as it says it, and its end."""

    def __init__(self, arguments: Sequence[str], folder: Path) -> None:
        self.command = " ".join(["faying", *arguments])
        self.started, self.ended = time.time(), 0.0
        self.progress: dict[str, Any] = {"stage": "starting", "done": 0, "total": 0, "elapsed_s": 0.0, "left_s": None}
        self.words: list[str] = []
        self.cancelled = False
        self._process = subprocess.Popen(
            [*PROGRAM, *arguments, "--progress", "json"],
            cwd=folder,
            env=_environment(),
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
        )
        self._readers = [threading.Thread(target=self._read, args=(which,), daemon=True) for which in ("out", "err")]
        for reader in self._readers:
            reader.start()
        threading.Thread(target=self._wait, daemon=True).start()

    def _read(self, which: str) -> None:
        stream = self._process.stdout if which == "out" else self._process.stderr
        assert stream is not None
        with stream:
            for raw in stream:
                line = raw.decode("utf-8", errors="replace").rstrip()
                event = _event(line) if which == "err" else None
                if event is None:
                    self.words = [*self.words, line][-MAX_LINES:]
                else:
                    self.progress = event

    def _wait(self) -> None:
        self._process.wait()
        for reader in self._readers:
            reader.join()
        self.ended = time.time()

    @property
    def running(self) -> bool:
        """Whether it has not ended yet."""
        return self.ended == 0.0

    def cancel(self) -> None:
        """Ask it to stop, so that it clears up; end it where it does not."""
        if not self.running or self.cancelled:
            return
        self.cancelled = True
        self._process.terminate()
        timer = threading.Timer(GRACE, self._end)
        timer.daemon = True
        timer.start()

    def _end(self) -> None:
        """End it with the processes that it has started."""
        if self.running and os.name == "posix":
            with suppress(ProcessLookupError):
                os.killpg(self._process.pid, signal.SIGKILL)
        elif self.running:
            self._process.kill()

    def state(self) -> dict[str, Any]:
        """What the page shows of it."""
        done = self._process.returncode == 0
        return {
            "command": self.command,
            "running": self.running,
            "end": None if self.running else "cancelled" if self.cancelled else "done" if done else "failed",
            "started": self.started,
            "seconds": (self.ended or time.time()) - self.started,
            "words": self.words,
            **self.progress,
        }
