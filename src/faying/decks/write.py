"""All decks of one solver into a folder, whole or not at all, with the pairs as a table beside them."""

from pathlib import Path

import numpy as np

from faying.decks.deck import CondensedDeck, JointDeck
from faying.decks.programs import CONDENSED, module_of
from faying.decks.programs import SOLVERS as SOLVERS
from faying.errors import InputError
from faying.files import together, write_text


def write(deck: JointDeck, solver: str, folder: Path) -> list[Path]:
    """Write the decks of `solver` and joint_pairs.csv (SI units). Raises InputError for a solver that is not known."""
    if solver not in SOLVERS:
        raise InputError(f"no exporter for {solver!r}; give one of {', '.join(SOLVERS)}")
    ends = np.union1d(deck.pairs.first, deck.pairs.second)
    turned = ends[deck.mesh.turned[ends]] if deck.mesh.turned is not None else ends[:0]
    if len(turned):
        raise InputError(
            f"{len(turned)} nodes of the joint have directions of their own in the model, node "
            f"{deck.mesh.numbers[turned[0]]} "
            "for one (CD, *TRANSFORM); a joint acts in the directions of the model: take these out"
        )
    texts: dict[str, str] = module_of(solver).decks(deck)
    texts["joint_pairs.csv"] = pairs_csv(deck)
    return _written(texts, folder)


def write_condensed(deck: CondensedDeck, solver: str, folder: Path) -> list[Path]:
    """Write a condensed joint for `solver`. Raises InputError for one that takes no such matrix."""
    if solver not in CONDENSED:
        raise InputError(
            f"{solver!r} has no exporter for a matrix between two points with rotations; take one of "
            f"{', '.join(CONDENSED)}. faying attach writes the springs of the joint for {', '.join(SOLVERS)}"
        )
    return _written(module_of(solver).condensed(deck), folder)


def _written(texts: dict[str, str], folder: Path) -> list[Path]:
    with together(folder, "give another (--out)") as hidden:
        for name, text in texts.items():
            write_text(hidden / name, text)
    return [folder / name for name in texts]


def pairs_csv(deck: JointDeck) -> str:
    """Write the pairs: nodes, share of the area, pressure, k_n, k_t, loss factors, normal; SI units."""
    pairs = deck.pairs
    one, two = deck.ends
    head = "node a,node b,x [m],y [m],z [m],area [m^2],pressure [Pa],k_n [N/m],k_t [N/m],loss_n,loss_t,nx,ny,nz"
    along = np.einsum("pi,pij,pj->p", pairs.frames[:, 0], pairs.stiffness, pairs.frames[:, 0])
    across = (np.einsum("pii->p", pairs.stiffness) - along) / 2
    lost_n = np.einsum("pi,pij,pj->p", pairs.frames[:, 0], pairs.loss, pairs.frames[:, 0])
    lost_t = (np.einsum("pii->p", pairs.loss) - lost_n) / 2
    with np.errstate(invalid="ignore", divide="ignore"):
        loss = np.nan_to_num(np.column_stack([lost_n / along, lost_t / across]))
    table = np.column_stack(
        [deck.mesh.points[pairs.first], pairs.area, pairs.pressure, along, across, loss, pairs.frames[:, 0]]
    )
    rows = (f"{a},{b}," + ",".join(f"{v:.10g}" for v in row) for a, b, row in zip(one, two, table, strict=True))
    return "\n".join([*(f"# {fact}" for fact in deck.facts), head, *rows]) + "\n"
