"""Loads on faces for the tests."""

import numpy as np

from faying.bolt.bolt import Bolt
from faying.fe.sides import sampled


def face_load(points, blocks, axis_point, direction):
    """Nodal forces [N] (3n,) of a total force 1 N along `direction` whose line of action passes through `axis_point`.

    The traction is uniform up to a linear part across the face, just enough to bring the resultant on the line: two
    such loads on one line with opposite directions balance exactly, whatever the meshes of their faces.
    """
    unit = direction / np.linalg.norm(direction)
    helper = np.eye(3)[np.argmin(np.abs(unit))]
    across = np.stack([np.cross(unit, helper), np.cross(unit, np.cross(unit, helper))])
    across /= np.linalg.norm(across, axis=1)[:, None]
    samples = sampled(points, blocks)
    radius = float(np.sqrt(sum(share.sum() for *_, share in samples)))
    bases = [
        np.concatenate([np.ones((*share.shape, 1)), (place - axis_point) @ across.T / radius], axis=2)
        for _, _, place, _, share in samples
    ]
    gram = sum(np.einsum("fq,fqi,fqj->ij", one[-1], basis, basis) for one, basis in zip(samples, bases, strict=True))
    factors = np.linalg.solve(gram, [1.0, 0.0, 0.0])
    total = np.zeros(len(points))
    for (faces, values, _, _, share), basis in zip(samples, bases, strict=True):
        np.add.at(total, faces.ravel(), np.einsum("fq,qa->fa", share * (basis @ factors), values).ravel())
    return np.asarray(total[:, None] * unit).reshape(-1)


def bolt_load(structure, first, second):
    """Nodal forces [N] (unknowns,) of a bolt that pulls two faces towards each other with 1 N."""
    return Bolt(name="bolt", faces=(first, second)).fitted(structure.mesh).load
