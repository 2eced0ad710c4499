"""The study file: what a user writes in TOML, checked and in SI units."""

from collections.abc import Mapping, Sequence
from copy import deepcopy
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Self

from faying.bolt.bolt import Bolt
from faying.bolt.dowel import Dowel
from faying.bolt.solid_bolt import SolidBolt
from faying.errors import InputError, ReadError
from faying.joint.attachments import PointMass, Support
from faying.joint.modal import ModesChoice
from faying.joint.preload_case import NO_MEMORY, NO_SHANK, PreloadCase, after_greatest, each_once, with_history
from faying.materials import Material
from faying.misuse import checked_call, shortened
from faying.study.declaration.declared import NAME, Declared, Inner, Key
from faying.study.declaration.reader import Faults, Table
from faying.study.keys.alternative import AlternativeChoice
from faying.study.keys.backbone import BackboneChoice
from faying.study.keys.bolt import read_bolt
from faying.study.keys.bolt_sheet import BoltSheetChoice, read_bolt_sheets
from faying.study.keys.dowel import read_dowels
from faying.study.keys.geometry import GeometryChoice, read_geometry
from faying.study.keys.joint import JointChoice, read_joints
from faying.study.keys.law import LAW, LawChoice
from faying.study.keys.load import read_loads
from faying.study.keys.material import PartTestChoice, read_materials, read_parts
from faying.study.keys.solution import ResponseChoice, read_modes, read_order, read_response
from faying.study.keys.support import read_mass, read_support
from faying.study.keys.surface import SurfaceChoice
from faying.study.keys.tables import STUDY
from faying.study.keys.test import HammerChoice, TestChoice, read_test
from faying.study.keys.uncertain import Known, UncertainChoice, extracted, read_uncertain
from faying.study.keys.varied import varied
from faying.study.keys.vibration import read_vibrations
from faying.study.load import Load
from faying.study.vibration import Excitation
from faying.style import Summary
from faying.text import toml

FOLDER, PLAIN = "results", "study"  # the folder, and the name of the study whose files lie in it directly


def results_folder(folder: Path, name: str) -> Path:
    """The folder of the results of a study.

    Args:
        folder: that of the study file.
        name: of the study file, without its suffix.

    Returns:
        `results` for `study.toml`, `results/NAME` for `NAME.toml`.
    """
    return folder / FOLDER if name == PLAIN else folder / FOLDER / name


