"""Bubbles that let the eight-node brick bend: Wilson's incompatible modes with Taylor's correction, condensed out.

R.L. Taylor, P.J. Beresford, E.L. Wilson, "A non-conforming element for stress analysis", Int. J. Numer. Methods Eng. 10
(1976) 1211-1219, doi:10.1002/nme.1620100602. Also CalculiX's C3D8I.
"""

from collections.abc import Callable

import numpy as np

from faying.fe.elements import reference
from faying.typing import Array, Index


def condensed_stiffness(
    points: Array, cells: Index, g: Array, weights: Array, det: Array, stiffness: Callable[[Array, Array], Array]
) -> Array:
    """Stiffness (e, 8, 3, 8, 3) of bricks with the displacements 1 - x^2, 1 - y^2, 1 - z^2 of no node condensed out.

    g (e, q, 8, 3), weights and det (e, q): gradients in space, volumes [m3] and determinants at the points of
    integration; stiffness: of any gradients and weights.
    """
    local, _, _, _ = reference("hex8", 3)
    _, _, _, middle = reference("hex8", 1)
    jacobian = np.einsum("eai,aj->eij", points[cells], middle[0])
    # Taylor: the map of the middle everywhere, scaled, so that uniform stress does no work on the bubbles
    bubbles = np.einsum("jq,ejk->eqjk", -2.0 * local, np.linalg.inv(jacobian))
    bubbles *= (np.linalg.det(jacobian)[:, None] / det)[..., None, None]
    whole = stiffness(np.concatenate([g, bubbles], axis=2), weights).reshape(len(cells), 33, 33)
    held, free = whole[:, :24, :24], whole[:, 24:, 24:]
    mixed = whole[:, 24:, :24]
    return np.asarray(held - mixed.transpose(0, 2, 1) @ np.linalg.solve(free, mixed)).reshape(-1, 8, 3, 8, 3)
