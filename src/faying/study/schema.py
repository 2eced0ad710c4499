"""The study file: what a user writes in TOML, checked and in SI units."""

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal, Self

from faying.errors import InputError, ReadError
from faying.materials import CATALOGUE, Material
from faying.study.connections import (
    BoltSpec,
    JointSpec,
    MassSpec,
    SupportSpec,
    bolt_spec,
    direction,
    joint_spec,
    mass_spec,
    support_spec,
)
from faying.study.contact import LawSpec, SurfaceSpec, law_spec, surface_spec
from faying.study.geometry import GeometrySpec, read_geometry
from faying.study.reader import Faults, Table, point
from faying.study.test import HammerSpec, TestSpec, read_test

Point = tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class ResponseSpec:
    """Frequency response: inputs and outputs as (point [m], direction), from first to last [Hz] in so many points."""

    inputs: tuple[tuple[Point, Point], ...]
    outputs: tuple[tuple[Point, Point], ...]
    first: float
    last: float
    points: int
    structural_loss: float


@dataclass(frozen=True, kw_only=True)
class Study:
    """One whole study. Read it with Study.read(path); every fault of the file is reported in one InputError."""

    title: str
    folder: Path
    materials: dict[str, Material]
    geometry: GeometrySpec
    parts: dict[str, str]
    surface: SurfaceSpec | None
    law: LawSpec
    joints: tuple[JointSpec, ...]
    bolts: tuple[BoltSpec, ...]
    supports: tuple[SupportSpec, ...] = ()
    masses: tuple[MassSpec, ...] = ()
    mode_count: int = 10
    damping: Literal["hysteretic", "viscous"] = "hysteretic"
    order: tuple[int, ...] | None = None
    response: ResponseSpec | None = None
    solver: str | None = None
    shift_frequency: float | None = None
    test: TestSpec | None = None
    hammer: HammerSpec | None = None

    @property
    def load_count(self) -> int:
        """How many preloads are run in turn."""
        return len(self.bolts[0].preload)

    @classmethod
    def read(cls, path: str | Path) -> Self:
        """Read a study file. ReadError where there is none or it is not TOML, InputError with all faults otherwise."""
        file = Path(path)
        if not file.is_file():
            raise ReadError(f"no file {file}; write one with: faying init {file}")
        try:
            data = tomllib.loads(file.read_text(encoding="utf-8"))
        except (tomllib.TOMLDecodeError, UnicodeDecodeError) as fault:
            raise ReadError(f"{file} is not TOML: {fault}") from None
        return cls.from_dict(data, folder=file.resolve().parent, where=str(file))

    @classmethod
    def from_dict(cls, data: dict[str, Any], *, folder: Path, where: str = "study") -> Self:
        """Check a study given as nested dictionaries (as TOML gives them); file names are relative to `folder`."""
        faults = Faults()
        top = Table(data, "", faults)
        title = top.text("title", "untitled")
        materials = _materials(top)
        geometry = read_geometry(top, folder)
        parts = _parts(top, materials)
        joints = tuple(joint_spec(t, i, folder) for i, t in enumerate(top.tables("joint", required=True)))
        law = law_spec(top.table("law") or Table({}, "law", faults), folder)
        shared = top.table("surface")
        if "surface" not in data:
            for text in dict.fromkeys((joint.law or law).lacking for joint in joints if joint.surface is None):
                if text:
                    faults.add(text)
        surface = None if shared is None else surface_spec(shared, folder)
        bolts = tuple(bolt_spec(t, i) for i, t in enumerate(top.tables("bolt", required=True)))
        supports = tuple(support_spec(t) for t in top.tables("support"))
        masses = tuple(mass_spec(t) for t in top.tables("mass"))
        _known_materials(bolts, materials, faults)
        counts = {len(b.preload) for b in bolts if b.preload}
        if len(counts) > 1:
            faults.add(
                f"the bolts have {' and '.join(map(str, sorted(counts)))} preloads; give each bolt the same number"
            )
        modes = top.table("modes") or Table({}, "modes", faults)
        mode_count = modes.count("count", 10)
        solver = modes.text("solver", None, ("pardiso", "mumps", "cholmod", "superlu"))
        shift = modes.quantity("shift_frequency", "Hz", None)
        damping = modes.text("damping", "hysteretic", ("hysteretic", "viscous"))
        modes.close()
        order = _order(top, bolts)
        response = _response(top)
        test, hammer = read_test(top, folder, max((b.preload for b in bolts if b.preload), key=len, default=()))
        top.close()
        faults.raise_if_any(where)
        return cls(
            title=title,
            folder=folder,
            materials=materials,
            geometry=geometry,
            parts=parts,
            surface=surface,
            law=law,
            joints=joints,
            bolts=bolts,
            supports=supports,
            masses=masses,
            mode_count=mode_count,
            damping=damping,
            order=order,
            response=response,
            solver=solver,
            shift_frequency=shift,
            test=test,
            hammer=hammer,
        )


