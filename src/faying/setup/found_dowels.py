"""Dowels of a geometry: pins that are drawn as parts, and rows of holes of one diameter that take a pin."""

from collections.abc import Sequence
from dataclasses import replace

from faying.bolt.standards import COMMON_PINS, is_tapped, size_for_hole
from faying.geometry.bores import Bore, Stack, bores, rows, seat
from faying.geometry.face_facts import GeometryFacts
from faying.setup.face_names import FaceNames
from faying.setup.fasteners import DowelProposal, Fasteners
from faying.units import show

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
            remark = (
                f"{show(2 * stack.bores[0].radius, 'm')} (ISO 2338), as long as its holes; take it out if there is none"
            )
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