@checked_call
@dataclass(frozen=True, kw_only=True, repr=False)
class Study(Summary):
    """One whole study. Read it with Study.read(path); every fault of the file is reported in one InputError.

    Args:
        title, folder: what it is called; where file names start from.
        name: of the study file, without its suffix.
        text, data: the study file as it was read, and its tables.
        files: all files that it names, so that a result depends on them.
        materials, parts: materials by name; name of the material of each part.
        geometry, surface, law, joints, bolts, dowels: tables of the file.
        supports, masses, modes, response, test, hammer: others.
        parts_loss: loss factor of the parts themselves [-].
        bonds: joints whose faces are welded or glued; `joints` are the others.
        backbone: which curve over amplitude is asked for; None where the file does not say.
        alternatives: other laws and surfaces whose modes stand beside those of the study.
        bolt_sheets: what is said for the sheets of the bolts.
        load_cases: what acts on the preloaded structure.
        vibrations: what shakes it in service.
        part_tests: what was measured of parts alone.
        uncertain: which numbers scatter; None where the file does not say.
        order: the order of tightening as indices of bolts, pass after pass; None where all are pulled at once.
    """

    title: str
    folder: Path
    materials: dict[str, Material]
    geometry: GeometryChoice
    parts: dict[str, str]
    surface: SurfaceChoice | None
    law: LawChoice
    joints: tuple[JointChoice, ...]
    bolts: tuple[Bolt | SolidBolt, ...]
    preloads: tuple[PreloadCase, ...]
    supports: tuple[Support, ...] = ()
    masses: tuple[PointMass, ...] = ()
    dowels: tuple[Dowel, ...] = ()
    modes: ModesChoice = field(default_factory=ModesChoice)
    response: ResponseChoice | None = None
    parts_loss: float = 0.0
    test: TestChoice | None = None
    hammer: HammerChoice | None = None
    backbone: BackboneChoice | None = None
    alternatives: tuple[AlternativeChoice, ...] = ()
    uncertain: UncertainChoice | None = None
    bonds: tuple[JointChoice, ...] = ()
    name: str = PLAIN
    bolt_sheets: tuple[BoltSheetChoice, ...] = ()
    load_cases: tuple[Load, ...] = ()
    vibrations: tuple[Excitation, ...] = ()
    part_tests: Mapping[str, PartTestChoice] = field(default_factory=dict)
    text: str = field(default="", repr=False)
    data: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)
    files: tuple[Path, ...] = ()

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and what the study holds."""
        law = "; ".join(dict.fromkeys(self.law_of(joint).model for joint in self.joints))
        preloads = ", ".join(f"{load / 1e3:g}" for load in self.loads)
        rows = {
            "geometry": self.geometry.file.name,
            "parts": ", ".join(f"{part} ({material})" for part, material in self.parts.items()),
            **({"joints": f"{', '.join(joint.name for joint in self.joints)} ({law})"} if self.joints else {}),
            **({"bolts": f"{', '.join(bolt.name for bolt in self.bolts)}, {preloads} kN"} if self.bolts else {}),
            **({"dowels": ", ".join(dowel.name for dowel in self.dowels)} if self.dowels else {}),
            "supports": str(len(self.supports)) if self.supports else "none: free",
            "modes": str(self.modes.count),
            "asks for": ", ".join(self._asked) or "modes",
        }
        return f"Study {self.title!r}", {
            name: text if len(text) <= 90 else f"{text[:87]}..." for name, text in rows.items()
        }

    @property
    def _asked(self) -> list[str]:
        every = {
            "test": self.test or self.hammer,
            "response": self.response,
            "backbone": self.backbone,
            "alternatives": self.alternatives,
            "load cases": self.load_cases,
            "vibration": self.vibrations,
            "bolt sheets": self.bolt_sheets,
            "scatter": self.uncertain,
            "tests of parts": self.part_tests,
        }
        return [name for name, there in every.items() if there]

    @property
    def results(self) -> Path:
        """The folder of its results: `results` for study.toml, `results/NAME` for NAME.toml."""
        return results_folder(self.folder, self.name)

    @property
    def loads(self) -> tuple[float, ...]:
        """Preloads of the first bolt [N], by which results know them."""
        return tuple(case.preload for case in self.preloads)

    @property
    def load_names(self) -> tuple[str, ...]:
        """What messages call them, each once."""
        return each_once(case.name for case in self.preloads)

    @property
    def is_settled(self) -> bool:
        """Whether the joints have carried the greatest preload before."""
        return any(joint.state == "settled" for joint in self.joints)

    @property
    def assumes_scatter(self) -> bool:
        """Whether what [uncertain] does not list scatters as it is assumed of bolted structures."""
        return self.uncertain is None or not self.uncertain.only

    @property
    def in_order(self) -> bool:
        """Whether the bolts are tightened one after another."""
        return any(case.order is not None for case in self.preloads)

    @property
    def bolt_forces(self) -> dict[str, tuple[float, ...]]:
        """Force [N] of each bolt at each preload, by its name."""
        return {bolt.name: tuple(case.forces[k] for case in self.preloads) for k, bolt in enumerate(self.bolts)}

    def law_of(self, joint: JointChoice) -> LawChoice:
        """The law of a joint: its own, or that of the study."""
        return joint.law or self.law

    @checked_call
    def with_(self, path: str, value: Any) -> "Study":
        """Return the study with one thing changed, read anew with all its checks.

        Args:
            path: A key, as `geometry.size`; in a list of tables for all entries, as `bolt.preload`, or for one by its
                name, as `bolt.left.preload`. Quotes stand around a name with blanks.
            value: Text with a unit, as in the file, or numbers in SI units; a mapping for a whole table; None takes the
                key out.

        Raises:
            InputError: The path leads nowhere, or what is written there cannot be; with what is allowed.
        """
        data = with_value(self.data, path, value)
        text = f"{self.text.rstrip()}\n# changed in Python: {path} = {shortened(value)}\n"
        return replace(Study.from_dict(data, folder=self.folder, where=f"{path} changed", text=text), name=self.name)

    @classmethod
    @checked_call
    def read(cls, path: "str | Path | Study") -> "Study":
        """Read a study file. ReadError where there is none or it is not TOML, InputError with all faults otherwise.

        A study that is read already comes back as it is.
        """
        if isinstance(path, Study):
            return path
        file = Path(path)
        if not file.is_file():
            raise ReadError(f"no file {file}; write one with: faying init {file}")
        try:
            text = file.read_text(encoding="utf-8")
            data = toml(text)
        except ValueError as fault:  # of TOML, of UTF-8, or of an integer of thousands of digits
            text = str(fault).partition("; use sys.")[0]
            raise ReadError(f"{file} is not TOML: {text}") from None
        study = cls.from_dict(data, folder=file.resolve().parent, where=str(file), text=text)
        return replace(study, name=file.stem)

    @classmethod
    def read_bolted(cls, path: "str | Path | Study", *, first_loading: bool = False) -> "Study":
        """As `read`, for work on joints under preload. Raises InputError also where there is none.

        first_loading: whether the work knows joints on first loading alone; raises where a joint has carried more.
        """
        study = cls.read(path)
        if not study.joints:
            raise InputError("this needs joints that bolts press together, and the study has none; see faying run")
        if first_loading and any(case.after for case in study.preloads):
            raise InputError(
                "this takes joints on first loading, and those of the study have carried more before: give preloads "
                'that rise, and leave out state = "settled"; faying run takes both'
            )
        return study

    @classmethod
    def from_dict(cls, data: dict[str, Any], *, folder: Path, where: str = "study", text: str = "") -> Self:
        """Check a study given as nested dictionaries (as TOML gives them); file names are relative to `folder`."""
        faults = Faults(folder=folder)
        given, inside = extracted(data)
        top = Table(given, "", faults, STUDY)
        title = top.get("title")
        materials = read_materials(top)
        geometry = read_geometry(top)
        parts, part_tests = read_parts(top, materials)
        joints, bonds = read_joints(top)
        law = LawChoice.of(top.table("law") or Table({}, "law", faults, LAW.keys))
        surface = top.inner("surface", SurfaceChoice.of)
        alternatives = tuple(AlternativeChoice.of(t, i) for i, t in enumerate(top.tables("alternative")))
        backbone = top.inner("backbone", BackboneChoice.of)
        _note_states(faults, joints)
        _note_lacking_laws(faults, joints, (law, surface), alternatives, backbone)
        bolts, forces = _bolts(top, materials, joints)
        cases, vibrations = read_loads(top.tables("load")), read_vibrations(top.tables("vibration"))
        names = [bolt.name for bolt in bolts]
        sheets = read_bolt_sheets(top.tables("bolt_sheet"), bolts, [load.name for load in cases])
        supports, masses = top.every("support", read_support), top.every("mass", read_mass)
        dowels = read_dowels(top.tables("dowel"), materials)
        modes = top.inner("modes", read_modes) or ModesChoice()
        order = top.inner("tightening", lambda table: read_order(table, names))
        response, parts_loss = top.inner("response", read_response) or (None, 0.0)
        test, hammer = read_test(top, max(forces, key=len, default=(0.0,)))
        geometry = _with_selectors(geometry, faults)
        count = max(map(len, forces), default=1)
        known = Known(joints=joints, bolts=names, loads=count, materials=materials, parts=parts)
        uncertain = read_uncertain(top.inner("uncertain", lambda table: table.data), inside, known, faults)
        faults.raise_if_any(where)
        return cls(
            title=title,
            folder=folder,
            materials=materials,
            geometry=geometry,
            parts=parts,
            part_tests=part_tests,
            surface=surface,
            law=law,
            joints=joints,
            bonds=bonds,
            bolts=bolts,
            preloads=_preloads(forces, order, joints, bolts),
            modes=modes,
            response=response,
            parts_loss=parts_loss,
            test=test,
            hammer=hammer,
            backbone=backbone,
            alternatives=alternatives,
            uncertain=uncertain,
            bolt_sheets=sheets,
            load_cases=cases,
            vibrations=vibrations,
            dowels=dowels,
            supports=supports,
            masses=masses,
            text=text,
            data=data,
            files=tuple(dict.fromkeys(faults.files)),
        )


def _bolts(
    top: Table, materials: dict[str, Material], joints: tuple[JointChoice, ...]
) -> tuple[tuple[Bolt | SolidBolt, ...], tuple[tuple[float, ...], ...]]:
    """Read [[bolt]], with the forces [N] of each; faults: other numbers of preloads, joints without bolts, or none."""
    _note_unpressed(top, joints)
    read = [read_bolt(t, i, materials) for i, t in enumerate(top.tables("bolt"))]
    counts = {len(forces) for _, forces in read if forces}
    if len(counts) > 1:
        many = " and ".join(map(str, sorted(counts)))
        top.faults.add(f"the bolts have {many} preloads; give each bolt the same number")
    return tuple(bolt for bolt, _ in read if bolt is not None), tuple(forces for _, forces in read if forces)


def _note_unpressed(top: Table, joints: tuple[JointChoice, ...]) -> None:
    """Note joints without a bolt, a bolt without a joint, and what is asked of joints where there are none."""
    if joints and "bolt" not in top.data:
        top.faults.add(
            "[[bolt]] is missing: nothing presses the joints; give bonded = true to those that are welded or glued"
        )
    if not joints:
        top.faults.lines += [
            f"{key} needs a [[joint]] that bolts press together, and the study has none"
            for key in ("bolt", "alternative", "backbone", "tightening")
            if key in top.data
        ]


def _with_selectors(geometry: GeometryChoice, faults: Faults) -> GeometryChoice:
    """The geometry with the selectors that stand in joints, bolts, dowels, supports and masses."""
    both = [name for name in faults.selectors if name in geometry.face]
    if both:
        faults.add(f"geometry.face.{both[0]!r} is the name that a selector elsewhere gets; choose another name")
    return replace(geometry, face={**geometry.face, **faults.selectors})


def _note_states(faults: Faults, joints: tuple[JointChoice, ...]) -> None:
    """Note joints of which some are settled and some are not."""
    states = {joint.state: joint.name for joint in joints}
    if len(states) > 1:
        faults.add(
            f'joint {states["settled"]!r} has state = "settled" and {states["first"]!r} has not; a structure was put '
            "together at once: give all joints the same state"
        )


def _preloads(
    forces: tuple[tuple[float, ...], ...],
    order: tuple[int, ...] | None,
    joints: tuple[JointChoice, ...],
    bolts: tuple[Bolt | SolidBolt, ...],
) -> tuple[PreloadCase, ...]:
    """The preloads with what the joints carried before each, from the forces [N] of each bolt."""
    soft = [bolt.name for bolt in bolts if isinstance(bolt, Bolt) and bolt.diameter is None]
    if order is not None and soft:
        raise InputError(f"tightening: {NO_SHANK.format(', '.join(soft))}")
    cases = [PreloadCase(forces=one, order=order) for one in (zip(*forces, strict=True) if forces else [()])]
    found = (after_greatest if any(joint.state == "settled" for joint in joints) else with_history)(cases)
    per_node = [joint.name for joint in joints if joint.springs == "per-node"]
    if per_node and any(case.after for case in found):
        raise InputError(NO_MEMORY.format(per_node[0]))
    return found


def _note_lacking_laws(
    faults: Faults,
    joints: tuple[JointChoice, ...],
    shared: tuple[LawChoice, SurfaceChoice | None],
    alternatives: tuple[AlternativeChoice, ...],
    backbone: BackboneChoice | None,
) -> None:
    """Note what the laws of the study, of [[alternative]] and of [backbone] do not find in the surfaces."""
    _note_lacking(faults, joints, *shared)
    changes = [(f"alternative[{number}]: ", one.law, one.surface) for number, one in enumerate(alternatives, 1)]
    changes += [("backbone.law: ", law, None) for law in (() if backbone is None else backbone.laws)]
    for where, law, surface in changes:
        changed = tuple(replace(j, law=law or j.law, surface=surface or j.surface) for j in joints)
        _note_lacking(faults, changed, *shared, where)


def _note_lacking(
    faults: Faults, joints: tuple[JointChoice, ...], law: LawChoice, surface: SurfaceChoice | None, where: str = ""
) -> None:
    """Note every joint's law that its surface does not supply, before anything is read or meshed."""
    known_lines = {line.removeprefix(where) for line in faults.lines}
    for number, joint in enumerate(joints, start=1):
        choice = joint.surface or surface
        there = "no" if choice is None else "fractal" if choice.scan is None else "scan"
        fault = (joint.law or law).fault_without(there)
        if fault and not fault.startswith("[surface]"):
            fault = f"{f'joint[{joint.number or number}].law' if joint.law else 'law'}: {fault}"
        if fault and fault not in known_lines:
            known_lines.add(fault)
            faults.add(where + fault)


