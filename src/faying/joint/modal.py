"""What is asked about the vibration of a structure, who answers it, and the answer."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, Protocol

import numpy as np

from faying.fe.interface import Interface
from faying.joint.bolted import BoltedStructure
from faying.joint.equilibrium import PreloadState
from faying.joint.springs import Springs
from faying.numerics.damped import DampedModes
from faying.numerics.follow import follow, may_cross
from faying.numerics.modes import Modes
from faying.numerics.solve import BY_PARTS
from faying.typing import Array

SPARE_MODES = 6  # beyond those asked for, so that the basis of the complex modes does not end at the last of them
MAX_MODES = 10_000
EXACT = 1e-8  # of the squared frequencies, complex or not: 5e-9 of a frequency, 1e-8 of a loss factor, 1e-4 of a shape
SOLVERS = ("pardiso", BY_PARTS, "superlu")


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


@dataclass(frozen=True, kw_only=True)
class Vibration:
    """Real and complex modes under the springs of the joints, with stiffness and loss [N/m] that they belong to."""

    modes: Modes
    damped: DampedModes
    stiffness: Any
    loss: Any


class Engine(Protocol):
    """How the equations of a structure are solved at its preloads; no printed digit depends on it."""

    def preload(self, number: int) -> PreloadState:
        """The equilibrium at one of the preloads, counted from 0; raises as `checked_preload` does."""

    def vibrate(self, springs: Sequence[Springs[Interface]]) -> Vibration:
        """Real and complex modes with springs on the joints. Raises InputError where a part moves freely."""

    def frequencies(self, springs: Sequence[Springs[Interface]], before: Modes, *, one_way: bool) -> Array:
        """Frequencies [Hz] of the elastic modes with other springs, their squares to 1e-4 or nearer.

        before: the modes whose order they have, each that of the mode whose shape it has; one_way: whether no spring is
        softer than those of these modes, or none is stiffer.
        """


def in_order_of(before: Modes, problem: ModalProblem, found: Callable[[bool], Modes], one_way: bool) -> Array:
    """Frequencies [Hz] (m,) of the lowest elastic modes under other springs, in the order of those before.

    found: returns the modes, with shapes where these are asked for: only where modes may have changed places.
    """
    lowest = slice(problem.rigid_count, problem.rigid_count + problem.choice.count)
    here = before.frequencies[lowest]
    if one_way and not may_cross(here, there := found(False).frequencies[lowest]):
        return there
    modes, mass = found(True), problem.structure.dynamic_matrices[1]
    order = follow(before.shapes[:, lowest], modes.shapes[:, lowest], mass, here)
    return np.asarray(modes.frequencies[lowest][order])
