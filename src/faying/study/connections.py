"""What a study says of joints, bolts, supports and point masses."""

from dataclasses import dataclass
from itertools import pairwise
from math import isclose
from pathlib import Path
from typing import Any, Literal

from faying.errors import InputError
from faying.joint.bolt import torque_to_preload
from faying.study.contact import LawSpec, SurfaceSpec, law_spec, surface_spec
from faying.study.reader import Table, existing_path, number, point, quantity


@dataclass(frozen=True, kw_only=True)
class JointSpec:
    """Two faces that meet. surface and law: of this joint alone, those of the study where None. Lengths [m].

    gap_map: a file of x, y, gap [m] on the first face, with the joint's own axes (gap_origin, gap_x, gap_y).
    """

    name: str
    faces: tuple[str, str]
    springs: Literal["per-area", "per-node"] = "per-area"
    tangential: Literal["law", "mindlin"] = "law"
    friction: float | None = None
    reach: float | None = None
    surface: SurfaceSpec | None = None
    law: LawSpec | None = None
    gap_map: "GapSpec | None" = None


@dataclass(frozen=True, kw_only=True)
class GapSpec:
    """A measured gap (form error) between two faces: CSV or text of x, y, gap, with the units of the columns.

    origin (3,) [m], x_axis, y_axis (3,): where x = y = 0 lies in the structure and how the axes point.
    """

    file: Path
    xy_unit: str
    gap_unit: str
    origin: tuple[float, float, float]
    x_axis: tuple[float, float, float]
    y_axis: tuple[float, float, float]


@dataclass(frozen=True, kw_only=True)
class WasherSpec:
    """A washer: diameters and thickness [m], name of its material."""

    outer: float
    inner: float
    thickness: float
    material: str


@dataclass(frozen=True, kw_only=True)
class BoltSpec:
    """A bolt that pulls two faces towards each other with each of the preloads [N] in turn. Lengths [m], masses [kg].

    part: the part that is this bolt, where it is meshed; its faces are its own then.
    """

    name: str
    faces: tuple[str, str]
    preload: tuple[float, ...]
    part: str | None = None
    at: tuple[float, float, float] | None = None
    diameter: float | None = None
    material: str | None = None
    seat: tuple[float, float] | None = None
    washers: tuple[WasherSpec, ...] = ()
    head_mass: float | None = None
    nut_mass: float | None = None


@dataclass(frozen=True, kw_only=True)
class SupportSpec:
    """A face held in some directions, on springs per area [Pa/m] where stiffness is given."""

    face: str
    directions: tuple[str, ...]
    stiffness: float | None


@dataclass(frozen=True, kw_only=True)
class MassSpec:
    """A point mass [kg] on a face or at a point [m]."""

    mass: float
    face: str | None
    point: tuple[float, float, float] | None
    offset: tuple[float, float, float]


def direction(value: Any, name: str) -> tuple[float, float, float]:
    """Convert three numbers that are not all zero; InputError that shows the form."""
    if not isinstance(value, list) or len(value) != 3:
        raise InputError(f"{name} = {value!r} should be three numbers, for example [1, 0, 0]")
    x, y, z = (number(v, name) for v in value)
    if x == y == z == 0:
        raise InputError(f"{name} = {value!r} has no length")
    return x, y, z


def joint_spec(table: Table, index: int, folder: Path) -> JointSpec:
    """Read one [[joint]]."""
    own_surface, own_law, gap = table.table("surface"), table.table("law"), table.table("gap")
    spec = JointSpec(
        name=table.text("name", f"joint {index + 1}"),
        faces=tuple(table.texts("faces", 2) or ("", "")),
        springs=table.text("springs", "per-area", ("per-area", "per-node")),
        tangential=table.text("tangential", "law", ("law", "mindlin")),
        friction=table.number("friction", None),
        reach=table.quantity("reach", "m", None),
        surface=None if own_surface is None else surface_spec(own_surface, folder),
        law=None if own_law is None else law_spec(own_law, folder),
        gap_map=None if gap is None else _gap_spec(gap, folder),
    )
    table.close()
    return spec


def _gap_spec(table: Table, folder: Path) -> GapSpec:
    spec = GapSpec(
        file=table.take("file", existing_path(folder)),
        xy_unit=table.text("xy_unit"),
        gap_unit=table.text("gap_unit"),
        origin=table.take("origin", point, (0.0, 0.0, 0.0)),
        x_axis=table.take("x_axis", direction, (1.0, 0.0, 0.0)),
        y_axis=table.take("y_axis", direction, (0.0, 1.0, 0.0)),
    )
    table.close()
    return spec


