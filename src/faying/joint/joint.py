"""Joints: two faces that meet, the contact law between them, and their place on a mesh."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from faying.checks import number
from faying.contact.law import ContactLaw
from faying.errors import InputError
from faying.fe.elasticity import Solid
from faying.fe.interface import Interface, join
from faying.fe.mesh import Mesh
from faying.form.face_axes import FaceAxes
from faying.form.form import Form
from faying.form.waviness import NODES, LaidWaves, carried_by
from faying.joint.joint_law import JointLaw
from faying.joint.springs import Springs
from faying.materials import MOST_FRICTION
from faying.misuse import checked_call
from faying.notes import Note
from faying.typing import Array, Mask
from faying.units import show

MAX_TANGENTIAL = 2.0  # greatest k_t/k_n [-]
SAME_MODULUS = 0.02  # relative difference of E* from which the materials of a law are not those of the parts


@checked_call
@dataclass(frozen=True, init=False)
class Joint:
    """Two faces that meet, and the contact law between them.

    Args:
        faces: Names of the two faces, on two parts; the first one is the face whose scan the law was made of.
        law: The contact law, such as `Mates(scan, materials="45 steel").law()`.
        name: What messages and results call the joint; "joint 1" and so on where None.
        tangential: Where k_t comes from: "law", "mindlin" for k_n 2(1-nu)/(2-nu), or k_t/k_n as a number, above 0 and
            at most 2; None takes that of the law where it has one, else Mindlin's.
        per_node: Springs at nodes instead of per area, as the JK paper has them; the faces must match node for node.
        scan_area: With per_node, area of the scan [m2], or text with a unit, to which a node's force is applied.
        friction: Coefficient of Coulomb slip under the preload [-], 0 to 10; None where the joint sticks everywhere.
        search_distance: Between faces that count as meeting [m], or text with a unit; chosen where None.
        form: Distance of the faces before any load, roughness apart; None for faces as they are meshed.

    Raises:
        InputError: An argument cannot be used; the text says which, and what is allowed.
    """

    faces: tuple[str, str]
    law: ContactLaw
    name: str | None
    tangential: Literal["law", "mindlin"] | float | None
    per_node: bool
    scan_area: float | None
    friction: float | None
    search_distance: float | None
    form: Form | None

    def __init__(
        self,
        faces: tuple[str, str],
        law: ContactLaw,
        *,
        name: str | None = None,
        tangential: Literal["law", "mindlin"] | float | None = None,
        per_node: bool = False,
        scan_area: float | str | None = None,
        friction: float | None = None,
        search_distance: float | str | None = None,
        form: Form | None = None,
    ) -> None:
        called = f"joint {name!r}" if name else "joint"
        if faces[0] == faces[1]:
            raise InputError(f"{called}: both faces are {faces[0]!r}; name two faces, on two parts")
        if isinstance(tangential, int | float) and not 0 < tangential <= MAX_TANGENTIAL:
            raise InputError(
                f'{called}: tangential = {tangential!r} should be "law", "mindlin", or k_t/k_n, above 0 and at most 2; '
                "for example 0.4"
            )
        check_friction(called, friction)
        if scan_area is not None:
            scan_area = number(scan_area, f"{called}: scan_area", "m^2", least=0)
        if search_distance is not None:
            search_distance = number(search_distance, f"{called}: search_distance", "m", least=0)
        vars(self).update(
            faces=(faces[0], faces[1]),
            law=law,
            name=name,
            tangential=tangential,
            per_node=per_node,
            scan_area=scan_area,
            friction=friction,
            search_distance=search_distance,
            form=form,
        )

    def fitted(self, mesh: Mesh, materials: Mapping[str, Solid], number: int = 1) -> "FittedJoint":
        """Return the joint in its place.

        Args:
            mesh: The parts and their faces.
            materials: Part -> its material.
            number: Of the joint among those of a structure, from 1; its name where it has none.

        Raises:
            InputError: A face does not exist, both are on one part, they do not meet, or the law has no stiffness.
        """
        name = self.name or f"joint {number}"
        for face in self.faces:
            known_face(mesh, face, f"joint {name!r}")
        interface = join(mesh, *self.faces, search_distance=self.search_distance)
        notes: list[Note] = []
        if self.form is not None:
            interface, notes = with_form(interface, mesh, self.faces, self.form, name)
        rough, other = (materials[mesh.face_part[face]] for face in self.faces)
        law = JointLaw(model=self.law, tangential=self.tangential, nu=rough.nu)
        law.check()
        return FittedJoint(
            name=name,
            faces=self.faces,
            interface=interface,
            law=law,
            per_node=self.per_node,
            scan_area=self.scan_area,
            friction=self.friction,
            notes=(*notes, *_material_notes(name, self.law, rough, other)),
        )


def check_friction(what: str, friction: float | None) -> None:
    """Raise InputError for what is not a coefficient of friction."""
    if friction is not None and not 0 <= friction <= MOST_FRICTION:
        raise InputError(
            f"{what}: friction {friction:g} is not a coefficient of friction, 0 to {MOST_FRICTION:g}; give one such as "
            "0.2, or leave it out for a joint that sticks"
        )


def known_face(mesh: Mesh, face: str, what: str) -> None:
    """Raise InputError that lists the faces where a mesh has none of this name."""
    if face not in mesh.faces:
        raise InputError(
            f"{what} names the face {face!r}, which does not exist; the faces are "
            f"{', '.join(map(repr, sorted(mesh.faces)))}"
        )


def _material_notes(name: str, law: ContactLaw, rough: Solid, other: Solid) -> list[Note]:
    """Say where the law was made for other materials than those of the parts, as far as it knows them."""
    if law.made_for is None:
        return []
    modulus = law.made_for.E_star
    here = 1 / sum((1 - m.nu**2) / m.E for m in (rough, other))
    if abs(modulus / here - 1) <= SAME_MODULUS:
        return []
    text = (
        f"{name}: the law was made for a contact modulus E* of {modulus / 1e9:.4g} GPa, the materials of its parts "
        f"have {here / 1e9:.4g} GPa; make the law for the materials of the parts, unless you want this"
    )
    return [Note(code="law-materials", severity="wrong", joint=name, text=text)]


@dataclass(frozen=True, kw_only=True)
class FittedJoint:
    """A joint in its place on a mesh: how its faces meet, and the law at their points.

    Args:
        name: What messages and results call the joint.
        faces: Names of the two faces, on two parts.
        interface: How they meet, from `join`.
        law: The contact law on the joint.
        per_node: Springs at nodes instead of per area, as the JK paper has them; the faces must match node for node.
        scan_area: With per_node, area of the scan [m2] to which a node's force is applied; 1 m2 where None.
        friction: Coefficient of Coulomb slip under the preload [-], 0 to 10; None where the joint sticks everywhere.
        notes: What was found when it was laid on its mesh.

    Raises:
        InputError: The friction is not a coefficient of friction.

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
    notes: tuple[Note, ...] = ()

    def __post_init__(self) -> None:
        check_friction(f"joint {self.name!r}", self.friction)

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

    @property
    def assumptions(self) -> tuple[Note, ...]:
        """What its law assumes, and whether it predicts a loss."""
        law, out = self.law, []
        if law.assumes_mindlin and law.tangential is None:
            ratio = 2 * (1 - law.nu) / (2 - law.nu)
            text = f"{law.model.name} defines no tangential stiffness: k_t/k_n = {ratio:.3f} is Mindlin's, assumed"
            out.append(Note(code="assumed", text=text))
        out += [Note(code="assumed", text=f"{law.model.name}: {text}") for text in law.model.assumptions]
        if not law.predicts_loss:
            text = f"{self.name}: {law.model.name} gives no damping at rest; that of measured structures is assumed"
            out.append(Note(code="no-loss", joint=self.name, text=text))
        return tuple(out)

    def above_range(self, springs: Springs[Interface]) -> Mask:
        """Points of its springs (q,) whose pressure is beyond the end of the law, as the law is asked."""
        pressure = springs.pressure
        if self.per_node:
            pressure = pressure * springs.interface.weights / (self.scan_area or 1.0)
        return np.asarray(pressure > self.law.model.greatest_pressure)


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


