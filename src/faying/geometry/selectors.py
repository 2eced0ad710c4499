"""Which face of a part is meant: by its normal, by what it touches, by a point near it, by its number."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from faying.errors import InputError
from faying.fe.line import FACING
from faying.geometry.face_facts import FaceFacts, GeometryFacts, Point
from faying.units import in_mm, show, show_area

WITHIN = 1e-3  # m: a point farther from a face than this does not mean it
AMBIGUOUS = 1e-6  # m: faces whose distances differ by less are not told apart
TOUCHING = 1e-6  # of the size of the structure: faces closer than this touch
LISTED = 12  # faces that a message lists
AXES: dict[str, Point] = {
    "+x": (1.0, 0.0, 0.0),
    "-x": (-1.0, 0.0, 0.0),
    "+y": (0.0, 1.0, 0.0),
    "-y": (0.0, -1.0, 0.0),
    "+z": (0.0, 0.0, 1.0),
    "-z": (0.0, 0.0, -1.0),
}


@dataclass(frozen=True, kw_only=True)
class Selector:
    """What a face of a part must be; all that is given must hold.

    Args:
        part: the part.
        normal: direction of the outward normal of a plane, within 1 degree.
        touching: another part, which the face touches.
        nearest: a point [m]; of the faces for which the rest holds, the nearest is meant.
        within: the farthest that this point may lie from the face [m].
        number: number of the face among those of its part, from 1; or those of several faces that are meant together.
        all: whether several faces are meant together.
    """

    part: str
    normal: Point | None = None
    touching: str | None = None
    nearest: Point | None = None
    within: float = WITHIN
    number: int | tuple[int, ...] | None = None
    all: bool = False

    def __str__(self) -> str:
        words = [f"part = {self.part!r}"]
        if self.number is not None:
            words.append(f"number = {list(self.numbers) if len(self.numbers) > 1 else self.numbers[0]}")
        if self.normal is not None:
            named = next((word for word, axis in AXES.items() if np.allclose(axis, self.normal)), None)
            words.append(f"normal = {named or '[' + ', '.join(f'{x:.4g}' for x in self.normal) + ']'}")
        if self.touching is not None:
            words.append(f"touching = {self.touching!r}")
        if self.nearest is not None:
            words.append(f"nearest = ({', '.join(f'{1e3 * x:g}' for x in self.nearest)}) mm")
        return ", ".join(words)

    @property
    def numbers(self) -> tuple[int, ...]:
        """The numbers that are given, none or more."""
        if self.number is None:
            return ()
        return (self.number,) if isinstance(self.number, int) else self.number


def points_of(selectors: Mapping[str, Selector]) -> dict[str, tuple[str, Sequence[float]]]:
    """The points whose distances selectors need, as `read_facts` takes them."""
    return {label: (one.part, one.nearest) for label, one in selectors.items() if one.nearest is not None}


def chosen(label: str, selector: Selector, facts: GeometryFacts, *, snap: float = 0.0) -> tuple[FaceFacts, ...]:
    """The faces that a selector means, one unless it says `all`.

    Args:
        label: the name that they get, for messages.
        selector: what they must be.
        facts: of the geometry, with the distances of `points_of`.
        snap: faces that lie no farther apart than this count as touching [m].

    Raises:
        InputError: none or several fit; the message lists the candidates.
    """
    for part in (selector.part, selector.touching):
        if part is not None and part not in facts.by_part:
            names = ", ".join(map(repr, facts.by_part))
            raise InputError(f"face {label!r}: no part is called {part!r}; the parts are {names}")
    every = facts.by_part[selector.part]
    left = list(every)
    if selector.number is not None:
        left = [face for face in left if face.number in selector.numbers]
        missing = sorted(set(selector.numbers) - {face.number for face in left})
        if left and missing:
            raise InputError(
                f"face {label!r}: {selector.part!r} has no face {', '.join(map(str, missing))}; it has {len(every)}: "
                f"{listed(every)}"
            )
    if selector.normal is not None:
        along = np.array(selector.normal)
        left = [face for face in left if face.facing(along) >= FACING]
    if selector.touching is not None:
        left = _touching(label, selector, facts, left, max(snap, TOUCHING * facts.size))
    if selector.nearest is not None and left:
        left = _nearest(label, selector, facts, left)
    if not left:
        raise InputError(
            f"face {label!r}: no face of {selector.part!r} fits {selector}; it has {len(every)}: {listed(every)}"
        )
    if len(left) > 1 and not selector.all and len(selector.numbers) < 2:
        raise InputError(
            f"face {label!r}: {len(left)} faces fit {selector}: {listed(left)}; add number, nearest or normal, or "
            "all = true for all of them together"
        )
    return tuple(left)


def listed(faces: Sequence[FaceFacts]) -> str:
    """Number, area, centre and normal of faces, the largest first."""
    words = []
    for face in sorted(faces, key=lambda face: -face.area)[:LISTED]:
        looks = f"radius {1e3 * face.radius:.4g} mm" if face.radius is not None else face.kind
        if face.normal is not None:
            looks = f"normal ({', '.join(f'{x:.3g}' for x in face.normal)})"
        words.append(f"number {face.number} ({show_area(face.area)} about {in_mm(face.centre)}, {looks})")
    more = len(faces) - LISTED
    return "; ".join(words) + (f"; and {more} more" if more > 0 else "")


def _touching(
    label: str, selector: Selector, facts: GeometryFacts, faces: Sequence[FaceFacts], close: float
) -> list[FaceFacts]:
    gaps: dict[int, float] = {}
    for contact in facts.contacts:
        for one, two in permutations(contact.sides):
            if one[0] == selector.part and two[0] == selector.touching:
                gaps[one[1]] = min(gaps.get(one[1], np.inf), abs(contact.gap))
    found = [face for face in faces if gaps.get(face.number, np.inf) <= close]
    near = [face for face in faces if face.number in gaps]
    if not found and near:
        best = min(near, key=lambda face: gaps[face.number])
        gap = show(gaps[best.number], "m")
        raise InputError(
            f"face {label!r}: no face of {selector.part!r} that fits {selector} touches it; nearest is "
            f"{listed([best])}, {gap} away; geometry.snap of {gap} or more counts it as touching"
        )
    return found


def _nearest(label: str, selector: Selector, facts: GeometryFacts, faces: Sequence[FaceFacts]) -> list[FaceFacts]:
    away = facts.distances[label]
    least = min(away[face.number - 1] for face in faces)
    if least > selector.within:
        best = next(face for face in faces if away[face.number - 1] == least)
        raise InputError(
            f"face {label!r}: the nearest face of {selector.part!r} that fits {selector} is {show(least, 'm')} away, "
            f"more than {show(selector.within, 'm')}: {listed([best])}; check the point and its unit, or give within"
        )
    return [face for face in faces if away[face.number - 1] < least + AMBIGUOUS]
