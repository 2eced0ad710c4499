"""Numbers of the bolts of a study that a designer of bolted joints asks for."""

from dataclasses import dataclass

from faying.result.fields import variable
from faying.typing import Array


@dataclass(frozen=True, kw_only=True, eq=False)
class BoltNumbers:
    """Compliances, forces and checks of the bolts, in the terms of VDI 2230; NaN stands for what is not known.

    Modal forces are those in the shank while the point of the structure that moves most moves by 1 m, or with 1 m/s2;
    their signs belong to the signs of `Result.shapes`. Bounds are the least and the greatest value.
    """

    compliance: Array = variable("load", "bolt", unit="m/N", long_name="compliance of the bolt, delta_S", gaps=True)
    member_compliance: Array = variable(
        "load", "bolt", unit="m/N", long_name="compliance of what the bolt clamps, delta_P"
    )
    load_factor: Array = variable(
        "load", "bolt", unit="1", long_name="share of a load at the seats that the bolt takes, Phi", gaps=True
    )
    cone_compliance: Array = variable(
        "bolt", unit="m/N", long_name="delta_P by the deformation cone of VDI 2230", gaps=True
    )
    modal_force: Array = variable(
        "load", "mode", "bolt", unit="N/m", long_name="force in the bolt per motion where a mode moves most", gaps=True
    )
    modal_force_by_acceleration: Array = variable(
        "load",
        "mode",
        "bolt",
        unit="N s2/m",
        long_name="force in the bolt per acceleration where a mode moves most",
        gaps=True,
    )
    proof_share: Array = variable("load", "bolt", unit="1", long_name="force over proof load", gaps=True)
    seat_pressure: Array = variable(
        "load", "bolt", unit="Pa", long_name="greatest pressure under head or nut", gaps=True
    )
    seat_limit: Array = variable("bolt", unit="Pa", long_name="pressure that the softer seat bears", gaps=True)
    embedding: Array = variable(
        "bound", "load", "joint", "bolt", unit="m", long_name="approach that lasts, by the contact law", gaps=True
    )
    embedding_loss: Array = variable(
        "bound", "load", "bolt", unit="N", long_name="preload lost if all of it came after tightening", gaps=True
    )
    embedding_guide: Array = variable(
        "bolt", unit="m", long_name="embedding f_Z of thread, seats and joints by VDI 2230", gaps=True
    )
    embedding_guide_loss: Array = variable(
        "load", "bolt", unit="N", long_name="preload lost by the embedding of VDI 2230", gaps=True
    )
