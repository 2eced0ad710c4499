"""From bolt forces to the pressure on the joints: equilibrium of elastic parts on a rough interface.

The rough surface is a normal compliance p(closing), so nothing is penalised: its tangent is the contact stiffness.
Tangentially the joint sticks with the stiffness k_t of its pressure. With k_t held, equilibrium is the minimum of a
convex energy, found by Newton with a line search; k_t then follows the pressure until neither changes. Each linear
system is solved by conjugate gradients preconditioned with one factorisation at a reference state of the joints, since
only the joint changes; it is renewed when it has aged.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from faying.errors import InputError, NotConverged
from faying.fe.interface import Interface
from faying.fe.solve import Factorisation, factorise
from faying.joint.seat import Seat

Array = NDArray[np.float64]
AGED = 15  # conjugate-gradient steps after which a new factorisation is cheaper
BEYOND = 0.1  # share of the contact that may lie beyond the end of the law, at the rim of a hole say; it is flagged
SETTLED = 1e-4  # imbalance below which k_t is held


@dataclass(frozen=True, kw_only=True)
class Preload:
    """Equilibrium under the bolts.

    pressures [Pa] and openings [m], one array per joint; displacement (unknowns,) [m]; imbalance, the residual force over
    the load [-]; Newton steps, conjugate-gradient steps, factorisations taken.
    """

    pressures: tuple[Array, ...]
    openings: tuple[Array, ...]
    displacement: Array
    imbalance: float
    newton_steps: int
    inner_steps: int
    factorisations: int


class Assembly:
    """Parts with joints between them, ready for one load after another (each starts from the last)."""

    def __init__(
        self,
        stiffness: Any,
        mass: Any,
        rigid: Array,
        joints: Sequence[tuple[Interface, Seat]],
        *,
        shift_frequency: float,
        solver: str | None = None,
    ) -> None:
        self.stiffness, self.joints, self.solver = stiffness, list(joints), solver
        self._shifted = stiffness + (2 * np.pi * shift_frequency) ** 2 * mass
        self._rigid = np.linalg.qr(rigid)[0]
        self._factor: Factorisation | None = None
        self._last: Array | None = None
        self.factorisations = 0

    def solve(self, load: Array, *, tolerance: float = 1e-10, steps: int = 60,
              report: Callable[[str], None] | None = None) -> Preload:  # fmt: skip
        """Find equilibrium under nodal forces `load` [N] (unknowns,) that balance among themselves.

        tolerance: of the residual force relative to the load. Raises InputError when the pressure leaves the law and
        NotConverged when Newton stops short.
        """
        scale = float(np.linalg.norm(load))
        net = float(np.linalg.norm(self._rigid.T @ load))
        if net > 1e-9 * scale:
            raise InputError(f"the bolt forces do not balance ({net / scale:.1e} of the load is left over); each bolt must "
                             "pull between two faces of different parts that face each other")  # fmt: skip
        u = self._start(load) if self._last is None else self._last
        newton = inner = 0
        shear = [self._shear_stiffness(joint, seat, u) for joint, seat in self.joints]
        size = np.inf
        while True:
            force = self._out_of_balance(u, load, shear)
            size = float(np.linalg.norm(force)) / scale
            if size < tolerance:
                fresh = [self._shear_stiffness(joint, seat, u) for joint, seat in self.joints]
                change = max(_relative_change(new, old) for new, old in zip(fresh, shear, strict=True))
                shear = fresh
                size = float(np.linalg.norm(self._out_of_balance(u, load, shear))) / scale
                if size < tolerance or change < 1e-12:
                    break
                continue
            if newton >= steps:
                raise NotConverged(f"preload: after {newton} Newton steps {size:.1e} of the load is out of balance "
                                   f"(tolerance {tolerance:.0e}); refine the mesh of the joint, or load it in steps")  # fmt: skip
            step, count = self._direction(u, force, shear, accuracy=min(1e-2, 0.1 * size))
            length = self._line_search(u, step, load, shear)
            u = u + length * step
            if size > SETTLED:  # far off, k_t follows at once; near the end it is held so that Newton converges
                shear = [self._shear_stiffness(joint, seat, u) for joint, seat in self.joints]
            newton, inner = newton + 1, inner + count
            if report:
                report(f"Newton {newton}: imbalance {size:.1e}, {count} inner steps, step {length:.3g}")
        self._last = u
        openings = tuple(joint.opening(u) for joint, _ in self.joints)
        pressures = tuple(seat.pressure(-gap)[0] for gap, (_, seat) in zip(openings, self.joints, strict=True))
        for p, (joint, seat) in zip(pressures, self.joints, strict=True):
            end = seat.law.greatest_pressure
            touching = float(joint.weights[p > 0].sum())
            beyond = float(joint.weights[p > end].sum()) / touching if touching > 0 else 0.0
            if beyond > BEYOND:
                raise InputError(
                    f"the preload presses the joint to {p.max() / 1e6:.4g} MPa, and {beyond:.0%} of what is in contact to more "
                    f"than {seat.law.name} covers with this surface ({end / 1e6:.4g} MPa); lower the preload, widen the "
                    "joint, or choose a law that reaches further"
                )
        return Preload(pressures=pressures, openings=openings, displacement=u, imbalance=size, newton_steps=newton,
                       inner_steps=inner, factorisations=self.factorisations)  # fmt: skip

    def _start(self, load: Array) -> Array:
        """Begin with every joint at the mean pressure that the load would give it."""
        total = float(np.abs(load).sum()) / 4
        springs = self._shifted
        push = load.copy()
        for joint, seat in self.joints:
            mean = np.clip(total / joint.area, 10 * seat.least_pressure, 0.5 * seat.law.greatest_pressure)
            k_n, k_t = (np.full(len(joint.weights), float(k)) for k in seat.stiffness(np.asarray(mean)))
            springs = springs + joint.springs(k_n, k_t)
            # a spring that is tangent to p(closing) at the mean pressure, in place of the curve
            offset = mean - k_n * (seat.closing(float(mean)) + joint.gap)
            push = push + joint.forces(np.asarray(offset), np.zeros((len(joint.weights), 2)))
        self._factor = factorise(springs.tocsr(), self.solver)
        self.factorisations += 1
        return self._factor.solve(push)

    def _shear_stiffness(self, joint: Interface, seat: Seat, u: Array) -> Array:
        return seat.stiffness(seat.pressure(-joint.opening(u))[0])[1]

    def _out_of_balance(self, u: Array, load: Array, shear: list[Array]) -> Array:
        force = load - self.stiffness @ u
        for (joint, seat), k_t in zip(self.joints, shear, strict=True):
            p, _ = seat.pressure(-joint.opening(u))
            force += joint.forces(p, k_t[:, None] * joint.slip(u))
        return np.asarray(force - self._rigid @ (self._rigid.T @ force))

    def _direction(self, u: Array, force: Array, shear: list[Array], accuracy: float) -> tuple[Array, int]:
        tangents = []
        for (joint, seat), k_t in zip(self.joints, shear, strict=True):
            _, k_n = seat.pressure(-joint.opening(u))
            tangents.append((joint, k_n, k_t))

        def product(x: Array) -> Array:
            y = self.stiffness @ x
            for joint, k_n, k_t in tangents:
                local = (joint.relative @ x).reshape(-1, 3)
                local = local * np.stack([k_n, k_t, k_t], axis=1) * joint.weights[:, None]
                y = y + joint.relative.T @ local.ravel()
            return np.asarray(y)

        if self._factor is None:
            self._renew(tangents)
        x, count = self._conjugate_gradients(product, force, accuracy)
        if count >= AGED:
            self._renew(tangents)
            x, more = self._conjugate_gradients(product, force, accuracy, limit=400)
            count += more
        return x, count

    def _renew(self, tangents: list[tuple[Interface, Array, Array]]) -> None:
        springs = self._shifted
        for joint, k_n, k_t in tangents:
            springs = springs + joint.springs(k_n, k_t)
        self._factor = None
        self._factor = factorise(springs.tocsr(), self.solver)
        self.factorisations += 1

    def _conjugate_gradients(
        self, product: Callable[[Array], Array], right: Array, accuracy: float, limit: int = AGED
    ) -> tuple[Array, int]:
        assert self._factor is not None
        x = np.zeros_like(right)
        r = right.copy()
        z = self._factor.solve(r)
        d, rho = z, float(r @ z)
        target = accuracy * float(np.linalg.norm(right))
        for count in range(1, limit + 1):
            q = product(d)
            alpha = rho / float(d @ q)
            x += alpha * d
            r -= alpha * q
            if np.linalg.norm(r) <= target:
                return x, count
            z = self._factor.solve(r)
            rho, old = float(r @ z), rho
            d = z + rho / old * d
        return x, limit

    def _line_search(self, u: Array, step: Array, load: Array, shear: list[Array]) -> float:
        """Step length at which the slope of the energy has fallen to a fraction; the energy is convex along the line."""
        stretch = self.stiffness @ step
        linear = float(step @ (load - self.stiffness @ u))
        quadratic = float(step @ stretch)
        local = [(joint.relative @ step).reshape(-1, 3) for joint, _ in self.joints]
        gaps = [joint.opening(u) for joint, _ in self.joints]
        slips = [joint.slip(u) for joint, _ in self.joints]

        def slope(length: float) -> float:
            total = length * quadratic - linear
            for (joint, seat), move, gap, slip, k_t in zip(self.joints, local, gaps, slips, shear, strict=True):
                p, _ = seat.pressure(-(gap + length * move[:, 0]))
                work = -p * move[:, 0] + k_t * np.einsum("qi,qi->q", slip + length * move[:, 1:], move[:, 1:])
                total += float(joint.weights @ work)
            return total

        start = slope(0.0)
        if start >= 0:
            raise NotConverged("preload: the search direction does not lower the energy; the joint may be wholly open")
        end = slope(1.0)
        if abs(end) <= 0.5 * abs(start):
            return 1.0
        low, high = (0.0, 1.0) if end > 0 else (1.0, 2.0)
        while end < 0 and high < 64:
            end = slope(high)
            low, high = (high, 2 * high) if end < 0 else (low, high)
        for _ in range(40):
            middle = (low + high) / 2
            value = slope(middle)
            if abs(value) <= 0.3 * abs(start):
                return middle
            low, high = (middle, high) if value < 0 else (low, middle)
        return (low + high) / 2


def _relative_change(new: Array, old: Array) -> float:
    size = float(np.linalg.norm(new))
    return float(np.linalg.norm(new - old)) / size if size > 0 else 0.0
