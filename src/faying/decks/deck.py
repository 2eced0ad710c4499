"""What every exporter gets: the pairs of one joint, the node numbers of the model, and what its header says."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from faying.decks.system import UnitSystem
from faying.errors import InputError
from faying.fe.mesh import Mesh
from faying.joint.pairs import NodePairs
from faying.typing import Array, Index

SAME = 1e-10  # of the largest: springs that differ by less share one property
NOTHING = 1e-14  # of the largest of a block: entries below it are rounding


@dataclass(frozen=True, kw_only=True)
class ContactProperty:
    """The law as a contact property.

    Pressure [Pa] against approach [m], k_n, k_t [Pa/m] and loss factor at the mean pressure.

    friction: coefficient [-]; given: whether the study says it.
    """

    approach: Array
    pressure: Array
    k_n: float
    k_t: float
    loss_n: float
    mean_pressure: float
    friction: float
    given: bool

    @property
    def friction_note(self) -> str:
        """The coefficient of friction in words, with a warning where the study does not say it."""
        return f"friction {self.friction:g}" + ("" if self.given else ", not given by the study: check it")


@dataclass(frozen=True, kw_only=True)
class JointDeck:
    """One joint, ready to be written.

    pairs: its springs; mesh: of the model, with its node numbers; faces: their names; facts: lines for the header;
    viscous [N s/m] (p, 3, 3): dampers, None where no frequency is given; paper: they are the JK paper's; first_element:
    the number from which elements are numbered; contact: None where the law gives no curve.
    """

    pairs: NodePairs
    mesh: Mesh
    faces: tuple[str, str]
    system: UnitSystem
    facts: tuple[str, ...]
    viscous: Array | None = None
    paper: bool = False
    frequency: float | None = None
    first_element: int = 1
    contact: ContactProperty | None = None

    @property
    def ends(self) -> tuple[Index, Index]:
        """Node numbers of both ends of each pair."""
        return self.mesh.numbers[self.pairs.first], self.mesh.numbers[self.pairs.second]

    @property
    def entries(self) -> Index:
        """Node and direction, from 1, of each row of the model's matrix (n, 2)."""
        numbers = self.mesh.numbers
        return np.column_stack([np.repeat(numbers, 3), np.tile([1, 2, 3], len(numbers))])

    @property
    def axes(self) -> Array:
        """Normal and tangents of the pairs (p, 3, 3), without the rounding of zeros."""
        return np.round(self.pairs.frames, 15) + 0.0

    @property
    def stiffness(self) -> Array:
        """Stiffness of the pairs in the deck's units (p, 3, 3)."""
        return _clean(self.pairs.stiffness) * self.system.stiffness

    @property
    def loss(self) -> Array:
        """Imaginary part of the stiffness in the deck's units (p, 3, 3)."""
        return _clean(self.pairs.loss) * self.system.stiffness

    @property
    def uncoupled(self) -> bool:
        """Whether every pair acts along its own axes, so that it can be turned into them."""
        try:
            self.pairs.own(self.pairs.stiffness)
        except InputError:
            return False
        return True

    @property
    def dampers(self) -> Array | None:
        """Dampers in the deck's units (p, 3, 3); None where there are none."""
        if self.viscous is None or not np.any(self.viscous):
            return None
        return _clean(self.viscous) * self.system.stiffness

    def header(self, mark: str, *more: str) -> list[str]:
        """Comment lines: the facts of the joint and the notes of this form, cut to 100 columns."""
        return comments(mark, *self.facts, *more)

    def damping_note(self) -> str:
        """A sentence on the dampers of a form that takes no loss factor."""
        if self.viscous is None:
            return (
                "no dampers: this form takes no loss factor, and no frequency was given at which viscous dampers "
                'c = eta k/omega stand for it (--frequency "500 Hz")'
            )
        if self.paper:
            return (
                "dampers after the JK paper, c = eta sqrt(M k) pair by pair, M the whole mass: their sum grows with "
                "the square root of the number of pairs, so the damping depends on the mesh"
            )
        return f"dampers c = eta k/omega, right at {self.frequency:g} Hz: loss grows with frequency beyond it"


