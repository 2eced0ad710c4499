"""The curve of frequency and damping of a mode against its amplitude: its numbers, on disk, and drawn."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from faying.errors import InputError
from faying.files import write_text
from faying.measured.ring_down import MeasuredBackbone
from faying.misuse import checked_call
from faying.notes import Note
from faying.result.fields import Recorded, declared, in_units, listed, variable
from faying.result.provenance import Provenance
from faying.style import COLUMN, axes_of, colour, drawing, headline, legend_above, new_figure, plain, plain_numbers
from faying.text import csv_text, notes_row
from faying.typing import Array, Index
from faying.units import in_mm, load_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_POINTS = 6  # of a curve that a summary has a line for
DECAY = 200  # points of a ring-down
SHORT = 1e-3  # step of the logarithm of the amplitude for the slope of the frequency


@dataclass(frozen=True, kw_only=True, eq=False)
class QuasiStaticCheck:
    """The same mode from statics alone: a quasi-static cycle under inertia forces, at some of the amplitudes."""

    amplitude: Array = variable("witness", "m kg^1/2", "modal amplitude")
    acceleration: Array = variable("witness", "m/s2", "acceleration at the point")
    frequency: Array = variable("witness", "Hz", "frequency of the static cycle")
    damping: Array = variable("witness", "1", "damping ratio of the static cycle")
    frequency_change: Array = variable("witness", "1", "static cycle over the curve's frequency, less 1")
    damping_change: Array = variable(
        "witness", "1", "static cycle over the joints' damping, less 1; NaN where there is none", gaps=True
    )


@dataclass(frozen=True, kw_only=True)
class ErrorBounds:
    """What changes, relatively, at an acceleration [m/s2] when the computation is made coarser; NaN: not looked at.

    The acceleration is the largest of the curve at which the coarser computations have an answer.
    harmonics: {0, 1} in place of all; points: half of the joints' points; samples: half of the instants of a cycle.
    Damping is that of the joints alone. residual: the greatest of what the cycles leave in the full equations.
    """

    acceleration: float = float("nan")
    harmonics_frequency: float = float("nan")
    harmonics_damping: float = float("nan")
    points_frequency: float = float("nan")
    points_damping: float = float("nan")
    samples_frequency: float = float("nan")
    samples_damping: float = float("nan")
    residual: float = float("nan")


@dataclass(frozen=True, kw_only=True, eq=False)
class RingDown:
    """Free decay along the curve: time [s], acceleration amplitude [m/s2], frequency [Hz], damping ratio [-] (k,)."""

    time: Array
    acceleration: Array
    frequency: Array
    damping: Array


def measured_of(curve: Any) -> MeasuredBackbone | None:
    """The measured points that a curve, or curves of samples, are compared with; None without."""
    if not len(curve.measured_acceleration):
        return None
    return MeasuredBackbone.of_points(
        curve.measured_acceleration, curve.measured_frequency, curve.measured_damping, source=curve.measured_source
    )


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Backbone(Recorded):
    """Frequency and damping of one mode against its amplitude.

    The amplitude is that of the fundamental harmonic at the point `at` along `direction`. damping is the joints' ratio
    to critical plus `rest_damping`; friction is that of each joint; mode counts elastic modes from 1; preload [N] is
    that of the first bolt. code and reason say why the curve ends. shape_at [kg^-1/2]: what the mode at rest moves
    at the point. laws: name of the contact law of each joint; measured_source: file of the measured points.
    """

    KIND: ClassVar[str] = "backbone"
    COMMAND: ClassVar[str] = "faying backbone STUDY.toml"

    title: str
    mode: int
    preload: float
    friction: tuple[float, ...]
    harmonics: int
    linear_frequency: float
    rest_damping: float
    shape_at: float
    code: str
    reason: str
    joints: tuple[str, ...]
    bolts: tuple[str, ...]
    basis_size: int
    unknowns: int
    at: Array = variable("axis", "m", "point whose motion is given")
    direction: Array = variable("axis", "1", "direction of that motion")
    acceleration: Array = variable("amplitude", "m/s2", "acceleration amplitude at the point")
    frequency: Array = variable("amplitude", "Hz", "frequency")
    damping: Array = variable("amplitude", "1", "damping ratio to critical")
    modal_amplitude: Array = variable("amplitude", "m kg^1/2", "modal amplitude")
    displacement: Array = variable("amplitude", "m", "displacement amplitude at the point")
    slipping: Array = variable("amplitude", "1", "share of the joints' friction that slides in a cycle")
    open: Array = variable("amplitude", "1", "share of the joints' area that opens in a cycle")
    other_modes: Array = variable("amplitude", "1", "share of other modes and harmonics in the motion")
    residual: Array = variable("amplitude", "1", "residual of the full equations, in energy")
    joint_slipping: Array = variable("amplitude joint", "1", "share of a joint's friction that slides")
    joint_open: Array = variable("amplitude joint", "1", "share of a joint's area that opens")
    energy: Array = variable("amplitude joint", "J", "energy lost in each joint in a cycle")
    bolt_force: Array = variable("amplitude bolt", "N", "amplitude of each bolt's force")
    slip_map: Array = variable("amplitude point", "1", "share of the friction that slides")
    open_map: Array = variable("amplitude point", "1", "whether the point opens")
    points: Array = variable("point axis", "m", "points of the joints")
    weights: Array = variable("point", "m2", "area of each point")
    joint_of_point: Index = variable("point", "1", "joint of each point, from 0", dtype="i8")
    measured_acceleration: Array = variable("measured", "m/s2", "measured acceleration amplitude", default=())
    measured_frequency: Array = variable("measured", "Hz", "measured frequency", default=())
    measured_damping: Array = variable(
        "measured", "1", "measured damping ratio; NaN where not measured", gaps=True, default=()
    )
    measured_source: str = ""
    laws: tuple[str, ...] = ()
    witness: QuasiStaticCheck | None = None
    bounds: ErrorBounds = field(default_factory=ErrorBounds)
    notes: tuple[Note, ...] = ()
    provenance: Provenance = field(default_factory=Provenance)

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and some points of the curve."""
        head = f"Backbone {self.title!r}: mode {self.mode}, {self.settings}"
        rest = f"{self.linear_frequency:.3f} Hz, damping ratio {self.rest_damping:.3g}, seen at {in_mm(self.at)}"
        rows = {"at rest": rest}
        count = len(self.acceleration)
        for k in np.unique(np.linspace(0, count - 1, min(count, MAX_POINTS)).round().astype(int)):
            text = f"{self.frequency[k]:.3f} Hz, damping ratio {self.damping[k]:.3g}, slips on {self.slipping[k]:.0%}"
            rows[f"{self.acceleration[k]:.4g} m/s2"] = text
        rows["ends"] = self.reason
        return head, rows | notes_row(self.notes)

    @property
    def friction_text(self) -> str:
        """The friction of the joints, once where it is the same for all."""
        return ", ".join(f"{value:g}" for value in dict.fromkeys(self.friction))

    @property
    def settings(self) -> str:
        """Preload, laws and friction in words."""
        return ", ".join([load_text(self.preload), *dict.fromkeys(self.laws), f"friction {self.friction_text}"])

    @property
    def measured(self) -> MeasuredBackbone | None:
        """The measured points that the study names, None without."""
        return measured_of(self)

    def at_measured(self) -> tuple[Array, Array]:
        """Frequency [Hz] and damping ratio [-] of the curve at the measured accelerations, NaN beyond its end."""
        inside = self.measured_acceleration <= self.acceleration[-1]
        frequency, damping = self._between(self.acceleration, self.measured_acceleration)
        return np.where(inside, frequency, np.nan), np.where(inside, damping, np.nan)

    @property
    def warnings(self) -> tuple[str, ...]:
        """The notes as sentences."""
        return tuple(note.text for note in self.notes)

    def at_acceleration(self, acceleration: Any) -> tuple[Array, Array]:
        """Frequency [Hz] and damping ratio [-] at accelerations [m/s2] of any shape.

        Interpolated between the points of the curve in the logarithm of the amplitude; below the first point damping
        from slip falls in proportion to the amplitude and the frequency goes to that at rest. Raises InputError beyond
        the end of the curve.
        """
        wanted = np.asarray(acceleration, dtype=float)
        if np.any(wanted > self.acceleration[-1] * (1 + 1e-9)) or np.any(wanted <= 0):
            raise InputError(
                f"the curve goes from 0 to {self.acceleration[-1]:.4g} m/s2 ({self.reason}); it has no value at "
                f"{wanted.max():.4g} m/s2"
            )
        return self._between(self.acceleration, wanted)

    def _between(self, scale: Array, wanted: Array) -> tuple[Array, Array]:
        x, known = np.log(np.maximum(wanted, scale[0])), np.log(scale)
        share = np.minimum(wanted / scale[0], 1.0)

        def along(values: Array, rest: float) -> Array:
            near_rest = rest + share * (values[0] - rest)
            return np.asarray(np.where(wanted < scale[0], near_rest, np.interp(x, known, values)))

        return along(self.frequency, self.linear_frequency), along(self.damping, self.rest_damping)

    @checked_call
    def ring_down(self, acceleration: float, time: float, *, points: int = DECAY) -> RingDown:
        """Free decay from an acceleration amplitude [m/s2] over a time [s].

        One mode alone, by averaging: d(w q^2)/dt = -2 zeta w (w q^2) with w and zeta of the curve at q. Where the
        frequency hardly changes that is dq/dt = -zeta w q.
        """
        self.at_acceleration(acceleration)
        q = float(np.exp(np.interp(np.log(acceleration), np.log(self.acceleration), np.log(self.modal_amplitude))))
        if acceleration < self.acceleration[0]:
            q = self.modal_amplitude[0] * acceleration / self.acceleration[0]
        times = np.linspace(0.0, time, points)

        def rate(log_q: float) -> float:
            near = np.exp(log_q + np.array([-SHORT, 0.0, SHORT]))
            f, z = self._between(self.modal_amplitude, near)
            bend = float(np.log(f[2] / f[0])) / (2 * SHORT)
            return -float(z[1] * 2 * np.pi * f[1]) / (1 + bend / 2)

        logs = [float(np.log(q))]
        for step in np.diff(times):  # Runge-Kutta, whose steps are far shorter than the decay bends
            here = logs[-1]
            a = rate(here)
            b = rate(here + step / 2 * a)
            c = rate(here + step / 2 * b)
            logs.append(here + step / 6 * (a + 2 * b + 2 * c + rate(here + step * c)))
        amplitude = np.exp(logs)
        f, z = self._between(self.modal_amplitude, amplitude)
        return RingDown(time=times, acceleration=self._acceleration(amplitude), frequency=f, damping=z)

    def _acceleration(self, amplitude: Array) -> Array:
        """Acceleration [m/s2] at the point at modal amplitudes [m kg^1/2]."""
        scale = self.acceleration / self.modal_amplitude
        return np.asarray(amplitude * np.interp(np.log(amplitude), np.log(self.modal_amplitude), scale))

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers a reader wants, ready for JSON: {"unit", "values"} in SI; maps are left out."""
        plain = ("title", "mode", "harmonics", "basis_size", "unknowns", "code", "reason")
        out: dict[str, Any] = {name: getattr(self, name) for name in plain}
        for name in ("friction", "joints", "bolts", "laws"):
            out[name] = list(getattr(self, name))
        units = {"preload": "N", "linear_frequency": "Hz", "rest_damping": "1", "shape_at": "kg^-1/2"}
        out |= {name: {"unit": unit, "values": getattr(self, name)} for name, unit in units.items()}
        out |= in_units(self, without=("point",))
        if self.witness is not None:
            out["witness"] = in_units(self.witness)
        out["bounds"] = {name: listed(value) for name, value in asdict(self.bounds).items()}
        out["notes"] = [asdict(note) for note in self.notes]
        return out

    def labels(self) -> dict[str, Any]:
        """Labels of the dimensions of its arrays, by the name of the dimension."""
        return {"joint": self.joints, "bolt": self.bolts, "axis": ("x", "y", "z")}

    def to_csv(self, path: str | Path) -> Path:
        """Write one row for each amplitude, units in the heading; the file appears complete or not at all."""
        names = ("acceleration", "frequency", "damping", "modal_amplitude", "displacement", "slipping", "open")
        units = declared(type(self))
        heads = [f"{name} [{'-' if units[name].unit == '1' else units[name].unit}]" for name in names]
        columns = ([f"{value:.8g}" for value in getattr(self, name)] for name in names)
        return write_text(Path(path), csv_text([heads, *zip(*columns, strict=True)]))

    @drawing
    @checked_call
    def plot(self, ax: Any = None) -> "list[Axes]":
        """Draw frequency and damping against the acceleration, with what was measured and the static cycle.

        Args:
            ax: Two matplotlib axes to draw into, in a list or an array; new ones where None.

        Returns:
            The axes of frequency and of damping.

        Raises:
            InputError: The number of axes does not fit.
        """
        axes = axes_of(ax, 2, width=COLUMN, height=2.7)
        for one, quantity in zip(axes, ("frequency", "damping"), strict=True):
            panel(one, [self], quantity)
            one.set_xlabel(f"acceleration at {in_mm(self.at)} [m/s²]")
        axes[1].set_title(f"{headline(self.title)}: mode {self.mode}, {load_text(self.preload)}")
        legend_above(axes[0], 1)
        return axes


ROUNDING = 1e-9  # of the greatest damping: less is rounding


def label(curve: Backbone, curves: Sequence[Backbone]) -> str:
    """What tells a curve from the others: law, friction and preload, where these differ."""
    parts = []
    if len({other.laws for other in curves}) > 1:
        parts.append(", ".join(dict.fromkeys(curve.laws)))
    if len({other.preload for other in curves}) > 1:
        parts.append(load_text(curve.preload))
    if len({other.friction for other in curves}) > 1 or not parts:
        parts.append(f"friction {curve.friction_text}")
    return ", ".join(parts)


@drawing
def panel(ax: Any, curves: Sequence[Backbone], quantity: str, measured: Sequence[MeasuredBackbone] = ()) -> Any:
    """Draw frequency [Hz] or damping [%] of curves over acceleration, the static cycle as circles.

    quantity: "frequency" or "damping". Measured points, those of the curves' study first, are hollow,
    with bars of 95 % where standard errors are known.
    """
    own = curves[0].measured
    measured = [*([] if own is None else [own]), *measured]
    factor = factor_of(quantity)
    for k, curve in enumerate(curves):
        look: dict[str, Any] = {"color": colour(k), "lw": 1.5, "marker": ".", "ms": 3.5}
        ax.plot(curve.acceleration, factor * getattr(curve, quantity), label=label(curve, curves), **look)
        if (cycle := curve.witness) is not None:
            look = {"mfc": "none", "mec": colour(k), "ms": 6, "mew": 1.0, "label": "static cycle" if k == 0 else None}
            ax.plot(cycle.acceleration, factor * getattr(cycle, quantity), "o", **look)
    for k, points in enumerate(measured):
        marks(ax, points, quantity, k)
    return framed(ax, quantity)


def marks(ax: Any, points: MeasuredBackbone, quantity: str, k: int) -> None:
    """Draw measured points, marked as the k-th of their kind, with 95 % intervals where standard errors are known."""
    values, error = getattr(points, quantity), getattr(points, f"{quantity}_error")
    known, factor = np.isfinite(values), factor_of(quantity)
    ends = 1.96 * factor * error[known]
    ax.errorbar(
        points.acceleration[known],
        factor * values[known],
        yerr=np.nan_to_num(ends) if np.isfinite(ends).any() else None,
        fmt="sv^x"[k % 4],
        color="0.25",
        ms=3.5,
        mew=1.0,
        mfc="white",
        elinewidth=0.8,
        label=plain(Path(points.source).stem if points.source else "measured"),
    )


def factor_of(quantity: str) -> float:
    """From SI to what is drawn."""
    return 100.0 if quantity == "damping" else 1.0


def framed(ax: Any, quantity: str) -> Any:
    """Scales, grid and names of the axes."""
    ax.set_xscale("log")
    plain_numbers(ax.xaxis)
    ax.grid(which="major", alpha=0.3)
    ax.grid(which="minor", alpha=0.1)
    if quantity == "frequency":
        ax.set_ylabel("frequency [Hz]")
        ax.ticklabel_format(axis="y", useOffset=False)
        return ax
    ax.set(ylabel="damping ratio [%]", yscale="log")
    plain_numbers(ax.yaxis)
    return ax


@drawing
def figure(curves: Sequence[Backbone], measured: Sequence[MeasuredBackbone] = ()) -> Any:
    """Return the figure of curves of one mode: frequency above, damping below, over the same acceleration.

    Args:
        curves: of one mode, at one point.
        measured: points to lay over them.
    """
    fig = new_figure(COLUMN, 4.6)
    upper, lower = fig.subplots(2, 1, sharex=True)
    panel(upper, curves, "frequency", measured)
    panel(lower, curves, "damping", measured)
    first = curves[0]
    lower.set_xlabel(f"acceleration at {in_mm(first.at)} [m/s²]")
    fig.suptitle(f"{headline(first.title)}: mode {first.mode}")
    legend_above(upper, 1)
    return fig


@drawing
def measured(points: MeasuredBackbone) -> Any:
    """Return the figure of measured points alone: frequency above, damping below."""
    fig = new_figure(COLUMN, 4.6)
    upper, lower = fig.subplots(2, 1, sharex=True)
    for ax, quantity in ((upper, "frequency"), (lower, "damping")):
        marks(ax, points, quantity, 0)
        framed(ax, quantity)
    lower.set_xlabel("acceleration [m/s²]")
    fig.suptitle(plain(Path(points.source).name) or "free decay")
    return fig
