"""Files that appear whole or not at all, and rows of numbers read from text."""

import codecs
import errno
import hashlib
import os
import re
import secrets
import shutil
import signal
import socket
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path, PureWindowsPath
from typing import IO, Any
from zipfile import ZipFile

from faying.errors import InputError, ReadError

LATIN = "faying-latin"  # errors of a text that is read: what is not UTF-8 is Latin-1, as instruments write their µ
UTF16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)  # or begins with one of these, as the texts of Windows programs do


def _latin(fault: UnicodeError) -> tuple[str, int]:
    assert isinstance(fault, UnicodeDecodeError)
    if fault.object.startswith(UTF16):
        return fault.object.decode("utf-16", "replace"), len(fault.object)
    return fault.object[fault.start : fault.end].decode("latin-1"), fault.end


codecs.register_error(LATIN, _latin)


def write_atomically(path: Path, write: Callable[[Path], object]) -> Path:
    """Let `write` fill a temporary file beside `path` and move it there, so that no half-written file is left.

    A link is followed, and a device or a pipe is written to. Raises InputError where the folder does not exist or the
    file cannot be written.
    """
    device = path.exists() and not path.is_file() and not path.is_dir()  # /dev/null, a pipe: it stays what it is
    path = path.resolve() if path.is_symlink() and not device else path
    if not path.parent.is_dir():
        raise InputError(f"no folder {path.parent} to write {path.name} in; make it first")
    where = Path(tempfile.gettempdir()) if device else path.parent
    temporary = where / f".{path.name}.{secrets.token_hex(4)}.part"
    try:
        write(temporary)
        with temporary.open("rb+") as file:  # on the disk before it is renamed, so that a power cut finds it whole
            os.fsync(file.fileno())
        _put(temporary, path)
    except OSError as fault:
        raise InputError(f"cannot write {path}: {fault.strerror or fault}") from None
    finally:
        with suppress(OSError):  # on a read-only disk nothing was made, and nothing can be removed
            temporary.unlink(missing_ok=True)
    return path


