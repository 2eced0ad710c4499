"""A bolted structure: meshed parts, the joints between them, the bolts that pull them together, what supports them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.fe.constraint import constrain
from faying.fe.elasticity import Solid
from faying.fe.interface import Interface
from faying.fe.mesh import Mesh
from faying.fe.outline import Outline, outline
from faying.fe.quality import quality
from faying.fe.solve import BY_PARTS, Factoriser, chosen, is_mpi
from faying.joint.attachments import PointMass, Support
from faying.joint.bolt import Bolt, FittedBolt
from faying.joint.frame import Frame, added
from faying.joint.joint_law import JointLaw
from faying.joint.preload import PreloadProblem
from faying.joint.solid_bolt import FittedSolidBolt, SolidBolt
from faying.joint.springs import Springs
from faying.notes import Note
from faying.typing import Array, Index


@dataclass(frozen=True, kw_only=True)
class Joint:
    """Two faces that meet, and the contact law between them.

    Args:
        name: What messages and results call the joint.
        faces: Names of the two faces, on two parts.
        interface: How they meet, from `faying.fe.interface.join`.
        law: The contact law on the joint.
        per_node: Springs at nodes instead of per area, as the JK paper has them; the faces must match node for node.
        scan_area: With per_node, area of the scan [m2] to which a node's force is applied; 1 m2 where None.
        friction: Coefficient of Coulomb slip under the preload [-], 0 to 10; None where the joint sticks everywhere.

    Raises:
        InputError: The friction is no coefficient of friction.

    Source:
        Springs at nodes: the JK paper, doi:10.3390/fractalfract8100611.
    """

    name: str
    faces: tuple[str, str]
    interface: Interface
    law: JointLaw
    per_node: bool = False
    scan_area: float | None = None
    friction: float | None = None

    def __post_init__(self) -> None:
        if self.friction is not None and not 0 <= self.friction < 10:
            raise InputError(
                f"joint {self.name!r}: friction {self.friction:g} is no coefficient of friction; give one such as "
                "0.2, or leave it out for a joint that sticks"
            )

    def springs(self, pressure: Array) -> Springs[Interface]:
        """Springs of this joint under a pressure [Pa] (q,) at the points of its interface."""
        if not self.per_node:
            return self.law.springs(self.interface, pressure)
        # the paper's use: each node's force goes straight into the law as if the node were a whole scan
        nodes = self.interface.at_nodes()
        at_nodes = np.maximum(self.interface.to_nodes(nodes, pressure), 0.0)
        area = self.scan_area or 1.0
        scans = self.law.springs(nodes, at_nodes * nodes.weights / area)
        per_area = area / nodes.weights
        return replace(scans, pressure=at_nodes, k_n=scans.k_n * per_area, k_t=scans.k_t * per_area)


def each_pair_once(joints: Mapping[str, tuple[str, str]]) -> None:
    """Raise InputError where two joints, name -> faces, join the same faces."""
    met: dict[frozenset[str], str] = {}
    for name, faces in joints.items():
        other = met.setdefault(frozenset(faces), name)
        if other != name:
            raise InputError(
                f"joints {other!r} and {name!r} join the same faces {' and '.join(map(repr, sorted(faces)))}, which "
                "would double the stiffness; leave one out"
            )


@dataclass(frozen=True, kw_only=True)
class Structure:
    """A bolted structure.

    What does not depend on the laws of the joints is assembled once, when it is first asked for, and shared with a
    structure that `dataclasses.replace` makes with other laws on the same faces.

    Args:
        mesh: Parts and faces.
        materials: Part -> its material (E [Pa], nu [-], density [kg/m3]).
        joints: The joints between the parts.
        bolts: Bolts as beams, forces or meshed parts.
        supports: Faces that are fixed or on springs.
        masses: Point masses.

    Raises:
        InputError: A part has neither joint nor support, or is two solid bolts; a solid bolt's face is in no joint.
    """

    mesh: Mesh
    materials: Mapping[str, Solid]
    joints: tuple[Joint, ...]
    bolts: tuple[Bolt | SolidBolt, ...] = ()
    supports: tuple[Support, ...] = ()
    masses: tuple[PointMass, ...] = ()
    frame: Frame | None = field(default=None, repr=False, compare=False)

    def __post_init__(self) -> None:
        faces = [face for joint in self.joints for face in joint.faces] + [support.face for support in self.supports]
        met = {self.mesh.face_part[face] for face in faces if face in self.mesh.face_part}
        solid = [bolt for bolt in self.bolts if isinstance(bolt, SolidBolt)]
        meshed = [bolt.part for bolt in solid]
        twice = sorted({part for part in meshed if meshed.count(part) > 1})
        if twice:
            raise InputError(f"part {', '.join(twice)} is two solid bolts; a part is drawn in once, with one preload")
        for bolt in solid:
            apart = [face for face in bolt.faces if face not in faces]
            if apart:
                raise InputError(
                    f"bolt {bolt.name!r}: its face {apart[0]!r} is in no joint; add a [[joint]] of it and the seat "
                    "that it presses"
                )
        loose = [part for part in self.mesh.parts if part not in met]
        if loose and len(self.mesh.parts) > 1:
            raise InputError(
                f"part {', '.join(loose)} has no joint; add a [[joint]] of one of its faces, or leave it out"
            )
        for what, names in (
            ("joints", [joint.name for joint in self.joints]),
            ("bolts", [bolt.name for bolt in self.bolts]),
        ):
            again = sorted({name for name in names if names.count(name) > 1})
            if again:
                raise InputError(f"two {what} are called {again[0]!r}; give each a name of its own")
        each_pair_once({joint.name: joint.faces for joint in self.joints})
        frame = Frame(
            mesh=self.mesh,
            materials=self.materials,
            joined=tuple(face for joint in self.joints for face in joint.faces),
            bolts=self.bolts,
            supports=self.supports,
            masses=self.masses,
        )
        if self.frame is None or not self.frame.same(frame):
            object.__setattr__(self, "frame", frame)

    @property
    def _frame(self) -> Frame:
        assert self.frame is not None
        return self.frame

    @property
    def matrices(self) -> tuple[Any, Any]:
        """Stiffness [N/m] and mass [kg] of the parts alone."""
        return self._frame.matrices

    @property
    def mass(self) -> float:
        """Mass of the parts [kg]."""
        return float(self.matrices[1].sum()) / 3

    @property
    def fixed(self) -> Index:
        """Unknowns that supports keep at rest."""
        return self._frame.fixed

    @property
    def fitted_bolts(self) -> tuple[FittedBolt | FittedSolidBolt, ...]:
        """The bolts in their places."""
        return self._frame.fitted_bolts

    @property
    def pulls(self) -> Array:
        """What a displacement adds to the force of each bolt (bolts, unknowns) [N/m]; 0 for a bolt without a shank."""
        return np.array([bolt.pull for bolt in self.fitted_bolts]).reshape(-1, self.mesh.unknowns)

    @property
    def predicts_loss(self) -> bool:
        """Whether the law of any joint gives a loss factor."""
        return any(joint.law.predicts_loss for joint in self.joints)

    @property
    def loads(self) -> Array:
        """Nodal forces [N] (unknowns, bolts) of 1 N in each bolt."""
        return self._frame.loads

    @property
    def standing(self) -> Any:
        """Stiffness [N/m] of the parts and of elastic supports, before any bolt is tight."""
        return self._frame.standing

    @property
    def vibrating(self) -> tuple[Any, Any]:
        """Stiffness [N/m] and mass [kg] without the joints, but with bolts, supports and masses; fixed ones cleared."""
        return self._frame.vibrating

    @property
    def is_bare(self) -> bool:
        """Whether the parts under preload are all that vibrates: no bolt adds a stiffness or a mass."""
        return self._frame.is_bare

    @property
    def rigid(self) -> Array:
        """Rigid motions of the whole that no support resists (unknowns, up to 6)."""
        return self._frame.rigid

    @property
    def rigid_count(self) -> int:
        """Number of rigid motions that no support resists, 0 to 6."""
        return int(self.rigid.shape[1])

    def loose(self) -> Array:
        """Motions (unknowns, r) of the parts, each rigid by itself, that nothing resists with all joints apart."""
        return self._frame.loose()

    @property
    def shift_frequency(self) -> float:
        """A frequency below the first elastic mode of any compact body of this size [Hz]: .02 c/size."""
        return self._frame.shift_frequency

    def solver(self, name: str | None = None) -> str | Factoriser:
        """What factorises the matrices of this structure, by the name that a study gives; part by part if need be.

        Where no name is given, that is where one factor of the whole would take more than half of the free memory.

        Raises:
            InputError: there is no such solver here.
        """
        way = chosen(name)
        if is_mpi(way):
            return self._frame.over_mpi(way)
        if len(self.mesh.parts) < 2 or way not in ("pardiso", BY_PARTS):
            return way
        if way == "pardiso" and (name or not self._frame.is_large):
            return way
        return self._frame.by_parts

    @property
    def notes(self) -> tuple[Note, ...]:
        """What the mesh left out, how good its elements are, and what was chosen for the bolts."""
        bolts = [note for bolt in self.fitted_bolts if isinstance(bolt, FittedBolt) for note in bolt.notes]
        return (*self.mesh.notes, *quality(self.mesh).notes, *bolts)

    def assembly(self, *, solver: str | None = None) -> PreloadProblem:
        """Return the preload problem of this structure."""
        pairs = [(joint.interface, joint.law) for joint in self.joints]
        way = self.solver(solver)
        problem = PreloadProblem(
            self.standing,
            self.matrices[1],
            self.rigid,
            pairs,
            shift_frequency=self.shift_frequency,
            solver=way,
            friction=[joint.friction for joint in self.joints],
            fixed=self.fixed,
        )
        if not (isinstance(way, Factoriser) and way.cheap):
            problem.corners = self._frame.corners
        return problem

    def joined(self, springs: Sequence[Springs[Interface]], *, viscous: bool = False) -> tuple[Any, Any]:
        """Stiffness [N/m] with the springs of all joints, and their loss; fixed unknowns cleared.

        The loss is the imaginary part of the stiffness [N/m], or where viscous the damping [N s/m] of the JK paper.
        """
        return added(self.vibrating[0], [self.sprung(springs)]), self.lost(springs, viscous=viscous)

    def sprung(self, springs: Sequence[Springs[Interface]]) -> Any:
        """Stiffness [N/m] of the springs of all joints alone; fixed unknowns cleared."""
        return added(None, [constrain(s.stiffness(), self.fixed, 0.0) for s in springs])

    def lost(self, springs: Sequence[Springs[Interface]], *, viscous: bool = False) -> Any:
        """The loss of the springs of all joints, as `joined` gives it."""
        from scipy.sparse import csr_array

        weight = float(self.matrices[1].sum()) / 3 if viscous else 0.0
        lossy = [s for s in springs if np.any(s.loss_n) or np.any(s.loss_t)]
        losses = [s.viscous(weight) if viscous else s.loss() for s in lossy]
        return added(csr_array(self.matrices[0].shape), [constrain(loss, self.fixed, 0.0) for loss in losses])

    def springs(self, pressures: Sequence[Array]) -> tuple[Springs[Interface], ...]:
        """Return the springs of every joint, as they are assembled.

        Args:
            pressures: Pressure [Pa] at the points of each joint's interface, one array per joint.

        Returns:
            For each joint: the points of its springs with their share of the area, the pressure there, k_n, k_t and
            both loss factors. With springs per node the points are nodes.
        """
        return tuple(joint.springs(pressure) for joint, pressure in zip(self.joints, pressures, strict=True))

    def bonded(self) -> Any | None:
        """Return the map that bonds the faces of every joint; see `bond`."""
        return bond(self.mesh, [joint.faces for joint in self.joints])

    def outline(self) -> tuple[Index, Index]:
        """Nodes of the outer surface and triangles between them (t, 3), for pictures."""
        found = self.surface()
        return found.nodes, found.triangles

    def surface(self) -> Outline:
        """The outer surface with parts and faces; a triangle on several faces belongs to that of a joint."""
        used = [face for joint in self.joints for face in joint.faces]
        used += [face for bolt in self.bolts for face in bolt.faces] + [support.face for support in self.supports]
        return outline(self.mesh, used)

    @property
    def part_masses(self) -> Array:
        """Mass of each part [kg] (p,), without bolts and point masses."""
        along = np.zeros(self.mesh.unknowns)
        along[::3] = 1.0
        of_node = np.asarray(self.matrices[1] @ along)[::3]
        return np.array([of_node[self.mesh.part_nodes(part)].sum() for part in self.mesh.parts])


def merged(matrix: Any, merge: Any) -> Any:
    """A sparse matrix on fewer unknowns, those that `bond` makes: merge' @ matrix @ merge in a fifth of the time."""
    from scipy.sparse import csr_array

    columns = csr_array((matrix.data, merge.indices[matrix.indices], matrix.indptr), shape=merge.shape)
    return merge.T.tocsr() @ columns


