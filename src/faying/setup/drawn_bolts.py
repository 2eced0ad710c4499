"""Bolts that a geometry shows as bodies: a screw or stud with its nuts and washers, what it clamps, where it ends."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import permutations
from math import pi

import numpy as np

from faying.bolt.tapped import INSIDE
from faying.bolt.threads import NOMINAL, metric
from faying.fe.line import Line
from faying.geometry.bores import Bore, bores, seat
from faying.geometry.face_facts import FaceFacts, GeometryFacts
from faying.geometry.seats import countersink
from faying.setup.bolt_proposal import BoltProposal, DrawnBodies, to_nanometres
from faying.setup.fastener_forms import PLAY, Bearing, FastenerForm
from faying.units import show

WIDEST = 2.0  # stem diameters: wider holes on its axis are not its own
OUT = 0.3  # diameters: a stem that stands out of its last hole by more ends in a nut, drawn or not
CLOSE = 1e-5  # m: surfaces that CAD draws as touching, with what programs round
TIGHT = 1e-4  # of the radius: a nut that is wider by no more touches its stem
SHALLOW = 0.8  # diameters of engagement below which a thread of the bolt's own strength strips (VDI 2230, R11)


@dataclass(frozen=True, kw_only=True)
class _Row:
    """A stem in its holes along a line, its head or first nut in front.

    bores: of the parts that it passes, by where they begin; rings: before the first and behind the last of them, from
    the parts outwards.
    """

    stem: FastenerForm
    line: Line
    bores: tuple[Bore, ...]
    rings: tuple[list[FastenerForm], list[FastenerForm]]

    def span(self, body: Bore | FastenerForm) -> tuple[float, float]:
        """Where a hole or a ring begins and ends along the line [m]."""
        return self.line.span(body.line, body.low, body.high)

    @property
    def stems(self) -> list[tuple[float, float, float]]:
        """Radius [m] of each cylinder of the stem, and where it begins and ends along the line [m]."""
        return [(radius, *self.line.span(self.stem.line, low, high)) for radius, low, high in self.stem.stems]

    @property
    def last(self) -> Bore:
        """The bore that ends last."""
        return max(self.bores, key=lambda bore: self.span(bore)[1])

    @property
    def past(self) -> float:
        """How far the stem stands out of its last hole [m], less than 0 for one that ends inside."""
        return max(high for *_, high in self.stems) - self.span(self.last)[1]

    def nuts(self, end: int) -> list[FastenerForm]:
        """Nuts on the head's side (0) or at the end (1): rings without play, where there is no head."""
        tight = [ring for ring in self.rings[end] if ring.fits(self.stem.radius) and (end or not self.stem.head)]
        return [ring for ring in tight if not ring.is_washer] or tight

    def washers(self, end: int) -> list[FastenerForm]:
        """Washers there, from the parts outwards."""
        nuts = self.nuts(end)
        return [ring for ring in self.rings[end] if ring not in nuts]


def drawn_bolts(facts: GeometryFacts, found: Sequence[FastenerForm], solid: Iterable[str]) -> list[BoltProposal]:
    """The bolts whose bodies are drawn.

    Args:
        facts: of the geometry.
        found: bodies of the form of a fastener; solid: parts that are bolts, too, and are meshed.
    """
    rings = [form for form in found if form.ring]
    stems = [form for form in found if not form.ring]
    aside = {form.part for form in found if not form.ring or form.is_washer or form.flats is not None}
    nuts = {ring.part for ring in rings for stem in stems if stem.holds(ring) and ring.fits(stem.radius)}
    holes = [bore for bore in bores(facts) if bore.part not in aside | nuts | {*solid}]
    lines = (_row(stem, stem.line, rings, holes) for stem in stems)
    return [bolt for row in lines if row is not None and (bolt := _bolt(facts, row)) is not None]


