"""What every exporter gets: the pairs of one joint, the numbers and units of the model, and what its header says."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import TextWrapper

import numpy as np

from faying import units
from faying.decks.programs import CONDENSED, REDUCED, module_of
from faying.decks.programs import SOLVERS as SOLVERS
from faying.errors import InputError
from faying.fe.mesh import Mesh
from faying.files import together, write_text
from faying.joint.pairs import NodePairs
from faying.typing import Array, Index


@dataclass(frozen=True)
class UnitSystem:
    """Units of a deck, such as mm and N, from which MPa, tonne and N s/mm follow."""

    length: str
    force: str = "N"

    @property
    def metre(self) -> float:
        """How many of the length one metre is [-]."""
        return 1 / units.scale(self.length, "m", name="unit of length")

    @property
    def newton(self) -> float:
        """How many of the force one newton is [-]."""
        return 1 / units.scale(self.force, "N", name="unit of force")

    @property
    def stiffness(self) -> float:
        """Factor from N/m; the same from N s/m."""
        return self.newton / self.metre

    @property
    def pressure(self) -> float:
        """Factor from Pa."""
        return self.newton / self.metre**2

    @property
    def density(self) -> float:
        """Factor from Pa/m, a stiffness per area."""
        return self.newton / self.metre**3

    @property
    def mass(self) -> float:
        """Factor from kg."""
        return self.newton / self.metre

    def describe(self) -> str:
        """One line for a deck."""
        mass = {("mm", "N"): " (tonne)", ("m", "N"): " (kg)"}.get((self.length, self.force), "")
        return (
            f"units: {self.length}, {self.force}, s; mass {self.force} s2/{self.length}{mass}; stiffness {self.force}/"
            f"{self.length}; stress {self.force}/{self.length}2"
        )


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
    viscous [N s/m] (p, 3, 3): dampers, None where no frequency is given; first_element:
    the number from which elements are numbered; contact: None where the law gives no curve.
    """

    pairs: NodePairs
    mesh: Mesh
    faces: tuple[str, str]
    system: UnitSystem
    facts: tuple[str, ...]
    viscous: Array | None = None
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
        """Comment lines: the facts of the joint and the notes of this form."""
        return comments(mark, *self.facts, *more)

    def own(self) -> tuple[Array, Array]:
        """Stiffness and loss (p, 3) along the pairs' own axes; InputError as `NodePairs.own`."""
        return self.pairs.own(self.stiffness), self.pairs.own(self.loss)

    def damping_note(self) -> str:
        """A sentence on the dampers of a form that takes no loss factor."""
        if self.viscous is None:
            return (
                "no dampers: this form takes no loss factor, and no frequency was given at which viscous dampers "
                'c = eta k/omega stand for it (--frequency "500 Hz")'
            )
        return f"dampers c = eta k/omega, right at {self.frequency:g} Hz: loss grows with frequency beyond it"


def comments(mark: str, *texts: str) -> list[str]:
    """Comment lines after a mark, of at most 101 columns."""
    fold = TextWrapper(101, f"{mark} ", f"{mark}   ", break_long_words=False, break_on_hyphens=False)
    return [line for text in texts for line in fold.wrap(text)]


@dataclass(frozen=True, kw_only=True)
class CondensedDeck:
    """A joint or a structure as matrices between points, ready to be written.

    points (p, 3) [m]; nodes (p,): their numbers; element: number of the element or property; entries (n, 2): node and
    direction of each row, three translations and three rotations in the axes of the model, or a number of its own and 0
    for a mode; stiffness, loss, its imaginary part, and mass, None for a joint (n, n) [N/m, N, N m; kg, kg m, kg m2],
    of modes normalised to 1 kg; facts: lines for the header; name: of the files.
    """

    points: Array
    nodes: Sequence[int]
    element: int
    entries: Index
    stiffness: Array
    loss: Array
    mass: Array | None = None
    system: UnitSystem
    facts: tuple[str, ...]
    name: str = "condensed"

    def in_units(self, matrix: Array) -> Array:
        """A matrix (n, n) in the deck's units, without the rounding of zeros; modes keep their mass."""
        size = np.sqrt(np.abs(np.diag(matrix)))
        clean = np.where(np.abs(matrix) > NOTHING * np.outer(size, size), matrix, 0.0)
        energy, direction = self.system.newton * self.system.metre, self.entries[:, 1]
        lengths = np.select([direction == 0, direction < 4], [np.sqrt(energy), self.system.metre], 1.0)
        return np.asarray(clean * energy / np.outer(lengths, lengths))

    @property
    def places(self) -> Array:
        """Coordinates of the points (p, 3) in the deck's unit."""
        return np.asarray(self.points * self.system.metre)

    @property
    def modes(self) -> list[int]:
        """Numbers of the modes."""
        return [int(node) for node, direction in self.entries if direction == 0]


def six_each(nodes: Sequence[int]) -> Index:
    """Node and direction, from 1 to 6, of each row of a matrix between nodes (6 p, 2)."""
    return np.column_stack([np.repeat(nodes, 6), np.tile(np.arange(1, 7), len(nodes))])


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


def members(group: Index) -> list[Index]:
    """The rows of each group, in their order; group: of each row, as `grouped` counts them."""
    return np.split(np.argsort(group, kind="stable"), np.cumsum(np.bincount(group))[:-1])


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
    """Write a condensed joint or a superelement for `solver`. Raises InputError for one that takes no such matrix."""
    what, known = ("matrix between two points with rotations", CONDENSED) if deck.mass is None else (deck.name, REDUCED)
    if solver not in known:
        more = f". faying attach writes the springs of the joint for {', '.join(SOLVERS)}" if deck.mass is None else ""
        raise InputError(f"{solver!r} has no exporter for a {what}; take one of {', '.join(known)}{more}")
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
