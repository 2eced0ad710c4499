"""CalculiX: matrices read, and the joint written as SPRING2 elements or as a table for node-to-surface contact.

After the CalculiX CrunchiX manual, 2.20: values in at most 20 columns with a decimal point; a table of at most 200
points, pressure constant beyond. Surface-to-surface contact loses a TABULAR law without a word.
"""

from pathlib import Path

import numpy as np

from faying.decks.deck import JointDeck, real
from faying.decks.keywords import elements, orientations, table
from faying.decks.raw import Matrices, read_dofs, read_text
from faying.errors import ReadError

MOST_POINTS = 200


def read_matrices(path: Path, _names: tuple[str, str]) -> Matrices:
    """Read job.sti, .mas and .dof: rows of (row, column, value) of one triangle, and a list of "node.direction"."""
    from scipy.sparse import coo_array, diags_array

    table = read_dofs(path.with_suffix(".dof"))
    out = []
    for suffix, what in ((".sti", "stiffness"), (".mas", "mass")):
        file = path.with_suffix(suffix)
        words = read_text(file, what).replace("D", "E").split()
        try:
            rows = np.array(words, dtype=float).reshape(-1, 3)
        except ValueError as fault:
            raise ReadError(f"{file} is not rows of row, column and value ({fault}); is it whole?") from None
        i, j = rows[:, 0].astype(np.int64) - 1, rows[:, 1].astype(np.int64) - 1
        if len(rows) and max(i.max(), j.max()) >= len(table):
            raise ReadError(
                f"{file} has row {max(i.max(), j.max()) + 1}, but the .dof file lists {len(table)} unknowns"
            )
        half = coo_array((rows[:, 2], (i, j)), shape=(len(table), len(table))).tocsr()
        out.append((half + half.T - diags_array(half.diagonal())).tocsr())
    return out[0], out[1], table


def decks(deck: JointDeck) -> dict[str, str]:
    """Files to include in an input deck before its first step, by name."""
    out = {"joint_spring2.inp": spring2(deck)}
    if deck.contact is not None:
        out["joint_contact.inp"] = contact(deck)
    return out


def spring2(deck: JointDeck) -> str:
    """Write SPRING2 elements along the normal and the tangents of the face. Raises InputError as `NodePairs.own`."""
    lines = deck.header(
        "**",
        "no damping: CalculiX takes no loss factor for a spring, and a DASHPOTA between coincident nodes gives NaN",
    )
    axes, group = orientations(deck)
    values = deck.pairs.own(deck.stiffness)
    springs, _ = elements(deck, "SPRING2", "SPRING", "JK", values, group, deck.first_element)
    return "\n".join([*lines, *axes, *springs]) + "\n"


def contact(deck: JointDeck) -> str:
    """Write a surface interaction and the contact pair, to take the place of the springs in a model with bolts."""
    rows, law = table(deck)
    slope = law.k_t * deck.system.density
    lines = deck.header(
        "**",
        "contact in place of springs: needs a *STATIC step with the bolts, then *STEP,PERTURBATION with *FREQUENCY",
        "NODE TO SURFACE only: SURFACE TO SURFACE loses a TABULAR law. Slave is the surface named first",
        f"stick slope k_t at the mean pressure, {law.mean_pressure * deck.system.pressure:.6g}; friction {law.friction:g}"
        + ("" if law.given else ", not given by the study: check it"),
        "no damping: *CONTACT DAMPING acts in *DYNAMIC only",
    )
    lines += ["*SURFACE INTERACTION,NAME=JK", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TABULAR", *rows]
    lines += ["*FRICTION", f"{real(law.friction, 20)},{real(slope, 20)}"]
    lines += ["*CONTACT PAIR,INTERACTION=JK,TYPE=NODE TO SURFACE", ",".join(deck.faces)]
    return "\n".join(lines) + "\n"
