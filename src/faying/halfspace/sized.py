"""Contacts whose hardness is, at every spot, the one that its size has."""

from collections.abc import Callable

import numpy as np

from faying.errors import NotConverged
from faying.halfspace.solution import HalfSpaceContact
from faying.halfspace.solve import spread_map
from faying.hardness import VickersHardness
from faying.typing import Array

FULL_PASSES = 6  # after these the hardness of a point only falls
MAX_PASSES = 20
HARDNESS_TOLERANCE = 1e-2  # change of ln H, weighted by the load, below which it is that of the spots


def solve_with_size(
    solve: Callable[[Array, HalfSpaceContact | None], HalfSpaceContact],
    shape: tuple[int, int],
    spacing: tuple[float, float],
    law: VickersHardness,
    start: HalfSpaceContact | None,
) -> HalfSpaceContact:
    """Solve a contact whose hardness is, at every spot, the one that its own size has.

    Solve, measure the spots, set the hardness of each by its size, solve again, until it changes by less than 1 % on
    average over the load.

    Args:
        solve: solves the map with a hardness at each point [Pa] (ny, nx), from an earlier contact.
        shape: of the map.
        spacing: (dx, dy) [m].
        law: hardness over the diagonal of an indentation.
        start: an earlier contact of the map, or of the map on fewer points; its spots give the first hardness.

    Raises:
        NotConverged: where the hardness of the spots keeps changing.
    """
    if start is None:
        hardness = np.full(shape, float(law.at(4 * np.sqrt(2 * spacing[0] * spacing[1]))))
    else:
        hardness = spread_map(start.spots.hardness(law), shape)
    contact, change = start, np.inf
    for number in range(MAX_PASSES):
        contact = solve(hardness, contact)
        found = contact.spots.hardness(law)
        if number >= FULL_PASSES:  # spots that join under one hardness and part under the next one alternate
            found = np.minimum(hardness, found)
        # where the contact is elastic its hardness does not matter
        plastic = contact.at_hardness | (contact.traction > found)
        load = contact.traction.sum(dtype=float)
        change = float((contact.traction * plastic * np.abs(np.log(found / hardness))).sum() / load) if load else 0.0
        if change < HARDNESS_TOLERANCE:
            return contact
        hardness = found
    raise NotConverged(
        f"half-space contact: the hardness of the spots still changes by {abs(change):.1%} after {MAX_PASSES} "
        "solutions; give one hardness for all spots"
    )
