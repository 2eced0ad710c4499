"""Seats: what the head or the nut of a bolt presses of a face."""

from dataclasses import dataclass
from math import inf, pi

from faying.errors import InputError
from faying.fe.attach import Ring
from faying.fe.line import Line
from faying.fe.sides import NamedFaces, face_centre, nodes_of
from faying.units import show

ROUND = 0.03  # of the area of a ring: a face that differs from it by more does not fill it


@dataclass(frozen=True, kw_only=True)
class Seat:
    """What a head, a nut or a washer presses of a face.

    Args:
        face: Its name.
        inner, outer: Diameters [m], no wider than the hole and the edge of the face are where these are round.
        area: What lies on the face [m2].
        is_ring: Whether it is one between both diameters, some of which may be missing; a whole face may have any form.
        overhang: What is to be said where the ring that was given is wider than its face; "" where it is not.
    """

    face: str
    inner: float
    outer: float
    area: float
    is_ring: bool = True
    overhang: str = ""

    @classmethod
    def of(cls, mesh: NamedFaces, face: str, line: Line, ring: tuple[float, float] | None) -> "Seat":
        """Return the seat that a ring presses about an axis, the whole face where there is none.

        Raises InputError where the ring meets nothing of the face.
        """
        blocks = mesh.face(face)
        radius = line.about(mesh.points[nodes_of(blocks)])[0]
        ends = 2 * float(radius.min()), 2 * float(radius.max())
        if ring is None:
            area = face_centre(mesh.points, blocks)[2]
            inner, outer = min(ends, (0.0, ends[1]), key=lambda one: _off(area, one))  # nodes may miss the middle
            return cls(face=face, inner=inner, outer=outer, area=area, is_ring=_off(area, (inner, outer)) < ROUND)
        inner, outer = ring
        area = Ring(point=line.point, axis=line.axis, inner=inner / 2, outer=outer / 2).area_on(mesh.points, blocks)
        given = pi / 4 * (outer**2 - inner**2)
        if _off(area, ring) < ROUND:
            return cls(face=face, inner=inner, outer=outer, area=given)
        what = f"{show(inner, 'm')} to {show(outer, 'm')}"
        if area < 1e-6 * given:
            raise InputError(
                f"a ring of {what} meets nothing of its face {face!r}; check the point on the axis, the diameters and "
                "their unit"
            )
        within = max(inner, ends[0]), min(outer, ends[1])
        if _off(area, within) < ROUND:
            inner, outer = within
            area = pi / 4 * (outer**2 - inner**2)
        overhang = f"of its ring of {what} only {area / given:.0%} lie on {face!r}; the seat counts as that"
        return cls(face=face, inner=inner, outer=outer, area=area, overhang=overhang)

    @property
    def diameters(self) -> tuple[float, float]:
        """Inner and outer diameter [m]."""
        return self.inner, self.outer

    @property
    def mean_diameter(self) -> float:
        """D_Km, about which friction under a head turns [m] (VDI 2230)."""
        return (self.inner + self.outer) / 2


def _off(area: float, ring: tuple[float, float]) -> float:
    """By which share an area [m2] differs from that of a ring between two diameters [m]."""
    whole = pi / 4 * (ring[1] ** 2 - ring[0] ** 2)
    return abs(area / whole - 1) if whole > 0 else inf
