"""Static equilibrium of a preloaded structure under loads, in a basis that grows until nothing is left over.

From the preload u_0 a load moves the structure by d + y: d is what supports prescribe, y what is found. With the
stiffness K of parts, supports and tight bolts, the relative motion B of the faces and their traction t,

    f - K (d + y) - B' [t(B (u_0 + d + y)) - t(B u_0)] = 0.

K_0 = K + B' k B is the stiffness under the springs at the preload, with which modes are found as well. y is sought in
vectors that are orthonormal in K_0: there the linear answer of a load is its projection, and only the joints depart
from it. What the answer leaves of the forces on the whole structure, solved for with one factorisation near K_0, is the
next vector, for all loads together.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from faying.case.acting import Acting
from faying.errors import NotConverged
from faying.joint.equilibrium import admissible
from faying.loads.contact import ContactState, LoadedContact
from faying.memory import require
from faying.numerics.product import combined
from faying.numerics.span import GrowingColumns, extension
from faying.typing import Array, Index

STRAIGHT = 1e-9  # of the load: what a linear answer may leave over
TOLERANCE = 1e-7  # the same of a state with opening and friction
ON_THE_WAY = 1e-2  # the same at increments before the last, which tell no more than the way
ROUNDED = 1e-6  # error below which an answer stands where rounding lets it fall no further
SMALLEST = 1e-8  # of the preload: a smaller load counts as this, since pressures have 16 digits
STAGNANT_ROUNDS = 5  # rounds in which an error does not halve: it stands
WORKING_ROOM = 4  # times what vectors and their images take, while they are made
ROUNDS = 80  # of new vectors
NEWTON_STEPS = 30
HALVINGS = 6
ROUNDS_AHEAD = 1  # whose vectors are found before joints are balanced again
VECTORS_AHEAD = 40  # times the vectors of the linear answers' first round, for which there is room from the beginning
BORNE = 2.0  # shear over pressure that no friction bears
MIN_TANGENT_CHANGE = 0.01  # relative change of a tangent from which a Newton step counts it


@dataclass(frozen=True, kw_only=True)
class LoadedState:
    """A structure in equilibrium under a load.

    Args:
        coordinates: Of the basis at the time it was found (m,).
        acting: The load.
        contact: State of each joint.
        tractions: Of each joint (q, 3) [Pa]: minus pressure, shear beyond that of the preload.
        motions: Relative motion of each joint (q, 3) [m].
        dissipated: By the sliders of each joint on the way here from the state before [J].
        error: Forces that are left over, over the load or SMALLEST of the preload, in their energy on K_0 [-].
    """

    coordinates: Array
    acting: Acting
    contact: tuple[ContactState, ...]
    tractions: tuple[Array, ...]
    motions: tuple[Array, ...]
    dissipated: Array
    error: float


@dataclass(frozen=True)
class _Local:
    """How tractions (q, 3) [Pa] and tangents (q, 3, 3) [Pa/m] of each joint differ from those of its springs."""

    tractions: list[Array]
    tangents: list[Array]


@dataclass
class _Task:
    """One load on its way."""

    name: str
    target: Acting
    offset: Array  # nodal forces f - K d, admissible
    before: Array  # the same under the load that it starts from
    moved: tuple[Array, ...]  # relative motion (q, 3) by d
    start: tuple[ContactState, ...]
    x: Array
    sides: Array  # of offset and before in the basis (m, 2), as far as it was projected on
    local: "_Local | None" = None  # of its joints at x
    error: float = np.inf


class LoadStatics:
    """Answers of a preloaded structure to one load after another, or to several at once.

    Args:
        stiffness: K_0 [N/m] (unknowns, unknowns), fixed unknowns cleared.
        factor: What solves near it.
        elastic_forces: K times a displacement, fixed unknowns included.
        joints: Relative motion of the faces and the contact of each joint.
        displacement: Under the preload [m] (unknowns,).
        rigid: Motions (unknowns, r) that nothing resists.
        fixed: Unknowns that supports hold.
    """

    def __init__(
        self,
        *,
        stiffness: Any,
        factor: Any,
        elastic_forces: Callable[[Array], Array],
        joints: Sequence[tuple[Any, LoadedContact]],
        displacement: Array,
        rigid: Array,
        fixed: Index,
    ) -> None:
        self.stiffness, self.factor, self.joints = stiffness, factor, list(joints)
        self.displacement, self.fixed = displacement, fixed
        self._elastic_forces = elastic_forces
        self._rigid = np.linalg.qr(rigid)[0] if rigid.size else rigid
        none = np.zeros((stiffness.shape[0], 0))
        self._vectors, self._images = GrowingColumns(none), GrowingColumns(none)
        self._relative = [np.zeros((3 * len(contact.weights), 0)) for _, contact in self.joints]
        self._single = [np.zeros((len(contact.weights), 3, 0), dtype=np.float32) for _, contact in self.joints]
        self._at_rest = [contact.advance(contact.start, contact.rest)[1] for _, contact in self.joints]

    @property
    def size(self) -> int:
        """How many vectors the basis has."""
        return int(self._vectors.values.shape[1])

    def rest_state(self, acting: Acting) -> LoadedState:
        """Return the preload itself; acting: a load that does nothing."""
        contacts = [contact for _, contact in self.joints]
        return LoadedState(
            coordinates=np.zeros(self.size),
            acting=acting,
            contact=tuple(contact.start for contact in contacts),
            tractions=tuple(self._at_rest),
            motions=tuple(contact.rest for contact in contacts),
            dissipated=np.zeros(len(contacts)),
            error=0.0,
        )

    def motion(self, state: LoadedState) -> Array:
        """Displacement [m] (unknowns,) from the preload to a state."""
        x = state.coordinates
        return np.asarray(self._vectors.values[:, : len(x)] @ x + state.acting.moved)

    def linear(self, actings: Sequence[Acting]) -> list[Array]:
        """Displacements [m] (unknowns,) under loads if the joints kept the springs of the preload.

        Raises NotConverged where the factorisation does not lead there.
        """
        # less what d does to the springs of the joints
        loads = np.stack([self._offset(one) - self._spring_forces(one) for one in actings], axis=1)
        for _ in range(ROUNDS):
            x = self._vectors.values.T @ loads
            rest = loads - self._images.values @ x
            z = self._solved(rest)
            left = _energy_roots(rest, z)
            scale = np.linalg.norm(x, axis=0)
            if np.all(left <= STRAIGHT * scale):
                break
            more = left > STRAIGHT * scale
            if not self._extend(z[:, more], left[more]):
                if np.all(left <= ROUNDED * scale):
                    break
                raise NotConverged("loads: the linear answer does not converge; is a part free to move?")
        else:
            raise NotConverged(
                f"loads: the linear answer does not converge in {ROUNDS} rounds; is a part free to move?"
            )
        return [self._vectors.values @ x[:, k] + one.moved for k, one in enumerate(actings)]

    def solve(self, cases: Sequence[tuple[str, LoadedState, Acting, int]]) -> list[list[LoadedState]]:
        """Find the states on the way to loads.

        Args:
            cases: Name, the state that it starts from, the load, and in how many increments.

        Returns:
            For each case: the states at its increments; the last one is under the whole load.

        Raises:
            NotConverged: A joint opens wholly, or the iteration stops short.
        """
        found: list[list[LoadedState]] = [[] for _ in cases]
        most = max((count for *_, count in cases), default=0)
        for step in range(1, most + 1):
            moving = [k for k, (*_, count) in enumerate(cases) if step <= count]
            tasks, tolerances = [], []
            for k in moving:
                name, start, load, count = cases[k]
                before = found[k][-1] if found[k] else start
                share = step / count
                target = load if step == count else start.acting.times(1 - share) + load.times(share)
                tasks.append(self._task(name, before, target))
                tolerances.append(TOLERANCE if step == count else ON_THE_WAY)
            self._settle(tasks, tolerances)
            for k, task in zip(moving, tasks, strict=True):
                found[k].append(self._state(task))
        return found

    def _task(self, name: str, before: LoadedState, target: Acting) -> _Task:
        offset, from_there = self._offset(target), self._offset(before.acting)
        moved, x = tuple(self._relative_motions(target.moved)), self._in_basis(before.coordinates)
        return _Task(name, target, offset, from_there, moved, before.contact, x, np.zeros((0, 2)))

    def _in_basis(self, x: Array) -> Array:
        """Coordinates (m,) in a basis that has grown since."""
        return np.append(x, np.zeros(self.size - len(x)))

    def _project(self, task: _Task) -> None:
        """Project the loads of a task on vectors that are new."""
        known = len(task.sides)
        if known < self.size:
            new = self._vectors.values[:, known:].T
            task.sides = np.concatenate([task.sides, np.stack([new @ task.offset, new @ task.before], axis=1)])

    def _scale(self, task: _Task) -> float:
        """Root of twice the energy [J^0.5] that the greater of the loads of a task has on K_0, or least counts."""
        return max(float(np.linalg.norm(task.sides, axis=0).max(initial=0.0)), self._least) or 1.0

    @cached_property
    def _least(self) -> float:
        """The same of the forces of the joints under the preload, times SMALLEST."""
        total = admissible(self._forces_of(self._at_rest), self._rigid, self.fixed)
        return SMALLEST * float(np.sqrt(max(float(total @ self._solved(total[:, None])[:, 0]), 0.0)))

    def _settle(self, tasks: Sequence[_Task], tolerances: Sequence[float]) -> None:
        """Bring all tasks into equilibrium."""
        past: list[float] = []  # the greatest error of each round
        for _ in range(ROUNDS):
            left = [k for k, task in enumerate(tasks) if task.error > tolerances[k]]
            if not left:
                return
            for k in left:
                self._project(tasks[k])
                self._balance(tasks[k], tolerances[k])
            rest = self._left_over([tasks[k] for k in left])
            if not np.all(np.isfinite(rest)):
                raise self._lost(tasks[left[int(np.argmin(np.isfinite(rest).all(axis=0)))]])
            z = self._solved(rest)
            sizes = _energy_roots(rest, z)
            for size, k in zip(sizes, left, strict=True):
                tasks[k].error = float(size) / self._scale(tasks[k]) if self.size or size == 0 else np.inf
            more = [column for column, k in enumerate(left) if tasks[k].error > tolerances[k]]
            worst = max(tasks, key=lambda task: task.error)
            if not more or (worst.error <= ROUNDED and _stands(past)):
                return
            past.append(worst.error)
            if not self._extend(*self._extrapolated([tasks[left[column]] for column in more], z[:, more], sizes[more])):
                if worst.error <= ROUNDED:
                    return
                raise self._lost(worst)
        raise self._lost(max(tasks, key=lambda task: task.error))

    def _extrapolated(self, tasks: Sequence[_Task], new: Array, size: Array) -> tuple[Array, Array]:
        """Vectors (unknowns, k) and those that the next rounds would find if tangents stayed as they are."""
        vectors, sizes = [new], [size]
        for _ in range(ROUNDS_AHEAD):
            rest = np.stack([self._turned(task, column) for task, column in zip(tasks, new.T, strict=True)], axis=1)
            new = self._solved(rest)
            vectors.append(new)
            sizes.append(_energy_roots(rest, new))
        return np.concatenate(vectors, axis=1), np.concatenate(sizes)

    def _turned(self, task: _Task, motion: Array) -> Array:
        """Forces [N] (unknowns,) by which joints depart from their springs, of a small motion (unknowns,)."""
        assert task.local is not None
        pairs = zip(self._relative_motions(motion), task.local.tangents, strict=True)
        total = self._forces_of([np.matmul(change, by[:, :, None])[:, :, 0] for by, change in pairs])
        return admissible(-total, self._rigid, self.fixed)

    def _balance(self, task: _Task, tolerance: float) -> None:
        """Newton's iteration within the basis."""
        x = self._in_basis(task.x)
        # vectors that are new have changed no motion yet
        local = task.local or self._local(task, x)
        left = self._left(task, x, local)
        size = float(np.linalg.norm(left))
        goal = max(0.03 * min(task.error, 1.0), 0.1 * tolerance) * self._scale(task)
        for _ in range(NEWTON_STEPS):
            if size <= goal or not len(x):
                break
            step = np.linalg.solve(self._tangent(local.tangents), left)
            best, length = None, 1.0
            for _ in range(HALVINGS):
                there = self._local(task, x + length * step)
                rest = self._left(task, x + length * step, there)
                now = float(np.linalg.norm(rest))
                if best is None or now < best[0]:
                    best = now, length, rest, there
                if now < (1 - 0.3 * length) * size:
                    break
                length /= 2
            assert best is not None
            gained = best[0] < 0.999 * size
            x = x + best[1] * step
            size, _, left, local = best
            if not gained:
                break
        task.x, task.local = x, local

    def _left(self, task: _Task, x: Array, local: _Local) -> Array:
        """Forces left over in the basis (m,)."""
        left = task.sides[:, 0] - x
        for k, (_, contact) in enumerate(self.joints):
            left = left - self._relative[k].T @ (contact.weights[:, None] * local.tractions[k]).ravel()
        return np.asarray(left)

    def _local(self, task: _Task, x: Array) -> _Local:
        """What the joints do at coordinates (m,)."""
        changes, tractions = [], []
        for k, (_, contact) in enumerate(self.joints):
            by = (self._relative[k] @ x).reshape(-1, 3)
            motion = contact.rest + task.moved[k] + by
            _, traction, tangent = contact.advance(task.start[k], motion)
            local = traction - self._at_rest[k]
            local[:, 0] -= contact.k_n * by[:, 0]
            local[:, 1:] -= contact.k_t[:, None] * by[:, 1:]
            tractions.append(local)
            tangent[:, 0, 0] -= contact.k_n
            tangent[:, 1, 1] -= contact.k_t
            tangent[:, 2, 2] -= contact.k_t
            changes.append(tangent)
        return _Local(tractions, changes)

    def _tangent(self, changes: Sequence[Array]) -> Array:
        """Tangent (m, m) in the basis: 1 and what the joints change of it.

        In single precision, in which Newton's method converges as fast: what is left over is found in double.
        """
        total = np.zeros((self.size, self.size), dtype=np.float32)
        for rows, change, (_, contact) in zip(self._single, changes, self.joints, strict=True):
            size = np.abs(change).max(axis=(1, 2))
            least = np.maximum(contact.k_n, MIN_TANGENT_CHANGE * contact.k_n.max())
            some = np.flatnonzero(size > MIN_TANGENT_CHANGE * least)
            here = rows[some]
            turned = np.matmul((contact.weights[some, None, None] * change[some]).astype(np.float32), here)
            total += here.reshape(-1, self.size).T @ turned.reshape(-1, self.size)
        return np.eye(self.size) + total

    def _left_over(self, tasks: Sequence[_Task]) -> Array:
        """What the answers leave of the forces on the whole structure [N] (unknowns, tasks)."""
        out = np.stack([task.offset for task in tasks], axis=1)
        out -= combined(self._images.values, np.stack([task.x for task in tasks], axis=1))
        for column, task in enumerate(tasks):
            assert task.local is not None
            left = out[:, column] - self._forces_of(task.local.tractions)
            out[:, column] = admissible(left, self._rigid, self.fixed)
        return out

    def _state(self, task: _Task) -> LoadedState:
        states, tractions, motions, lost = [], [], [], []
        for k, (_, contact) in enumerate(self.joints):
            motion = contact.rest + task.moved[k] + (self._relative[k][:, : len(task.x)] @ task.x).reshape(-1, 3)
            state, traction, _ = contact.advance(task.start[k], motion)
            lost.append(float(contact.weights @ contact.dissipated(task.start[k], state)))
            states.append(state)
            tractions.append(traction)
            motions.append(motion)
        return LoadedState(
            coordinates=task.x,
            acting=task.target,
            contact=tuple(states),
            tractions=tuple(tractions),
            motions=tuple(motions),
            dissipated=np.array(lost),
            error=task.error,
        )

    def _offset(self, acting: Acting) -> Array:
        """Forces f - K d [N] (unknowns,)."""
        force = acting.force
        if np.any(acting.moved):
            force = force - self._elastic_forces(acting.moved)
        return admissible(force, self._rigid, self.fixed)

    def _spring_forces(self, acting: Acting) -> Array:
        """What the springs of the joints at the preload resist of d [N] (unknowns,)."""
        moves = self._relative_motions(acting.moved)
        springs = (np.stack([contact.k_n, contact.k_t, contact.k_t], axis=1) for _, contact in self.joints)
        total = self._forces_of([local * by for local, by in zip(springs, moves, strict=True)])
        return admissible(total, self._rigid, self.fixed)

    def _relative_motions(self, motion: Array) -> list[Array]:
        """Relative motion of each joint (q, 3) [m] by a displacement (unknowns,)."""
        return [np.asarray(interface.relative @ motion).reshape(-1, 3) for interface, _ in self.joints]

    def _forces_of(self, tractions: Sequence[Array]) -> Array:
        """Nodal forces [N] (unknowns,) of the tractions of each joint (q, 3) [Pa]."""
        total = np.zeros(self.stiffness.shape[0])
        for (interface, contact), traction in zip(self.joints, tractions, strict=True):
            total += interface.relative.T @ (contact.weights[:, None] * traction).ravel()
        return total

    def _solved(self, forces: Array) -> Array:
        """Displacements near K_0^-1 forces (unknowns, k)."""
        return admissible(np.asarray(self.factor.solve(forces)), self._rigid, self.fixed)

    def _extend(self, new: Array, size: Array) -> int:
        """Add columns (unknowns, k) to the basis; return how many directions were new.

        size: about the root of twice the energy [J^0.5] of each (k,), by which small ones count as much as great ones.
        """
        require(
            WORKING_ROOM * 16.0 * self.stiffness.shape[0] * new.shape[1],
            f"load cases of {self.stiffness.shape[0]:,} unknowns with {self.size} vectors, and more vectors",
            "solve fewer cases at a time",
        )
        new = new[:, size > 0] / size[size > 0]
        if not new.shape[1]:
            return 0
        found, image = extension(new, self._vectors.values, self._images.values, self.stiffness, least=1e-20)
        if not self.size:  # room is made ahead of the first columns
            self._vectors, self._images = (GrowingColumns(one, ahead=VECTORS_AHEAD) for one in (found, image))
        else:
            self._vectors.add(found)
            self._images.add(image)
        self._relative = [
            np.concatenate([old, np.asarray(interface.relative @ found)], axis=1)
            for old, (interface, _) in zip(self._relative, self.joints, strict=True)
        ]
        self._single = [one.astype(np.float32).reshape(len(one) // 3, 3, -1) for one in self._relative]
        return int(found.shape[1])

    def _lost(self, task: _Task) -> NotConverged:
        """What to say of a load whose iteration stops short."""
        state = self._state(replace(task, x=self._in_basis(task.x)))
        pairs = enumerate(zip(self.joints, state.motions, strict=True))
        apart = [k for k, ((_, contact), motion) in pairs if not np.any(contact.normal(motion)[0] > 0)]
        where = f"; joint {apart[0] + 1} is fully open, and nothing holds its parts together" if apart else ""
        where = where or self._sheared(state)
        return NotConverged(
            f"load {task.name!r}: no equilibrium is found, an error of {task.error:.1e} is left{where}; give more "
            "increments, a smaller load or a greater preload"
        )

    def _sheared(self, state: LoadedState) -> str:
        """What to say of a joint that sticks under a shear which no friction bears; "" where there is none.

        Where such a face opens, its shear ends at once unless k_t falls to 0 with pressure, and no state between is in
        equilibrium.
        """
        ratios = [
            _greatest_ratio(traction) if contact.friction is None else 0.0
            for traction, (_, contact) in zip(state.tractions, self.joints, strict=True)
        ]
        if max(ratios) < BORNE:
            return ""
        k = int(np.argmax(ratios))
        return (
            f"; joint {k + 1} sticks under a shear of {ratios[k]:.3g} times its pressure, which no friction bears, and "
            "loses it at once where it opens: give it joint.friction"
        )


def _energy_roots(forces: Array, motions: Array) -> Array:
    """Roots of twice the energies [J^0.5] (k,) of forces [N] on motions [m], both (unknowns, k)."""
    return np.asarray(np.sqrt(np.maximum(np.einsum("ij,ij->j", forces, motions), 0.0)))


def _greatest_ratio(traction: Array) -> float:
    """The greatest shear over pressure of points (q, 3) that touch [-]; 0 where none does."""
    shut = traction[:, 0] < 0
    return float((np.linalg.norm(traction[shut, 1:], axis=1) / -traction[shut, 0]).max(initial=0.0))


def _stands(errors: Sequence[float]) -> bool:
    """Whether errors, round by round, fall no further."""
    return len(errors) > STAGNANT_ROUNDS and min(errors[-STAGNANT_ROUNDS:]) > min(errors[:-STAGNANT_ROUNDS]) / 2
