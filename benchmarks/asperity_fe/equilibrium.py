"""Equilibrium under the plane: a projected Newton iteration on a convex energy.

Over one step the energy is convex in the displacement and the plane only bounds the heights of the surface nodes, so
the equilibrium is the minimum of a convex function under bounds. Each iteration pins the nodes that the plane presses,
solves with the consistent tangent for the others, and searches along the path that the bounds bend, down the energy
itself; contact and plastic flow are found together, and the search makes the iteration converge from any start.
Source: D. P. Bertsekas, SIAM J. Control Optim. 20 (1982) 221-246, doi:10.1137/0320018.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from asperity_fe.body import Balance, Body, CapState
from faying.errors import NotConverged
from faying.numerics.pardiso import Pardiso
from faying.numerics.solve import Factorisation, factorise
from faying.typing import Array, Index

TOLERANCE = 1e-5  # unbalanced force over the forces that press
ITERATIONS = 40


@dataclass(frozen=True, kw_only=True)
class CapEquilibrium:
    """unknowns (n,) [m]; balance; pressing: places in `body.touching` of the nodes in contact; iterations."""

    unknowns: Array
    balance: Balance
    pressing: Index
    iterations: int


class CapSolver:
    """Solves with tangents of one pattern; the symbolic part of the factorisation is done once."""

    def __init__(self, name: str | None = None) -> None:
        self._name = name
        self._factor: Factorisation | None = None
        self.factorisations = 0

    def __call__(self, matrix: Any, right: Array) -> Array:
        """Solve with `matrix`, whose pattern is that of the first one."""
        if isinstance(self._factor, Pardiso):
            self._factor = self._factor.again(matrix)
        else:
            self._factor = factorise(matrix, self._name)
        self.factorisations += 1
        return self._factor.solve(right)


def follow(body: Body, solver: CapSolver, at: CapEquilibrium, moves: Array) -> Array:
    """Predict the displacement after the nodes in contact have moved by `moves`: one solution with the tangent."""
    pinned = body.touching[at.pressing]
    matrix = body.tangent(at.balance.returned)
    shift = np.zeros(body.size)
    shift[pinned] = moves
    right = -(matrix @ shift)
    right[pinned] = 0.0
    return at.unknowns + shift + np.where(_mask(body.size, pinned), 0.0, solver(body.fixed(matrix, pinned), right))


def _mask(size: int, places: Index) -> Any:
    mask = np.zeros(size, bool)
    mask[places] = True
    return mask


def balanced(
    body: Body, solver: CapSolver, start: Array, state: CapState, room: Array, tolerance: float = TOLERANCE
) -> CapEquilibrium:
    """Find the equilibrium reached in one step from `state`.

    start (n,): where to begin; room (s,): how far each surface node may rise before the plane stops it [m].
    Raises NotConverged with the number of iterations, the imbalance left and the place of the largest one.
    """
    ceiling = np.full(body.size, np.inf)
    ceiling[body.touching] = room
    x = np.minimum(start, ceiling)
    now = body.balance(x, state)
    imbalance = np.inf
    for iteration in range(ITERATIONS):
        at_bound = x >= ceiling
        pinned = np.flatnonzero(at_bound & (now.force <= 0))
        loose = ~_mask(body.size, pinned)
        # where nothing presses, the force of the stresses on the finest elements
        inner = float(np.abs(now.returned.stress).max() * np.median(body.quads.weight) ** (2 / 3))
        scale = float(np.abs(now.force[pinned]).sum()) or inner
        imbalance = float(np.linalg.norm(now.force[loose])) / scale if scale else 0.0
        if imbalance < tolerance:
            pressing = np.flatnonzero(~loose[body.touching])
            return CapEquilibrium(unknowns=x, balance=now, pressing=pressing, iterations=iteration)
        right = np.where(loose, -now.force, 0.0)
        step = solver(body.fixed(body.tangent(now.returned), pinned), right)
        step[pinned] = 0.0
        length = 1.0
        for _ in range(30):
            trial = np.minimum(x + length * step, ceiling)
            then = body.balance(trial, state)
            slope = float(now.force @ (trial - x))
            rounding = 1e-12 * abs(now.energy)
            if then.energy <= now.energy + 1e-4 * slope + rounding:
                break
            length *= 0.5
        else:
            break
        x, now = trial, then
    worst = int(np.argmax(np.where(loose, np.abs(now.force), 0.0)))
    node = int(np.flatnonzero(body.unknown_of_dof == worst)[0]) // 2
    r, z = body.mesh.nodes[node]
    raise NotConverged(
        f"no equilibrium after {iteration + 1} iterations: imbalance {imbalance:.2e} of the load (allowed "
        f"{tolerance:g}),"
        f" largest at r = {r:.4g} m, z = {z:.4g} m; take more steps, or a finer mesh"
    )
