"""Frequency response at points of a structure: receptance from complex modes and the static rest."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from faying.errors import InputError
from faying.fe.damped import DampedModes
from faying.fe.modes import Modes
from faying.typing import Array, Complex


@dataclass(frozen=True, kw_only=True)
class Response:
    """Receptance (frequency, output, input) [m/N] at frequencies [Hz], and the residual of the full equations.

    error (f,): at a few of the frequencies, `checked` [Hz], the force left unanswered, as displacement in the energy
    norm, over the answer's.
    """

    frequencies: Array
    receptance: Complex
    checked: Array
    error: Array

    def accelerance(self) -> Complex:
        """Acceleration per force [m/s2/N]."""
        omega = 2 * np.pi * self.frequencies[:, None, None]
        return -(omega**2) * self.receptance

    def mobility(self) -> Complex:
        """Velocity per force [m/s/N]."""
        return 2j * np.pi * self.frequencies[:, None, None] * self.receptance


def frequency_response(
    modes: Modes,
    damped: DampedModes,
    stiffness: Any,
    mass: Any,
    loss: Any,
    *,
    forces: Array,
    outputs: Array,
    frequencies: Array,
    rigid: int,
    kind: Literal["hysteretic", "viscous"] = "hysteretic",
    structural_loss: float = 0.0,
    parts: Any | None = None,
    checks: int = 5,
) -> Response:
    """Solve (K + i eta P + i C - w^2 M) u = f, or with i w C where kind is viscous, in a basis.

    forces (unknowns, i): unit forces; outputs (unknowns, o): what is read of u; frequencies [Hz] (f,);
    structural_loss: eta of the parts themselves, whose stiffness is P (parts; K where None). Basis: rigid motions, real and
    complex modes, and the response to the forces at the shift of the factorisation, so that modes beyond the last one count through their static part. Raises
    InputError for frequencies that do not rise from above 0.
    """
    from scipy.linalg import cholesky, solve_triangular

    frequencies = np.asarray(frequencies, dtype=float)
    if frequencies.ndim != 1 or not len(frequencies) or frequencies[0] <= 0 or np.any(np.diff(frequencies) <= 0):
        raise InputError("the frequencies of a response must be positive and rise, for example from 10 Hz to 5000 Hz")
    # without what the known modes answer, which is all but the last digits of it where a body is free
    rest = forces - (mass @ modes.shapes) @ (modes.shapes.T @ forces)
    static = modes.factorisation.solve(np.asfortranarray(rest))
    columns = np.concatenate([modes.shapes, damped.shapes.real, damped.shapes.imag, static], axis=1)
    basis = _orthonormal(columns, mass, leading=modes.shapes.shape[1])
    small_k, small_c = basis.T @ (stiffness @ basis), basis.T @ (loss @ basis)
    lossy = stiffness if parts is None else parts
    small_p = small_k if parts is None else basis.T @ (parts @ basis)
    for small in (small_k, small_p):
        small[:rigid] = small[:, :rigid] = 0.0
    small_m = basis.T @ (mass @ basis)
    push, read = basis.T @ forces, basis.T @ outputs
    root = cholesky(small_m)
    turn = solve_triangular(root, np.eye(len(root)))
    small_k, small_p, small_c = (turn.T @ small @ turn for small in (small_k, small_p, small_c))
    push, read = turn.T @ push, turn.T @ read
    answers = np.empty((len(frequencies), read.shape[1], push.shape[1]), dtype=complex)
    inner = np.empty((len(frequencies), len(small_k), push.shape[1]), dtype=complex)
    identity = np.eye(len(small_k))
    for i, omega in enumerate(2 * np.pi * frequencies):
        damping = omega * small_c if kind == "viscous" else small_c
        inner[i] = np.linalg.solve(
            small_k + 1j * (structural_loss * small_p + damping) - omega**2 * identity, push.astype(complex)
        )
        answers[i] = read.T @ inner[i]
    where = np.unique(np.linspace(0, len(frequencies) - 1, min(checks, len(frequencies))).astype(int))
    error = np.empty(len(where))
    basis = basis @ turn
    for j, i in enumerate(where):
        omega = 2 * np.pi * frequencies[i]
        u = basis @ inner[i]
        damping = omega if kind == "viscous" else 1.0
        absorbed = 1j * (structural_loss * (lossy @ u) + damping * (loss @ u))
        miss = forces - stiffness @ u - absorbed + omega**2 * (mass @ u)
        solved = [modes.factorisation.solve(np.asfortranarray(part)) for part in (miss.real, miss.imag)]
        left = np.sqrt(sum(abs(np.sum(part * s)) for part, s in zip((miss.real, miss.imag), solved, strict=True)))
        energy = np.sqrt(abs(np.vdot(u, stiffness @ u)) + modes.shift * abs(np.vdot(u, mass @ u)))
        error[j] = left / energy
    return Response(frequencies=frequencies, receptance=answers, checked=frequencies[where], error=error)


def _orthonormal(columns: Array, mass: Any, leading: int) -> Array:
    """The leading columns as they are (orthonormal with the mass), and what the others add to them."""
    basis = columns[:, :leading]
    rest = columns[:, leading:]
    rest = rest / np.sqrt(np.maximum(np.einsum("ij,ij->j", rest, mass @ rest), 1e-300))
    for _ in range(2):
        rest = rest - basis @ (basis.T @ (mass @ rest))
    values, rotation = np.linalg.eigh(rest.T @ (mass @ rest))
    keep = values > 1e-10
    return np.concatenate([basis, rest @ (rotation[:, keep] / np.sqrt(values[keep]))], axis=1)
