"""Bolts that the holes of a geometry ask for: through bolts, screws, countersunk screws, in T-slots; dowels."""

from collections.abc import Sequence
from dataclasses import replace

from faying.bolt.tapped import ENGAGED
from faying.bolt.threads import COMMON, COMMON_PINS, METRIC, is_tapped, metric, size_for_hole
from faying.bolt.vdi2230 import Head
from faying.geometry.bores import Bore, Stack, bores, on_one_axis, room_around, rows, seat
from faying.geometry.face_facts import FaceFacts, GeometryFacts, TouchingFaces
from faying.geometry.seats import countersink, lips
from faying.setup.bolt_proposal import BoltProposal, to_nanometres
from faying.setup.face_names import FaceNames
from faying.setup.fasteners import DowelProposal, Fasteners
from faying.text import listed
from faying.typing import Array
from faying.units import show

CHORDS = 1.02  # by so much a round edge is wider than its chords
WIDEST = 1.1e-3 * METRIC[max(COMMON)].holes[2]  # m: wider holes are for no bolt that is known here
SUNK = 1.6  # nominal diameters from which a cone at the mouth of a hole is a countersink, and no chamfer
PLACES = 3  # rows of holes whose places a remark says


def found_bolts(
    facts: GeometryFacts, fasteners: Fasteners, free: Sequence[Stack], joints: Sequence[TouchingFaces]
) -> tuple[list[BoltProposal], list[str]]:
    """The bolts of a geometry, bodies and those of rows of holes; and what there is to say of rows that take none.

    Args:
        facts: of the parts that are not left out.
        fasteners: has the bodies that are bolts.
        free: rows of holes in which nothing of the file runs.
        joints: the planes that touch.
    """
    found = [*fasteners.bolts]
    left: dict[tuple[str, str], list[Array]] = {}  # what is to be said of rows of holes -> their places [m]
    met = {side for contact in joints for side in contact.sides}
    every = bores(facts)
    for stack in (one for row in free for one in _from_both_sides(row)):
        if 2 * min(bore.radius for bore in stack.bores) > WIDEST or takes_dowel(facts, stack):
            continue  # a pipe, a bearing, or a dowel
        bolt: BoltProposal | str | None = _in_slot(facts, stack, every)
        if bolt is None:
            bolt = _in_row(facts, stack) if len(stack.bores) > 1 else _alone(facts, stack, met)
        if isinstance(bolt, str):
            widths = ", ".join(f"{2e3 * bore.radius:.4g} mm in {bore.part!r}" for bore in stack.bores)
            left.setdefault((widths, bolt), []).append(stack.middle)
        elif bolt is not None:
            found.append(bolt)
    remarks = []
    for (widths, why), places in left.items():
        where = listed((f"({', '.join(f'{1e3 * x:.4g}' for x in place)})" for place in places), PLACES)
        many = f"{len(places)} rows of holes" if len(places) > 1 else "holes"
        remarks.append(f"{many} about {where} mm ({widths}) {why}: left out")
    return [_in_shared_thread(bolt, found) for bolt in found], remarks


def _in_shared_thread(bolt: BoltProposal, found: Sequence[BoltProposal]) -> BoltProposal:
    """A screw that meets another one in the middle of a thread engages half of it at most."""
    shared = [one for one in found if one is not bolt and one.end == bolt.end and bolt.words[1] == "thread"]
    depth = max((face.length or 0.0 for face in bolt.end), default=0.0)
    if not shared or bolt.size is None or bolt.engaged is not None:
        return bolt
    half = round(min(ENGAGED * 1e-3 * bolt.size, depth / 2), 9)
    return replace(bolt, engaged=half, remark=f"{bolt.remark}; another screw comes from the other side")


def _from_both_sides(stack: Stack) -> list[Stack]:
    """A row in two where two screws meet in the thread of a part in its middle, one from either side."""
    sizes = [size_for_hole(2 * bore.radius) for bore in stack.bores]
    for k in range(1, len(sizes) - 1):
        before, behind = set(sizes[:k]), set(sizes[k + 1 :])
        if len(before) == len(behind) == 1 and before == behind and None not in before:
            size = before.pop()
            if size is not None and sizes[k] != size and is_tapped(2 * stack.bores[k].radius, size):
                return [Stack(bores=stack.bores[: k + 1]), Stack(bores=stack.bores[k:])]
    return [stack]