def _row(stem: FastenerForm, line: Line, rings: Sequence[FastenerForm], holes: Sequence[Bore]) -> _Row | None:
    """A stem with its holes, nuts and washers; None where it has no holes or ends."""
    sunk = stem.head and -stem.head not in stem.bearings  # its head lies in the first hole
    ends = [(stem.low, stem.high)] if sunk else [(start, end) for _, start, end in stem.stems]
    low, high = line.span(stem.line, min(start for start, _ in ends), max(end for _, end in ends))

    def span(body: Bore | FastenerForm) -> tuple[float, float]:
        return line.span(body.line, body.low, body.high)

    def meets(body: Bore | FastenerForm, room: float) -> bool:
        return span(body)[0] < high + room and span(body)[1] > low - room

    def fits(ring: FastenerForm) -> bool:
        return ring.fits(stem.radius) or (ring.is_washer and stem.radius <= ring.radius <= WIDEST * stem.radius)

    wide = [
        bore
        for bore in holes
        if bore.radius <= WIDEST * stem.radius
        and stem.holds(bore, max(bore.radius - stem.radius, 0.0))
        and meets(bore, -CLOSE)
    ]
    narrow = {part: min(bore.radius for bore in wide if bore.part == part) for part in {bore.part for bore in wide}}
    inside = sorted((bore for bore in wide if bore.radius <= (1 + PLAY) * narrow[bore.part]), key=span)
    if not inside:
        return None
    first, last = span(inside[0])[0], max(span(bore)[1] for bore in inside)
    own = sorted((ring for ring in rings if fits(ring) and stem.holds(ring) and meets(ring, CLOSE)), key=span)
    before = [ring for ring in reversed(own) if span(ring)[1] <= first + CLOSE]
    behind = [ring for ring in own if span(ring)[0] >= last - CLOSE]
    row = _Row(stem=stem, line=line, bores=tuple(inside), rings=(before, behind))
    has_head = stem.head or row.nuts(0)
    if line is stem.line and (stem.head > 0 or (not has_head and row.nuts(1))):
        return _row(stem, Line(point=line.point, axis=-line.axis), rings, holes)
    return row if has_head else None


def _bolt(facts: GeometryFacts, row: _Row) -> BoltProposal | None:
    """The bolt of a stem in its holes; None where its size or one of its seats is not known."""
    stem, size = row.stem, row.stem.size
    if size is None:
        return None
    tapped = not row.nuts(1) and _is_thread(row)
    if not tapped and not row.nuts(1) and row.past < OUT * stem.diameter:
        return None
    cone = None
    if stem.head and _bearing(row, 0) is None:
        cone = countersink(facts, row.bores[0], top=bool(row.bores[0].axis @ row.line.axis < 0))
    head = cone.faces if cone is not None else _seat(facts, row, 0)
    end = tuple(facts.face(row.last.part, number) for number in row.last.faces) if tapped else _seat(facts, row, 1)
    if not head or not end:
        return None
    ends = (0,) if tapped else (0, 1)
    outer = min(_outer(row, side, size) for side in ends) if cone is None else min(cone.outer, 2 * stem.reach)
    first = [washer.radius for side in ends for washer in row.washers(side)[:1]]
    inner = 2 * max([*((row.bores[0], row.last)[side].radius for side in ends), *first])
    if inner >= outer:
        return None
    at = (_depth(row, head), _depth(row, end))
    engaged, length = None, at[1] - at[0]
    if tapped:
        mouth, bottom = row.span(row.last)
        engaged = bottom + min(row.past, 0.0) - mouth
        length = mouth - at[0] + min(INSIDE * 1e-3 * size, engaged)
    volumes, washers = _volumes(row, size, at[0], length), row.washers(0) + row.washers(1)
    parts = dict.fromkeys((*(bore.part for bore in row.bores), *(face.part for face in (*head, *end))))
    return BoltProposal(
        axis=row.line.axis,
        parts=tuple(parts),
        head=head,
        end=end,
        words=("seat" if cone is None else "countersink", "thread" if tapped else "seat"),
        size=size,
        at=None if tapped else to_nanometres(row.line.at(at[0] + length / 2)),
        ring=(round(inner, 9), round(outer, 9)),
        shape=stem.shape,
        engaged=None if engaged is None else round(engaged, 9),
        drawn=DrawnBodies(
            names=(stem.part, *(form.part for form in (*row.nuts(0), *row.nuts(1), *washers))),
            washers=tuple((round(w.diameter, 9), round(2 * w.reach, 9), round(w.length, 9)) for w in washers),
            shank=_plain(row, at[0], mouth if tapped else at[1]),
            volumes=(volumes[0], volumes[1] if tapped or row.nuts(1) else None),
            holes=frozenset(side for bore in row.bores for side in bore.sides),
            solid=() if tapped or cone is not None else _solid(row),
        ),
        remark=_remark(row, size, tapped, engaged),
    )


