"""Bolts that a geometry shows as bodies: a screw or stud with its nuts and washers, what it clamps, where it ends."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from math import pi

import numpy as np

from faying.bolt.standards import NOMINAL, metric
from faying.bolt.tapped import INSIDE
from faying.geometry.bores import Bore, bores, seat
from faying.geometry.face_facts import FaceFacts, GeometryFacts
from faying.geometry.seats import countersink
from faying.setup.bolt_proposal import BoltProposal, DrawnBodies, to_nanometres
from faying.setup.fastener_forms import PLAY, Bearing, FastenerForm, Line
from faying.units import show

ASIDE = 0.2  # of the radius of a stem: how far the axes of its holes, nuts and washers lie from its own
WIDEST = 2.0  # stem diameters: wider holes on its axis are not its own
OUT = 0.3  # diameters: a stem that stands out of its last hole by more ends in a nut, drawn or not
CLOSE = 1e-5  # m: surfaces that CAD draws as touching, with what programs round
SHALLOW = 0.8  # diameters of engagement below which a thread of the bolt's own strength strips (VDI 2230, R11)


@dataclass(frozen=True, kw_only=True)
class _Row:
    """A stem in its holes, turned so that its head comes first.

    bores: of the parts that it passes, by where they begin; spans: where each begins and ends along the line [m];
    rings: before the first and behind the last of them, from the parts outwards.
    """

    stem: FastenerForm
    line: Line
    bores: tuple[Bore, ...]
    spans: tuple[tuple[float, float], ...]
    rings: tuple[tuple[FastenerForm, ...], tuple[FastenerForm, ...]]

    @property
    def last(self) -> Bore:
        """The bore that ends last."""
        return max(zip(self.bores, self.spans, strict=True), key=lambda one: one[1][1])[0]

    @property
    def ends(self) -> tuple[float, float]:
        """Where the first bore begins, and the last one ends."""
        return min(low for low, _ in self.spans), max(high for _, high in self.spans)

    def nuts(self, end: int) -> list[FastenerForm]:
        """Nuts on the head's side (0) or at the end (1): rings without play, where there is no head."""
        tight = [ring for ring in self.rings[end] if ring.fits(self.stem.radius) and (end or not self.stem.head)]
        return [ring for ring in tight if not ring.is_washer] or tight

    def washers(self, end: int) -> list[FastenerForm]:
        """Washers there, from the parts outwards."""
        nuts = self.nuts(end)
        return [ring for ring in self.rings[end] if ring not in nuts]

    @property
    def tip(self) -> float:
        """Where the stem ends."""
        return self.line.span(self.stem.line, *self.stem.stem)[1]

    def turned(self) -> "_Row":
        """The same from the other end."""
        spans = tuple((-high, -low) for low, high in self.spans)
        order = sorted(range(len(spans)), key=lambda k: spans[k])
        return replace(
            self,
            line=self.line.reversed,
            bores=tuple(self.bores[k] for k in order),
            spans=tuple(spans[k] for k in order),
            rings=self.rings[::-1],
        )


def drawn_bolts(facts: GeometryFacts, found: Sequence[FastenerForm], solid: Iterable[str]) -> list[BoltProposal]:
    """The bolts whose bodies are drawn.

    Args:
        facts: of the geometry.
        found: bodies of the form of a fastener; solid: parts that are bolts, too, and are meshed.
    """
    rings = [form for form in found if form.ring]
    aside = {*(form.part for form in found if not form.ring or form.is_washer or form.flats is not None), *solid}
    stems = [form for form in found if not form.ring]
    nuts = {
        ring.part
        for ring in rings
        for stem in stems
        if stem.line.holds(ring.line, ASIDE * stem.radius) and ring.fits(stem.radius)
    }
    holes = [bore for bore in bores(facts) if bore.part not in aside | nuts]
    made = []
    for stem in stems:
        row = _row(stem, rings, holes)
        bolt = None if row is None else _bolt(facts, row)
        if bolt is not None:
            made.append(bolt)
    return made


