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

    compliance: Array = variable("load bolt", "m/N", "compliance of the bolt, delta_S", gaps=True)
    member_compliance: Array = variable("load bolt", "m/N", "compliance of what the bolt clamps, delta_P")
    load_factor: Array = variable("load bolt", "1", "share of a load at the seats that the bolt takes, Phi", gaps=True)
    cone_compliance: Array = variable("bolt", "m/N", "delta_P by the deformation cone of VDI 2230", gaps=True)
    modal_force: Array = variable(
        "load mode bolt", "N/m", "force in the bolt per motion where a mode moves most", gaps=True
    )
    modal_force_by_acceleration: Array = variable(
        "load mode bolt", "N s2/m", "force in the bolt per acceleration where a mode moves most", gaps=True
    )
    proof_share: Array = variable("load bolt", "1", "force over proof load", gaps=True)
    seat_pressure: Array = variable("load bolt", "Pa", "greatest pressure under head or nut", gaps=True)
    seat_limit: Array = variable("bolt", "Pa", "pressure that the softer seat bears", gaps=True)
    embedding: Array = variable("bound load joint bolt", "m", "approach that lasts, by the contact law", gaps=True)
    embedding_loss: Array = variable(
        "bound load bolt", "N", "preload lost if all of it came after tightening", gaps=True
    )
    embedding_guide: Array = variable("bolt", "m", "embedding f_Z of thread, seats and joints by VDI 2230", gaps=True)
    embedding_guide_loss: Array = variable("load bolt", "N", "preload lost by the embedding of VDI 2230", gaps=True)
