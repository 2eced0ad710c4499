"""The result of a curve: its points as arrays, its error bounds, its witness, and what is to be said of it."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from faying.case.case import Case
from faying.case.provenance import provenance
from faying.errors import NotConverged
from faying.joint.state import law_notes
from faying.joint.strength import pressure_notes
from faying.measured.ring_down import MeasuredBackbone
from faying.microslip.epmc import Epmc, EpmcCurve, EpmcPoint
from faying.microslip.slip_basis import SlipBasis
from faying.microslip.slip_cycle import nearest, static_cycle
from faying.notes import Note
from faying.result.backbone import Backbone, ErrorBounds, QuasiStaticCheck
from faying.study.keys.backbone import BackboneChoice
from faying.typing import Array

WITNESSES = 3  # amplitudes of the static cycle, from the last a factor 5 down each
APART = 5.0
STEPS = 16  # load steps from end to end
DIFFERS = 0.02  # damping of the static cycle against the curve's from which there is a note
TRIED = 3  # points at the end of the curve at which error bounds are looked for
NOTHING = 1e-7  # damping of slip below which it is rounding and no slip
NOTED = 0.05  # error bound of damping from which there is a note


@dataclass(frozen=True, kw_only=True)
class BackboneCurve:
    """A curve with all that it was made from; residuals: of each point, in energy."""

    case: Case
    choice: BackboneChoice
    load: float
    friction: tuple[float, ...]
    basis: SlipBasis
    epmc: Epmc
    line: EpmcCurve
    residuals: Sequence[float]
    node: int
    direction: Array
    rest_damping: float


def collected(curve: BackboneCurve) -> Backbone:
    """Return the curve as it is kept."""
    study, structure, line = curve.case.study, curve.case.structure, curve.line
    low = curve.choice.amplitude[0]
    first = next((k for k, p in enumerate(line.points) if p.level >= low * (1 - 1e-3)), len(line.points) - 1)
    points, residuals = line.points[first:], curve.residuals[first:]
    bounds, witness = error_bounds(curve, points), _quasi_static_check(curve, points)
    interfaces = [joint.interface for joint in structure.joints]
    row = curve.epmc.observer
    assert row is not None
    rates, shapes = curve.epmc.model.modes
    return Backbone(
        title=study.title,
        mode=curve.choice.mode,
        preload=curve.load,
        friction=curve.friction,
        harmonics=curve.choice.harmonics,
        linear_frequency=float(rates[curve.epmc.mode]) / (2 * np.pi),
        rest_damping=curve.rest_damping,
        shape_at=float(row @ shapes[:, curve.epmc.mode]),
        code=line.code,
        reason=line.reason,
        joints=tuple(joint.name for joint in structure.joints),
        bolts=tuple(bolt.name for bolt in study.bolts),
        basis_size=len(curve.epmc.model.mass),
        unknowns=structure.mesh.unknowns,
        at=structure.mesh.points[curve.node],
        direction=curve.direction,
        damping=np.array([p.damping for p in points]) + curve.rest_damping,
        residual=np.array(residuals),
        bolt_force=_bolt_forces(curve, points),
        points=np.concatenate([i.positions for i in interfaces]),
        weights=np.concatenate([i.weights for i in interfaces]),
        joint_of_point=np.concatenate([np.full(len(i.weights), k) for k, i in enumerate(interfaces)]),
        laws=tuple(joint.law.model.name for joint in structure.joints),
        witness=witness,
        bounds=replace(bounds, residual=float(max(residuals))),
        notes=tuple(_notes(curve, bounds, witness)),
        provenance=provenance(study),
        **_along(curve, points),
        **_measured_points(curve.choice.measured),
    )


def _measured_points(path: Path | None) -> dict[str, Any]:
    """The measured points of a file, as curves hold them; none without a file."""
    if path is None:
        return {}
    points = MeasuredBackbone.read(path)
    found = {f"measured_{name}": getattr(points, name) for name in ("acceleration", "frequency", "damping")}
    return {**found, "measured_source": path.name}


def _along(curve: BackboneCurve, points: Sequence[EpmcPoint]) -> dict[str, Any]:
    """What each point of the curve has."""
    weights = [joint.weights for joint in curve.epmc.model.joints]

    def per_joint(values: tuple[Array, ...], mean: bool) -> list[float]:
        return [float(w @ v) / (float(w.sum()) if mean else 1.0) for w, v in zip(weights, values, strict=True)]

    levels, rates = np.array([p.level for p in points]), np.array([p.frequency for p in points])
    return {
        "acceleration": levels,
        "displacement": levels / rates**2,
        "frequency": rates / (2 * np.pi),
        "modal_amplitude": np.array([p.amplitude for p in points]),
        "slipping": np.array([p.slipping for p in points]),
        "open": np.array([p.open for p in points]),
        "other_modes": np.array([p.other_modes for p in points]),
        "joint_slipping": np.array([per_joint(p.sliding, True) for p in points]),
        "joint_open": np.array([per_joint(p.opening, True) for p in points]),
        "energy": np.array([per_joint(p.dissipated, False) for p in points]),
        "slip_map": np.array([np.concatenate(p.sliding) for p in points]),
        "open_map": np.array([np.concatenate(p.opening) for p in points]),
    }


def _bolt_forces(curve: BackboneCurve, points: Sequence[EpmcPoint]) -> Array:
    """Amplitude of each bolt's force [N] (points, bolts): half of its range in a cycle."""
    rows = curve.case.structure.bolt_force_operator @ curve.basis.basis.vectors
    phase = np.linspace(0, 2 * np.pi, 64, endpoint=False)
    harmonics = range(1, curve.choice.harmonics + 1)
    waves = np.stack([wave(h * phase) for h in harmonics for wave in (np.cos, np.sin)])
    cycles = np.array([rows @ p.coordinates[1:].T @ waves for p in points])
    return np.asarray((cycles.max(axis=2) - cycles.min(axis=2)) / 2)


