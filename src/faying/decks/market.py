"""Matrices between points as Matrix Market files, for what reads matrices and no decks; APDL Math of MAPDL is one."""

from io import BytesIO

import numpy as np

from faying.decks.deck import CondensedDeck


def condensed(deck: CondensedDeck) -> dict[str, str]:
    """Matrices in the deck's units, and dofs.txt, "node.direction" of each row, by name; a mode is direction 1."""
    from scipy.io import mmwrite
    from scipy.sparse import coo_array

    matrices = {"stiffness": deck.stiffness, "mass": deck.mass, "loss": deck.loss if np.any(deck.loss) else None}
    out = {"dofs.txt": "".join(f"{node}.{max(direction, 1)}\n" for node, direction in deck.entries)}
    for name, matrix in matrices.items():
        if matrix is not None:
            file, values = BytesIO(), coo_array(deck.in_units(matrix))
            mmwrite(file, values, comment=f"{name}\n" + "\n".join(deck.facts), precision=17, symmetry="symmetric")
            out[f"{name}.mtx"] = file.getvalue().decode()
    return out
