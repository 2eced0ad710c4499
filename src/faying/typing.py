"""Names of array types, once for all modules."""

from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Array: TypeAlias = NDArray[np.float64]
Complex: TypeAlias = NDArray[np.complex128]
Index: TypeAlias = NDArray[np.int64]
Mask: TypeAlias = NDArray[np.bool_]
Sparse: TypeAlias = Any
"""A SciPy sparse matrix or array: SciPy ships no types, so that a checker cannot see into it."""
AnyArray: TypeAlias = NDArray[Any]
"""An array of floats in double or single precision, of complex numbers, truth values or indices."""
Quantity: TypeAlias = Any
"""An array of numbers, or None where a model does not define it; a script that asks for one knows its model."""