def _solid(row: _Row) -> tuple[str, ...]:
    """Bodies that touch and are one meshed bolt: the stem and its nuts; none where a nut lacks or does not touch it."""
    nuts = (*row.nuts(0), *row.nuts(1))

    def touches(nut: FastenerForm) -> bool:
        low, high = row.span(nut)
        return any(
            radius >= (1 - TIGHT) * nut.radius and start < low + CLOSE and end > high - CLOSE
            for radius, start, end in row.stems
        )

    return (row.stem.part, *(nut.part for nut in nuts)) if row.nuts(1) and all(map(touches, nuts)) else ()


def _is_thread(row: _Row) -> bool:
    """Whether the last hole is the thread of a stem: no wider, narrower than the other holes, or not passed far."""
    stem, last = row.stem, row.last
    others = [bore.radius for bore in row.bores if bore.part != last.part]
    narrower = bool(others) and last.radius < (1 - PLAY) * min(others)
    return last.radius <= (1 + PLAY) * stem.radius and (narrower or row.past < OUT * stem.diameter)


def _bearing(row: _Row, end: int, *, alone: bool = False) -> Bearing | None:
    """The plane that presses on the parts on the head's side (0) or at the end (1): of a washer, a nut or the head.

    alone: whether nuts and washers do not count.
    """
    rings = [] if alone else row.rings[end]
    body = rings[0] if rings else row.stem
    if not rings and (end or not row.stem.head):
        return None
    ahead = 1 if end == 0 else -1  # towards the parts, along the line of the row
    return body.bearings.get(ahead if body.line.axis @ row.line.axis > 0 else -ahead)


def _seat(facts: GeometryFacts, row: _Row, end: int) -> tuple[FaceFacts, ...]:
    """The faces that are pressed there: those that the bearing touches, else the plane at the end of the hole."""
    bearing = _bearing(row, end)
    pressing = None if bearing is None else bearing.face.side
    areas: dict[str, float] = {}
    touched: list[FaceFacts] = []
    for contact in facts.contacts:
        for one, two in permutations(contact.sides):
            if one == pressing and abs(contact.gap) <= CLOSE:
                touched.append(facts.face(*two))
                areas[two[0]] = areas.get(two[0], 0.0) + contact.area
    if touched:
        return tuple(face for face in touched if face.part == max(areas, key=lambda part: areas[part]))
    bore = row.bores[0] if end == 0 else row.last
    ahead = bool(bore.axis @ row.line.axis > 0)
    found = seat(facts, bore, top=ahead is (end == 1))
    return () if found is None else (found,)


def _outer(row: _Row, end: int, size: float) -> float:
    """Outer diameter [m] of what presses there; of a nut that is not drawn, its width across flats (ISO 4032)."""
    bearing = _bearing(row, end)
    return bearing.outer if bearing is not None else 1e-3 * (metric(size).flats or 1.5 * size)


def _depth(row: _Row, faces: Sequence[FaceFacts]) -> float:
    """Depth [m] of the middle of faces that are pressed, where a bolt takes its seat to be."""
    depths = row.line.about(np.array([face.centre for face in faces]))[1]
    return float(np.average(depths, weights=[face.area for face in faces]))


