"""Cheap stand-ins for the many points of a joint: groups of them that move alike, and seven digits of their motion.

The groups are never the answer. An equilibrium starts from them, takes its tangents and its small changes from the
seven digits, and ends where the force balance of all points in full says so. Springs of the modes have seven digits.
"""

from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from faying.typing import Array, Index

SIZE = 8  # most points of a group
MIN_CLOSED_SHARE = 0.95  # of the points: where fewer have springs, the others are left out
COMPARED_MOTIONS = 6  # of the motions of a joint, strongest first, by which points are alike


def joint_stiffness(relative: Any, springs: Array) -> Array:
    """Stiffness (m, m) of springs (q, 3) [N/m], normal and both tangential, on a relative motion (3q, m).

    Springs and losses are never negative: half the work through their roots. A motion in single precision gives as many
    digits.
    """
    closed = np.flatnonzero(springs.any(axis=1))
    if len(closed) < MIN_CLOSED_SHARE * len(springs):
        # one copy, by rows of three, takes less than what it saves
        rooted = relative.reshape(len(springs), -1).take(closed, axis=0).reshape(-1, relative.shape[1])
        rooted *= np.sqrt(springs[closed]).astype(relative.dtype).reshape(-1, 1)
    else:
        rooted = np.sqrt(springs).astype(relative.dtype).reshape(-1, 1) * relative
    return np.asarray((rooted.T @ rooted).astype(float))  # NumPy sees that both are one, and does half of it


def per_point(weights: Array, k_n: Array, k_t: Array) -> Array:
    """Springs (q, 3) [N/m], normal and both tangential, of areas [m2] with stiffness per area [Pa/m] (q,)."""
    return np.asarray(weights[:, None] * np.stack([k_n, k_t, k_t], axis=1))


@dataclass(frozen=True, kw_only=True)
class Groups:
    """Groups of the q points of one joint, g of them.

    order: the points, group by group (q,); starts: where each group begins in `order` (g,); weights: area of each
    group [m2] (g,); shares: of each point of `order` in the area of its group (q,); relative: mean motion (3g, m);
    light: the motion of all points (3q, m) in seven digits; light_mean: `relative` in as many.
    """

    order: Index
    starts: Index
    weights: Array
    shares: Array
    relative: Array
    light: NDArray[np.float32]
    light_mean: NDArray[np.float32]

    @classmethod
    def of(cls, weights: Array, relative: Array) -> Self:
        """Group points of areas `weights` [m2] (q,) by their relative motion (3q, m): halves of halves."""
        motion = relative.reshape(len(weights), -1)
        moved = motion - motion.mean(axis=0)
        seen = moved @ np.linalg.eigh(moved.T @ moved)[1][:, : -COMPARED_MOTIONS - 1 : -1]
        groups, left_over = [], [np.arange(len(weights))]
        while left_over:
            here = left_over.pop()
            if len(here) <= SIZE:
                groups.append(here)
                continue
            widest = int(np.argmax(np.ptp(seen[here], axis=0)))
            ranked = here[np.argsort(seen[here, widest], kind="stable")]
            left_over += [ranked[: len(here) // 2], ranked[len(here) // 2 :]]
        order = np.concatenate(groups)
        starts = np.cumsum([0, *map(len, groups[:-1])])
        area = np.add.reduceat(weights[order], starts)
        shares = weights[order] / np.repeat(area, np.diff(np.append(starts, len(order))))
        mean = np.add.reduceat(shares[:, None] * motion[order], starts, axis=0)
        width = relative.shape[1]
        return cls(
            order=order,
            starts=starts,
            weights=area,
            shares=shares,
            relative=mean.reshape(-1, width),
            light=relative.astype(np.float32),
            light_mean=mean.reshape(-1, width).astype(np.float32),
        )

    def mean(self, values: Array) -> Array:
        """Means (g,) by area of values (q,)."""
        return np.add.reduceat(self.shares * values[self.order], self.starts)

    def sums(self, values: Array) -> Array:
        """Sums (g, ...) over each group of values (q, ...)."""
        return np.add.reduceat(values[self.order], self.starts)
