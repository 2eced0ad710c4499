"""Files that appear whole or not at all, and rows of numbers read from text."""

import os
import re
import shutil
import signal
import threading
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any
from zipfile import ZipFile

from faying.errors import InputError, ReadError


def write_atomically(path: Path, write: Callable[[Path], object]) -> Path:
    """Let `write` fill a temporary file beside `path` and move it there, so that no half-written file is left.

    Raises InputError where the folder does not exist or the file cannot be written.
    """
    if not path.parent.is_dir():
        raise InputError(f"no folder {path.parent} to write {path.name} in; make it first")
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        write(temporary)
        _flush(temporary)
        os.replace(temporary, path)
    except OSError as fault:
        raise InputError(f"cannot write {path}: {fault.strerror or fault}") from None
    finally:
        with suppress(OSError):  # on a read-only disk nothing was made, and nothing can be removed
            temporary.unlink(missing_ok=True)
    return path


def write_arrays(path: Path, arrays: Mapping[str, Any]) -> Path:
    """Write arrays in the form of `numpy.savez`, whole or not at all."""
    import numpy as np

    def fill(temporary: Path) -> None:
        # not savez: on a full disk older versions of numpy leave the archive open, which complains when it is collected
        with ZipFile(temporary, "w") as archive:
            for name, array in arrays.items():
                with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
                    np.lib.format.write_array(file, np.asanyarray(array), allow_pickle=False)

    return write_atomically(path, fill)


def write_text(path: Path, text: str) -> Path:
    """Write text in UTF-8 as `write_atomically` does."""
    return write_atomically(path, lambda temporary: temporary.write_text(text, encoding="utf-8"))


def make_folder(folder: Path, remedy: str) -> Path:
    """Make a folder with those above it; InputError that ends in the remedy where that cannot be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as fault:
        raise InputError(f"cannot make the folder {folder}: {fault.strerror}; {remedy}") from None
    return folder


def _flush(path: Path) -> None:
    """Wait until a file is on the disk, so that a power cut after the renaming finds it whole."""
    with path.open("rb+") as file:
        os.fsync(file.fileno())


@contextmanager
def new_folder(folder: Path, remedy: str) -> Iterator[Path]:
    """Make a folder before hours of work, and take away what is new and empty if they come to nothing."""
    new = [path for path in (folder, *folder.parents) if not path.exists()]
    make_folder(folder, remedy)
    try:
        yield folder
    except BaseException:
        for path in new:
            with suppress(OSError):  # it holds something by now
                path.rmdir()
        raise


@contextmanager
def together(folder: Path, remedy: str) -> Iterator[Path]:
    """Give a hidden folder to write in, whose files appear in `folder` together, or not at all after any fault.

    The hidden folder stands in `folder` where that exists, so that both are on one disk, else beside it. Made before
    the work, it shows in time where nothing can be written. Files of other names in `folder` stay as they are.

    Raises:
        InputError: the folder cannot be made; faults of writing inside it name the file's final place.
    """
    name = f".{folder.name}.{os.getpid()}.part"
    with new_folder(folder.parent, remedy):
        hidden = folder / name if folder.is_dir() else folder.with_name(name)
        if folder.exists() and not folder.is_dir():
            raise InputError(f"cannot make the folder {folder}: a file has this name; {remedy}")
        try:
            hidden.mkdir()
        except OSError as fault:
            raise InputError(f"cannot write in {hidden.parent}: {fault.strerror}; {remedy}") from None
        try:
            try:
                yield hidden
            except InputError as fault:
                raise InputError(str(fault).replace(str(hidden), str(folder))) from None
            with uninterrupted():
                if hidden.parent != folder:
                    hidden.rename(folder)
                else:
                    for file in sorted(hidden.iterdir()):
                        os.replace(file, folder / file.name)
        finally:
            shutil.rmtree(hidden, ignore_errors=True)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold Ctrl-C and SIGTERM back for the moment; what came is passed on at the end."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    before = {n: signal.signal(n, lambda n, _: came.append(n)) for n in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for which, handler in before.items():
            signal.signal(which, signal.SIG_DFL if handler is None else handler)
    for number in came[:1]:
        signal.raise_signal(number)


def end_of(path: Path) -> tuple[str, ...]:
    """A note where a text file's last line has no line break: it may have been cut short. None for other files.

    A file that was cut where a line ends cannot be told from a shorter one (docs/decisions/0021-files-cut-short.md).
    """
    with path.open("rb") as handle:
        head = handle.read(4096)
        handle.seek(-min(path.stat().st_size, 4096), 2)
        tail = handle.read()
    # instruments write numbers behind a head of text
    if not head or head[:2] == b"PK" or not all(b in b"\t\n\r\x0c\x1a" or b >= 32 for b in head + tail):
        return ()
    return () if tail[-1:] in b"\r\n\x1a" else (f"{path}: the last line has no line break; the file may be cut short",)


_DECIMAL_COMMA = re.compile(r"(?<![\d.,])\d+,\d+(?:[eE][-+]?\d+)?(?=\s*[;\t]|[ ]+[-+.\d]|$)")


def refuse_decimal_comma(line: str, where: str) -> None:
    """Raise ReadError where numbers are written with a decimal comma: other separators stand between the numbers."""
    apart = re.search(r"[\d.]\s*[;\t]|[\d.] +[-+.\d]", re.sub(r"\s*,\s+|\s+,", ",", line))
    if apart and _DECIMAL_COMMA.search(line):
        raise ReadError(
            f"{where}: {line.strip()[:60]!r} has decimal commas; write decimal points, as in 4.5, and keep the comma "
            f"for "
            "between numbers"
        )
