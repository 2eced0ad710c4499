"""Modes of matrices that another program has assembled, with or without a joint added here, or of a study."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from faying.case.case import build
from faying.checks import number, whole
from faying.decks.matrices import arranged, read_matrices, read_pair, total_mass
from faying.errors import InputError
from faying.export.attach import Attachment
from faying.fe.elasticity import rigid_motions
from faying.file_kinds import STUDY, kind_of
from faying.files import together, write_arrays, write_text
from faying.joint.assembled_parts import compact_shift
from faying.joint.modal import MAX_MODES
from faying.joint.support_check import checked_preload
from faying.misuse import checked_call
from faying.numerics.damped import DampedModes, damped_modes
from faying.numerics.memory import check_modes
from faying.numerics.modes import lowest_modes, missed_modes
from faying.study.study import Study
from faying.style import Summary
from faying.typing import Array, Index


@dataclass(frozen=True, kw_only=True)
class Assembled:
    """Stiffness [N/m] and mass [kg] (n, n), sparse CSR; dofs (n, 2): node and direction; a frequency to shift by [Hz].

    points: coordinates (nodes, 3) [m], where known; loss: imaginary part of the stiffness [N/m] (n, n), where known.
    """

    stiffness: Any
    mass: Any
    dofs: Index
    shift_frequency: float
    source: str
    points: Array | None = None
    loss: Any | None = None

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
        """Write stiffness.npz, mass.npz (SciPy), dofs.txt, and where known loss.npz and points.txt, all or none."""
        from scipy.sparse import csr_matrix

        out = []
        with together(folder, "give another (--export)") as hidden:
            for name, matrix in (("stiffness", self.stiffness), ("mass", self.mass), ("loss", self.loss)):
                if matrix is None:
                    continue
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


MAX_ROWS = 9  # frequencies in a summary


@checked_call
@dataclass(frozen=True, kw_only=True, repr=False)
class MatrixModes(Summary):
    """Lowest modes of a pair of matrices, rigid motions among them.

    Args:
        source: Name of the study or of the file of the stiffness.
        frequencies: [Hz] (m,).
        shapes: Mass-normalised [kg^-1/2] (unknowns, m).
        dofs: Node and direction of each unknown (unknowns, 2).
        mass: Along x, y and z [kg] (3,).
        missed: How many modes below the last of these are missing; 0 where none are.
        solver, factor_memory: What factorised the matrices, and the memory that its factor took [B].
    """

    source: str
    frequencies: Array
    shapes: Array
    dofs: Index
    mass: Array
    missed: int
    solver: str
    factor_memory: float

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return the unknowns, the mass, and the first frequencies."""
        known = zip("xyz", self.mass, strict=True)
        rows = {"mass": ", ".join(f"{one:.6g} kg along {axis}" for axis, one in known if one == one) or "not known"}
        rows |= {f"mode {k}": f"{one:.6f} Hz" for k, one in enumerate(self.frequencies[:MAX_ROWS], 1)}
        rows |= {"missing": f"{self.missed} modes below the last; give another shift"} if self.missed else {}
        return f"{len(self.frequencies)} modes of {self.source}: {len(self.shapes):,} unknowns, {self.solver}", rows

    def to_dict(self) -> dict[str, Any]:
        """Everything but the shapes, in SI units."""
        return {
            "source": self.source,
            "unknowns": len(self.shapes),
            "solver": self.solver,
            "factor_memory": {"unit": "B", "value": self.factor_memory},
            "missed": self.missed,
            "mass": {"unit": "kg", "values": self.mass.tolist()},
            "frequencies": {"unit": "Hz", "values": self.frequencies.tolist()},
        }


