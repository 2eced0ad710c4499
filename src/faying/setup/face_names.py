"""The faces of a STEP or mesh file, and names for those that a proposed study speaks of, with their selectors."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from faying.decks.meshfile import read_mesh
from faying.errors import InputError
from faying.file_kinds import STEP, kind_of
from faying.geometry.face_facts import FaceFacts, GeometryFacts, read_facts
from faying.geometry.mesh_facts import mesh_facts
from faying.geometry.selectors import AXES, Selector, chosen
from faying.misuse import checked_call


@dataclass
class FaceNames:
    """Names of faces: that of the file, or one that is made up, with the selector that finds the face."""

    facts: GeometryFacts
    snap: float
    selectors: dict[str, Selector] = field(default_factory=dict)
    given: dict[tuple[str, int], str] = field(default_factory=dict)
    several: dict[tuple[str, tuple[int, ...]], str] = field(default_factory=dict)

    def of(self, face: FaceFacts, word: str, touching: str | None = None) -> str:
        """The name of a face; word: what it is for; touching: the part that it touches, if it does."""
        key = face.side
        if key not in self.given:
            alike = [one for one in self.facts.faces if one.name == face.name]
            if face.name and len(alike) == 1:
                self.given[key] = face.name
            else:
                self.given[key] = name = self._free(f"{face.part}.{word}")
                self.selectors[name] = self._selector(face, touching)
        return self.given[key]

    def of_several(self, faces: Sequence[FaceFacts], word: str) -> str:
        """The name of faces that are meant together, such as the halves of a cylinder."""
        if len(faces) == 1:
            return self.of(faces[0], word)
        part, numbers = faces[0].part, tuple(sorted(face.number for face in faces))
        if (part, numbers) not in self.several:
            self.several[part, numbers] = name = self._free(f"{part}.{word}")
            self.selectors[name] = Selector(part=part, number=numbers)
        return self.several[part, numbers]

    def _free(self, name: str) -> str:
        taken = {one.name for one in self.facts.faces} | set(self.selectors)
        return next(n for n in (name, *(f"{name} {k}" for k in range(2, 10_000))) if n not in taken)

    def _selector(self, face: FaceFacts, touching: str | None) -> Selector:
        """The first of touching, normal and number that means this face alone."""
        tries = [Selector(part=face.part, touching=touching)] if touching is not None else []
        tries += [
            Selector(part=face.part, normal=axis)
            for axis in AXES.values()
            if face.normal is not None and np.allclose(axis, face.normal)
        ]
        for selector in tries:
            try:
                if chosen("", selector, self.facts, snap=self.snap) == (face,):
                    return selector
            except InputError:
                continue
        return Selector(part=face.part, number=face.number)


@checked_call
def faces(geometry: str | Path, *, unit: str | None = None) -> GeometryFacts:
    """Return the parts of a STEP or mesh file, their faces, and where faces of two parts look at each other.

    Args:
        geometry: STEP file, or mesh file of another program, of which the named faces count.
        unit: Unit of a mesh file's coordinates, such as "mm"; a STEP file states its own.

    Returns:
        The facts: `parts`, `faces` (number, kind, area, normal, centre, radius), `contacts`.

    Raises:
        InputError: A unit for a STEP file, none for a mesh file that needs one, or a file of another kind.
        ReadError: The file cannot be read.
    """
    path = Path(geometry)
    if kind_of(path) is not STEP:
        return mesh_facts(read_mesh(path, unit=unit))
    if unit is not None:
        raise InputError("a unit is for mesh files; a STEP file states its unit, so leave it out")
    return read_facts(path)
