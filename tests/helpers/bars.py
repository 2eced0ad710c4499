"""Two bars end to end under a bolt, all of which is one-dimensional: closed forms for load cases."""

from dataclasses import dataclass

import numpy as np

import faying
from faying.fe.interface import join
from faying.joint.attachments import Support
from faying.joint.joint import FittedJoint
from faying.joint.joint_law import JointLaw
from faying.joint.structure import Structure
from tests.helpers.boxes import row
from tests.helpers.laws import Given

LENGTH, WIDTH = 0.03, 0.02
AREA = WIDTH**2
K = 2e13  # Pa/m, of the joint
SIMPLE = faying.Material(name="simple", E=200e9, nu=0.0, density=7800.0, expansion=12e-6)


def even(k_n=K, k_t=0.8 * K):
    """A law of the same stiffness at every pressure: p = k w, until the faces part."""
    return JointLaw(model=Given(k_n=lambda p: np.where(p > 0, k_n, 0.0), k_t=lambda p: np.where(p > 0, k_t, 0.0)))


@dataclass(frozen=True)
class Bars:
    """What the closed forms need: the structure, and both compliances [m/N]."""

    structure: Structure
    bolt: float
    members: float

    @property
    def share(self):
        return self.members / (self.bolt + self.members)


def bars(*, friction=None, held=False, law=None, diameter="8 mm", kind="hex20", count=2, bolt_friction=None):
    """Bars along x, pressed together over their whole ends by a bolt through both; held: by the left end."""
    mesh = row(
        [LENGTH, LENGTH], [count, count], kinds=(kind, kind), sections=((1, 1), (1, 1)), width=WIDTH, height=WIDTH
    )
    joint = FittedJoint(
        name="j",
        faces=("p0.right", "p1.left"),
        interface=join(mesh, "p0.right", "p1.left"),
        law=law or even(),
        friction=friction,
    )
    given = {} if diameter is None else {"diameter": diameter, "material": SIMPLE, "friction": bolt_friction}
    bolt = faying.Bolt("b", ("p0.left", "p1.right"), **given)
    structure = Structure(
        mesh=mesh,
        materials=dict.fromkeys(mesh.parts, SIMPLE),
        joints=(joint,),
        bolts=(bolt,),
        supports=[Support(face="p0.left")] if held else [],
    )
    fitted = structure.fitted_bolts[0]
    own = 1 / fitted.axial_stiffness if fitted.axial_stiffness else np.inf
    return Bars(structure=structure, bolt=own, members=2 * LENGTH / (SIMPLE.E * AREA) + 1 / (K * AREA))
