"""Bricks with one point of integration, as Abaqus has them under C3D8R: to compare with numbers that were made so."""

import numpy as np
import scipy.sparse as sp

CORNERS = np.array(
    [(-1, -1, -1), (1, -1, -1), (1, 1, -1), (-1, 1, -1), (-1, -1, 1), (1, -1, 1), (1, 1, 1), (-1, 1, 1)], dtype=float
)
HOURGLASS = np.stack([CORNERS[:, 1] * CORNERS[:, 2], CORNERS[:, 2] * CORNERS[:, 0], CORNERS[:, 0] * CORNERS[:, 1]])
HOURGLASS = np.vstack([HOURGLASS, CORNERS.prod(axis=1)])


def mean_gradients(x):
    """Mean gradient of the shapes over each brick (e, 8, 3) and its volume; x: corners (e, 8, 3)."""
    mean, volume = np.zeros(x.shape), np.zeros(len(x))
    for at in CORNERS / np.sqrt(3):
        parts = (1 + CORNERS * at) / 2
        local = np.stack([CORNERS[:, k] / 2 * parts[:, (k + 1) % 3] * parts[:, (k + 2) % 3] for k in range(3)], axis=1)
        jacobian = np.einsum("eai,ak->eik", x, local)
        size = np.linalg.det(jacobian)
        volume += size
        mean += size[:, None, None] * np.einsum("ak,eki->eai", local, np.linalg.inv(jacobian))
    return mean / volume[:, None, None], volume


def one_point(points, cells, *, E, nu, hourglass=0.005):
    """Sparse stiffness [N/m] of bricks (e, 8) of uniform strain, with a small stiffness against hourglass motions.

    hourglass: share of the shear modulus; .005 is Abaqus' own. Source: Flanagan and Belytschko 1981,
    doi:10.1002/nme.1620170504, with the mean gradients of their eq. 16 and the hourglass shapes of their eq. 28.
    """
    x = points[cells]
    gradient, volume = mean_gradients(x)
    shear = E / (2 * (1 + nu))
    pairs = np.einsum("eai,ebj->eaibj", gradient, gradient)
    alike = np.einsum("eai,ebi->eab", gradient, gradient)
    block = 2 * shear * nu / (1 - 2 * nu) * pairs + shear * pairs.transpose(0, 1, 4, 3, 2)
    block += shear * np.einsum("eab,ij->eaibj", alike, np.eye(3))
    block *= volume[:, None, None, None, None]
    pure = HOURGLASS - np.einsum("ha,eai,ebi->ehb", HOURGLASS, x, gradient)
    resist = hourglass * shear * volume * np.einsum("eaa->e", alike) / 8
    block += np.einsum("e,eha,ehb,ij->eaibj", resist, pure, pure, np.eye(3))
    place = (3 * cells[:, :, None] + np.arange(3)).reshape(len(cells), 24)
    where = np.repeat(place, 24, axis=1).ravel(), np.tile(place, 24).ravel()
    return sp.coo_array((block.ravel(), where), shape=(points.size, points.size)).tocsr()
