"""[[bolt]]: where a bolt is, what it is made of, and the forces or torques that tighten it."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import pairwise
from math import isclose
from operator import mul
from typing import Any

import numpy as np

from faying.bolt.bolt import BOLT_FRICTION, NUT_FACTOR, Bolt, Washer, torque_to_preload
from faying.bolt.solid_bolt import SolidBolt
from faying.bolt.threads import PROOF, Fastener, Thread
from faying.contact.parameter import Parameter
from faying.errors import InputError
from faying.materials import CATALOGUE, Material
from faying.study.declaration.declared import QUANTITY, REQUIRED, Declared, Inner, Key, one_or_more
from faying.study.declaration.reader import Table
from faying.study.declaration.values import quantity
from faying.study.keys.face import face_names, two_faces
from faying.study.keys.material import named_material

FRICTIONS = ("thread_friction", "head_friction")
# what a meshed bolt has already
OF_THE_MESH = ("material", "seat", "washer", "head_mass", "nut_mass", "engaged", "shank", "head")


def read_bolt(
    table: Table, index: int, materials: Mapping[str, Material]
) -> tuple[Bolt | SolidBolt | None, tuple[float, ...]]:
    """Read one [[bolt]] and its forces [N] at each preload; no bolt where its faults leave none."""
    name = table.get("name", f"bolt {index + 1}")
    faces = face_names(table, name)
    at, part, diameter, pitch = (table.get(key) for key in ("at", "part", "diameter", "pitch"))
    friction = (table.get("thread_friction"), table.get("head_friction"))
    thread, fastener = _thread(table, diameter, pitch, meshed=part is not None)
    bolt: Bolt | SolidBolt | None = None
    if part is not None:
        _note_solid(table, part)
        bolt = SolidBolt(name=name, part=part, faces=faces, at=at, fastener=fastener, friction=friction)
    else:
        material = named_material(table, materials, f"bolt {name!r}")
        washers = table.every("washer", lambda one: _washer(one, name, materials))
        given = {key: table.get(key) for key in ("seat", "head_mass", "nut_mass", "engaged", "shank", "head")}
        if diameter is not None and "material" not in table.data and thread is None:
            thread = table.made(lambda: Thread.near(diameter))  # the size of its thread, and no more
        idle = [key for key in ("head_mass", "nut_mass", "shank", "head") if key in table.data]
        if idle and "material" not in table.data:
            table.faults.add(
                f"bolt {name!r} has {' and '.join(idle)}, but no diameter and material: it is a force without "
                "stiffness and mass; give both, or leave that out"
            )
        if diameter is None and "material" in table.data:
            table.faults.add(
                f"bolt {name!r} has a material but no diameter; give both, or neither for a bolt without stiffness"
            )
        elif all(faces):  # else there is a fault already
            bolt = table.made(
                lambda: Bolt(
                    name=name,
                    faces=faces,
                    at=at,
                    diameter=None if material is None else diameter,
                    material=material,
                    washers=washers,
                    fastener=fastener,
                    thread=thread,
                    friction=friction,
                    **given,
                )
            )
    shown = bolt.metric if isinstance(bolt, Bolt) else None
    return bolt, _forces(table, bolt, thread or (shown if fastener is None else fastener.thread))


def _thread(
    table: Table, diameter: float | None, pitch: float | None, *, meshed: bool
) -> tuple[Thread | None, Fastener | None]:
    """The thread where it is given, by itself or by its pitch; and with its property class, where that is given."""
    grade, size_text = table.get("grade"), table.get("thread")
    if meshed and grade is None and size_text is not None:
        table.faults.add(
            f'{table.where}.thread is used with grade alone where the bolt is meshed; give grade, such as "8.8", or '
            "leave it out"
        )
        return None, None
    if grade is not None and size_text is None and diameter is None:
        table.faults.add(f'{table.where}.grade needs the size of the thread; give thread, such as "M8"')
        return None, None

    def made() -> Thread | None:
        if size_text is not None:
            return Thread.parse(size_text)
        return None if pitch is None or diameter is None else Thread(diameter=diameter, pitch=pitch)

    thread = table.made(made)
    if thread is not None and pitch is not None and not isclose(thread.pitch, pitch, rel_tol=1e-6):
        table.faults.add(
            f'{table.where}: thread = "{size_text}" and pitch = {1e3 * pitch:g} mm differ; leave pitch out'
        )
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
            f"{table.where}.diameter is for torque only, since the part {part!r} has a shank of its own; leave it out"
        )


def _washer(table: Table, bolt: str, materials: Mapping[str, Material]) -> Washer | None:
    outer, inner, thickness = (table.get(key) for key in ("outer", "inner", "thickness"))
    material = named_material(table, materials, f"bolt {bolt!r}")
    if None in (outer, inner, thickness) or material is None:
        return None
    return Washer(outer=outer, inner=inner, thickness=thickness, material=material)


def _forces(table: Table, bolt: Bolt | SolidBolt | None, thread: Thread | None) -> tuple[float, ...]:
    """Forces [N], given as such or as torques with what turns them into forces."""
    forces, torques = table.get("preload"), table.get("torque")
    factor, pitch, *frictions = (table.get(key) for key in ("nut_factor", "pitch", *FRICTIONS))
    rubbing = [key for key in FRICTIONS if key in table.data]
    if "preload" not in table.data and "torque" not in table.data:
        table.faults.add(f'{table.where}.preload is missing; give a force such as "12 kN", or torque = "20 N m"')
    if "preload" in table.data and "torque" in table.data:
        table.faults.add(f"{table.where} has both preload and torque; give one of them")
    elif "preload" in table.data and "nut_factor" in table.data:
        table.faults.add(f"{table.where}.nut_factor turns a torque into a preload, which is given; leave it out")
    elif "nut_factor" in table.data and rubbing:
        table.faults.add(
            f"{table.where} has nut_factor and {' and '.join(rubbing)}, which all turn its torque into a preload; give "
            "nut_factor, or the frictions"
        )
    if any(key in table.data and table.get(key) is None for key in ("nut_factor", "pitch", *FRICTIONS)):
        return ()  # a fault is noted
    if torques is not None:
        diameter = table.get("diameter") if thread is None else thread.diameter
        if diameter is None:
            table.faults.add(f"{table.where}: a torque gives a preload only with the thread's diameter; add diameter")
            return ()
        ring = bolt.stated_ring if isinstance(bolt, Bolt) else None
        bearing = None if ring is None else sum(ring) / 2
        given = dict(zip(FRICTIONS, frictions, strict=True)) | {"nut_factor": factor, "bearing": bearing}
        pitch = pitch if thread is None else thread.pitch
        forces = table.made(lambda: tuple(torque_to_preload(t, diameter, pitch=pitch, **given) for t in torques))
    return forces or ()


def _tightened(unit: str, example: str, says: str) -> Key:
    """One quantity that tightens a bolt, or several, one after another."""

    def read(value: Any, name: str) -> tuple[float, ...]:
        written = unit.replace("*", " ")
        items = value if isinstance(value, list) else [value]
        if not items:
            raise InputError(f'{name} is empty; give one or more, for example "{example}"')
        loads = [quantity(v, written, name, positive=False) for v in items]
        for item, load in zip(items, loads, strict=True):
            if load <= 0:
                raise InputError(f'{name} = "{item}": a preload pulls the joint together and must be positive')
            quantity(item, written, name)  # refuses what no bolt can have
        if any(isclose(a, b) for a, b in pairwise(loads)):
            raise InputError(f"{name} = {value!r}: two in a row are the same; leave one out")
        return tuple(loads)

    return Key(f"quantity [{unit}], or a list", one_or_more(QUANTITY), says, read=read, unit=unit)


BOLT: Declared = {
    "name": Key.text("What tables call it.", "bolt 1"),
    "faces": two_faces("The two faces that head and nut press on."),
    "at": Key.point(
        "A point on the axis, where a face holds more than one seat; of a meshed bolt, where the shank is drawn in."
    ),
    "part": Key.text("The part that is the bolt, where it is meshed."),
    "diameter": Key.quantity(
        "m", "Diameter of the shank; with material, the bolt has stiffness and mass, else it is the size of the thread."
    ),
    "pitch": Key.quantity(
        "m",
        "Pitch of the thread, where it is not the coarse one; for its areas, and F = T/(0.16 P + 0.58 d2 mu + D_Km "
        "mu/2) of VDI 2230; D_Km is the mean diameter of the seat or washer, 1.3 d where neither is given.",
    ),
    "thread_friction": Key.within(*BOLT_FRICTION, "Coefficient of friction in the thread."),
    "head_friction": Key.within(*BOLT_FRICTION, "Coefficient of friction under the head."),
    "preload": replace(
        _tightened(
            "N",
            "12 kN",
            'One force, or several one after another: ["6 kN", "12 kN"]. They may fall, ["12 kN", "6 kN"]: then each '
            "point of the joints unloads from the greatest pressure that it has carried.",
        ),
        parameter=Parameter("N", "preload of the bolts", 0),
    ).varying(lambda forces, value: np.full_like(forces, value)),
    "torque": _tightened("N*m", "20 N m", "One tightening torque or several, in place of preload."),
    "nut_factor": Key.within(*NUT_FACTOR, "K of F = T/(K d)."),
    "grade": Key.text(
        'Property class of ISO 898-1, for example "8.8"; compares the preload with the proof load.',
        examples=lambda: PROOF,
    ),
    "thread": Key.text('Thread, for example "M8x1", where it is not the coarse one of the diameter.'),
    "material": Key.text("Material of the shank.", examples=lambda: CATALOGUE),
    "washer": Inner(
        says="Washers under head and nut together.",
        many=True,
        keys={
            "outer": Key.quantity("m", "Outer diameter.", REQUIRED),
            "inner": Key.quantity("m", "Inner diameter.", REQUIRED),
            "thickness": Key.quantity("m", "Thickness.", REQUIRED),
            "material": Key.text("Material.", REQUIRED, examples=lambda: CATALOGUE),
        },
    ),
    "seat": Key.quantities(
        'inner and outer diameter, for example ["8.4 mm", "16 mm"]',
        "m",
        2,
        "Inner and outer diameter of the ring that is pressed; that of the washer where left out, or else 1.5 "
        "diameters around the hole; the full face of a bolt with a nut and neither washer nor at.",
    ),
    "head_mass": Key.quantity("kg", "Mass of the head; of a hexagon head of the diameter where left out."),
    "nut_mass": Key.quantity(
        "kg", "Mass of the nut; of a hexagon nut of the diameter where left out, none in a tapped hole."
    ),
    "engaged": Key.quantity(
        "m",
        "Length of the thread in a tapped hole, whose wall is the second face; 1.5 diameters, or the depth of the "
        "hole, where left out.",
    ),
    "shank": Key.quantity(
        "m",
        "Length of the plain shank under the head. Where left out: 0, a thread up to the head; all of the free length "
        "for a diameter that is not that of the thread.",
        positive=False,
    ),
    "head": Key.text("The head of the screw.", "hexagon", ("hexagon", "socket")),
}

# numbers that vary and that no key of [[bolt]] holds
BOLT_FACTORS: Declared = {
    "factor": Key.of_parameter(Parameter("", "factor on the preload of the bolts", 0)).varying(mul),
}
