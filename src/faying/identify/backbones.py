"""What scatter makes of a backbone: the curves of samples on one grid of accelerations, and their quantiles."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from faying.measured.ring_down import MeasuredBackbone
from faying.notes import Note
from faying.result.backbone import measured_of
from faying.result.fields import Recorded, listed, variable
from faying.typing import Array, Index

ENOUGH = 0.5  # share of the curves that must reach an acceleration for quantiles there


@dataclass(frozen=True, kw_only=True, eq=False)
class Backbones(Recorded):
    """Backbones of the first samples of a prediction: NaN beyond the end of a curve, and where there is none.

    Args:
        mode: Elastic mode of the median, from 1, whose shape is followed in every sample.
        preload: Of the first bolt [N], as the study has it.
        reasons: Why samples have no backbone, and how many.
        ends: Why backbones end before the last acceleration, and how many.
        measured_source: File of the measured points that [backbone] names; empty where it names none.
    """

    mode: int
    preload: float
    at: Array = variable("axis", "m", "point whose motion is given")
    acceleration: Array = variable("amplitude", "m/s2", "acceleration amplitude at the point")
    frequencies: Array = variable("curve amplitude", "Hz", "frequency of each sample", gaps=True)
    damping: Array = variable("curve amplitude", "1", "damping ratio to critical of each sample", gaps=True)
    measured_acceleration: Array = variable("measured", "m/s2", "measured acceleration amplitude", default=())
    measured_frequency: Array = variable("measured", "Hz", "measured frequency", default=())
    measured_damping: Array = variable(
        "measured", "1", "measured damping ratio; NaN where not measured", gaps=True, default=()
    )
    measured_source: str = ""
    reasons: dict[str, int] = field(default_factory=dict)
    ends: dict[str, int] = field(default_factory=dict)

    @property
    def measured(self) -> MeasuredBackbone | None:
        """The measured points that the study names, None without."""
        return measured_of(self)

    @property
    def reached(self) -> Index:
        """How many curves reach each acceleration (amplitude,)."""
        return np.asarray(np.count_nonzero(np.isfinite(self.frequencies), axis=0))

    @property
    def answered(self) -> int:
        """How many samples have a backbone."""
        return len(self.frequencies) - sum(self.reasons.values())

    @property
    def enough(self) -> Any:
        """At which accelerations there are quantiles (amplitude,).

        Those are of the curves that reach it. Where fewer than half do, not even the median of all need lie among them.
        """
        return self.reached >= max(ENOUGH * self.answered, 1)

    def quantiles(self, levels: Sequence[float]) -> tuple[Array, Array]:
        """Quantiles (q, amplitude) of frequency [Hz] and damping ratio [-] over the curves that reach an acceleration.

        NaN where fewer than half of them do.

        Args:
            levels: Shares from 0 to 1 of the curves that lie below.
        """
        out = np.full((2, len(levels), len(self.acceleration)), np.nan)
        for found, values in zip(out, (self.frequencies, self.damping), strict=True):
            found[:, self.enough] = np.nanquantile(values[:, self.enough], levels, axis=0)
        return out[0], out[1]

    @property
    def notes(self) -> list[Note]:
        """What there is to say of them."""
        count, reached = len(self.frequencies), self.reached
        none = (f"{number} of {count} samples have no backbone: {reason}" for reason, number in self.reasons.items())
        early = (f"{number} of {self.answered} backbones end early: {reason}" for reason, number in self.ends.items())
        out = [Note(code="no-backbone", text=text) for text in none]
        out += [Note(code="backbone-ends", text=text) for text in early]
        fewer = np.flatnonzero(reached < self.answered)
        if len(fewer):
            text = f"from {self.acceleration[fewer[0]]:.3g} m/s2 on the quantiles are those of the backbones that go on"
            if not self.enough.all():
                first = self.acceleration[np.argmin(self.enough)]
                text += f"; from {first:.3g} m/s2 on fewer than half do, and there are none"
            out.append(Note(code="backbone-survivors", text=text))
        return out

    def to_dict(self, levels: Sequence[float]) -> dict[str, Any]:
        """Return a summary ready for JSON, in SI units."""
        frequencies, damping = self.quantiles(levels)
        return {
            "mode": self.mode,
            "preload": {"unit": "N", "values": self.preload},
            "at": {"unit": "m", "values": listed(self.at)},
            "samples": len(self.frequencies),
            "answered": self.answered,
            "without_answer": self.reasons,
            "ends": self.ends,
            "acceleration": {"unit": "m/s2", "values": listed(self.acceleration)},
            "reached": listed(self.reached),
            "frequencies": {"unit": "Hz", "values": listed(frequencies)},
            "damping": {"unit": "1", "values": listed(damping)},
        }
