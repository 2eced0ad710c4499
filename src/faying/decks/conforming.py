"""Parts of a file that share nodes: one body where no face is named between them, and apart where faces are."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from itertools import combinations

import numpy as np

from faying.decks.raw import joined
from faying.errors import InputError
from faying.fe.sides import Blocks, nodes_of, side_key, skin
from faying.fe.solids import bodies_of
from faying.typing import Index

LISTED = 4  # pairs of parts that a note names


@dataclass(frozen=True)
class Bodies:
    """Which parts are one body, as the nodes of the file have it.

    Args:
        pairs: parts that share sides of elements where no face is named.
        place: the body of each part, from 0.
        shared: number of nodes of each pair that both parts have.
        sides: name of each face between parts of one body, with its part and the sides.
    """

    pairs: tuple[tuple[str, str], ...]
    place: Mapping[str, int]
    shared: tuple[int, ...]
    sides: Mapping[str, tuple[str, Blocks]] = field(default_factory=dict)

    def keys(self, blocks: Mapping[str, Blocks], nodes: int) -> Index:
        """One number for each node of each body."""
        return np.unique(np.concatenate([self.place[part] * nodes + nodes_of(some) for part, some in blocks.items()]))

    @property
    def text(self) -> str:
        """What there is to say of them; "" where no parts share nodes."""
        if not self.pairs:
            return ""
        some = [
            f"{a!r} and {b!r} ({count} nodes)" for (a, b), count in zip(self.pairs[:LISTED], self.shared, strict=False)
        ]
        more = f" and {len(self.pairs) - LISTED} more pairs" if len(self.pairs) > LISTED else ""
        return (
            f"parts that share nodes are one body, as in the file: {', '.join(some)}{more}; the sides between "
            "them are called PART.OTHER; where they only touch, name the face of the joint on both sides in the file"
        )


def bodies(
    blocks: Mapping[str, Blocks], faces: Mapping[str, Blocks], face_part: Mapping[str, str], nodes: int
) -> Bodies:
    """Tell which parts are one body.

    Two parts that share sides of elements are one, unless a face is named on these sides: then they are a joint. A face
    that is the whole skin of its part names none of its sides.
    """
    names = list(blocks)
    pairs: list[tuple[str, str]] = []
    counts: list[int] = []
    own = {part: nodes_of(some) for part, some in blocks.items()}
    every = np.concatenate(list(own.values()))
    if len(np.unique(every)) == len(every):
        return Bodies((), {part: k for k, part in enumerate(names)}, ())
    outer = {part: skin(some, nodes) for part, some in blocks.items()}
    skins = {part: keys_of(some, nodes) for part, some in outer.items()}
    sides: dict[str, tuple[str, Blocks]] = {}
    named: dict[str, list[Index]] = {part: [] for part in names}
    for face, some in faces.items():
        key = keys_of(some, nodes)
        if len(key) < len(skins[face_part[face]]):
            named[face_part[face]].append(key)
    for a, b in combinations(names, 2):
        met = np.intersect1d(skins[a], skins[b])
        if len(met) and not np.isin(met, joined([*named[a], *named[b]])).any():
            pairs.append((a, b))
            counts.append(len(np.intersect1d(own[a], own[b])))
            for one, two in ((a, b), (b, a)):
                sides[f"{one}.{two}"] = one, among(outer[one], met, nodes)
    place = {part: k for k, body in enumerate(bodies_of(names, pairs)) for part in body}
    return Bodies(tuple(pairs), place, tuple(counts), {name: one for name, one in sides.items() if name not in faces})


def check_apart(
    name: str,
    blocks: Mapping[str, Blocks],
    faces: Mapping[str, Blocks],
    owners: tuple[Mapping[str, str], Bodies],
    numbers: Index,
) -> None:
    """Raise InputError where bodies share nodes that lie on no named face.

    Args:
        name: of the file.
        blocks, faces: of each part; the faces by their names.
        owners: the part of each face, and the bodies.
        numbers: of the nodes in the file (n,).
    """
    face_part, found = owners
    n = len(numbers)
    key = found.keys(blocks, n)
    node, count = np.unique(key % n, return_counts=True)
    shared = node[count > 1]
    if not len(shared):
        return
    on = [found.place[face_part[label]] * n + nodes_of(some) for label, some in faces.items()]
    loose = key[np.isin(key % n, shared) & ~np.isin(key, joined(on))]
    if len(loose):
        part = next(part for part in blocks if found.place[part] == loose[0] // n)
        other = next(p for p in blocks if p != part and loose[0] % n in nodes_of(blocks[p]))
        raise InputError(
            f"{name}: part {part!r} shares {len(loose)} nodes with other parts outside of any named face (node "
            f"{numbers[loose[0] % n]} is one, with {other!r}); name the faces of the joint on both sides, or make one "
            f'part of them, of one material: sets = {{ {part} = "{part} + {other}" }}'
        )


def keys_of(faces: Iterable[Index], nodes: int) -> Index:
    """Keys of faces of several kinds, one for each face; nodes: how many there are."""
    return joined(side_key(some, nodes) for some in faces)


def among(faces: Blocks, keys: Index, nodes: int, *, others: bool = False) -> Blocks:
    """The faces that have one of some keys; others: those that have none."""
    chosen = [some[np.isin(side_key(some, nodes), keys, invert=others)] for some in faces]
    return tuple(some for some in chosen if len(some))
