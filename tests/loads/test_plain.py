"""Load cases against Newton's method on all unknowns, with a factorisation for each of its steps."""

import numpy as np
import pytest
import scipy.sparse as sp
from scipy.sparse.linalg import splu

import faying
from faying.case.acting import acting, nothing
from faying.joint.attachments import Support
from faying.loads.solve import of_state, statics_of
from faying.loads.statics import ROUNDED
from tests.helpers.plates import STEEL, plates, stacked

PRELOAD = 6e3
STEPS = 4


@pytest.fixture(scope="module", params=[None, 0.2], ids=["sticks", "slides"])
def lap(request):
    """Two plates under two bolts, one end of the lower one held; the faces stick, or slide by a friction of 0.2."""
    ends = ("high.top", "low.bottom")
    given = {"diameter": "8 mm", "material": STEEL, "seat": ("9 mm", "16 mm")}
    bolts = tuple(faying.Bolt(f"b{k}", ends, at=(x, 0.02, 0.0), **given) for k, x in enumerate((0.02, 0.06)))
    made = plates(stacked(counts=(6, 3, 1)), bolts=bolts, friction=request.param, supports=[Support(face="low.left")])
    return made, made.solve(PRELOAD, modes=2)


def plain(statics, structure, load, steps):
    """Motion [m] (unknowns,) under a load that grows in steps; each ends where 1e-11 of it is left over."""
    stiffness = sp.csc_matrix(structure.dynamic_matrices[0])
    moved = np.zeros(stiffness.shape[0])
    states = [contact.start for _, contact in statics.joints]
    for step in range(1, steps + 1):
        force = load.force * step / steps
        force[structure.fixed] = 0.0

        def there(moved, states=tuple(states), force=force):
            left, tangent, after = force - stiffness @ moved, stiffness, []
            for (trace, contact), state in zip(statics.joints, states, strict=True):
                now = contact.rest + (trace.relative @ moved).reshape(-1, 3)
                new, traction, slopes = contact.advance(state, now)
                before = contact.advance(contact.start, contact.rest)[1]
                left = left - trace.relative.T @ (contact.weights[:, None] * (traction - before)).ravel()
                block = sp.block_diag(list(contact.weights[:, None, None] * slopes), format="csr")
                tangent = tangent + trace.relative.T @ block @ trace.relative
                after.append(new)
            left[structure.fixed] = 0.0
            return left, tangent, after

        left, tangent, after = there(moved)
        for _ in range(60):
            if np.linalg.norm(left) <= 1e-11 * np.linalg.norm(force):
                break
            tangent = sp.lil_matrix(tangent)
            tangent[structure.fixed] = 0.0
            tangent[structure.fixed, structure.fixed] = 1.0
            way = splu(sp.csc_matrix(tangent)).solve(left)
            for length in 0.5 ** np.arange(8):
                tried = there(moved + length * way)
                if np.linalg.norm(tried[0]) < np.linalg.norm(left):
                    break
            moved, (left, tangent, after) = moved + length * way, tried
        assert np.linalg.norm(left) <= 1e-9 * np.linalg.norm(force)
        states = after
    return moved


def test_the_basis_finds_what_a_factorisation_for_each_step_finds(lap, monkeypatch):
    """Pulled off, pushed along and both, where each increment is solved as the last one is: motions to what may stand.

    That is 1e-6 of each increment where rounding lets it fall no further, as on some processors. As it is, increments
    on the way may leave 1e-2 of the load, and sliders remember that: motions differ by 1e-3.
    """
    made, state = lap
    loads = [
        faying.Load("off", forces=[faying.Force("high.right", force=(0, 0, 400.0))]),
        faying.Load("along", forces=[faying.Force("high.right", force=(1500.0, 300.0, 0))]),
        faying.Load("both", combine={"off": 1.0, "along": 0.8}),
    ]
    acts = acting(made, loads)
    statics = statics_of(of_state(state, modes=False))
    steps = 1 if statics.joints[0][1].friction is None else STEPS
    wanted = {load.name: plain(statics, made, acts[load.name], steps) for load in loads}

    def departures():
        """Of the basis from the plain way, over the greatest motion, for each load."""
        basis = statics_of(of_state(state, modes=False))
        cases = [(load.name, basis.rest_state(nothing(made)), acts[load.name], steps) for load in loads]
        ends = [basis.motion(states[-1]) for states in basis.solve(cases)]
        pairs = zip(ends, wanted.values(), strict=True)
        return [np.abs(motion - plainly).max() / np.abs(plainly).max() for motion, plainly in pairs]

    assert max(departures()) < (1e-6 if steps == 1 else 1e-3)
    monkeypatch.setattr("faying.loads.statics.ON_THE_WAY", 1e-8)
    assert max(departures()) < steps * ROUNDED

    found = faying.load_cases(state, loads, modes=False)
    assert found.opened[0, 0] > 0.05
    assert (found.sliding[1, 0] > 0.1) == (steps > 1)
    assert found.superposition.max() > 0.05
