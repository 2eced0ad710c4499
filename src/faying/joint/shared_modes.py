"""Preloads and modes of a structure in one state after another, by one factorisation where that will do."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, final

from faying.errors import NotConverged
from faying.fe.interface import Interface
from faying.joint.assembled_parts import added
from faying.joint.bolted import BoltedStructure
from faying.joint.equilibrium import PreloadState
from faying.joint.modal import EXACT, SPARE_MODES, ModalProblem, Vibration, in_order_of
from faying.joint.preload import PreloadProblem
from faying.joint.preload_case import PreloadCase
from faying.joint.springs import Springs
from faying.joint.support_check import check_motions, checked_preload
from faying.numerics.constraint import constrain
from faying.numerics.damped import damped_near
from faying.numerics.memory import check_modes
from faying.numerics.modal_reanalysis import ModalReanalysis, near_factor, refined_modes
from faying.numerics.modes import Modes, lowest_modes
from faying.numerics.shifted import Shifted
from faying.numerics.single import factorise_roughly
from faying.typing import Array

RANGE_ERROR = 1e-4  # of the squared frequencies at the ends of a range, which no digit of a law's range asks for
MAX_ROUNDS = 6  # rounds of enrichment that cost about what a factorisation and the two rounds after it do
BASIS_STATES, ROOM = 8, 24_000_000  # what the basis keeps: times the modes of one state, or numbers, whichever is more


def modes_of(
    problem: ModalProblem, springs: Sequence[Springs[Interface]], count: int | None = None
) -> tuple[Modes, Any, Any]:
    """Real modes of a structure with springs on its joints, and the stiffness and loss that they belong to.

    count: rigid motions included; those of the problem where None.
    """
    stiffness, loss = coupled(problem, springs)
    return modes_with(problem, stiffness, problem.structure.dynamic_matrices[1], count), stiffness, loss


def coupled(problem: ModalProblem, springs: Sequence[Springs[Interface]]) -> tuple[Any, Any]:
    """Stiffness of a structure with springs on its joints, and their loss, hysteretic or viscous as asked."""
    return problem.structure.coupled(springs, viscous=problem.choice.damping == "viscous")


class SharedModes:
    """Real modes of a structure under one set of springs after another, by one factorisation where that will do.

    The first springs give the factorisation and the basis; those that differ so much that the basis does not reach them
    in a few rounds get a factorisation of their own, which serves what comes later.
    """

    def __init__(self) -> None:
        self.near: ModalReanalysis | None = None  # where the modes were found last

    def begin(self, problem: ModalProblem, preload: PreloadProblem) -> None:
        """Take the factorisation of a preload where its springs are near to those that it led to, if none is at hand.

        It must be of what vibrates: bolts that have a stiffness or a mass of their own are not in it.
        """
        structure, factor = problem.structure, preload.factor
        alike = structure.is_parts_only and preload.shift_frequency == problem.shift_frequency
        if self.near is not None or preload.factorised_springs is None or factor is None or not alike:
            return
        laid = [
            constrain(j.interface.springs(*k), structure.fixed, 0.0)
            for j, k in zip(structure.joints, preload.factorised_springs, strict=True)
        ]
        stiffness, mass = added(structure.dynamic_matrices[0], laid), structure.dynamic_matrices[1]
        check_modes(problem.mode_count, stiffness.shape[0])
        self.near = near_factor(
            factor,
            stiffness,
            mass,
            problem.mode_count,
            rigid=structure.rigid,
            shift_frequency=problem.shift_frequency,
            spare=SPARE_MODES,
            most=_most(problem),
        )

    def of(
        self,
        problem: ModalProblem,
        springs: Sequence[Springs[Interface]],
        *,
        tolerance: float = EXACT,
        shapes: bool = True,
    ) -> tuple[Modes, Any]:
        """Real modes, and the stiffness [N/m] that they belong to.

        tolerance: of the squared frequencies, relative; shapes: False where only these are wanted.
        """
        structure = problem.structure
        parts, mass = structure.dynamic_matrices
        stiffness = added(parts, [structure.joint_stiffness(springs)])
        if self.near is not None:
            try:
                return self._from_near(problem, stiffness, tolerance, shapes), stiffness
            except NotConverged:
                self._factorise(problem, stiffness)
            try:
                return self._from_near(problem, stiffness, tolerance, shapes), stiffness
            except NotConverged:
                self.near = None  # before the next factorisation: one at a time in memory
        modes = modes_with(problem, stiffness, mass, rigid=structure.rigid)
        self.near = ModalReanalysis(modes, stiffness, mass, rigid=problem.rigid_count, most=_most(problem))
        return modes, stiffness

    def _from_near(self, problem: ModalProblem, stiffness: Any, tolerance: float, shapes: bool) -> Modes:
        assert self.near is not None
        count = problem.choice.count
        spare = problem.mode_count - problem.rigid_count - count
        return self.near.under(stiffness, count, tolerance=tolerance, spare=spare, rounds=MAX_ROUNDS, shapes=shapes)

    def _factorise(self, problem: ModalProblem, stiffness: Any) -> None:
        """Factorise a stiffness [N/m] that the factorisation at hand is far from; the basis stays."""
        assert self.near is not None
        matrix = Shifted(stiffness=stiffness, mass=problem.structure.dynamic_matrices[1], shift=self.near.modes.shift)
        solver = problem.structure.solver(problem.choice.solver)
        self.near.adopt_factor(factorise_roughly(matrix, rigid=problem.structure.rigid, solver=solver), stiffness)


def _most(problem: ModalProblem) -> int:
    """How many vectors the basis of a problem keeps from one state to the next."""
    return max(BASIS_STATES * problem.mode_count, ROOM // problem.structure.mesh.unknowns)


def modes_with(
    problem: ModalProblem,
    stiffness: Any,
    mass: Any,
    count: int | None = None,
    *,
    rigid: Array | None = None,
) -> Modes:
    """Real modes of any stiffness [N/m] and mass [kg], by the solver and the shift of a problem.

    count: those of the problem where None, its spare ones to no tolerance. rigid: the motions (n, r) that the stiffness
    leaves free, with which a factorisation in single precision will do; None where they are not known.
    """
    spare = SPARE_MODES if count is None else 0
    count = count or problem.mode_count
    check_modes(count, stiffness.shape[0])
    frequency, solver = problem.shift_frequency, problem.structure.solver(problem.choice.solver)
    if rigid is None:
        return lowest_modes(stiffness, mass, count, shift_frequency=frequency, solver=problem.choice.solver)
    return refined_modes(stiffness, mass, count, rigid=rigid, shift_frequency=frequency, solver=solver, spare=spare)


@final
class Reanalysis:
    """An `Engine` with one factorisation and one basis for many states.

    Each preload is found from those before; modes grow from one basis, and start from the
    factorisation of the preload. `Direct` has the same answer.
    """

    def __init__(self, modal: ModalProblem, preloads: Sequence[PreloadCase]) -> None:
        self.modal, self._preloads, self._shared = modal, preloads, SharedModes()
        self._problem = modal.structure.assembly(solver=modal.choice.solver)
        self._looked = False  # for modes that only the ends of a range bring among the lowest

    def like(self, structure: BoltedStructure, preloads: Sequence[PreloadCase]) -> "Reanalysis":
        """An engine of a structure with other gaps on the same joints; it goes on with what this one has factorised."""
        made = Reanalysis(replace(self.modal, structure=structure), preloads)
        made._shared = self._shared
        if (factor := self._problem.factor) is not None:
            made._problem.adopt_factor(factor, self._problem.shift_frequency)
        return made

    def preload(self, number: int) -> PreloadState:
        """See `Engine`."""
        return checked_preload(self.modal.structure, self._problem, self._preloads[number])

    def vibrate(self, springs: Sequence[Springs[Interface]]) -> Vibration:
        """See `Engine`; preload and modes lend each other their factorisations."""
        shared, preload, modal = self._shared, self._problem, self.modal
        structure, choice = modal.structure, modal.choice
        shared.begin(modal, preload)
        modes, stiffness = shared.of(modal, springs)
        loss = structure.joint_loss(springs, viscous=choice.damping == "viscous")
        check_motions(structure, modes)
        preload.adopt_factor(modes.factorisation, modal.shift_frequency)
        assert shared.near is not None
        damped = damped_near(
            shared.near, modes, stiffness, loss, count=choice.count, kind=choice.damping, tolerance=EXACT
        )
        return Vibration(modes=modes, damped=damped, stiffness=stiffness, loss=loss)

    def frequencies(self, springs: Sequence[Springs[Interface]], before: Modes, *, one_way: bool) -> Array:
        """See `Engine`."""
        if not self._looked and self._shared.near is not None:
            self._shared.near.look_everywhere()
            self._looked = True

        def found(shapes: bool) -> Modes:
            return self._shared.of(self.modal, springs, tolerance=RANGE_ERROR, shapes=shapes)[0]

        return in_order_of(before, self.modal, found, one_way)
