"""What finds the preload and the modes of a case: plainly, or from what is known of the states before."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol, final

from faying.case.case import Case
from faying.case.preloads import Preloads
from faying.errors import InputError
from faying.fe.interface import Interface
from faying.joint.equilibrium import PreloadState
from faying.joint.plain import PlainPreload
from faying.joint.preload import PreloadProblem
from faying.joint.shared_modes import EXACT, SharedModes
from faying.joint.springs import Springs
from faying.joint.state import Vibration, vibrate
from faying.joint.support_check import check_motions, checked_preload
from faying.numerics.damped import damped_modes
from faying.numerics.modes import Modes, lowest_modes
from faying.typing import Array

RANGE_ERROR = 1e-4  # of the squared frequencies at the ends of a range, which no digit of a law's range asks for


class Engine(Protocol):
    """How the equations of a case are solved; no printed digit depends on it."""

    def preload(self, number: int) -> PreloadState:
        """The equilibrium at one of the loads, counted from 0; raises as `checked_preload` does."""

    def vibrate(self, springs: Sequence[Springs[Interface]]) -> Vibration:
        """Real and complex modes with springs on the joints. Raises InputError where a part moves freely."""

    def frequencies(self, springs: Sequence[Springs[Interface]]) -> Array:
        """Frequencies [Hz] of the elastic modes with other springs, their squares to `RANGE_ERROR` or nearer."""

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
            structure.supported_stiffness,
            structure.rigid,
            [(joint.interface, joint.law) for joint in structure.joints],
            friction=[joint.friction for joint in structure.joints],
            fixed=structure.fixed,
            solver=solver,
        )

    def preload(self, number: int) -> PreloadState:
        """See `Engine`."""
        return checked_preload(self.case.structure, self._problem, self.case.study.preloads[number])

    def vibrate(self, springs: Sequence[Springs[Interface]]) -> Vibration:
        """See `Engine`."""
        case, structure, choice = self.case, self.case.structure, self.case.study.modes
        modes, stiffness = self._modes(springs)
        check_motions(structure, modes)
        loss = structure.joint_loss(springs, viscous=choice.damping == "viscous")
        damped = damped_modes(
            modes,
            stiffness,
            structure.dynamic_matrices[1],
            loss,
            rigid=case.rigid_count,
            count=choice.count,
            kind=choice.damping,
            tolerance=EXACT,
        )
        return Vibration(modes=modes, damped=damped, stiffness=stiffness, loss=loss)

    def frequencies(self, springs: Sequence[Springs[Interface]]) -> Array:
        """See `Engine`."""
        modes, _ = self._modes(springs)
        return modes.frequencies[self.case.rigid_count :][: self.case.study.modes.count]

    def of(self, case: Case) -> "Direct":
        """See `Engine`."""
        return Direct(case)

    def _modes(self, springs: Sequence[Springs[Interface]]) -> tuple[Modes, Any]:
        case, structure = self.case, self.case.structure
        stiffness, _ = structure.coupled(springs)
        return lowest_modes(
            stiffness,
            structure.dynamic_matrices[1],
            case.modal.mode_count,
            shift_frequency=case.shift_frequency,
            solver=case.study.modes.solver,
            rigid=structure.rigid,
        ), stiffness


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

    def vibrate(self, springs: Sequence[Springs[Interface]]) -> Vibration:
        """See `Engine`."""
        return vibrate(self.case.modal, springs, self._preloads.problem, self._shared)

    def frequencies(self, springs: Sequence[Springs[Interface]]) -> Array:
        """See `Engine`."""
        if not self._looked and self._shared.near is not None:
            self._shared.near.look_everywhere()
            self._looked = True
        modes, _ = self._shared.of(self.case.modal, springs, tolerance=RANGE_ERROR, shapes=False)
        return modes.frequencies[self.case.rigid_count :][: self.case.study.modes.count]

    def of(self, case: Case) -> "Reanalysis":
        """See `Engine`; the factorisation at hand serves the other case, too."""
        problem = case.structure.assembly(solver=case.study.modes.solver)
        if self._shared.near is not None:
            problem.adopt_factor(self._shared.near.modes.factorisation, case.shift_frequency)
        return Reanalysis(case, shared=self._shared, problem=problem)


ENGINES: dict[str, Callable[[Case], Engine]] = {"reanalysis": Reanalysis, "direct": Direct}


def engine_of(name: str, case: Case) -> Engine:
    """The engine of a name. Raises InputError for another name than those of `ENGINES`."""
    if name not in ENGINES:
        raise InputError(f"engine = {name!r}; allowed: {', '.join(ENGINES)}")
    return ENGINES[name](case)
