"""Assemblies of ordinary joints beside CalculiX (`ccx`): bonded modes, and modes under preload with linear contact."""

import shutil
from dataclasses import replace

import numpy as np
import pytest

from faying.case.bounds import bounds
from faying.case.case import Case, build
from faying.fe.elasticity import assemble, rigid_motions
from faying.fe.mesh import Mesh
from faying.joint.structure import Structure
from faying.numerics.modes import lowest_modes
from faying.study import Study
from tests.helpers import assemblies, ccx, ccx_contact
from tests.helpers.bars import even
from tests.helpers.proposed import proposed

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed"),
]
MODES = 8
K_N, K_T = 2e13, 1e13  # Pa/m
SCALE = 0.01  # of the preload in CalculiX, whose stiffness under stress ours lacks; the contact is linear


def study_of(name, folder):
    return Study.read(proposed(assemblies.made(name, folder / f"{name}.step"), assemblies.SIZES[name]))


def fused(mesh, pairs):
    """The mesh with nodes of both faces of each pair that lie at the same place made one."""
    number = np.arange(len(mesh.points))
    for pair in pairs:
        nodes = np.unique(np.concatenate([mesh.face_nodes(face) for face in pair]))
        place = np.round(mesh.points[nodes] * 1e7).astype(np.int64)  # to 0.1 um
        _, first, same = np.unique(place, axis=0, return_index=True, return_inverse=True)
        number[nodes] = number[nodes[first]][same.ravel()]
    used, column = np.unique(number, return_inverse=True)
    return Mesh(
        points=mesh.points[used],
        parts={part: tuple(column[block] for block in blocks) for part, blocks in mesh.parts.items()},
        faces={},
        face_part={},
        bonded=tuple((mesh.face_part[first], mesh.face_part[second]) for first, second in pairs),
    )


@pytest.mark.parametrize("name", ["flanges", "bracket", "t_slots", "spacers"])
def test_bonded_modes_are_those_of_a_fused_mesh(name, tmp_path, published):
    """Without bolts, which CalculiX has not; the mass is the exact one, CalculiX's is integrated by its stiffness."""
    study = study_of(name, tmp_path)
    case = Case.of(replace(study, modes=replace(study.modes, count=MODES)))
    made = case.structure
    bare = Structure(made.mesh, made.materials, made.joints)
    (_, ours), notes = bounds(replace(case, structure=bare))
    assert notes == []  # nodes are merged, no springs in their place
    mesh = fused(made.mesh, [joint.faces for joint in made.joints])
    step = ["*STEP", "*FREQUENCY,SOLVER=ARPACK", f"{MODES + 6}", "*END STEP"]
    ccx.run(tmp_path, ccx.deck(mesh, made.materials, step=step))
    theirs = np.sort(ccx.frequencies(tmp_path))[6:]
    words = name.replace("_", "-")
    for mode, (one, other) in enumerate(zip(ours, theirs, strict=True), 1):
        published(
            f"{words} of STEP without names: bonded mode {mode}",
            other,
            one,
            source=SOURCE,
            unit="Hz",
            rel=3e-3,
            why="the same mesh of tet10 with merged nodes; the rules of the mass differ",
        )


SOURCE = "CalculiX 2.20 (ccx), run by the test"


def held_unknowns(mesh):
    """Six unknowns of three nodes of the first part that no rigid motion leaves at rest."""
    nodes = mesh.part_nodes(next(iter(mesh.parts)))
    x = mesh.points[nodes]
    first = np.argmin(x.sum(axis=1))
    second = np.argmax(np.linalg.norm(x - x[first], axis=1))
    third = np.argmax(np.linalg.norm(np.cross(x - x[first], x[second] - x[first]), axis=1))
    motions, held = rigid_motions(mesh.points), []
    for node in nodes[[first, second, third]]:
        for one in 3 * node + np.arange(3):
            rows = motions[[*held, one]] / np.linalg.norm(motions[[*held, one]], axis=1)[:, None]
            if len(held) < 6 and np.linalg.svd(rows, compute_uv=False)[-1] > 1e-3:
                held.append(int(one))
    assert len(held) == 6
    return held


def in_calculix(structure, forces, folder, modes):
    """Displacements [m] under a hundredth of the preload with linear contact, times a hundred, and frequencies [Hz]."""
    u, found = ccx_contact.preloaded(
        folder,
        structure.mesh,
        structure.materials,
        [joint.faces for joint in structure.joints],
        k_n=K_N,
        k_t=K_T,
        held=held_unknowns(structure.mesh),
        force=SCALE * (structure.loads @ list(forces.values())),
        modes=modes,
    )
    return u / SCALE, found


def linear(name, size, folder):
    """The structure of an assembly with a joint of the same stiffness at every pressure, and the preloads."""
    study = Study.read(proposed(assemblies.made(name, folder / f"{name}.step"), size))
    made = build(study)
    joints = [replace(joint, law=even(K_N, K_T)) for joint in made.joints]
    structure = Structure(made.mesh, made.materials, joints, made.bolts)
    return structure, {name: forces[0] for name, forces in study.bolt_forces.items()}


@pytest.mark.parametrize(
    ("name", "size", "within"), [("spacers", "12 mm", 5e-3), ("flanges", "15 mm", 5e-3), ("bracket", "20 mm", 1e-2)]
)
def test_modes_under_preload_are_those_of_contact_in_calculix(name, size, within, tmp_path):
    """Joints that stay closed, and two of which more than half opens: below bolts, and below screws in tapped holes.

    Both programs get the same nodal forces of bolts and threads, whose shanks are left out of the modes. CalculiX has
    surface-to-surface contact with the same stiffness per area on the same mesh: its displacements give our pressures.
    """
    structure, forces = linear(name, size, tmp_path)
    mesh = structure.mesh
    state = structure.solve(forces, modes=1)
    K, M = assemble(mesh, structure.materials, mass="stiffness")
    K = K + structure.joint_stiffness(state.springs)
    held = held_unknowns(mesh)
    free = np.setdiff1d(np.arange(mesh.unknowns), held)
    ours = lowest_modes(K[free][:, free].tocsr(), M[free][:, free].tocsr(), MODES, shift_frequency=200.0).frequencies
    u, theirs = in_calculix(structure, forces, tmp_path, MODES)
    for joint in structure.joints:
        weights = joint.interface.weights
        mine = state.pressures[joint.name]
        other = K_N * np.maximum(-joint.interface.opening(u), 0)
        assert weights @ other == pytest.approx(weights @ mine, rel=1e-3)
        assert weights @ (other > 0) / weights.sum() == pytest.approx(weights @ (mine > 0) / weights.sum(), abs=0.01)
        assert np.sqrt(weights @ (other - mine) ** 2 / (weights @ mine**2)) < 0.01
    assert ours == pytest.approx(theirs[:MODES], rel=within)
