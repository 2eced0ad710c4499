"""Equilibrium of elastic parts on a rough interface, by Newton with a line search.

The rough surface is a normal compliance p(approach), so nothing is penalised: its tangent is the contact stiffness.
Tangentially the joint sticks with the stiffness k_t of its pressure and, where a friction coefficient is given, slips
at friction times pressure. With k_t and that limit given, equilibrium is the minimum of a convex energy; both then
follow the pressure until nothing changes. How a Newton step is solved is left to those who build on this: with sparse
matrices (`preload`) or in a small basis (`reduce`).
"""

from abc import ABC, abstractmethod
from collections.abc import Hashable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from faying.errors import InputError, NotConverged
from faying.joint.joint_law import JointLaw
from faying.joint.springs import InterfaceMotion
from faying.numerics.product import product_of_sizes
from faying.typing import Array, Index, Mask

Step = tuple[Array, int]  # of Newton's iteration, and how many inner steps it took
Contact = Sequence[tuple[Array, Array]]  # opening [m] and pressure [Pa] at the points (q,) of each joint

DRAWN_BACK_FROM = 10.0  # imbalance over the load from which a start is drawn back
ROUNDED = 1e-7  # imbalance from which it is asked whether rounding lets it fall further
FORCING_TERM = 0.03  # of the imbalance, which a Newton step far from equilibrium leaves
FIX_FRICTION_BELOW = 1e-4  # imbalance below which k_t and the limit of friction are kept
MAX_NEWTON_STEPS = 60
MIN_NEW_CHANGE = 1e-6  # share of the greatest change of k_t below which one tells nothing new
REMEMBERED_CHANGES = 3  # changes of k_t before, from which the next one is foreseen


@dataclass(frozen=True, kw_only=True)
class PreloadState:
    """Equilibrium under the bolts.

    pressures [Pa], openings [m] and share of the slipping area [-], one per joint; displacement (unknowns,) [m];
    imbalance, the residual force over the load [-]; Newton steps, conjugate-gradient steps, factorisations taken;
    bolt_forces [N], those left when all bolts are tight; carried, the greatest pressures [Pa] at the points of each
    joint under the preloads before, () on first loading.
    """

    displacement: Array
    pressures: tuple[Array, ...] = ()
    openings: tuple[Array, ...] = ()
    slipping: tuple[float, ...] = ()
    imbalance: float = 0.0
    newton_steps: int = 0
    inner_steps: int = 0
    factorisations: int = 0
    bolt_forces: tuple[float, ...] = ()
    carried: tuple[Array, ...] = ()


@dataclass
class StickSlip:
    """Tangential state of one joint while k_t (q,) [Pa/m] and the greatest shear (q,) [Pa] are kept.

    anchor (q, 2) [m]: the slip at which the shear traction is zero.
    """

    k_t: Array
    limit: Array | None
    anchor: Array

    def shear(self, slip: Array) -> Array:
        """Shear tractions [Pa] (q, 2)."""
        stuck = self.k_t[:, None] * (slip - self.anchor)
        if self.limit is None:
            return stuck
        size = np.linalg.norm(stuck, axis=1)
        return np.asarray(stuck * np.minimum(1.0, self.limit / np.where(size > 0, size, 1.0))[:, None])

    def sliding(self, slip: Array) -> Mask:
        """Points (q,) where the traction has reached its limit."""
        if self.limit is None:
            return np.zeros(len(self.k_t), dtype=bool)
        return np.asarray(np.linalg.norm(self.k_t[:, None] * (slip - self.anchor), axis=1) > self.limit)

    def tangent(self, slip: Array) -> Array:
        """Tangent (q, 2, 2) [Pa/m] of the shear traction: k_t where it sticks.

        Across the motion only where it slides.
        """
        full = self.k_t[:, None, None] * np.eye(2)
        slides = self.sliding(slip)
        if np.any(slides):
            assert self.limit is not None
            move = (slip - self.anchor)[slides]
            size = np.linalg.norm(move, axis=1)
            along = move / size[:, None]
            across = np.eye(2) - along[:, :, None] * along[:, None, :]
            full[slides] = (self.limit[slides] / size)[:, None, None] * across
        return full