def _put(file: Path, path: Path) -> None:
    """Move a file to its place: a link is followed, and a device or a pipe is written to."""
    if path.exists() and not path.is_file() and not path.is_dir():
        path.write_bytes(file.read_bytes())
    else:
        target = Path(os.path.realpath(path))
        try:
            os.replace(file, target)
        except OSError as fault:
            if fault.errno != errno.EXDEV:
                raise
            near = target.with_name(f".{target.name}.part")  # a link leads to another disk
            shutil.copyfile(file, near)
            os.replace(near, target)


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

    Two processes do not write to one folder at once: the second is refused before its work. What a process that ended
    has left hidden is taken away.

    Args:
        folder: where the files appear.
        remedy: what to do where it cannot be made.
        kept: names of files that appear even where a fault stops the writing of others.

    Raises:
        InputError: the folder cannot be made, or another process writes to it; faults of writing inside it name the
            file's final place.
    """
    name = f".{Path(os.path.abspath(folder)).name}.part"  # the folder may be given as "."
    if folder.is_symlink() and not folder.exists():
        raise InputError(f"{folder} is a link that leads nowhere; remove it, or {remedy}")
    for left in (folder / name, folder.parent / name):
        if left.is_dir():
            with uninterrupted():
                release(left, locked(left, folder, remedy))
    with new_folder(folder.parent, remedy):
        hidden = folder / name if folder.is_dir() else folder.parent / name
        if folder.exists() and not folder.is_dir():
            raise InputError(f"cannot make the folder {folder}: a file has this name; {remedy}")
        lock = None
        try:
            with uninterrupted():
                lock = locked(hidden, folder, remedy)
            try:
                yield hidden
            except InputError as fault:
                whole = [hidden / one for one in kept if (hidden / one).is_file()]
                with uninterrupted():
                    _appear(folder, whole)
                more = f"; {', '.join(one.name for one in whole)} was written" if whole else ""
                raise InputError(str(fault).replace(str(hidden), str(folder)) + more) from None
            with uninterrupted():
                _appear(folder, sorted(path for path in hidden.iterdir() if path.name != LOCK))
        finally:
            if lock is not None:
                release(hidden, lock)


def _appear(folder: Path, files: Sequence[Path]) -> None:
    """Move files from the hidden folder to their place."""
    if not files:
        return
    try:
        folder.mkdir(exist_ok=True)
        for file in files:
            _put(file, folder / file.name)
    except OSError as fault:
        raise InputError(f"cannot write in {folder}: {fault.strerror or fault}") from None


LOCK = "lock"  # name of the file in a folder that a process holds


def locked(folder: Path, target: Path, remedy: str) -> IO[str]:
    """Hold a folder until the file returned is closed or the process ends, however it ends.

    The system keeps the lock, for processes of all containers and hosts that share the disk. A system or a disk without
    such locks holds nothing.

    Args:
        folder: What is held; it is made where it does not exist.
        target: What the work in it is for.
        remedy: What to do in place of waiting.

    Raises:
        InputError: Another process holds it, or nothing can be written in it.
    """
    path = folder / LOCK
    try:
        while True:
            folder.mkdir(exist_ok=True)
            try:
                file = os.fdopen(os.open(path, os.O_RDWR | os.O_CREAT, 0o666), "r+", encoding="utf-8")
            except FileNotFoundError:
                continue  # whoever held the folder has just removed it
            if not _lock(file):
                holder = file.read() or "another process"
                file.close()
                raise InputError(f"{holder} writes to {target} already; wait for it, or {remedy}")
            with suppress(FileNotFoundError):
                if os.path.samestat(os.fstat(file.fileno()), path.stat()):
                    break
            file.close()  # whoever held it has just removed it
        try:
            file.truncate(0)
            file.write(f"process {os.getpid()} on {socket.gethostname()}")
            file.flush()
        except OSError:  # the disk is full; what else is in the folder stays
            path.unlink()
            with suppress(OSError):
                file.close()
            raise
    except OSError as fault:
        with suppress(OSError):  # it holds something
            folder.rmdir()
        raise InputError(f"cannot write in {folder.parent}: {fault.strerror}; {remedy}") from None
    return file


def _lock(file: IO[str]) -> bool:
    """Lock an open file with what the system has; False where another process holds it."""

    def tried(lock: Callable[[], object]) -> bool:
        try:
            lock()
        except OSError as fault:
            return fault.errno not in (errno.EAGAIN, errno.EACCES, errno.EDEADLK)  # others: the disk has no locks
        return True

    with suppress(ImportError):
        import fcntl

        return tried(lambda: fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB))
    with suppress(ImportError):
        import msvcrt

        lock: Any = getattr(msvcrt, "locking", None)
        return lock is None or tried(lambda: lock(file.fileno(), getattr(msvcrt, "LK_NBLCK", 2), 1))
    return True


def release(folder: Path, lock: IO[str]) -> None:
    """Remove a folder that is held, and let go of it."""
    with uninterrupted():
        if os.name == "nt":  # where an open file cannot be removed
            lock.close()
        shutil.rmtree(folder, ignore_errors=True)
        lock.close()
        with suppress(OSError):  # a disk of another host shows an open file until it is closed
            folder.rmdir()


# what ends a command, with SIGHUP where the system has it: a terminal that is closed
STOPS = (signal.SIGINT, signal.SIGTERM, *[one for one in signal.Signals if one.name == "SIGHUP"])


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Hold what stops a command back for the moment; what came is passed on at the end."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    came: list[int] = []
    before: dict[signal.Signals, Any] = {}
    try:
        for which in STOPS:
            before[which] = signal.signal(which, lambda n, _: came.append(n))
        yield
    finally:
        for which, handler in before.items():
            signal.signal(which, signal.SIG_DFL if handler is None else handler)
    for number in came[:1]:
        signal.raise_signal(number)


def named_by(path: Path, name: str) -> Path:
    """The file that another file names, relative to its own folder.

    Where there is none, the one whose name differs in upper and lower case alone, as on file systems of Windows, which
    also write backslashes; of a full path, which another machine wrote, the file of that name in the folder.
    """
    named = there = path.parent / name
    try:
        if "\0" in name or named.exists():
            return named
        there, steps = path.parent, PureWindowsPath(name)
        for step in (steps.name,) if steps.anchor else steps.parts:
            others = there.iterdir() if there.is_dir() and not (there / step).exists() else ()
            there = next((one for one in others if one.name.lower() == step.lower()), there / step)
    except OSError:  # the name is too long, or a folder may not be read
        return named
    return there


def named_files(path: Path, names: Callable[[bytes], Iterable[str]]) -> list[Path]:
    """A file and those that it names, at any depth, whether they are there or not.

    names: what a file names, from its bytes.
    """
    found = [path]
    for file in found:  # those that it names come to the end
        for name in names(file.read_bytes()) if file.is_file() else ():
            one = named_by(file, name)
            if "\0" not in name and one.resolve() not in {other.resolve() for other in found}:
                found.append(one)
    return found


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
    apart = re.search(r"[\d.]\s*[;\t]|[\d.] +[-+.\d]", re.sub(r"(?<!\s)\s*,\s+|(?<!\s)\s+,", ",", line))
    if apart and _DECIMAL_COMMA.search(line):
        raise ReadError(
            f"{where}: {line.strip()[:60]!r} has decimal commas; write decimal points, as in 4.5, and keep the comma "
            f"for "
            "between numbers"
        )
