"""Code_Aster: the whole mesh with the joint's SEG2 cells, and the commands that give them stiffness and loss.

After the documents U3.01.00 (mesh file .mail) and U4.42.01 (AFFE_CARA_ELEM): DISCRET with K_T_D_L, three values along
the axes that ORIENTATION gives by VECT_X_Y, and AMOR_HYST, one loss factor for a cell; hence two cells for each pair,
one along the normal and one across it. Not run: read back in the tests by a reader of that grammar.
"""

import numpy as np

from faying.decks.deck import JointDeck, grouped, real, reals
from faying.decks.raw import UPRIGHT_FIRST
from faying.fe.mesh import Mesh
from faying.fe.solids import kind_of
from faying.typing import Array, Index

CELLS = {
    "tet4": "TETRA4",
    "tet10": "TETRA10",
    "hex8": "HEXA8",
    "hex20": "HEXA20",
    "wedge6": "PENTA6",
    "wedge15": "PENTA15",
}


def decks(deck: JointDeck) -> dict[str, str]:
    """Mesh (.mail) and commands (.comm), by name."""
    axes, frame = grouped(deck.axes)
    k, lost = deck.own()
    part = np.array([[1.0, 0, 0], [0, 1, 1]])  # along the normal, across it
    rows = np.concatenate([np.column_stack([frame, k * p, lost * p]) for p in part])
    scale = np.maximum(np.abs(rows).max(axis=0), 1e-300)
    first, group = grouped(rows / scale)
    return {
        "model.mail": mesh(deck, len(first), group, len(axes), np.tile(frame, 2)),
        "joint.comm": commands(deck, rows[first], axes),
    }


def _wrapped(words: list[str]) -> list[str]:
    return [" ".join(words[i : i + 7]) for i in range(0, len(words), 7)]


def mesh(deck: JointDeck, sets: int, group: Index, frames: int, frame: Index) -> str:
    """Write nodes, solids by part, faces as groups of nodes, and the cells of the joint: JK<set>, axes JX<frame>."""
    model: Mesh = deck.mesh
    n = model.numbers
    lines = ["TITRE", *deck.header(""), "FINSF", "COOR_3D"]
    lines += [f"N{i} " + reals(p, " ", 23) for i, p in zip(n, model.points * deck.system.metre, strict=True)]
    lines.append("FINSF")
    number, members = 0, {}
    for part, blocks in model.parts.items():
        start = number
        for cells in blocks:
            lines.append(CELLS[kind_of(cells)])
            for cell in cells[:, UPRIGHT_FIRST.get(cells.shape[1], slice(None))]:
                number += 1
                lines += _wrapped([f"M{number}", *(f"N{n[i]}" for i in cell)])
            lines.append("FINSF")
        members[part] = [f"M{i + 1}" for i in range(start, number)]
    lines.append("SEG2")
    one, two = (np.tile(end, 2) for end in deck.ends)
    lines += [f"J{i + 1} N{a} N{b}" for i, (a, b) in enumerate(zip(one, two, strict=True))]
    lines.append("FINSF")
    cells_of = {f"JK{s + 1}": np.flatnonzero(group == s) for s in range(sets)}
    cells_of |= {f"JX{s + 1}": np.flatnonzero(frame == s) for s in range(frames)}
    cells_of["JOINT"] = np.arange(len(group))
    members |= {name: [f"J{i + 1}" for i in some] for name, some in cells_of.items()}
    for name, some in members.items():
        lines += ["GROUP_MA", name[:24], *_wrapped(some), "FINSF"]
    for name in model.faces:
        lines += ["GROUP_NO", name[:24], *_wrapped([f"N{n[i]}" for i in model.face_nodes(name)]), "FINSF"]
    return "\n".join([*lines, "FIN"]) + "\n"


def commands(deck: JointDeck, sets: Array, axes: Index) -> str:
    """Write AFFE_MODELE and AFFE_CARA_ELEM of the joint.

    sets (s, 7): frame, then k and loss along three axes.
    """
    lines = deck.header(
        "#",
        "loss factors in AMOR_HYST: CALC_MODES takes them through RIGI_MECA_HYST",
        "mesh: LIRE_MAILLAGE(FORMAT='ASTER') of model.mail; JK<n> are springs, JX<n> their axes",
    )
    lines += [
        "MODELE = AFFE_MODELE(MAILLAGE=MAIL, AFFE=(",
        "    _F(TOUT='OUI', PHENOMENE='MECANIQUE', MODELISATION='3D'),",
        "    _F(GROUP_MA='JOINT', PHENOMENE='MECANIQUE', MODELISATION='DIS_T')))",
        "CARA = AFFE_CARA_ELEM(MODELE=MODELE, DISCRET=(",
    ]
    for s, row in enumerate(sets, 1):
        k, lost = row[1:4], row[4:]
        factor = float(lost.sum() / k.sum()) if k.sum() else 0.0
        hysteretic = f", AMOR_HYST={real(factor, 20)}" if factor else ""
        lines.append(f"    _F(GROUP_MA='JK{s}', REPERE='LOCAL', CARA='K_T_D_L', VALE=({reals(k, ', ')}){hysteretic}),")
    lines.append("    _F(GROUP_MA='JOINT', REPERE='GLOBAL', CARA='M_T_D_L', VALE=0.0)),")
    lines.append("  ORIENTATION=(")
    for s, leader in enumerate(axes, 1):
        lines.append(f"    _F(GROUP_MA='JX{s}', CARA='VECT_X_Y', VALE=({reals(deck.axes[leader, :2].ravel(), ', ')})),")
    return "\n".join([*lines, "  ))"]) + "\n"
