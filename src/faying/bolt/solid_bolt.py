"""Bolts that are meshed: parts of the structure whose shank is drawn in until it carries its preload."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from faying.bolt.threads import Fastener
from faying.errors import InputError
from faying.fe.mesh import Mesh
from faying.fe.sides import NamedFaces, face_centre
from faying.misuse import checked_call
from faying.typing import Array, Index
from faying.units import in_mm

MAX_LAYER_UNKNOWNS = 6000  # unknowns of the layer that is drawn in: its dense block takes 0.3 GB then


@checked_call
@dataclass(frozen=True, kw_only=True)
class SolidBolt:
    """A bolt that is a meshed part; its faces meet the seats in joints like those of any other part.

    Args:
        name: What messages and results call the bolt.
        part: Name of the part.
        faces: Faces of the bolt itself under its head and under its nut, or round its thread.
        at: A point (3,) [m] of the plane in which the shank is drawn in; half-way between the faces where None.
        fastener: Thread and property class, from which its proof load follows; None where they are not known.
        friction: Coefficients of friction in the thread and under the head; for sheet and loosening alone.
    """

    name: str
    part: str
    faces: tuple[str, str]
    at: tuple[float, float, float] | None = None
    fastener: Fastener | None = None
    friction: tuple[float | None, float | None] | None = None
    diameter: ClassVar[None] = None  # it has no shank but that of the mesh

    def fitted(self, mesh: Mesh, stiffness: Any, joined: Sequence[str] = ()) -> "FittedSolidBolt":
        """Return the bolt in its place; stiffness [N/m]: of the parts alone; joined: faces that joints or supports use.

        Raises InputError where the faces are not on the part, the head does not look at the nut, or the plane misses
        the shank or meets one of the faces `joined`.
        """
        head, nut = self.faces
        part = self.part
        for face in self.faces:
            if mesh.face_part[face] != part:
                raise InputError(
                    f"bolt {self.name!r} is the part {part!r}, but its face {face!r} is on {mesh.face_part[face]!r}; "
                    "name the faces under its own head and nut"
                )
        centre, normal, _ = face_centre(mesh.points, mesh.face(head))
        end, _, _ = face_centre(mesh.points, mesh.face(nut))
        axis = end - centre
        length = float(np.linalg.norm(axis))
        if length < 1e-6 * mesh.size or normal @ axis < 0.5 * length:
            raise InputError(
                f"bolt {self.name!r}: its face {head!r} does not look towards {nut!r}; name first the face under "
                "the head, then the one under the nut or round the thread"
            )
        axis = axis / length
        place = self.place(mesh)
        before, behind = ((mesh.points[mesh.face_nodes(face)] - place) @ axis for face in self.faces)
        if before.max() > 0 or behind.min() <= 0:
            raise InputError(
                f"bolt {self.name!r}: the plane through {in_mm(place)} across its axis does not part {head!r} from "
                f"{nut!r}; give a point between them as `at`"
            )
        nodes = mesh.part_nodes(part)
        above = nodes[(mesh.points[nodes] - place) @ axis > 0]
        layer = _across(mesh, part, above)
        met = [f for f in joined if mesh.face_part.get(f) == part and np.isin(mesh.face_nodes(f), layer).any()]
        if met:
            raise InputError(
                f"bolt {self.name!r}: the plane through {in_mm(place)} that cuts its shank meets its face "
                f"{met[0]!r}, which is in a joint; give a point of the bare shank as `at`, or a finer mesh"
            )
        others = [other for other in mesh.parts if other != part and np.isin(mesh.part_nodes(other), layer).any()]
        if others:
            raise InputError(
                f"bolt {self.name!r}: the plane through {in_mm(place)} that cuts its shank meets nodes that it "
                f"shares with {others[0]!r}, to which it is bonded; give a point of the bare shank as `at`"
            )
        if 3 * len(layer) > MAX_LAYER_UNKNOWNS:
            raise InputError(
                f"bolt {self.name!r}: the elements in the plane across its shank have {3 * len(layer):,} unknowns, "
                f"which all couple while it is pulled ({MAX_LAYER_UNKNOWNS:,} at most); mesh the shank more coarsely, "
                "or give a beam"
            )
        drawn = np.zeros((len(mesh.points), 3))
        drawn[above] = axis
        pull = np.zeros_like(drawn)  # nothing but rounding outside the layer, where the motion is rigid
        pull[layer] = np.asarray(stiffness @ drawn.ravel()).reshape(-1, 3)[layer]
        rigidity = float(np.sum(pull * drawn))
        return FittedSolidBolt(
            bolt=self, pull=pull.ravel(), rigidity=rigidity, seats=np.stack([centre, end]), drawn=drawn.ravel()
        )

    def place(self, mesh: Mesh) -> Array:
        """The point (3,) [m] of the plane in which the shank is drawn in."""
        if self.at is not None:
            return np.array(self.at)
        first, second = (face_centre(mesh.points, mesh.face(face))[0] for face in self.faces)
        return np.asarray((first + second) / 2)


@dataclass(frozen=True, kw_only=True)
class FittedSolidBolt:
    """A solid bolt in its place: pull (unknowns,), rigidity [N/m], and the centres (2, 3) [m] of its two faces.

    drawn (unknowns,): v, how the far half moves when it is drawn in by 1.

    The far half is drawn towards the head by a (the turn of a nut), v being 1 along the axis in that half and 0 in the
    other. The bolt is strained by u + a v, so that its tension is v.K(u + a v) = pull.u + rigidity a: the resultant of
    the stresses in every section, exactly. Given a tension instead of a, the structure loses the stiffness pull
    pull'/rigidity and gains the load -tension pull/rigidity. Where the halves meet makes no difference.
    """

    bolt: SolidBolt
    pull: Array
    rigidity: float
    seats: Array
    drawn: Array

    @cached_property
    def load(self) -> Array:
        """Nodal forces [N] (unknowns,) of 1 N of tension, on the structure without `released`."""
        return -self.pull / self.rigidity

    @cached_property
    def released(self) -> Any:
        """Sparse stiffness [N/m] that the parts lose while the bolt's tension is given."""
        from scipy.sparse import coo_array

        at = np.flatnonzero(self.pull)
        block = np.outer(self.pull[at], self.pull[at]) / self.rigidity
        n = len(self.pull)
        return coo_array((block.ravel(), (np.repeat(at, len(at)), np.tile(at, len(at)))), shape=(n, n)).tocsr()

    @property
    def stiffness(self) -> Any:
        """What the tight bolt gives back [N/m]: `released`."""
        return self.released

    def drawn_in(self, displacement: Array, force: float) -> Array:
        """How far the far half is drawn in, a v [m] (unknowns,), at a displacement under a force [N] of the bolt."""
        return np.asarray((force - self.tension(displacement)) / self.rigidity * self.drawn)

    @property
    def mass(self) -> None:
        """None: the mesh has the bolt's mass."""
        return None

    def tension(self, displacement: Array) -> float:
        """What the stretch of the tight bolt adds to its force [N] under a displacement (unknowns,)."""
        return float(self.pull @ displacement)


