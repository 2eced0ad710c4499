"""From bolt forces to the pressure on the joints, with the full matrices of the parts.

Each Newton step is solved by conjugate gradients preconditioned with one factorisation at a reference state of the
joints, since only the joint changes; the factorisation is renewed when it has aged.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from faying.errors import InputError, NotConverged
from faying.fe.interface import Motion
from faying.fe.vertices import VertexRestriction
from faying.joint.equilibrium import (
    Contact,
    Equilibrium,
    Step,
    StickSlip,
    admissible,
    check_balance,
    tangent_springs,
    uniform_contact,
)
from faying.joint.joint_law import JointLaw
from faying.numerics.constraint import constrain
from faying.numerics.shifted import Shifted
from faying.numerics.single import factorise_roughly
from faying.numerics.solve import Factorisation, Factoriser
from faying.typing import Array, Index

AGED = 40  # conjugate-gradient steps after which a new factorisation is cheaper: one step costs a fiftieth of it

# a tangent factorisation takes one or two steps a decade, and Newton has some fifteen decades in all before it once the
# faces lie about where they end up: between these decades of imbalance, above this rate, a new one pays
EARLY, LATE, SLOW = -0.5, -3.5, 4.8

GUESSED = 1e-3  # imbalance of the equilibrium of the corners, which are wrong by far more
ROUGH = 1e-2  # accuracy of the start of Newton's iteration where it is found by conjugate gradients
FLAT = 1e-9  # curvature over that of the factor below which a direction costs no energy


class PreloadProblem(Equilibrium):
    """Parts with joints between them, ready for one load after another (each starts from the last).

    fixed: unknowns that supports fix; rigid (unknowns, r): rigid motions that nothing resists, r = 0 where supports do;
    vertices: those of the mesh, for whoever has one to set: their own equilibrium says which springs to factorise with;
    without them, springs at one pressure for each joint. sprung: springs per area (k_n, k_t) [Pa/m] of each joint in
    the factorisation at hand, where they are near to those under the load; None where they are not.
    """

    def __init__(
        self,
        stiffness: Any,
        mass: Any,
        rigid: Array,
        joints: Sequence[tuple[Motion, JointLaw]],
        *,
        shift_frequency: float,
        solver: str | Factoriser | None = None,
        friction: Sequence[float | None] | None = None,
        fixed: Index | None = None,
    ) -> None:
        super().__init__(stiffness, joints, friction=friction)
        self.solver = solver
        self.fixed = np.zeros(0, dtype=np.int64) if fixed is None else fixed
        self.shift_frequency = shift_frequency
        self.mass = mass
        self._mass, self._shift = constrain(mass, self.fixed, 0.0), (2 * np.pi * shift_frequency) ** 2
        self._rigid = np.linalg.qr(rigid)[0] if rigid.size else rigid
        self.vertices: VertexRestriction | None = None
        self.factor: Factorisation | None = None
        self.factorised_springs: list[tuple[Array, Array]] | None = None
        self._rate = 0.0  # conjugate-gradient steps for each decade of the residual, with this factorisation
        self._scale = 1.0

    def adopt_factor(self, factor: Factorisation, shift_frequency: float) -> None:
        """Go on with the factorisation of a like state in place of its own: that of the modes under the last load.

        Springs that are nearer to those of the next load save half of the conjugate-gradient steps, and one
        factorisation less is held. One that was shifted further, by this frequency [Hz], is left.
        """
        if shift_frequency <= self.shift_frequency:
            self.factor, self.factorised_springs, self._rate = factor, None, 0.0

    def _check_load(self, load: Array) -> None:
        self._scale = float(np.linalg.norm(load))
        check_balance(load, self._rigid)

    def _start(self, load: Array) -> Array:
        """Displacement under springs that are tangent to p(approach) where the joints are likely to end up."""
        of_corners = self._contact_of_corners(load)
        per_area, springs, push = tangent_springs(self.joints, of_corners or uniform_contact(self.joints, load), load)
        push = self._admissible(push)
        if self.factor is not None:  # of a like state, taken from elsewhere
            parts = Shifted(stiffness=self.stiffness, mass=self._mass, shift=self._shift)

            def product(x: Array) -> Array:  # the sum of the matrices takes as long as several
                return self._clear_fixed(sum((one @ x for one in springs), parts @ x))

            found, count = self._gradients(product, push, ROUGH)
            if count < AGED:
                return found
        self._factorise(springs, per_area if of_corners else None)
        return self._near(push)

    def _contact_of_corners(self, load: Array) -> Contact | None:
        """Where the joints end up under a load as the corners of the elements say; None where these do not tell.

        Only the corners move by themselves, a seventh of the unknowns or less. The parts are then too stiff in bending,
        and pressures right to some tenths.
        """
        if self.vertices is None:
            return None
        unknowns, spread = self.vertices.unknowns, self.vertices.spread
        coarse = PreloadProblem(
            self.vertices.of_matrix(self.stiffness),
            self.vertices.of_matrix(self.mass),
            self._rigid[unknowns],
            [(joint.carried(spread), law) for joint, law in self.joints],
            shift_frequency=self.shift_frequency,
            solver=self.solver if isinstance(self.solver, str) else None,
            friction=self.friction,
            fixed=np.flatnonzero(np.isin(unknowns, self.fixed)),
        )
        try:
            found = coarse.solve(coarse._admissible(spread.T @ load), tolerance=GUESSED)
        except (NotConverged, InputError):
            return None
        return list(zip(found.openings, found.pressures, strict=True))

    def _factorise(self, springs: list[Any], factorised_springs: list[tuple[Array, Array]] | None) -> None:
        self.factor = None  # one at a time in memory
        stiffness = sum(springs, self.stiffness)
        near = Shifted(stiffness=constrain(stiffness, self.fixed), mass=self._mass, shift=self._shift)
        self.factor = factorise_roughly(near, rigid=self._rigid, solver=self.solver)
        self.factorisations += 1
        self.factorised_springs, self._rate = factorised_springs, 0.0

    def _clear_fixed(self, force: Array) -> Array:
        """A force with nothing on the unknowns that supports fix."""
        if len(self.fixed):
            force[self.fixed] = 0.0
        return np.asarray(force)

    def _admissible(self, force: Array) -> Array:
        return admissible(force, self._rigid, self.fixed)

    def _near(self, forces: Array) -> Array:
        assert self.factor is not None
        return self.factor.solve(forces)

    def _direction(self, u: Array, force: Array, slip_states: Sequence[StickSlip], accuracy: float) -> Step:
        tangents = self._tangents(u, slip_states)

        def product(x: Array) -> Array:
            y = self.stiffness @ x
            for interface, k_n, k_t in tangents:
                move = self._move(interface, x)
                local = np.concatenate([k_n[:, None] * move[:, :1], np.einsum("qij,qj->qi", k_t, move[:, 1:])], axis=1)
                y = y + interface.relative.T @ local.ravel()
            return self._clear_fixed(y)

        if self.factor is None or self._refactorisation_pays(force):
            self._renew(tangents)
        x, count = self._gradients(product, force, accuracy)
        self._rate = count / -np.log10(accuracy)
        if count >= AGED:
            self._renew(tangents)
            x, more = self._gradients(product, force, accuracy, limit=400)
            count += more
        return x, count

    def _refactorisation_pays(self, force: Array) -> bool:
        """Whether a new factorisation costs less than the conjugate-gradient steps that the old one still asks for."""
        left = np.log10(float(np.linalg.norm(force)) / self._scale)  # decades of imbalance, below 0
        return bool(LATE < left < EARLY and self._rate > SLOW)

    def _renew(self, tangents: list[tuple[Any, Array, Array]]) -> None:
        laid = [
            (k_n / joint.weights, np.trace(k_t, axis1=1, axis2=2) / 2 / joint.weights) for joint, k_n, k_t in tangents
        ]
        self._factorise([joint.springs(*k) for (joint, _), k in zip(self.joints, laid, strict=True)], laid)

    def _gradients(self, product: Callable[[Array], Array], right: Array, accuracy: float, limit: int = AGED) -> Step:
        """Conjugate gradients: the solution and how many steps it took, `limit` where that was not enough."""
        x = np.zeros_like(right)
        r = right.copy()
        z = self._near(r)
        d, rho = z, float(r @ z)
        target = accuracy * float(np.linalg.norm(right))
        for count in range(1, limit + 1):
            q = product(d)
            bend = float(d @ q)
            if bend <= FLAT * rho:  # a part has lost contact on the way: go by the factor's springs, which draw it back
                return (x if count > 1 else z), count
            alpha = rho / bend
            x += alpha * d
            r -= alpha * q
            if np.linalg.norm(r) <= target:
                return x, count
            z = self._near(r)
            rho, old = float(r @ z), rho
            d = z + rho / old * d
        return x, limit
