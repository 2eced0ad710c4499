"""Names for the faces that a proposed study speaks of, with the selectors that find them."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from faying.errors import InputError
from faying.geometry.face_facts import FaceFacts, GeometryFacts
from faying.geometry.selectors import AXES, Selector, chosen


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