def comments(mark: str, *texts: str) -> list[str]:
    """Comment lines after a mark, cut to 100 columns."""
    out = []
    for text in texts:
        line = mark
        for word in text.split():
            if len(line) + len(word) > 100:
                out.append(line)
                line = mark + "  "
            line += " " + word
        out.append(line)
    return out


@dataclass(frozen=True, kw_only=True)
class CondensedDeck:
    """A joint as one matrix between two points, ready to be written.

    points (2, 3) [m]; nodes: their numbers; element: number of the element or property; stiffness and loss, its
    imaginary part (12, 12) [N/m, N, N m]: three translations and three rotations of the first point, then of the
    second, in the axes of the model; facts: lines for the header.
    """

    points: Array
    nodes: tuple[int, int]
    element: int
    stiffness: Array
    loss: Array
    system: UnitSystem
    facts: tuple[str, ...]

    def in_units(self, matrix: Array) -> Array:
        """A matrix (12, 12) in the deck's units, without the rounding of zeros."""
        size = np.sqrt(np.maximum(np.diag(self.stiffness), 0.0))
        clean = np.where(np.abs(matrix) > NOTHING * np.outer(size, size), matrix, 0.0)
        lengths = np.tile(np.repeat([self.system.metre, 1.0], 3), 2)
        return np.asarray(clean * self.system.newton * self.system.metre / np.outer(lengths, lengths))

    @property
    def places(self) -> Array:
        """Coordinates of both points (2, 3) in the deck's unit."""
        return np.asarray(self.points * self.system.metre)

    @property
    def entries(self) -> Index:
        """Node and direction, from 1, of each row (12, 2)."""
        return np.column_stack([np.repeat(self.nodes, 6), np.tile(np.arange(1, 7), 2)])


def _clean(blocks: Array) -> Array:
    """Blocks (p, 3, 3) without the rounding that turning leaves where a face lies along an axis."""
    size = np.abs(blocks).max(axis=(1, 2), keepdims=True)
    return np.where(np.abs(blocks) > NOTHING * size, blocks, 0.0)


def grouped(values: Array) -> tuple[Index, Index]:
    """Rows (p, ...) that agree to rounding: which row stands for each group, and the group of each row."""
    flat = values.reshape(len(values), -1)
    scale = max(float(np.abs(flat).max()), 1e-300) if flat.size else 1.0
    _, first, group = np.unique(np.round(flat / (scale * SAME)), axis=0, return_index=True, return_inverse=True)
    return first, group.ravel()


def springs_of(blocks: Array, like: Array | None = None) -> list[tuple[int, int, int, int, Array]]:
    """Springs between single directions that add up to the blocks (p, 3, 3) of pairs.

    Rows of (end, direction, end, direction, stiffness (p,)): ends 0 and 1, directions 0 to 2. What couples two
    directions becomes four springs whose diagonals cancel; where no block does, only the three of like directions are
    left. like: blocks that decide which are left, in place of these.
    """
    judge = blocks if like is None else like
    out = [(0, c, 1, c, blocks[:, c, c]) for c in range(3)]
    for c in range(3):
        for d in range(c):
            if np.any(np.abs(judge[:, c, d]) > NOTHING * np.abs(judge).max()):
                cross = blocks[:, c, d]
                out += [(0, c, 1, d, cross), (0, d, 1, c, cross), (0, c, 0, d, -cross), (1, c, 1, d, -cross)]
    return out


def real(value: float, width: int) -> str:
    """Write a number with a decimal point in at most `width` columns, as exactly as they and 17 digits allow."""
    digits = min(16, width - 6 - (value < 0))
    text = f"{value:.{digits}E}"
    return text if len(text) <= width else f"{value:.{digits - 1}E}"


def reals(values: Iterable[float], mark: str = ",", width: int = 20) -> str:
    """Write numbers as `real` does, with a mark between them."""
    return mark.join(real(float(value), width) for value in values)
