"""Load cases on three structures against CalculiX: contact of the same stiffness per area, friction, opening, heat."""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.materials import MOST_FRICTION
from tests.helpers import ccx_contact
from tests.helpers.ccx_contact import at
from tests.helpers.voxels import bolted

pytestmark = pytest.mark.slow

PRELOAD = 4e3
SOURCE = "CalculiX 2.20, surface-to-surface contact with linear pressure-overclosure and stick slope, same mesh"
QUIET = "a bolt whose force changes by little: CalculiX leaves some 0.1 N"


def compare(published, folder, what, made, pairs, loads, *, change, moved):
    """Bolt forces to 0.1 %, their change by a share or 0.5 N, opened areas to 5 % of all, motions by a share."""
    found = faying.load_cases(made.solve(PRELOAD, modes=2), loads, modes=False)
    forces, motions, openings = ccx_contact.answers(folder, made, pairs, PRELOAD, loads)
    assert forces[0] == pytest.approx(PRELOAD, rel=2e-3)
    w = made.joints[0].interface.weights
    for row, (load, motion, opening) in enumerate(zip(loads, motions, openings, strict=True)):
        case = f"{what}, {load.name}"
        theirs, ours = forces[row + 1] - forces[0], found.bolt_force[row] - PRELOAD
        assert np.ptp(theirs) < 1e-3 * PRELOAD
        published(
            f"bolt force, {case}", forces[row + 1, 0], found.bolt_force[row, 0], source=SOURCE, unit="N", rel=1e-3
        )
        small = change * abs(theirs[0]) < 0.5
        published(
            f"change of bolt force, {case}",
            theirs[0],
            ours[0],
            source=SOURCE,
            unit="N",
            **({"tol": 0.5, "why": QUIET} if small else {"rel": change}),
        )
        published(
            f"share of the joint that is open, {case}",
            w @ (opening > 0) / w.sum(),
            w @ (found.pressure[row][: len(w)] <= 0) / w.sum(),
            source=SOURCE,
            tol=0.05,
        )
        far = np.linalg.norm(motion.reshape(-1, 3), axis=1).max()
        published(
            f"greatest motion, {case}", far * 1e6, found.displacement[row] * 1e6, source=SOURCE, unit="um", rel=moved
        )
    return found


def test_a_pried_bolt(tmp_path, published):
    """Two plates that reach beyond their bolt; an end of the lower one is held, the far end of the upper one pulled."""
    made, pairs, loads = ccx_contact.pried_bolt()
    found = compare(published, tmp_path, "pried bolt", made, pairs, loads, change=0.01, moved=0.02)
    assert found.opened[1, 0] > 0.2
    assert found.superposition[1] > 0.1


@pytest.fixture(scope="module")
def stub():
    """Two plates under two bolts, the lower one held and the upper one pulled in the middle: they pry on their ends."""
    mesh = bolted(places=((0.02, 0.02), (0.06, 0.02)), length=0.08, kind="hex8")
    strip = (0.04, 6.1e-3)
    ends = {"lower.web": ("lower", at(2, 0.0, strip)), "upper.web": ("upper", at(2, 0.02, strip))}
    return ccx_contact.structure(mesh, ends, held="lower.web", friction=0.3)


def test_a_stub_that_is_pulled(stub, tmp_path, published):
    loads = [
        faying.Load(f"{force:g} N", forces=[faying.Force("upper.web", force=(0, 0, force))])
        for force in (2000.0, 5000.0)
    ]
    found = compare(published, tmp_path, "T-stub", *stub, loads, change=0.01, moved=0.03)
    assert found.opened[1, 0] > 0.2
    assert found.superposition[1] > 1


def test_a_stub_whose_flange_is_heated(stub, tmp_path, published):
    """One plate expands along the other, and the whole joint slides."""
    loads = [faying.Load("upper plate 50 K warmer", temperature={"upper": 50.0}, increments=8)]
    found = compare(published, tmp_path, "T-stub", *stub, loads, change=0.01, moved=0.01)
    assert found.sliding[0, 0] > 0.9
    assert found.bolt_force[0, 0] > 1.1 * PRELOAD


def test_shear_that_no_friction_bears_is_named_where_a_face_opens():
    """The same on hex20, heads and nuts sticking by a law with stiffness across at no pressure.

    Where such a point opens its shear ends at once, and no state between is in equilibrium. Where
    it slides, at the greatest friction, there is an answer.
    """
    strip = (0.04, 6.1e-3)
    mesh = bolted(places=((0.02, 0.02), (0.06, 0.02)), length=0.08, kind="hex20")
    ends = {"lower.web": ("lower", at(2, 0.0, strip)), "upper.web": ("upper", at(2, 0.02, strip))}
    made, _ = ccx_contact.structure(mesh, ends, held="lower.web", friction=0.3)
    warm = [faying.Load("warm", temperature={"upper": 50.0}, increments=8)]
    with pytest.raises(faying.NotConverged, match=r"joint \d sticks under a shear of .* times its pressure"):
        faying.load_cases(made.solve(PRELOAD, modes=2), warm, modes=False)
    slides = [replace(joint, friction=joint.friction or MOST_FRICTION) for joint in made.joints]
    found = faying.load_cases(replace(made, joints=tuple(slides)).solve(PRELOAD, modes=2), warm, modes=False)
    assert found.error[0] < 1e-6
    assert found.bolt_force[0].min() > 1.1 * PRELOAD


def test_a_lap_that_slides(tmp_path, published):
    """Pulled along the joint, up to three quarters of what friction carries."""
    mesh = bolted(places=((0.02, 0.02),), length=0.06, kind="hex8")
    ends = {"lower.end": ("lower", at(0, 0.0)), "upper.end": ("upper", at(0, 0.06))}
    made, pairs = ccx_contact.structure(mesh, ends, held="lower.end", friction=0.3)
    loads = [
        faying.Load(f"{force:g} N", forces=[faying.Force("upper.end", force=(force, 0, 0))], increments=8)
        for force in (300.0, 600.0, 900.0)
    ]
    found = compare(published, tmp_path, "lap", made, pairs, loads, change=0.01, moved=0.01)
    assert found.sliding[2, 0] > 0.5
    assert found.superposition[2] > 0.2