def error_bounds(curve: BackboneCurve, points: Sequence[EpmcPoint]) -> ErrorBounds:
    """What changes at the largest amplitude when the computation is made coarser, or at one before where that fails."""
    for last in points[: -TRIED - 1 : -1]:
        found = _bounds_at(curve.epmc, last)
        if np.isfinite(found.points_frequency):
            break
    return found


def _bounds_at(epmc: Epmc, last: EpmcPoint) -> ErrorBounds:
    def change(make: Callable[[], Epmc]) -> tuple[float, float]:
        try:
            other = make().solve(last.amplitude, [last])
        except NotConverged:
            return float("nan"), float("nan")
        damping = other.damping / last.damping - 1 if last.damping > NOTHING else float("nan")
        return other.frequency / last.frequency - 1, damping

    coarser: dict[str, Callable[[], Epmc]] = {
        "samples": lambda: replace(epmc, samples=epmc.samples // 2),
        "points": lambda: replace(epmc, model=epmc.model.halved()),
    }
    if epmc.harmonics > 1:
        coarser["harmonics"] = lambda: replace(epmc, harmonics=1)
    found: dict[str, float] = {}
    for name, make in coarser.items():
        found[f"{name}_frequency"], found[f"{name}_damping"] = change(make)
    return ErrorBounds(acceleration=last.level, **found)


def _quasi_static_check(curve: BackboneCurve, points: Sequence[EpmcPoint]) -> QuasiStaticCheck | None:
    levels = [p.level for p in points]
    wanted = [levels[-1] / APART**k for k in range(WITNESSES) if levels[-1] / APART**k >= levels[0]]
    rows = []
    for k in nearest(levels, wanted):
        p = points[k]
        try:
            found = static_cycle(curve.epmc.model, curve.epmc.mode, p.amplitude, steps=STEPS)
        except NotConverged:
            continue
        change = found.damping / p.damping - 1 if p.damping > NOTHING else float("nan")
        rows.append((p.amplitude, p.level, found, found.frequency / p.frequency - 1, change))
    if not rows:
        return None
    return QuasiStaticCheck(
        amplitude=np.array([row[0] for row in rows]),
        acceleration=np.array([row[1] for row in rows]),
        frequency=np.array([row[2].frequency for row in rows]) / (2 * np.pi),
        damping=np.array([row[2].damping for row in rows]) + curve.rest_damping,
        frequency_change=np.array([row[3] for row in rows]),
        damping_change=np.array([row[4] for row in rows]),
    )


def _notes(curve: BackboneCurve, bounds: ErrorBounds, witness: QuasiStaticCheck | None) -> list[Note]:
    case, line, load = curve.case, curve.line, curve.load
    preload = curve.basis.preload
    out = [note for note in case.notes if note.code != "no-loss"]  # the loss is that of slip here
    out += law_notes(case.structure, preload, load)
    out += pressure_notes(case.structure, preload.pressures, load)
    if line.code != "amplitude":
        end = f"the curve ends at {line.points[-1].level:.3g} m/s2 of {curve.choice.amplitude[1]:.3g}: {line.reason}"
        out.append(Note(code="backbone-ends", severity="limit", load=load, text=end))
    if witness is None:
        text = "the static cycle finds no equilibrium, so that the curve has no static comparison"
        out.append(Note(code="backbone-no-witness", load=load, text=text))
    else:
        out += _differences(curve, witness)
    for what, value in (
        ("harmonics 0 and 1 alone", bounds.harmonics_damping),
        ("half of the joints' points", bounds.points_damping),
        ("half of the instants of a cycle", bounds.samples_damping),
    ):
        if abs(value) > NOTED:
            text = f"at {bounds.acceleration:.4g} m/s2 {what} change the joints' damping by {value:+.0%}"
            out.append(Note(code="backbone-bound", severity="limit", load=load, text=text))
    if line.points[-1].damping <= NOTHING:
        text = (
            f"up to {line.points[-1].level:.3g} m/s2 slip damps mode {curve.choice.mode} by less than {NOTHING:g} of "
            "critical: its joints open and close rather than slip"
        )
        out.append(Note(code="backbone-no-slip", load=load, text=text))
    if curve.rest_damping == 0 and case.structure.predicts_loss:
        text = (
            "the damping is that of slip alone; the laws predict a loss at rest, too, which is left out so that slip "
            'does not count twice: rest_damping = "law" adds it'
        )
        out.append(Note(code="backbone-rest", load=load, text=text))
    return list(dict.fromkeys(out))


def _differences(curve: BackboneCurve, witness: QuasiStaticCheck) -> Iterator[Note]:
    """Say where the static cycle gives another damping, and what they do not share."""
    for level, change in zip(witness.acceleration, witness.damping_change, strict=True):
        if not abs(change) > DIFFERS:
            continue
        point = min(curve.line.points, key=lambda p: abs(np.log(p.level / level)))
        why = (
            f"at {level:.4g} m/s2 the static cycle has {change:+.1%} of the curve's damping from slip: it loads the "
            f"structure as the mode at rest moves, while other modes and harmonics make {point.other_modes:.1%} of the "
            f"motion and {point.slipping:.0%} of the joints' friction slides"
        )
        yield Note(code="backbone-witness", load=curve.load, text=why)
