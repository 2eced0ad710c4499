"""The study file: what a user writes in TOML, checked and in SI units."""

import tomllib
from dataclasses import dataclass, field
from itertools import pairwise
from math import isclose
from pathlib import Path
from typing import Any, Literal, Self

from faying.errors import InputError, ReadError
from faying.materials import CATALOGUE, Material
from faying.study.geometry import GeometrySpec, path_in, point_of, read_geometry
from faying.study.reader import Faults, Table, number, quantity

LAW_NUMBERS = ("gamma", "alpha", "cutoff", "shear_ratio", "psi", "modulus_ratio")


@dataclass(frozen=True, kw_only=True)
class SurfaceSpec:
    """The rough surface: a scan with its units and estimator, or D, G [m] and scan_area [m2] as given."""

    scan: Path | None = None
    xy_unit: str | None = None
    z_unit: str | None = None
    method: str = "psd"
    D: float | None = None
    G: float | None = None
    scan_area: float | None = None


@dataclass(frozen=True, kw_only=True)
class LawSpec:
    """The contact law of the joints and its options."""

    model: str = "jk"
    counterbody: Literal["part", "rigid"] = "part"
    options: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class JointSpec:
    """Two faces that meet."""

    name: str
    faces: tuple[str, str]
    springs: Literal["per-area", "per-node"] = "per-area"
    tangential: Literal["law", "mindlin"] = "law"


@dataclass(frozen=True, kw_only=True)
class BoltSpec:
    """A bolt that pulls two faces towards each other with each of the preloads [N] in turn."""

    name: str
    faces: tuple[str, str]
    preload: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class TestSpec:
    """Measured frequencies [Hz] per load, the published model's where there is one, and what the test can see.

    A mode is seen where its motion along `direction` at one of `points` [m] is at least `threshold` of the largest
    among the modes.
    """

    source: str
    frequencies: tuple[tuple[float, ...], ...]
    published: tuple[tuple[float, ...], ...] | None
    published_name: str
    direction: tuple[float, float, float]
    points: tuple[tuple[float, float, float], ...]
    threshold: float = 0.1


@dataclass(frozen=True, kw_only=True)
class Study:
    """One whole study. Read it with Study.read(path); every fault of the file is reported in one InputError."""

    title: str
    folder: Path
    materials: dict[str, Material]
    geometry: GeometrySpec
    parts: dict[str, str]
    surface: SurfaceSpec
    law: LawSpec
    joints: tuple[JointSpec, ...]
    bolts: tuple[BoltSpec, ...]
    mode_count: int = 10
    solver: str | None = None
    shift_frequency: float | None = None
    test: TestSpec | None = None

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
        surface = _surface(top, folder)
        law = _law(top)
        joints = tuple(_joint(t, i) for i, t in enumerate(top.tables("joint", required=True)))
        bolts = tuple(_bolt(t, i) for i, t in enumerate(top.tables("bolt", required=True)))
        counts = {len(b.preload) for b in bolts if b.preload}
        if len(counts) > 1:
            faults.add(
                f"the bolts have {' and '.join(map(str, sorted(counts)))} preloads; give each bolt the same number"
            )
        modes = top.table("modes") or Table({}, "modes", faults)
        mode_count = modes.count("count", 10)
        solver = modes.text("solver", None, ("pardiso", "mumps", "cholmod", "superlu"))
        shift = modes.quantity("shift_frequency", "Hz", None)
        modes.close()
        test = _test(top, max(counts, default=0))
        top.close()
        faults.raise_if_any(where)
        return cls(title=title, folder=folder, materials=materials, geometry=geometry, parts=parts, surface=surface,
                   law=law, joints=joints, bolts=bolts, mode_count=mode_count, solver=solver, shift_frequency=shift,
                   test=test)  # fmt: skip


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


def _surface(top: Table, folder: Path) -> SurfaceSpec:
    table = top.table("surface", required=True) or Table({}, "surface", Faults())
    given = "scan" in table.data
    spec = SurfaceSpec(
        scan=table.take("scan", path_in(folder), None),
        xy_unit=table.text("xy_unit", None),
        z_unit=table.text("z_unit", None),
        method=table.text("method", "psd"),
        D=table.number("D", None),
        G=table.quantity("G", "m", None),
        scan_area=table.quantity("scan_area", "m^2", None),
    )
    if not given and "scan" not in table.data:
        lacking = [k for k in ("D", "G", "scan_area") if k not in table.data]
        if lacking:
            table.faults.add(f"surface: give scan, or D, G and scan_area ({', '.join(lacking)} missing)")
    if spec.D is not None and not 2 < spec.D < 3:
        table.faults.add(f"surface.D = {spec.D}: the dimension of a surface lies between 2 and 3, for example 2.4")
    table.close()
    return spec


