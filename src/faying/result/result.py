"""The result of a study: frozen arrays with names, dimensions and units, and the facts that they belong to."""

import csv
import io
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from faying.errors import InputError, ReadError
from faying.files import write_text
from faying.joint.attachments import PointMass, Support
from faying.joint.preload_case import preload_index
from faying.measured.compare import ModalComparison
from faying.measured.model import FullResponse, ModelModes
from faying.misuse import checked_call, shortened
from faying.notes import Note, grouped
from faying.result.backbone import Backbone
from faying.result.bolts import BoltNumbers
from faying.result.fields import Recorded, in_units, load_texts, variable
from faying.result.interval import Interval
from faying.result.provenance import Provenance
from faying.text import listed
from faying.typing import Array, Complex, Index

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Point = tuple[float, float, float]
MOST_LOADS, MOST_MODES = 4, 5  # that a summary has a column and a line for
MAPS = ("point", "node", "triangle", "mode_other")  # dimensions of what only a file holds, not the JSON


def preload_slope(values: Array, loads: Array) -> Array:
    """Change with preload [value/N] (mode,) of values (load, mode), by a straight line; NaN for a single load."""
    if len(loads) < 2:
        return np.full(values.shape[1], np.nan)
    about = loads - loads.mean()
    return np.asarray(about @ values / (about @ about))


@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredComparison:
    """Listed frequencies of a hammer test beside the study's, and the mode (from 0) that each was paired with."""

    source: str
    frequencies: Array = variable("load", "test_mode", unit="Hz", long_name="measured frequencies")
    predicted: Array = variable("load", "test_mode", unit="Hz", long_name="frequencies of the paired modes", gaps=True)
    modes: Index = variable("load", "test_mode", unit="1", long_name="index of the paired mode, -1: none", dtype="i8")
    published: Array | None = variable(
        "load", "test_mode", unit="Hz", long_name="frequencies of a published model", default=None
    )
    published_name: str = "published"
    alternatives: Array | None = variable(
        "law",
        "load",
        "test_mode",
        unit="Hz",
        long_name="frequencies under another law",
        gaps=True,
        name="predicted_by_law",
        default=None,
    )
    kind: str = "test"  # or "model", where the frequencies are those of somebody's model

    @property
    def reference(self) -> str:
        """What tables and figures call the frequencies that ours are set beside."""
        return "test" if self.kind == "test" else "reference model"


@dataclass(frozen=True, kw_only=True, eq=False)
class Receptance:
    """Frequency response at every load; error: the largest of the residuals that were checked [-]."""

    frequencies: Array = variable("response_frequency", unit="Hz", long_name="frequencies of the response")
    values: Complex = variable(
        "load", "response_frequency", "output", "input", unit="m/N", long_name="receptance", dtype="c16"
    )
    input_points: Array = variable("input", "axis", unit="m", long_name="points of the forces")
    input_directions: Array = variable("input", "axis", unit="1", long_name="directions of the forces")
    output_points: Array = variable("output", "axis", unit="m", long_name="points of the motion")
    output_directions: Array = variable("output", "axis", unit="1", long_name="directions of the motion")
    error: Array = variable("load", unit="1", long_name="largest residual of the full equations that was checked")
    bolt_forces: Complex | None = variable(
        "load",
        "response_frequency",
        "bolt",
        "input",
        unit="1",
        long_name="force in each bolt per force, 0 for a bolt without a shank",
        dtype="c16",
        default=None,
    )

    @property
    def inputs(self) -> tuple[tuple[Point, Point], ...]:
        """Point [m] and direction of each force."""
        return _pairs(self.input_points, self.input_directions)

    @property
    def outputs(self) -> tuple[tuple[Point, Point], ...]:
        """Point [m] and direction of each motion."""
        return _pairs(self.output_points, self.output_directions)


def _pairs(points: Array, directions: Array) -> tuple[tuple[Point, Point], ...]:
    return tuple((tuple(p), tuple(d)) for p, d in zip(points.tolist(), directions.tolist(), strict=True))


