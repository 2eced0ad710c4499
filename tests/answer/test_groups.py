"""Symmetric structures: a mode keeps its symmetry whatever the joints do, and twins have one interval.

Each structure looks the same after a turn about z by 360 / n degrees. The product of a shape with its turned self is
the cosine of 360 m / n degrees, m its waves around the axis: no law, no ratio and no preload changes that.
"""

from dataclasses import replace

import numpy as np
import pytest

import faying
from faying.answer.interval import Draws, _laws, intervals
from faying.case.bounds import bounds
from faying.case.case import Case, Progress
from faying.case.changed import ChangedCase, frequencies_of
from faying.case.mesh_error import mesh_error
from faying.case.scatter import known_of
from faying.case.solve import solve
from faying.numerics.follow import same_group
from tests.helpers.meshfiles import LOW_AND_HIGH, abaqus
from tests.helpers.rings import discs
from tests.helpers.voxels import voxels

MM, MODES = 1e-3, 9
LOWEST = slice(6)  # of those modes: these stay among them
NEAR = 4e-3  # by which the small basis misses two modes that mix
STUDY = (
    LOW_AND_HIGH
    + """[modes]
count = 9
levels = []
"""
)
JOINT = '[[joint]]\nname = "j{k}"\nfaces = ["low.top{k}", "high.bottom{k}"]\n'
BOLT = '[[bolt]]\nname = "b{k}"\nfaces = ["high.top{k}", "low.bottom{k}"]\npreload = ["{force} kN"]\n'


def at(height, where=lambda p: np.full(len(p), True)):
    """Which nodes lie at a height, and where else."""
    return lambda p: (np.abs(p[:, 2] - height) < 1e-9) & where(p)


def stack(fine):
    """Two flat discs: their torsion passes twins as the joint softens."""
    heights = np.linspace(0, 40, 3 if fine else 2) * MM
    mesh = discs(np.array([5, 12, 20]) * MM, 16, heights)
    renamed = {f"{name}0": face for name, face in mesh.faces.items()}
    return replace(mesh, faces=renamed, face_part={f"{name}0": part for name, part in mesh.face_part.items()}), 16, 1


def frame(fine):
    """Two square frames of 20 mm bars."""
    line = np.linspace(-60, 60, 13 if fine else 7) * MM
    z = np.linspace(-15, 15, 5 if fine else 3) * MM

    def ring(up):
        return lambda p: (np.abs(p[:, :2]).max(axis=1) > 40 * MM) & ((p[:, 2] > 0) == up)

    faces = {"low.bottom0": ("low", at(-15 * MM)), "low.top0": ("low", at(0.0))}
    faces |= {"high.bottom0": ("high", at(0.0)), "high.top0": ("high", at(15 * MM))}
    return voxels((line, line, z), {"low": ring(False), "high": ring(True)}, faces), 4, 1


def feet(fine):
    """A plate on four equal feet of 20 mm at the corners of a block."""
    line = np.array([-50, -40, -30, -10, 10, 30, 40, 50] if fine else [-50, -30, 0, 30, 50]) * MM
    z = np.array([-20, -10, 0, 5, 10, 13, 16] if fine else [-20, -10, 0, 10, 16]) * MM

    def plate(p):
        return (p[:, 2] > 0) & ((p[:, 2] > 10 * MM) | (np.abs(p[:, :2]).min(axis=1) > 30 * MM))

    faces = {}
    for k, (x, y) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):

        def foot(p, x=x, y=y):
            return (x * p[:, 0] > 30 * MM - 1e-9) & (y * p[:, 1] > 30 * MM - 1e-9)

        for name, height in (("low.bottom", -20), ("low.top", 0), ("high.bottom", 0), ("high.top", 16)):
            faces[f"{name}{k}"] = (name.split(".")[0], at(height * MM, foot))
    return voxels((line, line, z), {"low": lambda p: p[:, 2] < 0, "high": plate}, faces), 4, 4


MADE = {"stack": stack, "frame": frame, "feet": feet}


def prepared(folder, name, fine=False):
    """Name and case of a structure, its state, and the number of turns after which it looks the same."""
    mesh, turns, joints = MADE[name](fine)
    (folder / "model.inp").write_text(abaqus(mesh))
    more = [one.format(k=k, force=5.0 / joints) for one in (JOINT, BOLT) for k in range(joints)]
    (folder / "study.toml").write_text(STUDY.replace("[modes]", "\n".join(more) + "[modes]"))
    case = Case.of(faying.Study.read(folder / "study.toml"))
    return name, case, [solve(case, 0, case.engine("reanalysis"), Progress(1))], turns


