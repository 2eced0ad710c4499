"""Modes and FRFs as universal files: data sets 151, 164, 2411, 55 and 58."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.files import write_atomically
from faying.measured.frf import FRF, Dof, Position
from faying.measured.modes import ModeSet
from faying.misuse import checked_call

CODES = {"": 0, "x": 1, "y": 2, "z": 3, "rx": 4, "ry": 5, "rz": 6}
TYPES = {"receptance": (8, "m"), "mobility": (11, "m/s"), "accelerance": (12, "m/s^2")}


@checked_call
def write_uff(path: str | Path, *contents: ModeSet | FRF, title: str = "Faying") -> Path:
    """Write modes (data set 55) and FRFs (58) with units (164) and the positions of the points (2411), in SI.

    The format keeps six digits of frequencies and shapes, twelve of FRFs. A loss factor is written as a viscous damping
    ratio of half its size; complex shapes with their pole. Modes are written in x, y, z, with zeros where a direction
    is not known. Intervals, and the decay of an exponential window, stand in the header. The file appears whole or not
    at all.

    Args:
        path: of the file.
        contents: modes and FRFs, in the order in which they are written.
        title: of the model, 80 characters at most.

    Returns:
        The path.

    Raises:
        InputError: for modes in rotations or in no direction, and where the file cannot be written.
    """
    import pyuff

    if not contents:
        raise InputError("nothing to write; give modes or FRFs")
    sets: list[dict[str, Any]] = [
        {"type": 151, "model_name": title[:80], "description": "NONE", "db_app": "Faying", "program": "Faying"},
        {"type": 164, "units_code": 1, "units_description": "SI: Meter (newton)", "temp_mode": 2}
        | {"length": 1.0, "force": 1.0, "temp": 1.0, "temp_offset": 273.15},
    ]
    positions: dict[int, Position] = {}
    for content in contents:
        positions |= dict(content.positions)
    if positions:
        sets.append(_nodes(positions))
    for content in contents:
        sets += _shapes(content) if isinstance(content, ModeSet) else _functions(content)

    def write(temporary: Path) -> None:
        pyuff.UFF(str(temporary)).write_sets(sets, mode="overwrite")

    return write_atomically(Path(path), write)


def _nodes(positions: Mapping[int, Position]) -> dict[str, Any]:
    labels = sorted(positions)
    xyz = np.array([positions[label] for label in labels], float)
    zero = np.zeros(len(labels), dtype=int)
    return {
        "type": 2411,
        "node_nums": labels,
        "def_cs": zero,
        "disp_cs": zero,
        "color": zero + 1,
        **dict(zip("xyz", xyz.T, strict=True)),
    }


def _shapes(modes: ModeSet) -> list[dict[str, Any]]:
    bad = [str(d) for d in modes.dofs if d.split()[1] not in ("x", "y", "z")]
    if bad:
        raise InputError(
            f"{', '.join(bad)}: data set 55 takes motion along x, y and z; leave rotations out, and state the direction"
        )
    points = list(dict.fromkeys(d.point for d in modes.dofs))
    values = np.zeros((len(modes.frequencies), len(points), 3), complex)
    for k, dof in enumerate(modes.dofs):
        sign, name = dof.split()
        values[:, points.index(dof.point), "xyz".index(name)] = sign * modes.shapes[:, k]
    real = not np.any(values.imag)
    out = []
    for k, (f, loss) in enumerate(zip(modes.frequencies, modes.loss_factors, strict=True)):
        motion = values[k].real if real else values[k]
        data: dict[str, Any] = {
            "type": 55,
            "model_type": 1,
            "id1": f"mode {k + 1}",
            **_intervals(modes, k),
            "analysis_type": 2 if real else 3,
            "data_ch": 2,
            "spec_data_type": 8,
            "load_case": 1,
            "mode_n": k + 1,
            "node_nums": points,
            **dict(zip(("r1", "r2", "r3"), motion.T, strict=True)),
        }
        if real:
            data |= {"freq": f, "modal_m": 0.0, "modal_damp_vis": loss / 2, "modal_damp_his": 0.0}
        else:
            data["eig"] = 2 * np.pi * f * (-loss / 2 + 1j * np.sqrt(1 - min(loss / 2, 1.0) ** 2))
        out.append(data)
    return out


def _intervals(modes: ModeSet, k: int) -> dict[str, str]:
    """The intervals of one mode as words for its header, which `read_uff` finds again."""
    spans = {"id2": ("frequency", modes.frequency_interval), "id3": ("loss factor", modes.loss_interval)}
    return {
        key: f"95 % of {name}: {span[k, 0]:.8g} .. {span[k, 1]:.8g}"
        for key, (name, span) in spans.items()
        if span is not None
    }


def _functions(frf: FRF) -> list[dict[str, Any]]:
    kind, unit = TYPES[frf.quantity]
    gaps = np.diff(frf.frequency)
    even = bool(np.ptp(gaps) <= 1e-6 * gaps.mean())
    out = []
    for o, i in frf.measured:
        common = {
            "type": 58,
            "id1": f"{frf.outputs[o]} / {frf.inputs[i]}",
            **({"id2": f"exponential window of decay {frf.window_decay:.12g} 1/s"} if frf.window_decay else {}),
            **_place("rsp", frf.outputs[o]),
            **_place("ref", frf.inputs[i]),
            "abscissa_spacing": int(even),
            "abscissa_spec_data_type": 18,
            "abscissa_axis_units_lab": "Hz",
            "x": frf.frequency,
        }
        out.append(
            common
            | {
                "func_type": 4,
                "data": frf.values[o, i],
                "ordinate_spec_data_type": kind,
                "ordinate_axis_units_lab": unit,
                "orddenom_spec_data_type": 13,
                "orddenom_axis_units_lab": "N",
            }
        )
        if frf.coherence is not None and np.all(np.isfinite(frf.coherence[o, i])):
            out.append(common | {"func_type": 6, "data": frf.coherence[o, i], "orddenom_spec_data_type": 0})
    return out


def _place(prefix: str, dof: Dof) -> dict[str, int]:
    sign, name = dof.split()
    return {f"{prefix}_node": dof.point, f"{prefix}_dir": sign * CODES[name]}
