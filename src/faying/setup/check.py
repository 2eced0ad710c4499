"""What can be said of a study in seconds, before anything is solved: faults, notes, what a run will need."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import Any, Literal, TypeVar, get_args

from faying.bolt.bolt import Bolt, BoltPlace, each_in_its_place
from faying.bolt.solid_bolt import SolidBolt, SolidPlace
from faying.case.case import SIZES, fit_warnings, interface_of, materials_of, name_faults, surfaces_of
from faying.case.places import named_points, on_structure
from faying.errors import FayingError, InputError
from faying.fe.mesh import Mesh
from faying.fe.quality import quality
from faying.geometry.face_facts import FaceFacts, GeometryFacts, read_facts
from faying.geometry.face_triangles import FaceTriangles
from faying.geometry.mesh_facts import mesh_facts
from faying.geometry.selectors import TOUCHING, chosen, points_of
from faying.joint.bolted import nothing_moves, overlapping, seat_apart
from faying.joint.joint import each_pair_once
from faying.joint.strength import bolt_notes, material_notes
from faying.memory import available
from faying.misuse import checked_call
from faying.notes import Note
from faying.numerics.solve import chosen as factorisation
from faying.progress import duration
from faying.setup.bolt_proposal import MAX_NAMES, grouped
from faying.setup.edit import key_of, line_of, line_of_fault, lines_of
from faying.setup.expected import Expected, unknowns_of
from faying.setup.reach import law_findings
from faying.setup.sketch import Sketch
from faying.study.declaration.reader import StudyFaults
from faying.study.keys.face import place_name
from faying.study.keys.geometry import mesh_of
from faying.study.keys.joint import JointChoice
from faying.study.keys.surface import Surface
from faying.study.study import Study
from faying.style import Summary
from faying.text import cut
from faying.units import in_mm, show, show_area

MAX_MESHED = 400_000  # unknowns, as estimated: meshing them takes some ten seconds
TOO_MUCH = 1.5  # times the free memory: a fault, as estimated unknowns are within a factor of 2.5
COARSER = tuple(1.1**k for k in range(1, 18))  # times a size, to five times: beyond, a mesh says nothing of the parts
MAX_ROWS = 8  # findings in a summary
Level = Literal["fault", "note", "ok"]
Made = TypeVar("Made")


@dataclass(frozen=True, kw_only=True)
class Finding:
    """One thing that was looked at.

    Args:
        level: ok, note or fault; with a fault the run would stop.
        code: what was looked at.
        text: what was found, and what to do about it.
        key: of the study that it concerns; "" where it is none.
        line: of the study's text on which the key stands, from 1.
    """

    level: Level
    code: str
    text: str
    key: str = ""
    line: int | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Checked(Summary):
    """All findings on a study, in the order in which they were looked at, and what a run is expected to need."""

    findings: tuple[Finding, ...]
    expected: Expected | None = None

    @property
    def faults(self) -> tuple[Finding, ...]:
        """The findings with which a run would stop."""
        return tuple(one for one in self.findings if one.level == "fault")

    @property
    def by_level(self) -> tuple[Finding, ...]:
        """Faults, then notes, then what is well."""
        return tuple(one for level in get_args(Level) for one in self.findings if one.level == level)

    @property
    def count(self) -> str:
        """How many faults and notes there are, in words."""
        notes = sum(one.level == "note" for one in self.findings)
        faults = len(self.faults)
        return f"{faults} fault{'s' * (faults != 1)}, {notes} note{'s' * (notes != 1)}"

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return how many faults and notes there are, the first of them, and what a run needs."""
        grave = [one for one in self.by_level if one.level != "ok"]
        rows = {f"{one.level} {k}": cut(one.text) for k, one in enumerate(grave[:MAX_ROWS], 1)}
        rows |= {"more": f"{len(grave) - MAX_ROWS}, in .findings"} if len(grave) > MAX_ROWS else {}
        if self.expected is not None:
            need = self.expected
            rows["a run needs"] = f"{need.unknowns:,} unknowns, {need.memory / 1e9:.2g} GB, {duration(need.seconds)}"
        return f"Check of a study: {self.count}", rows

    def to_dict(self) -> dict[str, Any]:
        """Findings, and what a run is expected to need, with units."""
        need = self.expected
        return {
            "findings": [asdict(one) for one in self.findings],
            "faults": len(self.faults),
            "expected": None
            if need is None
            else {
                "unknowns": need.unknowns,
                "memory": {"unit": "B", "values": need.memory},
                "time": {"unit": "s", "values": need.seconds},
                "basis": need.basis,
            },
        }


