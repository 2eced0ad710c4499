"""Forms of faces that nobody has measured: where waves are drawn, and what moves with the second face of a joint."""

from dataclasses import dataclass, replace
from typing import Self

import numpy as np

from faying.bolt.solid_bolt import SolidBolt
from faying.fe.interface import Interface
from faying.fe.mesh import Mesh
from faying.form.face_axes import FaceAxes
from faying.form.form import Form
from faying.form.waviness import ASSUMED, LaidWaves, ScanWaves
from faying.study.keys.joint import JointChoice
from faying.study.keys.surface import Surface
from faying.study.study import Study
from faying.typing import Array


def form_of(joint: JointChoice, surface: Surface) -> Form:
    """The form of a joint: as given, or the waves that are assumed of machined faces where nothing is said."""
    return (joint.form or Form(waviness=ASSUMED)).with_scan(surface.waves)


def drawn_on(study: Study, mesh: Mesh, joint: JointChoice, interface: Interface, surface: Surface) -> LaidWaves | None:
    """The waves that are drawn on a joint; None where it stays as it is.

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
    return None if laid is None or laid.waves.longest < laid.carried else laid


@dataclass(frozen=True, kw_only=True)
class JointPlacement:
    """Where a joint lies, and the gap that any form leaves there.

    Args:
        positions, weights: Its points (q, 3) [m] and their areas (q,) [m2].
        geometry: Gap without any form (q,) [m].
        axes: Those of its faces.
        scan: What its scan says of waves.
    """

    positions: Array
    weights: Array
    geometry: Array
    axes: FaceAxes
    scan: ScanWaves | None

    @classmethod
    def of(cls, mesh: Mesh, joint: JointChoice, interface: Interface, surface: Surface) -> Self:
        """The place of a joint whose interface has the form that the joint gives."""
        place = cls(
            positions=interface.positions,
            weights=interface.weights,
            geometry=np.zeros(len(interface.weights)),
            axes=FaceAxes.of(mesh, joint.faces, interface, None if joint.form is None else joint.form.along),
            scan=surface.waves,
        )
        return replace(place, geometry=interface.gap - place.gap(joint.form))

    def gap(self, form: Form | None, shift: Array | None = None) -> Array:
        """Gap [m] (q,) before any load with a form; shift (3,) [m]: of the second face; what is in its plane counts."""
        if form is None:
            return self.geometry
        moved = None if shift is None else shift - (shift @ self.axes.normal) * self.axes.normal
        return self.geometry + form.with_scan(self.scan).at(self.positions, self.axes, self.weights, moved)


@dataclass(frozen=True, kw_only=True)
class MovableFace:
    """A joint whose second face may lie elsewhere in its plane, with waves or a form that moves with it."""

    place: JointPlacement
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
        return cls(place=JointPlacement.of(mesh, joint, interface, surface), form=form)

    def gap(self, shift: Array) -> Array:
        """Gap [m] (q,) with the second face moved by a displacement (3,) [m]."""
        return self.place.gap(self.form, shift)