def bond(mesh: Mesh, pairs: Sequence[tuple[str, str]]) -> Any | None:
    """Return the sparse map (unknowns, fewer) that bonds pairs of faces node by node.

    None where the meshes of a pair do not match.
    """
    from scipy.sparse import csr_array, get_index_dtype
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import cKDTree

    n = len(mesh.points)
    near, far = [], []
    for first, second in pairs:
        a, b = mesh.face_nodes(first), mesh.face_nodes(second)
        distance, index = cKDTree(mesh.points[a]).query(mesh.points[b])
        if not np.all(distance < 1e-6 * mesh.size):
            return None
        near.append(a[index])
        far.append(b)
    ends = np.concatenate(near), np.concatenate(far)
    # a node of several joints is bonded to all that it meets in any of them
    _, column = connected_components(csr_array((np.ones(len(ends[0])), ends), shape=(n, n)), directed=False)
    count = int(column.max()) + 1
    columns = (3 * column.reshape(-1, 1) + np.arange(3)).ravel()
    short = get_index_dtype(maxval=3 * n + 1)  # what is merged by long indices keeps them
    pieces = np.ones(3 * n), columns.astype(short), np.arange(3 * n + 1, dtype=short)
    return csr_array(pieces, shape=(3 * n, 3 * count))
