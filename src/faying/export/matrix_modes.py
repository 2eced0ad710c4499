"""Modes of matrices that another program has assembled, or of a study at its first preload."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from faying.checks import number, whole
from faying.decks.matrices import total_mass
from faying.errors import InputError
from faying.export.assembled import Assembled
from faying.file_kinds import STUDY, kind_of
from faying.joint.modal import MAX_MODES
from faying.misuse import checked_call
from faying.numerics.memory import check_modes
from faying.numerics.modes import lowest_modes, missed_modes
from faying.study.study import Study
from faying.style import Summary
from faying.typing import Array, Index

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
        rows = {"mass along x, y, z": ", ".join(f"{one:.6g} kg" for one in self.mass)}
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
        mass=total_mass(given.mass, given.dofs),
        missed=missed_modes(given.stiffness, given.mass, modes),
        solver=modes.factorisation.name,
        factor_memory=modes.factorisation.memory,
    )
