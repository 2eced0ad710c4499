"""Where waves are drawn on the joints: on those whose form nobody measured, where the faces have room for waves."""

from faying.bolt.solid_bolt import SolidBolt
from faying.fe.interface import Interface
from faying.fe.mesh import Mesh
from faying.form.face_axes import FaceAxes
from faying.form.form import Form
from faying.form.machining import ASSUMED
from faying.form.waviness import LaidWaves
from faying.study.keys.joint import JointChoice
from faying.study.keys.surface import Surface
from faying.study.study import Study


def drawn_on(
    study: Study, mesh: Mesh, joint: JointChoice, interface: Interface, surface: Surface
) -> tuple[FaceAxes, LaidWaves] | None:
    """The axes of a joint and the waves that are drawn on it; None where it stays as it is.

    Where a joint says nothing of its form, the waves are those that are assumed of machined faces; where it gives
    waves, other draws of them. A form without waves stays as it is; so do the seats of solid bolts, and faces that are
    curved or have no room for waves.
    """
    solid = {bolt.part for bolt in study.bolts if isinstance(bolt, SolidBolt)}
    form = (joint.form or Form(waviness=ASSUMED)).with_scan(surface.waves)
    if form.waviness is None or any(mesh.face_part[face] in solid for face in joint.faces):
        return None
    axes = FaceAxes.of(mesh, joint.faces, interface, form.along)
    laid = LaidWaves.of(form.waviness, axes) if form.waviness.fits(axes) else None
    return None if laid is None or laid.waves.longest < laid.carried else (axes, laid)
