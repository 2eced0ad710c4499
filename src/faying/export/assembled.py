"""The assembled matrices of a study at its first preload, or of files, for modes alone and for other solvers."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from faying.case.case import build
from faying.decks.matrices import read_pair
from faying.files import together, write_arrays, write_text
from faying.joint.support_check import checked_preload
from faying.study.study import Study
from faying.typing import Array, Index


@dataclass(frozen=True, kw_only=True)
class Assembled:
    """Stiffness [N/m] and mass [kg] (n, n), sparse CSR; dofs (n, 2): node and direction; a frequency to shift by [Hz].

    points: coordinates (n / 3, 3) [m] of the nodes, where known.
    """

    stiffness: Any
    mass: Any
    dofs: Index
    shift_frequency: float
    source: str
    points: Array | None = None

    @classmethod
    def of_study(cls, study: Study) -> "Assembled":
        """Assemble a study with the springs of its joints at its first preload."""
        structure = build(study)
        assembly = structure.assembly(solver=study.modes.solver)
        found = checked_preload(structure, assembly, study.preloads[0])
        structure = structure.under(found)
        stiffness, _ = structure.coupled(structure.springs(found.pressures))
        numbers = structure.mesh.numbers
        dofs = np.column_stack([np.repeat(numbers, 3), np.tile([1, 2, 3], len(numbers))])
        return cls(
            stiffness=stiffness,
            mass=structure.dynamic_matrices[1],
            dofs=dofs,
            shift_frequency=study.modes.shift_frequency or structure.shift_frequency,
            source=study.title,
            points=structure.mesh.points,
        )

    @classmethod
    def of_files(cls, stiffness: Path, mass: Path | None, *, stiffness_unit: str, mass_unit: str) -> "Assembled":
        """Read matrices of any program; see `faying.decks.matrices.read_pair`."""
        K, M, dofs = read_pair(stiffness, mass, stiffness_unit=stiffness_unit, mass_unit=mass_unit)
        return cls(stiffness=K, mass=M, dofs=dofs, shift_frequency=typical_frequency(K, M), source=stiffness.name)

    def write(self, folder: Path) -> list[Path]:
        """Write stiffness.npz, mass.npz (SciPy), dofs.txt and where known points.txt, all or none of them."""
        from scipy.sparse import csr_matrix

        out = []
        with together(folder, "give another (--export)") as hidden:
            for name, matrix in (("stiffness", self.stiffness), ("mass", self.mass)):
                csr = csr_matrix(matrix)
                arrays = {"format": b"csr", "shape": csr.shape}  # as scipy.sparse.save_npz has them
                arrays |= {part: getattr(csr, part) for part in ("indices", "indptr", "data")}
                out.append(write_arrays(hidden / f"{name}.npz", arrays, seal=False))
            text = "\n".join(f"{node}.{axis}" for node, axis in self.dofs) + "\n"
            out.append(write_text(hidden / "dofs.txt", text))
            if self.points is not None:
                text = "".join(f"{x:.17g} {y:.17g} {z:.17g}\n" for x, y, z in self.points.tolist())
                out.append(write_text(hidden / "points.txt", text))
        return [folder / file.name for file in out]


def typical_frequency(stiffness: Any, mass: Any) -> float:
    """A frequency [Hz] of the order of the first mode of a compact body: a wave of some ten bodies' length.

    The mean of the diagonals gives the frequency of one element; a body of n unknowns is n^(1/3) elements across.
    """
    n = stiffness.shape[0]
    element = np.sqrt(stiffness.diagonal().sum() / mass.diagonal().sum()) / (2 * np.pi)
    return float(0.1 * element / np.cbrt(n))
