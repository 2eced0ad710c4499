"""A face by its name or by a selector: {part = "upper", normal = "+z"}."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.geometry.face_facts import Point
from faying.geometry.selectors import AXES, WITHIN, Selector
from faying.study.declaration.declared import INTEGER, REQUIRED, WORDS, Declared, Key, listed
from faying.study.declaration.reader import Table
from faying.study.declaration.values import direction, text, whole_number

TWO = '["upper.joint", "lower.joint"], or of selectors such as {part = "upper", touching = "lower"}'
SEVERAL = '["cover.pin", "frame.pin"], or of selectors such as {part = "cover", number = 7}'
FORM = '"upper.joint", or {part = "upper", normal = "+z"}'


def read_selector(table: Table) -> Selector | None:
    """Read the table of one selector; None where its faults leave none."""
    part = table.get("part")
    given: dict[str, Any] = {key: table.get(key) for key in SELECTOR if key != "part"}
    rules = [key for key in ("normal", "touching", "nearest", "number") if key in table.data]
    if not rules and part is not None:
        table.faults.add(
            f'{table.where} gives a part but no face of it; add normal = "+z", touching = "another part", '
            f'nearest = ["0 mm", "0 mm", "5 mm"] or number = 1 (`faying faces` lists them)'
        )
        return None
    if given["within"] is not None and given["nearest"] is None:
        table.faults.add(f"{table.where}.within needs nearest; give nearest too, or leave within out")
    if part is None or any(given[key] is None for key in rules):
        return None
    return Selector(part=part, **given | {"within": given["within"] or WITHIN})


def face_name(table: Table, label: str, key: str = "face") -> str | None:
    """Take a face: its name, or a selector, whose face gets the name `label`."""

    def named(value: Any, where: str) -> str:
        return _name(table, value, where, label) if isinstance(value, Mapping) else text(value, where)

    name: str | None = table.take(key, named)
    return name


def face_names(table: Table, label: str) -> tuple[str, str]:
    """Take two faces, by name or by selector; the face of a selector gets the name `label` with its place behind it."""
    found = _names(table, "faces", label, f"2 names, for example {TWO}", most=2)
    return (found[0], found[1]) if found else ("", "")


def several_names(table: Table, label: str) -> tuple[str, ...]:
    """Take two walls or more, as `face_names` does; none where there is a fault."""
    return _names(table, "walls", label, f"2 names or more, for example {SEVERAL}")


def _names(table: Table, key: str, label: str, form: str, most: int | None = None) -> tuple[str, ...]:
    """Take a list of faces, two or more, as `face_names` does; none where there is a fault."""

    def named(value: Any, where: str) -> tuple[str, ...]:
        fits = isinstance(value, list) and 2 <= len(value) <= (most or len(value))
        if not fits or not all(isinstance(one, str | Mapping) for one in value):
            raise InputError(f"{where} = {value!r} should be a list of {form}")
        return tuple(
            _name(table, one, f"{where}[{place + 1}]", place_name(label, place)) for place, one in enumerate(value)
        )

    return table.take(key, named) or ()


def _name(table: Table, value: str | Mapping[str, Any], where: str, label: str) -> str:
    """The name of a face; that of a selector is `label`."""
    if isinstance(value, str):
        return value
    selector = read_selector(Table(value, where, table.faults, SELECTOR))
    if selector is not None:
        table.faults.selectors[label] = selector
    return label


def place_name(label: str, place: int) -> str:
    """The name of the face of a selector at a place, from 0, in the list of what is called `label`."""
    return f"{label} {('first', 'second')[place] if place < 2 else place + 1}"


def _normal(value: Any, name: str) -> Point:
    """Convert an axis word or three numbers to a unit vector."""
    if isinstance(value, str):
        if value not in AXES:
            raise InputError(f'{name} = "{value}" should be one of {", ".join(AXES)}, or three numbers')
        return AXES[value]
    if not isinstance(value, list):
        raise InputError(f'{name} = {value!r} should be an axis such as "+z", or three numbers such as [0, 0, 1]')
    along = np.array(direction(value, name))
    x, y, z = along / np.linalg.norm(along)
    return float(x), float(y), float(z)


def _numbers(value: Any, name: str) -> int | tuple[int, ...]:
    if not isinstance(value, list):
        return whole_number(value, name)
    if not value:
        raise InputError(f"{name} is empty; give the number of a face, such as 3, or of several, such as [3, 5]")
    return tuple(whole_number(one, name) for one in value)


SELECTOR: Declared = {
    "part": Key.text("The part.", REQUIRED),
    "normal": Key(
        'an axis such as "+z", or three numbers such as [0, 0, 1]',
        {"anyOf": [{"enum": list(AXES)}, listed({"type": "number"}, 3, 3)]},
        'Outward normal of a plane, within 1 degree: "+x", "-x", "+y", "-y", "+z", "-z" or three numbers.',
        read=_normal,
    ),
    "touching": Key.text("The part that the face touches, or comes as near to as geometry.snap says."),
    "nearest": Key.point("A point; of the faces for which the rest holds, the nearest."),
    "within": Key.quantity("m", "The farthest that this point may lie from the face; 1 mm where left out."),
    "number": Key(
        "a whole number from 1 to 1,000,000, or a list of them",
        {"anyOf": [INTEGER, listed(INTEGER, 1)]},
        "Number of the face among those of its part, as `faying faces` lists them; or those of several faces that are "
        "meant together, such as [3, 5].",
        read=_numbers,
    ),
    "all": Key.truth("Several faces that fit count as one."),
}
FACE = {"anyOf": [WORDS, {"$ref": "#/$defs/selector"}]}


def one_face(says: str, default: Any = None) -> Key:
    """A face, by its name or by a selector; `face_name` reads it."""
    return Key(f"a face: {FORM}", FACE, says, default)


def two_faces(says: str) -> Key:
    """Two faces, each by its name or by a selector; `face_names` reads them."""
    return Key(f"a list of 2 names, for example {TWO}", listed(FACE, 2, 2), says, REQUIRED)


def several_faces(says: str, default: Any = None) -> Key:
    """Two faces or more, each by its name or by a selector; `several_names` reads them."""
    return Key(f"a list of names, for example {SEVERAL}", listed(FACE, 2), says, default)
