"""Two blocks, straight or turned, matched or not, and the deck of their joint for the tests."""

from dataclasses import replace

import numpy as np

from faying.decks.deck import ContactProperty, JointDeck, UnitSystem
from faying.fe.interface import join
from faying.fe.mesh import Mesh
from faying.joint.pairs import consistent, lumped
from tests.helpers.boxes import row

K_N, K_T, LOSS_N, LOSS_T = 4e13, 2.5e13, 0.02, 0.05
FACES = ("p0.right", "p1.left")


def two(kinds=("hex20", "hex20"), sections=((3, 2), (3, 2)), angle=0.0, counts=(4, 3), numbers=True, move=None):
    """Blocks 60 and 40 mm long that meet at x = 60 mm, then turned about an oblique axis; numbers in steps of 3."""
    mesh = row([0.06, 0.04], counts, kinds=kinds, sections=sections, width=0.03, height=0.02, move=move)
    axis = np.array([0.2, 0.5, 1.0]) / np.linalg.norm([0.2, 0.5, 1.0])
    cross = np.cross(np.eye(3), axis)
    turn = np.eye(3) - np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
    given = 100 + 3 * np.arange(len(mesh.points)) if numbers else None
    return Mesh(
        points=mesh.points @ turn.T, parts=mesh.parts, faces=mesh.faces, face_part=mesh.face_part, node_numbers=given
    )


def springs(points, seed=None):
    """k_n, k_t and loss factors at points, uniform or not."""
    vary = np.ones(points) if seed is None else np.random.default_rng(seed).uniform(0.5, 1.5, points)
    return K_N * vary, K_T * vary, LOSS_N * np.ones(points), LOSS_T * np.ones(points)


def pairs_of(mesh, coupling="nodes", seed=None):
    interface = join(mesh, *FACES)
    if coupling == "faces":
        return consistent(interface, springs(len(interface.weights), seed))
    nodes = interface.at_nodes()
    return lumped(nodes, springs(len(nodes.weights), seed), np.full(len(nodes.weights), 5e6))


def deck_of(mesh, coupling="nodes", seed=1, unit="mm", frequency=500.0, **changes):
    pairs = pairs_of(mesh, coupling, seed)
    p = np.geomspace(1e5, 1e7, 50)
    contact = ContactProperty(
        approach=p / K_N, pressure=p, k_n=K_N, k_t=K_T, loss_n=LOSS_N, mean_pressure=5e6, friction=0.2, given=False
    )
    deck = JointDeck(
        pairs=pairs,
        mesh=mesh,
        faces=FACES,
        system=UnitSystem(unit),
        facts=("a joint", "law: by hand"),
        viscous=None if frequency is None else pairs.loss / (2 * np.pi * frequency),
        frequency=frequency,
        first_element=100001,
        contact=contact,
    )
    return replace(deck, **changes)
