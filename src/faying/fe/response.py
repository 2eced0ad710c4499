"""Frequency response at points of a structure: receptance from complex modes and the static rest."""

from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from faying.errors import InputError
from faying.memory import require
from faying.numerics.damped import DampedModes
from faying.numerics.modes import Modes
from faying.numerics.solve import conjugate_gradients
from faying.numerics.span import extension
from faying.typing import Array, Complex

MIN_NEW_SHARE = 1e-10  # of the square of a vector of the basis that must be new
STATIC = 1e-8  # accuracy of the response at the shift


@dataclass(frozen=True, kw_only=True)
class FrequencyResponse:
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


@dataclass(frozen=True, kw_only=True)
class ForcedVibration:
    """The equations (K + i eta P + i C - w^2 M) u = f, or with i w C where kind is viscous.

    stiffness K [N/m], mass M [kg], loss C [N/m or N s/m], sparse; rigid: how many of the lowest modes are rigid
    motions; structural_loss: eta [-] of the parts themselves, whose stiffness is P (parts; K where None).
    """

    stiffness: Any
    mass: Any
    loss: Any
    rigid: int
    kind: Literal["hysteretic", "viscous"] = "hysteretic"
    structural_loss: float = 0.0
    parts: Any | None = None

    def dynamic_stiffness(self, omega: float, K: Any, P: Any, C: Any, M: Any) -> Any:
        """The matrix of the equations at an angular frequency [1/s], of full or projected matrices, or products."""
        damping = omega * C if self.kind == "viscous" else C
        return K + 1j * (self.structural_loss * P + damping) - omega**2 * M


def frequency_response(
    vibration: ForcedVibration,
    modes: Modes,
    damped: DampedModes,
    *,
    forces: Array,
    outputs: Array,
    frequencies: Array,
    checks: int = 5,
) -> FrequencyResponse:
    """Solve the equations of a vibration in a basis.

    forces (unknowns, i): unit forces; outputs (unknowns, o): what is read of u; frequencies [Hz] (f,). Basis: rigid
    motions, real and complex modes, and the response to the forces at the shift of the factorisation, so that modes
    beyond the last one count through their static part. Raises InputError for frequencies that do not rise above 0.
    """
    frequencies = np.asarray(frequencies, dtype=float)
    if frequencies.ndim != 1 or not len(frequencies) or frequencies[0] <= 0 or np.any(np.diff(frequencies) <= 0):
        raise InputError("the frequencies of a response must be positive and rise, for example from 10 Hz to 5000 Hz")
    count = modes.shapes.shape[1] + 2 * damped.shapes.shape[1] + forces.shape[1]
    require(
        2 * 16.0 * len(frequencies) * (count + outputs.shape[1]) * forces.shape[1],
        f"responses at {len(frequencies):,} frequencies, {outputs.shape[1]} outputs and {forces.shape[1]} inputs",
        "ask for fewer frequencies",
    )
    mass = vibration.mass
    # without what the known modes answer, which is all but the last digits of it where a body is free
    momentum = mass @ modes.shapes
    rest = forces - momentum @ (modes.shapes.T @ forces)
    static = conjugate_gradients(
        lambda x: vibration.stiffness @ x + modes.shift * (mass @ x), modes.factorisation, rest, accuracy=STATIC
    )
    columns = np.concatenate([damped.shapes.real, damped.shapes.imag, static], axis=1)
    columns /= np.sqrt(np.maximum(np.einsum("ij,ij->j", columns, mass @ columns), 1e-300))  # no motion stays none
    added, _ = extension(columns, modes.shapes, momentum, mass, least=MIN_NEW_SHARE)
    small, basis = _projected(vibration, np.concatenate([modes.shapes, added], axis=1))
    push, read = basis.T @ forces, basis.T @ outputs
    inner = np.empty((len(frequencies), basis.shape[1], push.shape[1]), dtype=complex)
    for i, omega in enumerate(2 * np.pi * frequencies):
        inner[i] = np.linalg.solve(vibration.dynamic_stiffness(omega, *small), push.astype(complex))
    where = np.unique(np.linspace(0, len(frequencies) - 1, min(checks, len(frequencies))).astype(int))
    error = [_error(vibration, modes, forces, basis @ inner[i], 2 * np.pi * frequencies[i]) for i in where]
    return FrequencyResponse(
        frequencies=frequencies,
        receptance=np.asarray(read.T @ inner, dtype=complex),
        checked=frequencies[where],
        error=np.array(error),
    )


def _projected(vibration: ForcedVibration, basis: Array) -> tuple[tuple[Array, ...], Array]:
    """K, P, C, M in a basis that is orthonormal with the projected mass, and that basis."""
    from scipy.linalg import cholesky, solve_triangular

    K, C = (basis.T @ (matrix @ basis) for matrix in (vibration.stiffness, vibration.loss))
    P = K.copy() if vibration.parts is None else basis.T @ (vibration.parts @ basis)
    for small in (K, P):
        small[: vibration.rigid] = small[:, : vibration.rigid] = 0.0
    root = cholesky(basis.T @ (vibration.mass @ basis))
    turn = solve_triangular(root, np.eye(len(root)))
    return (*(turn.T @ small @ turn for small in (K, P, C)), np.eye(len(root))), basis @ turn


def _error(vibration: ForcedVibration, modes: Modes, forces: Array, u: Complex, omega: float) -> float:
    """The force left unanswered at an angular frequency, as displacement in the energy norm, over the answer's."""
    parts = vibration.stiffness if vibration.parts is None else vibration.parts
    products = [matrix @ u for matrix in (vibration.stiffness, parts, vibration.loss, vibration.mass)]
    miss = forces - vibration.dynamic_stiffness(omega, *products)
    left = sum(
        abs(np.sum(part * modes.factorisation.solve(np.asfortranarray(part)))) for part in (miss.real, miss.imag)
    )
    energy = abs(np.vdot(u, products[0])) + modes.shift * abs(np.vdot(u, products[3]))
    return float(np.sqrt(left / energy))
