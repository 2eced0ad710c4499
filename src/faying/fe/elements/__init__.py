"""The elements, one shape a file; every file of this folder that lists ELEMENTS is found."""

from importlib import import_module
from pkgutil import iter_modules

from faying.fe.elements.element import Element as Element

_MODULES = [import_module(f"{__name__}.{module.name}") for module in iter_modules(__path__) if module.name != "element"]
KINDS: dict[str, Element] = {
    element.name: element
    for element in sorted((e for module in _MODULES for e in module.ELEMENTS), key=lambda e: (e.dimension, e.count))
}
SOLIDS = {element.count: element for element in KINDS.values() if element.dimension == 3}
FACES = {element.count: element for element in KINDS.values() if element.dimension == 2}


def from_edges(kind: str, edges: tuple[tuple[int, int], ...]) -> list[int]:
    """Order that turns a list of nodes whose middle nodes follow `edges` into VTK's order."""
    corners = KINDS[kind].corners
    place = {frozenset(edge): corners + i for i, edge in enumerate(edges)}
    return [*range(corners), *(place[frozenset(edge)] for edge in KINDS[kind].edges)]