def _materials(top: Table) -> dict[str, Material]:
    materials = dict(CATALOGUE)
    outer = top.table("material")
    for name in list(outer.data) if outer else []:
        table = outer.table(name) if outer else None
        if table is None:
            continue
        fields = {
            "E": table.quantity("E", "Pa"),
            "nu": table.number("nu"),
            "density": table.quantity("density", "kg/m^3"),
            "yield_strength": table.quantity("yield_strength", "Pa", None),
            "hardness": table.quantity("hardness", "Pa", None),
            "friction": table.number("friction", None),
        }
        table.text("source", "")
        table.close()
        if None not in (fields["E"], fields["nu"], fields["density"]):
            try:
                materials[name] = Material(name=name, **fields)
            except InputError as fault:
                top.faults.add(str(fault))
    return materials


def _known_materials(bolts: tuple[BoltSpec, ...], materials: dict[str, Material], faults: Faults) -> None:
    for bolt in bolts:
        if bolt.part is not None:  # its material is that of the part
            continue
        for name in (bolt.material, *(washer.material for washer in bolt.washers)):
            if name is not None and name not in materials:
                known = ", ".join(f'"{m}"' for m in materials)
                faults.add(f'bolt {bolt.name!r}: material "{name}" is unknown; known are {known}')
        if bolt.diameter is None and bolt.material is not None:
            faults.add(
                f"bolt {bolt.name!r} has a material but no diameter; give both, or neither for a bolt without stiffness"
            )


def _parts(top: Table, materials: dict[str, Material]) -> dict[str, str]:
    parts: dict[str, str] = {}
    outer = top.table("part", required=True)
    for name in list(outer.data) if outer else []:
        table = outer.table(name) if outer else None
        if table is None:
            continue
        material = table.text("material")
        if material is not None and material not in materials:
            known = ", ".join(f'"{m}"' for m in materials)
            top.faults.add(f'part.{name}.material = "{material}" is unknown; known are {known}')
        elif material is not None and materials[material].density is None:
            top.faults.add(f'part.{name}: material "{material}" has no density; modes need one')
        parts[name] = material
        table.close()
    return parts


def _order(top: Table, bolts: tuple[BoltSpec, ...]) -> tuple[int, ...] | None:
    """The order of tightening as indices of bolts, pass after pass; None where all are pulled at once."""
    table = top.table("tightening")
    if table is None:
        return None
    names = [bolt.name for bolt in bolts]

    def order(value: Any, name: str) -> tuple[int, ...]:
        if not isinstance(value, list) or any(v not in names for v in value) or set(value) != set(names):
            raise InputError(f"{name} = {value!r} should name every bolt: {', '.join(map(repr, names))}")
        return tuple(names.index(v) for v in value)

    found, passes = table.take("order", order), table.count("passes", 1)
    table.close()
    return None if found is None else found * passes


def _response(top: Table) -> ResponseSpec | None:
    table = top.table("response")
    if table is None:
        return None
    first, last = table.quantity("from", "Hz"), table.quantity("to", "Hz")
    if first is not None and last is not None and not first < last:
        table.faults.add(f"response: from = {first:g} Hz must lie below to = {last:g} Hz")
    sides = []
    for key in ("input", "output"):
        pairs = []
        for one in table.tables(key, required=True):
            pairs.append((one.take("point", point), one.take("direction", direction)))
            one.close()
        sides.append(tuple(pairs))
    spec = ResponseSpec(
        inputs=sides[0],
        outputs=sides[1],
        first=first,
        last=last,
        points=table.count("points", 1000),
        structural_loss=table.number("structural_loss", 0.0),
    )
    table.close()
    return spec
