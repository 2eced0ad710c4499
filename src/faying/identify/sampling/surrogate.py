"""A polynomial in place of a model, with the error that it makes at points that it has not seen."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations_with_replacement
from typing import Self, final

import numpy as np

from faying.errors import InputError
from faying.typing import Array, Index, Mask

POINTS_PER_COEFFICIENT = 2.0
HIGHEST = 7  # degree that is tried
FLATNESS = (1.0, 0.75, 0.5)  # of the norm that limits the terms: 1 is the total degree, 0.5 leaves few mixed terms
ROUNDING = 1e-11  # of an output's largest value: an error that is less by no more takes no other terms
DEPENDENT = 1e-10  # relative pivot below which a column of the design says nothing new


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class Surrogate:
    """Polynomials of d inputs for m outputs.

    An input is the standardised value of its distribution, (x - centre)/spread, of ln x for a lognormal one. A bounded
    input, of a uniform distribution, has Legendre polynomials on -1 to 1, any other Hermite polynomials: both are
    orthonormal under their prior. To map every input to a normal score instead would bend what is straight: a model
    that is linear in a uniform input would not be a polynomial of its score.

    Args:
        bounded: which inputs have Legendre polynomials (d,).
        terms: the degree of each term in each input (p, d).
        coefficients: of each term in each output (p, m).
        error: root mean square of the error at points left out one at a time, corrected for their number (m,).
        degree: the highest degree of each output's terms (m,).
        points: how many points each output was fitted to (m,).
    """

    bounded: Mask
    terms: Index
    coefficients: Array
    error: Array
    degree: Index
    points: Index

    @classmethod
    def fit(cls, x: Array, y: Array, *, degree: int = HIGHEST, bounded: Sequence[bool] | None = None) -> Self:
        """Fit by least squares; the terms of each output are those with the least leave-one-out error.

        Terms are those of a total degree up to `degree`, or fewer mixed ones (a hyperbolic truncation), with at least
        2 points for each coefficient.

        Args:
            x: standardised inputs (n, d).
            y: outputs (n, m); NaN where a point has no answer, which then is left out for that output.
            degree: the highest degree that is tried, 1 or more.
            bounded: which inputs are uniform on -1 to 1; none where not given.

        Raises:
            InputError: an output has fewer than 2 points.

        Source: orthonormal polynomials and leave-one-out error from the hat matrix: Blatman and Sudret 2011,
            doi:10.1016/j.jcp.2010.12.021, eqs. (6), (20), (29); the correction for few points: Chapelle, Vapnik and
            Bengio 2002, doi:10.1023/A:1013943418833.
        """
        x, y = np.asarray(x, dtype=float), np.asarray(y, dtype=float)
        limited = np.zeros(x.shape[1], dtype=bool) if bounded is None else np.asarray(bounded, dtype=bool)
        known = np.isfinite(y)
        if known.sum(axis=0).min(initial=2) < 2:
            raise InputError(f"output {int(known.sum(axis=0).argmin()) + 1} has an answer at fewer than 2 points")
        sets = _term_sets(x.shape[1], degree, int(POINTS_PER_COEFFICIENT**-1 * known.sum(axis=0).max(initial=2)))
        terms = np.unique(np.concatenate(sets), axis=0)
        place = {term.tobytes(): k for k, term in enumerate(terms)}
        where = [np.array([place[term.tobytes()] for term in chosen]) for chosen in sets]
        columns = _columns(_values(x, limited, int(terms.max())), terms)
        coefficients = np.zeros((len(terms), y.shape[1]))
        error = np.full(y.shape[1], np.inf)
        best = np.zeros(y.shape[1], dtype=np.int64)
        gain = ROUNDING * np.abs(np.where(known, y, 0.0)).max(axis=0)
        for pattern, outputs in _patterns(known):
            for entries, chosen in zip(where, sets, strict=True):
                if len(entries) > 1 and len(entries) * POINTS_PER_COEFFICIENT > pattern.sum():
                    continue
                found, left_out = _least_squares(columns[np.ix_(pattern, entries)], y[np.ix_(pattern, outputs)])
                better = left_out < error[outputs] - gain[outputs]
                improved = outputs[better]
                coefficients[:, improved] = 0.0
                coefficients[np.ix_(entries, improved)] = found[:, better]
                error[improved] = left_out[better]
                best[improved] = chosen.sum(axis=1).max()
        points = known.sum(axis=0).astype(np.int64)
        return cls(bounded=limited, terms=terms, coefficients=coefficients, error=error, degree=best, points=points)

    def predict(self, x: Array) -> Array:
        """The outputs (k, m) at standardised inputs (k, d)."""
        return _columns(_values(x, self.bounded, self._highest), self.terms) @ self.coefficients

    def gradient(self, x: Array) -> Array:
        """The derivatives (k, m, d) of the outputs by the inputs, at standardised inputs (k, d)."""
        values = _values(x, self.bounded, self._highest)
        out = np.empty((len(x), self.coefficients.shape[1], len(self.bounded)))
        for j, limited in enumerate(self.bounded):
            changed = values.copy()
            changed[j] = values[j] @ _derivative(self._highest, bool(limited)).T
            varies = self.terms[:, j] > 0
            out[:, :, j] = _columns(changed, self.terms[varies]) @ self.coefficients[varies]
        return out

    @cached_property
    def _highest(self) -> int:
        return int(self.terms.max(initial=0))


def _term_sets(inputs: int, degree: int, most: int) -> list[Index]:
    """Sets of terms to choose from, each with its degrees (p, d), the constant alone first; at most `most` terms."""
    every = (_terms(inputs, highest, flatness, most) for highest in range(degree + 1) for flatness in FLATNESS)
    return list({terms.tobytes(): terms for terms in every if terms is not None}.values())


def _terms(inputs: int, degree: int, flatness: float, most: int) -> Index | None:
    """Terms with (sum of degree_j^flatness)^(1/flatness) <= degree; None where they are too many."""
    # most inputs that one term may mix: each takes part with a degree of at least 1
    mixed = int(degree**flatness + 1e-9)
    found: list[Index] = []
    for total in range(degree + 1):
        for factors in combinations_with_replacement(range(inputs), total):
            term = np.bincount(np.array(factors, dtype=np.int64), minlength=inputs).astype(np.int64)
            if np.count_nonzero(term) <= mixed and np.sum(term**flatness) <= degree**flatness + 1e-9:
                found.append(term)
                if len(found) > max(most, 1):
                    return None
    return np.array(found, dtype=np.int64)


def _patterns(known: Mask) -> list[tuple[Mask, Index]]:
    """Outputs that are known at the same points."""
    patterns, which = np.unique(known, axis=1, return_inverse=True)
    which = which.ravel()
    return [(patterns[:, k], np.flatnonzero(which == k)) for k in range(patterns.shape[1])]


def _values(x: Array, bounded: Mask, degree: int) -> Array:
    """Orthonormal polynomials (d, n, degree + 1) of each input."""
    orders = np.arange(degree + 1)
    hermite = np.polynomial.hermite_e.hermevander(x.T, degree) / np.sqrt(np.cumprod(np.maximum(orders, 1)))
    if not bounded.any():
        return np.asarray(hermite)
    legendre = np.polynomial.legendre.legvander(x.T, degree) * np.sqrt(2 * orders + 1)
    return np.where(bounded[:, None, None], legendre, hermite)


def _derivative(degree: int, bounded: bool) -> Array:
    """The matrix that gives the derivatives of the orthonormal polynomials in terms of themselves."""
    out = np.zeros((degree + 1, degree + 1))
    for k in range(1, degree + 1):
        if bounded:  # P_k' = sum of (2 j + 1) P_j over j = k - 1, k - 3, ...
            for j in range(k - 1, -1, -2):
                out[k, j] = np.sqrt((2 * k + 1) * (2 * j + 1))
        else:  # He_k' = k He_(k-1)
            out[k, k - 1] = np.sqrt(k)
    return out


def _columns(values: Array, terms: Index) -> Array:
    """The value of each term at each point (n, p)."""
    out = np.ones((values.shape[1], len(terms)))
    for value, orders in zip(values, terms.T, strict=True):
        here = np.flatnonzero(orders)
        out[:, here] *= value[:, orders[here]]
    return out


def _least_squares(columns: Array, y: Array) -> tuple[Array, Array]:
    """Coefficients (p, m) and the leave-one-out error (m,), infinite where the columns depend on each other."""
    q, r = np.linalg.qr(columns)
    pivots = np.abs(np.diag(r))
    left = 1 - np.einsum("ij,ij->i", q, q)  # 1 - h_ii of the hat matrix
    # a point that alone fixes a coefficient: nothing is known of its error
    if pivots.min() <= DEPENDENT * pivots.max() or left.min() <= DEPENDENT:
        return np.zeros((columns.shape[1], y.shape[1])), np.full(y.shape[1], np.inf)
    projected = q.T @ y
    error = (y - q @ projected) / left[:, None]
    # terms are chosen by this error, so that it must not favour many of them
    count, size = columns.shape
    few = count / max(count - size, 1) * (1 + np.sum(np.linalg.inv(r) ** 2))
    return np.linalg.solve(r, projected), np.sqrt(few * np.mean(error**2, axis=0))
