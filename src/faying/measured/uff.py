"""Universal files (UFF, UNV) of modal tests: data sets 15, 18, 55, 58, 58b, 82, 151, 164, 2411, 2412, 2414, 2420.

Most are read through pyuff; 18 and 2414 are read here.

The formats: University of Cincinnati, Structural Dynamics Research Lab, https://www.ceas3.uc.edu/sdrluff.
"""

import re
import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, redirect_stdout
from io import StringIO
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from faying.data_sets import check_data_sets
from faying.errors import InputError, ReadError
from faying.measured.frf import Dof, Position
from faying.measured.uff_systems import UffSystem, export_note, of_pole, shapes_2414, systems
from faying.measured.uff_units import FREQUENCY, FileUnits
from faying.measured.universal import Function, UniversalFile
from faying.misuse import checked_call
from faying.typing import Array, Index
from faying.units import scale

KINDS = {
    0: "general",
    1: "time response",
    2: "auto spectrum",
    3: "cross spectrum",
    4: "FRF",
    5: "transmissibility",
    6: "coherence",
    7: "auto correlation",
    8: "cross correlation",
    9: "power spectral density",
    10: "energy spectral density",
    12: "spectrum",
    13: "cumulative distribution",
    22: "impulse response",
}
FRF_TYPE, COHERENCE_TYPE, OVER_TIME = 4, 6, (1, 7, 8, 22)
GLOBAL = (0, 1)  # systems that a file need not define
LINE = 6  # numbers in a line of data set 58
OWN = (18, 2414)  # data sets that Faying reads itself
OF_POINTS, COLUMNS = 6, 80  # lines from the number of a data set 58 to its points, and columns that these have
TAKEN = {*OWN, 15, 55, 58, 82, 151, 164, 2411, 2412, 2420}  # and all that it takes from a file
DIRECTION_CODES = {0: "", 1: "x", 2: "y", 3: "z", 4: "rx", 5: "ry", 6: "rz"}


@checked_call
def read_uff(path: str | Path, *, length_unit: str | None = None) -> UniversalFile:
    """Read a universal file (UFF, UNV) of a modal test, ascii or binary.

    Args:
        path: of the file.
        length_unit: of the positions, where the file states no units (data set 164), for example "mm".

    Returns:
        UniversalFile; its `modes()` and `frf()` give the mode shapes and the FRFs.

    Raises:
        ReadError: where the file is missing, no universal file, cut short, or a data set cannot be read.
        InputError: where `length_unit` is given against the file.

    Source:
        University of Cincinnati, Structural Dynamics Research Lab, https://www.ceas3.uc.edu/sdrluff.
    """
    file = Path(path)
    sets = _sets(file)
    units = FileUnits.of(sets, str(file))
    if length_unit is not None and units is not None:
        raise InputError(
            f"{file}: the file states its units ({units.words.strip() or 'data set 164'}); leave out length_unit"
        )
    metre = scale(length_unit, "m", name="length_unit") if length_unit else 1 / units.length if units else 1.0
    positions, rotations, about_places = _points(file, sets, systems(file, sets), metre)
    shapes = [_shape(s, f"{file}, data set {s['number']}") for s in sets if s["type"] == 55]
    nodal, about_results = shapes_2414(file)
    if shapes and nodal:
        about_results.append(
            f"{file}: its mode shapes are taken from data sets 55; {len(nodal)} of data sets 2414 are left out"
        )
    elif nodal:
        at = f"{file}, data set 2414"
        shapes = [_mode(f, loss, _whole(points, str(file)), values, at) for f, loss, points, values in nodal]
    others, rigid = sorted({int(s["type"]) for s in sets} - TAKEN), sum(s["frequency"] == 0 for s in shapes)
    _check_numbered([s for s in sets if s["type"] == 58 and s["func_type"] == FRF_TYPE], file)
    return UniversalFile(
        source=str(file),
        title=next((s["model_name"] for s in sets if s["type"] == 151), ""),
        units=units,
        functions=tuple(_function(s, f"{file}, data set {s['number']}") for s in sets if s["type"] == 58),
        shapes=tuple(s for s in shapes if s["frequency"] > 0),
        positions=positions,
        rotations=rotations,
        lines=_lines(sets),
        kinds=tuple(s["type"] for s in sets),
        warnings=(
            *about_places,
            *about_results,
            *([f"{file}: data sets {', '.join(map(str, others))} are not read"] if others else []),
            *([f"{file}: {rigid} mode shapes at 0 Hz, rigid motion, are left out"] if rigid else []),
            *_about_lengths(file, positions, stated=units is not None or length_unit is not None),
        ),
    )


