"""The preload of a case and its real modes, as the study asks for them."""

from collections.abc import Sequence
from typing import Any

from faying.errors import NotConverged
from faying.fe.changed import Changed, whole
from faying.fe.constraint import constrain
from faying.fe.interface import Interface
from faying.fe.memory import check_modes
from faying.fe.modes import Modes, lowest_modes
from faying.fe.nearby import NearbyModes, near_factor, refined_modes
from faying.fe.shifted import Shifted
from faying.fe.single import factorise_roughly
from faying.fe.solve import Factoriser
from faying.joint.equilibrium import PreloadState
from faying.joint.frame import added
from faying.joint.preload import PreloadProblem
from faying.joint.springs import Springs
from faying.joint.support_check import check_contact, checked_preload
from faying.joint.tighten import tighten_together
from faying.study.case import SPARE_MODES, Case
from faying.typing import Array

EXACT = 1e-8  # of the squared frequencies, complex or not: 5e-9 of a frequency, 1e-8 of a loss factor, 1e-4 of a shape
FEW = 6  # rounds of enrichment that cost about what a factorisation and the two rounds after it do
AT_ONCE = 8_000_000  # unknowns of all loads whose preload is found at once
KEPT, ROOM = 8, 24_000_000  # what the basis keeps: times the modes of one state, or numbers, whichever is more


def settled(case: Case, number: int, problem: PreloadProblem) -> PreloadState:
    """The preload of a case at one of its loads, counted from 0."""
    return checked_preload(case.structure, problem, case.study.forces(number), order=case.study.order)


class Preloads:
    """The preload of a case at its loads: at all of them at once, where they can go together.

    problem: of the case, or a like one with a factorisation; made here where None.
    """

    def __init__(self, case: Case, problem: PreloadProblem | None = None) -> None:
        self.case = case
        self.problem = problem or case.structure.assembly(solver=case.study.modes.solver)
        self._found: list[PreloadState | None] | None = None

    def at(self, number: int) -> PreloadState:
        """The preload at one of the loads, counted from 0. Raises what `checked_preload` raises."""
        if self._found is None:
            self._found = self._together()
        found = self._found[number]
        if found is None:
            return settled(self.case, number, self.problem)
        check_contact(self.case.structure, found.pressures, found.openings)
        return found

    def _together(self) -> list[PreloadState | None]:
        """The states at all loads; None for those that are to be found one by one, each from the one before."""
        study, structure = self.case.study, self.case.structure
        count = len(study.loads)
        fits = 1 < count <= AT_ONCE // structure.mesh.unknowns
        if not fits or study.order is not None or not self.problem.can_go_together:
            return [None] * count
        return tighten_together(structure, self.problem, [study.forces(k) for k in range(count)])


def modes_of(case: Case, springs: Sequence[Springs[Interface]], count: int | None = None) -> tuple[Modes, Any, Any]:
    """Real modes of a case with springs on its joints, and the stiffness and loss that they belong to.

    count: rigid motions included; those of the case where None.
    """
    stiffness, loss = joined(case, springs)
    return modes_with(case, stiffness, case.structure.vibrating[1], count), stiffness, loss


def joined(case: Case, springs: Sequence[Springs[Interface]]) -> tuple[Any, Any]:
    """Stiffness of a case with springs on its joints, and their loss, hysteretic or viscous as the study asks."""
    return case.structure.joined(springs, viscous=case.study.modes.damping == "viscous")


