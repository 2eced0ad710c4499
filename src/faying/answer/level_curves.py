"""Frequency and damping of all modes over their amplitude, by secant passes: a curve of each mode in seconds."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from faying.answer.run import run
from faying.backbones.backbone import chosen, friction_of
from faying.case.case import bare
from faying.errors import InputError
from faying.files import write_text
from faying.joint.preload_case import preload_index
from faying.misuse import checked_call
from faying.progress import Report
from faying.result import Result
from faying.result.backbone import Backbone
from faying.study.study import Study
from faying.style import (
    COLOURS,
    COLUMN,
    Summary,
    axes_of,
    colour,
    drawing,
    headline,
    legend_above,
    plain_numbers,
    shared_legend,
)
from faying.text import csv_text, in_columns
from faying.typing import Array
from faying.units import load_text

if TYPE_CHECKING:
    from matplotlib.axes import Axes

EACH_DECADE = 6  # levels
MAX_CURVES = 10  # curves in one panel


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class LevelCurves(Summary):
    """Frequency and damping of all modes at rising levels of acceleration, under one preload.

    Args:
        title: Of the study.
        load: Preload of the first bolt [N].
        friction: Coefficient of each joint [-].
        levels: Peak acceleration (l,) of the point that moves most [m/s2].
        frequencies: At each level and of each mode (l, m) [Hz].
        damping: Ratio to critical (l, m) [-], of slip and of what is added at rest.
        error: Estimated error of the iteration (l, m), over the damping of slip [-].
    """

    title: str
    load: float
    friction: tuple[float, ...]
    levels: Array
    frequencies: Array
    damping: Array
    error: Array

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and the frequency and damping of the first modes at both ends."""
        head = f"Curves of {self.frequencies.shape[1]} modes of {self.title!r} at {load_text(self.load)}"
        rows = {"levels": f"{len(self.levels)}, {self.levels[0]:.3g} to {self.levels[-1]:.3g} m/s2"}
        for mode in range(min(8, self.frequencies.shape[1])):
            f, z = self.frequencies[[0, -1], mode], 100 * self.damping[[0, -1], mode]
            rows[f"mode {mode + 1}"] = f"{f[0]:.2f} to {f[1]:.2f} Hz, {z[0]:.3g} to {z[1]:.3g} %"
        return head, rows

    @drawing
    def plot(self, ax: Any = None) -> "list[Axes]":
        """Draw the change of every frequency, and every damping ratio, over the level; at most ten modes.

        Args:
            ax: Two matplotlib axes to draw into; new ones where left out.

        Returns:
            The axes.
        """
        axes = axes_of(ax, 2, width=COLUMN, height=2.9)
        count = min(self.frequencies.shape[1], MAX_CURVES)
        for mode in range(count):
            line = "-" if mode < len(COLOURS) else "--"
            look: dict[str, Any] = {"color": colour(mode), "ls": line, "label": f"mode {mode + 1}"}
            axes[0].plot(self.levels, 100 * (self.frequencies[:, mode] / self.frequencies[0, mode] - 1), **look)
            axes[1].plot(self.levels, 100 * self.damping[:, mode], **look)
        axes[0].set_ylabel("change of frequency [%]")
        axes[1].set(ylabel="damping ratio [%]", yscale="log")
        for one in axes:
            one.set(xscale="log", xlabel="peak acceleration [m/s²]")
            one.grid(alpha=0.3)
            plain_numbers(one.xaxis)
        plain_numbers(axes[1].yaxis)
        heading = f"{headline(self.title)}, {load_text(self.load)}"
        if ax is None:
            shared_legend(axes[0].figure, axes, title=heading)
        else:
            axes[1].set_title(heading)
            legend_above(axes[0])
        return axes

    def to_dict(self) -> dict[str, Any]:
        """Return the curves, ready for JSON, in SI units."""
        arrays = {"levels": "m/s2", "frequencies": "Hz", "damping": "1", "error": "1"}
        out: dict[str, Any] = {"title": self.title, "load": self.load, "friction": list(self.friction)}
        return out | {name: {"unit": unit, "values": getattr(self, name).tolist()} for name, unit in arrays.items()}

    def csv_text(self) -> str:
        """Return one row for each mode and level as text, units in the heading."""
        rows: list[list[Any]] = [["mode", "acceleration [m/s^2]", "frequency [Hz]", "damping [%]", "error of slip [%]"]]
        for mode in range(self.frequencies.shape[1]):
            for k, level in enumerate(self.levels):
                numbers = (self.frequencies[k, mode], 100 * self.damping[k, mode], 100 * self.error[k, mode])
                rows.append([mode + 1, f"{level:.6g}", *(f"{one:.8g}" for one in numbers)])
        return csv_text(rows)

    def to_csv(self, path: str | Path) -> Path:
        """Write the rows of `csv_text`; the file appears complete or not at all."""
        return write_text(Path(path), self.csv_text())