@dataclass(frozen=True, kw_only=True)
class SolidPlace:
    """A meshed bolt before there is a mesh: point [m] and axis (3,) from head to nut, length [m] between its faces."""

    bolt: SolidBolt
    point: Array
    axis: Array
    length: float

    @classmethod
    def of(cls, bolt: SolidBolt, faces: NamedFaces) -> "SolidPlace":
        """Place a bolt between its two faces. Raises InputError where they are not apart."""
        (start, _, _), (end, _, _) = (face_centre(faces.points, faces.face(name)) for name in bolt.faces)
        length = float(np.linalg.norm(end - start))
        if length < 1e-6 * faces.size:
            raise InputError(
                f"bolt {bolt.name!r}: its faces have one centre; name the faces under its head and its nut"
            )
        return cls(bolt=bolt, point=start, axis=(end - start) / length, length=length)

    @property
    def seats(self) -> Array:
        """Centres (2, 3) [m] of the faces under head and nut."""
        return np.stack([self.point, self.point + self.length * self.axis])


def _across(mesh: Mesh, part: str, above: Index) -> Index:
    """Nodes of the elements of a part that have nodes both in `above` and not."""
    far = np.zeros(len(mesh.points), dtype=bool)
    far[above] = True
    found = [np.zeros(0, dtype=np.int64)]
    for cells in mesh.parts[part]:
        inside = far[cells].sum(axis=1)
        found.append(cells[(inside > 0) & (inside < cells.shape[1])].ravel())
    return np.unique(np.concatenate(found))
