"""What a prediction or an identification keeps on disk: the bases, and every chunk of samples as it is done."""

import hashlib
from pathlib import Path

from faying import __version__
from faying.joint.reduced import ReducedModel
from faying.study.parallel import Rows
from faying.study.part_folder import PartFolder, load_arrays, save_arrays
from faying.study.study import Study
from faying.study.sweep_files import kept_model
from faying.typing import Array

Kept = tuple[ReducedModel, tuple[Array, Array] | None]


class Store:
    """The folder OUT.part beside the output; without an output nothing is kept."""

    def __init__(self, out: Path | None, *, fingerprint: str = "", what: str = "prediction") -> None:
        self._part = None if out is None else PartFolder(out, fingerprint, what=what)
        self.folder = None if self._part is None else self._part.path

    def within(self, number: int) -> "Store":
        """A folder in this one, for a part of the work with bases of its own."""
        inner = Store(None)
        if self.folder is not None:
            inner.folder = self.folder / f"{number:03d}"
            inner.folder.mkdir(exist_ok=True)
        return inner

    def close(self) -> None:
        """Let other processes have the folder."""
        if self._part is not None:
            self._part.close()

    def finish(self) -> None:
        """Remove the folder: the work is done."""
        if self._part is not None:
            self._part.remove()

    def forget(self) -> None:
        """Remove the folder where nothing has been kept in it, so that it bars no other work."""
        if self._part is not None and not any(self._part.path.rglob("*.npz")):
            self._part.remove()

    def model(self) -> Kept | None:
        """The bases that were kept, and what the test sees of them."""
        if self.folder is None:
            return None
        model, seen = kept_model(self.folder / "model.npz"), load_arrays(self.folder / "seen.npz")
        if model is None or seen is None:
            return None
        return model, (seen["basis"], seen["rigid"]) if "basis" in seen else None

    def keep_model(self, model: ReducedModel, seen: tuple[Array, Array] | None) -> None:
        """Keep the bases."""
        if self.folder is not None:
            save_arrays(self.folder / "seen.npz", {} if seen is None else {"basis": seen[0], "rigid": seen[1]})
            save_arrays(self.folder / "model.npz", model.arrays())

    def rows(self, what: str, number: int) -> Rows | None:
        """A chunk of samples that was kept; None where it is missing or damaged."""
        return None if self.folder is None else load_arrays(self.folder / f"{what}-{number:06d}.npz")

    def keep_rows(self, what: str, number: int, rows: Rows) -> None:
        """Keep a chunk of samples."""
        if self.folder is not None:
            plain = {name: values.astype(str) if name == "reasons" else values for name, values in rows.items()}
            save_arrays(self.folder / f"{what}-{number:06d}.npz", plain)


def fingerprint(study: Study, *facts: object) -> str:
    """What tells one piece of work from another: Faying's version, the study, the bytes of its files, and facts."""
    digest = hashlib.sha256(f"{__version__} {study!r} {facts!r}".encode())
    for file in study.files:
        digest.update(hashlib.sha256(file.read_bytes()).digest())
    return digest.hexdigest()
