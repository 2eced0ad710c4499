"""Files that appear whole or not at all, and rows of numbers read from text."""

import hashlib
import os
import re
import shutil
import signal
import threading
from collections.abc import Callable, Iterator, Mapping, Sequence
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
        with temporary.open("rb+") as file:  # on the disk before it is renamed, so that a power cut finds it whole
            os.fsync(file.fileno())
        os.replace(temporary, path)
    except OSError as fault:
        raise InputError(f"cannot write {path}: {fault.strerror or fault}") from None
    finally:
        with suppress(OSError):  # on a read-only disk nothing was made, and nothing can be removed
            temporary.unlink(missing_ok=True)
    return path


SEAL = b"FAYING-SHA256 "  # behind the bytes that it is the checksum of, with 64 digits


def seal_of(data: bytes) -> bytes:
    """The checksum that stands behind some bytes in a file; readers of HDF5 and zip pass it over."""
    return SEAL + hashlib.sha256(data).hexdigest().encode()


def is_sealed(path: Path) -> bool | None:
    """Whether a file is as it was written; None where it bears no checksum. Raises OSError where it cannot be read."""
    length = len(SEAL) + 64
    size = path.stat().st_size - length
    digest = hashlib.sha256()
    with path.open("rb") as file:
        if size < 0:
            return None
        file.seek(size)
        seal = file.read()
        if not seal.startswith(SEAL):
            return None
        file.seek(0)
        while size > 0 and (block := file.read(min(size, 1 << 20))):
            digest.update(block)
            size -= len(block)
    return bool(seal == SEAL + digest.hexdigest().encode())


def write_arrays(path: Path, arrays: Mapping[str, Any], *, seal: bool = True) -> Path:
    """Write arrays in the form of `numpy.savez`, whole or not at all; seal: whether a checksum stands behind them."""
    import numpy as np

    def fill(temporary: Path) -> None:
        # not savez: on a full disk older versions of numpy leave the archive open, which complains when it is collected
        with ZipFile(temporary, "w") as archive:
            for name, array in arrays.items():
                with archive.open(f"{name}.npy", "w", force_zip64=True) as file:
                    np.lib.format.write_array(file, np.asanyarray(array), allow_pickle=False)
        if seal:
            with temporary.open("rb+") as file:
                file.write(SEAL + hashlib.file_digest(file, "sha256").hexdigest().encode())

    return write_atomically(path, fill)


def load_arrays(path: Path) -> dict[str, Any] | None:
    """The arrays of a file of `write_arrays`, None where it is missing or not as it was written."""
    import numpy as np

    try:
        if not is_sealed(path):
            return None
        with path.open("rb") as file, np.load(file, allow_pickle=False) as data:
            return dict(data.items())
    except (OSError, ValueError, EOFError, KeyError):
        return None


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
def together(folder: Path, remedy: str, kept: Sequence[str] = ()) -> Iterator[Path]:
    """Give a hidden folder to write in, whose files appear in `folder` together, or not at all after any fault.

    The hidden folder stands in `folder` where that exists, so that both are on one disk, else beside it. Made before
    the work, it shows in time where nothing can be written. Files of other names in `folder` stay as they are.

    Two processes do not write to one folder at once: the second is refused before its work. What processes that are not
    more have left hidden is taken away.

    Args:
        folder: where the files appear.
        remedy: what to do where it cannot be made.
        kept: names of files that appear even where a fault stops the writing of others.

    Raises:
        InputError: the folder cannot be made, or another process writes to it; faults of writing inside it name the
            file's final place.
    """
    name = f".{folder.name}.{os.getpid()}.part"
    if folder.is_symlink() and not folder.exists():
        raise InputError(f"{folder} is a link that leads nowhere; remove it, or {remedy}")
    _refuse_company(folder, remedy)
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
                whole = [hidden / one for one in kept if (hidden / one).is_file()]
                with uninterrupted():
                    _appear(hidden, folder, whole)
                more = f"; {', '.join(one.name for one in whole)} was written" if whole else ""
                raise InputError(str(fault).replace(str(hidden), str(folder)) + more) from None
            with uninterrupted():
                _appear(hidden, folder, sorted(hidden.iterdir()))
        finally:
            shutil.rmtree(hidden, ignore_errors=True)


def _appear(hidden: Path, folder: Path, files: Sequence[Path]) -> None:
    """Move files from the hidden folder to their place."""
    if not files:
        return
    try:
        folder.mkdir(exist_ok=True)
        for file in files:
            os.replace(file, folder / file.name)
    except OSError as fault:
        raise InputError(f"cannot write in {folder}: {fault.strerror or fault}") from None


def _refuse_company(folder: Path, remedy: str) -> None:
    """Raise InputError where a process that lives writes to the folder; take away what dead ones have left."""
    mark = re.compile(rf"\.{re.escape(folder.name)}\.(\d+)\.part")
    for place in (folder, folder.parent):
        with suppress(OSError):
            for one in [path for path in place.iterdir() if path.is_dir()]:
                found = mark.fullmatch(one.name)
                if found is None or int(found[1]) == os.getpid():
                    continue
                if alive(int(found[1])):
                    raise InputError(
                        f"process {found[1]} writes to {folder} already; wait for it, or {remedy} (or remove {one} "
                        "where no such process is Faying's)"
                    )
                shutil.rmtree(one, ignore_errors=True)


def alive(process: int) -> bool:
    """Whether a process of this number lives on this machine; True where that cannot be known."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True


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
