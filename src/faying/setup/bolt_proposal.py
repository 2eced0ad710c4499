"""A bolt that a study may have: what it presses on, its size, how far it is tightened, and the bodies it stands for."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import floor, log10

import numpy as np

from faying.bolt.threads import THICK_CLASS, Fastener, Thread, is_graded
from faying.bolt.tightening import DEFAULT_WAY, TIGHTENING
from faying.bolt.vdi2230 import Head, greatest_preload
from faying.geometry.face_facts import FaceFacts, Point, point_of
from faying.typing import Array

GRADE = "8.8"  # of the bolts
MAX_NAMES = 2  # bolts that a line names one by one


@dataclass(frozen=True, kw_only=True)
class DrawnBodies:
    """Bodies of the file that a beam stands for.

    Args:
        names: the one with the stem, its nuts, its washers.
        washers: inner, outer diameter and thickness of each washer [m].
        shank: length of the plain shank [m], where it is drawn apart from the thread.
        volumes: [m3] that rest on the head's side and at the end: all but the shank between the seats; None at the end
            where neither a nut nor a thread is drawn.
        holes: part and number of the faces of all holes that are its own.
        solid: those that are one body where the bolt is meshed, the stem and its nuts; empty in a thread, under a
            countersunk head, or where a nut lacks or does not touch.
    """

    names: tuple[str, ...]
    washers: tuple[tuple[float, float, float], ...]
    shank: float | None
    volumes: tuple[float, float | None]
    holes: frozenset[tuple[str, int]]
    solid: tuple[str, ...]


@dataclass(frozen=True, kw_only=True)
class BoltProposal:
    """A bolt through a row of holes, bodies that are a bolt, or a part that is one and is meshed.

    Args:
        axis: unit direction (3,).
        parts: what it clamps.
        head, end: the faces under the head, and those at the nut or of the thread.
        words: what these faces are called.
        size: nominal diameter [mm]; None where it is not known.
        at: point on the axis [m]; None where a tapped hole or a meshed bolt says it.
        ring: inner and outer diameter of the seat [m]; None for a meshed bolt.
        part: the part that it is, if it is one.
        shape: of the head.
        engaged: length in the thread [m]; None where the depth of its hole says it.
        drawn: the bodies of the file that it stands for, if it does.
        force: what a mesh file pulls it with, as the file writes it; None where it gives none.
        remark: where size and ring come from.
        name, faces: what tables call it, and names of its two faces, once they have names.
    """

    axis: Array
    parts: tuple[str, ...]
    head: tuple[FaceFacts, ...]
    end: tuple[FaceFacts, ...]
    words: tuple[str, str] = ("seat", "seat")
    size: float | None = None
    at: tuple[float, float, float] | None = None
    ring: tuple[float, float] | None = None
    part: str | None = None
    shape: Head = "hexagon"
    engaged: float | None = None
    drawn: DrawnBodies | None = None
    force: float | None = None
    remark: str = ""
    name: str = ""
    faces: tuple[str, str] = ("", "")

    @property
    def preload(self) -> float | None:
        """The greatest [N] that the bolt sheet accepts of class 8.8, three digits; None where the size is not known.

        Above M39, where ISO 898-1 ends, with the same strength.
        """
        if self.size is None:
            return None
        thread = Thread.coarse(self.size * 1e-3)
        strength = Fastener(thread=thread, grade=GRADE).yield_stress if self.graded else THICK_CLASS[1]
        return rounded(greatest_preload(thread, strength, scatter=TIGHTENING[DEFAULT_WAY].scatter), 3, up=False)

    @property
    def graded(self) -> bool:
        """Whether ISO 898-1 has strengths for its thread."""
        return self.size is not None and is_graded(Thread.coarse(self.size * 1e-3))


def grouped(names: Sequence[str], kind: str = "bolt") -> str:
    """Names of bolts that are alike on one line: each of a few, else how many they are, the first and the last."""
    return ", ".join(names) if len(names) <= MAX_NAMES else f"{len(names)} {kind}s ({names[0]} to {names[-1]})"


def rounded(value: float, digits: int, *, up: bool | None = None) -> float:
    """A value to so many digits: the nearest, or the next above or below."""
    step: float = 10.0 ** (floor(log10(value)) - digits + 1)
    count = round(value / step) if up is None else np.ceil(value / step) if up else np.floor(value / step)
    return round(float(count) * step, 15)


def to_nanometres(place: Array) -> Point:
    """A point (3,) [m] to the last digit that a study needs."""
    return point_of(place, 9)
