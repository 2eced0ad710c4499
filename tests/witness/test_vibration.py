"""A welded bar on a shaker, on the same mesh in CalculiX: steady state under the motion of its support."""

import re
import shutil

import numpy as np
import pytest
from scipy.linalg import eigh

import faying
from faying.fe.bonded import bonded_mesh
from faying.joint.attachments import Support
from faying.joint.structure import Structure
from tests.helpers import ccx
from tests.helpers.boxes import row

STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0)
BAND = (100.0, 8000.0)
MODES = 20
THEIRS = 120  # modes of CalculiX, which adds nothing for those that it leaves out


@pytest.fixture(scope="module")
def state():
    cut = row([0.06, 0.05], [4, 4], kinds=("hex20",) * 2, sections=((2, 2),) * 2, width=0.02, height=0.012)
    mesh = bonded_mesh(cut, [("seam", ("p0.right", "p1.left"))])
    held = Structure(
        mesh=mesh, materials=dict.fromkeys(mesh.parts, STEEL), joints=(), bolts=(), supports=[Support(face="p0.left")]
    )
    return held.solve(modes=MODES)


def test_parts_without_a_bolt_are_shaken_and_swept(state):
    """A table of 1 m/s2 in a sweep and of its square over 1 Hz in noise: alike where the damping is that at rest."""
    noise = faying.Excitation("noise", psd=[(f, 1e-4) for f in BAND], direction=(0, 0, 1))
    sweep = faying.Excitation("sweep", sine=[(f, 1e-2) for f in BAND], direction=(0, 0, 1), rate=1.0)
    (random, sine) = faying.vibration(state, [noise, sweep])
    for one in (random, sine):
        assert one.bolt_force.shape == one.damage.shape == (3, 0)
        assert "vibration-alone" not in [note.code for note in one.notes]  # no joint, no slip
    peaks = [np.sqrt(random.curve[1].max() / 1e-4), sine.curve[1].max() / 1e-2]
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-3)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
def test_a_shaken_base_is_that_of_calculix(state, tmp_path):
    """Away from the resonances, on their flanks and at their peaks, under the same damping of each mode.

    CalculiX leaves out what the consistent mass couples of the free nodes to those of the support: 0.1 to 0.2 % here.
    With it the dense matrices give our answer, without it that of CalculiX.
    """
    structure, mesh = state.structure, state.structure.mesh
    (found,) = faying.vibration(state, [faying.Excitation("noise", psd=[(f, 1.0) for f in BAND], direction=(0, 0, 1))])
    first, second, third = found.rest_frequency[:3]
    wanted = (300.0, first, 1.001 * first, 1.3 * first, second, 0.98 * third, third, 7000.0)
    at = [int(np.argmin(np.abs(found.line_frequency - f))) for f in wanted]
    lines, damping = found.line_frequency[at], found.rest_damping[1, 0]
    node = int(np.argmin(np.linalg.norm(mesh.points - found.points[1], axis=1)))

    held = [f"{one // 3 + 1},{one % 3 + 1}" for one in structure.fixed]
    step = ["*BOUNDARY", *held, "*NSET,NSET=ONE", f"{node + 1}", "*AMPLITUDE,NAME=EVEN", "0.,1000.,1.e6,1000."]
    step += ["*STEP", "*FREQUENCY,STORAGE=YES", f"{THEIRS}", "*END STEP"]
    for f in lines:
        step += ["*STEP", "*STEADY STATE DYNAMICS", f"{f:.12e},{f * (1 + 1e-9):.12e},2,1."]
        step += ["*MODAL DAMPING", f"1,{THEIRS},{damping:.9e}", "*BASE MOTION,DOF=3,AMPLITUDE=EVEN,TYPE=ACCELERATION"]
        step += ["*NODE PRINT,NSET=ONE", "U", "*END STEP"]
    ccx.run(tmp_path, ccx.deck(mesh, dict.fromkeys(mesh.parts, STEEL), step=step))
    # real and imaginary part [mm], one after the other, at all frequencies of the steps: ours and those of modes
    moved = re.findall(rf"and time +(\S+)\n\n +{node + 1} +\S+ +\S+ +(\S+)\n", (tmp_path / "job.dat").read_text())
    times, parts = np.array(moved, dtype=float).reshape(-1, 2, 2).transpose(2, 0, 1)
    nearest = [int(np.argmin(np.abs(times[:, 0] - f))) for f in lines]
    theirs = np.hypot(*parts[nearest].T) * (2 * np.pi * lines) ** 2 / 1000

    M, along = structure.inertia(np.eye(mesh.unknowns)), np.tile([0.0, 0.0, 1.0], len(mesh.points))
    free = np.setdiff1d(np.arange(len(M)), structure.fixed)
    inside = M[np.ix_(free, free)]
    squared, shapes = eigh(structure.elastic_forces(np.eye(len(M)))[np.ix_(free, free)], inside)
    here = shapes[np.searchsorted(free, 3 * node + 2)]

    def exact(inertia):
        drive = 2 * np.pi * lines[:, None]
        q = -(inertia @ shapes) / (squared - drive**2 + 2j * damping * np.sqrt(squared) * drive)
        return np.abs(1 - drive[:, 0] ** 2 * (q @ here))

    assert np.sqrt(found.curve[1, 1, at]) == pytest.approx(exact((M @ along)[free]), rel=2e-4)
    assert theirs == pytest.approx(exact(inside @ along[free]), rel=2e-4)