@dataclass
class _Findings:
    lines: Mapping[str, int]
    out: list[Finding] = field(default_factory=list)

    def add(self, level: Level, code: str, text: str, key: str = "") -> None:
        """Add one finding, once."""
        found = Finding(level=level, code=code, text=text, key=key, line=line_of(key, self.lines))
        if found not in self.out:
            self.out.append(found)

    def tried(self, code: str, key: str, work: Callable[[], Made]) -> Made | None:
        """Return what some work makes; what it refuses is a fault, and makes nothing."""
        try:
            return work()
        except FayingError as fault:
            self.add("fault", code, str(fault), key)
            return None


@checked_call
def check(path: str | Path, *, mesh: bool = True) -> Checked:
    """Look at a study file without solving: its keys, names, contacts, bolts, seats, laws and size.

    Args:
        path: Study file.
        mesh: Whether to mesh its STEP file, too, which counts the unknowns and finds what the mesher refuses; the mesh
            is kept for the run. Not where it is expected to have more than 400,000 unknowns.

    Returns:
        Every finding; nothing is raised for faults of the study.

    Raises:
        ReadError: there is no such file.
    """
    file = Path(path)
    text = file.read_text(encoding="utf-8", errors="replace") if file.is_file() else ""
    found = _Findings(lines_of(text))
    study = _read(file, text, found)
    if study is None:
        return Checked(findings=tuple(found.out))
    found.add("ok", "keys", f"keys, units and files of {file.name}")
    facts, ready = _geometry(study, found)
    if facts is None:
        return Checked(findings=tuple(found.out))
    named = _named(study, facts, found)
    before = len(found.out)
    owner = {name: some[0].part for name, some in named.items()}
    for key, fault in name_faults(study, list(facts.by_part), owner, () if ready is None else ready.bonded):
        found.add("fault", "names", fault, key)
    for name in study.geometry.face_size:
        if name not in named:
            text = f"size of face {name!r}: the faces are {', '.join(sorted(named))}"
            found.add("fault", "names", text, f"geometry.face_size.{name}")
    if len(found.out) > before and any(one.level == "fault" for one in found.out):
        return Checked(findings=tuple(found.out), expected=_expected(study, facts, named, ready, found))
    parts = "1 part" if len(facts.parts) == 1 else f"{len(facts.parts)} parts"
    found.add("ok", "names", f"{parts} and {len(named)} named faces of {facts.file}")
    sketch = Sketch(
        study=study,
        facts=facts,
        named=named,
        mesh=FaceTriangles.of(facts, named),
        materials={name: study.materials[study.parts[name]] for name in facts.by_part},
        fitted_bolts=(),
    )
    _contacts(sketch, found)
    shared = set() if ready is None else {face for face in ready.faces if ready.is_shared(face)}
    for joint in study.joints:
        if text := nothing_moves(joint.name, [face for face in joint.faces if face in shared]):
            found.add("fault", "contact", text, f"joint[{joint.number}].faces")
    seats = {face for bolt in study.bolts for face in bolt.faces}
    bonded = set() if ready is None else {face for face in seats if ready.is_shared(face, wholly=False)}
    sketch = _bolts(sketch, found, bonded)
    _dowels(sketch, found)
    surfaces = _surfaces(study, found)
    for name, test in study.part_tests.items():
        found.tried("part", f"part.{name}.file", test.read)
    for level, code, words, key in law_findings(sketch, surfaces):
        found.add(level, code, words, key)
    made = _meshed(study, facts, named, found) if mesh and ready is None else ready
    for key, what, point in named_points(study):
        found.tried("point", key, partial(on_structure, what, point, made or facts))
    if made is not None:
        if text := overlapping(made, {joint.name: joint.faces for joint in study.joints}):
            found.add("fault", "contact", text, "joint")
        _laid(study, made, surfaces, found)
    expected = _expected(study, facts, named, made, found)
    return Checked(findings=tuple(found.out), expected=expected)


def _read(file: Path, text: str, found: _Findings) -> Study | None:
    try:
        return Study.read(file)
    except StudyFaults as faults:
        for line in faults.lines:
            found.add("fault", "keys", line, key_of(line, found.lines))
    except InputError as fault:
        if not file.is_file():
            raise
        found.out.append(Finding(level="fault", code="toml", text=str(fault), line=line_of_fault(fault, text)))
    return None


