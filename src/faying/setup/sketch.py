"""A study on its geometry before there is a mesh."""

from collections.abc import Mapping
from dataclasses import dataclass

from faying.bolt.bolt import BoltPlace
from faying.bolt.solid_bolt import SolidPlace
from faying.geometry.face_facts import FaceFacts, GeometryFacts, TouchingFaces
from faying.geometry.face_triangles import FaceTriangles
from faying.materials import Material
from faying.study.study import Study


@dataclass(frozen=True, kw_only=True)
class Sketch:
    """A study on its geometry before there is a mesh, as far as strength and laws ask for it.

    Args:
        study, facts: the study and its geometry.
        named: faces by name.
        mesh: the named faces as triangles.
        materials: part -> material.
        fitted_bolts: the bolts in their places.
    """

    study: Study
    facts: GeometryFacts
    named: Mapping[str, tuple[FaceFacts, ...]]
    mesh: FaceTriangles
    materials: Mapping[str, Material]
    fitted_bolts: tuple[BoltPlace | SolidPlace, ...]

    @property
    def mass(self) -> float:
        """Mass of the parts [kg]."""
        return sum((self.materials[part.name].density or 0.0) * part.volume for part in self.facts.parts)

    def contacts(self, faces: tuple[str, str]) -> list[TouchingFaces]:
        """Where the faces of a joint look at each other."""
        first, second = ({face.side for face in self.named[name]} for name in faces)
        return [c for c in self.facts.contacts if {c.first, c.second} & first and {c.first, c.second} & second]
