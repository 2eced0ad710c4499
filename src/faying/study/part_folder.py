"""The folder OUT.part that long work keeps beside its output, so that it goes on where it was stopped."""

import hashlib
import json
from collections.abc import Mapping
from pathlib import Path
from typing import IO, Any, Self

from faying import __version__
from faying.errors import FayingError, InputError
from faying.files import LOCK, load_arrays, locked, release, write_arrays, write_text
from faying.study.study import Study


class PartFile:
    """What long work keeps in the folder OUT.part, locked and labelled with what it belongs to.

    Without an output nothing is kept. It is a context: at the end it lets go of the folder, and removes it where
    Faying has refused the work before anything was kept, so that it bars no other.

    Args:
        out: The output, ending in .nc, or None.
        fingerprint: What tells this work from another, from `fingerprint`.
        what: The name of such work in messages, and of the label.

    Raises:
        InputError: The output is not an .nc file in an existing folder, is in use, or has other work in it.
    """

    def __init__(self, out: Path | None, fingerprint: str = "", *, what: str) -> None:
        self.folder: Path | None = None
        self._lock: IO[str] | None = None
        if out is not None:
            self.folder, self._lock = _opened(out, fingerprint, what)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: object, fault: BaseException | None, trace: object) -> None:
        if self.folder is not None and isinstance(fault, FayingError) and not any(self.folder.rglob("*.npz")):
            self.finish()
        if self._lock is not None:
            self._lock.close()

    def arrays(self, name: str) -> dict[str, Any] | None:
        """The arrays of NAME.npz in the folder; None where they are missing or damaged, or nothing is kept."""
        return None if self.folder is None else load_arrays(self.folder / f"{name}.npz")

    def keep_arrays(self, name: str, arrays: Mapping[str, Any]) -> None:
        """Keep arrays in NAME.npz, where anything is kept."""
        if self.folder is not None:
            write_arrays(self.folder / f"{name}.npz", arrays)

    def finish(self) -> None:
        """Remove the folder: the work is done, or has kept nothing."""
        if self.folder is not None and self._lock is not None:
            release(self.folder, self._lock)


def _opened(out: Path, fingerprint: str, what: str) -> tuple[Path, IO[str]]:
    """The folder of an output, made or found, and its lock."""
    if out.suffix != ".nc":
        raise InputError(f"the output {out} should end in .nc: a {what} is written as NetCDF")
    if not out.parent.is_dir():
        raise InputError(f"no folder {out.parent} to write {out.name} in; make it first")
    folder = out.with_name(out.name + ".part")
    label = folder / f"{what}.json"
    lock = locked(folder, folder, "choose another output with --out")
    if all(one.name == LOCK for one in folder.iterdir()):
        write_text(label, json.dumps({"fingerprint": fingerprint, "version": __version__}))
        return folder, lock
    try:
        known = dict(json.loads(label.read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        known = {}
    if known.get("fingerprint") == fingerprint:
        return folder, lock
    lock.close()
    if (made_by := known.get("version", __version__)) != __version__:
        raise InputError(
            f"{folder} was begun by Faying {made_by}, and this is {__version__}, whose numbers may differ: "
            f"finish the {what} with {made_by}, or remove the folder and begin anew"
        )
    raise InputError(
        f"{folder} is what another {what} has left, or another version of this study; remove it, "
        "or choose another output with --out"
    )


def fingerprint(study: Study, *facts: object) -> str:
    """What tells one piece of work from another: Faying's version, the study, the bytes of its files, and facts."""
    words = f"{study!r} {facts!r}".replace(str(study.folder), "")  # a folder that was moved holds the same study
    digest = hashlib.sha256(f"{__version__} {words}".encode())
    for file in study.files:
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()
