"""Modes out of FRFs without a hand on the mouse: poles, the rule for the stable ones, residues, intervals."""

from dataclasses import dataclass, replace

import numpy as np

from faying.errors import InputError
from faying.measured.frf import FRF, Dof
from faying.measured.lsfd import refine, residues
from faying.measured.modes import ModeSet
from faying.measured.poles import Poles, Rule, poles_by_order, tracks
from faying.misuse import checked_call
from faying.style import Summary
from faying.text import listed
from faying.typing import Array, Complex, Mask

ALTERNATIONS = 200  # of least squares; what is joined by a chain of pairs takes one for each, noise some ten more
UNWEIGHED = "the coherence is read and not used: all spectral lines count alike"
TURNED = (
    "the poles of the FRFs grow in time, and those of their complex conjugates decay: they are written with "
    "exp(-i w t), and their conjugates are taken"
)


@dataclass(frozen=True, kw_only=True, repr=False)
class Identified(Summary):
    """Modes of a test and what they rest on.

    modes; poles: all of the stabilisation diagram; frf: the FRFs used; fit (n, f): what modes and residuals make of the
    measured pairs; misfit [-]: rms of what the fit leaves over rms of the FRFs; rule;
    turned: whether `frf` has the complex conjugates of what was measured.
    """

    modes: ModeSet
    poles: Poles
    frf: FRF
    fit: Complex
    misfit: float
    rule: Rule
    turned: bool = False

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, the first modes, and what the fit leaves."""
        heading, rows = self.modes.summary()
        first = dict(list(rows.items())[:9])
        return f"{heading}, by {self.frf.quantity}", first | {"fit leaves": f"{self.misfit:.2%} of the FRFs' rms"}


@checked_call
def identify_modes(
    frf: FRF, *, band: tuple[float, float] | None = None, rule: Rule | None = None, refined: bool = True
) -> Identified:
    """Identify the modes of a test from its FRFs, with 95 % intervals.

    The poles of each mode are the medians over its track in the stabilisation diagram; then poles and residues are
    moved together to the best fit. Intervals take the wider of twice the scatter over the track and twice the standard
    error of that fit, and reach at least to the median, so that they show where the two estimates differ.

    FRFs written with exp(-i w t) have no pole that decays; their complex conjugates are then taken, and a warning of
    the result's `frf` says so.

    Args:
        frf: the measured functions, at evenly spaced spectral lines.
        band: lowest and highest frequency [Hz] to use (default: all lines above 0 Hz).
        rule: what makes a pole stable (default: `Rule.fitting`).
        refined: do the last fit; without it the medians stand.

    Returns:
        Identified: the modes, all poles, and the fit. Shapes are those of the outputs, or of the inputs where there are
        more of them (a roving hammer; reciprocity).

    Raises:
        InputError: where no mode is found, or the spectral lines are too few or uneven.

    Source:
        Guillaume et al. 2003 (LSCF poles); Golub and Pereyra 1973, doi:10.1137/0710036 (the fit).
    """
    low, high = band or (0.0, np.inf)
    used = frf.band(max(low, np.nextafter(0, 1)), high)
    if used.coherence is not None:
        used = replace(used, warnings=(*used.warnings, UNWEIGHED))
    rule = rule or Rule.fitting(len(used.frequency))
    diagram, found = tracks(used, poles_by_order(used, rule.highest_order), rule)
    turned = not found
    if turned:  # in the other sign of time every pole grows, and none is stable
        used = replace(used, values=used.values.conj(), warnings=(*used.warnings, TURNED))
        diagram, found = tracks(used, poles_by_order(used, rule.highest_order), rule)
    if not found:
        raise InputError(
            f"no pole stays over {rule.orders} of {rule.highest_order} orders between {used.frequency[0]:g} and "
            f"{used.frequency[-1]:g} Hz; loosen the rule (fewer orders, wider tolerances), raise the highest order, or "
            "look at the stabilisation diagram"
        )
    poles, f_interval, z_interval, note = _fitted(used, found, rule.frequency if refined else None)
    constants, fit = residues(poles, used.frequency, used.rows(), used.quantity)
    # an exponential window moves every pole left by its decay
    z_interval = z_interval - (used.window_decay / np.abs(poles))[:, None]
    poles = poles + used.window_decay
    frequencies, damping = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    shapes, dofs, unjoined = _shapes(used, constants)
    used = replace(used, warnings=(*used.warnings, *unjoined))
    modes = ModeSet(
        frequencies=frequencies,
        loss_factors=2 * damping,
        shapes=shapes,
        dofs=dofs,
        positions=frf.positions,
        frequency_interval=f_interval,
        loss_interval=2 * np.maximum(z_interval, 0),
        found_in=np.array([len(track) for track in found], dtype=np.int64),
        notes=tuple(note + _narrow(used, f, z) for f, z in zip(frequencies, damping, strict=True)),
        source=frf.source,
    )
    misfit = float(np.linalg.norm(used.rows() - fit) / np.linalg.norm(used.rows()))
    return Identified(modes=modes, poles=diagram, frf=used, fit=fit, misfit=misfit, rule=rule, turned=turned)


def _fitted(frf: FRF, found: list[Complex], search: float | None) -> tuple[Complex, Array, Array, tuple[str, ...]]:
    """Poles of the tracks, moved to the best fit unless `search` is None; intervals of frequency and damping ratio;
    notes that hold for every mode."""
    frequencies = np.array([np.median(np.abs(track)) for track in found]) / (2 * np.pi)
    damping = np.array([np.median(-track.real / np.abs(track)) for track in found])
    f_spread = np.array([np.std(np.abs(track)) for track in found]) / np.pi  # 2 standard deviations
    z_spread = 2 * np.array([np.std(-track.real / np.abs(track)) for track in found])
    poles = 2 * np.pi * frequencies * (-damping + 1j * np.sqrt(1 - damping**2))
    notes: tuple[str, ...] = ()
    if search is not None:
        better = refine(poles, frf.frequency, frf.rows(), frf.quantity, search=search)
        if better.converged:
            poles = better.poles
            f_spread = np.maximum(f_spread, 2 * better.frequency_error)
            z_spread = np.maximum(z_spread, 2 * better.damping_error)
        else:
            notes = ("the fit of poles and residues together did not converge; the value is the median over orders",)
    f_now, z_now = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    return poles, _interval(f_now, f_spread, frequencies), _interval(z_now, z_spread, damping), notes


def _narrow(frf: FRF, frequency: float, damping: float) -> tuple[str, ...]:
    """Notes on a mode whose damping the spectral lines hardly show."""
    step = float(np.median(np.diff(frf.frequency)))
    out = []
    if 2 * damping * frequency < step:
        out.append(
            f"the resonance is narrower than the {step:g} Hz between spectral lines: its damping rests on few of them"
        )
    if damping <= 0:
        out.append("no damping is left after the decay of the window is taken off")
    return tuple(out)


def _interval(value: Array, spread: Array, other: Array) -> Array:
    """Value with its spread to both sides, at least as far as the other estimate (m, 2)."""
    return np.stack([np.minimum(value - spread, other), np.maximum(value + spread, other)], axis=1)


def _shapes(frf: FRF, constants: Complex) -> tuple[Complex, tuple[Dof, ...], tuple[str, ...]]:
    """Shapes (m, d) scaled to 1 at their largest component, from residue matrices of rank one; what is left out.

    No shape joins outputs that have no input in common, nor are joined by others: those of most pairs are taken.
    """
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    matrix = np.full((len(constants), len(frf.outputs), len(frf.inputs)), np.nan + 0j)
    for n, (o, i) in enumerate(frf.measured):
        matrix[:, o, i] = constants[:, n]
    dofs = frf.outputs
    if len(frf.inputs) > len(frf.outputs):
        matrix, dofs = matrix.transpose(0, 2, 1), frf.inputs
    known = np.isfinite(matrix[0])
    joined = connected_components(csr_array(known.astype(int) @ known.T.astype(int)))[1]
    kept = joined == np.bincount(joined, weights=known.sum(axis=1)).argmax()
    shapes = np.array([_of_rank_one(m) for m in matrix[:, kept]])
    peak = shapes[np.arange(len(shapes)), np.abs(shapes).argmax(axis=1)]
    apart = [str(dof) for dof, keep in zip(dofs, kept, strict=True) if not keep]
    note = f"shapes are without {listed(apart, 8)}: no FRFs join them to the others; measure all from one point"
    return shapes / peak[:, None], tuple(dof for dof in dofs if str(dof) not in apart), (note,) if apart else ()


def _of_rank_one(matrix: Complex) -> Complex:
    """The vector u (d,) of the matrix u v of rank one that is nearest to one (d, i) with NaN where it is not known."""
    known = np.isfinite(matrix)
    filled = np.where(known, matrix, 0.0)
    if known.all():
        return np.asarray(np.linalg.svd(filled, full_matrices=False)[0][:, 0])
    u = filled[:, known.sum(axis=0).argmax()]
    for _ in range(ALTERNATIONS):
        v = _share(filled.T, known.T, u)
        u = _share(filled, known, v / np.abs(v).max())
    return u


def _share(matrix: Complex, known: Mask, by: Complex) -> Complex:
    """Factors (d,) that make least squares of matrix (d, i) - factor by (i,) where it is known."""
    squares = known @ np.abs(by) ** 2
    return np.asarray(np.divide(matrix @ by.conj(), squares, out=np.zeros(len(matrix), complex), where=squares > 0))
