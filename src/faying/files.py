"""Files that appear whole or not at all."""

import os
from collections.abc import Callable
from pathlib import Path

from faying.errors import InputError


def whole(path: Path, write: Callable[[Path], object]) -> Path:
    """Let `write` fill a temporary file beside `path` and move it there, so that no half-written file is left.

    Raises InputError where the folder does not exist or the file cannot be written.
    """
    if not path.parent.is_dir():
        raise InputError(f"no folder {path.parent} to write {path.name} in; make it first")
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        write(temporary)
        os.replace(temporary, path)
    except OSError as fault:
        raise InputError(f"cannot write {path}: {fault.strerror or fault}") from None
    finally:
        temporary.unlink(missing_ok=True)
    return path
