"""What a run has found: frozen arrays with names, dimensions and units, and the facts that they belong to."""

from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from faying.errors import ReadError
from faying.files import write_text
from faying.joint.attachments import PointMass, Support
from faying.joint.preload_case import each_once, load_name, preload_index
from faying.measured.compare import ModalComparison
from faying.measured.model import FullResponse, ModelModes
from faying.misuse import checked_call
from faying.notes import Note, grouped
from faying.result.backbone import Backbone
from faying.result.bolts import BoltNumbers
from faying.result.fields import (
    Recorded,
    RecordedQuantity,
    ShownAs,
    declared,
    group,
    in_units,
    load_texts,
    optional,
    quantities,
    variable,
)
from faying.result.groups import Alternatives, BondedAboveRange, Levels, WaveDraws
from faying.result.interval import Interval
from faying.result.provenance import Provenance
from faying.result.vibration import VibrationResponse
from faying.text import csv_text, listed, notes_row
from faying.typing import Array, Complex, Index

Point = tuple[float, float, float]
MAX_LOADS, MAX_MODES = 4, 5  # that a summary has a column and a line for
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
    frequencies: Array = variable("load test_mode", "Hz", "measured frequencies")
    predicted: Array = variable("load test_mode", "Hz", "frequencies of the paired modes", gaps=True)
    modes: Index = variable("load test_mode", "1", "index of the paired mode, -1: none", dtype="i8")
    published: Array | None = optional("load test_mode", "Hz", "frequencies of a published model")
    published_name: str = "published"
    alternatives: Array | None = optional(
        "law load test_mode", "Hz", "frequencies under another law", "predicted_by_law", gaps=True
    )
    kind: str = "test"  # or "model", where the frequencies are those of somebody's model

    @property
    def reference(self) -> str:
        """What tables and figures call the frequencies that ours are set beside."""
        return "test" if self.kind == "test" else "reference model"


