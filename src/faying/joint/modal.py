"""What is asked about the vibration of a structure: how many modes, which loss, by which factorisation."""

from dataclasses import dataclass, field
from typing import Literal

from faying.joint.bolted import BoltedStructure
from faying.numerics.solve import BY_PARTS, MPI

SPARE_MODES = 6  # beyond those asked for, so that the basis of the complex modes does not end at the last of them
MAX_MODES = 10_000
SOLVERS = ("pardiso", BY_PARTS, "mumps", "cholmod", "superlu", MPI)


@dataclass(frozen=True, kw_only=True)
class ModesChoice:
    """How many elastic modes, which kind of loss, which factorisation, which shift [Hz] (None: chosen).

    levels: accelerations [m/s2] of the point that moves most, at which damping is found; none where empty.
    intervals: whether a run finds the interval of every frequency, and draws waves where faces have them.
    """

    count: int = 10
    damping: Literal["hysteretic", "viscous"] = "hysteretic"
    solver: str | None = None
    shift_frequency: float | None = None
    levels: tuple[float, ...] = (0.1, 1.0, 10.0)
    intervals: bool = True


@dataclass(frozen=True, kw_only=True)
class ModalProblem:
    """A structure, and what is asked about its modes."""

    structure: BoltedStructure
    choice: ModesChoice = field(default_factory=ModesChoice)

    @property
    def shift_frequency(self) -> float:
        """Where the modes are looked for [Hz]."""
        return self.choice.shift_frequency or self.structure.shift_frequency

    @property
    def rigid_count(self) -> int:
        """Rigid motions that nothing resists."""
        return self.structure.rigid_count

    @property
    def mode_count(self) -> int:
        """Real modes that are computed, rigid and spare ones included."""
        return self.rigid_count + self.choice.count + SPARE_MODES
