"""What a backbone keeps on disk while it is computed: the basis, and every point as it is found."""

from dataclasses import fields
from pathlib import Path
from typing import Any

from faying.files import load_arrays, write_arrays
from faying.microslip.epmc import EpmcPoint
from faying.study.part_folder import PartFile
from faying.typing import Array

LISTS = ("sliding", "opening", "dissipated", "traction")  # one array for each joint


class CurveStore(PartFile):
    """The folder OUT.part beside the output; without an output nothing is kept."""

    def __init__(self, out: Path | None, fingerprint: str) -> None:
        super().__init__(out, fingerprint, what="backbone")

    def basis(self) -> Array | None:
        """The vectors that were kept, None where there are none."""
        found = None if self.folder is None else load_arrays(self.folder / "basis.npz")
        return None if found is None else found.get("vectors")

    def keep_basis(self, vectors: Array) -> None:
        """Keep the basis in which the points are."""
        if self.folder is not None:
            write_arrays(self.folder / "basis.npz", {"vectors": vectors})

    def points(self, curve: int) -> list[EpmcPoint]:
        """The points of a curve that were kept, in rising amplitude, up to the first that is damaged."""
        out: list[EpmcPoint] = []
        while self.folder is not None:
            found = load_arrays(self._file(curve, len(out)))
            point = None if found is None else _point(found)
            if point is None:
                break
            out.append(point)
        return out

    def keep(self, curve: int, number: int, point: EpmcPoint) -> None:
        """Keep one point of a curve."""
        if self.folder is None:
            return
        arrays: dict[str, Any] = {}
        for f in fields(point):
            value = getattr(point, f.name)
            if f.name in LISTS:
                arrays |= {f"{f.name}.{k}": part for k, part in enumerate(value)}
            else:
                arrays[f.name] = value
        write_arrays(self._file(curve, number), arrays)

    def _file(self, curve: int, number: int) -> Path:
        assert self.folder is not None
        return self.folder / f"curve-{curve}-{number:04d}.npz"


def _point(found: dict[str, Any]) -> EpmcPoint | None:
    given: dict[str, Any] = {}
    try:
        for f in fields(EpmcPoint):
            if f.name in LISTS:
                count = sum(name.startswith(f"{f.name}.") for name in found)
                given[f.name] = tuple(found[f"{f.name}.{k}"] for k in range(count))
            else:
                given[f.name] = found[f.name] if f.name == "coordinates" else float(found[f.name])
    except KeyError:
        return None
    return EpmcPoint(**given)
