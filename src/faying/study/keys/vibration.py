"""[[vibration]]: what shakes the structure in service."""

from collections.abc import Sequence
from typing import Any

from faying.errors import InputError
from faying.study.declaration.declared import QUANTITY, WORDS, Declared, Key, listed
from faying.study.declaration.reader import Table
from faying.study.declaration.values import POINT, point
from faying.study.keys.face import face_name, one_face
from faying.study.vibration import FASTEST, FORM, Excitation


def read_vibrations(tables: Sequence[Table]) -> tuple[Excitation, ...]:
    """Read all [[vibration]]; a fault is noted where two share a name."""
    found = [one for one in map(_read, tables) if one is not None]
    if found:
        tables[0].faults.note_alike("vibrations", [one.name for one in found])
    return tuple(found)


def _read(table: Table) -> Excitation | None:
    face = face_name(table, table.where)
    given = {key: table.get(key) for key in VIBRATION if key not in ("face", "name", "psd", "sine")}
    tables = {key: _rows(table, key) for key in ("psd", "sine")}
    name = table.get("name")
    return table.made(lambda: Excitation(name, face=face, **tables, **given))


def _rows(table: Table, key: str) -> Any:
    """The rows as they are written, or the file of that name."""
    if isinstance(table.data.get(key), str):
        return table.existing(key)

    def rows(value: Any, name: str) -> Any:
        is_table = isinstance(value, list) and all(isinstance(row, list) for row in value)
        if not is_table or not all(isinstance(cell, str) for row in value for cell in row):
            kind = "random" if key == "psd" else "sine"
            raise InputError(f"{name} = {value!r}; write each number with its unit as text, for example {FORM[kind]}")
        return value

    return table.take(key, rows)


def _points(value: Any, name: str) -> tuple[tuple[float, float, float], ...]:
    if not isinstance(value, list) or not all(isinstance(one, list) for one in value):
        raise InputError(f"{name} = {value!r} should be a list of points, each {POINT}")
    return tuple(point(one, name) for one in value)


def _table(kind: str, says: str) -> Key:
    """Rows of frequency and value, or the name of a file of them; `Excitation` reads the values."""
    row = listed(WORDS, 2, 2)
    return Key(f"rows of frequency and value, or a CSV file: {FORM[kind]}", {"anyOf": [listed(row, 2), WORDS]}, says)


VIBRATION: Declared = {
    "name": Key.text("What tables call it.", "vibration"),
    "psd": _table(
        "random",
        "One-sided power spectral density of random vibration: of the acceleration of the supports, or of the force. "
        "Between rows it is straight in logarithms; +3 dB/oct in place of a value is a slope. Or a CSV file with the "
        "columns frequency and psd.",
    ),
    "sine": _table(
        "sine", "Amplitude of a sine sweep, in the same form; the columns of a file are frequency and amplitude."
    ),
    "direction": Key.direction("Along which the supports move, or the force acts.", (0.0, 0.0, 1.0)),
    "face": one_face("Face that the force is spread over; without face and point all supports move together."),
    "point": Key.point("Point that the force goes through; without a face the node nearest to it bears it."),
    "duration": Key.quantity("s", "How long random vibration lasts, for the fatigue of the bolts."),
    "rate": Key.within(1e-3, FASTEST, "Octaves a minute of the sweep, for the fatigue of the bolts."),
    "points": Key(
        "a list of points",
        listed(listed(QUANTITY, 3, 3), 0),
        "Points whose motion is wanted; the one that moves most of each part where left out.",
        (),
        read=_points,
        unit="m",
    ),
}
