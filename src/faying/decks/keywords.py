"""What the decks of CalculiX and Abaqus share: orientations, spring elements, the law as a contact table."""

import numpy as np

from faying.decks.deck import Contact, JointDeck, grouped, real
from faying.errors import InputError
from faying.typing import Array, Index


def orientations(deck: JointDeck) -> tuple[list[str], Index]:
    """Keyword lines of the axes of all pairs, and which of them each pair takes; their names are JKA0, JKA1, ...

    The first local axis is the normal, the second a tangent.
    """
    first, group = grouped(deck.axes)
    lines = []
    for g, leader in enumerate(first):
        numbers = ",".join(real(v, 20) for v in deck.axes[leader, :2].ravel())
        lines += [f"*ORIENTATION,NAME=JKA{g},SYSTEM=RECTANGULAR", numbers]
    return lines, group


def elements(
    deck: JointDeck, kind: str, keyword: str, label: str, values: Array, axes: Index, number: int
) -> tuple[list[str], int]:
    """Two-node elements of one direction each, equal ones together, and the number after the last.

    values (p, 3): along the normal and the two tangents; axes: the orientation of each pair.
    """
    one, two = deck.ends
    lines = []
    scale = max(float(np.abs(values).max()), 1e-300)
    for axis in range(3):
        first, group = grouped(np.column_stack([axes, values[:, axis] / scale]))
        order = np.argsort(group, kind="stable")
        starts = np.searchsorted(group[order], np.arange(len(first) + 1))
        for g, leader in enumerate(first):
            if values[leader, axis] == 0:
                continue
            name = f"{label}{axis + 1}_{g}"
            lines.append(f"*ELEMENT,TYPE={kind},ELSET={name}")
            for i in order[starts[g] : starts[g + 1]]:
                lines.append(f"{number},{one[i]},{two[i]}")
                number += 1
            lines += [
                f"*{keyword},ELSET={name},ORIENTATION=JKA{axes[leader]}",
                f"{axis + 1},{axis + 1}",
                real(float(values[leader, axis]), 20),
            ]
    return lines, number


def table(deck: JointDeck) -> tuple[list[str], Contact]:
    """Lines of pressure and overclosure in the deck's units, and the contact they came from."""
    contact = deck.contact
    if contact is None:
        raise InputError("the law gives no curve of pressure against approach; export springs")
    pressure, approach = contact.pressure * deck.system.pressure, contact.approach * deck.system.metre
    rows = [f"{real(p, 20)},{real(w, 20)}" for p, w in zip(pressure, approach, strict=True)]
    return ["0.,0.", *rows], contact