def rows(curves: LevelCurves) -> list[list[str]]:
    """One row per mode: frequency and damping at levels a decade apart, or the first and the last."""
    steps = list(range(0, len(curves.levels), EACH_DECADE))
    shown = steps if len(steps) > 1 else [0, len(curves.levels) - 1]
    out = [["mode", *(f"{curves.levels[k]:.3g} m/s2" for k in shown)]]
    for mode in range(curves.frequencies.shape[1]):
        values = [(curves.frequencies[k, mode], 100 * curves.damping[k, mode]) for k in shown]
        out.append([str(mode + 1), *(f"{f:.2f}, {z:.3g}" for f, z in values)])
    return out


def balanced_rows(curves: LevelCurves, curve: Backbone) -> list[list[str]]:
    """One row per level that a curve by harmonic balance reaches: frequency and damping of both."""
    reached = (curve.acceleration[0] <= curves.levels) & (curves.levels <= curve.acceleration[-1])
    f, z = curve.at_acceleration(curves.levels[reached])
    own, damping, error = (rows[reached, curve.mode - 1] for rows in (curves.frequencies, curves.damping, curves.error))
    return in_columns(
        ("m/s2", curves.levels[reached], ".3g"),
        ("quick [Hz]", own, ".3f"),
        ("balanced [Hz]", f, ".3f"),
        ("quick [%]", 100 * damping, ".4g"),
        ("balanced [%]", 100 * z, ".4g"),
        ("error of quick [%]", 100 * error, ".2g"),
    )


@checked_call
def level_curves(
    study: Study | str | Path,
    friction: float | None = None,
    amplitude: tuple[float, float] | None = None,
    *,
    load: float | str | None = None,
    rest_damping: float | None = None,
    report: Report | None = None,
) -> LevelCurves:
    """Follow all modes of a study from small to large amplitudes, without harmonic balance.

    What is left out is taken from [backbone] of the study, or its default.

    Args:
        study: A Study or the path of its TOML file.
        friction: Coefficient [-] of all joints, 0 to 10; that of each joint in the study where left out.
        amplitude: First and last acceleration amplitude [m/s2] of the point that moves most.
        load: Preload of the first bolt [N], or text with a unit, one of the study's; the greatest by default.
        rest_damping: Ratio to critical [-] that is added to that of slip.
        report: Called with a stage, the stages done, and how many there are.

    Returns:
        The curves. Mean opening, lag and the harmonics 2 and 3 are corrected once in a pass; `backbone` solves them
        together.

    Raises:
        InputError: No friction is given, no law has a stiffness that slips, there is no such load.
        NotConverged: The preload or the modes are not found.

    Source:
        The first harmonic of a cycle of hysteresis as springs, equivalent linearisation: Caughey 1960,
        doi:10.1115/1.3644075.
    """
    study = Study.read_bolted(study)
    choice = chosen(study, friction, {"amplitude": amplitude, "rest_damping": rest_damping})
    if choice.rest_damping == "law":
        raise InputError('rest_damping = "law" is for harmonic balance; give a number here, such as 0.001')
    (mu,) = friction_of(study, replace(choice, friction=choice.friction[:1]))
    first, last = choice.amplitude
    levels = np.geomspace(first, last, max(2, round(EACH_DECADE * np.log10(last / first)) + 1))
    index = preload_index(study.loads, load, names=study.load_names)
    found = _bare(study, index, mu, tuple(levels.tolist()), report)
    if found.level_slip is None or found.level_frequencies is None or found.level_error is None:
        raise InputError("no joint can slip: its law has no tangential stiffness, or its springs are per node")
    rest = float(choice.rest_damping or 0.0)
    return LevelCurves(
        title=study.title,
        load=study.loads[index],
        friction=mu,
        levels=levels,
        frequencies=found.level_frequencies[0],
        damping=found.level_slip[0] + rest,
        error=found.level_error[0],
    )


def _bare(
    study: Study, index: int, friction: tuple[float, ...], levels: tuple[float, ...], report: Report | None
) -> Result:
    """The run of one load with the damping at levels, and without what it does not ask for."""
    joints = tuple(replace(joint, friction=mu) for joint, mu in zip(study.joints, friction, strict=True))
    preloads = study.preloads[index : index + 1]
    study = replace(bare(study), preloads=preloads, joints=joints, test=None)
    return run(replace(study, modes=replace(study.modes, levels=levels)), report=report)
