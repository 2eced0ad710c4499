"""Each state by itself: Newton with a factorisation for each step, Lanczos with one for each set of modes."""

from collections.abc import Sequence
from typing import Any, final

import numpy as np

from faying.fe.interface import Interface, Motion
from faying.joint.equilibrium import (
    Equilibrium,
    PreloadState,
    Step,
    StickSlip,
    admissible,
    check_balance,
    tangent_springs,
    uniform_contact,
)
from faying.joint.joint_law import JointLaw
from faying.joint.modal import EXACT, ModalProblem, Vibration, in_order_of
from faying.joint.preload_case import PreloadCase
from faying.joint.springs import Springs
from faying.joint.support_check import check_motions, checked_preload
from faying.numerics.constraint import constrain
from faying.numerics.damped import damped_modes
from faying.numerics.modes import Modes, lowest_modes
from faying.numerics.solve import factorise
from faying.typing import Array, Index


class PlainPreload(Equilibrium):
    """The preload problem of `PreloadProblem` without any of its savings, to check it by.

    Each step solves (K + B' k B) du = f, with K of the parts, B the relative motion of the faces and k the tangents of
    the joints. Where nothing holds the structure, as many unknowns as it has rigid motions are held; the forces are in
    balance, so that this adds a rigid motion and nothing else.

    Args:
        stiffness: of the parts [N/m], sparse (n, n).
        rigid: rigid motions (n, r) that nothing resists.
        joints: the interface and the law of each joint.
        friction: coefficient of friction of each joint; None where it sticks.
        fixed: unknowns that supports hold.
        solver: name of the factorisation; the fastest at hand where None.
    """

    def __init__(
        self,
        stiffness: Any,
        rigid: Array,
        joints: Sequence[tuple[Motion, JointLaw]],
        *,
        friction: Sequence[float | None],
        fixed: Index,
        solver: str | None = None,
    ) -> None:
        super().__init__(stiffness, joints, friction=friction)
        self.solver, self._fixed = solver, fixed
        self._rigid = np.linalg.qr(rigid)[0] if rigid.size else rigid
        self._clear_fixed = np.union1d(fixed, _holding(rigid))

    def _check_load(self, load: Array) -> None:
        check_balance(load, self._rigid)

    def _start(self, load: Array) -> Array:
        """Under springs that are tangent to p(approach) where each joint has the mean pressure of the load."""
        _, springs, push = tangent_springs(self.joints, uniform_contact(self.joints, load), load)
        return self._solved(sum(springs, self.stiffness), push)

    def _direction(self, u: Array, force: Array, slip_states: Sequence[StickSlip], accuracy: float) -> Step:
        from scipy.sparse import block_diag

        stiffness = self.stiffness
        for interface, k_n, k_t in self._tangents(u, slip_states):
            local = np.zeros((len(k_n), 3, 3))
            local[:, 0, 0], local[:, 1:, 1:] = k_n, k_t
            stiffness = stiffness + interface.relative.T @ block_diag(local, format="csr") @ interface.relative
        return self._solved(stiffness, force), 1

    def _admissible(self, force: Array) -> Array:
        return admissible(force, self._rigid, self._fixed)

    def _solved(self, stiffness: Any, force: Array) -> Array:
        right = self._admissible(force).copy()
        right[self._clear_fixed] = 0.0
        return factorise(constrain(stiffness, self._clear_fixed).tocsr(), self.solver).solve(right)


def _holding(rigid: Array) -> Index:
    """Unknowns (r,) that hold a structure against its rigid motions (n, r)."""
    from scipy.linalg import qr

    if not rigid.size:
        return np.zeros(0, dtype=np.int64)
    _, _, order = qr(rigid.T, mode="economic", pivoting=True)
    return np.asarray(order[: rigid.shape[1]], dtype=np.int64)


@final
class Direct:
    """An `Engine` that keeps nothing from one state to the next, to check the other by."""

    def __init__(self, problem: ModalProblem, preloads: Sequence[PreloadCase]) -> None:
        structure = problem.structure
        self.problem, self.preloads = problem, preloads
        self._equilibrium = PlainPreload(
            structure.supported_stiffness,
            structure.rigid,
            [(joint.interface, joint.law) for joint in structure.joints],
            friction=[joint.friction for joint in structure.joints],
            fixed=structure.fixed,
            solver=problem.choice.solver,
        )

    def preload(self, number: int) -> PreloadState:
        """See `Engine`."""
        return checked_preload(self.problem.structure, self._equilibrium, self.preloads[number])

    def vibrate(self, springs: Sequence[Springs[Interface]]) -> Vibration:
        """See `Engine`."""
        problem, structure, choice = self.problem, self.problem.structure, self.problem.choice
        modes, stiffness = self._modes(springs)
        check_motions(structure, modes)
        loss = structure.joint_loss(springs, viscous=choice.damping == "viscous")
        damped = damped_modes(
            modes,
            stiffness,
            structure.dynamic_matrices[1],
            loss,
            rigid=problem.rigid_count,
            count=choice.count,
            kind=choice.damping,
            tolerance=EXACT,
        )
        return Vibration(modes=modes, damped=damped, stiffness=stiffness, loss=loss)

    def frequencies(self, springs: Sequence[Springs[Interface]], before: Modes, *, one_way: bool) -> Array:
        """See `Engine`."""
        modes, _ = self._modes(springs)
        return in_order_of(before, self.problem, lambda shapes: modes, one_way)

    def _modes(self, springs: Sequence[Springs[Interface]]) -> tuple[Modes, Any]:
        problem, structure = self.problem, self.problem.structure
        stiffness, _ = structure.coupled(springs)
        return lowest_modes(
            stiffness,
            structure.dynamic_matrices[1],
            problem.mode_count,
            shift_frequency=problem.shift_frequency,
            solver=problem.choice.solver,
            rigid=structure.rigid,
        ), stiffness