def _lengths(value: Any, name: str) -> tuple[float, float]:
    if not isinstance(value, list) or len(value) != 2:
        raise InputError(f'{name} = {value!r} should be inner and outer diameter, for example ["8.4 mm", "16 mm"]')
    inner, outer = (quantity(v, "m", name, positive=False) for v in value)
    return inner, outer


def bolt_spec(table: Table, index: int) -> BoltSpec:
    """Read one [[bolt]]: preloads as forces, or torques with what turns them into forces."""
    part = table.text("part", None)
    meshed = [key for key in ("material", "seat", "washer", "head_mass", "nut_mass") if key in table.data]
    if part is not None and meshed:
        table.faults.add(
            f"{table.where} is the part {part!r}, whose mesh has shank, head, nut and all; leave out {', '.join(meshed)}"
        )
    diameter = table.quantity("diameter", "m", None)
    forces = table.take("preload", lambda v, name: _rising(v, name, "N", "12 kN"), None)
    torques = table.take("torque", lambda v, name: _rising(v, name, "N m", "20 N m"), None)
    if part is not None and diameter is not None and "torque" not in table.data:
        table.faults.add(
            f"{table.where}.diameter goes only with torque here, since the part {part!r} has a shank of its own; leave "
            "it out"
        )
    factor = table.number("nut_factor", None)
    pitch = table.quantity("pitch", "m", None)
    frictions = table.number("thread_friction", None), table.number("head_friction", None)
    if forces is None and torques is None and "preload" not in table.data and "torque" not in table.data:
        table.faults.add(f'{table.where}.preload is missing; give a force such as "12 kN", or torque = "20 N m"')
    if forces is not None and torques is not None:
        table.faults.add(f"{table.where} has both preload and torque; give one of them")
    if torques is not None:
        try:
            if diameter is None:
                raise InputError("a torque gives a preload only with the thread's diameter; add diameter")
            forces = tuple(
                torque_to_preload(
                    t,
                    diameter,
                    nut_factor=factor,
                    pitch=pitch,
                    thread_friction=frictions[0],
                    head_friction=frictions[1],
                )
                for t in torques
            )
        except InputError as fault:
            table.faults.add(f"{table.where}: {fault}")
    washers = tuple(_washer(t) for t in table.tables("washer"))
    spec = BoltSpec(
        name=table.text("name", f"bolt {index + 1}"),
        faces=tuple(table.texts("faces", 2) or ("", "")),
        preload=forces or (),
        part=part,
        at=table.take("at", point, None),
        diameter=diameter,
        material=table.text("material", None),
        seat=table.take("seat", _lengths, None),
        washers=washers,
        head_mass=table.quantity("head_mass", "kg", None),
        nut_mass=table.quantity("nut_mass", "kg", None),
    )
    table.close()
    return spec


def _washer(table: Table) -> WasherSpec:
    spec = WasherSpec(
        outer=table.quantity("outer", "m"),
        inner=table.quantity("inner", "m"),
        thickness=table.quantity("thickness", "m"),
        material=table.text("material"),
    )
    table.close()
    return spec


def _rising(value: Any, name: str, unit: str, example: str) -> tuple[float, ...]:
    items = value if isinstance(value, list) else [value]
    if not items:
        raise InputError(f'{name} is empty; give one or more, for example "{example}"')
    loads = [quantity(v, unit, name, positive=False) for v in items]
    for text, load in zip(items, loads, strict=True):
        if load <= 0:
            raise InputError(f'{name} = "{text}": a preload pulls the joint together and must be positive')
    if any(b <= a or isclose(a, b) for a, b in pairwise(loads)):
        raise InputError(
            f"{name} = {value!r}: preloads must rise, since the law is one of loading; the joint remembers "
            "the greatest load it has seen"
        )
    return tuple(loads)


def support_spec(table: Table) -> SupportSpec:
    """Read one [[support]]."""

    def axes(value: Any, name: str) -> tuple[str, ...]:
        if not isinstance(value, list) or not value or any(v not in ("x", "y", "z") for v in value):
            raise InputError(f'{name} = {value!r} should be some of "x", "y", "z" in a list')
        return tuple(value)

    spec = SupportSpec(
        face=table.text("face"),
        directions=table.take("directions", axes, ("x", "y", "z")),
        stiffness=table.quantity("stiffness", "Pa/m", None),
    )
    table.close()
    return spec


def mass_spec(table: Table) -> MassSpec:
    """Read one [[mass]]."""
    spec = MassSpec(
        mass=table.quantity("mass", "kg"),
        face=table.text("face", None),
        point=table.take("point", point, None),
        offset=table.take("offset", point, (0.0, 0.0, 0.0)),
    )
    if (spec.face is None) == (spec.point is None):
        table.faults.add(f"{table.where}: a mass sits on a face or at a point; give one of the two")
    table.close()
    return spec
