"""Shape functions of the elements at quadrature points, from scikit-fem."""

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@cache
def reference(kind: str, degree: int) -> tuple[Array, Array, Array, Array]:
    """Return points (d, q), weights (q,), shape functions (q, a) and their gradients (q, a, d) on the reference element.

    kind: "tet10" or "tri6"; degree: polynomials up to it are integrated exactly. Nodes in VTK order, which is also
    scikit-fem's for these two.
    """
    import skfem
    from skfem.quadrature import get_quadrature

    element: Any = {"tet10": skfem.ElementTetP2, "tri6": skfem.ElementTriP2}[kind]()
    count = {"tet10": 10, "tri6": 6}[kind]
    points, weights = get_quadrature(element.refdom, degree)
    values, gradients = zip(*(element.lbasis(points, i) for i in range(count)), strict=True)
    return points, weights, np.stack(values, axis=1), np.stack(gradients, axis=0).transpose(2, 0, 1)


def shape_at(kind: str, local: Array) -> tuple[Array, Array]:
    """Shape functions (q, a) and gradients (q, a, d) at given local coordinates (d, q)."""
    import skfem

    element: Any = {"tet10": skfem.ElementTetP2, "tri6": skfem.ElementTriP2}[kind]()
    count = {"tet10": 10, "tri6": 6}[kind]
    values, gradients = zip(*(element.lbasis(local, i) for i in range(count)), strict=True)
    return np.stack(values, axis=1), np.stack(gradients, axis=0).transpose(2, 0, 1)
