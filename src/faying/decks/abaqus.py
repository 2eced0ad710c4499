"""Abaqus: SPRING2 and DASHPOT2, connectors with structural damping, a matrix, and the law as a contact property.

Keywords after the Abaqus Keywords Reference Guide 2016 and 2017: MATRIX INPUT (entries "node, direction, node,
direction, value", one triangle), CONNECTOR DAMPING (TYPE=STRUCTURAL: a part of the elasticity), SPRING (ORIENTATION).
Not run: read back in the tests by a reader of that grammar.
"""

import numpy as np

from faying.decks.deck import JointDeck, grouped, real
from faying.decks.keywords import elements, orientations, table
from faying.typing import Array


def decks(deck: JointDeck) -> dict[str, str]:
    """Files to include in an input deck before its first step, by name; one of them, not all."""
    out = {"joint_matrix.inp": matrix(deck)}
    if deck.uncoupled:
        out["joint_spring2.inp"] = spring2(deck)
    if deck.pairs.lumped:
        out["joint_connector.inp"] = connector(deck)
    if deck.contact is not None:
        out["joint_contact.inp"] = contact(deck)
    return out


def spring2(deck: JointDeck) -> str:
    """Write SPRING2 elements, and DASHPOT2 where there are dampers. Raises InputError as `NodePairs.own`."""
    lines = deck.header("**", deck.damping_said())
    axes, group = orientations(deck)
    springs, number = elements(
        deck, "SPRING2", "SPRING", "JK", deck.pairs.own(deck.stiffness), group, deck.first_element
    )
    dashpots: list[str] = []
    if deck.dampers is not None:
        dashpots, _ = elements(deck, "DASHPOT2", "DASHPOT", "JC", deck.pairs.own(deck.dampers), group, number)
    return "\n".join([*lines, *axes, *springs, *dashpots]) + "\n"


def connector(deck: JointDeck) -> str:
    """Write CONN3D2 elements of type CARTESIAN: component 1 is the normal; loss factors as structural damping."""
    k, lost = deck.pairs.own(deck.stiffness), deck.pairs.own(deck.loss)
    ratio = np.divide(lost, k, out=np.zeros_like(k), where=k != 0)
    dampers = deck.pairs.own(deck.dampers) if deck.paper and deck.dampers is not None else None
    said = deck.damping_said() if dampers is not None else "loss factors as structural damping of each component"
    lines = deck.header("**", said)
    axes, group = orientations(deck)
    lines += axes
    one, two = deck.ends
    key = [group[:, None], k / np.abs(k).max(), ratio]
    if dampers is not None:
        key.append(dampers / np.abs(dampers).max())
    first, alike = grouped(np.column_stack(key))
    number = deck.first_element
    for g, leader in enumerate(first):
        lines.append(f"*ELEMENT,TYPE=CONN3D2,ELSET=JN{g}")
        for i in np.flatnonzero(alike == g):
            lines.append(f"{number},{one[i]},{two[i]}")
            number += 1
        lines += [f"*CONNECTOR SECTION,ELSET=JN{g},BEHAVIOR=JB{g}", "CARTESIAN,", f"JKA{group[leader]},"]
        lines.append(f"*CONNECTOR BEHAVIOR,NAME=JB{g}")
        for c in range(3):
            lines += [f"*CONNECTOR ELASTICITY,COMPONENT={c + 1}", f"{real(k[leader, c], 20)},"]
            if dampers is not None:
                lines += [f"*CONNECTOR DAMPING,COMPONENT={c + 1}", f"{real(dampers[leader, c], 20)},"]
            elif ratio[leader, c]:
                lines += [f"*CONNECTOR DAMPING,COMPONENT={c + 1},TYPE=STRUCTURAL", f"{real(ratio[leader, c], 20)},"]
    return "\n".join(lines) + "\n"


def matrix(deck: JointDeck) -> str:
    """Write the joint as sparse matrices: stiffness, and structural damping or, after the JK paper, viscous."""
    paper = deck.paper and deck.dampers is not None
    lines = deck.header(
        "**",
        deck.damping_said()
        if paper
        else "loss as a structural damping matrix, the imaginary "
        "part of the stiffness; frequency-domain steps with SIM only",
    )
    lines += _entries("KJ", deck, deck.stiffness)
    assemble = "*MATRIX ASSEMBLE,STIFFNESS=KJ"
    if paper and deck.dampers is not None:
        lines += _entries("CJ", deck, deck.dampers)
        assemble += ",VISCOUS DAMPING=CJ"
    elif np.any(deck.loss):
        lines += _entries("SJ", deck, deck.loss)
        assemble += ",STRUCTURAL DAMPING=SJ"
    return "\n".join([*lines, assemble]) + "\n"


def _entries(name: str, deck: JointDeck, blocks: Array) -> list[str]:
    from scipy.sparse import triu

    upper = triu(deck.pairs.matrix(blocks)).tocoo()
    n = deck.mesh.numbers
    return [f"*MATRIX INPUT,NAME={name},TYPE=SYMMETRIC"] + [
        f"{n[i // 3]},{i % 3 + 1},{n[j // 3]},{j % 3 + 1},{real(v, 23)}"
        for i, j, v in zip(upper.row, upper.col, upper.data, strict=True)
        if v
    ]


def contact(deck: JointDeck) -> str:
    """Write a surface interaction with the law as pressure-overclosure table, and the contact pair."""
    rows, law = table(deck)
    slip = law.friction * law.mean_pressure / law.k_t * deck.system.metre
    lines = deck.header(
        "**",
        "contact in place of springs: needs a step with the bolts before *FREQUENCY",
        f"elastic slip: sticks with k_t at the mean pressure; friction {law.friction:g}"
        + ("" if law.given else ", not given by the study: check it"),
    )
    lines += ["*SURFACE INTERACTION,NAME=JK", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TABULAR", *rows]
    lines += [f"*FRICTION,ELASTIC SLIP={real(slip, 20)}", f"{real(law.friction, 20)},"]
    if deck.frequency is not None and law.loss_n:
        c = law.loss_n * law.k_n / (2 * np.pi * deck.frequency) * deck.system.density
        lines += ["*CONTACT DAMPING,DEFINITION=DAMPING COEFFICIENT", f"{real(c, 20)},"]
    lines += ["*CONTACT PAIR,INTERACTION=JK,TYPE=SURFACE TO SURFACE", ",".join(deck.faces)]
    return "\n".join(lines) + "\n"
