"""VTK's XML files of triangles with values, and the .pvd that names them, for ParaView.

The format: VTK file formats, XML, UnstructuredGrid (docs.vtk.org); arrays are little-endian, written inline in base64
with their length before them.
"""

from base64 import b64encode
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from faying.errors import InputError
from faying.files import make_folder, write_text
from faying.typing import Array, Index

Values = Mapping[str, Any]  # arrays by name
TRIANGLE = 5  # VTK's number of a triangle with three nodes
TYPES = {"f": ("Float64", np.float64), "i": ("Int64", np.int64), "u": ("UInt8", np.uint8)}


def write_collection(path: str | Path, times: Sequence[float], grid: Callable[[int], str]) -> list[Path]:
    """Write NAME.pvd and NAME-1.vtu, NAME-2.vtu and so on; times: of ParaView; grid: makes the text of one."""
    file = Path(path)
    if file.suffix.lower() not in (".pvd", ".vtu"):
        raise InputError(f"{file}: ParaView's files end in .pvd or .vtu; give a name such as {file.stem}.pvd")
    make_folder(file.parent, "give another place for the files")
    every = [file.with_name(f"{file.stem}-{k + 1}.vtu") for k in range(len(times))]
    for k, one in enumerate(every):
        write_text(one, grid(k))
    lines = "".join(
        f'<DataSet timestep="{float(time)!r}" part="0" file={quoteattr(one.name)}/>\n'
        for time, one in zip(times, every, strict=True)
    )
    text = f'<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n{lines}</Collection>\n'
    return [write_text(file.with_suffix(".pvd"), f"{text}</VTKFile>\n"), *every]


def grid_text(title: str, places: Array, triangles: Index, points: Values, cells: Values, facts: Values) -> str:
    """The text of one .vtu: nodes (n, 3), triangles (t, 3), values at points, of triangles and of the whole."""
    shape = {"connectivity": triangles.ravel(), "offsets": 3 * np.arange(1, len(triangles) + 1)}
    shape["types"] = np.full(len(triangles), TRIANGLE, dtype=np.uint8)
    return (
        '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        f'header_type="UInt64">\n<!-- {escape(title).replace("--", "- -")} -->\n<UnstructuredGrid>\n'
        f"<FieldData>\n{_arrays(facts, tuples=True)}</FieldData>\n"
        f'<Piece NumberOfPoints="{len(places)}" NumberOfCells="{len(triangles)}">\n'
        f"<Points>\n{_arrays({'Points': places})}</Points>\n"
        f"<Cells>\n{_arrays(shape)}</Cells>\n"
        f"<PointData>\n{_arrays(points)}</PointData>\n<CellData>\n{_arrays(cells)}</CellData>\n"
        "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    )


def _arrays(every: Values, *, tuples: bool = False) -> str:
    """Arrays (n,) or (n, 3) as elements of XML."""
    out = []
    for name, values in every.items():
        array = np.asarray(values)
        kind, dtype = TYPES[array.dtype.kind]
        made = np.ascontiguousarray(array, dtype=np.dtype(dtype).newbyteorder("<")).tobytes()
        text = b64encode(np.array([len(made)], dtype="<u8").tobytes() + made).decode("ascii")
        parts = f' NumberOfComponents="{array.shape[1]}"' if array.ndim > 1 else ""
        count = f' NumberOfTuples="{len(array)}"' if tuples else ""
        head = f'<DataArray type="{kind}" Name={quoteattr(name)}{parts}{count} format="binary">'
        out.append(f"{head}{text}</DataArray>\n")
    return "".join(out)
