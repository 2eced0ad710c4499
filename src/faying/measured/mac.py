"""How alike shapes and functions are: MAC, FRAC."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.numerics.product import product
from faying.typing import Array


def mac(a: Any, b: Any, mass: Any | None = None) -> Array:
    """Modal assurance criterion |a* . b|2 / (a* . a)(b* . b) of shapes a (m, d) and b (k, d), complex or real: (m, k).

    Allemang 2003, Sound and Vibration 37(8), eq. (5). Scale and phase of a shape do not matter. A shape without motion
    has a MAC of 0 with all. mass (d, d) [kg], sparse or not, weights the products of shapes of a whole model:
    modes of one structure are orthogonal in it and in nothing else. Raises InputError where the degrees of freedom
    differ in number.
    """
    a, b = (x if np.any(np.imag(x)) else np.real(x) for x in (np.atleast_2d(a), np.atleast_2d(b)))
    if a.shape[1] != b.shape[1]:
        raise InputError(f"shapes at {a.shape[1]} and at {b.shape[1]} degrees of freedom; give both at the same ones")
    if mass is not None:
        return Weighted.of(b.T, mass).mac(Weighted.of(a.T, mass))
    a, b = _unit(a), _unit(b)
    return np.asarray(np.minimum(np.abs(a.conj() @ b.T) ** 2, 1.0))


@dataclass(frozen=True, kw_only=True)
class Weighted:
    """Shapes (d, m) of a whole model, complex or real, with their momenta (d, m) and their sizes (m,) in its mass."""

    shapes: Any
    momenta: Any
    sizes: Array

    @classmethod
    def of(cls, shapes: Any, mass: Any) -> "Weighted":
        """Weight shapes (d, m) by a mass (d, d) [kg], sparse or not."""
        shapes = shapes if np.any(np.imag(shapes)) else np.real(shapes)
        momenta = product(mass, shapes)
        sizes = np.einsum("dm,dm->m", shapes.conj(), momenta).real
        return cls(shapes=shapes, momenta=momenta, sizes=np.where(sizes > 0, sizes, np.inf))

    def mac(self, other: "Weighted") -> Array:
        """MAC of the other's shapes (d, k) with these (d, m): (k, m)."""
        overlap = np.abs(other.shapes.conj().T @ self.momenta) ** 2
        return np.asarray(np.minimum(overlap / np.outer(other.sizes, self.sizes), 1.0))


def _unit(a: Any) -> Any:
    peak = np.abs(a).max(axis=1, keepdims=True, initial=0.0)
    a = a / np.where(peak > 0, peak, 1)
    size = np.linalg.norm(a, axis=1, keepdims=True)
    return a / np.where(size > 0, size, 1)


def frac(measured: Any, predicted: Any) -> Array:
    """Frequency response assurance criterion of two sets of FRFs over the same spectral lines (..., f): (...).

    The MAC along frequency, one number for each FRF (Heylen and Lammens 1996, Proc. Int. Conf. Identification in
    Engineering Systems). It sees the height of the peaks only relative to each other.
    """
    x, a = np.asarray(measured), np.asarray(predicted)
    if x.shape != a.shape:
        raise InputError(f"FRFs of the shapes {x.shape} and {a.shape}; give both at the same pairs and spectral lines")
    top = np.abs(np.sum(x.conj() * a, axis=-1)) ** 2
    size = np.sum(np.abs(x) ** 2, axis=-1) * np.sum(np.abs(a) ** 2, axis=-1)
    return np.asarray(np.divide(top, size, out=np.zeros_like(top), where=size > 0))
