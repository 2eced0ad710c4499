"""What waves of the faces do to the frequencies: a few draws of waves that nobody has measured, in a small basis."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from faying.case.case import Case
from faying.case.solve import LoadedCase
from faying.case.waves import drawn_on
from faying.errors import NotConverged
from faying.form.face_axes import FaceAxes
from faying.form.machining import ASSUMED_GAP
from faying.form.waviness import LaidWaves
from faying.notes import Note, joint_names
from faying.result.run_record import preload_slope
from faying.typing import Array
from faying.units import show

DRAWS = 4
MIN_DRAWS = 2  # that have a scatter


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
    """A joint on which waves are drawn: its gap without waves (q,) [m], and the waves, whose seed varies.

    own: the seed of the draw that the case has; None where it has none.
    """

    positions: Array
    weights: Array
    base: Array
    axes: FaceAxes
    laid: LaidWaves
    own: int | None

    def gap(self, seed: int) -> Array:
        waves = replace(self.laid, waves=replace(self.laid.waves, seed=seed))
        return self.base + waves.gap(self.positions, self.axes, self.weights)


@dataclass(frozen=True, kw_only=True)
class Draws:
    """The draws of waves on the joints of a case; nothing on a joint that stays as it is."""

    wavy: Sequence[_Wavy | None]
    seeds: tuple[int, ...] = tuple(range(DRAWS))

    @classmethod
    def of(cls, case: Case) -> "Draws":
        """The draws of a case."""
        return cls(wavy=_wavy(case))

    @property
    def drawn(self) -> tuple[int, ...]:
        """The seeds of the draws that the case itself does not have."""
        if not any(self.wavy):
            return ()
        own = {waves.own for waves in self.wavy if waves is not None}
        return tuple(seed for seed in self.seeds if own != {seed})

    def gaps(self, case: Case, seed: int) -> list[Array]:
        """Gap of each joint [m] (q,) in one draw."""
        joints = case.structure.joints
        return [
            joint.interface.gap if waves is None else waves.gap(seed)
            for joint, waves in zip(joints, self.wavy, strict=True)
        ]

    def band(self, states: Sequence[LoadedCase], found: Sequence[Array | NotConverged]) -> WaveBand | None:
        """The frequencies of all draws that have an answer, from those of `drawn` [Hz] (loads, m).

        None where nothing is drawn, or fewer than two draws have an answer.
        """
        if not any(self.wavy):
            return None
        solved = np.stack([state.damped.frequencies for state in states])
        by_seed = dict.fromkeys(self.seeds, solved) | dict(zip(self.drawn, found, strict=True))
        rows = {seed: row for seed, row in by_seed.items() if not isinstance(row, NotConverged)}
        if len(rows) < MIN_DRAWS:
            return None
        ends = [
            (np.nan, np.nan) if w is None else (max(w.laid.waves.shortest, w.laid.carried), w.laid.waves.longest)
            for w in self.wavy
        ]
        rms = [np.nan if w is None else w.laid.waves.Wq for w in self.wavy]
        return WaveBand(
            seeds=tuple(rows), frequencies=np.stack(list(rows.values())), rms=np.array(rms), ends=np.array(ends)
        )

    def notes(self, case: Case) -> list[Note]:
        """What is assumed of the faces that the study says nothing of."""
        named = zip(case.study.joints, self.wavy, strict=True)
        silent = [joint.name for joint, waves in named if waves is not None and joint.form is None]
        if not silent:
            return []
        text = (
            f"{joint_names(silent)}: the study gives no form of the faces. The table of modes has them as meshed; "
            f"machined faces have waves, and {DRAWS} draws of waves with a gap of {show(ASSUMED_GAP, 'm')} rms say how "
            "far that moves each frequency. Give [joint.form] a measured map, waviness, or flat = true"
        )
        return [Note(code="waves-assumed", text=text)]


def _wavy(case: Case) -> list[_Wavy | None]:
    """Where waves are drawn on each joint; None where it stays as it is."""
    structure, out = case.structure, list[_Wavy | None]()
    for joint, choice, surface in zip(structure.joints, case.study.joints, case.surfaces, strict=True):
        interface = joint.interface
        found = drawn_on(case.study, structure.mesh, choice, interface, surface)
        if found is None:
            out.append(None)
            continue
        axes, laid = found
        silent = choice.form is None
        given = 0.0 if silent else laid.gap(interface.positions, axes, interface.weights)
        out.append(
            _Wavy(
                positions=interface.positions,
                weights=interface.weights,
                base=interface.gap - given,
                axes=axes,
                laid=laid,
                own=None if silent else laid.waves.seed,
            )
        )
    return out