def _geometry(study: Study, found: _Findings) -> tuple[GeometryFacts | None, Mesh | None]:
    """Facts of the geometry, and the mesh where the study names one that is ready."""
    spec = study.geometry
    points = points_of(spec.face)
    try:
        if spec.mesh is not None:
            mesh = mesh_of(spec)
            _notes(found, (*mesh.notes, *quality(mesh).notes), "geometry.mesh")
            return mesh_facts(mesh, points), mesh
        facts = read_facts(spec.file, points=points, overlaps=True, leave_out=spec.leave_out, unite=spec.unite)
    except FayingError as fault:
        found.add("fault", "geometry", str(fault), "geometry.mesh" if spec.mesh is not None else "geometry.step")
        return None, None
    _notes(found, facts.notes, "geometry.step")
    for overlap in facts.overlaps:
        text = f"{overlap}; parts may touch, not overlap: correct it in the CAD program"
        found.add("fault", "overlap", text, "geometry.step")
    if not SIZES[0] <= facts.size <= SIZES[1]:
        text = f"the structure measures {facts.size:.4g} m from corner to corner; is the unit of its geometry right?"
        found.add("note", "size", text, "geometry.step")
    return facts, None


def _notes(found: _Findings, notes: tuple[Note, ...], key: str) -> None:
    for note in notes:
        found.add("note", note.code, note.text, key)


def _named(study: Study, facts: GeometryFacts, found: _Findings) -> dict[str, tuple[FaceFacts, ...]]:
    """Faces by name: those of the file, and those that selectors mean."""
    named: dict[str, tuple[FaceFacts, ...]] = {}
    for face in facts.faces:
        if face.name:
            named[face.name] = (*named.get(face.name, ()), face)
    if study.geometry.mesh is not None:
        return named  # a mesh has them all
    taken = set(named)
    for label, selector in study.geometry.face.items():
        key = _selector_key(study, label)
        if label in taken:
            text = f"face {label!r}: the file has a face of this name already; choose another name"
            found.add("fault", "selector", text, key)
            continue
        faces = found.tried("selector", key, partial(chosen, label, selector, facts, snap=study.geometry.snap))
        if faces is not None:
            named[label] = faces
        elif selector.part in facts.by_part:
            named[label] = facts.by_part[selector.part][:1]  # so that its name is not a second fault
    return named


def _selector_key(study: Study, label: str) -> str:
    """Where a selector stands: under [geometry.face], or in place of a name."""
    named: list[tuple[str, str, tuple[str, ...]]]
    named = [(f"joint[{joint.number}].faces", joint.name, joint.faces) for joint in (*study.joints, *study.bonds)]
    named += [(f"bolt[{k}].faces", bolt.name, bolt.faces) for k, bolt in enumerate(study.bolts, 1)]
    named += [(f"dowel[{k}].walls", dowel.name, dowel.walls) for k, dowel in enumerate(study.dowels, 1)]
    for key, name, faces in named:
        if label in [place_name(name, k) for k, face in enumerate(faces) if face == label]:
            return key
    if label.endswith("]") and label.split("[")[0] in ("support", "mass"):
        return f"{label}.face"
    acting = re.fullmatch(r"(load\[\d+\]) (\w+) (\d+)", label)
    return f"{acting[1]}.{acting[2]}[{acting[3]}].face" if acting else f"geometry.face.{label}"


def _meshed(
    study: Study, facts: GeometryFacts, named: Mapping[str, tuple[FaceFacts, ...]], found: _Findings
) -> Mesh | None:
    """The mesh of a STEP file, as the run makes it; None where it would be large, or faults forbid it."""
    spec = study.geometry
    if any(one.level == "fault" for one in found.out):
        return None
    if unknowns_of(facts, spec.size, spec.face_size, named) > MAX_MESHED:
        return None
    return found.tried("mesh", "geometry.size", partial(mesh_of, spec))


def _surfaces(study: Study, found: _Findings) -> tuple[Surface, ...]:
    """The surface of each joint; none where one of them cannot be read, which is a fault."""
    key = "surface" if study.surface is not None else "joint[1].surface"
    out = found.tried("surface", key, partial(surfaces_of, study)) or ()
    for text in fit_warnings(study, out) if out else ():
        found.add("note", "surface", text, key)
    return out