def with_value(data: Mapping[str, Any], path: str, value: Any) -> dict[str, Any]:
    """The tables of a study with another value at a path.

    Args:
        data: the tables, as TOML gives them.
        path: keys with dots between them, as `geometry.size`; in a list of tables for all entries, as `bolt.preload`,
            or for one by its name, as `bolt.left.preload`. A name with other signs than letters, digits, - and _ stands
            in quotes: `part."upper half".material`.
        value: text with a unit, or a number or several in SI units; a mapping for a table; None takes the key out.

    Raises:
        InputError: the path leads nowhere, with what there is.
    """
    out = deepcopy(dict(data))
    _set(out, STUDY, _parts(path), value, path)
    return out


def _parts(path: str) -> list[str]:
    wrong = InputError(f"path = {shortened(path)} should be keys with dots between them, such as bolt.preload")
    if "\n" in path:
        raise wrong
    try:
        table: Any = toml(f"{path} = 0")
    except ValueError:
        raise wrong from None
    parts = []
    while isinstance(table, dict):
        ((name, table),) = table.items()
        parts.append(name)
    return parts


def _set(table: dict[str, Any], keys: Declared, parts: Sequence[str], value: Any, path: str) -> None:
    name, rest = parts[0], parts[1:]
    what = keys.get(name) or keys.get(NAME)
    if what is None:
        near = get_close_matches(name, keys, n=1)
        hint = f"did you mean {near[0]}?" if near else f"give one of {', '.join(keys)}"
        raise InputError(f'"{path}" is not a key of a study: {name!r}; {hint}')
    if not rest:
        if value is None:
            table.pop(name, None)
        else:
            table[name] = _written(what, value)
    elif isinstance(what, Key):
        raise InputError(f'"{path}": {name} has no other keys; leave out {".".join(rest)}')
    elif what.many:
        _set_in_list(table, what, parts, value, path)
    else:
        of_laws = {key: one for found in what.models().values() for key, one in found.items()}
        _set(table.setdefault(name, {}), {**what.keys, **of_laws}, rest, value, path)