def _check_numbered(frfs: Sequence[dict[str, Any]], file: Path) -> None:
    """Raise ReadError where some FRFs have a point or direction and others none: what cannot be read comes as 0."""
    for name, what in (
        ("rsp_node", "response point"),
        ("ref_node", "reference point"),
        ("rsp_dir", "response direction"),
        ("ref_dir", "reference direction"),
    ):
        without = [s["number"] for s in frfs if s[name] == 0]
        if without and len(without) < len(frfs):
            raise ReadError(
                f"{file}, data set {without[0]}: an FRF without a {what}, where other FRFs of the file have one; "
                "its header is damaged"
            )


def _check_headers(lines: Sequence[str], file: Path) -> None:
    """Raise ReadError where the points of a function (data set 58) do not stand in the columns of the format."""
    for k, line in enumerate(lines[: -OF_POINTS or None]):
        if line.strip() == "58" and lines[k - 1].strip() == "-1":
            points = lines[k + OF_POINTS].rstrip("\x00 \t\r")
            if len(points) > COLUMNS:
                raise ReadError(
                    f"{file}, line {k + OF_POINTS + 1}: {points.strip()!r} is longer than the {COLUMNS} columns in "
                    "which the points of a function are written; its header is damaged"
                )


def _about_lengths(file: Path, positions: Mapping[int, Position], *, stated: bool) -> list[str]:
    """Notes on the unit of length, where the file states none or the points lie far apart."""
    notes: list[str] = []
    if not positions:
        return notes
    size = float(np.linalg.norm(np.ptp(np.array(list(positions.values())), axis=0)))
    if not stated:
        notes.append(f"{file}: the file states no unit of length; metres are assumed (the points span {size:.3g} m)")
    if size > 100:
        hint = 'give length_unit="mm" (--length-unit mm), or correct data set 164 where there is one'
        notes.append(f"{file}: the points span {size:.3g} m; are they in mm? Then {hint}")
    return notes


def _sets(file: Path) -> list[dict[str, Any]]:
    """All data sets that pyuff can read, each with its number in the file."""
    import pyuff

    if not file.is_file():
        raise ReadError(f"{file}: no such file")
    try:
        with _quiet():
            uff = pyuff.UFF(str(file))
            kinds = [int(k) for k in uff.get_set_types()]
    except Exception as fault:  # pyuff raises nothing more precise
        raise ReadError(f"{file}: cannot be read ({fault})") from None
    if not kinds:
        raise ReadError(
            f"{file} is not a universal file: it has no data set between lines of -1. Export the test as UFF or UNV"
        )
    content = file.read_bytes()
    if not content.rstrip(b"\x00\x1a \t\r\n").endswith(b"    -1"):
        raise ReadError(
            f"{file}: it ends in the middle of data set {len(kinds) + 1}; it was cut short, export or copy it again"
        )
    if not any(b"58b" in line[:9] for line in content.splitlines()):  # binary data may hold anything
        lines = content.decode("latin-1").split("\n")  # as pyuff does; splitlines knows more ends of lines
        check_data_sets(lines, str(file))
        _check_headers(lines, file)
    out = []
    for number, kind in enumerate(kinds):
        if kind in OWN:
            out.append({"type": kind, "number": number + 1})
            continue
        try:
            with _quiet():
                data = uff.read_sets(number)
        except Exception as fault:
            raise ReadError(
                f"{file}: data set {number + 1} (type {kind}) cannot be read ({fault}); it is damaged or of a variant "
                "that pyuff does not know: export it again, as ascii where it is binary"
            ) from None
        out.append({**data, "type": kind, "number": number + 1})
    return out


@contextmanager
def _quiet() -> Iterator[None]:
    """Leave out what pyuff warns of and prints: of some data sets it prints all that it reads."""
    with warnings.catch_warnings(), redirect_stdout(StringIO()):
        warnings.simplefilter("ignore")
        yield


