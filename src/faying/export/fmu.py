"""A superelement as an FMU for co-simulation (FMI 2.0): forces on its interfaces in, their motions out."""

import re
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from shutil import copy
from tempfile import TemporaryDirectory

import numpy as np

from faying.errors import InputError
from faying.files import together
from faying.typing import Array, Index

DIRECTIONS = ("x", "y", "z", "rx", "ry", "rz")
FILE = "superelement.fmu"
RIGID = 1e-3  # of the lowest elastic frequency: what lies below is a rigid motion, and has neither stiffness nor loss


def write_fmu(
    folder: Path,
    title: str,
    names: tuple[str, ...],
    dofs: Index,
    stiffness: Array,
    mass: Array,
    loss: Array,
    lowest: float,
) -> list[Path]:
    """Write matrices (n, n) of interfaces and modes as `superelement.fmu`.

    Each mode of these matrices keeps its own share of the loss, as a viscous damping ratio: that is exact at its
    resonance. What the loss couples of different modes is left out.

    Args:
        folder: Where the file goes.
        title: What it is.
        names: Of the interfaces.
        dofs: Interface, from 1, and direction, 1 to 6, of each row; direction 0 of a mode (n, 2).
        stiffness, mass, loss: [N/m, N, N m; kg, kg m, kg m2]; the loss is the imaginary part of the stiffness.
        lowest: Elastic frequency [Hz].

    Raises:
        InputError: PythonFMU is not installed, or the folder cannot be used.
    """
    from scipy.linalg import eigh

    if find_spec("pythonfmu") is None:
        raise InputError(
            "an FMU is packed by PythonFMU, which is not installed; add --extra fmu to uv run, or pip install pythonfmu"
        )
    squared, shapes = eigh(stiffness, mass)
    elastic = squared > (RIGID * 2 * np.pi * lowest) ** 2
    squared = np.where(elastic, squared, 0.0)
    lost = np.einsum("im,ij,jm->m", shapes, loss, shapes)
    some = dofs[:, 1] > 0
    places = [re.sub(r"^(?=[0-9])|[^A-Za-z0-9_]", "_", name) for name in names]
    if len({*places}) < len(places):
        raise InputError(f"the interfaces {', '.join(names)} are not told apart in an FMU: {places}; rename a face")
    pairs = [(k - 1, DIRECTIONS[way - 1]) for k, way in dofs[some].tolist()]
    with TemporaryDirectory() as there, together(folder, "give another (--out)") as hidden:
        np.savez(
            Path(there) / "modes.npz",
            title=title,
            names=[f"{places[k]}.{way}" for k, way in pairs],
            words=[f"of {names[k]!r}, {way}" for k, way in pairs],
            shapes=shapes[some],
            omega=np.sqrt(squared),
            ratio=np.divide(lost, 2 * squared, out=np.zeros_like(lost), where=elastic),
        )
        program = copy(Path(__file__).with_name("fmu_unit.py"), there)
        pack = ["-m", "pythonfmu", "build", "-f", program, "-d", str(hidden / FILE), f"{there}/modes.npz"]
        # in a process of its own: it leaves the program among the modules of the one that packs
        subprocess.run([sys.executable, *pack], check=True, capture_output=True)
    return [folder / FILE]
