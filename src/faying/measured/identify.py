"""Modes out of FRFs without a hand on the mouse: poles, the rule for the stable ones, residues, intervals."""

from dataclasses import dataclass

import numpy as np

from faying.errors import InputError
from faying.measured.frf import FRF, Dof
from faying.measured.lsfd import refine, residues
from faying.measured.modes import ModeSet
from faying.measured.poles import Poles, Rule, poles_by_order, tracks
from faying.typing import Array, Complex


@dataclass(frozen=True, kw_only=True)
class Identified:
    """Modes of a test and what they rest on.

    modes; poles: all of the stabilisation diagram; frf: the FRFs used; fit (n, f): what modes and residuals make of the
    measured pairs; residues (m, n) of receptance; misfit [-]: rms of what the fit leaves over rms of the FRFs; rule.
    """

    modes: ModeSet
    poles: Poles
    frf: FRF
    fit: Complex
    residues: Complex
    misfit: float
    rule: Rule


def identify_modes(
    frf: FRF, *, band: tuple[float, float] | None = None, rule: Rule | None = None, refined: bool = True
) -> Identified:
    """Identify the modes of a test in `band` [Hz] (default: all lines above 0 Hz) by the rule (default: Rule.fitting).

    The poles of each mode are the medians over its track; then, unless refined=False, poles and residues are moved together
    to the best fit. Intervals (95 %) take the wider of twice the scatter over the track and twice the standard error of that
    fit, and reach at least to the median, so that they tell where the two estimates part. Shapes are those of the outputs, or of the inputs where there are more of them (a roving hammer; reciprocity).
    Raises InputError where no mode is found.
    """
    low, high = band or (0.0, np.inf)
    used = frf.band(max(low, np.nextafter(0, 1)), high)
    rule = rule or Rule.fitting(len(used.frequency))
    diagram, found = tracks(used, poles_by_order(used, rule.highest_order), rule)
    if not found:
        raise InputError(
            f"no pole stays over {rule.orders} of {rule.highest_order} orders between {used.frequency[0]:g} and "
            f"{used.frequency[-1]:g} Hz; loosen the rule (fewer orders, wider tolerances), raise the highest order, or look at "
            "the stabilisation diagram"
        )
    frequencies = np.array([np.median(np.abs(track)) for track in found]) / (2 * np.pi)
    damping = np.array([np.median(-track.real / np.abs(track)) for track in found])
    f_spread = np.array([np.std(np.abs(track)) for track in found]) / np.pi  # 2 standard deviations
    z_spread = 2 * np.array([np.std(-track.real / np.abs(track)) for track in found])
    poles = 2 * np.pi * frequencies * (-damping + 1j * np.sqrt(1 - damping**2))
    rows = used.rows()
    medians = (frequencies, damping)
    notes: list[list[str]] = [[] for _ in found]
    if refined:
        better = refine(poles, used.frequency, rows, used.quantity, reach=rule.frequency)
        if better.converged:
            poles = better.poles
            f_spread = np.maximum(f_spread, 2 * better.frequency_error)
            z_spread = np.maximum(z_spread, 2 * better.damping_error)
        else:
            for note in notes:
                note.append(
                    "the fit of poles and residues together did not come to rest; the value is the median over orders"
                )
    f_now, z_now = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    f_interval = _interval(f_now, f_spread, medians[0])
    z_interval = _interval(z_now, z_spread, medians[1])
    constants, fit = residues(poles, used.frequency, rows, used.quantity)
    # an exponential window moves every pole left by its decay
    z_interval = z_interval - (used.window_decay / np.abs(poles))[:, None]
    poles = poles + used.window_decay
    frequencies, damping = np.abs(poles) / (2 * np.pi), -poles.real / np.abs(poles)
    step = float(np.median(np.diff(used.frequency)))
    for k, note in enumerate(notes):
        if 2 * damping[k] * frequencies[k] < step:
            note.append(f"the resonance is narrower than the {step:g} Hz between lines: its damping rests on few lines")
        if damping[k] <= 0:
            note.append("no damping is left after the decay of the window is taken off")
    shapes, dofs = _shapes(used, constants)
    modes = ModeSet(
        frequencies=frequencies,
        loss_factors=2 * damping,
        shapes=shapes,
        dofs=dofs,
        positions=frf.positions,
        frequency_interval=f_interval,
        loss_interval=2 * np.maximum(z_interval, 0),
        found_in=np.array([len(track) for track in found], dtype=np.int64),
        notes=tuple(tuple(note) for note in notes),
        source=frf.source,
    )
    misfit = float(np.linalg.norm(rows - fit) / np.linalg.norm(rows))
    return Identified(modes=modes, poles=diagram, frf=used, fit=fit, residues=constants, misfit=misfit, rule=rule)


def _interval(value: Array, spread: Array, other: Array) -> Array:
    """Value with its spread to both sides, at least as far as the other estimate (m, 2)."""
    return np.stack([np.minimum(value - spread, other), np.maximum(value + spread, other)], axis=1)


def _shapes(frf: FRF, constants: Complex) -> tuple[Complex, tuple[Dof, ...]]:
    """Shapes (m, d) scaled to 1 at their largest component, from residue matrices of rank one."""
    matrix = np.zeros((len(constants), len(frf.outputs), len(frf.inputs)), complex)
    for n, (o, i) in enumerate(frf.measured):
        matrix[:, o, i] = constants[:, n]
    rove = len(frf.inputs) > len(frf.outputs)
    if rove:
        matrix = matrix.transpose(0, 2, 1)
    shapes = np.array([np.linalg.svd(m, full_matrices=False)[0][:, 0] for m in matrix])
    peak = shapes[np.arange(len(shapes)), np.abs(shapes).argmax(axis=1)]
    return shapes / peak[:, None], frf.inputs if rove else frf.outputs