def _alone(facts: GeometryFacts, stack: Stack, met: set[tuple[str, int]]) -> str | None:
    """What is to be said of a single clearance hole that ends at a face which another part touches."""
    (bore,) = stack.bores
    near = {other for number in bore.faces for other in facts.face(bore.part, number).neighbours}
    if size_for_hole(2 * bore.radius) is None or not any((bore.part, number) in met for number in near):
        return None
    return "end at a joint, where no hole and no slot of another part takes a bolt"


def _in_slot(facts: GeometryFacts, stack: Stack, every: Sequence[Bore]) -> BoltProposal | None:
    """A bolt whose nut, or head, pulls the lips of a T-slot beyond the end of a row of clearance holes.

    every: all bores, those of drawn bolts too: a part with one on this axis, such as two plates farther on, has a bolt
    of its own.
    """
    sizes = {size_for_hole(2 * bore.radius) for bore in stack.bores}
    size = sizes.pop()
    if sizes or size is None:
        return None
    hole = 2 * max(bore.radius for bore in stack.bores)
    for top in (True, False):
        bore, other = stack.ends[top], stack.ends[not top]
        found = lips(facts, bore, top=top, shank=size / 1e3, ring=(hole, _washer(size)))
        under = seat(facts, other, top=not top) if found else None
        owners = {face.part for face in found}
        if under is None or any(one.part in owners and on_one_axis(bore, one) for one in every):
            continue
        outer, why, shape = _pressed_ring(size, room_around(facts, under, other))
        owner = found[0].part
        return BoltProposal(
            axis=stack.axis,
            parts=(*stack.parts, owner),
            head=(under,),
            end=tuple(face for face in found if face.part == owner),
            words=("seat", "lips"),
            size=size,
            at=to_nanometres(stack.middle),
            ring=(round(hole, 9), outer),
            shape=shape,
            remark=f"M{size:g} for a hole of {show(hole, 'm')} (ISO 273), in a T-slot of {owner!r}; "
            f"seats: from the hole to the diameter {why}, on the lips as far as they reach",
        )
    return None


def _in_row(facts: GeometryFacts, stack: Stack) -> BoltProposal | str:
    """The bolt of a row of holes through several parts; why there is none, where none fits."""
    found = size_of(stack)
    if found is None:
        return "are clearance holes of no common bolt (M3 to M24, ISO 273)"
    size, tapped = found
    ends, word = stack.ends, "seat" if tapped is None else "thread"
    flats = [seat(facts, bore, top=bool(top)) for top, bore in enumerate(ends)]
    seats = [() if face is None else (face,) for face in flats]
    cones = [countersink(facts, bore, top=bool(top)) for top, bore in enumerate(ends)]
    thread = () if tapped is None else tuple(facts.face(tapped.part, number) for number in tapped.faces)
    into = "" if tapped is None else f", screwed into the hole of {show(2 * tapped.radius, 'm')} in {tapped.part!r}"

    def bolt(
        top: int, head: tuple[FaceFacts, ...], bore: Bore, outer: float, why: str, shape: Head = "hexagon"
    ) -> BoltProposal:
        return BoltProposal(
            axis=stack.axis,
            parts=stack.parts,
            head=head,
            end=thread or seats[not top],
            words=("seat" if head == seats[top] else "countersink", word),
            size=size,
            at=to_nanometres(stack.middle) if tapped is None else None,
            ring=(round(2 * bore.radius, 9), round(outer, 9)),
            shape=shape,
            remark=f"M{size:g} for {_hole(bore)} (ISO 273){into}; {why}",
        )

    heads = (0, 1) if tapped is None else (int(tapped is ends[0]),)  # ends that a head may be at
    for top in heads:
        cone = cones[top]
        if cone is not None and 1e3 * cone.outer >= SUNK * size and (thread or seats[not top]):
            bore = min(stack.bores, key=lambda bore: bore.radius) if tapped is None else ends[top]
            why = "a countersunk head" if thread else "countersunk head, and a nut on a ring as wide"
            return bolt(top, cone.faces, bore, cone.outer, why)
    top = heads[0]
    if tapped is not None:
        if not seats[top]:
            return "have no flat face for a head"
        why = "seat: from the hole to the diameter of its head, ISO 4762"
        return bolt(top, seats[top], ends[top], _socket(size), why, "socket")
    if flats[0] is None or flats[1] is None:
        return "have no flat face for head or nut at an end (a blind hole?)"
    widest = max(ends, key=lambda bore: (bore.slot is not None, bore.radius))
    edge = min(room_around(facts, flats[0], ends[0]), room_around(facts, flats[1], ends[1]))
    outer, why, shape = _pressed_ring(size, edge)
    pin = "; if the holes are those of a dowel, give a [[dowel]] in its place" if like_dowel(stack) else ""
    return bolt(0, seats[0], widest, outer, f"seat: from the hole to the diameter {why}{pin}", shape)