def _plain(row: _Row, seat_at: float, thread_at: float) -> float | None:
    """Length [m] of a shank that is drawn thicker than the thread behind it, from the head on; None without one."""
    ends = [high for radius, _, high in row.stems if radius > (1 - PLAY) * row.stem.radius]
    if not row.stem.head or len(ends) == len(row.stems):
        return None
    return round(max(min(max(ends), thread_at) - seat_at, 0.0), 9)


def _volumes(row: _Row, size: float, seat_at: float, length: float) -> tuple[float, float]:
    """Volumes [m3] on the head's side and at the end: all but a shank of the nominal diameter between the seats."""
    behind = sum(pi * radius**2 * (high - min(max(seat_at, low), high)) for radius, low, high in row.stems)
    nuts = [sum(nut.volume for nut in row.nuts(end)) for end in (0, 1)]
    rest = max(row.stem.volume + sum(nuts) - pi / 4 * (1e-3 * size) ** 2 * length, 0.0)
    head = min(max(row.stem.volume - behind + nuts[0], 0.0), rest)
    return head, rest - head


def _remark(row: _Row, size: float, tapped: bool, engaged: float | None) -> str:
    """What the bolt is, and what of it contradicts a standard."""
    stem, one = row.stem, metric(size)
    head = "stud" if not stem.head else f"screw with a {_head_words(row)}"
    words = [f"M{size:g} by the part {stem.part!r}, a {head}"]
    if abs(1e3 * stem.diameter - size) > NOMINAL:
        words.append(f"its stem is drawn with {show(stem.diameter, 'm')}")
    nuts = row.nuts(0) + row.nuts(1)
    words += [f"nut {nut.part!r}" for nut in nuts]
    for washer in row.washers(0) + row.washers(1):
        kind = "spring washer" if washer.split else "washer"
        words.append(
            f"{kind} {washer.part!r} of {show(2 * washer.reach, 'm')}" + "; it counts as closed" * washer.split
        )
    if engaged is not None:
        words.append(f"{show(engaged, 'm')} of thread in {row.last.part!r}")
        if engaged < SHALLOW * stem.diameter:
            words.append("which is short")
    elif not nuts:
        words.append("no nut is drawn: one of ISO 4032 is taken")
    clear = row.bores[:-1] if tapped else row.bores
    fine, medium, coarse = one.holes
    for wide in dict.fromkeys(round(2e3 * bore.radius, 6) for bore in clear):
        if wide <= size + NOMINAL:
            words.append(f"its hole of {wide:g} mm leaves no play (ISO 273: {medium:g} mm)")
        elif not fine - NOMINAL <= wide <= coarse + NOMINAL:
            words.append(f"its hole of {wide:g} mm is none of ISO 273 ({fine:g}, {medium:g}, {coarse:g} mm)")
    for body, standard in ((stem, "ISO 4014"), *((nut, "ISO 4032") for nut in nuts)):
        if body.flats is not None and one.flats is not None and abs(1e3 * body.flats - one.flats) > NOMINAL:
            words.append(f"{1e3 * body.flats:g} mm across flats, where {standard} has {one.flats:g} mm")
    across = round(2e3 * stem.reach, 6)
    if _bearing(row, 0, alone=True) is None and stem.head and one.sunk and not one.sunk[0] <= across <= one.sunk[1]:
        words.append(f"its head has {across:g} mm, where ISO 10642 has {one.sunk[0]:g} to {one.sunk[1]:g} mm")
    if not tapped and _bearing(row, 0) is not None and abs(_outer(row, 0, size) - _outer(row, 1, size)) > CLOSE:
        words.append("seat: the smaller of the two that are drawn")
    return "; ".join(words)


def _head_words(row: _Row) -> str:
    stem, bearing = row.stem, _bearing(row, 0, alone=True)
    if bearing is None:
        return "countersunk head"
    wide = show(bearing.outer, "m")
    if stem.flats is None:
        return f"{'cylindrical ' * stem.round_head}head of {wide}"
    return f"hexagon head of {show(stem.flats, 'm')}" + f" and a flange of {wide}" * (bearing.outer > 1.1 * stem.flats)
