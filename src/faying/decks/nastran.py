"""Nastran: CBUSH with loss factors, CELAS2, and DMIG, all in fields of 16 columns.

Cards after the MSC Nastran Quick Reference Guide and OptiStruct's: PBUSH (K, B, GE), CBUSH with CID since its grids
coincide, CELAS2 (K, G1, C1, G2, C2, GE), DMIG with one triangle of a symmetric matrix (form 6), chosen in the case
control by K2GG, B2GG and K42GG. MYSTRAN solves CBUSH and CELAS2 and passes DMIG over.
"""

import numpy as np

from faying.decks.deck import JointDeck, grouped, real, springs_of
from faying.errors import InputError
from faying.typing import Array

Field = int | float | str


def decks(deck: JointDeck) -> dict[str, str]:
    """Bulk data to include, by name; one of them, not all."""
    out = {"joint_dmig.bdf": dmig(deck), "joint_celas2.bdf": celas2(deck)}
    if deck.pairs.lumped:
        out["joint_cbush.bdf"] = cbush(deck)
    return out


def card(name: str, *values: Field) -> list[str]:
    """One card in fields of 16 columns, four in each line."""
    words = [real(v, 16) if isinstance(v, float) else str(v) for v in values]
    rows = [words[k : k + 4] for k in range(0, len(words), 4)]
    return [
        f"{name + '*' if k == 0 else '*':<8}" + "".join(f"{word:<16}" for word in row).rstrip()
        for k, row in enumerate(rows)
    ]


def cbush(deck: JointDeck) -> str:
    """Write CBUSH elements in coordinate systems of the face: direction 1 is the normal. Raises as `NodePairs.own`."""
    k, lost = deck.pairs.own(deck.stiffness), deck.pairs.own(deck.loss)
    ratio = np.divide(lost, k, out=np.zeros_like(k), where=k != 0)
    dampers = deck.pairs.own(deck.dampers) if deck.paper and deck.dampers is not None else np.zeros_like(k)
    said = (
        deck.damping_said()
        if dampers.any()
        else "GE of directions 1, 2, 3; a solver that reads one GE takes that of the normal"
    )
    lines = deck.header("$", said)
    axes, frame = grouped(deck.axes)
    number = deck.first_element
    for g, leader in enumerate(axes):
        n, _, t2 = (tuple(float(x) for x in row) for row in deck.axes[leader])
        lines += card("CORD2R", number + g, 0, 0.0, 0.0, 0.0, *t2, *n)
    size = np.abs(k).max()
    first, alike = grouped(np.column_stack([k / size, ratio, dampers / max(dampers.max(), 1e-300)]))
    for g, leader in enumerate(first):
        words: list[Field] = [number + g, "K", *map(float, k[leader]), "", "", ""]
        if dampers[leader].any():
            words += ["", "B", *map(float, dampers[leader]), "", "", ""]
        elif ratio[leader].any():
            words += ["", "GE", *map(float, ratio[leader]), "", "", ""]
        lines += card("PBUSH", *words)
    for i, (one, two) in enumerate(zip(*deck.ends, strict=True)):
        lines += card(
            "CBUSH", number + i, number + int(alike[i]), int(one), int(two), "", "", "", number + int(frame[i])
        )
    return "\n".join(lines) + "\n"


def celas2(deck: JointDeck) -> str:
    """Write CELAS2 elements in the basic axes; what an inclined face couples becomes springs that cancel on the diagonal.

    Grids must have their displacements in the basic axes (CD = 0). Raises InputError where a spring that couples has a
    loss factor of another sign than its stiffness.
    """
    said = (
        deck.damping_said()
        if deck.paper
        else "loss factors in GE; springs in the basic axes: leave CD of the grids blank"
    )
    lines = deck.header("$", said)
    number = deck.first_element
    grids = deck.ends
    lost = springs_of(deck.loss, deck.stiffness)
    for (a, c, b, d, values), (*_, loss) in zip(springs_of(deck.stiffness), lost, strict=True):
        for i in np.flatnonzero((values != 0) | (loss != 0)):
            if values[i] == 0:
                raise InputError("a spring with loss but no stiffness has no loss factor; take matrix or dmig")
            factor = 0.0 if deck.paper else float(loss[i] / values[i])
            lines += card(
                "CELAS2",
                number,
                float(values[i]),
                int(grids[a][i]),
                c + 1,
                int(grids[b][i]),
                d + 1,
                *([factor] if factor else []),
            )
            number += 1
    if deck.paper and deck.dampers is not None:
        for a, c, b, d, values in springs_of(deck.dampers):
            for i in np.flatnonzero(values):
                lines += card("CDAMP2", number, float(values[i]), int(grids[a][i]), c + 1, int(grids[b][i]), d + 1)
                number += 1
    return "\n".join(lines) + "\n"


def dmig(deck: JointDeck) -> str:
    """Write the joint as DMIG matrices KJOINT and, for the loss, K4JOINT (structural) or BJOINT (viscous)."""
    chosen = ["case control: K2GG = KJOINT"]
    bulk = _dmig("KJOINT", deck, deck.stiffness)
    if deck.paper and deck.dampers is not None:
        chosen += ["case control: B2GG = BJOINT", deck.damping_said()]
        bulk += _dmig("BJOINT", deck, deck.dampers)
    elif np.any(deck.loss):
        chosen.append("case control: K42GG = K4JOINT, the loss as a structural damping matrix")
        bulk += _dmig("K4JOINT", deck, deck.loss)
    return "\n".join([*deck.header("$", *chosen), *bulk]) + "\n"


def _dmig(name: str, deck: JointDeck, blocks: Array) -> list[str]:
    from scipy.sparse import tril

    lower = tril(deck.pairs.matrix(blocks)).tocsc()
    n = deck.mesh.numbers
    lines = card("DMIG", name, 0, 6, 2, 0)
    for j in np.flatnonzero(np.diff(lower.indptr)):
        here = slice(lower.indptr[j], lower.indptr[j + 1])
        words: list[Field] = [name, int(n[j // 3]), int(j % 3 + 1), ""]
        for i, v in zip(lower.indices[here], lower.data[here], strict=True):
            if v:
                words += [int(n[i // 3]), int(i % 3 + 1), float(v), ""]
        if len(words) > 4:
            lines += card("DMIG", *words)
    return lines
