"""A joint as springs between pairs of nodes: what solvers take that know no springs per area."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from faying.errors import InputError
from faying.fe.interface import Interface
from faying.typing import Array, Index, Mask

ROUNDING = 1e-9  # of the largest entry of a block: below it a coupling between axes is rounding


@dataclass(frozen=True, kw_only=True)
class NodePairs:
    """Springs between two nodes each, all of them together the stiffness of a joint.

    first, second: the nodes (p,); frames (p, 3, 3): rows are the normal from the first face to the second and two
    tangents; stiffness and loss, its imaginary part [N/m] (p, 3, 3), in the axes of the model: a pair adds
    [[B, -B], [-B, B]] to the matrix. area: share of each pair [m2] (p,); pressure [Pa] (p,); both are NaN where
    `lumped` is False. across (p,): the pair links one face with the other; pairs within a face correct those.
    """

    first: Index
    second: Index
    frames: Array
    stiffness: Array
    loss: Array
    area: Array
    pressure: Array
    across: Mask
    unknowns: int
    lumped: bool

    def __len__(self) -> int:
        return len(self.first)

    def matrix(self, blocks: Array | None = None) -> Any:
        """Sparse matrix (unknowns, unknowns) of the pairs; blocks (p, 3, 3): the stiffness [N/m] unless given."""
        from scipy.sparse import coo_array

        block = self.stiffness if blocks is None else blocks
        axes = np.arange(3)
        a, b = 3 * self.first[:, None] + axes, 3 * self.second[:, None] + axes
        rows, columns, values = [], [], []
        for i, j, sign in ((a, a, 1.0), (b, b, 1.0), (a, b, -1.0), (b, a, -1.0)):
            rows.append(np.broadcast_to(i[:, :, None], block.shape).ravel())
            columns.append(np.broadcast_to(j[:, None, :], block.shape).ravel())
            values.append(sign * block.ravel())
        return coo_array(
            (np.concatenate(values), (np.concatenate(rows), np.concatenate(columns))),
            shape=(self.unknowns, self.unknowns),
        ).tocsr()

    def own(self, blocks: Array) -> Array:
        """Blocks (p, 3, 3) along the normal and the two tangents of each pair (p, 3).

        Raises InputError where they couple these axes, as the consistent springs of a curved face do.
        """
        turned = self.frames @ blocks @ self.frames.transpose(0, 2, 1)
        along = np.einsum("pii->pi", turned).copy()
        rest = np.abs(turned - along[:, :, None] * np.eye(3)).max() if len(turned) else 0.0
        if rest > ROUNDING * max(float(np.abs(turned).max()), 1e-300):
            raise InputError(
                "the springs of a curved face do not act along one normal; take them node by node "
                "(coupling nodes), or a form that couples all directions: matrix27, matrix, dmig, celas2"
            )
        return np.asarray(along)

    def totals(self) -> tuple[float, float]:
        """Sum of all normal and all tangential springs [N/m], along the mean normal and across it."""
        total = self.stiffness[self.across].sum(axis=0)
        normal = (self.frames[:, 0] * np.abs(np.einsum("pii->p", self.stiffness))[:, None])[self.across].sum(axis=0)
        if not np.any(normal):  # no pressure, no stiffness
            return 0.0, 0.0
        normal /= np.linalg.norm(normal)
        along = float(normal @ total @ normal)
        return along, (float(np.trace(total)) - along) / 2


def lumped(nodes: Interface, springs: tuple[Array, Array, Array, Array], pressure: Array) -> NodePairs:
    """Return a spring for each pair of nodes that face each other.

    nodes: what `Interface.at_nodes` gives: shares of the area after the diagonal of the consistent mass of the face,
    all positive (HRZ, doi:10.1002/eqe.4290040305), that sum to the area; springs: k_n, k_t [Pa/m] and loss factors [-]
    at these nodes (p,), at the pressure [Pa] (p,) given.
    """
    k_n, k_t, loss_n, loss_t = springs
    frames, area = nodes.frames, nodes.weights
    own = area[:, None] * np.stack([k_n, k_t, k_t], axis=1)
    lost = own * np.stack([loss_n, loss_t, loss_t], axis=1)
    return NodePairs(
        first=nodes.first_nodes[:, 0],
        second=nodes.second_nodes[:, 0],
        frames=frames,
        stiffness=np.einsum("pik,pi,pil->pkl", frames, own, frames),
        loss=np.einsum("pik,pi,pil->pkl", frames, lost, frames),
        area=area,
        pressure=pressure,
        across=np.ones(len(area), dtype=bool),
        unknowns=nodes.unknowns,
        lumped=True,
    )


def consistent(interface: Interface, springs: tuple[Array, Array, Array, Array]) -> NodePairs:
    """Return the springs per area of a joint, matched or not, as springs between all nodes that share an overlap.

    A matrix whose blocks in each row sum to zero, as that of springs per area does, is a sum of springs between two
    nodes, each the negative of one off-diagonal block; so nothing is lost. Those within one face are negative. springs:
    k_n, k_t [Pa/m] and loss factors [-] at the points of the interface (q,).
    """
    k_n, k_t, loss_n, loss_t = springs
    full, lost = interface.springs(k_n, k_t), interface.springs(k_n * loss_n, k_t * loss_t)
    first, second, blocks = _blocks(full)
    _, _, lossy = _blocks(full * 0.0 + lost, (first, second))
    near = np.unique(interface.first_nodes[interface.first_values != 0])
    one, two = np.isin(first, near), np.isin(second, near)
    swap = two & ~one
    first, second = np.where(swap, second, first), np.where(swap, first, second)
    nothing = np.full(len(first), np.nan)
    return NodePairs(
        first=first,
        second=second,
        frames=_nearest_frames(interface, first),
        stiffness=-blocks,
        loss=-lossy,
        area=nothing,
        pressure=nothing,
        across=one != two,
        unknowns=interface.unknowns,
        lumped=False,
    )


def _blocks(matrix: Any, wanted: tuple[Index, Index] | None = None) -> tuple[Index, Index, Array]:
    """Blocks of 3 x 3 above the diagonal: nodes of row and column, and values (p, 3, 3)."""
    entries = matrix.tocoo()
    n = matrix.shape[0] // 3
    row, column = entries.row // 3, entries.col // 3
    key = row * n + column
    keep = row < column
    keys = np.unique(key[keep]) if wanted is None else wanted[0] * n + wanted[1]
    keep &= np.isin(key, keys)
    blocks = np.zeros((len(keys), 3, 3))
    np.add.at(
        blocks, (np.searchsorted(keys, key[keep]), entries.row[keep] % 3, entries.col[keep] % 3), entries.data[keep]
    )
    return keys // n, keys % n, blocks


def _nearest_frames(interface: Interface, first: Index) -> Array:
    """Frame of a point of the interface that each pair shares, or of any point on a flat joint."""
    frames = interface.frames
    if np.abs(interface.normals - interface.normals[0]).max() < ROUNDING:
        return np.broadcast_to(frames[0], (len(first), 3, 3)).copy()
    place: dict[int, int] = {}
    for nodes in (interface.first_nodes, interface.second_nodes):
        for point, row in enumerate(nodes):
            for node in row:
                place.setdefault(int(node), point)
    return np.asarray(frames[[place[int(node)] for node in first]])