def _laid(study: Study, mesh: Mesh, surfaces: Sequence[Surface], found: _Findings) -> None:
    """Joints with their form, bolts and dowels on the mesh, by what lays them there in a run."""
    if any(one.level == "fault" for one in found.out):
        return
    materials = materials_of(study, mesh)
    for joint, surface in zip(study.joints, surfaces, strict=True):
        found.tried("contact", f"joint[{joint.number}].faces", partial(interface_of, study, mesh, joint, surface))
    for k, bolt in enumerate(study.bolts, 1):
        if isinstance(bolt, Bolt):
            found.tried("bolt", f"bolt[{k}].faces", partial(bolt.fitted, mesh, materials))
    for k, dowel in enumerate(study.dowels, 1):
        found.tried("dowel", f"dowel[{k}].walls", partial(dowel.fitted, mesh))


def _expected(
    study: Study, facts: GeometryFacts, named: Mapping[str, tuple[FaceFacts, ...]], mesh: Mesh | None, found: _Findings
) -> Expected:
    spec = study.geometry
    key = "geometry.mesh" if spec.mesh is not None else "geometry.size"
    unknowns = mesh.unknowns if mesh is not None else unknowns_of(facts, spec.size, spec.face_size, named)
    expected = Expected.of(study, unknowns, counted=mesh is not None)
    found.tried("solver", "modes.solver", partial(factorisation, study.modes.solver))
    if study.modes.count > unknowns:
        text = f"modes.count = {study.modes.count}: the structure has {unknowns:,} unknowns; ask for fewer modes"
        found.add("fault", "expected", text, "modes.count")
    free = available()
    about = "" if mesh is not None else "about "
    text = f"{about}{unknowns:,} unknowns, {expected.memory / 1e9:.2g} GB, {duration(max(expected.seconds, 1.0))}"
    if free is not None and expected.memory > free:
        text += f"; {free / 1e9:.2g} GB are free: "
        ratio = _coarser(study, facts, named, free) if mesh is None and spec.step is not None else None
        if ratio is None:
            text += "mesh more coarsely"
        else:
            text += f'geometry.size = "{show(ratio * spec.size, "m", digits=2)}" fits'
            text += f", with face sizes {ratio:.2g} times theirs" if spec.face_size else ""
        found.add("fault" if expected.memory > TOO_MUCH * free else "note", "expected", text, key)
    else:
        found.add("ok", "expected", text, key)
    return expected


def _coarser(
    study: Study, facts: GeometryFacts, named: Mapping[str, tuple[FaceFacts, ...]], free: float
) -> float | None:
    """How many times larger elements fit into the free memory [B]; None where what holes need does not."""
    spec = study.geometry

    def memory(ratio: float) -> float:
        fine = {name: ratio * size for name, size in spec.face_size.items()}
        return Expected.of(study, unknowns_of(facts, ratio * spec.size, fine, named)).memory

    return next((ratio for ratio in COARSER if memory(ratio) < free), None)


def _contacts(sketch: Sketch, found: _Findings) -> None:
    """Whether the faces of each joint meet, and how far apart they lie."""
    every = sorted((*sketch.study.joints, *sketch.study.bonds), key=lambda joint: joint.number)
    joints = {joint.name: joint.faces for joint in every}
    found.tried("contact", "joint", lambda: each_pair_once(joints))
    for joint in every:
        found.add(*_contact(sketch, joint), f"joint[{joint.number}].faces")


