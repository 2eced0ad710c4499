"""What a preloaded structure does under its load cases: a record of arrays, on disk and back."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from faying.errors import InputError
from faying.misuse import checked_call, shortened
from faying.notes import Note
from faying.result.fields import Recorded, in_units, listed, variable
from faying.result.provenance import Provenance
from faying.typing import Array, Index
from faying.units import show

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_CASES = 8  # that a summary has a line for
ENOUGH = 0.01  # departure from the linear answer up to which superposition does
MAPS = ("point",)  # dimensions of what only a file holds, not the JSON


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadIntervals:
    """90 % intervals of load cases: the lower and the upper bound of each answer.

    inputs: what scatters, in words.
    """

    inputs: tuple[str, ...]
    bolt_force: Array = variable("bound", "case", "bolt", unit="N", long_name="force of the bolt", gaps=True)
    slip_use: Array = variable(
        "bound", "case", "joint", unit="1", long_name="friction that the worst part needs, over its friction", gaps=True
    )
    head_use: Array = variable(
        "bound", "case", "bolt", unit="1", long_name="friction that a head needs, over its friction", gaps=True
    )
    opened: Array = variable("bound", "case", "joint", unit="1", long_name="share of the joint that opens", gaps=True)
    check: Array = variable("case", unit="1", long_name="greatest departure from first order, over the answer")

    @property
    def slip_margin(self) -> Array:
        """Bounds of the margin against slip of the worst part (bound, case, joint)."""
        return _margin(np.ones_like(self.slip_use), self.slip_use)[::-1]

    @property
    def head_margin(self) -> Array:
        """Bounds of the margin against slip of each head (bound, case, bolt)."""
        return _margin(np.ones_like(self.head_use), self.head_use)[::-1]


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class LoadCases(Recorded):
    """Answers of a preloaded structure to load cases; NaN stands for what is not known.

    title: of the study; preload [N]: of the first bolt; cases, bolts, joints, dowels: names; after: the case from whose
    state each one starts, "" for the preload; friction: of each joint, NaN where it sticks; notes: what is to be said.
    """

    KIND: ClassVar[str] = "load cases"
    COMMAND: ClassVar[str] = "faying loads STUDY.toml --out loads.nc"

    title: str
    preload: float
    cases: tuple[str, ...]
    after: tuple[str, ...]
    bolts: tuple[str, ...]
    joints: tuple[str, ...]
    superposition: Array = variable(
        "case", unit="1", long_name="departure from the linear answer, over it: of displacement or force of a bolt"
    )
    displacement: Array = variable("case", unit="m", long_name="greatest displacement of a node by the load")
    error: Array = variable("case", unit="1", long_name="forces left over, over the load, in energy")
    bolt_force: Array = variable("case", "bolt", unit="N", long_name="force of the bolt", group="bolts")
    bolt_preload: Array = variable("bolt", unit="N", long_name="force of the bolt before any load", group="bolts")
    bolt_force_linear: Array = variable(
        "case", "bolt", unit="N", long_name="force of the bolt by superposition", group="bolts"
    )
    bolt_moment: Array = variable(
        "case",
        "bolt",
        unit="N m",
        long_name="greater bending moment of both ends of the bolt",
        group="bolts",
        gaps=True,
    )
    bolt_shear: Array = variable(
        "case", "bolt", unit="N", long_name="force across the bolt at its head", group="bolts", gaps=True
    )
    working_load: Array = variable(
        "case", "bolt", unit="N", long_name="load that pulls the parts apart at the bolt, F_A", group="bolts"
    )
    load_factor: Array = variable(
        "case", "bolt", unit="1", long_name="change of the bolt's force over the working load", group="bolts", gaps=True
    )
    transverse_load: Array = variable(
        "case", "bolt", unit="N", long_name="load across the bolt that its part of the joint carries", group="bolts"
    )
    seat_pressure: Array = variable(
        "case", "bolt", unit="Pa", long_name="mean pressure on the smaller seat", group="bolts", gaps=True
    )
    head_friction: Array = variable(
        "bolt", unit="1", long_name="coefficient of friction under the head", group="bolts", gaps=True
    )
    head_friction_needed: Array = variable(
        "case", "bolt", unit="1", long_name="force across the bolt over its force", group="bolts", gaps=True
    )
    dowels: tuple[str, ...] = ()
    dowel_shear: Array | None = variable(
        "case",
        "dowel",
        unit="N",
        long_name="greatest shear force of the dowel by the load",
        group="dowels",
        default=None,
    )
    dowel_bearing: Array | None = variable(
        "case",
        "dowel",
        unit="Pa",
        long_name="greatest force on a wall by the load over diameter and depth of its hole",
        group="dowels",
        default=None,
    )
    normal_force: Array = variable("case", "joint", unit="N", long_name="normal force on the joint", group="joints")
    normal_preload: Array = variable(
        "joint", unit="N", long_name="normal force on the joint before any load", group="joints"
    )
    friction: Array = variable("joint", unit="1", long_name="coefficient of friction", group="joints", gaps=True)
    shear_force: Array = variable(
        "case", "joint", unit="N", long_name="resultant of the shear on the joint by the load", group="joints"
    )
    torque: Array = variable(
        "case", "joint", unit="N m", long_name="torque of the shear about the normal of the joint", group="joints"
    )
    mean_pressure: Array = variable("case", "joint", unit="Pa", long_name="mean pressure on the joint", group="joints")
    greatest_pressure: Array = variable("case", "joint", unit="Pa", long_name="greatest pressure", group="joints")
    opened: Array = variable(
        "case", "joint", unit="1", long_name="share of the area in contact under preload that is open", group="joints"
    )
    sliding: Array = variable(
        "case", "joint", unit="1", long_name="share of the area in contact that slides", group="joints", gaps=True
    )
    friction_needed: Array = variable(
        "case", "joint", unit="1", long_name="shear over normal force of all of the joint", group="joints", gaps=True
    )
    friction_needed_worst: Array = variable(
        "case", "joint", unit="1", long_name="the same round the worst bolt", group="joints", gaps=True
    )
    worst_bolt: Index = variable(
        "case", "joint", unit="1", long_name="the bolt round which it is, from 0", dtype="i8", group="joints"
    )
    dissipated: Array = variable(
        "case", "joint", unit="J", long_name="work of friction on the way to this load", group="joints"
    )
    rest_frequency: Array | None = variable(
        "mode", unit="Hz", long_name="frequency under preload alone", group="modes", default=None
    )
    frequency: Array | None = variable(
        "case",
        "mode",
        unit="Hz",
        long_name="frequency of that mode under the load",
        group="modes",
        default=None,
    )
    likeness: Array | None = variable(
        "case", "mode", unit="1", long_name="MAC of both shapes, weighted by mass", group="modes", default=None
    )
    positions: Array = variable("point", "axis", unit="m", long_name="points of the joints", group="points")
    areas: Array = variable("point", unit="m2", long_name="area of each point", group="points")
    joint_of_point: Index = variable(
        "point", unit="1", long_name="joint of each point, from 0", dtype="i8", group="points"
    )
    rest_pressure: Array = variable("point", unit="Pa", long_name="pressure before any load", group="points")
    pressure: Array = variable("case", "point", unit="Pa", long_name="pressure", group="points")
    shear: Array = variable("case", "point", unit="Pa", long_name="shear by the load", group="points")
    intervals: LoadIntervals | None = None
    notes: tuple[Note, ...] = ()
    provenance: Provenance = field(default_factory=lambda: Provenance(study="", files={}, versions={}, date=""))

    @property
    def slip_margin(self) -> Array:
        """Friction over the shear that it carries (case, joint), of each whole joint; NaN where it sticks."""
        return _margin(self.friction, self.friction_needed)

    @property
    def slip_margin_worst(self) -> Array:
        """The same round the bolt where it is least (case, joint)."""
        return _margin(self.friction, self.friction_needed_worst)

    @property
    def head_margin(self) -> Array:
        """Friction under each head over the force across the bolt (case, bolt); NaN where one is not known."""
        return _margin(self.head_friction, self.head_friction_needed)

    @property
    def superposes(self) -> Any:
        """Whether the linear answer would have done, to 1 % (case,)."""
        return self.superposition <= ENOUGH

    @property
    def frequency_change(self) -> Array | None:
        """Relative change of each frequency by the load (case, mode) [-]; None where no modes were asked for."""
        if self.frequency is None or self.rest_frequency is None:
            return None
        return np.asarray(self.frequency / self.rest_frequency - 1)

    def labels(self) -> dict[str, Any]:
        """Labels of the dimensions."""
        modes = {} if self.rest_frequency is None else {"mode": np.arange(1, len(self.rest_frequency) + 1)}
        dowels = {"dowel": self.dowels} if self.dowels else {}
        return {
            "case": self.cases,
            "bolt": self.bolts,
            "joint": self.joints,
            "axis": ("x", "y", "z"),
            **dowels,
            **modes,
        }

    def index(self, case: str) -> int:
        """Return the number of a case, from 0. Raises InputError that lists the cases."""
        if case not in self.cases:
            raise InputError(f"case = {shortened(case)}; the cases are {', '.join(map(repr, self.cases))}")
        return self.cases.index(case)

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and for each case the bolt forces, opening, slip and whether superposition holds."""
        head = f"Load cases of {self.title} at {show(self.preload, 'N')}: {len(self.bolts)} bolts, "
        head += f"{len(self.joints)} joint{'s' * (len(self.joints) > 1)}"
        rows = {}
        for k, name in enumerate(self.cases[:MOST_CASES]):
            low, high = (show(float(one), "N") for one in (self.bolt_force[k].min(), self.bolt_force[k].max()))
            linear = "superposition holds" if self.superposes[k] else f"{self.superposition[k]:.0%} from superposition"
            rows[name] = f"bolts {low} to {high}, {self.opened[k].max():.1%} opens, {linear}"
        if len(self.cases) > MOST_CASES:
            rows["more cases"] = str(len(self.cases) - MOST_CASES)
        return head, rows

    def to_dict(self) -> dict[str, Any]:
        """Return all but the maps in SI units, for JSON; infinite margins are None."""
        margins = {name: getattr(self, name) for name in ("slip_margin", "slip_margin_worst", "head_margin")}
        finite = {name: np.where(np.isfinite(one), one, np.nan) for name, one in margins.items()}
        return {
            "title": self.title,
            "preload": {"unit": "N", "values": self.preload},
            "cases": list(self.cases),
            "after": [one or None for one in self.after],
            "bolts": list(self.bolts),
            "joints": list(self.joints),
            "dowels": list(self.dowels),
            **in_units(self, without=MAPS),
            **{name: {"unit": "1", "values": listed(one)} for name, one in finite.items()},
            "intervals": None
            if self.intervals is None
            else {"inputs": list(self.intervals.inputs), **in_units(self.intervals)},
            "superposition_does": [bool(one) for one in self.superposes],
            "notes": [note.text for note in self.notes],
        }

    @checked_call
    def plot(self, case: str | None = None, joint: str | None = None, ax: "Axes | None" = None) -> "Axes":
        """Draw the pressure on a joint under a case.

        Args:
            case: Its name; the last one where None.
            joint: Name of the joint; the first one where None.
            ax: Matplotlib axes to draw into; new ones where None.

        Returns:
            The axes.

        Raises:
            InputError: There is no such case or joint.
        """
        from faying.result.load_cases_figure import case_axes

        if joint is not None and joint not in self.joints:
            raise InputError(f"joint = {shortened(joint)}; the joints are {', '.join(map(repr, self.joints))}")
        number = len(self.cases) - 1 if case is None else self.index(case)
        return case_axes(self, number, 0 if joint is None else self.joints.index(joint), ax)


def _margin(friction: Array, needed: Array) -> Array:
    """Friction over what is needed of it; infinite where nothing is, NaN where one of them is not known."""
    margin = np.where(needed > 0, friction / np.where(needed > 0, needed, 1.0), friction + np.inf)
    return np.asarray(np.where(np.isnan(needed), np.nan, margin))