@checked_call
@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class Result(Recorded):
    """What a study gives. Load [N] means the preload of the first bolt; modes are the elastic ones.

    Frequencies, loss factors and shapes are those of the complex modes; "bonded" are the frequencies with the faces of
    every joint bonded, "free" those with the faces apart. `surfaces` and `laws` hold, per joint, what the law
    was made from and its own numbers. low and high: the frequencies at the ends of the range of stiffness that the laws
    state, None where none states one; `alternatives` names other laws, their frequencies are `alternative_frequencies`.
    `backbones` are the curves over amplitude that the study asks for, at the greatest preload.
    `tightening` names the bolts in the order in which they were pulled, and is empty where all were pulled at once.
    `parts`, `faces`, `joint_faces` (the two faces of each joint), `supports` and `masses` say what the structure is
    made of; they and the fields that go with them are empty or None in files of earlier versions.
    """

    KIND: ClassVar[str] = "result"
    COMMAND: ClassVar[str] = "faying run STUDY.toml"

    title: str
    loads: Array = variable("load", unit="N", long_name="preload of the first bolt", name="preload", before="load")
    frequencies: Array = variable("load", "mode", unit="Hz", long_name="frequency", group="modes", name="frequency")
    loss_factors: Array = variable(
        "load",
        "mode",
        unit="1",
        long_name="loss factor, NaN where no joint predicts one",
        gaps=True,
        group="modes",
        name="loss_factor",
    )
    loss_error: Array = variable(
        "load",
        "mode",
        unit="1",
        long_name="estimated relative error of the loss factor",
        group="modes",
        name="loss_factor_error",
    )
    free: Array = variable("mode", unit="Hz", long_name="frequency with the faces apart", group="modes")
    bonded: Array = variable("mode", unit="Hz", long_name="frequency with the faces bonded", group="modes")
    rigid: Array = variable(
        "rigid_motion", unit="Hz", long_name="largest frequency of each rigid motion, ideally 0", group="modes"
    )
    mac: Array = variable(
        "load",
        "mode",
        "mode_other",
        unit="1",
        long_name="MAC by mass of the modes at the first load with those at each",
        group="modes",
    )
    points: Array = variable(
        "point", "axis", unit="m", long_name="points of the joints", group="points", name="position"
    )
    weights: Array = variable("point", unit="m2", long_name="area of each point", group="points", name="area")
    joint_of_point: Index = variable(
        "point", unit="1", long_name="joint of each point, from 0", dtype="i8", group="points", name="joint_number"
    )
    pressure: Array = variable("load", "point", unit="Pa", long_name="contact pressure", group="points")
    k_n: Array = variable(
        "load", "point", unit="Pa/m", long_name="normal stiffness per area, as assembled", group="points"
    )
    k_t: Array = variable(
        "load", "point", unit="Pa/m", long_name="tangential stiffness per area, as assembled", group="points"
    )
    slipping: Array = variable(
        "load",
        "joint",
        unit="1",
        long_name="share of the area at the limit of friction",
        group="joints",
        name="slipping_share",
    )
    total_k_n: Array = variable(
        "load", "joint", unit="N/m", long_name="sum of the normal springs", group="joints", name="k_n"
    )
    total_k_t: Array = variable(
        "load", "joint", unit="N/m", long_name="sum of the tangential springs", group="joints", name="k_t"
    )
    bolt_forces: Array = variable(
        "load", "bolt", unit="N", long_name="force left when all bolts are tight", group="bolts", name="force"
    )
    imbalance: Array = variable(
        "load", unit="1", long_name="residual force of the preload over the load", group="solution"
    )
    newton_steps: Index = variable(
        "load", unit="1", long_name="Newton steps of the preload", dtype="i8", group="solution"
    )
    outline: Array = variable(
        "node", "axis", unit="m", long_name="nodes of the outer surface", group="surface", name="position"
    )
    triangles: Index = variable(
        "triangle", "corner", unit="1", long_name="triangles between them", dtype="i8", group="surface"
    )
    shapes: Any = variable(
        "load",
        "mode",
        "node",
        "axis",
        unit="kg^-1/2",
        long_name="mass-normalised mode shapes",
        dtype="f4",
        group="surface",
        name="shape",
    )
    shapes_imaginary: Any = variable(
        "load",
        "mode",
        "node",
        "axis",
        unit="kg^-1/2",
        long_name="imaginary part of the complex mode shapes, scaled as shapes: the motion is the real part of "
        "(shapes + i shapes_imaginary) exp(i phase)",
        dtype="f4",
        default=None,
        group="surface",
        name="shape_imaginary",
    )
    part_of_triangle: Index | None = variable(
        "triangle", unit="1", long_name="part of each triangle, from 0", dtype="i8", default=None, group="surface"
    )
    face_of_triangle: Index | None = variable(
        "triangle",
        unit="1",
        long_name="named face of each triangle, from 0, -1: none",
        dtype="i8",
        default=None,
        group="surface",
    )
    part_masses: Array | None = variable(
        "part",
        unit="kg",
        long_name="mass of each part, without bolts and point masses",
        default=None,
        group="parts",
        name="mass",
    )
    slip: Array | None = variable(
        "load",
        "point",
        unit="m",
        long_name="tangential displacement of the second face against the first under the preload",
        default=None,
        group="points",
    )
    gap: Array | None = variable(
        "point",
        unit="m",
        long_name="distance of the faces before any load, form included",
        default=None,
        group="points",
    )
    bolt_seats: Array | None = variable(
        "bolt",
        "end",
        "axis",
        unit="m",
        long_name="where the axis of each bolt meets its seats",
        default=None,
        group="bolts",
        name="seat",
    )
    bolt_diameters: Array | None = variable(
        "bolt",
        unit="m",
        long_name="diameter of each shank, NaN where none is given",
        gaps=True,
        default=None,
        group="bolts",
        name="diameter",
    )
    bolt_extents: Array | None = variable(
        "bolt",
        "edge",
        unit="m",
        long_name="inner and outer diameter of the seat of each bolt, NaN for a bolt that is a part",
        gaps=True,
        default=None,
        group="bolts",
        name="seat_diameter",
    )
    dowel_ends: Array | None = variable(
        "dowel",
        "end",
        "axis",
        unit="m",
        long_name="where each dowel begins and ends",
        default=None,
        group="dowels",
        name="ends",
    )
    dowel_diameters: Array | None = variable(
        "dowel", unit="m", long_name="diameter of each dowel", default=None, group="dowels", name="diameter"
    )
    dowel_shear: Array | None = variable(
        "load",
        "dowel",
        unit="N",
        long_name="greatest shear force of the dowel when all bolts are tight",
        default=None,
        group="dowels",
        name="shear",
    )
    outside_share: Array = variable(
        "load",
        unit="1",
        long_name="share of the joints' stiffness where their law is outside its validity range",
        group="joints",
    )
    above_range_share: Array = variable(
        "load",
        unit="1",
        long_name="share of the joints above the end of their law",
        group="joints",
        name="above_range_share",
    )
    low: Array | None = variable(
        "load",
        "mode",
        unit="Hz",
        long_name="frequency at the lower end of the laws' range",
        default=None,
        group="modes",
        name="frequency_low",
    )
    high: Array | None = variable(
        "load",
        "mode",
        unit="Hz",
        long_name="frequency at the upper end of the laws' range",
        default=None,
        group="modes",
        name="frequency_high",
    )
    interval_low: Array | None = variable(
        "load",
        "mode",
        unit="Hz",
        long_name="5 % of the frequency, of all that is not known",
        default=None,
        group="modes",
    )
    interval_high: Array | None = variable(
        "load",
        "mode",
        unit="Hz",
        long_name="95 % of the frequency, of all that is not known",
        default=None,
        group="modes",
    )
    interval_offsets: Array | None = variable(
        "source",
        "end",
        "load",
        "mode",
        unit="1",
        long_name="change of ln f at 5 and at 95 % of one thing that is not known",
        default=None,
        group="modes",
    )
    mesh_error: Array | None = variable(
        "load",
        "mode",
        unit="1",
        long_name="estimated relative error of the frequency by the mesh",
        default=None,
        group="modes",
    )
    levels: Array | None = variable(
        "level",
        unit="m/s2",
        long_name="peak acceleration of the point that moves most",
        default=None,
        group="modes",
        name="level_acceleration",
    )
    level_frequencies: Array | None = variable(
        "load", "level", "mode", unit="Hz", long_name="frequency at a level", default=None, group="modes"
    )
    level_damping: Array | None = variable(
        "load", "level", "mode", unit="1", long_name="damping ratio at a level", default=None, group="modes"
    )
    level_low: Array | None = variable(
        "load", "level", "mode", unit="1", long_name="lower end of damping at a level", default=None, group="modes"
    )
    level_high: Array | None = variable(
        "load", "level", "mode", unit="1", long_name="upper end of damping at a level", default=None, group="modes"
    )
    level_slip: Array | None = variable(
        "load", "level", "mode", unit="1", long_name="damping by slip at a level", default=None, group="modes"
    )
    level_error: Array | None = variable(
        "load", "level", "mode", unit="1", long_name="error of damping by slip", default=None, group="modes"
    )
    above_range_frequencies: Array | None = variable(
        "load",
        "mode",
        unit="Hz",
        long_name="frequency with what is above the law's end bonded",
        default=None,
        group="modes",
        name="frequency_bonded_above",
    )
    above_range_loss_factors: Array | None = variable(
        "load",
        "mode",
        unit="1",
        long_name="loss factor with what is above the law's end bonded",
        gaps=True,
        default=None,
        group="modes",
        name="loss_factor_bonded_above",
    )
    wave_seeds: Index | None = variable(
        "draw",
        unit="1",
        long_name="draws of waves on the faces, by their seed",
        dtype="i8",
        default=None,
        group="waves",
        name="seed",
    )
    wave_frequencies: Array | None = variable(
        "draw",
        "load",
        "mode",
        unit="Hz",
        long_name="frequency with waves on the faces",
        default=None,
        group="waves",
        name="frequency",
    )
    wave_slopes: Array | None = variable(
        "draw",
        "mode",
        unit="Hz/N",
        long_name="change of frequency with preload with waves",
        default=None,
        group="waves",
        name="slope",
    )
    wave_rms: Array | None = variable(
        "joint",
        unit="m",
        long_name="rms of the waves of each face, NaN where none are drawn",
        gaps=True,
        default=None,
        group="waves",
        name="rms",
    )
    wave_lengths: Array | None = variable(
        "joint",
        "end",
        unit="m",
        long_name="shortest and longest wave that is drawn, NaN where none are",
        gaps=True,
        default=None,
        group="waves",
        name="wave_length",
    )
    alternative_frequencies: Array | None = variable(
        "law",
        "load",
        "mode",
        unit="Hz",
        long_name="frequency under another law",
        gaps=True,
        default=None,
        group="laws",
        name="frequency",
    )
    alternative_loss_factors: Array | None = variable(
        "law",
        "load",
        "mode",
        unit="1",
        long_name="loss factor under another law",
        gaps=True,
        default=None,
        group="laws",
        name="loss_factor",
    )
    alternative_above_range_frequencies: Array | None = variable(
        "law",
        "load",
        "mode",
        unit="Hz",
        long_name="frequency under another law with what is above its end bonded",
        gaps=True,
        default=None,
        group="laws",
        name="frequency_bonded_above",
    )
    alternative_outside_share: Array | None = variable(
        "law",
        "load",
        unit="1",
        long_name="share of the joints' stiffness where another law is outside its validity range",
        gaps=True,
        default=None,
        group="laws",
        name="outside_share",
    )
    alternative_above_range_share: Array | None = variable(
        "law",
        "load",
        unit="1",
        long_name="share of the joints above the end of another law",
        gaps=True,
        default=None,
        group="laws",
        name="above_range_share",
    )
    alternative_reach: Array | None = variable(
        "law",
        unit="Pa",
        long_name="pressure at which another law ends",
        gaps=True,
        default=None,
        group="laws",
        name="end_pressure",
    )
    thermal_conductance: Array | None = variable(
        "load",
        "joint",
        unit="W/K",
        long_name="conductance of heat, clean metal in vacuum",
        gaps=True,
        default=None,
        group="joints",
    )
    electrical_conductance: Array | None = variable(
        "load",
        "joint",
        unit="S",
        long_name="conductance of current, clean metal",
        gaps=True,
        default=None,
        group="joints",
    )
    interval_sources: tuple[str, ...] = ()
    alternatives: tuple[str, ...] = ()
    joints: tuple[str, ...]
    bolts: tuple[str, ...]
    dowels: tuple[str, ...] = ()
    parts: tuple[str, ...] = ()
    faces: tuple[str, ...] = ()
    joint_faces: tuple[tuple[str, str], ...] = ()
    supports: tuple[Support, ...] = ()
    masses: tuple[PointMass, ...] = ()
    unknowns: int
    solver: str
    factor_memory: float = 0.0
    damping: str = "hysteretic"
    tightening: tuple[str, ...] = ()
    surfaces: tuple[dict[str, Any], ...] = ()
    laws: tuple[dict[str, Any], ...] = ()
    sources: tuple[str, ...] = ()
    notes: tuple[Note, ...] = ()
    response: Receptance | None = None
    comparison: MeasuredComparison | None = None
    hammer: ModalComparison | None = None
    bolt_numbers: BoltNumbers | None = None
    backbones: tuple[Backbone, ...] = ()
    provenance: Provenance = field(default_factory=Provenance)

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and what the result says, with the first modes."""
        head = (
            f"Result {self.title!r}: {self.unknowns:,} unknowns, {len(self.free)} modes at {len(self.loads)} preloads"
        )
        laws = dict.fromkeys(str(law.get("law", law.get("name", ""))) for law in self.laws)
        rows = {"joints": listed(self.joints) + (f" ({listed(filter(None, laws))})" if any(laws) else "")}
        rows["bolts"] = listed(self.bolts)
        rows |= {"dowels": listed(self.dowels)} if self.dowels else {}
        few = list(range(len(self.loads))) if len(self.loads) <= MOST_LOADS else [0, len(self.loads) // 2, -1]
        words = load_texts(self.loads)
        rows["frequencies"] = f"[Hz] free | {' | '.join(words[k] for k in few)} | bonded"
        shown = len(self.free) if len(self.free) <= MOST_MODES else MOST_MODES - 1
        for mode in range(shown):
            cells = (self.free[mode], *(self.frequencies[k, mode] for k in few), self.bonded[mode])
            rows[f"mode {mode + 1}"] = " | ".join(f"{value:8.2f}" for value in cells)
        if len(self.free) > shown:
            rows["more modes"] = f"{len(self.free) - shown}, up to {self.frequencies[-1, -1]:.2f} Hz"
        if self.comparison is not None:
            c = self.comparison
            error = np.abs(c.predicted / c.frequencies - 1)
            paired = np.isfinite(error)
            mean = f", mean deviation {np.mean(error[paired]):.2%}" if paired.any() else ""
            rows[c.reference] = f"{paired.sum()} of {paired.size} frequencies paired{mean}"
        return head, rows | ({"notes": f"{len(self.notes)}, in .notes"} if self.notes else {})

    @checked_call
    def plot(self, modes: int = 6, ax: Any = None) -> "list[Axes]":
        """Draw the frequency of each mode against preload.

        5 to 95 % are bands; without intervals the range that the laws state. Frequencies of the test are hollow dots.

        Args:
            modes: How many modes, from the lowest.
            ax: As many matplotlib axes to draw into, in a list or an array; new ones where None.

        Returns:
            The axes, one for each mode.

        Raises:
            InputError: The number of modes or of axes does not fit.
        """
        from faying.result.figure import frequency_axes

        if modes < 1:
            raise InputError(f"modes = {shortened(modes)}; give how many modes, 1 to {len(self.free)}")
        return frequency_axes(self, min(modes, len(self.free)), ax)

    @property
    def warnings(self) -> tuple[str, ...]:
        """The notes as sentences, those that differ in load and share alone as one; see `faying.notes.grouped`."""
        return tuple(note.text for note in grouped(self.notes))

    def open_share(self) -> Array:
        """Share of the joints' area that carries nothing [-] (l,)."""
        return np.asarray((self.pressure <= 0) @ self.weights / self.weights.sum())

    def response_at(self, load: int) -> FullResponse | None:
        """The frequency response at one load (its index) as a comparison with a test takes it."""
        r = self.response
        if r is None:
            return None
        return FullResponse(
            frequency=r.frequencies,
            receptance=r.values[load].transpose(1, 2, 0),
            outputs=(r.output_points, r.output_directions),
            inputs=(r.input_points, r.input_directions),
        )

    @checked_call
    def refuse_strays(self) -> None:
        """Raise ReadError where triangles name nodes, parts or faces that there are not, as in a damaged file."""
        for name, indices, count in (
            ("triangles", self.triangles, len(self.outline)),
            ("part_of_triangle", self.part_of_triangle, np.inf),
            ("face_of_triangle", self.face_of_triangle, np.inf),
        ):
            if indices is not None and indices.size and not (indices.min() >= -1 and indices.max() < count):
                raise ReadError(
                    f"its {name} run from {indices.min()} to {indices.max()}, past the end of those in the file"
                )

    @checked_call
    def modes_at(self, load: float | str | None = None, source: str = "this study") -> ModelModes:
        """The modes at a preload [N], by default the greatest, for a comparison with a test.

        Raises InputError where there is no such load.
        """
        index = preload_index(self.loads, load, name="load", of=source)
        return ModelModes(
            frequencies=self.frequencies[index],
            loss_factors=self.loss_factors[index],
            shapes=self.shapes[index].astype(float),
            points=self.outline,
            triangles=self.triangles,
            load=float(self.loads[index]),
            title=self.title,
            source=source,
            full=self.response_at(index),
        )

    def to_dict(self) -> dict[str, Any]:
        """Return the numbers a reader wants, ready for JSON: {"unit", "values"} in SI; maps and shapes are left out."""
        out: dict[str, Any] = {"title": self.title, "unknowns": self.unknowns, "solver": self.solver}
        out["factor_memory"] = {"unit": "B", "values": self.factor_memory}
        out |= in_units(self, without=MAPS)
        out["greatest_pressure"] = {"unit": "Pa", "values": self.pressure.max(axis=1).tolist()}
        out["open_share"] = {"unit": "1", "values": self.open_share().tolist()}
        out["interval_sources"], out["alternatives"] = list(self.interval_sources), list(self.alternatives)
        out["parts"] = list(self.parts)
        out["dowels"] = list(self.dowels)
        out |= {"joints": list(self.joints), "bolts": list(self.bolts), "tightening": list(self.tightening)}
        out |= {"damping": self.damping, "surfaces": list(self.surfaces), "laws": list(self.laws)}
        if self.comparison is not None:
            c = self.comparison
            facts = {"source": c.source, "published_name": c.published_name, "kind": c.kind}
            out["comparison"] = facts | in_units(c)
        if self.bolt_numbers is not None:
            out["bolt_numbers"] = in_units(self.bolt_numbers)
        if self.hammer is not None:
            out["hammer_test"] = self.hammer.to_dict()
        if self.backbones:
            out["backbones"] = [curve.to_dict() for curve in self.backbones]
        out["sources"] = list(self.sources)
        out["notes"] = [asdict(note) for note in self.notes]
        return out

    def labels(self) -> dict[str, Any]:
        """Labels of the dimensions of its arrays, by the name of the dimension."""
        out: dict[str, Any] = {"load": load_texts(self.loads), "mode": np.arange(1, len(self.free) + 1)}
        out |= {"joint": self.joints, "bolt": self.bolts, "axis": ("x", "y", "z")}
        out |= {"part": self.parts} if self.parts else {}
        out |= {"dowel": self.dowels} if self.dowels else {}
        out |= {"source": self.interval_sources} if self.interval_sources else {}
        return out | ({"law": self.alternatives} if self.alternatives else {})

    @property
    def interval(self) -> Interval | None:
        """What makes the interval of each frequency; None in a result without one."""
        if self.interval_offsets is None:
            return None
        return Interval(sources=self.interval_sources, offsets=self.interval_offsets)

    def to_csv(self, path: str | Path) -> Path:
        """Write one row for each load and mode, units in the heading; the file appears complete or not at all."""
        return write_text(Path(path), self.csv_text())

    @checked_call
    def save_vtu(self, path: str | Path) -> list[Path]:
        """Write files for ParaView: NAME.pvd, which is opened, and one .vtu for each preload.

        Each holds the outer surface with every mode shape, real and imaginary, and the first face of each joint with
        pressure, gap, slip, k_n and k_t in SI units, NaN elsewhere; part, face and joint of each triangle, from 0, -1
        where there is none; preload, frequencies and loss factors. ParaView's time is the preload [N].

        Args:
            path: NAME.pvd or NAME.vtu; a folder that is not there is made.

        Returns:
            The paths of all files, the .pvd first.

        Raises:
            InputError: the name ends in something else, or a file cannot be written.
        """
        from faying.result.vtu import write_vtu

        return write_vtu(self, path)

    def show(self, *, height: int = 620) -> Any:
        """Show the structure in a notebook: moving modes, maps of the joints, faces to click, as `faying view` does.

        Args:
            height: of the view [pixels], 200 to 4000.

        Returns:
            What a notebook shows as the last line of a cell; its `save` writes it as a page.

        Raises:
            InputError: the height does not fit.
        """
        import faying

        return faying.view(self, height=height)

    def csv_text(self) -> str:
        """Return the rows of to_csv as text."""
        out = io.StringIO()
        rows = csv.writer(out, lineterminator="\n")
        columns = [
            ("frequency", self.frequencies),
            ("loss factor", self.loss_factors),
            ("free", np.broadcast_to(self.free, self.frequencies.shape)),
            ("bonded", np.broadcast_to(self.bonded, self.frequencies.shape)),
            *(("low", self.low), ("high", self.high)),
            *(("5 %", self.interval_low), ("95 %", self.interval_high)),
        ]
        kept = [(name, values) for name, values in columns if values is not None]
        heads = [f"{name} [{'-' if name == 'loss factor' else 'Hz'}]" for name, _ in kept]
        if self.mesh_error is not None:
            heads, kept = [*heads, "error of the mesh [-]"], [*kept, ("", self.mesh_error)]
        if self.levels is not None and self.level_damping is not None:
            at = [(level, self.level_damping[:, k]) for k, level in enumerate(self.levels)]
            heads += [f"damping ratio at {level:g} m/s2 [-]" for level, _ in at]
            kept += [("", values) for _, values in at]
        rows.writerow(["preload [N]", "mode", *heads])
        for i, load in enumerate(self.loads):
            for j in range(len(self.bonded)):
                row = [float(values[i, j]) for _, values in kept]
                rows.writerow([f"{load:.6g}", j + 1, *("" if np.isnan(v) else f"{v:.8g}" for v in row)])
        return out.getvalue()


@checked_call
def read_model_modes(path: str | Path, *, load: float | None = None) -> ModelModes:
    """Read the modes of a result file for a comparison with a test.

    Args:
        path: result.nc of `faying run`.
        load: the preload [N]; the greatest where None.

    Returns:
        The elastic modes at that preload, with the frequency response that the file may hold.

    Raises:
        ReadError: the file is missing, damaged or no result of Faying.
        InputError: it has no such load.
    """
    return Result.load(path).modes_at(load, source=str(path))
