"""Pressure on a joint from outside: one value, or a file of node and pressure."""

from pathlib import Path

import numpy as np

from faying import units
from faying.columns import hold_table
from faying.errors import InputError, ReadError
from faying.fe.interface import Interface
from faying.fe.mesh import Mesh
from faying.typing import Array, Index

HEAD = "node,pressure [MPa]"


def read_pressure(given: str | Path, mesh: Mesh, faces: tuple[str, str], interface: Interface) -> tuple[Array, str]:
    """Pressure [Pa] at the points of the interface (q,), and in words where it comes from.

    given: a value such as "5 MPa", or a CSV file with the heading "node,pressure [MPa]" that covers one of the faces.
    Raises ReadError and InputError.
    """
    file = Path(given)
    if not file.is_file():
        if file.suffix.lower() in (".csv", ".txt"):
            raise ReadError(f'no file {file}; --pressure takes a CSV file, a value such as "5 MPa", or solve')
        value = units.parse(str(given), "Pa", name="--pressure")
        if value <= 0:
            raise InputError(f'--pressure "{given}" must be above 0; pressure presses the faces together')
        return np.full(len(interface.weights), value), f"{given} everywhere"
    numbers, values = _table(file)
    at = dict(zip(numbers.tolist(), values.tolist(), strict=True))
    missing = []
    for name, nodes, shapes in (
        (faces[0], interface.first_nodes, interface.first_values),
        (faces[1], interface.second_nodes, interface.second_values),
    ):
        needed = np.unique(nodes[shapes != 0])
        lost = [int(mesh.numbers[i]) for i in needed if int(mesh.numbers[i]) not in at]
        if not lost:
            by_node = np.zeros(len(mesh.points))
            by_node[needed] = [at[int(mesh.numbers[i])] for i in needed]
            # between nodes of a quadratic face the shape functions may dip below zero
            return np.maximum(np.einsum("qa,qa->q", shapes, by_node[nodes]), 0.0), f"{file.name}, on {name}"
        missing.append(f"{len(lost)} of {len(needed)} nodes of {name!r}, {lost[0]} for one")
    raise InputError(f"{file} must give the pressure at every node of one face; it lacks {' and '.join(missing)}")


def _table(file: Path) -> tuple[Index, Array]:
    try:
        hold_table(file)
        lines = [line.strip() for line in file.read_text(encoding="utf-8").splitlines()]
    except (OSError, UnicodeDecodeError) as fault:
        raise ReadError(f"cannot read {file}: {fault}") from None
    lines = [line for line in lines if line and not line.startswith("#")]
    mark = next((c for c in ",;\t" if lines and c in lines[0]), ",")
    head = [word.strip() for word in lines[0].split(mark)] if lines else []
    names = [word.split("[")[0].strip().lower() for word in head]
    if "node" not in names or "pressure" not in names or "[" not in head[names.index("pressure")]:
        raise ReadError(f'{file} should begin with the heading "{HEAD}", the unit of your pressures in the brackets')
    node, column = names.index("node"), names.index("pressure")
    scale = units.scale(head[column].split("[")[1].strip(" ]"), "Pa", name=f"{file.name}: unit of pressure")
    numbers, values = [], []
    for k, line in enumerate(lines[1:], 2):
        words = line.split(mark)
        try:
            numbers.append(int(float(words[node])))
            values.append(float(words[column]) * scale)
        except (ValueError, IndexError, OverflowError):
            raise ReadError(f'{file}, row {k}: "{line}" is not a node and a pressure') from None
    if not numbers or not np.all(np.isfinite(values)):
        raise ReadError(f"{file} holds no pressures, or some that are not numbers")
    if min(values) < -1e-9 * max(map(abs, values)):
        raise InputError(
            f"{file}: {sum(v < 0 for v in values)} pressures are negative; pressure presses the faces together and "
            "counts as positive: change the sign of the column, and write 0 where the joint is open"
        )
    if len(set(numbers)) < len(numbers):
        raise InputError(f"{file} gives some nodes twice; give each once")
    return np.array(numbers), np.maximum(values, 0.0)