def _dof(point: int, code: int) -> Dof:
    name = DIRECTION_CODES.get(abs(code), "")
    return Dof(point, f"-{name}" if code < 0 and name else name)


def _function(data: dict[str, Any], where: str) -> Function:
    x, values = np.asarray(data["x"], float), np.asarray(data["data"])
    count = data["num_pts"]
    padded = len(x) == len(values) > count > 0 and len(values) - count < LINE and not values[count:].any()
    if padded and (data["abscissa_spacing"] or not x[count:].any()):  # the last line is filled up with zeros
        x, values = x[:count], values[:count]
    if len(values) != count or len(x) != count:
        raise ReadError(
            f"{where}: {len(values)} values where its header announces {count}; the file is damaged or was cut short, "
            "export it again"
        )
    # `without_static` sees to 0 Hz
    moving = x != 0 if data["func_type"] in (FRF_TYPE, COHERENCE_TYPE) else np.full(len(x), True)
    if not (np.all(np.isfinite(values[moving])) and np.all(np.isfinite(x))):
        raise ReadError(f"{where}: it has NaN or infinite values; measure or export that function again")
    if data["func_type"] in OVER_TIME and data["abscissa_spec_data_type"] == FREQUENCY:
        raise ReadError(
            f"{where}: a {KINDS[data['func_type']]} over frequency; its header is damaged, export that function again"
        )
    return Function(
        kind=KINDS.get(data["func_type"], f"function of type {data['func_type']}"),
        x=x,
        values=np.where(np.isfinite(values), values, np.nan),
        output=_dof(data["rsp_node"], data["rsp_dir"]),
        input=_dof(data["ref_node"], data["ref_dir"]),
        unit=data["ordinate_axis_units_lab"],
        header={k: v for k, v in data.items() if k not in ("x", "data")},
        where=where,
    )


def _shape(data: dict[str, Any], where: str) -> dict[str, Any]:
    """Frequency [Hz], loss factor, points (p,) and motion (p, 3) of one mode."""
    kind = data["analysis_type"]
    if kind not in (2, 3, 7):
        raise ReadError(
            f"{where}: data at nodes of analysis type {kind}, which is not a mode; modes are types 2, 3 and 7"
        )
    points = _whole(data["node_nums"], where)
    parts = [np.asarray(data[r]) for r in ("r1", "r2", "r3")]
    if any(len(p) != len(points) for p in parts):
        raise ReadError(
            f"{where}: {len(points)} points but {[len(p) for p in parts]} values in x, y, z; export translations in "
            "three directions"
        )
    if kind == 2:
        frequency, loss = data["freq"], 2 * data["modal_damp_vis"] or data["modal_damp_his"]
    else:
        frequency, loss = of_pole(data["eig"])
    mode = _mode(float(frequency), float(loss), points, np.stack(parts, axis=1), where)
    return {**mode, "frequency_interval": _span(data["id2"]), "loss_interval": _span(data["id3"])}


def _mode(frequency: float, loss: float, points: Index, values: Array, where: str) -> dict[str, Any]:
    if not (0 <= frequency < np.inf and np.isfinite(loss) and np.all(np.isfinite(values))):
        raise ReadError(
            f"{where}: a mode of {frequency:g} Hz, loss factor {loss:g}, with NaN or infinite motion or a negative "
            "frequency; export it again"
        )
    if len(points) and points.min() < 1:
        raise ReadError(f"{where}: the mode moves point {points.min()}; numbers of points begin at 1")
    once, first = np.unique(points, return_index=True)
    if len(once) < len(points) and not np.array_equal(values, values[first[np.searchsorted(once, points)]]):
        twice = points[np.setdiff1d(np.arange(len(points)), first)]
        raise ReadError(f"{where}: the mode has two motions of point {twice[0]}; export it again")
    unknown = dict.fromkeys(("frequency_interval", "loss_interval"), (np.nan, np.nan))
    return {"frequency": frequency, "loss": loss, "points": points, "values": values, **unknown}


def _span(text: str) -> tuple[float, float]:
    """The interval that a line of the header states, as `write_uff` writes it; NaN for another line."""
    found = re.fullmatch(r"95 % of [a-z ]+: (\S+) \.\. (\S+)", text.strip())
    try:
        return (float(found[1]), float(found[2])) if found else (np.nan, np.nan)
    except ValueError:
        return np.nan, np.nan


