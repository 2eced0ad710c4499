"""From a preloaded structure and what shakes it to the levels of its modes, and what points, bolts and joints bear."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

import numpy as np

from faying.bolt.bolt import fatigue_area
from faying.bolt.fatigue import FatigueCurve, bending_modulus, dirlik, sweep_cycles
from faying.case.level_damping import assumed_words, assumes_friction, assumes_rest, frictions_of
from faying.case.scatter import Known
from faying.case.service_bolts import ServiceBolt, head_frictions
from faying.joint.bolted import BoltedStructure
from faying.joint.equilibrium import PreloadState
from faying.joint.modal import Vibration
from faying.joint.springs import Springs
from faying.notes import Note
from faying.result.fields import declared
from faying.result.groups import OuterStress
from faying.result.provenance import Provenance
from faying.result.vibration import VibrationResponse
from faying.service.curves import CurveSets, curve_sets
from faying.service.excited import Excited, twins_along
from faying.service.mode_curve import ModeCurve, greatest, resonance, rule, variance
from faying.study.vibration import Excitation
from faying.typing import Array, Complex

# of what is printed, 3 sigma or the amplitude: where margins are taken, and how far the curve of a mode is marched; one
# cycle of random vibration in 90 exceeds it
PEAKS = {"random": 3.0, "sine": 1.0}
STATES = {"random": {"1 sigma": 1.0, "3 sigma": 3.0}, "sine": {"amplitude": 1.0}}  # whose stress is recorded
ANGLES = 24  # round a bolt at which its stress is looked at: of a sine between two of them 0.2 % is missed
LINES, NEAR_LINES = 300, 12  # frequencies of a curve over the band, and on either side of each resonance
AROUND, SAMPLES = (0.05, 3.0), 15  # levels at which a mode's damping is drawn, over the one that it reaches
SWEPT = 2000  # frequencies of a sweep, and as many more near its resonances


@dataclass(frozen=True, kw_only=True)
class Shaken:
    """A structure at its preload, ready to be shaken.

    Args:
        title: What results call it.
        structure, preload, springs, found: The structure, its equilibrium, the springs of its joints, its modes.
        bolts: What friction and fatigue need of each bolt.
        provenance: What it was made from.
        parts_loss: Loss factor of the parts themselves [-].
        known: What scatters, by its key; of joints that it lists the friction.
    """

    title: str
    structure: BoltedStructure
    preload: PreloadState
    springs: Sequence[Springs[Any]]
    found: Vibration
    bolts: Sequence[ServiceBolt]
    provenance: Provenance
    parts_loss: float = 0.0
    known: Known = field(default_factory=dict)

    @property
    def forces(self) -> Array:
        """Force of each bolt under the preload [N] (b,)."""
        return np.array(self.preload.bolt_forces)

    @property
    def curves(self) -> list[FatigueCurve | None]:
        """The curve of fatigue of each bolt under its preload."""
        return [bolt.curve(force) for bolt, force in zip(self.bolts, self.forces.tolist(), strict=True)]


@dataclass(frozen=True, kw_only=True)
class _Answering:
    """What an answer needs beyond the curves: the structure under its excitation, and the stress of its bolts.

    stress: what axial force and two bending moments make of it round each bolt (b, angle, 3) [Pa/N, Pa/(N m)].
    """

    base: Shaken
    excited: Excited
    stress: Array
    lines: Array


def vibrate(base: Shaken, excitation: Excitation) -> VibrationResponse:
    """Answer one excitation with the intervals of friction and of damping at rest.

    Raises InputError where nothing holds the structure against it, or a face or a point is not there.
    """
    base = replace(base, found=twins_along(base.structure, base.found, excitation))
    excited = Excited.of(base.structure, base.springs, base.found, excitation)
    elastic = slice(excited.rigid, None)
    needs = [partial(_needed, excitation, float(abs(force))) for force in excited.force[elastic]]
    mu = frictions_of(base.structure, base.known)
    sets = curve_sets(base.structure, base.preload, base.found, needs, excited.greatest[elastic], mu, base.parts_loss)
    lines = _lines(excitation, sets.best)
    given = _Answering(base=base, excited=excited, stress=_stress(base.structure), lines=lines)
    answer = partial(_random if excitation.kind == "random" else _sine, given)
    best = answer(sets.best, mu[1])
    ends = [(answer(sets.at_rest(0), mu[1]), answer(sets.at_rest(2), mu[1]))]
    if sets.least is not None and sets.most is not None:
        ends.append((answer(sets.least, mu[0]), answer(sets.most, mu[2])))
    place, stress = best.pop("part_place"), best.pop("outer")
    return _record(given, sets, _with_ends(best, ends), place, stress)


def _needed(excitation: Excitation, force: float, curve: ModeCurve) -> float:
    """The amplitude of a mode's coordinate up to which its curve is wanted."""
    if excitation.kind == "random":
        found = curve.balance(partial(variance, excitation.table, force)).sigma
    else:
        speeds = _swept(excitation, [curve])
        found = float(np.abs(curve.forced(force * excitation.table.at(speeds / (2 * np.pi)), speeds)[0]).max())
    return PEAKS[excitation.kind] * found


