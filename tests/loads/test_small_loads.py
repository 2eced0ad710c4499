"""Small loads on two plates with two bolts under a contact law: linear, reciprocal, as direct solutions have them."""

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

import faying
from faying.case.acting import acting, nothing
from faying.joint.attachments import Support
from faying.loads.solve import of_state, statics_of
from tests.helpers.plates import plates, stacked

TINY = 1e-4  # N


@pytest.fixture(scope="module", params=[None, 0.3], ids=["sticks", "slips"])
def tight(request):
    """Plates of different thickness of mesh, held at one end."""
    bolts = [
        faying.Bolt(
            f"b{k}",
            ("low.bottom", "high.top"),
            at=(x, 0.02, 0),
            diameter="6 mm",
            material="45 steel",
            seat=(0, "12 mm"),
        )
        for k, x in enumerate((0.02, 0.06))
    ]
    mesh = stacked(counts=(8, 4, 1))
    return plates(mesh, bolts=bolts, friction=request.param, supports=[Support(face="low.left")]).solve(
        {"b0": 4000.0, "b1": 6000.0}, modes=2
    )


def cases(size):
    return [
        faying.Load("bend", forces=[faying.Force("high.right", force=(0, 0, size))]),
        faying.Load("shear", forces=[faying.Force("low.right", force=(size, size / 2, 0), moment=(0, 0, 0.01 * size))]),
        faying.Load("both", combine={"bend": 1.0, "shear": 2.0}),
    ]


def test_small_loads_are_those_of_the_matrices(tight):
    """The nonlinear answer to a small load, and the linear one, are K_0^-1 f to 1e-6 and 1e-9; work is reciprocal."""
    structure = tight.structure
    statics = statics_of(of_state(tight, modes=False))
    acts = acting(structure, cases(TINY))
    linear = statics.linear(list(acts.values()))
    stiffness, _ = structure.coupled(tight.springs)
    for act, found in zip(acts.values(), linear, strict=True):
        force = act.force.copy()
        force[structure.fixed] = 0.0
        wanted = spsolve(stiffness.tocsc(), force)
        assert np.abs(found - wanted).max() < 1e-9 * np.abs(wanted).max()
    bend, shear = (acts[name].force for name in ("bend", "shear"))
    assert bend @ linear[1] == pytest.approx(shear @ linear[0], rel=1e-9)
    assert linear[2] == pytest.approx(linear[0] + 2 * linear[1], abs=1e-9 * np.abs(linear[2]).max())
    rest = statics.rest_state(nothing(structure))
    for (name, act), straight in zip(acts.items(), linear, strict=True):
        [state] = statics.solve([(name, rest, act, 1)])
        moved = statics.motion(state[-1])
        assert np.abs(moved - straight).max() < 1e-6 * np.abs(straight).max()


def test_superposition_does_for_small_loads_and_not_for_great_ones(tight):
    # from 1.9 kN on the joint that sticks would open under a shear of 2,800 times its pressure
    small, great = (faying.load_cases(tight, cases(size), modes=False) for size in (TINY, 1500.0))
    assert small.superposition.max() < 1e-6
    assert small.superposes.all()
    assert not great.superposes.any()
    assert np.all(great.opened[[0, 2], 0] > 0.5)
    # the forces on every case balance: what crosses the joint is what acts on the free plate
    up = great.cases.index("bend")
    bolts = great.bolt_force[up] - great.bolt_preload
    assert bolts.sum() - (great.normal_force[up] - great.normal_preload).sum() == pytest.approx(1500.0, rel=1e-6)


def test_the_answer_does_not_depend_on_the_basis_or_on_the_company(tight):
    """One case alone, and after others in the same basis.

    Sliders remember increments on the way, which may leave 1e-2 of the load: pressures differ by 1e-3 at most then.
    """
    near = 1e-4 if tight.structure.joints[0].friction is None else 1e-3
    alone = faying.load_cases(tight, cases(1500.0)[:1], modes=False)
    others = faying.load_cases(tight, [*cases(1500.0)[1:2], *cases(1500.0)[:1]], modes=False)
    assert alone.bolt_force[0] == pytest.approx(others.bolt_force[1], rel=1e-6)
    assert alone.pressure[0] == pytest.approx(others.pressure[1], abs=near * alone.pressure[0].max())
    # and it satisfies the equations of the whole structure
    statics = statics_of(of_state(tight, modes=False))
    acts = acting(tight.structure, cases(1500.0))
    [[*_, state]] = statics.solve([("bend", statics.rest_state(nothing(tight.structure)), acts["bend"], 4)])
    moved, structure = statics.motion(state), tight.structure
    force = acts["bend"].force - structure.elastic_forces(moved)
    for (trace, contact), traction in zip(statics.joints, state.tractions, strict=True):
        before = contact.advance(contact.start, contact.rest)[1]
        force -= trace.relative.T @ (contact.weights[:, None] * (traction - before)).ravel()
    free = np.setdiff1d(np.arange(len(force)), structure.fixed)
    assert np.linalg.norm(force[free]) < 1e-5 * np.linalg.norm(acts["bend"].force)
    # the error that it states is what is left over, in its energy on the springs at rest, over that of the load
    left, whole = (np.where(np.isin(np.arange(len(one)), free), one, 0.0) for one in (force, acts["bend"].force))
    stiffness = structure.coupled(tight.springs)[0].tocsc()
    energies = [one @ spsolve(stiffness, one) for one in (left, whole)]
    assert state.error == pytest.approx(np.sqrt(energies[0] / energies[1]), rel=0.2)