def _set_in_list(table: dict[str, Any], what: Inner, parts: Sequence[str], value: Any, path: str) -> None:
    """Set a value in all tables of a list, or in the one that the next part names."""
    name, rest = parts[0], parts[1:]
    found = table.get(name, [])
    every = [found] if isinstance(found, dict) else found
    if not every:
        raise InputError(f'"{path}": the study has no [[{name}]]')
    chosen = every
    if rest[0] not in what.keys:
        names = [one.get("name", f"{name} {k}") for k, one in enumerate(every, start=1)]
        chosen, rest = [one for one, own in zip(every, names, strict=True) if own == rest[0]], rest[1:]
        if not chosen:
            near = get_close_matches(parts[1], what.keys, n=1)
            hint = f"; did you mean {near[0]}?" if near else ""
            number = varied(path)
            if number is not None and number.owner is None:
                raise InputError(f'"{path}" is not a key of [[{name}]]; sweeps and [uncertain] vary it')
            raise InputError(f'"{path}": no {name} is called {parts[1]!r}; give one of {", ".join(names)}{hint}')
        if not rest:
            raise InputError(f'"{path}" is a {name}, not a key; add one of its keys: {", ".join(what.keys)}')
    for one in chosen:
        _set(one, what.keys, rest, value, path)


def _written(what: Key | Inner, value: Any) -> Any:
    """A value as a study file has it: numbers of a quantity get their unit."""
    if isinstance(what, Inner):
        return deepcopy(value)
    if isinstance(value, list | tuple):
        return [_written(what, one) for one in value]
    if isinstance(value, Mapping):
        return {key: _written(what, one) for key, one in value.items()}
    if hasattr(value, "item"):  # of numpy
        value = value.item()
    if what.unit and isinstance(value, int | float) and not isinstance(value, bool):
        return f"{value!r} {what.unit}"
    return value
