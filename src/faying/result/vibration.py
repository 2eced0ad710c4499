"""What a structure does in service under one excitation: levels of its modes, motion of points, bolts and joints."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from faying.misuse import checked_call
from faying.notes import Note
from faying.result.fields import Recorded, group, in_units, listed, variable
from faying.result.groups import OuterStress
from faying.result.provenance import Provenance
from faying.style import COLUMN, axes_of, colour, drawing, legend_above, new_figure, plain_numbers
from faying.text import notes_row
from faying.typing import Array, Index
from faying.units import GRAVITY, load_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ESTIMATES = ("5 %", "best", "95 %")
SHAKEN = 0.01  # of the greatest level: modes below it are not shown,
NEAR_BAND = 1.2  # nor those farther from the band than by this factor, where others are nearer
MAX_MODES = 8  # that a summary has a line for
MAX_DRAWN = 6  # points, and modes, in one panel
YEAR, HOUR = 31_557_600.0, 3600.0  # s


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class VibrationResponse(Recorded):
    """Answers of a preloaded structure to one excitation; NaN stands for what is not known.

    Numbers are rms values of random vibration, greatest amplitudes of a sweep; those with an estimate have 5 %, best
    estimate and 95 % over friction and damping at rest. title: of the study; name: of the excitation; kind: "random" or
    "sine"; unit: SI unit of its table; preload [N]: of the first bolt; base: 1 where the supports move, 0 where a force
    acts; times: duration [s] of random vibration, or minutes an octave of a sweep, NaN where not given.
    """

    KIND: ClassVar[str] = "vibration"
    COMMAND: ClassVar[str] = "faying vibration STUDY.toml --out vibration.nc"

    title: str
    name: str
    kind: str
    unit: str
    preload: float
    base: int
    times: float
    bolts: tuple[str, ...]
    joints: tuple[str, ...]
    direction: Array = variable("axis", "1", "direction of the motion of the supports, or of the force")
    input_frequency: Array = variable("row", "Hz", "frequencies of the table")
    input_value: Array = variable("row", "", "density or amplitude of the input, in the unit of the table")
    rest_frequency: Array = variable("mode", "Hz", "frequency at rest", "modes/")
    rest_damping: Array = variable("estimate mode", "1", "damping ratio at rest", "modes/")
    share: Array = variable("mode", "1", "share of the mass that moves with a mode, or modal force", "modes/")
    frequency: Array = variable("estimate mode", "Hz", "frequency that is reached", "modes/")
    damping: Array = variable("estimate mode", "1", "damping ratio that is reached", "modes/")
    level: Array = variable(
        "estimate mode", "m/s2", "displacement where a mode alone moves most, times its own omega squared", "modes/"
    )
    reach: Array = variable(
        "mode", "m/s2", "where the curve of a mode ends; NaN where it need not", "modes/", gaps=True
    )
    curve_level: Array = variable("mode sample", "m/s2", "level of a mode", "modes/")
    curve_damping: Array = variable("mode sample", "1", "damping ratio of a mode at that level", "modes/")
    points: Array = variable("point axis", "m", "points whose motion is given", "points/position")
    acceleration: Array = variable("estimate point axis", "m/s2", "acceleration", "points/")
    velocity: Array = variable("estimate point axis", "m/s", "velocity, against supports that move", "points/")
    displacement: Array = variable("estimate point axis", "m", "displacement, against supports that move", "points/")
    line_frequency: Array = variable("line", "Hz", "frequencies of the curves", "curves/frequency")
    curve: Array = variable(
        "estimate point line", "", "density or amplitude of the acceleration along the input", "curves/acceleration"
    )
    curve_motion: Array = variable(
        "estimate point line", "", "the same of the displacement, against supports that move", "curves/displacement"
    )
    bolt_force: Array = variable("estimate bolt", "N", "change of the force of the bolt", "bolts/force")
    bolt_moment: Array = variable("estimate bolt", "N m", "bending moment, worst end", "bolts/moment", gaps=True)
    bolt_shear: Array = variable("estimate bolt", "N", "force across the bolt", "bolts/shear", gaps=True)
    stress: Array = variable("estimate bolt", "Pa", "stress of the bolt where it is greatest", "bolts/", gaps=True)
    damage: Array = variable("estimate bolt", "1", "damage, 1 at failure", "bolts/", gaps=True)
    head_motion: Array = variable(
        "estimate bolt", "1", "transverse motion of the head over that at which it slides", "bolts/", gaps=True
    )
    parts: tuple[str, ...]
    part_stress: Array = variable("estimate part", "Pa", "greatest stress of von Mises in each part", "parts/stress")
    part_stress_place: Array = variable("part axis", "m", "where it is", "parts/")
    slide_motion: Array = variable("bolt", "m", "transverse motion of the head at which it slides", "bolts/", gaps=True)
    slip_margin: Array = variable(
        "estimate joint", "1", "friction over shear and torque of all of the joint", "joints/", gaps=True
    )
    slip_margin_worst: Array = variable(
        "estimate joint", "1", "the same round the bolt where it is least", "joints/", gaps=True
    )
    surface: OuterStress | None = group("surface")
    notes: tuple[Note, ...] = ()
    provenance: Provenance = field(default_factory=Provenance)

    @property
    def words(self) -> str:
        """What the numbers are: "rms" or "amplitude"."""
        return "rms" if self.kind == "random" else "amplitude"

    @property
    def shaken(self) -> Index:
        """Indices of modes that are shaken: with a hundredth of the greatest level, near the band if any is."""
        strong = self.level[1] > SHAKEN * self.level[1].max()
        first, last = self.input_frequency[[0, -1]]
        near = strong & (self.rest_frequency * NEAR_BAND > first) & (self.rest_frequency < NEAR_BAND * last)
        return np.flatnonzero(near if near.any() else strong)

    @property
    def curve_velocity(self) -> Array:
        """Density or amplitude of the velocity along the input, against supports that move (estimate, point, line)."""
        return np.asarray(self.curve_motion * (2 * np.pi * self.line_frequency) ** (2 if self.kind == "random" else 1))

    @property
    def life(self) -> Array:
        """Time [s] until each bolt fails, or sweeps until then (estimate, bolt); infinite without damage."""
        with np.errstate(divide="ignore"):
            return np.asarray((self.times if self.kind == "random" else 1.0) / self.damage[::-1])

    def labels(self) -> dict[str, Any]:
        """Labels of the dimensions."""
        return {
            "estimate": ESTIMATES,
            "mode": np.arange(1, len(self.rest_frequency) + 1),
            "bolt": self.bolts,
            "joint": self.joints,
            "part": self.parts,
            "axis": ("x", "y", "z"),
            **({"state": self.surface.states} if self.surface else {}),
        }

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and level, frequency and damping of the modes that are shaken most."""
        head = f"Vibration {self.name!r} of {self.title} at {load_text(self.preload)}, {self.words} values"
        rows = {}
        for k in self.shaken[:MAX_MODES].tolist():
            low, best, high = self.level[:, k]
            rows[f"mode {k + 1}"] = (
                f"{best:.3g} m/s2 ({low:.3g} to {high:.3g}) at {self.frequency[1, k]:.4g} Hz, "
                f"damping {100 * self.damping[1, k]:.3g} %"
            )
        return head, rows | notes_row(self.notes)

    def to_dict(self) -> dict[str, Any]:
        """Return everything but the curves in SI units, for JSON."""
        margins = {name: getattr(self, name) for name in ("slip_margin", "slip_margin_worst")}
        return {
            **{name: getattr(self, name) for name in ("title", "name", "kind", "unit")},
            "preload": {"unit": "N", "values": self.preload},
            "base": bool(self.base),
            "bolts": list(self.bolts),
            "joints": list(self.joints),
            "parts": list(self.parts),
            "estimates": list(ESTIMATES),
            **in_units(self, without=("line", "sample", "node", "triangle")),
            **{name: {"unit": "1", "values": _finite(values)} for name, values in margins.items()},
            "life": {"unit": "s" if self.kind == "random" else "sweeps", "values": _finite(self.life)},
            "notes": [asdict(note) for note in self.notes],
        }

    @drawing
    def plot(self, ax: Any = None) -> "list[Axes]":
        """Draw the input and the acceleration of the points, and the damping of the modes over their level.

        Args:
            ax: Two matplotlib axes to draw into; new ones where None.

        Returns:
            The axes.
        """
        axes = axes_of(ax, 2, width=COLUMN, height=3.0)
        factor = GRAVITY**2 if self.kind == "random" else GRAVITY
        shown = "g²/Hz" if self.kind == "random" else "g"
        if self.base:
            axes[0].plot(self.input_frequency, self.input_value / factor, color="black", ls="--", label="input")
        for k in range(min(len(self.points), MAX_DRAWN)):
            low, best, high = self.curve[:, k] / factor
            axes[0].fill_between(self.line_frequency, low, high, color=colour(k), alpha=0.2, lw=0)
            axes[0].plot(self.line_frequency, best, color=colour(k), label=f"point {k + 1}")
        name = "PSD" if self.kind == "random" else "amplitude"
        axes[0].set(xscale="log", yscale="log", xlabel="frequency [Hz]", ylabel=f"{name} of acceleration [{shown}]")
        for number, k in enumerate(self.shaken[:MAX_DRAWN].tolist()):
            axes[1].plot(self.curve_level[k], 100 * self.curve_damping[k], color=colour(number), label=f"mode {k + 1}")
            axes[1].plot(self.level[1, k], 100 * self.damping[1, k], "o", color=colour(number), ms=4)
        axes[1].set(
            xscale="log", yscale="log", xlabel=f"{self.words} of acceleration [m/s²]", ylabel="damping ratio [%]"
        )
        for one in axes:
            one.grid(alpha=0.3)
            plain_numbers(one.xaxis)
            legend_above(one)
        plain_numbers(axes[1].yaxis)
        return axes


