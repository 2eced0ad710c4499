"""CalculiX: matrices read, and the joint written as SPRING2 elements or as a table for node-to-surface contact.

After the CalculiX CrunchiX manual, 2.20: values in at most 20 columns with a decimal point; a table of at most 200
points, pressure constant beyond. Surface-to-surface contact loses a TABULAR law without a word.
"""

from pathlib import Path
from typing import Any

import numpy as np

from faying.decks.deck import JointDeck, reals
from faying.decks.keywords import interaction, springs
from faying.decks.raw import Matrices, both_triangles, numbers_of, once, read_dofs, read_text, whole
from faying.errors import ReadError
from faying.typing import Index

MAX_POINTS = 200


def read_matrices(path: Path, _names: tuple[str, str]) -> Matrices:
    """Read job.sti, .mas and .dof: rows of (row, column, value) of one triangle, and a list of "node.direction"."""
    from scipy.sparse import coo_array

    dofs = read_dofs(path.with_suffix(".dof"))
    n = len(dofs)
    out = []
    for suffix, what in ((".sti", "stiffness"), (".mas", "mass")):
        file = path.with_suffix(suffix)
        values = numbers_of(file, read_text(file, what))
        if len(values) % 3:
            raise ReadError(f"{file} is not rows of row, column and value; is it complete?")
        table = values.reshape(-1, 3)
        i, j = whole(file, table[:, 0], n), whole(file, table[:, 1], n)
        once(file.name, np.minimum(i, j), np.maximum(i, j), n)
        out.append(both_triangles(coo_array((table[:, 2], (np.minimum(i, j), np.maximum(i, j))), shape=(n, n)).tocsr()))
    # nodes that share mass share stiffness: a file cut short has lost pairs of them
    pairs = [_node_pairs(matrix, dofs) for matrix in out]
    lost = np.setdiff1d(pairs[1], pairs[0])
    bare = np.setdiff1d(np.unique(dofs[:, 0]), dofs[out[1].diagonal() > 0, 0])
    if len(lost) or len(bare):
        where, what = (path, "stiffness") if len(lost) else (path.with_suffix(".mas"), "mass")
        raise ReadError(f"{where} has no {what} for {len(lost) or len(bare)} nodes or pairs of nodes; it is cut short")
    return out[0], out[1], dofs


def _node_pairs(matrix: Any, dofs: Index) -> Index:
    """One number for each pair of nodes between which a matrix has an entry."""
    entries = matrix.tocoo()
    _, node = np.unique(dofs[:, 0], return_inverse=True)
    return np.unique(node[entries.row] * (node.max(initial=0) + 1) + node[entries.col])


def decks(deck: JointDeck) -> dict[str, str]:
    """Files to include in an input deck before its first step, by name."""
    out = {"joint_spring2.inp": spring2(deck)}
    if deck.contact is not None:
        out["joint_contact.inp"] = contact(deck)
    return out


def spring2(deck: JointDeck) -> str:
    """Write SPRING2 elements along the normal and the tangents of the face. Raises InputError as `NodePairs.own`."""
    note = "no damping: CalculiX takes no loss factor for a spring, and a DASHPOTA between coincident nodes gives NaN"
    return springs(deck, note)


def contact(deck: JointDeck) -> str:
    """Write a surface interaction and the contact pair, to take the place of the springs in a model with bolts."""
    rows, law = interaction(deck)
    slope = law.k_t * deck.system.density
    lines = deck.header(
        "**",
        "contact in place of springs: needs a *STATIC step with the bolts, then *STEP,PERTURBATION with *FREQUENCY",
        "NODE TO SURFACE only: SURFACE TO SURFACE loses a TABULAR law. Slave is the surface named first",
        f"stick slope k_t at the mean pressure, {law.mean_pressure * deck.system.pressure:.6g}; {law.friction_note}",
        "no damping: *CONTACT DAMPING acts in *DYNAMIC only",
    )
    lines += [*rows, "*FRICTION", reals([law.friction, slope])]
    lines += ["*CONTACT PAIR,INTERACTION=JK,TYPE=NODE TO SURFACE", ",".join(deck.faces)]
    return "\n".join(lines) + "\n"