class SharedModes:
    """Real modes of a case under one set of springs after another, by one factorisation where that will do.

    The first springs give the factorisation and the basis; those that differ so much that the basis does not reach them
    in a few rounds get a factorisation of their own, which serves what comes later.
    """

    def __init__(self) -> None:
        self.near: NearbyModes | None = None  # where the modes were found last
        self._sprung: Any = None  # stiffness [N/m] of the springs in that of its basis

    def begin(self, case: Case, problem: PreloadProblem) -> None:
        """Take the factorisation of a preload where its springs are near to those that it led to, if none is at hand.

        It must be of what vibrates: bolts that have a stiffness or a mass of their own are not in it.
        """
        structure, factor = case.structure, problem.factor
        alike = structure.is_bare and problem.shift_frequency == case.shift_frequency
        if self.near is not None or problem.sprung is None or factor is None or not alike:
            return
        laid = [
            constrain(j.interface.springs(*k), structure.fixed, 0.0)
            for j, k in zip(structure.joints, problem.sprung, strict=True)
        ]
        sprung = added(None, laid)
        stiffness, mass = added(structure.vibrating[0], [sprung]), structure.vibrating[1]
        check_modes(case.mode_count, stiffness.shape[0])
        self.near = near_factor(
            factor,
            stiffness,
            mass,
            case.mode_count,
            rigid=structure.rigid,
            shift_frequency=case.shift_frequency,
            spare=SPARE_MODES,
            most=_most(case),
        )
        self._sprung = sprung

    def of(
        self, case: Case, springs: Sequence[Springs[Interface]], *, tolerance: float = EXACT, shapes: bool = True
    ) -> tuple[Modes, Any]:
        """Real modes, and the stiffness [N/m] that they belong to, which may be a `Changed` one.

        tolerance: of the squared frequencies, relative; shapes: False where only these are wanted.
        """
        structure = case.structure
        sprung = structure.sprung(springs)
        if self.near is not None:
            # the sum with the parts would take longer than the modes where the basis has them
            stiffness = Changed(before=self.near.span.stiffness, change=sprung - self._sprung)
            try:
                return self._from_near(case, stiffness, tolerance, shapes), stiffness
            except NotConverged:
                self._factorise(case, whole(stiffness))
            try:
                return self._from_near(case, stiffness, tolerance, shapes), stiffness
            except NotConverged:
                self.near = None  # before the next factorisation: one at a time in memory
        stiffness, mass = added(structure.vibrating[0], [sprung]), structure.vibrating[1]
        modes = modes_with(case, stiffness, mass, rigid=structure.rigid)
        self.near = NearbyModes(modes, stiffness, mass, rigid=case.rigid_count, most=_most(case))
        self._sprung = sprung
        return modes, stiffness

    def _from_near(self, case: Case, stiffness: Any, tolerance: float, shapes: bool) -> Modes:
        assert self.near is not None
        count = case.study.modes.count
        spare = case.mode_count - case.rigid_count - count
        return self.near.under(stiffness, count, tolerance=tolerance, spare=spare, rounds=FEW, shapes=shapes)

    def _factorise(self, case: Case, stiffness: Any) -> None:
        """Factorise a stiffness [N/m] that the factorisation at hand is far from; the basis stays."""
        assert self.near is not None
        matrix = Shifted(stiffness=stiffness, mass=case.structure.vibrating[1], shift=self.near.modes.shift)
        solver = case.structure.solver(case.study.modes.solver)
        self.near.take(factorise_roughly(matrix, rigid=case.structure.rigid, solver=solver), stiffness)


def _most(case: Case) -> int:
    """How many vectors the basis of a case keeps from one state to the next."""
    return max(KEPT * case.mode_count, ROOM // case.structure.mesh.unknowns)


def modes_with(
    case: Case,
    stiffness: Any,
    mass: Any,
    count: int | None = None,
    *,
    rigid: Array | None = None,
    solver: str | Factoriser | None = None,
) -> Modes:
    """Real modes of any stiffness [N/m] and mass [kg], by the solver and the shift of a case.

    count: those of the case where None, its spare ones to no tolerance. rigid: the motions (n, r) that the stiffness
    leaves free, with which a factorisation in single precision will do; None where they are not known. solver: in place
    of that of the case.
    """
    spare = SPARE_MODES if count is None else 0
    count = count or case.mode_count
    check_modes(count, stiffness.shape[0])
    frequency, solver = case.shift_frequency, solver or case.structure.solver(case.study.modes.solver)
    if rigid is None:
        return lowest_modes(stiffness, mass, count, shift_frequency=frequency, solver=case.study.modes.solver)
    return refined_modes(stiffness, mass, count, rigid=rigid, shift_frequency=frequency, solver=solver, spare=spare)
