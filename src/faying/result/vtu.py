"""Results for ParaView: one file of VTK's XML format for each preload, and one .pvd that names them all.

Each .vtu holds the outer surface and, after its points, what touches of every joint.
"""

from pathlib import Path
from typing import Any

import numpy as np

from faying.result.groups import STRESSES
from faying.result.maps import joint_map_of
from faying.result.run_record import RunRecord
from faying.result.vtk import grid_text, write_collection

UNITS = {"pressure": "Pa", "gap": "m", "slip": "m", "k_n": "Pa/m", "k_t": "Pa/m"}


def write_vtu(result: RunRecord, path: str | Path) -> list[Path]:
    """Write NAME.pvd and NAME-1.vtu, NAME-2.vtu and so on, one for each preload; see `Result.save_vtu`."""
    maps = [joint_map_of(result, joint) for joint in range(len(result.joints))]
    return write_collection(path, result.loads.tolist(), lambda load: _of_preload(result, maps, load))


def _of_preload(result: RunRecord, maps: list[Any], load: int) -> str:
    """The text of the .vtu of one preload."""
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
    for name, text in STRESSES.items():
        if (stress := getattr(result, name)) is not None:
            points[text] = moved(stress[load])
    for one in result.vibrations:
        if one.surface is not None and one.preload == result.loads[load]:
            for k, state in enumerate(one.surface.states):
                points |= {f"{one.name}, {state}: {text}": moved(v) for text, v in one.surface.fields(k).items()}
    for name in UNITS:
        if any(name in one.fields for _, one in found):
            values = [one.fields.get(name, np.full((1, len(one.parents)), np.nan)) for _, one in found]
            at = [rows[load if len(rows) > 1 else 0] for rows in values]
            points[f"{name} [{UNITS[name]}]"] = np.concatenate([np.full(nodes, np.nan), *at])
    of_maps = (np.full(count, joint) for (joint, _), count in zip(found, sizes, strict=True))
    joints = np.concatenate([np.full(len(result.triangles), -1), *of_maps]).astype(np.int64)
    cells = {"part": of_cells(result.part_of_triangle), "face": of_cells(result.face_of_triangle), "joint": joints}
    facts = {"preload [N]": result.loads[load : load + 1], "frequency [Hz]": result.frequencies[load]}
    facts["loss factor"] = result.loss_factors[load]
    return grid_text(result.title, np.concatenate(places), triangles, points, cells, facts)
