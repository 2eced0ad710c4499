"""Pressure on a joint from outside: one value, or a file of node and pressure."""

from pathlib import Path

import numpy as np

from faying import units
from faying.columns import read_columns
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
    known = {"node": "", "pressure": "Pa"}
    form = f'it should begin with the heading "{HEAD}", the unit of your pressures in the brackets'
    table = read_columns(file, known, needed=("node", "pressure"), form=form, examples={"Pa": "MPa"})
    numbers, values = table.values["node"], table.values["pressure"]
    if not table.lines:
        raise ReadError(f"{file} has no pressures; {form}")
    odd = np.flatnonzero((numbers != np.rint(numbers)) | (np.abs(numbers) > 2**53))
    if len(odd):
        raise ReadError(
            f"{file}, line {table.lines[odd[0]]}: {numbers[odd[0]]:g} is not a node number; give an integer"
        )
    if min(values) < -1e-9 * max(map(abs, values)):
        raise InputError(
            f"{file}: {sum(v < 0 for v in values)} pressures are negative; pressure presses the faces together and "
            "counts as positive: change the sign of the column, and write 0 where the joint is open"
        )
    if len(np.unique(numbers)) < len(numbers):
        raise InputError(f"{file} gives some nodes twice; give each once")
    return numbers.astype(np.int64), np.maximum(values, 0.0)
