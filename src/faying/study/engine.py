"""What finds the preload and the modes of a case: plainly, or from what is known of the states before."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol, final

from faying.errors import InputError
from faying.fe.damped import DampedModes, damped_modes, damped_near
from faying.fe.interface import Interface
from faying.fe.modes import Modes, lowest_modes
from faying.joint.equilibrium import PreloadState
from faying.joint.plain import PlainPreload
from faying.joint.preload import PreloadProblem
from faying.joint.springs import Springs
from faying.joint.support_check import checked_preload
from faying.study.case import Case
from faying.study.modes import EXACT, Preloads, SharedModes
from faying.typing import Array

RANGE_ERROR = 1e-4  # of the squared frequencies at the ends of a range, which no digit of a law's range asks for


class Engine(Protocol):
    """How the equations of a case are solved; no printed digit depends on it."""

    def preload(self, number: int) -> PreloadState:
        """The equilibrium at one of the loads, counted from 0; raises as `checked_preload` does."""

    def modes(self, springs: Sequence[Springs[Interface]]) -> tuple[Modes, Any]:
        """Real modes with springs on the joints, and the stiffness [N/m] that they belong to."""

    def damped(self, modes: Modes, stiffness: Any, loss: Any) -> DampedModes:
        """Complex modes, from the real ones and the loss of the joints [N/m], or [N s/m] where it is viscous."""

    def frequencies(self, springs: Sequence[Springs[Interface]]) -> Array:
        """Frequencies [Hz] of the elastic modes with other springs, to half of `RANGE_ERROR`."""

    def of(self, case: Case) -> "Engine":
        """The same for the case under another law or form, on the same mesh."""


@final
class Direct:
    """Each state by itself: Newton with a factorisation for each step, Lanczos with one for each set of modes.

    Slower than `Reanalysis` by the number of factorisations, and with nothing that needs explaining.
    """

    def __init__(self, case: Case) -> None:
        self.case = case
        structure, solver = case.structure, case.study.modes.solver
        self._problem = PlainPreload(
            structure.standing,
            structure.rigid,
            [(joint.interface, joint.law) for joint in structure.joints],
            friction=[joint.friction for joint in structure.joints],
            fixed=structure.fixed,
            solver=solver,
        )

    def preload(self, number: int) -> PreloadState:
        """See `Engine`."""
        study = self.case.study
        return checked_preload(self.case.structure, self._problem, study.forces(number), order=study.order)

    def modes(self, springs: Sequence[Springs[Interface]]) -> tuple[Modes, Any]:
        """See `Engine`."""
        case, structure = self.case, self.case.structure
        stiffness, _ = structure.joined(springs)
        return lowest_modes(
            stiffness,
            structure.vibrating[1],
            case.mode_count,
            shift_frequency=case.shift_frequency,
            solver=case.study.modes.solver,
            rigid=structure.rigid,
        ), stiffness

    def damped(self, modes: Modes, stiffness: Any, loss: Any) -> DampedModes:
        """See `Engine`."""
        case = self.case
        return damped_modes(
            modes,
            stiffness,
            case.structure.vibrating[1],
            loss,
            rigid=case.rigid_count,
            count=case.study.modes.count,
            kind=case.study.modes.damping,
            tolerance=EXACT,
        )

    def frequencies(self, springs: Sequence[Springs[Interface]]) -> Array:
        """See `Engine`."""
        modes, _ = self.modes(springs)
        return modes.frequencies[self.case.rigid_count :][: self.case.study.modes.count]

    def of(self, case: Case) -> "Direct":
        """See `Engine`."""
        return Direct(case)


@final
class Reanalysis:
    """One factorisation and one basis for many states.

    All loads find their preload together, or each from those before; modes grow from one basis, and start from the
    factorisation of the preload. `Direct` has the same answer.
    """

    def __init__(self, case: Case, *, shared: SharedModes | None = None, problem: PreloadProblem | None = None) -> None:
        self.case = case
        self._preloads = Preloads(case, problem)
        self._shared = SharedModes() if shared is None else shared
        self._looked = False  # for modes that only the ends of a range bring among the lowest

    def preload(self, number: int) -> PreloadState:
        """See `Engine`."""
        return self._preloads.at(number)

    def modes(self, springs: Sequence[Springs[Interface]]) -> tuple[Modes, Any]:
        """See `Engine`."""
        self._shared.begin(self.case, self._preloads.problem)
        modes, stiffness = self._shared.of(self.case, springs)
        self._preloads.problem.take(modes.factorisation, self.case.shift_frequency)
        return modes, stiffness

    def damped(self, modes: Modes, stiffness: Any, loss: Any) -> DampedModes:
        """See `Engine`."""
        near, modes_asked = self._shared.near, self.case.study.modes
        assert near is not None
        return damped_near(
            near, modes, stiffness, loss, count=modes_asked.count, kind=modes_asked.damping, tolerance=EXACT
        )

    def frequencies(self, springs: Sequence[Springs[Interface]]) -> Array:
        """See `Engine`."""
        if not self._looked and self._shared.near is not None:
            self._shared.near.look_everywhere()
            self._looked = True
        modes, _ = self._shared.of(self.case, springs, tolerance=RANGE_ERROR, shapes=False)
        return modes.frequencies[self.case.rigid_count :][: self.case.study.modes.count]

    def of(self, case: Case) -> "Reanalysis":
        """See `Engine`; the factorisation at hand serves the other case, too."""
        problem = case.structure.assembly(solver=case.study.modes.solver)
        if self._shared.near is not None:
            problem.take(self._shared.near.modes.factorisation, case.shift_frequency)
        return Reanalysis(case, shared=self._shared, problem=problem)


ENGINES: dict[str, Callable[[Case], Engine]] = {"reanalysis": Reanalysis, "direct": Direct}


def engine_of(name: str, case: Case) -> Engine:
    """The engine of a name. Raises InputError for another name than those of `ENGINES`."""
    if name not in ENGINES:
        raise InputError(f"engine = {name!r}; allowed: {', '.join(ENGINES)}")
    return ENGINES[name](case)