def _finite(values: Array) -> Any:
    """Lists with None in place of what is not finite."""
    return listed(np.where(np.isfinite(values), values, np.nan))


def life_text(seconds: float) -> str:
    """A time in words: "3.2 h", "5 years"; "no end" where it is infinite."""
    if np.isnan(seconds):
        return "-"
    if not np.isfinite(seconds) or seconds > 1e6 * YEAR:
        return "no end"
    for size, word in ((YEAR, "years"), (24 * HOUR, "days"), (HOUR, "h"), (60.0, "min")):
        if seconds >= size:
            return f"{seconds / size:.3g} {word}"
    return f"{seconds:.3g} s"


def has_life(found: Sequence[VibrationResponse]) -> bool:
    """Whether the life of a bolt is known and finite, at several preloads."""
    return len({one.preload for one in found}) > 1 and any(np.isfinite(one.life[1]).any() for one in found)


@drawing
def life_figure(found: Sequence[VibrationResponse]) -> Any:
    """Draw the life of the bolt that fails first over preload, a line for each excitation."""
    fig = new_figure(COLUMN, 2.6)
    ax = fig.add_subplot()
    for number, name in enumerate(dict.fromkeys(one.name for one in found)):
        some = [one for one in found if one.name == name]
        factor, unit = (HOUR, "h") if some[0].kind == "random" else (1.0, "sweeps")
        loads = np.array([one.preload for one in some]) / 1e3
        low, best, high = (np.nanmin([one.life[k] for one in some], axis=1) / factor for k in range(3))
        ends = np.stack([best - low, high - best])
        ax.errorbar(loads, best, yerr=np.where(np.isfinite(ends), ends, 0.0), fmt="o-", capsize=3, color=colour(number))
        ax.plot([], [], color=colour(number), label=f"{name} [{unit}]")
    ax.set(xlabel="preload [kN]", ylabel="life", yscale="log")
    ax.grid(alpha=0.3)
    legend_above(ax)
    return fig