class Equilibrium(ABC):
    """Newton on equilibrium, for one load after another: each starts from those before."""

    def __init__(
        self, stiffness: Any, joints: Sequence[tuple[Any, JointLaw]], *, friction: Sequence[float | None] | None = None
    ) -> None:
        self.parts = self.stiffness = stiffness
        self.joints = list(joints)
        self.friction = list(friction) if friction is not None else [None] * len(self.joints)
        self.forget_slip()
        self._last: Array | None = None  # displacement under the load before, from which the next sets out
        self._known: tuple[Array, list[tuple[Array, Array, Array]]] | None = None  # joints where last asked
        self.nearest: Array | None = None  # displacement nearest to balance in the last `solve`
        self.factorisations = 0
        self.first_loadings: dict[Hashable, tuple[PreloadState, tuple[Array, ...]]] = {}

    def forget_slip(self) -> None:
        """Go on without the shear that earlier loads left, so that no load depends on what was solved before it."""
        self.anchors = [np.zeros((len(interface.weights), 2)) for interface, _ in self.joints]

    def with_laws(self, laws: Sequence[JointLaw]) -> None:
        """Go on with other laws of the joints."""
        self.joints = [(interface, law) for (interface, _), law in zip(self.joints, laws, strict=True)]
        self._known = None

    @abstractmethod
    def _start(self, load: Array) -> Array:
        """Return a displacement to start from."""

    @abstractmethod
    def _direction(self, u: Array, force: Array, slip_states: Sequence[StickSlip], accuracy: float) -> Step:
        """Return the Newton step at a displacement for an out-of-balance force, to an accuracy relative to that [-]."""

    def _check_load(self, load: Array) -> None:
        """Raise InputError where no equilibrium exists under this load; by default any load will do."""
        return

    def _admissible(self, force: Array) -> Array:
        """Remove from a force what nothing can answer: rounding along rigid motions, forces on fixed unknowns."""
        return force

    def solve(
        self,
        load: Array,
        *,
        start: Array | None = None,
        shanks: Any | None = None,
        tolerance: float = 1e-10,
        steps: int = MAX_NEWTON_STEPS,
    ) -> PreloadState:
        """Find equilibrium under nodal forces `load` [N] (unknowns,).

        start: displacement to start from [m], found from the loads before where None; shanks: stiffness [N/m] of bolts
        that are tight; tolerance: of the residual force relative to the load, or what rounding leaves of it where that
        is more.
        Beyond the end of a law its curve goes on, so that whoever keeps the pressures looks whether it covers them.
        Raises InputError when the load cannot balance, and NotConverged when Newton stops short.
        """
        if not np.any(load):
            if not self.joints:  # nothing pulls the parts, and nothing is there to be pressed
                return PreloadState(displacement=np.zeros(load.shape))
            raise InputError("no bolt pulls: the load is zero everywhere; give at least one bolt a preload")
        self._check_load(load)
        self.stiffness = self.parts if shanks is None else self.parts + shanks
        if start is None:
            start = self._start(load) if self._last is None else self._last
        start = self._drawn_back(start, load)
        found = self._newton(start, load, tolerance, steps)
        self._last = found.displacement
        return found

    def _newton(self, u: Array, load: Array, tolerance: float, most: int) -> PreloadState:
        """Newton's iteration from a start; shear that slipped is carried to the next load.

        Raises NotConverged after `most` steps.
        """
        scale, taken, inner = float(np.linalg.norm(load)), 0, 0
        least, rounding, past = np.inf, None, list[tuple[Array, Array]]()
        slip_states: Sequence[StickSlip] = self._stick_slip(u)
        while True:
            force = self._out_of_balance(u, load, slip_states)
            size = float(np.linalg.norm(force)) / scale
            if size < least:
                least, self.nearest = size, u
            if rounding is None and size < max(tolerance, ROUNDED):
                rounding = self._rounding(u) / scale  # u hardly moves from here on
                tolerance = max(tolerance, rounding)
            if size < tolerance:
                fresh = self._stick_slip(u)
                change = max(_slip_change(new, old) for new, old in zip(fresh, slip_states, strict=True))
                size = float(np.linalg.norm(self._out_of_balance(u, load, fresh))) / scale
                if size < tolerance or change < 1e-12:
                    slip_states = fresh
                    break
                slip_states = _followed(slip_states, fresh, past)
                continue
            if taken >= most:
                raise NotConverged(
                    f"preload: after {taken} Newton steps {size:.1e} of the load is out of balance "
                    f"(tolerance {tolerance:.0e}); refine the mesh of the joint, or load it in steps"
                )
            # as exact as Newton's own convergence asks, and no more than the tolerance does
            accuracy = max(min(FORCING_TERM, 0.1 * size), 0.3 * tolerance / size)
            step, count = self._direction(u, force, slip_states, accuracy)
            u = self._line_search(u, step, load, slip_states)
            # far off, k_t follows at once; near the end it is kept so that Newton converges
            if size > FIX_FRICTION_BELOW:
                slip_states = _followed(slip_states, self._stick_slip(u), past)
            taken, inner = taken + 1, inner + count
        slipping = self._move_anchors(u, slip_states)
        openings, pressures = self.contact(u)
        return PreloadState(
            pressures=pressures,
            openings=openings,
            slipping=slipping,
            displacement=u,
            imbalance=size,
            newton_steps=taken,
            inner_steps=inner,
            factorisations=self.factorisations,
        )

    def _drawn_back(self, u: Array, load: Array) -> Array:
        """A start, or where it presses points by far more than the load, what is nearer on the way to it from rest.

        Beyond its end the curve of a law grows like an exponential, down which Newton takes one step for each factor
        of three: waves of the faces left 1e17 times the load, and 60 steps were not enough.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            size = np.linalg.norm(self._out_of_balance(u, load, self._stick_slip(u)))
            if size <= DRAWN_BACK_FROM * np.linalg.norm(load):
                return u
            rest = np.zeros_like(u)
            try:
                return self._line_search(rest, u, load, self._stick_slip(rest))
            except NotConverged:  # the way does not lead down from rest
                return u

    def _move_anchors(self, u: Array, slip_states: Sequence[StickSlip]) -> tuple[float, ...]:
        """Carry the shear that is left to the next load; return the share of the sliding area of each joint."""
        slipping = []
        for index, ((move, p, _), slip_state, (interface, _)) in enumerate(
            zip(self._state(u), slip_states, self.joints, strict=True)
        ):
            slides = slip_state.sliding(move[:, 1:])
            slipping.append(float(interface.weights @ slides / interface.weights.sum()))
            if np.any(slides):  # the shear that is left stays until the next load moves on
                rest = slip_state.shear(move[:, 1:]) / np.where(slip_state.k_t > 0, slip_state.k_t, 1.0)[:, None]
                self.anchors[index] = np.where(slides[:, None], move[:, 1:] - rest, self.anchors[index])
            if slip_state.limit is not None:  # what moves while it is open starts without shear when it closes
                self.anchors[index] = np.where((p > 0)[:, None], self.anchors[index], move[:, 1:])
        return tuple(slipping)

    def contact(self, u: Array) -> tuple[tuple[Array, ...], tuple[Array, ...]]:
        """Openings [m] and pressures [Pa] at the points of every joint under displacements [m] (unknowns,)."""
        openings = tuple(self._move(interface, u)[:, 0] + interface.gap for interface, _ in self.joints)
        return openings, tuple(law.pressure(-gap)[0] for gap, (_, law) in zip(openings, self.joints, strict=True))

    def _rounding(self, u: Array) -> float:
        """What rounding alone may leave of the elastic forces [N].

        Parts far stiffer than their joints lose digits in K u.
        """
        return float(2 * np.finfo(float).eps * np.linalg.norm(product_of_sizes(self.stiffness, u)))

    def _move(self, interface: InterfaceMotion, u: Array) -> Array:
        return np.asarray(interface.relative @ u).reshape(-1, 3)

    def _state(self, u: Array) -> list[tuple[Array, Array, Array]]:
        """Relative motion (q, 3), pressure and k_n (q,) of each joint.

        Asked for several times in a step, found once.
        """
        if self._known is None or self._known[0] is not u:
            moves = [self._move(interface, u) for interface, _ in self.joints]
            state = [
                (move, *law.pressure(-(move[:, 0] + interface.gap)))
                for move, (interface, law) in zip(moves, self.joints, strict=True)
            ]
            self._known = u, state
        return self._known[1]

    def _stick_slip(self, u: Array) -> list[StickSlip]:
        known = zip(self._state(u), self.joints, self.friction, self.anchors, strict=True)
        return [
            StickSlip(
                k_t=law.stiffness(p, tabulated=True)[1],
                limit=None if friction is None else friction * p,
                anchor=anchor,
            )
            for (_, p, _), (_, law), friction, anchor in known
        ]

    def _out_of_balance(self, u: Array, load: Array, slip_states: Sequence[StickSlip]) -> Array:
        force = load - self.stiffness @ u
        for (move, p, _), (interface, _), slip_state in zip(self._state(u), self.joints, slip_states, strict=True):
            local = np.concatenate([-p[:, None], slip_state.shear(move[:, 1:])], axis=1) * interface.weights[:, None]
            force = force - interface.relative.T @ local.ravel()
        return self._admissible(np.asarray(force))

    def _tangents(self, u: Array, slip_states: Sequence[StickSlip]) -> list[tuple[Any, Array, Array]]:
        """For each joint: interface, normal stiffness (q,) and tangential tangent (q, 2, 2), both times the area."""
        return [
            (interface, interface.weights * k_n, interface.weights[:, None, None] * slip_state.tangent(move[:, 1:]))
            for (move, _, k_n), (interface, _), slip_state in zip(self._state(u), self.joints, slip_states, strict=True)
        ]

    def _line_search(self, u: Array, step: Array, load: Array, slip_states: Sequence[StickSlip]) -> Array:
        """The displacement along a step at which the slope of the energy has fallen to a fraction.

        The energy is convex along the line. The state of the joints there is kept where the search ends at it.
        """
        ahead: list[tuple[Array, Array, Array]] = []

        def at(length: float, *, known: bool = True) -> Array:
            found = np.asarray(u + length * step)
            if known:
                self._known = found, ahead
            return found

        stretch = self.stiffness @ step
        linear = float(step @ (load - self.stiffness @ u))
        quadratic = float(step @ stretch)
        local = [self._move(interface, step) for interface, _ in self.joints]
        here = self._state(u)

        def slope(length: float) -> float:
            nonlocal ahead
            total, ahead = length * quadratic - linear, []
            for (interface, law), by, (move, p, k_n), slip_state in zip(
                self.joints, local, here, slip_states, strict=True
            ):
                if length:
                    move = move + length * by
                    p, k_n = law.pressure(-(interface.gap + move[:, 0]))
                ahead.append((move, p, k_n))
                shear = slip_state.shear(move[:, 1:])
                work = -p * by[:, 0] + np.einsum("qi,qi->q", shear, by[:, 1:])
                total += float(interface.weights @ work)
            return total

        start = slope(0.0)
        if start >= 0:
            apart = min(float(interface.gap.min()) for interface, _ in self.joints)
            raise NotConverged(
                "preload: the search direction does not lower the energy; a joint may be fully open (before any load "
                f"the nearest faces are {apart * 1e6:.4g} um apart): put the faces on each other, or pull harder"
            )
        end = slope(1.0)
        if abs(end) <= 0.5 * abs(start):
            return at(1.0)
        low, high = (1.0, 2.0) if end < 0 else (0.0, 1.0)  # 0 to 1 also where the end is too far for a number
        while end < 0 and high < 64:
            end = slope(high)
            low, high = (high, 2 * high) if end < 0 else (low, high)
        for _ in range(40):
            middle = (low + high) / 2
            value = slope(middle)
            if abs(value) <= 0.3 * abs(start):
                return at(middle)
            low, high = (middle, high) if value < 0 else (low, middle)
        return at((low + high) / 2, known=False)


def uniform_contact(joints: Sequence[tuple[Any, JointLaw]], load: Array) -> Contact:
    """Opening and pressure of every joint at the mean pressure that a load [N] (n,) would give it."""
    total, contact = float(np.abs(load).sum()) / 4, []
    for joint, law in joints:
        mean = np.clip(total / joint.area, 10 * law.least_pressure, 0.5 * law.model.greatest_pressure)
        contact.append((np.full(len(joint.weights), -law.approach(float(mean))), np.full(len(joint.weights), mean)))
    return contact


def tangent_springs(
    joints: Sequence[tuple[Any, JointLaw]], contact: Contact, load: Array
) -> tuple[list[tuple[Array, Array]], list[Any], Array]:
    """Springs tangent to p(approach) at some contact: per area (k_n, k_t) [Pa/m], as matrices, and what is to be borne.

    The last is the load [N] (n,) with what springs that are longer than the gap push.
    """
    per_area = [law.stiffness(pressure) for (_, law), (_, pressure) in zip(joints, contact, strict=True)]
    for (joint, _), (opening, pressure), (k_n, _) in zip(joints, contact, per_area, strict=True):
        offset = np.where(pressure > 0, pressure + k_n * (opening - joint.gap), 0.0)
        load = load + joint.forces(offset, np.zeros((len(offset), 2)))
    return per_area, [joint.springs(*k) for (joint, _), k in zip(joints, per_area, strict=True)], load


def admissible(force: Array, rigid: Array, fixed: Index) -> Array:
    """A force [N] (n,) without what moves along rigid motions (n, r) or pulls at unknowns that supports fix.

    rigid: orthonormal columns.
    """
    if rigid.size:
        force = force - rigid @ (rigid.T @ force)
    if len(fixed):
        force = force.copy()
        force[fixed] = 0.0
    return force


def check_balance(load: Array, rigid: Array) -> None:
    """Raise InputError where forces [N] (n,) move a structure along rigid motions (n, r) that nothing resists.

    rigid: orthonormal columns.
    """
    scale, net = float(np.linalg.norm(load)), float(np.linalg.norm(rigid.T @ load)) if rigid.size else 0.0
    if net > 1e-9 * scale:
        raise InputError(
            f"the bolt forces do not balance ({net / scale:.1e} of the load is left over); each bolt must "
            "pull between two faces of different parts that face each other"
        )


def _followed(
    old: Sequence[StickSlip], new: Sequence[StickSlip], past: list[tuple[Array, Array]]
) -> Sequence[StickSlip]:
    """States with the k_t of the new pressure, or with those to which the last few changes lead.

    Each pressure sets k_t and k_t moves the pressure: of two joints side by side one swing was 0.9 times the last.

    Args:
        old, new: states of the joints before and at the new pressure.
        past: k_t [Pa/m] (q,) of all points before, and what the pressures under them make of it; it grows by this.

    Source:
        Anderson 1965, doi:10.1145/321296.321305, as Walker and Ni 2011, doi:10.1137/10078356X, equation 2.1.
    """
    before, after = (np.concatenate([one.k_t for one in states]) for states in (old, new))
    past.append((before, after))
    del past[: -REMEMBERED_CHANGES - 1]
    change, ahead = after - before, after
    if len(past) > 1:
        others = np.stack([change - (g - x) for x, g in past[:-1]], axis=1)
        shares = np.linalg.lstsq(others, change, rcond=MIN_NEW_CHANGE)[0]
        ahead = after - np.stack([after - g for _, g in past[:-1]], axis=1) @ shares
        ahead = np.clip(ahead, after / 2, 2 * after)
    parts = np.split(ahead, np.cumsum([len(one.k_t) for one in new])[:-1])
    return [replace(one, k_t=k_t) for one, k_t in zip(new, parts, strict=True)]


def _slip_change(new: StickSlip, old: StickSlip) -> float:
    change = _relative_change(new.k_t, old.k_t)
    if new.limit is not None and old.limit is not None:
        change = max(change, _relative_change(new.limit, old.limit))
    return change


def _relative_change(new: Array, old: Array) -> float:
    size = max(float(np.linalg.norm(one)) for one in (new, old))  # a joint that opens has nothing left
    return float(np.linalg.norm(new - old)) / size if size > 0 else 0.0