def _washer(size: float) -> float:
    """Outer diameter [m] of the plain washer of a size [mm] (ISO 7089)."""
    washer = metric(size).washer
    return round(1e-3 * (size if washer is None else washer[1]), 9)


def _socket(size: float) -> float:
    """Diameter [m] of the head of the cap screw of a size [mm] (ISO 4762)."""
    return round(1e-3 * (metric(size).socket or size), 9)


def _pressed_ring(size: float, edge: float) -> tuple[float, str, Head]:
    """Outer diameter [m] of the seat of a bolt of a size [mm], where it is from, and the head of the bolt.

    edge: how far the nearest edge of the face is from the axis, by chords [m].
    """
    room = 2 * CHORDS * edge
    if _washer(size) <= room:
        return _washer(size), "of its washer, ISO 7089", "hexagon"
    less = "" if _socket(size) <= room else f", although the face ends {show(room / 2, 'm')} from the axis"
    return _socket(size), f"of its head, ISO 4762{less}", "socket"


def _hole(bore: Bore) -> str:
    wide = show(2 * bore.radius, "m")
    return f"a hole of {wide}" if bore.slot is None else f"a slot {wide} wide"


ALIKE = 1e-3  # of a diameter: holes that differ by less have one


def found_dowels(
    facts: GeometryFacts, fasteners: Fasteners, free: Sequence[Stack], names: FaceNames
) -> tuple[DowelProposal, ...]:
    """The dowels of a geometry.

    Args:
        facts: of the parts that are not left out.
        fasteners: has the pins that are drawn.
        free: rows of holes in which nothing of the file runs.
        names: gives their walls names.
    """
    found = []
    for pin in fasteners.dowels:
        walls = tuple(wall for wall in pin.faces if wall[0].part in facts.by_part)
        found += [replace(pin, faces=walls)] if len(walls) > 1 else []
    for stack in free:
        if takes_dowel(facts, stack):
            walls = tuple(tuple(facts.face(bore.part, number) for number in bore.faces) for bore in stack.bores)
            wide = show(2 * stack.bores[0].radius, "m")
            remark = f"{wide} (ISO 2338), as long as its holes; take it out if there is none"
            found.append(DowelProposal(faces=walls, remark=remark))
    return tuple(
        replace(pin, name=f"dowel {k}", walls=tuple(names.of_several(wall, "dowel") for wall in pin.faces))
        for k, pin in enumerate(found, 1)
    )


def free_rows(facts: GeometryFacts, fasteners: Fasteners) -> list[Stack]:
    """The rows of holes in which no bolt and no dowel of the file runs."""
    aside = {bolt.part for bolt in fasteners.bolts} | {*fasteners.washers}
    drawn = {side for bolt in fasteners.bolts if bolt.drawn for side in bolt.drawn.holes}
    left = [bore for bore in bores(facts) if bore.part not in aside and drawn.isdisjoint(bore.sides)]
    found = rows(left, reach=0.01 * facts.size)
    return [stack for stack in found if not any(fasteners.shanks & bore.sides for bore in stack.bores)]


def takes_dowel(facts: GeometryFacts, stack: Stack) -> bool:
    """Whether a row of holes is one for a dowel: of one diameter of ISO 2338, blind or of no clearance size."""
    if len(stack.bores) < 2 or not like_dowel(stack):
        return False
    low, high = stack.ends
    return size_of(stack) is None or None in (seat(facts, low, top=False), seat(facts, high, top=True))


def like_dowel(stack: Stack) -> bool:
    """Whether round holes have one diameter, which is that of a pin (ISO 2338)."""
    wide = [2e3 * bore.radius for bore in stack.bores]
    one = max(wide) - min(wide) <= ALIKE * wide[0] and all(bore.slot is None for bore in stack.bores)
    return one and any(abs(wide[0] - pin) <= ALIKE * pin for pin in COMMON_PINS)


def size_of(stack: Stack) -> tuple[float, Bore | None] | None:
    """Nominal diameter [mm] of the bolt of a row of holes, and the hole that is its thread; None where none fits."""
    sizes = [size_for_hole(2 * bore.radius) for bore in stack.bores]
    ends = [(stack.bores[-1], sizes[:-1]), (stack.bores[0], sizes[1:])]
    if sizes[0] is not None and len(set(sizes)) == 1:
        return sizes[0], None
    for end, others in ends:
        if others[0] is not None and len(set(others)) == 1 and is_tapped(2 * end.radius, others[0]):
            return others[0], end
    return None
