"""Residues for given poles, and poles refined: least squares in the frequency domain."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.measured.frf import QUANTITIES
from faying.typing import Array, Complex


def basis(poles: Complex, frequency: Array, quantity: str) -> Complex:
    """Functions of frequency that an FRF is made of, with real coefficients (f, 2 m + 2).

    Receptance: sum of A/(i w - s) + A*/(i w - s*) - L/w2 + U (Heylen, Lammens and Sas, Modal Analysis Theory and
    Testing, KU Leuven 1997, section A.3): real and imaginary part of each residue A, then the lower residual L [1/kg],
    the inertia of what lies below, and the upper one U [m/N], the compliance of what lies above. Other quantities carry
    factors i w.
    """
    iw = 2j * np.pi * frequency[:, None]
    one, other = 1 / (iw - poles), 1 / (iw - poles.conj())
    columns = [one + other, 1j * (one - other), 1 / iw**2, np.ones_like(iw)]
    return np.asarray(np.concatenate(columns, axis=1) * iw ** QUANTITIES[quantity])


def residues(poles: Complex, frequency: Array, rows: Complex, quantity: str) -> tuple[Complex, Complex]:
    """Residues (m, n) of FRFs `rows` (n, f) for poles [rad/s] (m,) with positive imaginary part, and the fit (n, f)."""
    b = basis(poles, frequency, quantity)
    stacked, target = _stack(b), _stack(rows.T)
    size = np.linalg.norm(stacked, axis=0)
    found = np.linalg.lstsq(stacked / size, target, rcond=None)[0] / size[:, None]
    m = len(poles)
    return found[:m] + 1j * found[m : 2 * m], (b @ found).T


def compressed(rows: Complex, rank: int) -> Complex:
    """Turn the rows (n, f) into at most `rank` rows that hold their strongest parts; residues keep lengths and angles.

    A real rotation of the pairs, by singular values: m modes and two residuals fill 2 m + 2 of them, what is cut is
    noise.
    """
    if len(rows) <= rank:
        return rows
    turn = np.linalg.svd(_stack(rows.T), full_matrices=False)[2][:rank]
    return np.asarray(turn @ rows)


def _stack(values: Complex) -> Array:
    return np.concatenate([values.real, values.imag])


@dataclass(frozen=True, kw_only=True)
class Refined:
    """Poles [rad/s] (m,), standard errors of their frequencies [Hz] and damping ratios [-] (m,), and convergence."""

    poles: Complex
    frequency_error: Array
    damping_error: Array
    converged: bool


def refine(poles: Complex, frequency: Array, rows: Complex, quantity: str, *, search: float = 0.01) -> Refined:
    """Move the poles to where residues and poles together fit the FRFs best, each by at most `search` in frequency.

    Variable projection (Golub and Pereyra 1973, doi:10.1137/0710036): at every step the residues are the linear
    solution, only frequencies and damping ratios are sought. Standard errors from the Jacobian and the residual, as if
    the errors of the spectral lines were independent and alike. Unlike the linear estimators it has no bias from noise
    in the FRFs.
    """
    from scipy.optimize import least_squares

    m = len(poles)
    f0, z0 = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    target = _stack(compressed(rows, 2 * m + 2).T)
    scale = float(np.sqrt(np.mean(target**2)))

    def miss(x: Array) -> Array:
        stacked = _stack(basis(_pole(f0 * (1 + x[:m] * z0), z0 * np.exp(x[m:])), frequency, quantity))
        q, _ = np.linalg.qr(stacked / np.linalg.norm(stacked, axis=0))
        return np.asarray(((target - q @ (q.T @ target)) / scale).ravel())

    bound = np.concatenate([np.minimum(search / z0, 30.0), np.full(m, np.log(10.0))])
    found: Any = least_squares(miss, np.zeros(2 * m), bounds=(-bound, bound), method="trf", xtol=1e-8, ftol=1e-10)
    x = found.x
    f, z = f0 * (1 + x[:m] * z0), z0 * np.exp(x[m:])
    unknowns = 2 * m + (2 * m + 2) * target.shape[1]
    variance = 2 * found.cost / max(target.size - unknowns, 1)
    spread = np.sqrt(np.maximum(np.diag(np.linalg.pinv(found.jac.T @ found.jac)) * variance, 0))
    return Refined(
        poles=_pole(f, z),
        frequency_error=f0 * z0 * spread[:m],
        damping_error=z * spread[m:],
        converged=bool(found.success and np.all(np.abs(x) < 0.99 * bound)),
    )


def _pole(frequency: Array, damping: Array) -> Complex:
    return np.asarray(2 * np.pi * frequency * (-damping + 1j * np.sqrt(1 - np.minimum(damping, 0.999) ** 2)))
