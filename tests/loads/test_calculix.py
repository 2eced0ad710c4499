"""Prying of a meshed bolt against CalculiX: contact with the same stiffness per area, opening, bolt force."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.fe.interface import join
from faying.fe.sides import sides_on
from faying.joint.attachments import Support
from faying.joint.joint import FittedJoint
from faying.joint.structure import Structure
from faying.loads.acting import acting
from tests.helpers import ccx_contact
from tests.helpers.bars import even
from tests.helpers.voxels import bolted

PRELOAD, K_N, K_T = 4e3, 2e13, 1e13
STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0, expansion=1e-5)
PAIRS = (("lower.joint", "upper.joint"), ("bolt0.head", "upper.seat0"), ("bolt0.nut", "lower.seat0"))


def prying():
    """Two plates that reach beyond their bolt; an end of the lower one is held, the far end of the upper one pulled."""
    mesh = bolted(places=((0.02, 0.02),), length=0.06, kind="hex20")
    faces, owner = dict(mesh.faces), dict(mesh.face_part)
    for name, part, place in (("lower.end", "lower", 0.0), ("upper.end", "upper", 0.06)):
        nodes = mesh.part_nodes(part)
        on = nodes[np.abs(mesh.points[nodes, 0] - place) < 1e-9]
        faces[name], owner[name] = sides_on(on, mesh.parts[part], len(mesh.points)), part
    mesh = replace(mesh, faces=faces, face_part=owner)
    joints = [
        FittedJoint(name=first, faces=(first, second), interface=join(mesh, first, second), law=even(K_N, K_T))
        for first, second in PAIRS
    ]
    bolt = faying.SolidBolt(name="bolt0", part="bolt0", faces=("bolt0.head", "bolt0.nut"))
    return Structure(
        mesh=mesh,
        materials=dict.fromkeys(mesh.parts, STEEL),
        joints=joints,
        bolts=[bolt],
        supports=[Support(face="lower.end")],
    )


@pytest.mark.slow
def test_bolt_force_and_opening_of_a_pried_joint(tmp_path):
    made = prying()
    loads = [
        faying.Load(f"{force:g}", forces=[faying.Force("upper.end", force=(0, 0, force))]) for force in (400.0, 1200.0)
    ]
    found = faying.load_cases(made.solve(PRELOAD, modes=2), loads, modes=False)
    acts = acting(made, loads)
    [fitted] = made.fitted_bolts
    cold = acting(made, [faying.Load("c", temperature={"bolt0": -1.0})])["c"].force

    # they cool along z alone, which takes (1 - nu)/(1 + nu) of the stress along z of a cooling in all directions
    alone = (1 - STEEL.nu) / (1 + STEEL.nu) * (fitted.drawn @ cold)

    def tension(u, temperature):
        return fitted.pull @ u - temperature * alone

    def run(temperature, forces):
        return ccx_contact.solve(
            tmp_path,
            made.mesh,
            made.materials,
            PAIRS,
            k_n=K_N,
            k_t=K_T,
            held=made.mesh.face_nodes("lower.end"),
            shrunk=["bolt0"],
            temperature=temperature,
            forces=forces,
        )

    first = 100.0
    (u,) = run(first, [])
    right = first * PRELOAD / tension(u, first)  # linear: nothing opens on the way
    theirs = run(right, [acts[load.name].force for load in loads])
    forces = np.array([tension(u, right) for u in theirs])
    assert forces[0] == pytest.approx(PRELOAD, rel=2e-3)
    joint = made.joints[0]
    for row, u in enumerate(theirs[1:]):
        assert found.bolt_force[row, 0] - PRELOAD == pytest.approx(forces[row + 1] - forces[0], rel=0.01)
        opening = joint.interface.opening(u)
        w = joint.interface.weights
        assert abs(w @ (opening > 0) / w.sum() - w @ (found.pressure[row][: len(w)] <= 0) / w.sum()) < 0.05
        assert found.displacement[row] == pytest.approx(
            np.linalg.norm((u - theirs[0]).reshape(-1, 3), axis=1).max(), rel=0.02
        )
    assert found.opened[1, 0] > 0.2
    assert found.superposition[1] > 0.1
