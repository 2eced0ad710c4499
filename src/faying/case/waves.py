"""Forms of faces that nobody has measured: where waves are drawn, and what moves with the second face of a joint."""

from dataclasses import dataclass
from typing import Self

from faying.bolt.solid_bolt import SolidBolt
from faying.fe.interface import Interface
from faying.fe.mesh import Mesh
from faying.form.face_axes import FaceAxes
from faying.form.form import Form
from faying.form.waviness import ASSUMED, LaidWaves
from faying.study.keys.joint import JointChoice
from faying.study.keys.surface import Surface
from faying.study.study import Study
from faying.typing import Array


def form_of(joint: JointChoice, surface: Surface) -> Form:
    """The form of a joint: as given, or the waves that are assumed of machined faces where nothing is said."""
    return (joint.form or Form(waviness=ASSUMED)).with_scan(surface.waves)


def drawn_on(
    study: Study, mesh: Mesh, joint: JointChoice, interface: Interface, surface: Surface
) -> tuple[FaceAxes, LaidWaves] | None:
    """The axes of a joint and the waves that are drawn on it; None where it stays as it is.

    Where a joint says nothing of its form, the waves are those that are assumed of machined faces; where it gives
    waves, other draws of them. A form without waves stays as it is; so do the seats of solid bolts, and faces that are
    curved or have no room for waves.
    """
    solid = {bolt.part for bolt in study.bolts if isinstance(bolt, SolidBolt)}
    form = form_of(joint, surface)
    if form.waviness is None or any(mesh.face_part[face] in solid for face in joint.faces):
        return None
    axes = FaceAxes.of(mesh, joint.faces, interface, form.along)
    laid = LaidWaves.of(form.waviness, axes) if form.waviness.fits(axes) else None
    return None if laid is None or laid.waves.longest < laid.carried else (axes, laid)


@dataclass(frozen=True, kw_only=True)
class MovableFace:
    """A joint whose second face may lie elsewhere in its plane, with waves or a form that moves with it.

    Args:
        interface: The joint; base: its gap [m] (q,) without its form.
        axes, form: Of its faces.
    """

    interface: Interface
    base: Array
    axes: FaceAxes
    form: Form

    @classmethod
    def of(cls, study: Study, mesh: Mesh, joint: JointChoice, interface: Interface, surface: Surface) -> Self | None:
        """None where nothing moves with the second face. Where the study gives no form, waves are drawn as a run does.

        interface: with the form that the study gives.
        """
        form = form_of(joint, surface)
        drawn = joint.form is not None or drawn_on(study, mesh, joint, interface, surface) is not None
        if not (drawn and form.of_each_face):
            return None
        axes = FaceAxes.of(mesh, joint.faces, interface, form.along)
        given = 0.0 if joint.form is None else form.at(interface.positions, axes, interface.weights)
        return cls(interface=interface, base=interface.gap - given, axes=axes, form=form)

    def gap(self, shift: Array) -> Array:
        """Gap [m] (q,) with the second face moved by a displacement (3,) [m], of which that in its plane counts."""
        moved = shift - (shift @ self.axes.normal) * self.axes.normal
        return self.base + self.form.at(self.interface.positions, self.axes, self.interface.weights, moved)