@checked_call
def matrix_modes(
    stiffness: Study | str | Path,
    mass: str | Path | None = None,
    *,
    stiffness_unit: str = "N/m",
    mass_unit: str = "kg",
    count: int = 20,
    shift: float | str | None = None,
) -> MatrixModes:
    """Find the lowest modes of matrices that another program has assembled, or of a study.

    Args:
        stiffness: File: .mtx, .npz, .sti of CalculiX, or DMIG of Nastran; or a study, whose matrices at its first
            preload are taken.
        mass: File of the mass, where that of the stiffness has none.
        stiffness_unit, mass_unit: Units of the entries.
        count: How many modes, 1 to 10,000, rigid motions among them.
        shift: Frequency of the spectral shift [Hz], or text with a unit; found from the matrices where None.

    Returns:
        The modes.

    Raises:
        ReadError, InputError: Files, units or numbers that cannot be used.
        NotConverged: The iteration stops short.
    """
    count = whole(count, "count", least=1, greatest=MAX_MODES)
    if isinstance(stiffness, Study) or kind_of(Path(stiffness)) is STUDY:
        if mass is not None:
            raise InputError("a study has a mass of its own; leave mass out")
        given = Assembled.of_study(Study.read(stiffness))
    else:
        file = None if mass is None else Path(mass)
        given = Assembled.of_files(Path(stiffness), file, stiffness_unit=stiffness_unit, mass_unit=mass_unit)
    return modes_of(given, count, given.shift_frequency if shift is None else number(shift, "shift", "Hz", least=0))


def modes_of(given: Assembled, count: int, shift: float) -> MatrixModes:
    """The lowest modes of assembled matrices; shift [Hz]. Raises InputError where memory is too short for them."""
    check_modes(count, given.stiffness.shape[0])
    modes = lowest_modes(given.stiffness, given.mass, count, shift_frequency=shift)
    return MatrixModes(
        source=given.source,
        frequencies=modes.frequencies,
        shapes=modes.shapes,
        dofs=given.dofs,
        mass=total_mass(given.mass, given.dofs, given.stiffness),
        missed=missed_modes(given.stiffness, given.mass, modes),
        solver=modes.factorisation.name,
        factor_memory=modes.factorisation.memory,
    )


SPARE = 6  # modes beyond those asked for, for the basis of the complex ones
MIN_RESISTANCE = 1e-9  # of the greatest energy of a rigid motion under an equal diagonal: below it nothing resists


@checked_call
def modes_with_joint(
    attachment: Attachment,
    matrices: str | Path,
    *,
    stiffness_unit: str | None,
    mass_unit: str | None,
    mass: str | Path | None = None,
    dofs: str | Path | None = None,
    count: int = 10,
) -> tuple[DampedModes, int]:
    """Find the elastic modes, with loss factors, of parts that another program has assembled, and of the joint.

    Args:
        attachment: The joint, on the mesh of the matrices, node by node.
        matrices: File of stiffness and mass, or of the stiffness: .sti, .mtx, .npz, DMIG.
        stiffness_unit, mass_unit: Units of the entries, such as "N/mm" and "t".
        mass, dofs: With a .mtx: file of the mass, and of "node direction" of each row.
        count: How many elastic modes.

    Returns:
        The modes, and how many rigid motions nothing resists.

    Raises:
        ReadError, InputError: Files or units that cannot be used, matrices of another mesh or with supports.
        NotConverged: The iteration stops short.
    """
    pairs, mesh = attachment.pairs, attachment.deck.mesh
    read = read_matrices(matrices, stiffness_unit=stiffness_unit, mass_unit=mass_unit, mass=mass, dofs=dofs)
    bare, M = arranged(read, mesh)
    K, C = bare + pairs.matrix(), pairs.matrix(pairs.loss)
    rigid = rigid_motions(mesh.points)
    energy = np.einsum("ij,ij->j", rigid, K @ rigid)
    still = int(np.count_nonzero(energy < MIN_RESISTANCE * np.einsum("ij,i,ij->j", rigid, K.diagonal(), rigid)))
    if still not in (0, 6):
        raise InputError(
            f"the matrices leave {still} of the six rigid motions free; take them from the model without supports, or "
            "fixed in all directions"
        )
    shift = compact_shift(attachment.materials.values(), mesh.size)
    check_modes(count + still + SPARE, K.shape[0])
    found = lowest_modes(K, M, count + still + SPARE, shift_frequency=shift)
    return damped_modes(found, K, M, C, rigid=still, count=count), still
