"""What a backbone keeps on disk while it is computed: the basis, and every point as it is found."""

from dataclasses import fields
from pathlib import Path
from typing import Any

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
        found = self.arrays("basis")
        return None if found is None else found.get("vectors")

    def keep_basis(self, vectors: Array) -> None:
        """Keep the basis in which the points are."""
        self.keep_arrays("basis", {"vectors": vectors})

    def points(self, curve: int) -> list[EpmcPoint]:
        """The points of a curve that were kept, in rising amplitude, up to the first that is damaged."""
        out: list[EpmcPoint] = []
        while (found := self.arrays(_name(curve, len(out)))) is not None:
            point = _point(found)
            if point is None:
                break
            out.append(point)
        return out

    def keep(self, curve: int, number: int, point: EpmcPoint) -> None:
        """Keep one point of a curve."""
        arrays: dict[str, Any] = {}
        for f in fields(point):
            value = getattr(point, f.name)
            if f.name in LISTS:
                arrays |= {f"{f.name}.{k}": part for k, part in enumerate(value)}
            else:
                arrays[f.name] = value
        self.keep_arrays(_name(curve, number), arrays)


def _name(curve: int, number: int) -> str:
    return f"curve-{curve}-{number:04d}"


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
