"""[[bolt]]: where a bolt is, what it is made of, and the forces or torques that tighten it."""

from collections.abc import Mapping
from itertools import pairwise
from math import isclose
from typing import Any

from faying.bolt.bolt import Bolt, Washer, torque_to_preload
from faying.bolt.solid_bolt import SolidBolt
from faying.bolt.threads import Fastener, Thread
from faying.errors import InputError
from faying.materials import Material
from faying.study.keys.face import face_names
from faying.study.keys.reader import Table, point, quantity

OF_THE_MESH = (
    "material",
    "seat",
    "washer",
    "head_mass",
    "nut_mass",
    "engaged",
    "shank",
    "head",
)  # what a meshed bolt has already


def read_bolt(table: Table, index: int, materials: Mapping[str, Material]) -> Bolt | SolidBolt | None:
    """Read one [[bolt]]; None where its faults leave no bolt."""
    name = table.text("name", f"bolt {index + 1}")
    faces = face_names(table, "faces", name)
    at = table.take("at", point, None)
    part = table.text("part", None)
    diameter = table.quantity("diameter", "m", None)
    pitch = table.quantity("pitch", "m", None)
    friction = (table.number("thread_friction", None), table.number("head_friction", None))
    preload = _preload(table, diameter, pitch, friction)
    thread, fastener = _thread(table, diameter, pitch, meshed=part is not None)
    bolt: Bolt | SolidBolt | None
    if part is not None:
        _note_solid(table, part)
        bolt = SolidBolt(name=name, part=part, faces=faces, at=at, preload=preload, fastener=fastener)
    else:
        material = _material(table, "material", name, materials, optional=True)
        washers = tuple(_washer(t, name, materials) for t in table.tables("washer"))
        given: dict[str, Any] = {
            "seat": table.take("seat", _ring, None),
            "head_mass": table.quantity("head_mass", "kg", None),
            "nut_mass": table.quantity("nut_mass", "kg", None),
            "engaged": table.quantity("engaged", "m", None),
            "shank": table.quantity("shank", "m", None, positive=False),
            "head": table.text("head", "hexagon", ("hexagon", "socket")),
            "thread": thread,
            "friction": None if None in friction else friction,
        }
        if diameter is None and "material" in table.data:
            table.faults.add(
                f"bolt {name!r} has a material but no diameter; give both, or neither for a bolt without stiffness"
            )
            return None
        bolt = table.made(
            lambda: Bolt(
                name=name,
                faces=faces,
                at=at,
                diameter=None if material is None else diameter,  # it may be given for a torque alone
                material=material,
                washers=tuple(w for w in washers if w is not None),
                preload=preload,
                fastener=fastener,
                **given,
            )
        )
    table.close()
    return bolt


def _thread(
    table: Table, diameter: float | None, pitch: float | None, *, meshed: bool
) -> tuple[Thread | None, Fastener | None]:
    """The thread where it is given, by itself or by its pitch; and with its property class, where that is given."""
    grade, text = table.text("grade", None), table.text("thread", None)
    if meshed and grade is None and text is not None:
        table.faults.add(
            f'{table.where}.thread is used with grade alone where the bolt is meshed; give grade, such as "8.8", or '
            "leave it out"
        )
        return None, None
    if grade is not None and text is None and diameter is None:
        table.faults.add(f'{table.where}.grade needs the size of the thread; give thread, such as "M8"')
        return None, None

    def made() -> Thread | None:
        if text is not None:
            return Thread.parse(text)
        return None if pitch is None or diameter is None else Thread(diameter=diameter, pitch=pitch)

    thread = table.made(made)
    if thread is not None and pitch is not None and not isclose(thread.pitch, pitch, rel_tol=1e-6):
        table.faults.add(f'{table.where}: thread = "{text}" and pitch = {1e3 * pitch:g} mm differ; leave pitch out')
    if grade is None:
        return thread, None
    size = thread or table.made(lambda: Thread.coarse(diameter or 0.0))
    return thread, None if size is None else table.made(lambda: Fastener(thread=size, grade=grade))


