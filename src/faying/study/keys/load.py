"""[[load]]: load cases on the preloaded structure."""

from collections.abc import Callable, Sequence
from typing import Any

from faying.errors import InputError
from faying.loads.load import MOST_INCREMENTS, NOTHING, Displacement, Force, Load, Pressure, Vector, in_order
from faying.study.keys.face import face_name
from faying.study.keys.reader import Table, number, point, quantity

LENGTH = '["0 mm", "0 mm", "0.1 mm"]'
EXAMPLES = {"N": '["0 N", "0 N", "5 kN"]', "N*m": '["0 N*m", "20 N*m", "0 N*m"]', "m": LENGTH}
EXAMPLES["m/s^2"] = '["0 m/s^2", "0 m/s^2", "98.1 m/s^2"]'


def read_loads(tables: Sequence[Table]) -> tuple[Load, ...]:
    """Read all [[load]]; a fault is noted where cases name what is not there, or each other in a circle."""
    found = tuple(load for load in map(_read, tables) if load is not None)
    if len(found) == len(tables) and tables:
        try:
            in_order(found)
        except InputError as fault:
            tables[0].faults.add(str(fault))
    return found


def _read(table: Table) -> Load | None:
    name = table.text("name")
    forces = [_force(one, f"{table.where} force {k}") for k, one in enumerate(table.tables("force"), 1)]
    pressures = [_pressure(one, f"{table.where} pressure {k}") for k, one in enumerate(table.tables("pressure"), 1)]
    moves = [_move(one, f"{table.where} displacement {k}") for k, one in enumerate(table.tables("displacement"), 1)]
    acceleration = table.take("acceleration", _vector("m/s^2"), None) or NOTHING
    heat = table.take("temperature", _changes, {})
    combine = table.take("combine", _factors, {})
    after = table.text("after", None)
    increments = table.count("increments", 4, most=MOST_INCREMENTS)
    table.close()
    if name is None or None in forces or None in pressures or None in moves:
        return None
    return table.made(
        lambda: Load(
            name,
            forces=[one for one in forces if one is not None],
            pressures=[one for one in pressures if one is not None],
            acceleration=acceleration,
            temperature=heat,
            displacements=[one for one in moves if one is not None],
            combine=combine,
            after=after,
            increments=increments,
        )
    )


def _force(table: Table, label: str) -> Force | None:
    face = face_name(table, "face", label, required=False)
    force = table.take("force", _vector("N"), None) or NOTHING
    moment = table.take("moment", _vector("N*m"), None) or NOTHING
    place = table.take("point", point, None)
    table.close()
    return table.made(lambda: Force(face, force=force, moment=moment, point=place))


def _pressure(table: Table, label: str) -> Pressure | None:
    face = face_name(table, "face", label)
    pressure = table.quantity("pressure", "Pa", positive=False)
    table.close()
    if face is None or pressure is None:
        return None
    return Pressure(face, pressure)


def _move(table: Table, label: str) -> Displacement | None:
    face = face_name(table, "face", label)
    displacement = table.take("displacement", _vector("m"))
    table.close()
    if face is None or displacement is None:
        return None
    return Displacement(face, displacement)


def _vector(unit: str) -> Callable[[Any, str], Vector]:
    def convert(value: Any, name: str) -> Vector:
        if not isinstance(value, list) or len(value) != 3:
            raise InputError(f"{name} = {value!r} should be three components, for example {EXAMPLES[unit]}")
        x, y, z = (quantity(one, unit, name, positive=False) for one in value)
        return x, y, z

    return convert


def _changes(value: Any, name: str) -> dict[str, float]:
    if not isinstance(value, dict) or not value:
        raise InputError(f'{name} = {value!r} should be changes by part or bolt, for example {{plate = "60 K"}}')
    return {key: quantity(one, "K", f"{name}.{key}", positive=False) for key, one in value.items()}


def _factors(value: Any, name: str) -> dict[str, float]:
    if not isinstance(value, dict) or not value:
        raise InputError(f'{name} = {value!r} should be factors by load, for example {{"10 g" = 1.5}}')
    return {key: number(one, f"{name}.{key}") for key, one in value.items()}
