"""Faces that are tied where their meshes do not match: rigid motions, linear fields, and modes of matched meshes."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import eigh

from faying.fe.bonded import bonded_mesh, tie_stiffness
from faying.fe.elasticity import assemble, rigid_motions
from faying.fe.mesh import Mesh
from faying.materials import CATALOGUE
from tests.fe.test_overlap import PAIRS, ring
from tests.helpers.boxes import row
from tests.helpers.sides import sides_on

STEEL = CATALOGUE["S355"]
FACES = ("p0.right", "p1.left")


def bars(sections, kinds=("hex20", "hex20"), counts=(2, 2)):
    return row([0.03, 0.04], counts, kinds=kinds, sections=sections, width=0.02, height=0.02)


@pytest.mark.parametrize("kinds", PAIRS, ids="-".join)
def test_a_field_that_is_linear_over_both_parts_costs_nothing(kinds):
    """Rigid motions and even strains pass through the tie, whatever meets there; a part that moves alone does not."""
    mesh = bars(((3, 2), (4, 5)), kinds)
    K = tie_stiffness(mesh, FACES, STEEL.E)
    linear = np.einsum("ni,ija->nja", mesh.points, np.eye(9).reshape(3, 3, 9)).reshape(-1, 9)
    size = abs(K).max() * mesh.size
    assert np.abs(K @ linear).max() < 1e-10 * size
    alone = np.zeros((len(mesh.points), 3))
    alone[mesh.part_nodes("p1"), 1] = 1.0
    k = 1e5 * STEEL.E / mesh.size
    assert alone.ravel() @ (K @ alone.ravel()) == pytest.approx(k * 4e-4, rel=1e-9)


@pytest.mark.parametrize("kind", ["hex20", "tet10", "hex8"])
def test_round_faces_turn_as_one_across_the_gaps_between_their_chords(kind):
    """A shaft in a bush with other elements around: chords lie up to 3 mm apart, and turning both costs nothing."""
    a, cells_a, r_a = ring(0.7, 1.0, (1, 12, 2), kind)
    b, cells_b, r_b = ring(1.0, 1.2, (1, 17, 3), kind)
    points = np.concatenate([a, b])
    shaft = sides_on(np.flatnonzero(np.isclose(r_a, 1.0)), (cells_a,), len(a))
    bush = tuple(s + len(a) for s in sides_on(np.flatnonzero(np.isclose(r_b, 1.0)), (cells_b,), len(b)))
    mesh = Mesh(
        points=points,
        parts={"a": cells_a, "b": cells_b + len(a)},
        faces={"s": shaft, "b": bush},
        face_part={"s": "a", "b": "b"},
    )
    K = tie_stiffness(mesh, ("s", "b"), STEEL.E)
    motions = rigid_motions(points)
    energy = np.einsum("ia,ia->a", motions, K @ motions)
    assert np.abs(energy).max() < 1e-12 * abs(K).max() * len(points)
    apart = motions.copy()
    apart[: 3 * len(a)] = 0.0
    assert np.einsum("ia,ia->a", apart, K @ apart).min() > 1e-3 * abs(K).max() * (motions**2).sum(axis=0).min() / len(a)


def frequencies(mesh):
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, STEEL))
    for faces in mesh.ties:
        K = K + tie_stiffness(mesh, faces, STEEL.E)
    values = eigh(K.toarray(), M.toarray(), eigvals_only=True, subset_by_index=(0, 13))
    assert np.sqrt(np.abs(values[:6]).max() / values[6]) < 1e-4
    return np.sqrt(values[6:]) / (2 * np.pi)


@pytest.mark.parametrize("kind", ["hex20", "tet10"])
def test_ties_of_matched_faces_have_the_modes_of_merged_nodes(kind):
    """Means over linear functions leave some of a quadratic jump free: lower, by less than 0.3 %."""
    mesh = bars(((3, 3), (3, 3)), (kind, kind))
    merged = bonded_mesh(mesh, [("seam", FACES)])
    assert merged.ties == ()
    tied = replace(mesh, bonded=(("p0", "p1"),), ties=(FACES,))
    change = frequencies(tied) / frequencies(merged) - 1
    assert np.all(change < 0)
    assert np.all(change > -3e-3)


def test_modes_of_unmatched_faces_lie_between_those_of_both_meshes():
    """Two and three elements across, tied, beside both with two and both with three."""
    mixed = bonded_mesh(bars(((2, 2), (3, 3))), [("seam", FACES)])
    assert mixed.ties == (FACES,)
    assert mixed.bodies == (("p0", "p1"),)
    coarse, fine = (frequencies(bonded_mesh(bars((one, one)), [("seam", FACES)])) for one in ((2, 2), (3, 3)))
    found = frequencies(mixed)
    assert np.all(found < coarse)
    assert np.all(found > fine * (1 - 3e-4))