def around(case, shapes, turns):
    """Cosine of 360 m / n degrees of each mode (k,), the mean of twins, from shapes (d, k) of unit modal mass."""
    mesh, angle = case.structure.mesh, 2 * np.pi / turns
    turn = np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])
    out = np.empty_like(shapes)
    for part in mesh.parts:
        nodes = mesh.part_nodes(part)
        order = {tuple(np.round(p, 7) + 0.0): k for k, p in zip(nodes, mesh.points[nodes], strict=True)}
        to = [order[tuple(np.round(p, 7) + 0.0)] for p in mesh.points[nodes] @ turn.T]
        moved = shapes.reshape(-1, 3, shapes.shape[1])[nodes]
        out.reshape(-1, 3, shapes.shape[1])[to] = np.einsum("ij,njk->nik", turn, moved)
    return np.einsum("dk,dk->k", shapes, case.structure.dynamic_matrices[1] @ out)


def by_symmetry(case, state, turns):
    """The cosine of each mode of a state (m,), the mean of twins."""
    groups = same_group(state.damped.frequencies)
    return np.round(groups @ around(case, shapes_of(case, state), turns) / groups.sum(axis=1), 2)


def shapes_of(case, state):
    return state.modes.shapes[:, case.rigid_count :][:, :MODES]


def solved_with(case, **changes):
    """The state of a case with other joints, in full."""
    changed = replace(case, structure=case.structure.with_joints(**changes))
    return solve(changed, 0, changed.engine("direct"), Progress(1))


@pytest.fixture(scope="module", params=sorted(MADE))
def solved(request, tmp_path_factory):
    return prepared(tmp_path_factory.mktemp(request.param), request.param)


@pytest.mark.slow
@pytest.mark.parametrize(("law", "ratio"), [(0.06, None), (0.3, 0.2), (4.0, 0.9)])
def test_no_law_and_no_ratio_changes_the_symmetry_of_a_mode(solved, law, ratio):
    """Each followed frequency is one of the full solution with the same number of waves around the axis."""
    _, case, states, turns = solved
    before = by_symmetry(case, states[0], turns)
    laws = [joint.law if ratio is None else replace(joint.law, tangential=ratio) for joint in case.structure.joints]
    laws = [one.scaled(law) for one in laws]
    (found,) = frequencies_of(case, states, [replace(ChangedCase.nothing(case), laws=laws)], [None])
    full = solved_with(case, laws=laws)
    there, after = full.damped.frequencies, by_symmetry(case, full, turns)
    for frequency, kind in zip(found[0][LOWEST], before[LOWEST], strict=True):
        assert np.abs(there[np.abs(after - kind) < 0.05] / frequency - 1).min() < NEAR


@pytest.mark.slow
def test_twins_have_one_interval_that_holds_them_under_other_waves(solved):
    """Waves are nowhere alike: the two modes that lie most in the plane of twins are both in their interval."""
    _, case, states, _ = solved
    interval = intervals(case, states, None)[1].between(*bounds(case)[0])
    full = solved_with(case, laws=_laws(case, known_of(case)), gaps=Draws.of(case, known_of(case)).gaps(case, 17))
    shapes, moved, M = shapes_of(case, states[0]), shapes_of(case, full), case.structure.dynamic_matrices[1]
    alike = (shapes.T @ (M @ moved)) ** 2
    groups = same_group(states[0].damped.frequencies)
    assert groups.sum() >= MODES + 4  # two pairs at least
    for group in groups[groups.sum(axis=1) == 2]:
        for ends in (interval.low[0], interval.best[0], interval.high[0], *interval.offsets.reshape(-1, MODES)):
            assert np.ptp(ends[group]) <= 1e-9 * np.abs(ends[group]).max()
        both = full.damped.frequencies[np.argsort(alike[group].sum(axis=0))[-2:]]
        assert np.all((interval.low[0][group] < both) & (both < interval.high[0][group]))


@pytest.mark.slow
def test_a_finer_mesh_has_the_same_groups_in_the_same_order(solved, tmp_path):
    name, case, states, turns = solved
    _, finer, there, _ = prepared(tmp_path, name, fine=True)
    symmetries = [by_symmetry(*one, turns)[LOWEST] for one in ((case, states[0]), (finer, there[0]))]
    assert np.array_equal(*symmetries)
    intervals_of = [intervals(*one, mesh_error(*one))[1] for one in ((case, states), (finer, there))]
    for one in intervals_of:
        for group in same_group(states[0].damped.frequencies[LOWEST]):
            assert np.ptp(one.best[0][LOWEST][group]) <= 1e-9 * one.best.max()
    coarse, fine = intervals_of
    # the frame has two pairs of twins within 1 %, of one symmetry, which mix
    assert np.all(coarse.low[0][LOWEST] < fine.high[0][LOWEST])
    assert np.all(fine.low[0][LOWEST] < coarse.high[0][LOWEST])


def test_a_change_by_way_of_itself_is_that_change(tmp_path):
    """The torsion of two discs passes two pairs of twins; no second step is left then, so that none changes places."""
    _, case, states, _ = prepared(tmp_path, "stack")
    laws = [replace(joint.law, tangential=0.02) for joint in case.structure.joints]
    change = replace(ChangedCase.nothing(case), laws=laws)
    once, again = frequencies_of(case, states, [change, change], [None, 0])
    assert once[0].argmin() == 2
    np.testing.assert_allclose(again, once, rtol=1e-9)
