"""Bolts that the holes of a geometry ask for: through bolts, screws, countersunk screws, bolts in T-slots."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from faying.bolt.compliance import Head
from faying.bolt.standards import COMMON, METRIC, is_tapped, metric, nearest_size, size_for_hole
from faying.bolt.tapped import ENGAGED
from faying.geometry.bores import Bore, Stack, room_around, seat
from faying.geometry.face_facts import FaceFacts, GeometryFacts, TouchingFaces
from faying.geometry.seats import Countersink, countersink, lips
from faying.setup.bolt_proposal import BoltProposal, to_nanometres
from faying.setup.fastener_forms import DRAWN
from faying.setup.fasteners import Fasteners, MeshedBolt, quoted
from faying.setup.found_dowels import free_rows, like_dowel, size_of, takes_dowel
from faying.typing import Array
from faying.units import show

CHORDS = 1.02  # by so much a round edge is wider than its chords
WIDEST = 1.1e-3 * METRIC[max(COMMON)].holes[2]  # m: wider holes are for no bolt that is known here
SUNK = 1.6  # nominal diameters from which a cone at the mouth of a hole is a countersink, and no chamfer
PLACES = 3  # rows of holes whose places a remark says


@dataclass
class LeftOut:
    """Rows of holes that take no bolt: why, with the places [m] of all for which the same is to be said."""

    places: dict[tuple[str, str], list[Array]] = field(default_factory=dict)

    def add(self, stack: Stack, why: str) -> None:
        """Note a row of holes."""
        widths = ", ".join(f"{2e3 * bore.radius:.4g} mm in {bore.part!r}" for bore in stack.bores)
        self.places.setdefault((widths, why), []).append(stack.middle)

    @property
    def remarks(self) -> Iterator[str]:
        """One line for all that are alike."""
        for (widths, why), places in self.places.items():
            where = ", ".join(f"({', '.join(f'{1e3 * x:.4g}' for x in place)})" for place in places[:PLACES])
            more = f" and {len(places) - PLACES} more" if len(places) > PLACES else ""
            many = f"{len(places)} rows of holes" if len(places) > 1 else "holes"
            yield f"{many} about {where}{more} mm ({widths}) {why}"


def found_bolts(
    facts: GeometryFacts, fasteners: Fasteners, joints: Sequence[TouchingFaces], out: LeftOut
) -> list[BoltProposal]:
    """The bolts of a geometry: parts that are bolts, bolts that are drawn, and rows of holes that take one.

    Args:
        facts: of the parts that are not left out.
        fasteners: parts that are bolts.
        joints: the planes that touch.
        out: takes the rows of holes that have no bolt.
    """
    found = [*(_meshed(facts, bolt) for bolt in fasteners.meshed), *fasteners.drawn]
    met = {side for contact in joints for side in contact.sides}
    for stack in (one for row in free_rows(facts, fasteners) for one in _from_both_sides(row)):
        if 2 * min(bore.radius for bore in stack.bores) > WIDEST or takes_dowel(facts, stack):
            continue  # a pipe, a bearing, or a dowel
        bolt = _in_slot(facts, stack) or (_in_row(facts, stack, out) if len(stack.bores) > 1 else None)
        if bolt is not None:
            found.append(bolt)
        elif len(stack.bores) == 1 and _opens(facts, stack.bores[0], met):
            out.add(stack, "end at a joint, where no hole and no slot of another part takes a bolt: left out")
    return [_in_shared_thread(bolt, found) for bolt in found]


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


def _meshed(facts: GeometryFacts, bolt: MeshedBolt) -> BoltProposal:
    assert bolt.shank.radius is not None
    size = nearest_size(2e3 * bolt.shank.radius, lambda one: one.size, DRAWN)
    clamped = {part for contact in facts.contacts if bolt.part in contact.parts for part in contact.parts}
    return BoltProposal(
        axis=np.array(bolt.shank.axis),
        parts=tuple(sorted(clamped - {bolt.part})),
        head=(bolt.head,),
        end=(bolt.nut,),
        words=("head", "nut"),
        size=size,
        part=bolt.part,
        remark=f"the part {bolt.part!r} is the bolt"
        + "; it has no play: if it is a rivet, give the force that it was set with" * bolt.tight,
    )


def _opens(facts: GeometryFacts, bore: Bore, met: set[tuple[str, int]]) -> bool:
    """Whether a clearance hole ends at a face that another part touches."""
    near = {other for number in bore.faces for other in facts.face(bore.part, number).neighbours}
    return size_for_hole(2 * bore.radius) is not None and any((bore.part, number) in met for number in near)


def _in_slot(facts: GeometryFacts, stack: Stack) -> BoltProposal | None:
    """A bolt whose nut, or head, pulls the lips of a T-slot beyond the end of a row of clearance holes."""
    sizes = {size_for_hole(2 * bore.radius) for bore in stack.bores}
    size = sizes.pop()
    if sizes or size is None:
        return None
    hole = 2 * max(bore.radius for bore in stack.bores)
    outer = _washer(size)
    ends = {True: stack.ends[1], False: stack.ends[0]}
    for top, bore in ends.items():
        found = lips(facts, bore, top=top, shank=size / 1e3, ring=(hole, outer))
        under = seat(facts, ends[not top], top=not top) if found else None
        if not found or under is None:
            continue
        room = 2 * CHORDS * room_around(facts, under, ends[not top])
        outer, why = _outer(size, room)
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
            shape=_shape(size, outer),
            remark=(
                f"M{size:g} for a hole of {show(hole, 'm')} (ISO 273), in a T-slot of {owner!r}; "
                f"seats: from the hole to the diameter {why}, on the lips as far as they reach"
            ),
        )
    return None


def _in_row(facts: GeometryFacts, stack: Stack, out: LeftOut) -> BoltProposal | None:
    """The bolt of a row of holes through several parts; None, noted in `out`, where none fits."""
    found = size_of(stack)
    low, high = stack.ends
    ends = seat(facts, low, top=False), seat(facts, high, top=True)
    if found is None:
        out.add(stack, "are clearance holes of no common bolt (M3 to M24, ISO 273): left out")
        return None
    size, tapped = found
    sunk: dict[bool, Countersink] = {}
    for top, bore in ((False, low), (True, high)):
        cone = countersink(facts, bore, top=top)
        if cone is not None and 1e3 * cone.outer >= SUNK * size:
            sunk[top] = cone
    if tapped is not None:
        end, top = (high, True) if tapped is low else (low, False)
        under = seat(facts, end, top=top)
        if top in sunk:
            return _screw(facts, stack, (end, sunk[top].faces), tapped, size, sunk[top].outer)
        if under is not None:
            return _screw(facts, stack, (end, (under,)), tapped, size, None)
        out.add(stack, "have no flat face for a head: left out")
        return None
    for top, cone in sunk.items():
        nut = ends[not top]
        if nut is not None:
            return _sunk(stack, cone.faces, nut, size, cone.outer)
    if ends[0] is None or ends[1] is None:
        out.add(stack, "have no flat face for head or nut at an end (a blind hole?): left out")
        return None
    return _through(facts, stack, (ends[0], ends[1]), size)


def _washer(size: float) -> float:
    """Outer diameter [m] of the plain washer of a size [mm] (ISO 7089)."""
    washer = metric(size).washer
    return round(1e-3 * (size if washer is None else washer[1]), 9)


def _socket(size: float) -> float:
    """Diameter [m] of the head of the cap screw of a size [mm] (ISO 4762)."""
    return round(1e-3 * (metric(size).socket or size), 9)


def _shape(size: float, outer: float) -> Head:
    """The head of a bolt whose seat has an outer diameter [m] of `_outer`."""
    return "hexagon" if outer == _washer(size) else "socket"


def _outer(size: float, room: float) -> tuple[float, str]:
    """Outer diameter [m] of the seat of a bolt of a size [mm] in a room [m] around its axis, and where it is from."""
    washer, head = _washer(size), _socket(size)
    outer, why = (washer, "of its washer, ISO 7089") if washer <= room else (head, "of its head, ISO 4762")
    if outer > room:
        why += f", although the face ends {show(room / 2, 'm')} from the axis"
    return outer, why


def _screw(
    facts: GeometryFacts,
    stack: Stack,
    head: tuple[Bore, tuple[FaceFacts, ...]],
    tapped: Bore,
    size: float,
    sunk: float | None,
) -> BoltProposal:
    """A screw into a tapped hole; head: the hole under its head, and the faces that it presses; sunk: as of `_sunk`."""
    bore, under = head
    why = "seat: from the hole to the diameter of its head, ISO 4762" if sunk is None else "a countersunk head"
    return BoltProposal(
        axis=stack.axis,
        parts=stack.parts,
        head=under,
        end=tuple(facts.face(tapped.part, number) for number in tapped.faces),
        words=("seat" if sunk is None else "countersink", "thread"),
        size=size,
        ring=(round(2 * bore.radius, 9), _socket(size) if sunk is None else round(sunk, 9)),
        shape="hexagon" if sunk is not None else "socket",
        remark=(
            f"M{size:g} for {_hole(bore)} (ISO 273), screwed into the hole of "
            f"{show(2 * tapped.radius, 'm')} in {tapped.part!r}; {why}"
        ),
    )


def _sunk(stack: Stack, cone: tuple[FaceFacts, ...], nut: FaceFacts, size: float, outer: float) -> BoltProposal:
    """A countersunk screw with a nut; outer: diameter [m] at the wide end of the cone."""
    hole = 2 * min(bore.radius for bore in stack.bores)
    return BoltProposal(
        axis=stack.axis,
        parts=stack.parts,
        head=cone,
        end=(nut,),
        words=("countersink", "seat"),
        size=size,
        at=to_nanometres(stack.middle),
        ring=(round(hole, 9), round(outer, 9)),
        remark=f"M{size:g} for a hole of {show(hole, 'm')} (ISO 273); countersunk head, and a nut on a ring as wide",
    )


def _through(facts: GeometryFacts, stack: Stack, ends: tuple[FaceFacts, FaceFacts], size: float) -> BoltProposal:
    last = stack.ends
    widest = max(last, key=lambda bore: (bore.slot is not None, bore.radius))
    room = 2 * CHORDS * min(room_around(facts, end, bore) for end, bore in zip(ends, last, strict=True))
    outer, why = _outer(size, room)
    pin = "" if not like_dowel(stack) else "; if the holes are those of a dowel, give a [[dowel]] in its place"
    return BoltProposal(
        axis=stack.axis,
        parts=stack.parts,
        head=(ends[0],),
        end=(ends[1],),
        size=size,
        at=to_nanometres(stack.middle),
        ring=(round(2 * widest.radius, 9), outer),
        shape=_shape(size, outer),
        remark=f"M{size:g} for {_hole(widest)} (ISO 273); seat: from the hole to the diameter {why}{pin}",
    )


def _hole(bore: Bore) -> str:
    wide = show(2 * bore.radius, "m")
    return f"a hole of {wide}" if bore.slot is None else f"a slot {wide} wide"


def clamped_along(found: Sequence[BoltProposal], one: str, two: str) -> list[Array]:
    """Axes of the bolts that clamp two parts together."""
    return [bolt.axis for bolt in found if one in bolt.parts and two in bolt.parts]


def shoulders(
    facts: GeometryFacts, joints: Sequence[TouchingFaces], found: Sequence[BoltProposal]
) -> list[TouchingFaces]:
    """Faces that touch along the bolts of their two parts, as the shoulder of a stepped lap: no bolt presses them."""
    out = []
    for contact in joints:
        axes = clamped_along(found, *contact.parts)
        normal = np.array(facts.face(*contact.first).normal)
        if axes and max(abs(float(normal @ axis)) for axis in axes) < 0.5:
            out.append(contact)
    return out


def shoulder_remark(contacts: Sequence[TouchingFaces]) -> str:
    """What there is to say of shoulders."""
    between = "; ".join(quoted(pair) for pair in dict.fromkeys(contact.parts for contact in contacts))
    return (
        f"{len(contacts)} pairs of faces that touch along the bolts of {between} (shoulders, registers) are not joints,"
        " since no bolt presses them: left out; add a [[joint]] if they do carry load"
    )
