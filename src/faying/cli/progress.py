"""What long work shows on stderr: one line on a terminal, or a line for each stage, or JSON for a program."""

import json
import re
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from types import TracebackType
from typing import Any, Literal, Self

import click

from faying.progress import duration

Form = Literal["bar", "seldom", "lines", "json", "none"]
WIDTH = 79
SEGMENTS = 20  # of the bar
TICK = 0.5  # s between two drawings of a line in which nothing happens
SELDOM = 30.0  # s between two lines in a pipe or a file
# seconds that the stages of a run take beside each other, counted on the T-specimen; only their ratios matter
SHARES = {"surface": 1.0, "mesh": 5.0, "preload": 4.0, "modes at": 6.0, "frequency": 3.0, "modes free": 9.0}
OTHERS = 3.0


def progress_options(command: Callable[..., Any]) -> Callable[..., Any]:
    """Add -q, -v and --progress to a command; its function takes `progress`."""
    wanted = click.option(
        "--progress",
        type=click.Choice(["bar", "lines", "json", "none"]),
        help="Progress on stderr [bar on a terminal, else a line every 30 s].",
    )
    verbose = click.option("-v", "--verbose", "progress", flag_value="lines", help="A line for each stage.")
    quiet = click.option("-q", "--quiet", "progress", flag_value="none", help="Show no progress.")
    return wanted(verbose(quiet(command)))


class Shown:
    """Shows the stages of long work and the time left; a context manager that is a report.

    Args:
        label: What works, such as "study".
        form: How to show it; a bar on a terminal and a line every 30 s elsewhere where None.
        plan: The stages in their order where they are known before; the time left counts those that are to come.
    """

    def __init__(self, label: str, form: Form | None = None, plan: Sequence[str] = ()) -> None:
        self.label, self.plan = label, list(plan)
        self.form: Form = form or ("bar" if sys.stderr.isatty() else "seldom")
        self.stage, self.done, self.total = "", 0, 0
        self.started = self.began = self.counted = time.monotonic()
        self.times: list[tuple[str, float]] = []  # stages that are over, with the seconds that each took
        self.first = 0  # steps that were done when the count began
        self._lock, self._over = threading.Lock(), threading.Event()

    def __enter__(self) -> Self:
        if self.form in ("bar", "seldom"):
            threading.Thread(target=self._ticking, daemon=True).start()
        return self

    def __exit__(self, kind: type[BaseException] | None, fault: BaseException | None, at: TracebackType | None) -> None:
        self._over.set()
        with self._lock:
            if self.form == "bar" and self.stage:
                sys.stderr.write("\r" + " " * WIDTH + "\r")
                sys.stderr.flush()
            if kind is None and self.form in ("lines", "json"):
                self._say("done", self.total or 1, self.total or 1, None)

    def __call__(self, stage: str, done: int, total: int) -> None:
        """Take a report: what is being done, and how much of it is."""
        with self._lock:
            now, new = time.monotonic(), stage != self.stage
            if new:
                if self.stage:
                    self.times.append((self.stage, now - self.began))
                self.stage, self.began = stage, now
            if total != self.total or done < self.done:
                self.counted, self.first = now, done
            self.done, self.total = done, total
            if self.form == "bar":
                self._draw()
            elif self.form == "json" or (self.form == "lines" and new):
                self._say(stage, done, total, self.left())

    def left(self) -> float | None:
        """Seconds that the work, or this stage of it, will still take; None where nothing tells."""
        now, gained = time.monotonic(), self.done - self.first
        if self.plan:
            return self._planned(now - self.began)
        return (now - self.counted) * (self.total - self.done) / gained if gained > 0 and self.total else None

    def _planned(self, spent: float) -> float | None:
        """Time of the stages to come: as long as earlier ones of their kind, else in proportion to them."""
        seen: dict[str, list[float]] = {}
        for stage, seconds in self.times:
            seen.setdefault(_kind(stage), []).append(seconds)
        if not seen:
            return None
        scale = sum(map(sum, seen.values())) / sum(_share(kind) * len(times) for kind, times in seen.items())

        def expected(stage: str) -> float:
            times = seen.get(_kind(stage))
            return sum(times) / len(times) if times else scale * _share(stage)

        to_come = self.plan[len(self.times) + 1 :]
        return max(expected(self.stage) - spent, 0.0) + sum(map(expected, to_come))

    def _ticking(self) -> None:
        while not self._over.wait(TICK if self.form == "bar" else SELDOM):
            with self._lock, suppress(OSError, ValueError):  # whoever reads stderr may be gone
                if self.stage and not self._over.is_set() and self.form == "bar":
                    self._draw()
                elif self.stage and not self._over.is_set():
                    self._say(self.stage, self.done, self.total, self.left())

    def _draw(self) -> None:
        filled = SEGMENTS * self.done // self.total if self.total else 0
        bar = f"[{'#' * filled}{'-' * (SEGMENTS - filled)}]" if self.total else ""
        count = f"{self.done} of {self.total}" if self.total else f"{time.monotonic() - self.began:.0f} s"
        line = " ".join(part for part in (self.label, bar, f"{self.stage},", count) if part)
        left = self.left()
        line += f", {duration(left)} left" if left is not None else ""
        sys.stderr.write(f"\r{line:<{WIDTH}.{WIDTH}}")
        sys.stderr.flush()

    def _say(self, stage: str, done: int, total: int, left: float | None) -> None:
        elapsed = time.monotonic() - self.started
        if self.form == "json":
            event = {"stage": stage, "done": done, "total": total, "elapsed_s": round(elapsed, 2)}
            line = json.dumps(event | {"left_s": None if left is None else round(left, 1)})
        else:
            line = f"{elapsed:7.1f} s  {stage}" + (f", about {duration(left)} left" if left is not None else "")
        sys.stderr.write(line + "\n")
        sys.stderr.flush()


def _kind(stage: str) -> str:
    """A stage without the numbers in it."""
    return re.sub(r"[\d.]+", "#", stage)


def _share(stage: str) -> float:
    return next((share for words, share in SHARES.items() if stage.startswith(words)), OTHERS)