def _row(stem: FastenerForm, rings: Sequence[FastenerForm], holes: Sequence[Bore]) -> _Row | None:
    """A stem with its holes, nuts and washers, its head or first nut in front; None where it has no holes or ends."""
    line, (low, high) = stem.line, stem.stem
    inside: list[tuple[tuple[float, float], Bore]] = []
    for bore in holes:
        own = Line(point=bore.at(0.0), axis=bore.axis)
        if not line.holds(own, ASIDE * stem.radius + max(bore.radius - stem.radius, 0.0)):
            continue
        span = line.span(own, bore.low, bore.high)
        if span[0] < high - CLOSE and span[1] > low + CLOSE and 2 * bore.radius <= WIDEST * stem.diameter:
            inside.append((span, bore))
    narrow = {bore.part: min(one.radius for _, one in inside if one.part == bore.part) for _, bore in inside}
    inside = sorted(
        (one for one in inside if one[1].radius <= (1 + PLAY) * narrow[one[1].part]), key=lambda one: one[0]
    )
    if not inside:
        return None
    first, last = inside[0][0][0], max(span[1] for span, _ in inside)
    before: list[tuple[float, FastenerForm]] = []
    behind: list[tuple[float, FastenerForm]] = []
    for ring in rings:
        at = line.span(ring.line, ring.low, ring.high)
        if not line.holds(ring.line, ASIDE * stem.radius) or at[0] > high + CLOSE or at[1] < low - CLOSE:
            continue
        if not ring.fits(stem.radius) and not (ring.is_washer and stem.radius <= ring.radius <= WIDEST * stem.radius):
            continue
        if at[1] <= first + CLOSE:
            before.append((-at[1], ring))
        elif at[0] >= last - CLOSE:
            behind.append((at[0], ring))
    ends = [tuple(ring for _, ring in sorted(some, key=lambda one: one[0])) for some in (before, behind)]
    row = _Row(
        stem=stem,
        line=line,
        bores=tuple(bore for _, bore in inside),
        spans=tuple(span for span, _ in inside),
        rings=(ends[0], ends[1]),
    )
    if stem.head > 0 or (not stem.head and row.nuts(1) and not row.nuts(0)):
        row = row.turned()
    return row if stem.head or row.nuts(0) else None


def _bolt(facts: GeometryFacts, row: _Row) -> BoltProposal | None:
    """The bolt of a stem in its holes; None where its size or one of its seats is not known."""
    stem, size = row.stem, row.stem.size
    if size is None:
        return None
    tapped = not row.nuts(1) and _is_thread(row)
    if not tapped and not row.nuts(1) and row.tip < row.ends[1] + OUT * stem.diameter:
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
    inner = max(_inner(row, side) for side in ends)
    if inner >= outer:
        return None
    at = (_depth(row, head), _depth(row, end))
    engaged, length = None, at[1] - at[0]
    if tapped:
        mouth = row.spans[row.bores.index(row.last)][0]
        engaged = min(row.tip, row.ends[1]) - mouth
        length = mouth - at[0] + min(INSIDE * 1e-3 * size, engaged)
    used = [form for side in (0, 1) for form in (*row.nuts(side), *row.washers(side))]
    washers = [form for side in (0, 1) for form in row.washers(side)]
    parts = dict.fromkeys((*(bore.part for bore in row.bores), *(face.part for face in (*head, *end))))
    point = row.line.point + (at[0] + length / 2) * row.line.axis
    return BoltProposal(
        axis=row.line.axis,
        parts=tuple(parts),
        head=head,
        end=end,
        words=("seat" if cone is None else "countersink", "thread" if tapped else "seat"),
        size=size,
        at=None if tapped else to_nanometres(point),
        ring=(round(inner, 9), round(outer, 9)),
        shape=stem.shape if stem.head else "hexagon",
        engaged=None if engaged is None else round(engaged, 9),
        drawn=DrawnBodies(
            names=(stem.part, *(form.part for form in sorted(used, key=lambda form: form in washers))),
            washers=tuple((round(w.diameter, 9), round(2 * w.reach, 9), round(w.length, 9)) for w in washers),
            shank=_plain(row, at[0], mouth if tapped else at[1]),
            volumes=_volumes(row, size, at[0], length),
            has_end=tapped or bool(row.nuts(1)),
            holes=frozenset(side for bore in row.bores for side in bore.sides),
        ),
        remark=_remark(row, size, tapped, engaged),
    )


def _is_thread(row: _Row) -> bool:
    """Whether the last hole is the thread of a stem: no wider, narrower than the other holes, or not passed far."""
    stem, last = row.stem, row.last
    if last.radius > (1 + PLAY) * stem.radius:
        return False
    others = [bore.radius for bore in row.bores if bore.part != last.part]
    narrower = bool(others) and last.radius < (1 - PLAY) * min(others)
    return narrower or row.tip < row.ends[1] + OUT * stem.diameter


def _bearing(row: _Row, end: int) -> Bearing | None:
    """The plane that presses on the parts on the head's side (0) or at the end (1): of a washer, a nut or the head."""
    rings = row.rings[end]
    body = rings[0] if rings else row.stem
    if not rings and (end or not row.stem.head):
        return None
    ahead = 1 if end == 0 else -1  # towards the parts, along the line of the row
    return body.bearings.get(ahead if body.line.axis @ row.line.axis > 0 else -ahead)