@dataclass(frozen=True, kw_only=True, eq=False)
class Receptance:
    """Frequency response at every load; error: the largest of the residuals that were checked [-]."""

    frequencies: Array = variable("response_frequency", "Hz", "frequencies of the response")
    values: Complex = variable("load response_frequency output input", "m/N", "receptance", dtype="c16")
    input_points: Array = variable("input axis", "m", "points of the forces")
    input_directions: Array = variable("input axis", "1", "directions of the forces")
    output_points: Array = variable("output axis", "m", "points of the motion")
    output_directions: Array = variable("output axis", "1", "directions of the motion")
    error: Array = variable("load", "1", "largest residual of the full equations that was checked")
    bolt_forces: Complex | None = optional(
        "load response_frequency bolt input",
        "1",
        "force in each bolt per force, 0 for a bolt without a shank",
        dtype="c16",
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


@dataclass(frozen=True, kw_only=True, eq=False, repr=False)
class RunRecord(Recorded):
    """The fields of `Result`, which says what they are."""

    KIND: ClassVar[str] = "result"
    COMMAND: ClassVar[str] = "faying run STUDY.toml"

    title: str
    loads: Array = variable("load", "N", "preload of the first bolt", "preload")
    carried: Array | None = optional(
        "load", "N", "greatest preload of the first bolt before, 0 on first loading", shown="greatest preload before"
    )
    settled: bool = False
    frequencies: Array = variable("load mode", "Hz", "frequency", "modes/frequency", shown="frequency")
    loss_factors: Array = variable(
        "load mode",
        "1",
        "loss factor, NaN where no joint predicts one",
        "modes/loss_factor",
        gaps=True,
        shown="loss factor",
    )
    loss_error: Array = variable(
        "load mode", "1", "estimated relative error of the loss factor", "modes/loss_factor_error"
    )
    free: Array | None = optional("mode", "Hz", "frequency with the faces apart", "modes/", shown="free")
    bonded: Array | None = optional("mode", "Hz", "frequency with the faces bonded", "modes/", shown="bonded")
    rigid: Array = variable("rigid_motion", "Hz", "largest frequency of each rigid motion, ideally 0", "modes/")
    mac: Array = variable(
        "load mode mode_other", "1", "MAC by mass of the modes at the first load with those at each", "modes/"
    )
    points: Array = variable("point axis", "m", "points of the joints", "points/position")
    weights: Array = variable("point", "m2", "area of each point", "points/area")
    joint_of_point: Index = variable("point", "1", "joint of each point, from 0", "points/joint_number", dtype="i8")
    pressure: Array = variable("load point", "Pa", "contact pressure", "points/")
    k_n: Array = variable("load point", "Pa/m", "normal stiffness per area, as assembled", "points/")
    k_t: Array = variable("load point", "Pa/m", "tangential stiffness per area, as assembled", "points/")
    slipping: Array = variable("load joint", "1", "share of the area at the limit of friction", "joints/slipping_share")
    total_k_n: Array = variable("load joint", "N/m", "sum of the normal springs", "joints/k_n")
    total_k_t: Array = variable("load joint", "N/m", "sum of the tangential springs", "joints/k_t")
    bolt_forces: Array = variable("load bolt", "N", "force left when all bolts are tight", "bolts/force")
    imbalance: Array = variable("load", "1", "residual force of the preload over the load", "solution/")
    newton_steps: Index = variable("load", "1", "Newton steps of the preload", "solution/", dtype="i8")
    outline: Array = variable("node axis", "m", "nodes of the outer surface", "surface/position")
    triangles: Index = variable("triangle corner", "1", "triangles between them", "surface/", dtype="i8")
    shapes: Any = variable("load mode node axis", "kg^-1/2", "mass-normalised mode shapes", "surface/shape", dtype="f4")
    shapes_imaginary: Any = variable(
        "load mode node axis",
        "kg^-1/2",
        "imaginary part of the complex mode shapes, scaled as shapes: the motion is the real part of "
        "(shapes + i shapes_imaginary) exp(i phase)",
        "surface/shape_imaginary",
        dtype="f4",
    )
    part_of_triangle: Index = variable("triangle", "1", "part of each triangle, from 0", "surface/", dtype="i8")
    face_of_triangle: Index = variable(
        "triangle", "1", "named face of each triangle, from 0, -1: none", "surface/", dtype="i8"
    )
    part_masses: Array = variable("part", "kg", "mass of each part, without bolts and point masses", "parts/mass")
    stress: Array | None = optional(
        "load part",
        "Pa",
        "greatest stress of von Mises in each part when all bolts are tight",
        "parts/",
        shown=ShownAs(
            chapter="Structure",
            title="Stress of the parts",
            line="greatest stress of von Mises in each part when all bolts are tight",
            below="The greatest stress of von Mises in each part when all bolts are tight, at nodes, averaged over the "
            "elements there. stress_place says where, stress_spread how far elements differ there. Under a sharp edge "
            "and where a bolt is a beam it grows as the mesh gets finer.",
        ),
    )
    stress_place: Array | None = optional("load part axis", "m", "where the stress of each part is greatest", "parts/")
    stress_spread: Array | None = optional(
        "load part", "1", "deviation of the elements at this place from their mean, over the stress", "parts/"
    )
    von_mises: Array | None = optional(
        "load node", "Pa", "stress of von Mises on the outer surface", "surface/", dtype="f4"
    )
    tension: Array | None = optional(
        "load node", "Pa", "greatest principal stress on the outer surface", "surface/", dtype="f4"
    )
    compression: Array | None = optional(
        "load node", "Pa", "least principal stress on the outer surface", "surface/", dtype="f4"
    )
    slip: Array = variable(
        "load point", "m", "tangential displacement of the second face against the first under the preload", "points/"
    )
    gap: Array = variable("point", "m", "distance of the faces before any load, form included", "points/")
    bolt_seats: Array = variable("bolt end axis", "m", "where the axis of each bolt meets its seats", "bolts/seat")
    bolt_diameters: Array = variable(
        "bolt", "m", "diameter of each shank, NaN where none is given", "bolts/diameter", gaps=True
    )
    bolt_extents: Array = variable(
        "bolt edge",
        "m",
        "inner and outer diameter of the seat of each bolt, NaN for a bolt that is a part",
        "bolts/seat_diameter",
        gaps=True,
    )
    dowel_ends: Array | None = optional("dowel end axis", "m", "where each dowel begins and ends", "dowels/ends")
    dowel_diameters: Array | None = optional("dowel", "m", "diameter of each dowel", "dowels/diameter")
    dowel_shear: Array | None = optional(
        "load dowel",
        "N",
        "greatest shear force of the dowel when all bolts are tight",
        "dowels/shear",
        shown=ShownAs(
            chapter="Structure",
            title="Dowels",
            line="shear force of each dowel when all bolts are tight",
            below="The greatest shear force of each pin between two parts, when all bolts are tight.",
            caption="The greatest shear force of each pin between two parts against preload.",
        ),
    )
    outside_share: Array = variable(
        "load", "1", "share of the joints' stiffness where their law is outside its validity range", "joints/"
    )
    above_range_share: Array = variable(
        "load", "1", "share of the joints above the end of their law", "joints/above_range_share"
    )
    low: Array | None = optional(
        "load mode", "Hz", "frequency at the lower end of the laws' range", "modes/frequency_low", shown="low"
    )
    high: Array | None = optional(
        "load mode", "Hz", "frequency at the upper end of the laws' range", "modes/frequency_high", shown="high"
    )
    interval: Interval | None = group("interval")
    mesh_error: Array | None = optional(
        "load mode", "1", "estimated relative error of the frequency by the mesh", "modes/", shown="error of the mesh"
    )
    levels: Levels | None = group("level")
    above_range: BondedAboveRange | None = group("above_range")
    waves: WaveDraws | None = group("wave")
    alternatives: Alternatives | None = group("alternative")
    thermal_conductance: Array | None = optional(
        "load joint", "W/K", "conductance of heat, clean metal in vacuum", "joints/", gaps=True
    )
    electrical_conductance: Array | None = optional(
        "load joint", "S", "conductance of current, clean metal", "joints/", gaps=True
    )
    joints: tuple[str, ...]
    bolts: tuple[str, ...]
    dowels: tuple[str, ...] = ()
    parts: tuple[str, ...]
    faces: tuple[str, ...]
    joint_faces: tuple[tuple[str, str], ...]
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
    vibrations: tuple[VibrationResponse, ...] = ()
    provenance: Provenance = field(default_factory=Provenance)

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and what the result says, with the first modes."""
        head = f"Result {self.title!r}: {self.unknowns:,} unknowns, {self.frequencies.shape[1]} modes"
        head += f" at {len(self.loads)} preloads" if self.bolts else ""
        laws = dict.fromkeys(str(law.get("law", law.get("name", ""))) for law in self.laws)
        joints = listed(self.joints) + (f" ({listed(filter(None, laws))})" if any(laws) else "")
        rows = {"joints": joints, "bolts": listed(self.bolts)} if self.joints else {"parts": listed(self.parts)}
        rows |= {"dowels": listed(self.dowels)} if self.dowels else {}
        few = list(range(len(self.loads))) if len(self.loads) <= MAX_LOADS else [0, len(self.loads) // 2, -1]
        words = self._labels_of_loads
        bounds = None if self.free is None or self.bonded is None else (self.free, self.bonded)
        heads = [words[k] for k in few]
        rows["frequencies"] = f"[Hz] {' | '.join(heads if bounds is None else ['free', *heads, 'bonded'])}"
        shown = self.frequencies.shape[1] if self.frequencies.shape[1] <= MAX_MODES else MAX_MODES - 1
        for mode in range(shown):
            cells = [self.frequencies[k, mode] for k in few]
            if bounds is not None:
                cells = [bounds[0][mode], *cells, bounds[1][mode]]
            rows[f"mode {mode + 1}"] = " | ".join(f"{value:8.2f}" for value in cells)
        if self.frequencies.shape[1] > shown:
            rows["more modes"] = f"{self.frequencies.shape[1] - shown}, up to {self.frequencies[-1, -1]:.2f} Hz"
        if (c := self.comparison) is not None:
            error = np.abs(c.predicted / c.frequencies - 1)
            paired = np.isfinite(error)
            mean = f", mean deviation {np.mean(error[paired]):.2%}" if paired.any() else ""
            rows[c.reference] = f"{paired.sum()} of {paired.size} frequencies paired{mean}"
        return head, rows | notes_row(self.notes)

    @property
    def warnings(self) -> tuple[str, ...]:
        """The notes as sentences, those that differ in load and share alone as one; see `faying.notes.grouped`."""
        return tuple(note.text for note in grouped(self.notes))

    def shown(self, chapter: str | None = None) -> dict[str, RecordedQuantity]:
        """The quantities that the result has and that declare a table in a chapter of the report, or in any."""
        return {
            name: meta
            for name, meta in declared(type(self)).items()
            if (meta.shown.chapter if chapter is None else meta.shown.chapter == chapter)
            and getattr(self, name) is not None
        }

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
        """Raise ReadError where joints lack their law, or triangles name nodes, parts or faces that there are not."""
        for name, found in (("surfaces", self.surfaces), ("laws", self.laws)):
            if len(found) != len(self.joints):
                raise ReadError(f"it has {len(found)} {name} for {len(self.joints)} joints")
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
        """The modes at a preload [N], by default the last, for a comparison with a test.

        Raises InputError where there is no such load.
        """
        index = preload_index(self.loads, load, names=self.load_names, name="load", of=source)
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
        out |= {"joint_state": self.joint_state} if self.joints else {}
        out |= in_units(self, without=(*MAPS, *["joint"] * (not self.joints), *["bolt"] * (not self.bolts)))
        if self.joints:
            out["greatest_pressure"] = {"unit": "Pa", "values": self.pressure.max(axis=1).tolist()}
            out["open_share"] = {"unit": "1", "values": self.open_share().tolist()}
        for name in ("parts", "dowels", "joints", "bolts", "tightening"):
            out[name] = list(getattr(self, name))
        out["interval_sources"] = [] if self.interval is None else list(self.interval.sources)
        out["alternatives"] = [] if self.alternatives is None else list(self.alternatives.names)
        out |= {"damping": self.damping, "surfaces": list(self.surfaces), "laws": list(self.laws)}
        if (c := self.comparison) is not None:
            facts = {"source": c.source, "published_name": c.published_name, "kind": c.kind}
            out["comparison"] = facts | in_units(c)
        if self.bolt_numbers is not None:
            out["bolt_numbers"] = in_units(self.bolt_numbers)
        if self.hammer is not None:
            out["hammer_test"] = self.hammer.to_dict()
        if self.backbones:
            out["backbones"] = [curve.to_dict() for curve in self.backbones]
        if self.vibrations:
            out["vibrations"] = [one.to_dict() for one in self.vibrations]
        out["sources"] = list(self.sources)
        out["notes"] = [asdict(note) for note in self.notes]
        return out

    def labels(self) -> dict[str, Any]:
        """Labels of the dimensions of its arrays, by the name of the dimension."""
        out: dict[str, Any] = {"load": self._labels_of_loads, "mode": np.arange(1, self.frequencies.shape[1] + 1)}
        out |= {"part": self.parts, "joint": self.joints, "bolt": self.bolts, "axis": ("x", "y", "z")}
        out |= {"dowel": self.dowels} if self.dowels else {}
        out |= {} if self.interval is None else {"source": self.interval.sources}
        return out | ({} if self.alternatives is None else {"law": self.alternatives.names})

    @property
    def joint_state(self) -> str:
        """What the joints have carried before, in words."""
        return "settled" if self.settled else "first loading"

    @property
    def load_names(self) -> tuple[str, ...]:
        """What tables call the loads, each once: "4 kN after 12 kN" where a preload has fallen."""
        carried = self.carried if self.has_history and self.carried is not None else np.zeros(len(self.loads))
        return each_once(load_name(*pair) for pair in zip(self.loads, carried, strict=True))

    @property
    def has_history(self) -> bool:
        """Whether a preload has fallen, so that names say after which."""
        return self.carried is not None and not self.settled

    @property
    def _labels_of_loads(self) -> tuple[str, ...]:
        return self.load_names if self.has_history else load_texts(self.loads)

    def to_csv(self, path: str | Path) -> Path:
        """Write one row for each load and mode, units in the heading; the file appears complete or not at all."""
        return write_text(Path(path), self.csv_text())

    def csv_text(self) -> str:
        """Return the rows of to_csv as text."""
        columns: list[tuple[str, Array]] = []
        levels = () if self.levels is None else self.levels.accelerations
        for _, meta, values in quantities(self):
            head = meta.shown.column
            if not head or not (self.joints or np.isfinite(values).any()):
                continue
            if "level" in meta.dims:
                columns += [
                    (f"{head} at {level:g} m/s2 [{meta.unit_text}]", values[:, k]) for k, level in enumerate(levels)
                ]
            else:
                at_modes = values[:, None] if meta.dims == ("load",) else values
                columns.append((f"{head} [{meta.unit_text}]", np.broadcast_to(at_modes, self.frequencies.shape)))
        rows: list[list[Any]] = [["preload [N]", "mode", *(head for head, _ in columns)]]
        for i, load in enumerate(self.loads):
            for j in range(self.frequencies.shape[1]):
                row = [float(values[i, j]) for _, values in columns]
                rows.append([f"{load:.6g}", j + 1, *("" if np.isnan(v) else f"{v:.8g}" for v in row)])
        return csv_text(rows)