def _note_solid(table: Table, part: str) -> None:
    meshed = [key for key in OF_THE_MESH if key in table.data]
    if meshed:
        table.faults.add(
            f"{table.where} is the part {part!r}, whose mesh has shank, head, nut and all; leave out "
            f"{', '.join(meshed)}"
        )
    for key in meshed:
        table.data.pop(key)
    if "diameter" in table.data and "torque" not in table.data:
        table.faults.add(
            f"{table.where}.diameter goes only with torque here, since the part {part!r} has a shank of its own; leave "
            "it out"
        )


def _material(
    table: Table, key: str, bolt: str, materials: Mapping[str, Material], *, optional: bool
) -> Material | None:
    name = table.text(key, None) if optional else table.text(key)
    if name is None or name in materials:
        return materials.get(name) if name is not None else None
    known = ", ".join(f'"{m}"' for m in materials)
    table.faults.add(f'bolt {bolt!r}: material "{name}" is unknown; known are {known}')
    return None


def _washer(table: Table, bolt: str, materials: Mapping[str, Material]) -> Washer | None:
    outer, inner, thickness = (table.quantity(key, "m") for key in ("outer", "inner", "thickness"))
    material = _material(table, "material", bolt, materials, optional=False)
    table.close()
    if None in (outer, inner, thickness) or material is None:
        return None
    return Washer(outer=outer, inner=inner, thickness=thickness, material=material)


def _ring(value: Any, name: str) -> tuple[float, float]:
    if not isinstance(value, list) or len(value) != 2:
        raise InputError(f'{name} = {value!r} should be inner and outer diameter, for example ["8.4 mm", "16 mm"]')
    inner, outer = (quantity(v, "m", name, positive=False) for v in value)
    return inner, outer


def _preload(
    table: Table, diameter: float | None, pitch: float | None, friction: tuple[float | None, float | None]
) -> tuple[float, ...]:
    """Forces [N], given as such or as torques with what turns them into forces."""
    forces = table.take("preload", lambda v, name: _rising(v, name, "N", "12 kN"), None)
    torques = table.take("torque", lambda v, name: _rising(v, name, "N m", "20 N m"), None)
    thread: dict[str, Any] = {
        "nut_factor": table.number("nut_factor", None),
        "pitch": pitch,
        "thread_friction": friction[0],
        "head_friction": friction[1],
    }
    if "preload" not in table.data and "torque" not in table.data:
        table.faults.add(f'{table.where}.preload is missing; give a force such as "12 kN", or torque = "20 N m"')
    if "preload" in table.data and "torque" in table.data:
        table.faults.add(f"{table.where} has both preload and torque; give one of them")
    if torques is not None:
        if diameter is None:
            table.faults.add(f"{table.where}: a torque gives a preload only with the thread's diameter; add diameter")
            return ()
        forces = table.made(lambda: tuple(torque_to_preload(t, diameter, **thread) for t in torques))
    return forces or ()


def _rising(value: Any, name: str, unit: str, example: str) -> tuple[float, ...]:
    items = value if isinstance(value, list) else [value]
    if not items:
        raise InputError(f'{name} is empty; give one or more, for example "{example}"')
    loads = [quantity(v, unit, name, positive=False) for v in items]
    for text, load in zip(items, loads, strict=True):
        if load <= 0:
            raise InputError(f'{name} = "{text}": a preload pulls the joint together and must be positive')
        quantity(text, unit, name)  # refuses what no bolt can have
    if any(b <= a or isclose(a, b) for a, b in pairwise(loads)):
        raise InputError(
            f"{name} = {value!r}: preloads must rise, since the law is one of loading; the joint remembers the "
            f"greatest "
            "load it has seen"
        )
    return tuple(loads)