def _points(
    file: Path, sets: list[dict[str, Any]], known: Mapping[int, UffSystem], metre: float
) -> tuple[dict[int, Position], dict[int, Array], list[str]]:
    """Positions [m] by point, for points whose directions are turned the rows of their axes, and notes.

    Data set 15 gives places in the system that it names, data set 2411 in that of the part, whatever export system it
    names; both give motion in the displacement system.
    """
    positions: dict[int, Position] = {}
    rotations: dict[int, Array] = {}
    exported: set[int] = set()
    for s in sets:
        if s["type"] not in (15, 2411):
            continue
        where = f"{file}, data set {s['number']}"
        numbers = [_whole(s[name], where) for name in ("node_nums", "def_cs", "disp_cs")]
        places = np.stack(_like(numbers, [s[name] for name in "xyz"], where), axis=1)
        for label, own, motion, place in zip(*(n.tolist() for n in numbers), places, strict=True):
            if label < 1:
                raise ReadError(f"{where}: a point has the number {label}; numbers of points begin at 1")
            moved = known.get(own) if s["type"] == 15 else None
            named = {"is given": own, "moves": motion} if s["type"] == 15 else {"moves": motion}
            for does, system in named.items():
                if known and system not in (*known, *GLOBAL):
                    raise ReadError(
                        f"{where}: point {label} {does} in the system {system}, which the file does not define; it "
                        f"defines {', '.join(map(str, known))}"
                    )
            if any(one is not None and one.kind != 0 for one in (moved, known.get(motion))):
                raise ReadError(
                    f"{file}: point {label} is given in a cylindrical or spherical system; export it in Cartesian ones"
                )
            if s["type"] == 2411 and own in known and (known[own].turned or known[own].origin.any()):
                exported.add(own)
            xyz = place if moved is None else moved.place(place)
            position: Any = tuple(float(v) * metre for v in xyz)
            if positions.get(label, position) != position:
                raise ReadError(f"{where}: point {label} appears twice, at two places; export the points once")
            positions[label] = position
            if motion in known and known[motion].turned:
                rotations[label] = known[motion].axes
    return positions, rotations, [export_note(file, exported)] if exported else []


def _whole(values: Any, where: str) -> Index:
    """Whole numbers, or ReadError."""
    try:
        found = np.atleast_1d(np.asarray(values, float))
    except (TypeError, ValueError):
        found = np.array([np.nan])
    if not np.all(np.isfinite(found)) or np.any(found != np.rint(found)) or np.any(np.abs(found) > 2**53):
        raise ReadError(f"{where}: some numbers of points are not whole numbers; the file is damaged, export it again")
    return found.astype(np.int64)


def _like(numbers: list[Index], columns: list[Any], where: str) -> list[Array]:
    """Columns of finite numbers, as many as there are points; ReadError for others."""
    found = [np.atleast_1d(np.asarray(column, float)) for column in columns]
    if len({len(c) for c in (*numbers, *found)}) > 1:
        raise ReadError(
            f"{where}: {len(numbers[0])} points but {[len(c) for c in found]} coordinates; the file is damaged or was "
            "cut short, export it again"
        )
    if not all(np.all(np.isfinite(c)) for c in found):
        raise ReadError(f"{where}: some coordinates are NaN or infinite; export the points again")
    return found


def _lines(sets: list[dict[str, Any]]) -> tuple[tuple[int, int], ...]:
    """Pairs of points to join in a drawing: trace lines (82; 0 lifts the pen) and the sides of elements (2412)."""
    out: dict[tuple[int, int], None] = {}
    for s in sets:
        if s["type"] == 82:
            nodes = np.asarray(s["nodes"], int)
            out |= {(int(a), int(b)): None for a, b in pairwise(nodes) if a and b}
        for elements in (v for k, v in s.items() if s["type"] == 2412 and str(k).isdigit()):
            for element in elements:
                nodes = element["nodes_nums"]
                out |= {(a, b): None for a, b in zip(nodes, [*nodes[1:], nodes[0]], strict=True) if a != b}
    return tuple(out)
