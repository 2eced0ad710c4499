"""The study that `faying new` writes from a STEP or mesh file: what was found, what is assumed, and each of it said."""

import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from textwrap import wrap
from typing import Any

from faying.bolt.tightening import DEFAULT_WAY, TIGHTENING
from faying.bolt.vdi2230 import TIGHTENED
from faying.checks import number
from faying.errors import InputError
from faying.file_kinds import STEP, kind_held, kind_of
from faying.files import together, write_atomically, write_text
from faying.geometry.selectors import AXES, Selector
from faying.materials import CATALOGUE
from faying.misuse import checked_call
from faying.setup.bolt_proposal import GRADE, BoltProposal, grouped
from faying.setup.edit import written as quoted
from faying.setup.face_names import faces
from faying.setup.fasteners import DowelProposal
from faying.setup.mesh_proposal import propose_mesh
from faying.setup.proposal import Proposal, propose
from faying.setup.template import SCHEMA, surface
from faying.style import Summary
from faying.text import cut
from faying.units import show, show_area

STEEL = "S355"
COLUMNS = 100  # of the comments that are wrapped
MIN_MASS = 1e-9  # kg: less is what rounding leaves of a volume


@dataclass(frozen=True, kw_only=True)
class Answers:
    """What a user says beyond what the geometry tells; what is left out is assumed and said.

    Args:
        materials: part -> material of the catalogue; steel where a part is left out.
        preload: force of every bolt [N]; that of class 8.8 which its bolt sheet accepts where None.
        scan: scan of one face; a synthetic surface of a fine finish where None.
    """

    materials: Mapping[str, str] = field(default_factory=dict)
    preload: float | None = None
    scan: Path | None = None


