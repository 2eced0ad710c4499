"""Springs between nodes.

Sums, the matrix of springs per area from pairs alone, turned faces, faces that do not match.
"""

import numpy as np
import pytest

import faying
from faying.fe.elasticity import assemble
from faying.fe.interface import join
from faying.joint.pairs import consistent
from faying.numerics.modes import lowest_modes
from tests.helpers import models
from tests.helpers.models import FACES, K_N, K_T, pairs_of, springs, two

STEEL = faying.Material(name="steel", E=200e9, nu=0.3, density=7800.0)
AREA = 0.03 * 0.02
ALL = ["tet10", "hex8", "hex20", "wedge15"]


@pytest.mark.parametrize("kind", ALL)
@pytest.mark.parametrize("coupling", ["nodes", "faces"])
@pytest.mark.parametrize("angle", [0.0, np.pi / 6])
def test_totals_are_stiffness_times_area(kind, coupling, angle):
    pairs = pairs_of(two((kind, kind), angle=angle), coupling)
    k_n, k_t = pairs.totals()
    assert k_n == pytest.approx(K_N * AREA, rel=1e-10)
    assert k_t == pytest.approx(K_T * AREA, rel=1e-10)
    if coupling == "nodes":
        assert pairs.area.min() > 0
        assert pairs.area.sum() == pytest.approx(AREA, rel=1e-10)


@pytest.mark.parametrize("kinds", [("tet10", "tet10"), ("hex8", "hex8"), ("hex20", "tet10")])
@pytest.mark.parametrize("sections", [((2, 2), (2, 2)), ((2, 2), (3, 2))])
def test_springs_per_area_are_pairs_of_nodes(kinds, sections):
    """The sum over pairs is the matrix itself, of any faces, turned or not."""
    mesh = two(kinds, sections, angle=0.7)
    interface = join(mesh, *FACES)
    given = springs(len(interface.weights), seed=3)
    pairs = consistent(interface, given)
    want, lost = interface.springs(*given[:2]), interface.springs(given[0] * given[2], given[1] * given[3])
    assert abs(pairs.matrix() - want).max() < 1e-12 * abs(want).max()
    assert abs(pairs.matrix(pairs.loss) - lost).max() < 1e-12 * abs(lost).max()


def test_lumped_pairs_are_the_springs_at_nodes():
    mesh = two(angle=0.4)
    nodes = join(mesh, *FACES).at_nodes()
    given = springs(len(nodes.weights), seed=1)
    assert abs(pairs_of(mesh, seed=1).matrix() - nodes.springs(*given[:2])).max() < 1e-12 * K_N * AREA


def frequencies(mesh, pairs, count=6):
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, STEEL))
    return lowest_modes(K + pairs.matrix(), M, 6 + count, shift_frequency=1000.0).frequencies


@pytest.mark.parametrize("coupling", ["nodes", "faces"])
def test_a_face_at_30_degrees(coupling):
    straight = frequencies(two(), pairs_of(two(), coupling, None))
    turned = frequencies(two(angle=np.pi / 6), pairs_of(two(angle=np.pi / 6), coupling, None))
    assert np.all(turned[:6] < 1e-4 * turned[6])
    assert turned[6:] == pytest.approx(straight[6:], rel=1e-8)


def test_lumping_tends_to_springs_per_area_with_the_mesh():
    """Shares of area at nodes differ from springs per area by an amount that falls with the mesh, at least linearly."""
    differ = []
    for n in (1, 2, 4):
        mesh = two(("hex8", "hex8"), ((n, n), (n, n)), counts=(3 * n, 2 * n))
        a, b = (frequencies(mesh, pairs_of(mesh, coupling))[6:] for coupling in ("nodes", "faces"))
        differ.append(np.abs(a / b - 1).max())
    assert differ[1] < differ[0] / 2
    assert differ[2] < differ[1] / 2


def test_faces_that_do_not_match():
    """The error of unmatched meshes against a matched one is that of the mesh, not of the pairing."""
    matched = frequencies(two(sections=((4, 3), (4, 3))), pairs_of(two(sections=((4, 3), (4, 3))), "faces"))[6:]
    mesh = two(sections=((4, 3), (3, 2)))
    unmatched = frequencies(mesh, pairs_of(mesh, "faces"))
    assert np.all(unmatched[:6] < 1e-4 * unmatched[6])
    assert unmatched[6:] == pytest.approx(matched, rel=2e-3)
    with pytest.raises(faying.InputError, match="need faces whose meshes match"):
        pairs_of(mesh, "nodes")


def test_own_axes_of_a_curved_face_are_refused():
    mesh = two(("hex8", "hex8"), ((4, 1), (4, 1)))
    bent = mesh.points.copy()
    bent[:, 0] += 2.0 * (bent[:, 1] - 0.015) ** 2
    curved = faying.fe.mesh.Mesh(points=bent, parts=mesh.parts, faces=mesh.faces, face_part=mesh.face_part)
    assert models.pairs_of(curved).own(models.pairs_of(curved).stiffness).min() > 0
    pairs = pairs_of(curved, "faces")
    with pytest.raises(faying.InputError, match="springs of a curved face do not act along one normal"):
        pairs.own(pairs.stiffness)
