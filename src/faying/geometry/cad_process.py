"""Questions to the CAD kernel, each answered in a process of its own: on some files the kernel dies."""

import json
import subprocess
import sys
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import InputError, ReadError

Task = Callable[[dict[str, Any]], "Answer"]
ORDER, FACTS, ARRAYS, FAULT = "request.json", "facts.json", "arrays.npz", "fault.json"


@dataclass(frozen=True, kw_only=True)
class Answer:
    """What a task hands back.

    Args:
        facts: anything that JSON holds.
        arrays: NumPy arrays by name.
    """

    facts: Any = None
    arrays: Mapping[str, Any] = field(default_factory=dict)


def ask(task: Task, request: Mapping[str, Any], *, path: Path) -> Answer:
    """Let a function of a module answer a request in a process of its own.

    Args:
        task: takes the request and returns an Answer; it raises ReadError and InputError, which are raised here again.
        request: what JSON holds.
        path: the CAD file that it is about, for messages.

    Raises:
        ReadError: the process died on the file, or what the task raised.
        InputError: what the task raised.
    """
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        order = [task.__module__, task.__name__, dict(request)]
        (place / ORDER).write_text(json.dumps(order), encoding="utf-8")
        code = f"import sys; sys.path[:] = sys.argv[2:]; from {__name__} import serve; serve(sys.argv[1])"
        done = subprocess.run(
            [sys.executable, "-c", code, folder, *sys.path], stdin=subprocess.DEVNULL, capture_output=True, check=False
        )
        if (place / FAULT).is_file():
            kind, text = json.loads((place / FAULT).read_text(encoding="utf-8"))
            raise {"ReadError": ReadError, "InputError": InputError}[kind](text)
        if done.returncode or not (place / FACTS).is_file():
            last = done.stderr.decode("utf-8", errors="replace").strip().splitlines()[-1:]
            how = f"signal {-done.returncode}" if done.returncode < 0 else " ".join(last) or f"code {done.returncode}"
            raise ReadError(
                f"{path}: the CAD kernel died on it ({how}); repair the geometry in the CAD program and export it again"
            )
        facts = json.loads((place / FACTS).read_text(encoding="utf-8"))
        with np.load(place / ARRAYS) as data:
            return Answer(facts=facts, arrays=dict(data.items()))


def serve(folder: str) -> None:
    """Do what `ask` has asked for in a folder; this runs in the process of its own."""
    place = Path(folder)
    module, name, request = json.loads((place / ORDER).read_text(encoding="utf-8"))
    task: Task = getattr(import_module(module), name)
    try:
        answer = task(request)
    except (ReadError, InputError) as fault:
        kind = "ReadError" if isinstance(fault, ReadError) else "InputError"
        (place / FAULT).write_text(json.dumps([kind, str(fault)]), encoding="utf-8")
        return
    np.savez(place / ARRAYS, **answer.arrays)
    (place / FACTS).write_text(json.dumps(answer.facts), encoding="utf-8")  # last: it says that all is there
