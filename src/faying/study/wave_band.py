"""What waves of the faces do to the frequencies: a few draws of waves that nobody has measured, in a small basis."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from faying.errors import FayingError
from faying.joint.face_axes import FaceAxes
from faying.joint.form import Form
from faying.joint.machining import ASSUMED, ASSUMED_GAP
from faying.joint.reduce import Reduction
from faying.joint.solid_bolt import SolidBolt
from faying.joint.together import Gapped, evaluate, train_together
from faying.joint.waviness import LaidWaves
from faying.notes import Note
from faying.result.result import preload_slope
from faying.study.case import Case
from faying.study.solve import LoadedCase
from faying.typing import Array
from faying.units import show

DRAWS = 4
TOLERANCE = 2e-4  # of a frequency, where draws differ by a thousandth and more


@dataclass(frozen=True, kw_only=True)
class WaveBand:
    """Frequencies under several draws of waves.

    seeds: of the d draws. frequencies [Hz] (d, loads, m); rms [m] (joints,): of the waves on each face; ends [m]
    (joints, 2): shortest and longest wave that is drawn; NaN where a joint has none.
    """

    seeds: tuple[int, ...]
    frequencies: Array
    rms: Array
    ends: Array

    def fields(self, loads: Array) -> dict[str, Any]:
        """Fields of the result; loads: preloads of the first bolt [N]."""
        slopes = None
        if len(loads) > 1:
            slopes = np.stack([preload_slope(values, loads) for values in self.frequencies])
        return {
            "wave_seeds": np.array(self.seeds),
            "wave_frequencies": self.frequencies,
            "wave_slopes": slopes,
            "wave_rms": self.rms,
            "wave_lengths": self.ends,
        }


@dataclass(frozen=True, kw_only=True)
class _Wavy:
    """A joint on which waves are drawn: its gap without waves (q,) [m], and the waves, whose seed varies."""

    positions: Array
    weights: Array
    base: Array
    axes: FaceAxes
    laid: LaidWaves

    def gap(self, seed: int) -> Array:
        waves = replace(self.laid, waves=replace(self.laid.waves, seed=seed))
        return self.base + waves.gap(self.positions, self.axes, self.weights)


def wave_band(case: Case, states: Sequence[LoadedCase]) -> tuple[WaveBand | None, list[Note]]:
    """Take the frequencies with a few draws of waves on the faces, at no full solution.

    Where a joint says nothing of its form, the waves are those that are assumed of machined faces. A form that is given
    stays as it is, its waves with the draw that its seed names; so do the seats of solid bolts, and faces that are
    curved or have no room for waves. Nothing where no joint has waves, or where a sweep has no answer either: bolts
    tightened in order, viscous dampers, springs per node.
    """
    study, structure = case.study, case.structure
    apart = study.order is not None or study.modes.damping == "viscous" or any(j.per_node for j in structure.joints)
    wavy = [] if apart else _wavy(case)
    if not any(wavy):
        return None, []
    seeds = range(DRAWS)
    last = states[-1]
    reduction = Reduction.about(
        structure,
        factor=last.modes.factorisation,
        reference=(last.modes.factorised + last.modes.shift * structure.vibrating[1]).tocsr(),
        state=last.preload.displacement,
        shapes=last.modes.shapes[:, case.rigid_count :],
        count=study.modes.count,
    )
    try:
        rows = _frequencies(case, reduction, wavy, seeds)
    except FayingError as fault:
        return None, [Note(code="wave-band", text=f"no answer with waves on the faces: {fault}")]
    notes = _notes(case, wavy)
    ends = [
        (np.nan, np.nan) if w is None else (max(w.laid.waves.shortest, w.laid.carried), w.laid.waves.longest)
        for w in wavy
    ]
    rms = [np.nan if w is None else w.laid.waves.Wq for w in wavy]
    return WaveBand(seeds=tuple(seeds), frequencies=np.stack(rows), rms=np.array(rms), ends=np.array(ends)), notes


def _notes(case: Case, wavy: list["_Wavy | None"]) -> list[Note]:
    """What is assumed of the faces that the study says nothing of."""
    silent = [joint.name for joint, waves in zip(case.study.joints, wavy, strict=True) if waves is not None]
    text = (
        f"{', '.join(silent)}: the study gives no form of the faces. The table of modes has them as meshed; machined "
        f"faces have waves, and {DRAWS} draws of waves with a gap of {show(ASSUMED_GAP, 'm')} rms say how far that "
        "moves each frequency. Give [joint.form] a measured map, waviness, or flat = true"
    )
    return [Note(code="waves-assumed", text=text)]


def _wavy(case: Case) -> list[_Wavy | None]:
    """Where waves are drawn on each joint; None where it stays as it is."""
    structure, mesh = case.structure, case.structure.mesh
    bolts = {bolt.part for bolt in structure.bolts if isinstance(bolt, SolidBolt)}
    out: list[_Wavy | None] = []
    for joint, choice, surface in zip(structure.joints, case.study.joints, case.surfaces, strict=True):
        interface = joint.interface
        seat = any(mesh.face_part[face] in bolts for face in joint.faces)
        axes = None if choice.form is not None or seat else FaceAxes.of(mesh, joint.faces, interface, Form().along)
        waviness = replace(ASSUMED, scan=surface.waves)
        if axes is None or not waviness.fits(axes):
            out.append(None)
            continue
        laid = LaidWaves.of(waviness, axes)
        if laid.waves.longest < laid.carried:
            out.append(None)
            continue
        out.append(
            _Wavy(positions=interface.positions, weights=interface.weights, base=interface.gap, axes=axes, laid=laid)
        )
    return out


def _frequencies(case: Case, reduction: Reduction, wavy: list[_Wavy | None], seeds: Sequence[int]) -> list[Array]:
    """Frequencies [Hz] (loads, m) of each draw; the basis is made for the first and the last load of all of them."""
    joints = case.structure.joints
    forces = [np.array(case.study.forces(k)) for k in range(len(case.loads))]
    draws = []
    for seed in seeds:
        gaps = [
            joint.interface.gap if waves is None else waves.gap(seed) for joint, waves in zip(joints, wavy, strict=True)
        ]
        laws, friction = [joint.law for joint in joints], [joint.friction for joint in joints]
        draws.append([Gapped(laws=laws, forces=force, friction=friction, gaps=gaps) for force in forces])
    ends = [draw[k] for draw in draws for k in sorted({0, len(forces) - 1})]
    each = len(ends) // len(draws)
    starts = train_together(reduction, ends, TOLERANCE)
    return [
        np.stack([evaluate(reduction, one, starts[each * number]).frequencies for one in draw])
        for number, draw in enumerate(draws)
    ]