def _swept(excitation: Excitation, curves: Sequence[ModeCurve]) -> Array:
    """Circular frequencies [rad/s] of a sweep: even in logarithms, finer where the modes softened or at rest are."""
    first, last = excitation.table.frequencies[[0, -1]]
    near = [_lines(excitation, curves)]
    for curve in curves:
        low = min(float(curve.speeds.min(initial=curve.speed)), curve.speed) / (2 * np.pi)
        most = curve.speed / (2 * np.pi)
        width = 1 + 10 * curve.rest
        near.append(np.geomspace(low / width, most * width, SWEPT // (4 * len(curves)) + 100))
    every = np.concatenate([np.geomspace(first, last, SWEPT), *near])
    return 2 * np.pi * np.unique(every[(every >= first) & (every <= last)])


def _lines(excitation: Excitation, curves: Sequence[ModeCurve]) -> Array:
    """Frequencies [Hz] at which densities and amplitudes are drawn: finer near the resonances."""
    first, last = excitation.table.frequencies[[0, -1]]
    away = np.geomspace(0.1, 30, NEAR_LINES)
    near = [curve.speed / (2 * np.pi) * (1 + curve.rest * np.concatenate([-away, [0.0], away])) for curve in curves]
    every = np.concatenate([np.geomspace(first, last, LINES), *near])
    return np.unique(every[(every >= first) & (every <= last)])


def _stress(structure: BoltedStructure) -> Array:
    """Stress round each bolt by axial force and two moments (b, angle, 3) [Pa/N, Pa/(N m)]; NaN without size."""
    turns = np.linspace(0, 2 * np.pi, ANGLES, endpoint=False)
    out = np.full((len(structure.bolts), ANGLES, 3), np.nan)
    for k, fitted in enumerate(structure.fitted_bolts):
        area = fatigue_area(fitted)
        if area > 0:  # NaN where it is not known
            around = np.stack([np.cos(turns), np.sin(turns)], axis=1) / bending_modulus(area)
            out[k] = np.concatenate([np.full((ANGLES, 1), 1 / area), around], axis=1)
    return out


def _random(given: _Answering, curves: Sequence[ModeCurve], friction: Array) -> dict[str, Array]:
    """What random vibration makes of the structure: rms values, and damage a second."""
    excited, table = given.excited, given.excited.excitation.table
    forces = np.abs(excited.force[excited.rigid :])
    levels = [c.balance(partial(variance, table, f)) for c, f in zip(curves, forces.tolist(), strict=True)]
    sigmas, speeds, dampings = np.array(levels).T
    frequencies, weights = rule(table, speeds, dampings)
    coordinates = _coordinates(excited, speeds, dampings, frequencies)
    density = weights * table.at(frequencies)

    def products(values: Complex) -> Array:
        """Covariances (..., k, k) of what has the amplitudes (..., k, n)."""
        return np.asarray(np.real((values * density) @ np.conj(np.swapaxes(values, -1, -2))))

    out = _borne(given, coordinates, 1.0, frequencies, friction, products)
    out |= {
        "frequency": speeds / (2 * np.pi),
        "damping": dampings,
        "level": sigmas * speeds**2 * excited.greatest[excited.rigid :],
    }
    stress = _stresses(given, coordinates, 1.0)
    powers = frequencies ** np.array([0, 1, 2, 4])[:, None]
    moments = np.einsum("...n,pn->...p", np.abs(stress) ** 2, powers * density)
    worst = np.argmax(np.nan_to_num(moments[..., 0]), axis=-1)[..., None]
    out["stress"] = np.sqrt(np.take_along_axis(moments[..., 0], worst, axis=-1)[..., 0]).max(axis=1)
    pairs = zip(given.base.curves, moments, strict=True)
    out["damage"] = np.array([_most_damage(curve, one.reshape(-1, 4)) for curve, one in pairs])
    full = np.concatenate([coordinates, np.ones((1, len(frequencies)))])
    out |= _part_stress(given, products(full))
    lines = _coordinates(excited, speeds, dampings, given.lines)
    along = _along(excited, lines, 1.0, given.lines)
    return out | {name: np.abs(one) ** 2 * table.at(given.lines) for name, one in along.items()}


def _part_stress(given: _Answering, products: Array) -> dict[str, Array]:
    """Stress of von Mises: the greatest in each part (p,) [Pa], its place (p, 3) [m], and at every node (n,)."""
    stress, points = given.excited.part_stress(products), given.base.structure.mesh.points
    every, worst = np.zeros(len(points)), []
    for one, values in zip(given.excited.stress.values(), stress, strict=True):
        worst.append(one.nodes[int(np.argmax(values))])
        every[one.nodes] = np.maximum(every[one.nodes], values)
    return {"part_stress": np.array([one.max() for one in stress]), "part_place": points[worst], "outer": every}


def _most_damage(curve: FatigueCurve | None, moments: Array) -> float:
    """Damage a second [1/s] at the angle and the end (k, 4) where it is greatest; NaN where it is not known."""
    if curve is None or np.isnan(moments).any():
        return float("nan")
    some = moments[np.argsort(moments[:, 0])[-ANGLES // 4 :]]  # the greatest variances, of which one has most damage
    return max(dirlik(curve, one) for one in some)


def _coordinates(excited: Excited, speeds: Array, dampings: Array, frequencies: Array) -> Complex:
    """Coordinates of all modes (m, n), rigid motions first, under a unit input of frequencies [Hz] (n,)."""
    none = np.zeros(excited.rigid)
    moved = resonance(np.concatenate([none, speeds]), np.concatenate([none, dampings]), frequencies)
    return np.asarray(excited.force[:, None] * moved)


def _sine(given: _Answering, curves: Sequence[ModeCurve], friction: Array) -> dict[str, Array]:
    """What a sweep makes of the structure: greatest amplitudes, and damage of one sweep."""
    excited = given.excited
    excitation = excited.excitation
    drive = np.unique(np.concatenate([_swept(excitation, curves), 2 * np.pi * given.lines]))
    frequencies = drive / (2 * np.pi)
    amplitude = excitation.table.at(frequencies)
    rigid = excited.force[: excited.rigid, None] * amplitude / -(drive**2)
    forced = [c.forced(abs(f) * amplitude, drive) for c, f in zip(curves, excited.force[excited.rigid :], strict=True)]
    signs = np.sign(excited.force[excited.rigid :])[:, None]
    elastic = signs * np.array([one for one, _ in forced])
    coordinates = np.concatenate([rigid, elastic]).astype(complex)

    def products(values: Complex) -> Array:
        """Products (..., k, k) of the amplitudes (..., k, n) at the frequency where the longest axis is greatest."""
        every = np.real(np.einsum("...in,...jn->...nij", values, np.conj(values)))
        worst = np.argmax(np.nan_to_num(greatest(every)), axis=-1)
        return np.take_along_axis(every, worst[..., None, None, None], axis=-3)[..., 0, :, :]

    out = _borne(given, coordinates, amplitude, frequencies, friction, products)
    peaks = np.abs(elastic).max(axis=1)
    at = [c.at(np.array(a)) for c, a in zip(curves, peaks, strict=True)]
    speeds, dampings = np.array([[float(w), float(z)] for w, z in at]).T
    out |= {
        "frequency": speeds / (2 * np.pi),
        "damping": dampings,
        "level": peaks * speeds**2 * excited.greatest[excited.rigid :],
        "jumps": np.array([float(jump.any()) for _, jump in forced]),
    }
    stress = np.abs(_stresses(given, coordinates, amplitude))
    out["stress"] = stress.max(axis=(1, 2, 3))
    pairs = zip(given.base.curves, stress, strict=True)
    out["damage"] = np.array(
        [_swept_damage(curve, one.reshape(-1, len(frequencies)), frequencies) for curve, one in pairs]
    )
    energy = np.sum(np.abs(excited.speeds[:, None] * coordinates) ** 2, axis=0)
    most = int(np.argmax(energy))  # where the most energy is
    full = np.append(coordinates[:, most], amplitude[most])
    out |= _part_stress(given, np.real(np.outer(full, full.conj())))
    along = _along(excited, coordinates, amplitude, frequencies)
    return out | {
        name: np.stack([np.interp(given.lines, frequencies, one) for one in np.abs(every)])
        for name, every in along.items()
    }


def _swept_damage(curve: FatigueCurve | None, stress: Array, frequencies: Array) -> float:
    """Damage of a sweep [-] at one octave a minute, at the worst place; stress: amplitudes (k, n) [Pa]."""
    if curve is None or np.isnan(stress).any():
        return float("nan")
    cycles, each = sweep_cycles(frequencies[:-1], frequencies[1:], 1.0), 1 / curve.cycles(stress)
    return float(((each[:, 1:] + each[:, :-1]) / 2 @ cycles).max())


def _along(excited: Excited, coordinates: Complex, amplitude: Array | float, frequencies: Array) -> dict[str, Complex]:
    """Absolute acceleration [m/s2] and displacement [m] of the points along the excitation (p, n)."""
    acceleration = _acceleration(excited, coordinates, amplitude, frequencies)
    both = {"curve": acceleration, "curve_motion": excited.transfer("motion", coordinates, amplitude)}
    along = excited.excitation.direction
    return {name: np.asarray(np.einsum("pin,i->pn", one, along)) for name, one in both.items()}


def _acceleration(excited: Excited, coordinates: Complex, amplitude: Array | float, frequencies: Array) -> Complex:
    """Absolute acceleration of the points [m/s2] (p, 3, n)."""
    moved = excited.transfer("motion", coordinates, amplitude)
    base = np.outer(excited.excitation.direction, amplitude) if excited.excitation.base else 0.0
    return np.asarray(base - (2 * np.pi * frequencies) ** 2 * moved)


def _stresses(given: _Answering, coordinates: Complex, amplitude: Array | float) -> Complex:
    """Stress round both ends of each bolt (b, end, angle, n) [Pa]."""
    axial = given.excited.transfer("axial", coordinates, amplitude)
    moments = given.excited.transfer("moments", coordinates, amplitude)
    bending = np.einsum("bai,bein->bean", given.stress[..., 1:], moments)
    return np.asarray(given.stress[:, None, :, :1] * axial[:, None, None] + bending)


def _borne(
    given: _Answering,
    coordinates: Complex,
    amplitude: Array | float,
    frequencies: Array,
    friction: Array,
    products: Callable[[Complex], Array],
) -> dict[str, Array]:
    """Motion of the points, forces of the bolts, and the margins of heads and joints.

    friction: coefficient of each joint (j,); products: of amplitudes (..., k, n) the (..., k, k) whose diagonal is the
    square of what is printed.
    """
    excited, base = given.excited, given.base
    peak = PEAKS[excited.excitation.kind]

    def each(values: Complex) -> Array:
        return np.sqrt(products(values[..., None, :])[..., 0, 0])

    motion = excited.transfer("motion", coordinates, amplitude)
    axial = each(excited.transfer("axial", coordinates, amplitude))
    across = _norms(products, excited.transfer("across", coordinates, amplitude))
    carried = excited.transfer("carried", coordinates, amplitude)
    normal, slip = each(carried[:, 0]), _norms(products, carried[:, 1:])
    mu = friction[[p.joint for p in excited.patches]]
    pressed = np.array([p.pressed.normal for p in excited.patches])
    left = np.maximum(base.forces - peak * axial, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        margin = mu * np.maximum(pressed - peak * normal, 0.0) / (peak * slip)
        head = peak * across / (head_frictions(base.bolts) * left)
    return {
        "acceleration": each(_acceleration(excited, coordinates, amplitude, frequencies)),
        "velocity": each(2j * np.pi * frequencies * motion),
        "displacement": each(motion),
        "bolt_force": axial,
        "bolt_moment": _norms(products, excited.transfer("moments", coordinates, amplitude)).max(axis=1),
        "bolt_shear": across,
        "head_motion": head,
        "margin": margin,
    }


def _norms(products: Callable[[Complex], Array], values: Complex) -> Array:
    """Of vectors (..., k, n), what is printed of their component along the worst direction (...); NaN stays."""
    known = np.asarray(~np.isnan(values).any(axis=(-1, -2)))
    found = greatest(products(np.where(known[..., None, None], values, 0.0)))
    return np.where(known, found, np.nan)


def _with_ends(
    best: Mapping[str, Array], ends: Sequence[tuple[Mapping[str, Array], Mapping[str, Array]]]
) -> dict[str, Array]:
    """Every quantity (3, ...): 5 %, best, 95 %. What is not known acts by factors, whose logarithms add in squares."""
    out = {}
    for name, middle in best.items():
        low = high = np.zeros_like(middle)
        known = np.isfinite(middle) & (middle > 0)
        for pair in ends:
            with np.errstate(divide="ignore", invalid="ignore"):
                moves = [np.where(known, np.log(one[name] / middle), 0.0) for one in pair]
            low = low + np.minimum(np.minimum(*moves), 0.0) ** 2
            high = high + np.maximum(np.maximum(*moves), 0.0) ** 2
        out[name] = np.stack([middle * np.exp(-np.sqrt(low)), middle, middle * np.exp(np.sqrt(high))])
    return out


def _record(
    given: _Answering, sets: CurveSets, found: Mapping[str, Array], place: Array, stress: Array
) -> VibrationResponse:
    """The answer; place: of the greatest stress of each part (p, 3) [m]; stress: at every node (n,) [Pa]."""
    base, excited, structure = given.base, given.excited, given.base.structure
    excitation, elastic = excited.excitation, slice(excited.rigid, None)
    times = excitation.duration if excitation.kind == "random" else 1 / excitation.rate if excitation.rate else None
    margins = np.full((2, 3, len(structure.joints)), np.nan)
    for k, patch in enumerate(excited.patches):
        if patch.bolt < 0:
            same = [n for n, other in enumerate(excited.patches) if other.joint == patch.joint]
            margins[:, :, patch.joint] = found["margin"][:, k], found["margin"][:, same].min(axis=1)
    reach = np.full(len(sets.best), np.nan)
    for k in sets.ended:
        curve = sets.best[k - 1]
        reach[k - 1] = curve.amplitudes.max(initial=0.0) * curve.speed**2 * excited.greatest[elastic][k - 1]
    levels, damping = _curves(given, sets.best, found)
    outer, states = structure.surface(), STATES[excitation.kind]
    recorded = declared(VibrationResponse).keys() - {"damage"}  # that of one second, or of one sweep
    return VibrationResponse(
        title=base.title,
        name=excitation.name,
        kind=excitation.kind,
        unit=excitation.unit,
        preload=float(base.forces[0]) if len(base.forces) else 0.0,
        base=int(excitation.base),
        times=float("nan") if times is None else float(times),
        bolts=tuple(bolt.name for bolt in structure.bolts),
        joints=tuple(joint.name for joint in structure.joints),
        parts=tuple(structure.mesh.parts),
        part_stress_place=place,
        surface=OuterStress.on(
            outer,
            structure.mesh.points,
            states=tuple(states),
            von_mises=np.outer(list(states.values()), stress[outer.nodes]),
        ),
        direction=np.array(excitation.direction),
        input_frequency=excitation.table.frequencies,
        input_value=excitation.table.values,
        rest_frequency=excited.speeds[elastic] / (2 * np.pi),
        rest_damping=sets.rest,
        share=excited.force[elastic] ** 2 / excited.mass if excitation.base else excited.force[elastic],
        points=structure.mesh.points[excited.nodes],
        line_frequency=given.lines,
        damage=found["damage"] * (np.nan if times is None else times),
        slide_motion=np.array([bolt.slide_motion(f) for bolt, f in zip(base.bolts, base.forces.tolist(), strict=True)]),
        slip_margin=margins[0],
        slip_margin_worst=margins[1],
        curve_level=levels,
        curve_damping=damping,
        reach=reach,
        notes=tuple(_notes(given, sets, found, reach)),
        provenance=base.provenance,
        **{name: values for name, values in found.items() if name in recorded},
    )


def _curves(given: _Answering, curves: Sequence[ModeCurve], found: Mapping[str, Array]) -> tuple[Array, Array]:
    """Level [m/s2] and damping ratio [-] of each mode (m, sample) about the level that it reaches."""
    speeds = 2 * np.pi * found["frequency"][1]
    scale = speeds**2 * given.excited.greatest[given.excited.rigid :]
    amplitudes = np.geomspace(*AROUND, SAMPLES) * (found["level"][1] / scale)[:, None]
    if given.excited.excitation.kind == "sine":
        at = np.array([c.at(row) for c, row in zip(curves, amplitudes, strict=True)])
        return amplitudes * at[:, 0] ** 2 * (scale / speeds**2)[:, None], at[:, 1]
    powers = 2 * (found["damping"][1] * speeds**3)[:, None] * amplitudes**2
    levels = np.array([[c.under(float(p)) for p in row] for c, row in zip(curves, powers, strict=True)])
    sigma, speed, damping = np.moveaxis(levels, -1, 0)
    return sigma * speed**2 * (scale / speeds**2)[:, None], damping


def _notes(given: _Answering, sets: CurveSets, found: Mapping[str, Array], reach: Array) -> Iterator[Note]:
    """What is assumed, what was left out, and where joints slide."""
    excitation, what = given.excited.excitation, f"vibration {given.excited.excitation.name!r}"
    last = float(excitation.table.frequencies[-1])
    modes = given.excited.speeds / (2 * np.pi)
    if last > modes[-1]:
        text = (
            f"{what} goes up to {last:g} Hz, and the modes that were found up to {modes[-1]:.5g} Hz: what is beyond "
            "answers as at rest; raise modes.count"
        )
        yield Note(code="vibration-band", severity="limit", text=text)
    level = found["level"][1]
    rms = " rms" if excitation.kind == "random" else ""
    for k in np.flatnonzero(PEAKS[excitation.kind] * level > reach).tolist():
        text = (
            f"{what}: mode {k + 1} reaches {level[k]:.3g} m/s2{rms}, its curve ends at {reach[k]:.3g} m/s2; beyond, no "
            "cycle of the mode alone is found, as its joints open or slide; frequency and damping stay as they are "
            "there, which may be far off"
        )
        yield Note(code="vibration-beyond", severity="wrong", text=text)
    if np.any(found.get("jumps", np.zeros(1)) > 0):
        text = f"{what}: at some frequencies a mode has several amplitudes, and a sweep jumps; the greatest counts"
        yield Note(code="vibration-jumps", text=text)
    rest = assumes_rest(given.base.structure, given.base.parts_loss)
    assumed = sets.least is not None and assumes_friction(given.base.structure, given.base.known)
    if words := assumed_words(friction=assumed, rest=rest):
        yield Note(code="level-damping", severity="limit", text=f"damping in service assumes {' and '.join(words)}")
    if given.base.structure.joints:
        text = (
            "each mode has the damping of its own level; where two modes that shake one joint are strong together, the "
            "joint slips more than either alone makes it"
        )
        yield Note(code="vibration-alone", text=text)
