"""Results for ParaView: one file of VTK's XML format for each preload, and one .pvd that names them all.

Each .vtu holds the outer surface and, after its points, what touches of every joint. The format: VTK file formats,
XML, UnstructuredGrid (docs.vtk.org); arrays are little-endian, written inline in base64 with their length before them.
"""

from base64 import b64encode
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape, quoteattr

import numpy as np

from faying.errors import InputError
from faying.files import make_folder, write_text
from faying.result.maps import joint_map_of
from faying.result.run_record import RunRecord

TRIANGLE = 5  # VTK's number of a triangle with three nodes
TYPES = {"f": ("Float64", np.float64), "i": ("Int64", np.int64), "u": ("UInt8", np.uint8)}
UNITS = {"pressure": "Pa", "gap": "m", "slip": "m", "k_n": "Pa/m", "k_t": "Pa/m"}


def write_vtu(result: RunRecord, path: str | Path) -> list[Path]:
    """Write NAME.pvd and NAME-1.vtu, NAME-2.vtu and so on, one for each preload; see `Result.save_vtu`."""
    file = Path(path)
    if file.suffix.lower() not in (".pvd", ".vtu"):
        raise InputError(f"{file}: ParaView's files end in .pvd or .vtu; give a name such as {file.stem}.pvd")
    make_folder(file.parent, "give another place for the files")
    every = [file.with_name(f"{file.stem}-{load + 1}.vtu") for load in range(len(result.loads))]
    maps = [joint_map_of(result, joint) for joint in range(len(result.joints))]
    for load, one in enumerate(every):
        write_text(one, _grid(result, maps, load))
    lines = "".join(
        f'<DataSet timestep="{load!r}" part="0" file={quoteattr(one.name)}/>\n'
        for load, one in zip(map(float, result.loads), every, strict=True)
    )
    text = f'<?xml version="1.0"?>\n<VTKFile type="Collection" version="0.1">\n<Collection>\n{lines}</Collection>\n'
    return [write_text(file.with_suffix(".pvd"), f"{text}</VTKFile>\n"), *every]


def _grid(result: RunRecord, maps: list[Any], load: int) -> str:
    """The text of one .vtu."""
    found = [(joint, one) for joint, one in enumerate(maps) if one is not None]
    nodes = len(result.outline)
    places = [result.outline, *(result.outline[one.parents].mean(axis=1) for _, one in found)]
    starts = np.cumsum([0, *(len(one) for one in places)])
    pieces = [(one.triangles + start) for (_, one), start in zip(found, starts[1:], strict=False)]
    triangles = np.concatenate([result.triangles, *pieces]).astype(np.int64)
    sizes = [len(one) for one in pieces]

    def of_cells(values: Any) -> Any:
        own = np.full(len(result.triangles), -1) if values is None else values
        return np.concatenate([own, np.full(sum(sizes), -1)]).astype(np.int64)

    def moved(shape: Any) -> Any:
        shape = np.asarray(shape, float)
        return np.concatenate([shape, *(shape[one.parents].mean(axis=1) for _, one in found)])

    points: dict[str, Any] = {}
    for mode in range(result.frequencies.shape[1]):
        points[f"mode {mode + 1} real"] = moved(result.shapes[load, mode])
        points[f"mode {mode + 1} imaginary"] = moved(result.shapes_imaginary[load, mode])
    if result.von_mises is not None:
        points["von Mises stress [Pa]"] = moved(result.von_mises[load])
    for name in UNITS:
        if any(name in one.fields for _, one in found):
            values = [one.fields.get(name, np.full((1, len(one.parents)), np.nan)) for _, one in found]
            at = [rows[load if len(rows) > 1 else 0] for rows in values]
            points[f"{name} [{UNITS[name]}]"] = np.concatenate([np.full(nodes, np.nan), *at])
    of_maps = (np.full(count, joint) for (joint, _), count in zip(found, sizes, strict=True))
    joints = np.concatenate([np.full(len(result.triangles), -1), *of_maps]).astype(np.int64)
    cells = {"part": of_cells(result.part_of_triangle), "face": of_cells(result.face_of_triangle), "joint": joints}
    shape = {"connectivity": triangles.ravel(), "offsets": 3 * np.arange(1, len(triangles) + 1)}
    shape["types"] = np.full(len(triangles), TRIANGLE, dtype=np.uint8)
    facts = {"preload [N]": result.loads[load : load + 1], "frequency [Hz]": result.frequencies[load]}
    facts["loss factor"] = result.loss_factors[load]
    return (
        '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        f'header_type="UInt64">\n<!-- {escape(result.title).replace("--", "- -")} -->\n<UnstructuredGrid>\n'
        f"<FieldData>\n{_arrays(facts, tuples=True)}</FieldData>\n"
        f'<Piece NumberOfPoints="{starts[-1]}" NumberOfCells="{len(triangles)}">\n'
        f"<Points>\n{_arrays({'Points': np.concatenate(places)})}</Points>\n"
        f"<Cells>\n{_arrays(shape)}</Cells>\n"
        f"<PointData>\n{_arrays(points)}</PointData>\n<CellData>\n{_arrays(cells)}</CellData>\n"
        "</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
    )


def _arrays(every: dict[str, Any], *, tuples: bool = False) -> str:
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
