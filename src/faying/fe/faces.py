"""Loads, centres and normals on faces of any elements, flat or curved."""

import numpy as np

from faying.fe.elements import FACES, reference
from faying.fe.sides import Blocks
from faying.typing import Array, Index

# exact for products of two shape functions on straight elements
FACE_DEGREE = {"tri3": 2, "quad4": 3, "tri6": 4, "quad8": 5}


def surface_frame(points: Array, faces: Index, gradients: Array) -> tuple[Array, Array]:
    """Unit normals (f, q, 3) and area per reference area (f, q) on curved element faces of one kind."""
    tangent = np.einsum("fai,qaj->fqij", points[faces], gradients, optimize=True)
    normal = np.cross(tangent[..., 0], tangent[..., 1])
    area = np.linalg.norm(normal, axis=-1)
    return normal / area[..., None], area


def sampled(points: Array, blocks: Blocks) -> list[tuple[Index, Array, Array, Array, Array]]:
    """Per block: the element faces, shape functions (q, a), places (f, q, 3), normals (f, q, 3) and areas (f, q)."""
    out = []
    for faces in blocks:
        kind = FACES[faces.shape[1]].name
        _, weights, values, gradients = reference(kind, FACE_DEGREE[kind])
        normals, area = surface_frame(points, faces, gradients)
        out.append((faces, values, np.einsum("fai,qa->fqi", points[faces], values), normals, area * weights))
    return out


def face_load(points: Array, blocks: Blocks, axis_point: Array, direction: Array) -> Array:
    """Nodal forces [N] (3n,) of a total force 1 N along `direction` whose line of action passes through `axis_point`.

    The traction is uniform up to a linear part across the face, just enough to bring the resultant on the line: two such
    loads on one line with opposite directions balance exactly, whatever the meshes of their faces.
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


def face_centre(points: Array, blocks: Blocks) -> tuple[Array, Array, float]:
    """Centre [m] (3,), mean unit normal (3,), and area [m2] of a face."""
    samples = sampled(points, blocks)
    area = float(sum(share.sum() for *_, share in samples))
    centre = sum(np.einsum("fq,fqi->i", share, place) for _, _, place, _, share in samples) / area
    normal = np.sum([np.einsum("fq,fqi->i", share, normals) for _, _, _, normals, share in samples], axis=0)
    return np.asarray(centre), normal / np.linalg.norm(normal), area
