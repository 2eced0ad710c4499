"""What a preloaded structure does under its load cases: a record of arrays, on disk and back."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from faying.errors import InputError
from faying.joint.figure import DrawnFace, face_axes
from faying.misuse import checked_call, shortened
from faying.notes import Note
from faying.result.fields import Recorded, group, in_units, listed, optional, variable
from faying.result.groups import OuterStress
from faying.result.provenance import Provenance
from faying.style import headline, percent
from faying.typing import Array, Index
from faying.units import show

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MAX_CASES = 8  # that a summary has a line for
ENOUGH = 0.01  # departure from the linear answer up to which superposition does
MAPS = ("point", "node", "triangle")  # dimensions of what only a file holds, not the JSON


@dataclass(frozen=True, kw_only=True, eq=False)
class LoadIntervals:
    """90 % intervals of load cases: the lower and the upper bound of each answer.

    inputs: what scatters, in words.
    """

    inputs: tuple[str, ...]
    bolt_force: Array = variable("bound case bolt", "N", "force of the bolt", gaps=True)
    slip_use: Array = variable(
        "bound case joint", "1", "friction that the worst part needs, over its friction", gaps=True
    )
    head_use: Array = variable("bound case bolt", "1", "friction that a head needs, over its friction", gaps=True)
    opened: Array = variable("bound case joint", "1", "share of the joint that opens", gaps=True)
    check: Array = variable("case", "1", "greatest departure from first order, over the answer")

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
        "case", "1", "departure from the linear answer, over it: of displacement or force of a bolt"
    )
    displacement: Array = variable("case", "m", "greatest displacement of a node by the load")
    error: Array = variable("case", "1", "forces left over, over the load, in energy")
    bolt_force: Array = variable("case bolt", "N", "force of the bolt", "bolts/")
    bolt_preload: Array = variable("bolt", "N", "force of the bolt before any load", "bolts/")
    bolt_force_linear: Array = variable("case bolt", "N", "force of the bolt by superposition", "bolts/")
    bolt_moment: Array = variable(
        "case bolt", "N m", "greater bending moment of both ends of the bolt", "bolts/", gaps=True
    )
    bolt_shear: Array = variable("case bolt", "N", "force across the bolt at its head", "bolts/", gaps=True)
    working_load: Array = variable(
        "case bolt",
        "N",
        "load that pulls the parts apart through the cut that the bolt holds, F_A",
        "bolts/",
        gaps=True,
    )
    load_factor: Array = variable(
        "case bolt", "1", "change of the bolt's force over the working load", "bolts/", gaps=True
    )
    transverse_load: Array = variable(
        "case bolt", "N", "share of the bolt of what crosses its joints, by friction and by shanks, F_Q", "bolts/"
    )
    seat_pressure: Array = variable("case bolt", "Pa", "mean pressure on the smaller seat", "bolts/", gaps=True)
    head_friction: Array = variable("bolt", "1", "coefficient of friction under the head", "bolts/", gaps=True)
    head_friction_needed: Array = variable(
        "case bolt", "1", "force across the bolt over its force", "bolts/", gaps=True
    )
    cycles: Array = variable("case", "1", "how often the load comes and goes")
    stress_amplitude: Array = variable(
        "case bolt",
        "Pa",
        "half of the range of stress where it is greatest, from the start of the case",
        "bolts/",
        gaps=True,
    )
    damage: Array = variable("case bolt", "1", "damage by the cycles, 1 at failure", "bolts/", gaps=True)
    slide_motion: Array = variable("bolt", "m", "transverse motion of the head at which it slides", "bolts/", gaps=True)
    dowels: tuple[str, ...] = ()
    dowel_shear: Array | None = optional("case dowel", "N", "greatest shear force of the dowel by the load", "dowels/")
    dowel_bearing: Array | None = optional(
        "case dowel", "Pa", "greatest force on a wall by the load over diameter and depth of its hole", "dowels/"
    )
    parts: tuple[str, ...] = ()
    stress: Array | None = optional(
        "case part", "Pa", "greatest stress of von Mises in each part, with the preload", "parts/"
    )
    stress_place: Array | None = optional("case part axis", "m", "where it is", "parts/")
    stress_spread: Array | None = optional(
        "case part", "1", "deviation of the elements at this place from their mean, over the stress", "parts/"
    )
    normal_force: Array = variable("case joint", "N", "normal force on the joint", "joints/")
    normal_preload: Array = variable("joint", "N", "normal force on the joint before any load", "joints/")
    friction: Array = variable("joint", "1", "coefficient of friction", "joints/", gaps=True)
    shear_force: Array = variable("case joint", "N", "resultant of the shear on the joint by the load", "joints/")
    torque: Array = variable("case joint", "N m", "torque of the shear about the normal of the joint", "joints/")
    mean_pressure: Array = variable("case joint", "Pa", "mean pressure on the joint", "joints/")
    greatest_pressure: Array = variable("case joint", "Pa", "greatest pressure", "joints/")
    opened: Array = variable("case joint", "1", "share of the area in contact under preload that is open", "joints/")
    sliding: Array = variable("case joint", "1", "share of the area in contact that slides", "joints/", gaps=True)
    friction_needed: Array = variable(
        "case joint", "1", "shear over normal force of all of the joint", "joints/", gaps=True
    )
    friction_needed_worst: Array = variable("case joint", "1", "the same round the worst bolt", "joints/", gaps=True)
    worst_bolt: Index = variable("case joint", "1", "the bolt round which it is, from 0", "joints/", dtype="i8")
    dissipated: Array = variable("case joint", "J", "work of friction on the way to this load", "joints/")
    rest_frequency: Array | None = optional("mode", "Hz", "frequency under preload alone", "modes/")
    frequency: Array | None = optional("case mode", "Hz", "frequency of that mode under the load", "modes/")
    likeness: Array | None = optional("case mode", "1", "MAC of both shapes, weighted by mass", "modes/")
    positions: Array = variable("point axis", "m", "points of the joints", "points/")
    areas: Array = variable("point", "m2", "area of each point", "points/")
    joint_of_point: Index = variable("point", "1", "joint of each point, from 0", "points/", dtype="i8")
    rest_pressure: Array = variable("point", "Pa", "pressure before any load", "points/")
    pressure: Array = variable("case point", "Pa", "pressure", "points/")
    shear: Array = variable("case point", "Pa", "shear by the load", "points/")
    surface: OuterStress | None = group("surface")
    intervals: LoadIntervals | None = None
    notes: tuple[Note, ...] = ()
    provenance: Provenance = field(default_factory=Provenance)

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
    def head_motion(self) -> Array:
        """Transverse motion of each head over the motion at which it slides (case, bolt); NaN where not known."""
        return np.asarray(self.head_friction_needed / self.head_friction)

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
        return {
            "case": self.cases,
            "bolt": self.bolts,
            "joint": self.joints,
            "axis": ("x", "y", "z"),
            **({"part": self.parts} if self.parts else {}),
            **({"dowel": self.dowels} if self.dowels else {}),
            **({"state": self.surface.states} if self.surface else {}),
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
        for k, name in enumerate(self.cases[:MAX_CASES]):
            low, high = (show(float(one), "N") for one in (self.bolt_force[k].min(), self.bolt_force[k].max()))
            linear = "superposition holds" if self.superposes[k] else f"{self.superposition[k]:.0%} from superposition"
            rows[name] = f"bolts {low} to {high}, {self.opened[k].max():.1%} opens, {linear}"
        if len(self.cases) > MAX_CASES:
            rows["more cases"] = str(len(self.cases) - MAX_CASES)
        return head, rows

    def to_dict(self) -> dict[str, Any]:
        """Return all but the maps in SI units, for JSON; infinite margins are None."""
        names = ("slip_margin", "slip_margin_worst", "head_margin", "head_motion")
        margins = {name: getattr(self, name) for name in names}
        finite = {name: np.where(np.isfinite(one), one, np.nan) for name, one in margins.items()}
        return {
            "title": self.title,
            "preload": {"unit": "N", "values": self.preload},
            "cases": list(self.cases),
            "after": [one or None for one in self.after],
            **{name: list(getattr(self, name)) for name in ("bolts", "joints", "dowels", "parts")},
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
        if joint is not None and joint not in self.joints:
            raise InputError(f"joint = {shortened(joint)}; the joints are {', '.join(map(repr, self.joints))}")
        number = len(self.cases) - 1 if case is None else self.index(case)
        drawn = self.face(number, 0 if joint is None else self.joints.index(joint))
        return face_axes(drawn, ax)

    def face(self, case: int | None, joint: int, size: float = 1.0) -> DrawnFace:
        """A joint as it is drawn under a case, both counted from 0, or under the preload alone; size: of its points."""
        here = self.joint_of_point == joint
        pressures = np.vstack([self.rest_pressure[here], self.pressure[:, here]])
        title = "preload" if case is None else headline(self.cases[case], 14)
        opens = "" if case is None else f": {percent(float(self.opened[case, joint]))} opens"
        return DrawnFace(
            places=self.positions[here],
            triangles=None,
            values=pressures[0 if case is None else case + 1],
            most=float(pressures.max()),
            areas=size * self.areas[here],
            title=title + opens,
        )


def _margin(friction: Array, needed: Array) -> Array:
    """Friction over what is needed of it; infinite where nothing is, NaN where one of them is not known."""
    margin = np.where(needed > 0, friction / np.where(needed > 0, needed, 1.0), friction + np.inf)
    return np.asarray(np.where(np.isnan(needed), np.nan, margin))
