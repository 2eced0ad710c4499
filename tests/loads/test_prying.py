"""A T-stub: a flange that is pulled in its middle, held by two bolts, and pries with its ends on a stiff bed."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.fe.interface import join
from faying.joint.attachments import Support
from faying.joint.joint import FittedJoint
from faying.joint.structure import Structure
from tests.helpers.bars import even
from tests.helpers.plates import stacked
from tests.helpers.sides import sides_on

HALF, WIDE, THICK, ARM = 0.04, 0.02, 0.006, 0.02  # m: half of the flange, from its middle to a bolt
CELL = 0.0025
PRELOAD, PULL = 20.0, 2000.0  # N
FLANGE = faying.Material(name="flange", E=200e9, nu=0.0, density=7800.0)
BED = faying.Material(name="bed", E=1e14, nu=0.0, density=7800.0)


def prying(pull, bolt):
    """Force of a bolt [N] by beams with shear: half of the flange, held at its middle, on its bolt and on its end.

    The bed presses the end with Q upwards, the bolt pulls with P + Q downwards. That the end stays on the bed and the
    bolt stretches by what the flange lifts there gives Q.
    """
    stiff, shear = FLANGE.E * WIDE * THICK**3 / 12, 5 / 6 * FLANGE.G * WIDE * THICK
    m, n = ARM, HALF - ARM
    by_end = (HALF**3 / 3 - m**2 * (3 * HALF - m) / 6) / stiff + n / shear
    by_bolt = (m**2 * (3 * HALF - m) / 6 - m**3 / 3) / stiff - bolt
    share = by_bolt / (by_end - by_bolt)
    return pull / 2 * (1 + share), share


@pytest.fixture(scope="module")
def stub():
    mesh = stacked(counts=(32, 1, 2), size=(2 * HALF, WIDE, THICK))
    faces, owner = dict(mesh.faces), dict(mesh.face_part)
    for part, height, name, place in (
        ("high", 2 * THICK, "high.web", HALF),
        *(("high", 2 * THICK, f"high.seat{k}", HALF + s * ARM) for k, s in enumerate((-1, 1))),
        *(("low", 0.0, f"low.seat{k}", HALF + s * ARM) for k, s in enumerate((-1, 1))),
    ):
        nodes = mesh.part_nodes(part)
        x, z = mesh.points[nodes, 0], mesh.points[nodes, 2]
        on = nodes[(np.abs(z - height) < 1e-9) & (np.abs(x - place) < 1.001 * CELL)]
        faces[name], owner[name] = sides_on(on, mesh.parts[part], len(mesh.points)), part
    mesh = replace(mesh, faces=faces, face_part=owner)
    joint = FittedJoint(
        name="bed",
        faces=("low.top", "high.bottom"),
        interface=join(mesh, "low.top", "high.bottom"),
        law=even(1e14, 1e12),
    )
    bolts = [
        faying.Bolt(f"b{k}", (f"high.seat{k}", f"low.seat{k}"), diameter="4 mm", material=FLANGE) for k in range(2)
    ]
    return Structure(
        mesh=mesh,
        materials={"low": BED, "high": FLANGE},
        joints=(joint,),
        bolts=bolts,
        supports=[Support(face="low.bottom")],
    )


def test_prying_adds_what_beams_say(stub):
    """The bolts carry half of the pull and the prying force, which is a quarter of that here, to 2 %."""
    loads = [faying.Load("pull", forces=[faying.Force("high.web", force=(0, 0, PULL))])]
    found = faying.load_cases(stub.solve(PRELOAD, modes=2), loads, modes=False)
    wanted, share = prying(PULL, 1 / stub.fitted_bolts[0].axial_stiffness)
    assert 0.2 < share < 0.5
    assert found.bolt_force[0] == pytest.approx([wanted, wanted], rel=0.02)
    assert found.normal_force[0, 0] == pytest.approx(PULL * share, rel=0.1)
    # the ends alone touch
    shut = found.pressure[0] > 0
    assert np.abs(found.positions[shut, 0] - HALF).min() > 0.8 * HALF