def _law(top: Table) -> LawSpec:
    table = top.table("law") or Table({}, "law", top.faults)
    options: dict[str, Any] = {key: value for key in LAW_NUMBERS if (value := table.number(key, None)) is not None}
    for key, choices in (("closure", ("consistent", "printed")), ("loss", ("held", "literal"))):
        if (chosen := table.text(key, None, choices)) is not None:
            options[key] = chosen
    share = table.take("substrate", lambda v, name: v if v == "exact" else number(v, name), None)
    if share is not None:
        options["substrate"] = share
    model = table.take("model", _known_law, "jk")
    counterbody = table.text("counterbody", "part", ("part", "rigid"))
    table.close()
    return LawSpec(model=model, counterbody=counterbody, options=options)


def _known_law(value: Any, name: str) -> str:
    from faying.contact.compare import ASPERITIES
    from faying.contact.registry import find_law

    if not isinstance(value, str):
        raise InputError(f"{name} = {value!r} should be text in quotes")
    if value.upper() not in ASPERITIES:
        find_law(value)
    return value


def _joint(table: Table, index: int) -> JointSpec:
    spec = JointSpec(
        name=table.text("name", f"joint {index + 1}"),
        faces=tuple(table.texts("faces", 2) or ("", "")),
        springs=table.text("springs", "per-area", ("per-area", "per-node")),
        tangential=table.text("tangential", "law", ("law", "mindlin")),
    )
    table.close()
    return spec


def _bolt(table: Table, index: int) -> BoltSpec:
    def preloads(value: Any, name: str) -> tuple[float, ...]:
        items = value if isinstance(value, list) else [value]
        if not items:
            raise InputError(f'{name} is empty; give one force or more, for example "12 kN"')
        loads = [quantity(v, "N", name, positive=False) for v in items]
        for text, load in zip(items, loads, strict=True):
            if load <= 0:
                raise InputError(f'{name} = "{text}": a preload pulls the joint together and must be positive')
        if any(b <= a or isclose(a, b) for a, b in pairwise(loads)):
            raise InputError(f"{name} = {value!r}: preloads must rise, since the law is one of loading; the joint remembers "
                             "the greatest load it has seen")  # fmt: skip
        return tuple(loads)

    spec = BoltSpec(
        name=table.text("name", f"bolt {index + 1}"),
        faces=tuple(table.texts("faces", 2) or ("", "")),
        preload=table.take("preload", preloads) or (),
    )
    table.close()
    return spec


def _test(top: Table, loads: int) -> TestSpec | None:
    table = top.table("test")
    if table is None:
        return None

    def rows(value: Any, name: str) -> tuple[tuple[float, ...], ...]:
        if not isinstance(value, list) or not all(isinstance(row, list) for row in value):
            raise InputError(f"{name} should be one list of frequencies for each preload")
        if len(value) != loads:
            raise InputError(f"{name} has {len(value)} rows for {loads} preloads; give one list for each")
        return tuple(tuple(quantity(v, "Hz", name) for v in row) for row in value)

    def points(value: Any, name: str) -> tuple[tuple[float, float, float], ...]:
        if not isinstance(value, list) or not value:
            raise InputError(f"{name} should be a list of points, each three lengths")
        return tuple(point_of(v, name) for v in value)

    def direction(value: Any, name: str) -> tuple[float, float, float]:
        if not isinstance(value, list) or len(value) != 3:
            raise InputError(f"{name} = {value!r} should be three numbers, for example [1, 0, 0]")
        x, y, z = (number(v, name) for v in value)
        if x == y == z == 0:
            raise InputError(f"{name} = {value!r} has no length")
        return x, y, z

    spec = TestSpec(
        source=table.text("source", ""),
        frequencies=table.take("frequencies", rows) or (),
        published=table.take("published", rows, None),
        published_name=table.text("published_name", "published"),
        direction=table.take("direction", direction) or (1.0, 0.0, 0.0),
        points=table.take("points", points) or (),
        threshold=table.number("threshold", 0.1),
    )
    table.close()
    return spec
