"""Calls in processes of their own: on some files a library dies, or never returns; many calls take many cores."""

import pickle
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any, ParamSpec, TypeVar, cast

from faying.errors import FayingError

P = ParamSpec("P")
T = TypeVar("T")
CODE = f"import sys; sys.path[:] = sys.argv[2:]; from {__name__} import serve; serve(sys.argv[1])"


class Died(Exception):
    """The process ended before it had an answer; the text says how, or after how many seconds it was ended."""


def apart(seconds: float | None, function: Callable[P, T], *args: P.args, **named: P.kwargs) -> T:
    """Call a function of a module in a process of its own, and return what it returns.

    Args:
        seconds: that it may take; without end where None.
        function, args, named: what is called; it is found by its name in its module, and arguments and answer can be
            pickled.

    Raises:
        Died: the process died, or took longer.
        FayingError: what the function raised.
    """
    with tempfile.TemporaryDirectory() as folder:
        order, answer = Path(folder) / "order", Path(folder) / "answer"
        order.write_bytes(pickle.dumps((function, args, named)))
        command = [sys.executable, "-c", CODE, str(order), *sys.path]
        try:
            done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=seconds, check=False)
        except subprocess.TimeoutExpired:
            raise Died(f"no end within {seconds:.0f} s") from None
        if done.returncode or not answer.is_file():
            last = done.stderr.decode("utf-8", errors="replace").strip().splitlines()[-1:]
            how = f"signal {-done.returncode}" if done.returncode < 0 else " ".join(last) or f"code {done.returncode}"
            raise Died(how)
        found = pickle.loads(answer.read_bytes())
    if isinstance(found, FayingError):
        raise found
    return cast("T", found)


def in_processes(
    function: Callable[..., T], calls: Sequence[tuple[Any, ...]], jobs: int, **options: Any
) -> Iterator[T]:
    """Call a function with each of some tuples of arguments in so many processes, and yield answers as they come.

    Args:
        function, calls, jobs: what is called, its arguments, and the number of processes.
        options: of joblib's Parallel.

    Raises:
        FayingError: A process was ended from outside; what the function raised.
    """
    from joblib import Parallel, delayed

    pool = Parallel(n_jobs=jobs, return_as="generator_unordered", backend="loky", **options)
    try:
        yield from pool(delayed(function)(*arguments) for arguments in calls)
    except BrokenProcessPool:
        raise FayingError(
            f"one of {jobs} processes was ended from outside, often for lack of memory; call again with fewer of them"
        ) from None


def serve(order: str) -> None:
    """Do what `apart` has asked for; this runs in the process of its own."""
    file = Path(order)
    function, args, named = pickle.loads(file.read_bytes())
    try:
        found = function(*args, **named)
    except FayingError as fault:
        found = fault
    file.with_name("answer").write_bytes(pickle.dumps(found))