def _seat(facts: GeometryFacts, row: _Row, end: int) -> tuple[FaceFacts, ...]:
    """The faces that are pressed there: those that the bearing touches, else the plane at the end of the hole."""
    bearing = _bearing(row, end)
    if bearing is not None:
        own = (bearing.face.part, bearing.face.number)
        touched: dict[str, list[tuple[float, FaceFacts]]] = {}
        for contact in facts.contacts:
            if own in contact.sides and abs(contact.gap) <= CLOSE:
                other = facts.face(*(contact.second if contact.first == own else contact.first))
                touched.setdefault(other.part, []).append((contact.area, other))
        if touched:
            widest = max(touched.values(), key=lambda some: sum(area for area, _ in some))
            return tuple(face for _, face in widest)
    bore = row.bores[0] if end == 0 else row.last
    ahead = bool(bore.axis @ row.line.axis > 0)
    found = seat(facts, bore, top=ahead is (end == 1))
    return () if found is None else (found,)


def _outer(row: _Row, end: int, size: float) -> float:
    """Outer diameter [m] of what presses there; of a nut that is not drawn, its width across flats (ISO 4032)."""
    bearing = _bearing(row, end)
    return bearing.outer if bearing is not None else 1e-3 * (metric(size).flats or 1.5 * size)


def _inner(row: _Row, end: int) -> float:
    """Inner diameter [m] of the ring that is pressed there."""
    hole = 2 * (row.bores[0] if end == 0 else row.last).radius
    return max([hole, *(washer.diameter for washer in row.washers(end)[:1])])


def _depth(row: _Row, faces: Sequence[FaceFacts]) -> float:
    """Depth [m] of the middle of faces that are pressed, where a bolt takes its seat to be."""
    depths = row.line.about(np.array([face.centre for face in faces]))[1]
    return float(np.average(depths, weights=[face.area for face in faces]))


def _plain(row: _Row, seat_at: float, thread_at: float) -> float | None:
    """Length [m] of a shank that is drawn thicker than the thread behind it, from the head on; None without one."""
    stems = [(radius, *row.line.span(row.stem.line, low, high)) for radius, low, high in row.stem.stems]
    thick = max(radius for radius, *_ in stems)
    ends = [high for radius, _, high in stems if radius > (1 - PLAY) * thick]
    if not row.stem.head or all(radius > (1 - PLAY) * thick for radius, *_ in stems):
        return None
    return round(max(min(max(ends), thread_at) - seat_at, 0.0), 9)


def _volumes(row: _Row, size: float, seat_at: float, length: float) -> tuple[float, float]:
    """Volumes [m3] on the head's side and at the end: all but a shank of the nominal diameter between the seats."""
    stem, section = row.stem, pi / 4 * (1e-3 * size) ** 2
    spans = [(pi * radius**2, *row.line.span(stem.line, low, high)) for radius, low, high in stem.stems]
    head = stem.volume - sum(area * (high - low) for area, low, high in spans)
    head += sum(area * max(min(high, seat_at) - low, 0.0) for area, low, high in spans)
    head += sum(nut.volume for nut in row.nuts(0))
    rest = stem.volume + sum(nut.volume for end in (0, 1) for nut in row.nuts(end)) - section * length
    head = min(max(head, 0.0), max(rest, 0.0))
    return head, max(rest - head, 0.0)


def _remark(row: _Row, size: float, tapped: bool, engaged: float | None) -> str:
    """What the bolt is, and what of it contradicts a standard."""
    stem, one = row.stem, metric(size)
    head = "stud" if not stem.head else f"screw with a {_head_words(row)}"
    words = [f"M{size:g} by the part {stem.part!r}, a {head}"]
    nuts = [*row.nuts(0), *row.nuts(1)]
    words += [f"nut {nut.part!r}" for nut in nuts]
    for washer in (*row.washers(0), *row.washers(1)):
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
    if not tapped and _bearing(row, 0) is not None and abs(_outer(row, 0, size) - _outer(row, 1, size)) > CLOSE:
        words.append("seat: the smaller of the two that are drawn")
    return "; ".join(words)


def _head_words(row: _Row) -> str:
    stem, bearing = row.stem, _bearing(replace(row, rings=((), ())), 0)
    if bearing is None:
        return "countersunk head"
    wide = show(bearing.outer, "m")
    if stem.flats is None:
        return f"{'cylindrical ' * stem.round_head}head of {wide}"
    return f"hexagon head of {show(stem.flats, 'm')}" + f" and a flange of {wide}" * (bearing.outer > 1.1 * stem.flats)
