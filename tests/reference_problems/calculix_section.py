"""The section of a bracket that is bonded to its tapped base, by CalculiX with CAX8 elements."""

import numpy as np

from tests.helpers import ccx, ccx_contact
from tests.reference_problems.axial_section import rows


def grid(r, z):
    """Nodes (n, 2) of quadratic elements in rows and columns, and the elements (e, 8)."""
    places = [np.interp(np.arange(2 * len(one) - 1) / 2, np.arange(len(one)), one) for one in (r, z)]
    index = -np.ones([len(one) for one in places], dtype=int)
    there = ~np.logical_and.outer(*(np.arange(len(one)) % 2 == 1 for one in places))
    index[there] = np.arange(np.count_nonzero(there))
    nodes = np.stack([one[there] for one in np.meshgrid(*places, indexing="ij")], axis=1)
    steps = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
    shape = [2 * len(one) - 2 for one in (r, z)]
    cells = np.stack([index[i : shape[0] + i : 2, k : shape[1] + k : 2].ravel() for i, k in steps], axis=1)
    return nodes, cells


def even(nodes, axis, place, span):
    """Shares of an even traction on a side, by node: exact for quadratic sides."""
    on = np.flatnonzero((np.abs(nodes[:, axis] - place) < 1e-9) & (nodes[:, 1 - axis] > span[0] - 1e-9))
    on = on[nodes[on, 1 - axis] < span[1] + 1e-9]
    on = on[np.argsort(nodes[on, 1 - axis])]
    share, x = np.zeros(len(nodes)), nodes[on, 1 - axis]
    for k in range(0, len(on) - 2, 2):
        r = nodes[on[k : k + 3], 0]
        # of the two corners and the middle: the radius is linear
        share[on[k : k + 3]] += (x[k + 2] - x[k]) / 6 * np.array([r[0], 4 * r[1], r[2]])
    return share / share.sum()


def bonded(folder, *, seat, hole, thread, outer, base, length, depth, engaged, parts, size):
    """Compliance [m/N] between the seat and the thread, as of `axial_section.tapped` with a rigid joint."""
    r = rows((thread / 2, hole / 2, seat / 2, outer / 2, base / 2), size)
    r = np.unique(np.round(r, 12))
    upper, above = grid(r[(r > hole / 2 - 1e-9) & (r < outer / 2 + 1e-9)], rows((0.0, length), size))
    lower, below = grid(r, rows((-depth, -engaged, 0.0), size))
    # the nodes of the bracket in the joint are those of the base
    name = {tuple(np.round(node, 9)): k for k, node in enumerate(lower)}
    number = np.array(
        [name.get(tuple(np.round(node, 9)), -1) if abs(node[1]) < 1e-9 else -1 for node in upper], dtype=int
    )
    number[number < 0] = len(lower) + np.arange(np.count_nonzero(number < 0))
    nodes = np.zeros((number.max() + 1, 2))
    nodes[: len(lower)], nodes[number] = lower, upper
    thread_share = even(nodes, 0, thread / 2, (-engaged, 0.0))
    clamp = thread_share - even(nodes, 1, length, (hole / 2, seat / 2))
    lines = ["*NODE,NSET=NALL", *(f"{k},{x:.12e},{y:.12e},0." for k, (x, y) in enumerate(nodes * 1e3, 1))]
    count = 0
    for part, cells, (E, nu) in (("BRACKET", number[above], parts[0]), ("BASE", below, parts[1])):
        lines += [f"*ELEMENT,TYPE=CAX8,ELSET={part}"]
        lines += [",".join(map(str, [count + k, *cell])) for k, cell in enumerate(cells + 1, 1)]
        count += len(cells)
        lines += [f"*MATERIAL,NAME={part}", "*ELASTIC", f"{E * 1e-6},{nu}"]
        lines += [f"*SOLID SECTION,ELSET={part},MATERIAL={part}"]
    held = np.flatnonzero(np.abs(nodes[:, 1] + depth) < 1e-9) + 1
    force = 1e3  # N
    lines += ["*BOUNDARY", *(f"{k},1,2" for k in held), "*STEP", "*STATIC", "*CLOAD"]
    lines += [f"{k},2,{force * share:.12e}" for k, share in enumerate(clamp, 1) if share]
    ccx.run(folder, "\n".join([*lines, "*NODE PRINT,NSET=NALL", "U", "*END STEP"]) + "\n")
    (moved,) = ccx_contact.read(folder, len(nodes))
    return float(clamp @ moved.reshape(-1, 3)[:, 1]) / force