def _contact(sketch: Sketch, joint: JointChoice) -> tuple[Level, str, str]:
    """Level, code and text of what there is to say of the faces of one joint."""
    who, size, pair = f"joint {joint.name!r}", sketch.facts.size, " and ".join(map(repr, joint.faces))
    parts = [sketch.mesh.face_part[face] for face in joint.faces]
    if parts[0] == parts[1]:
        return "fault", "contact", f"faces {pair} are both on part {parts[0]!r}; a joint needs two"
    meets = sketch.contacts(joint.faces)
    if not meets:
        text = f"{who}: its faces {pair} do not look at each other"
        if any(face.kind == "other" for name in joint.faces for face in sketch.named[name]):
            return "note", "contact", f"{text} as far as planes and cylinders show; they are curved"
        return "fault", "contact", f"{text} within {show(0.01 * size, 'm')}; `faying faces` lists what does"
    widest = max(abs(contact.gap) for contact in meets)
    apart, area = show(widest, "m"), show_area(sum(contact.area for contact in meets))
    reach, is_open = joint.search_distance or 0.01 * size, widest > max(TOUCHING * size, sketch.study.geometry.snap)
    if joint.bonded and is_open:
        remedy = "move a part, or give geometry.snap"
        return "fault", "contact", f"{who} is bonded, but its faces are {apart} apart; {remedy}"
    if joint.bonded:
        return "ok", "contact", f"{who}: its faces are bonded over {area}"
    if widest > reach:
        remedy = "move a part, or give search_distance"
        return "fault", "contact", f"{who}: its faces are {apart} apart, more than {show(reach, 'm')}; {remedy}"
    if is_open:
        text = f"{who}: a gap of {apart} between its faces about {in_mm(sketch.facts.face(*meets[0].first).centre)}"
        remedy = "geometry.snap of as much counts it as touching"
        return "note", "gap", f"{text} stays open until bolts close it; {remedy}"
    return "ok", "contact", f"{who}: its faces touch over {area}"


def _placed(bolt: Bolt | SolidBolt, mesh: FaceTriangles) -> BoltPlace | SolidPlace:
    return SolidPlace.of(bolt, mesh) if isinstance(bolt, SolidBolt) else bolt.placed(mesh)


def _bolts(sketch: Sketch, found: _Findings, bonded: set[str]) -> Sketch:
    """Bolts in their places: seats that look away from each other, axes in their holes, forces that they bear.

    bonded: seats of which some sides are of another part, too.
    """
    places: list[BoltPlace | SolidPlace] = []
    study = sketch.study
    met = bonded.union(*(joint.faces for joint in (*study.joints, *study.bonds)), (one.face for one in study.supports))
    well: dict[str, list[tuple[str, str]]] = {}  # what is said -> bolts and keys of which it is
    for k, bolt in enumerate(study.bolts, 1):
        made = found.tried("bolt", f"bolt[{k}].{'at' if bolt.at else 'faces'}", partial(_placed, bolt, sketch.mesh))
        if made is None:
            continue
        places.append(made)
        if isinstance(bolt, SolidBolt) and (apart := seat_apart(bolt, met)):
            found.add("fault", "bolt", apart, f"bolt[{k}].faces")
            continue
        length = show(made.length, "m")
        if isinstance(made, SolidPlace):
            text = f"bolt {bolt.name!r} is the part {bolt.part!r} and clamps {length}"
            found.add("ok", "bolt", text, f"bolt[{k}].part")
            continue
        ring = "whole faces" if made.ring is None else f"a ring of {' to '.join(show(d, 'm') for d in made.ring)}"
        well.setdefault(f"{length} between seats that are {ring}", []).append((bolt.name, f"bolt[{k}].faces"))
        _notes(found, made.notes, f"bolt[{k}].seat")
    for words, some in well.items():
        many = len(some) > MAX_NAMES
        who = f"{grouped([name for name, _ in some])} clamp" if many else ""
        for name, key in some[:1] if many else some:
            found.add("ok", "bolt", f"{who or f'bolt {name!r} clamps'} {words}", key)
    found.tried("bolt", "bolt", lambda: each_in_its_place([one for one in places if isinstance(one, BoltPlace)]))
    sketch = replace(sketch, fitted_bolts=tuple(places))
    keys = {bolt.name: f"bolt[{k}].preload" for k, bolt in enumerate(study.bolts, 1)}
    _notes(found, tuple(material_notes(sketch)), "part")
    for note in bolt_notes(sketch, study.bolt_forces):
        key = next((key for name, key in keys.items() if note.text.startswith(f"bolt {name!r}")), "bolt")
        found.add("note", note.code, note.text, key)
    return sketch


def _dowels(sketch: Sketch, found: _Findings) -> None:
    """Dowels in their places: holes of one diameter on one axis, one behind the other."""
    for k, dowel in enumerate(sketch.study.dowels, 1):
        key = f"dowel[{k}].walls"
        made = found.tried("dowel", key, partial(dowel.placed, sketch.mesh))
        if made is not None:
            depths = ", ".join(
                f"{show(float(high - low), 'm')} in {sketch.mesh.face_part[wall]!r}"
                for wall, (low, high) in zip(made.walls, made.depths, strict=True)
            )
            found.add("ok", "dowel", f"dowel {dowel.name!r}: {show(made.diameter, 'm')} thick, {depths}", key)
