"""How far the frequencies of one structure differ from one assembly to the next: what is drawn, and what it does."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np

from faying.misuse import checked_call
from faying.notes import Note
from faying.result.fields import Recorded, in_units, load_texts, optional, variable
from faying.result.fields import listed as numbers
from faying.result.provenance import Provenance
from faying.text import listed, notes_row
from faying.typing import Array, Index, Mask

SOURCES = ("force", "order", "position")  # what an assembly draws
ENDS = (0.05, 0.95)
MAX_MODES = 5  # that a summary has a line for


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Assemblies(Recorded):
    """Frequencies of one structure that one person takes apart and bolts together again.

    Material, law and roughness are as modelled in every assembly. Of a face that the study says nothing of, the waves
    are one draw, the same in all; each frequency is that as modelled times what the assembly does to the structure with
    these waves.

    Args:
        title: Of the study.
        seed: Of the draws.
        sources: What is drawn, of `SOURCES`.
        bolts, joints: Their names.
        reasons: Why assemblies have no answer, and how many.
        notes: What there is to say.
    """

    KIND: ClassVar[str] = "assemblies"
    COMMAND: ClassVar[str] = "faying predict STUDY.toml --assemblies 32"

    title: str
    seed: int
    sources: tuple[str, ...]
    bolts: tuple[str, ...]
    joints: tuple[str, ...]
    loads: Array = variable("load", "N", "preload of the first bolt", "preload")
    modelled: Array = variable("load mode", "Hz", "frequencies as modelled", "modes/frequency_as_modelled")
    frequencies: Array = variable("assembly load mode", "Hz", "frequencies", "assemblies/frequency", gaps=True)
    alone: Array = variable(
        "source assembly load mode",
        "Hz",
        "frequencies with one thing drawn alone",
        "assemblies/frequency_alone",
        gaps=True,
    )
    forces: Array = variable("assembly load bolt", "N", "force that a bolt is tightened to", "assemblies/force")
    left: Array = variable(
        "assembly load bolt", "N", "force left when all bolts are tight", "assemblies/force_left", gaps=True
    )
    orders: Index = variable("assembly turn", "1", "bolts in their order, from 1", "assemblies/order", dtype="i8")
    shifts: Array = variable(
        "assembly joint axis", "m", "displacement of the second face in its plane", "assemblies/displacement"
    )
    low: Array | None = optional("load mode", "Hz", "5 % of all such structures", "modes/low_of_structures")
    high: Array | None = optional("load mode", "Hz", "95 % of all such structures", "modes/high_of_structures")
    reasons: dict[str, int] = field(default_factory=dict)
    notes: tuple[Note, ...] = ()
    provenance: Provenance | None = None

    @property
    def sound(self) -> Mask:
        """Which assemblies have an answer (n,)."""
        return np.asarray(np.isfinite(self.frequencies).all(axis=(1, 2)))

    @checked_call
    def quantiles(self, levels: Sequence[float] = ENDS) -> Array:
        """Quantiles of the frequencies [Hz] (q, load, mode) over the assemblies that have an answer.

        Args:
            levels: Shares from 0 to 1 of the assemblies that lie below.
        """
        return np.asarray(np.quantile(self.frequencies[self.sound], levels, axis=0))

    @property
    def deviation(self) -> Array:
        """Standard deviation of ln f between assemblies [-] (load, mode)."""
        return _deviation(self.frequencies)

    @property
    def deviation_alone(self) -> Array:
        """The same with one source drawn alone [-] (source, load, mode)."""
        return np.stack([_deviation(one) for one in self.alone])

    @property
    def part_of_interval(self) -> Array:
        """Width from 5 to 95 % between assemblies over that between structures [-] (load, mode); NaN if not known."""
        low, high = self.quantiles()
        if self.low is None or self.high is None:
            return np.full(low.shape, np.nan)
        return np.asarray((high - low) / (self.high - self.low))

    def most(self, load: int, mode: int) -> str:
        """The source that makes most of a mode's scatter when it is drawn alone; "-" where there is none."""
        alone = self.deviation_alone[:, load, mode]
        return self.sources[int(np.argmax(alone))] if np.any(alone > 0) else "-"

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, what is drawn, and the scatter of the first modes at the last preload."""
        count = int(np.count_nonzero(self.sound))
        rows = {"drawn": listed(self.sources), "preloads": listed(load_texts(self.loads))}
        low, high = self.quantiles()
        rows["frequencies"] = f"5 % | 95 %, standard deviation at {load_texts(self.loads)[-1]}"
        for k in range(min(low.shape[1], MAX_MODES)):
            rows[f"mode {k + 1}"] = f"{low[-1, k]:.2f} | {high[-1, k]:.2f} Hz, {self.deviation[-1, k]:.2%}"
        head = f"Assemblies of {self.title!r}: {count} of {len(self.frequencies)} have an answer"
        return head, rows | notes_row(self.notes)

    def to_dict(self) -> dict[str, Any]:
        """Return a summary ready for JSON, in SI units; the assemblies are in the file."""
        return {
            "title": self.title,
            "assemblies": len(self.frequencies),
            "answered": int(np.count_nonzero(self.sound)),
            "without_answer": self.reasons,
            "drawn": list(self.sources),
            **in_units(self, without=("assembly",)),
            "quantiles": {"levels": list(ENDS), "frequencies": {"unit": "Hz", "values": numbers(self.quantiles())}},
            "deviation": {"unit": "1", "values": numbers(self.deviation)},
            "deviation_alone": {"unit": "1", "values": numbers(self.deviation_alone)},
            "notes": [{"code": note.code, "text": note.text} for note in self.notes],
        }

    def labels(self) -> dict[str, Any]:
        """Labels of the dimensions of its arrays, by the name of the dimension."""
        modes = np.arange(1, self.modelled.shape[1] + 1)
        named = {"load": load_texts(self.loads), "mode": modes, "source": self.sources, "bolt": self.bolts}
        return {**named, "joint": self.joints, "axis": ("x", "y", "z")}


def _deviation(frequencies: Array) -> Array:
    """Standard deviation (load, mode) of ln f over assemblies (n, load, mode) that have an answer."""
    logs = np.log(frequencies[np.isfinite(frequencies).all(axis=(1, 2))])
    return np.asarray(logs.std(axis=0, ddof=1)) if len(logs) > 1 else np.full(frequencies.shape[1:], np.nan)