@dataclass(frozen=True, kw_only=True, repr=False)
class Written(Summary):
    """The files that were written, what was found, and what was assumed, in the order of the study."""

    files: tuple[Path, ...]
    proposal: Proposal
    assumed: tuple[str, ...]

    @property
    def found(self) -> str:
        """How many parts, joints, bolts and dowels were found, in words."""
        proposal = self.proposal
        counts = {"joint": len(proposal.joints), "bolt": len(proposal.bolts), "dowel": len(proposal.dowels)}
        words = [f"{count} {kind}{'s' * (count != 1)}" for kind, count in counts.items() if count or kind != "dowel"]
        more = f" and {len(proposal.left_out)} more that are not meshed" if proposal.left_out else ""
        parts = "1 part" if proposal.alone else f"{len(proposal.facts.parts)} parts"
        return ", ".join([f"{parts}{more}", *words])

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return what was found, the files, and the first of what was assumed."""
        rows = {"written": ", ".join(map(str, self.files))}
        rows |= {f"assumed {k}": cut(line) for k, line in enumerate(self.assumed[:8], 1)}
        rows |= {"more": f"{len(self.assumed) - 8}, in .assumed"} if len(self.assumed) > 8 else {}
        return f"Study of {self.proposal.facts.file}: {self.found}", rows

    def to_dict(self) -> dict[str, Any]:
        """What was found and written, in SI units."""
        found = self.proposal
        return {
            "files": [str(file) for file in self.files],
            "parts": [part.name for part in found.facts.parts],
            "left_out": list(found.left_out),
            "joints": [
                {"name": j.name, "faces": list(j.faces), "area": {"unit": "m^2", "values": j.area}}
                for j in found.joints
            ],
            "bolts": [
                {
                    "name": b.name,
                    "faces": list(b.faces),
                    "size": b.size and f"M{b.size:g}",
                    "part": b.part,
                    "head": b.shape,
                    "engaged": {"unit": "m", "values": b.engaged},
                    "washers": 0 if b.drawn is None else len(b.drawn.washers),
                    "drawn": None if b.drawn is None else list(b.drawn.names),
                    "preload": {"unit": "N", "values": b.preload},
                }
                for b in found.bolts
            ],
            "dowels": [{"name": d.name, "walls": list(d.walls)} for d in found.dowels],
            "size": {"unit": "m", "values": found.size},
            "unknowns": found.unknowns,
            "assumed": list(self.assumed),
        }


@checked_call
def new_study(
    geometry: str | Path,
    study: str | Path = "study.toml",
    *,
    scan: str | Path | None = None,
    materials: str | Mapping[str, str] | None = None,
    preload: float | str | None = None,
    unit: str | None = None,
    mesh_bolts: bool = False,
    force: bool = False,
) -> Written:
    """Write a commented study of a part or an assembly: the joints, bolts, dowels and seats that its geometry has.

    Args:
        geometry: STEP file, or mesh file of another program whose faces have names.
        study: The file to write.
        scan: Scan of one face; a synthetic one of a fine finish is written where None.
        materials: Material of all parts, or part -> material, of the catalogue; steel where a part is left out.
        preload: Force of each bolt [N], or text such as "12 kN"; what the bolt sheet accepts of class 8.8 where None.
        unit: Unit of a mesh file's coordinates, such as "mm".
        mesh_bolts: Whether bolts that a STEP file shows with their nuts are meshed; else beams stand for them.
        force: Whether files that exist are replaced.

    Returns:
        What was found, written and assumed.

    Raises:
        InputError: A file exists, a material or a part is unknown, or nothing can be written there.
        ReadError: The geometry cannot be read.
    """
    path, out = Path(geometry), Path(study)
    proposal = find(path, unit, mesh_bolts=mesh_bolts)
    parts = [part.name for part in proposal.facts.parts]
    given = dict.fromkeys(parts, materials) if isinstance(materials, str) else dict(materials or {})
    unknown = [name for name in given if name not in parts]
    if unknown:
        raise InputError(f"no part is called {unknown[0]!r}; the parts are {', '.join(map(repr, parts))}")
    force_of_bolts = None if preload is None else number(preload, "preload", "N")
    answers = Answers(materials=given, preload=force_of_bolts, scan=None if scan is None else Path(scan))
    return write(proposal, path, out, answers, force=force)


def find(step: Path, unit: str | None = None, *, mesh_bolts: bool = False) -> Proposal:
    """Read a STEP file, or a mesh file in a unit, and propose what its study may hold.

    Raises ReadError and InputError as `propose` and `propose_mesh`.
    """
    if kind_of(step) is STEP:
        return propose(faces(step, unit=unit), step, mesh_bolts=mesh_bolts)
    return propose_mesh(step, unit)


def write(proposal: Proposal, step: Path, out: Path, answers: Answers, *, force: bool = False) -> Written:
    """Write the study, and the synthetic scan with it where no scan is given; all files or none.

    Args:
        proposal: from `find`.
        step: the STEP file.
        out: the study file.
        answers: what the user says.
        force: whether files that exist are replaced.

    Raises:
        InputError: a file exists, a material is unknown, or nothing can be written there.
    """
    unknown = [name for name in answers.materials.values() if name not in CATALOGUE]
    if unknown:
        raise InputError(f'material "{unknown[0]}" is not in the catalogue; give one of {", ".join(CATALOGUE)}')
    if answers.scan is not None and not answers.scan.is_file():
        raise InputError(f"no scan {answers.scan}")
    kind = None if answers.scan is None else kind_held(answers.scan)
    if kind is not None and "scan" not in kind.serves:
        raise InputError(f"{answers.scan} is {kind.says}, not a scan")
    synthetic = answers.scan is None and not proposal.alone
    made = [out.name, *[scan_name(out)] * synthetic]
    there = [out.parent / name for name in made if (out.parent / name).exists()]
    if there and not force:
        raise InputError(
            f"{there[0]} exists already; name another study (--out), or have it replaced by force (--force)"
        )
    text, assumed = study_text(proposal, step, out, answers)
    with together(out.parent, "give another place (--out)") as folder:
        write_text(folder / out.name, text)
        if synthetic:
            write_atomically(folder / scan_name(out), surface)
    return Written(files=tuple(out.parent / name for name in made), proposal=proposal, assumed=tuple(assumed))


def scan_name(out: Path) -> str:
    """The name of the synthetic scan of a study file."""
    return f"{out.stem}-surface.x3p"


def study_text(proposal: Proposal, step: Path, out: Path, answers: Answers) -> tuple[str, list[str]]:
    """The text of the study, and what it assumes."""
    assumed: list[str] = []
    blocks = [
        _head(proposal, step, out),
        _geometry(proposal, _relative(step, out)),
        _parts(proposal, answers, assumed),
        "" if proposal.alone else _surface(out, answers, assumed),
        _joints(proposal) or ("" if proposal.alone else NO_JOINT),
        *(_bolt(bolt, answers) for bolt in proposal.bolts),
        "" if proposal.bolts or proposal.alone else NO_BOLT,
        *map(_dowel, proposal.dowels),
        SUPPORT,
        "[modes]\ncount = 10                     # elastic modes\n",
    ]
    assumed += _assumed_of_bolts(proposal.bolts, answers)
    pins = ((dowel.name, f"{dowel.remark}; without play, {STEEL}") for dowel in proposal.dowels)
    assumed += alike(pins, "dowel")
    assumed.append("no support: the structure is free")
    return "\n".join(block for block in blocks if block), [*assumed, *proposal.remarks]


NO_JOINT = """# No joint was found. Name the two faces of each one (see `faying faces`).
# [[joint]]
# name = "joint"
# faces = ["FACE_A", "FACE_B"]
"""
NO_BOLT = """# No bolt was found in the geometry. Name the two faces that head and nut press on (see `faying faces`).
# [[bolt]]
# name = "bolt 1"
# faces = [{ part = "upper", normal = "+z" }, { part = "lower", normal = "-z" }]
# at = ["0 mm", "0 mm", "0 mm"]  # a point on its axis
# seat = ["9 mm", "16 mm"]       # inner and outer diameter of what head and nut press on
# diameter = "8 mm"
# material = "S355"
# preload = "14.5 kN"
"""
SUPPORT = """# Assumed: the structure is free. A face that is held:
# [[support]]
# face = { part = "PART", normal = "-x" }
"""


def _table(*lines: str) -> str:
    """A table of the study, of those lines that hold something."""
    return "\n".join([*filter(None, lines), ""])


def _comment(text: str) -> str:
    """Lines of a comment."""
    lines = wrap(_plain(text), COLUMNS - 2, break_long_words=False, break_on_hyphens=False)
    return "\n".join(f"# {line}" for line in lines)


def _line(key: str, value: Any, why: str = "") -> str:
    """A key with its value and a comment; "" where there is no value."""
    return f"{key} = {quoted(value)}{f'  # {why}' if why else ''}" if value else ""


def _length(value: float | None) -> str:
    """A length [m] as the study writes it, "" where it is not known."""
    return "" if value is None else show(value, "m")


def _head(proposal: Proposal, step: Path, out: Path) -> str:
    return _table(
        SCHEMA,
        f"# Written by faying new from {_plain(step.name)}. Lines marked ASSUMED are guesses: make them yours.",
        f"# Look at it with: faying check {_plain(out.name)}; run it with: faying run {_plain(out.name)}",
        *(_comment(f"Note: {remark}") for remark in proposal.remarks),
        _line("title", step.stem),
    )


def _geometry(proposal: Proposal, step: str) -> str:
    snap = _length(proposal.snap or None)
    if proposal.unit:
        return _table(
            "[geometry]",
            _line("mesh", step),
            _line("unit", proposal.unit),
            _line("snap", snap, "ASSUMED: gaps between faces up to this are none"),
            "[geometry.sets]  # parts that are several sets of the file, or bodies of it" if proposal.sets else "",
            *(_line(quoted(part), some) for part, some in proposal.sets.items()),
        )
    return _table(
        "[geometry]",
        _line("step", step),
        _line("size", _length(proposal.size), f"largest element: about {proposal.unknowns:,} unknowns"),
        _line("snap", snap, "ASSUMED: gaps of the CAD model up to this are none"),
        _line("leave_out", proposal.left_out, "parts of the file that are not meshed"),
        _line("unite", proposal.unite, "bodies of the file that are one part: bolts with their nuts"),
        f"[geometry.face]  # names for faces; `faying faces {_plain(step)}` lists all of them" * bool(proposal.faces),
        *(_line(quoted(name), selector_table(one)) for name, one in proposal.faces.items()),
    )


def selector_table(selector: Selector) -> dict[str, Any]:
    """A selector as the study has it."""
    normal, numbers = selector.normal, list(selector.numbers)
    word = next((word for word, axis in AXES.items() if axis == normal), normal)
    which = numbers if len(numbers) > 1 else next(iter(numbers), None)
    keys = {"part": selector.part, "touching": selector.touching, "normal": word, "number": which}
    return {key: value for key, value in keys.items() if value is not None}


def _parts(proposal: Proposal, answers: Answers, assumed: list[str]) -> str:
    given = {part.name: answers.materials.get(part.name) for part in proposal.facts.parts}
    guessed = [part for part, material in given.items() if not material]
    if guessed:
        assumed.append(f"{STEEL} steel for {', '.join(guessed)}")
    lines = []
    for part, material in given.items():
        lines += [f"[part.{quoted(part)}]", _line("material", material or STEEL, "" if material else "ASSUMED")]
    return _table(
        f"# The catalogue has {', '.join(CATALOGUE)}; [material.NAME] describes one of your own.",
        '# Of a part weighed and rung alone: mass = "1.234 kg", frequencies = ["512 Hz", "1.4 kHz"], its free modes.',
        *lines,
    )


def _surface(out: Path, answers: Answers, assumed: list[str]) -> str:
    if answers.scan is None:
        scan = scan_name(out)
        assumed.append(f"the surface {scan}, a synthetic fine finish of 0.5 um rms height, on both faces: scan yours")
        mark = "ASSUMED: synthetic, fine finish, 0.5 um rms height; put the scan of your face here"
    else:
        scan, mark = _relative(answers.scan, out), ""
        assumed.append("the other face of each joint is alike but unrelated (surface.counter)")
    other = 'ASSUMED: the other face is alike but unrelated; "smooth", or the file of its own scan'
    law = "the contact solved on the scan, or the law nearest to it; `faying models` lists others"
    lines = _line("scan", scan, mark), _line("counter", "same", other)
    head = "# The rough surface: the scan of one face, laid on every joint. [joint.surface] gives one to a joint alone."
    return "\n".join([head, _table("[surface]", *lines), _table("[law]", _line("model", "auto", law))])


def _joints(proposal: Proposal) -> str:
    tables = []
    for joint in proposal.joints:
        gap = f", {show(joint.gap, 'm')} apart" if abs(joint.gap) > 1e-9 else ""
        faces = _line("faces", joint.faces, f"{show_area(joint.area)}{gap}")
        tables.append(_table("[[joint]]", _line("name", joint.name), faces))
    return "\n".join(tables)


def _bolt(bolt: BoltProposal, answers: Answers) -> str:
    meshed, drawn = bolt.part is not None, bolt.drawn
    density = CATALOGUE[STEEL].density or 0.0
    volumes = (None, None) if drawn is None else drawn.volumes
    head_mass, nut_mass = (
        "" if not one or one * density < MIN_MASS else show(one * density, "kg", digits=6) for one in volumes
    )
    if answers.preload is not None:
        preload = _line("preload", show(answers.preload, "N", digits=6))
    elif bolt.force is not None:
        preload = _line("preload", f"{bolt.force:.9g} N", "ASSUMED: the force of the file, taken as newtons")
    elif bolt.preload is not None:
        preload = _line("preload", show(bolt.preload, "N"), f"ASSUMED: {_share()}")
    else:
        preload = '# preload = "10 kN"  # give the force; its thread is not known'
    return _table(
        _comment(bolt.remark),
        "[[bolt]]",
        _line("name", bolt.name),
        _line("faces", bolt.faces),
        _line("part", bolt.part),
        _line("at", bolt.at and _millimetres(bolt.at)),
        _line("seat", bolt.ring and [_length(diameter) for diameter in bolt.ring]),
        _line("thread", meshed and bolt.graded and f"M{bolt.size:g}"),
        _line("diameter", not meshed and f"{bolt.size:g} mm"),
        _line("material", not meshed and STEEL),
        _line("grade", bolt.graded and GRADE, "ASSUMED"),
        _line("head", bolt.shape != "hexagon" and bolt.shape),
        _line("engaged", _length(bolt.engaged)),
        _line("shank", drawn and _length(drawn.shank)),
        _line("head_mass", head_mass, "drawn: what of its bodies is not the shank"),
        _line("nut_mass", nut_mass, "drawn: nut, or end of the screw"),
        preload,
        *map(_washer, () if drawn is None else drawn.washers),
    )


def _washer(sizes: tuple[float, float, float]) -> str:
    lengths = zip(("inner", "outer", "thickness"), map(_length, sizes), strict=True)
    lines = [_line(key, length) for key, length in lengths]
    return _table("[[bolt.washer]]", *lines, _line("material", STEEL)).rstrip()


def _dowel(dowel: DowelProposal) -> str:
    return _table(
        _comment(dowel.remark),
        "[[dowel]]",
        _line("name", dowel.name),
        _line("walls", dowel.walls, "ASSUMED: it fits them without play"),
        _line("ends", dowel.ends and [_millimetres(end) for end in dowel.ends]),
        _line("material", STEEL, "ASSUMED"),
    )


def _share() -> str:
    scatter = TIGHTENING[DEFAULT_WAY].scatter
    return f"class {GRADE}: stress at assembly {TIGHTENED:.0%} of yield at {1 + scatter:.2f} times it (VDI 2230, R7)"


def _assumed_of_bolts(bolts: Sequence[BoltProposal], answers: Answers) -> list[str]:
    """What is assumed of the bolts; those that are alike have one line."""
    remarks = [(bolt.name, bolt.remark) for bolt in bolts]
    for bolt in bolts if answers.preload is None else ():
        if bolt.force is not None:
            words = f"{bolt.force:.9g} N, the force of the file taken as newtons"
        elif bolt.preload is not None:
            words = f"{show(bolt.preload, 'N')}, {_share()}"
        else:
            words = "no preload; its thread is not known: give one"
        remarks.append((bolt.name, words))
    return alike(remarks)


def alike(remarks: Iterable[tuple[str, str]], kind: str = "bolt") -> list[str]:
    """What is said of each name; names of which one thing is said have one line."""
    groups: dict[str, list[str]] = {}
    for name, words in remarks:
        groups.setdefault(words, []).append(name)
    return [f"{grouped(names, kind)}: {words}" for words, names in groups.items()]


def _millimetres(point: Sequence[float]) -> list[str]:
    """A point [m] as the study writes it."""
    return [f"{1e3 * x:.9g} mm" for x in point]


def _relative(file: Path, out: Path) -> str:
    """The name of a file as the study names it: relative to the study's folder."""
    return Path(os.path.relpath(file.resolve(), out.resolve().parent)).as_posix()


def _plain(text: str) -> str:
    """Text on one line, for comments: a comment with a line break would begin a line of the study."""
    return "".join(letter if letter.isprintable() else " " for letter in text)


def summary(written: Written, study: Path) -> Sequence[str]:
    """What the terminal shows: what was found, what was assumed, and what to do next."""
    return [
        f"found: {written.found}",
        *(f"assumed: {line}" for line in written.assumed),
        f"written: {', '.join(str(file) for file in written.files)}",
        f"next: faying check {study}, then faying run {study}",
    ]