def with_form(
    interface: Interface, mesh: Mesh, faces: tuple[str, str], form: Form, name: str
) -> tuple[Interface, list[Note]]:
    """A joint of two named faces with their form added to its gap, and which waves are drawn or beyond the mesh.

    Raises InputError where the waves do not fit.
    """
    notes, waviness = list[Note](), form.waviness
    if not (form.wave or waviness):
        return form.on(interface, mesh, faces), notes
    axes = FaceAxes.of(mesh, faces, interface, form.along)
    if form.wave and form.wave_length and form.wave_length < (least := carried_by(axes)):
        text = (
            f"{name}: the points of the joint do not follow a wave of {show(form.wave_length, 'm')}; the mesh carries "
            f"{show(least, 'm')} ({NODES} nodes of the coarser face in a wave). Take finer elements on the faces"
        )
        notes.append(Note(code="waves-mesh", joint=name, text=text))
    if waviness is not None:
        laid = LaidWaves.of(waviness, axes)
        text = (
            f"{name}: {laid.words()} ({waviness.origin}), draw {waviness.seed}; another draw gives other frequencies."
        )
        text += f" faying sweep over joint.{name}.form.waviness_seed, or faying predict, says how far draws differ"
        notes.append(Note(code="waves", joint=name, text=text))
        if laid.missing_share > 0:
            notes.append(Note(code="waves-mesh", joint=name, text=f"{name}: {laid.mesh_limit()}"))
    return form.on(interface, mesh, faces), notes
