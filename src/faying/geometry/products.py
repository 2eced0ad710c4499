"""Names of products in a STEP file: the kernel hands on the tree of an assembly, with the names of occurrences alone.

The product behind each occurrence is read from the text of the file: PRODUCT, its definitions, and the occurrences
(NEXT_ASSEMBLY_USAGE_OCCURRENCE) that place one definition in another (ISO 10303-21, -41 and -44).
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

_ENTITY = re.compile(
    r"#(\d+)\s*=\s*(PRODUCT|PRODUCT_DEFINITION|PRODUCT_DEFINITION_WITH_ASSOCIATED_DOCUMENTS|"
    r"PRODUCT_DEFINITION_FORMATION|PRODUCT_DEFINITION_FORMATION_WITH_SPECIFIED_SOURCE|"
    r"NEXT_ASSEMBLY_USAGE_OCCURRENCE)\s*\("
)
_ARGUMENT = re.compile(r"'((?:[^']|'')*)'|#(\d+)|/\*.*?\*/|([(),])|[^'#(),/]+|/", re.DOTALL)
_ESCAPE = re.compile(
    r"\\X2\\((?:[0-9A-Fa-f]{4})+)\\X0\\|\\X4\\((?:[0-9A-Fa-f]{8})+)\\X0\\|\\X\\([0-9A-Fa-f]{2})|\\S\\(.)"
)
PLACEHOLDER = "Open CASCADE STEP translator"  # what the kernel writes for want of a name
COUNTED = re.compile(r"(?:NAUO|=>\[[^\]]*\])?\s*\d*")  # names of occurrences that only count them


@dataclass(frozen=True, kw_only=True)
class Occurrence:
    """A definition that is placed in another: its words (name, id, description) and the definitions' numbers."""

    words: tuple[str, ...]
    inside: int
    of: int


@dataclass(frozen=True, kw_only=True)
class Products:
    """Products of a file: name by number of definition, and the occurrences of definitions in each other."""

    names: Mapping[int, str]
    occurrences: tuple[Occurrence, ...]

    @property
    def roots(self) -> set[int]:
        """Definitions that are placed in no other."""
        return set(self.names) - {one.of for one in self.occurrences}

    def below(self, definitions: set[int], label: str) -> list[Occurrence]:
        """Occurrences of this label in any of the definitions."""
        return [one for one in self.occurrences if one.inside in definitions and label in one.words]


@dataclass(frozen=True, kw_only=True)
class Leaf:
    """A shape of an assembly in its place; product and occurrence are "" where the file does not tell them apart."""

    shape: Any
    product: str
    occurrence: str


def read_products(text: str) -> Products:
    """Read products and occurrences from the text of a STEP file."""
    entities: dict[str, dict[int, list[str | int]]] = {}
    for found in _ENTITY.finditer(text):
        kind = found[2].replace("_WITH_SPECIFIED_SOURCE", "").replace("_WITH_ASSOCIATED_DOCUMENTS", "")
        entities.setdefault(kind, {})[int(found[1])] = list(_arguments(text, found.end()))
    names = {number: _name(words) for number, words in entities.get("PRODUCT", {}).items()}
    for kind in ("PRODUCT_DEFINITION_FORMATION", "PRODUCT_DEFINITION"):  # each refers to one of the kind before
        made = entities.get(kind, {}).items()
        names = {number: names[at] for number, words in made for at in words if isinstance(at, int) and at in names}
    occurrences = []
    for words in entities.get("NEXT_ASSEMBLY_USAGE_OCCURRENCE", {}).values():
        texts = [word for word in words if isinstance(word, str)]
        at = [word for word in words if isinstance(word, int)]
        if len(at) >= 2 and at[0] in names and at[1] in names:
            order = (*texts[1:2], *texts[:1], *texts[2:3])  # the name first, then the id
            occurrences.append(Occurrence(words=tuple(order), inside=at[0], of=at[1]))
    return Products(names=names, occurrences=tuple(occurrences))


def leaves(tree: Any, products: Products) -> list[Leaf]:
    """The placed shapes of the kernel's tree, each with its product and the name of its occurrence."""
    out: list[Leaf] = []

    def walk(node: Any, definitions: set[int], occurrence: str) -> None:
        children = list(node.children)
        if not children:
            names = {products.names[number] for number in definitions}
            if not node.is_assembly and node.shape is not None:
                product = names.pop() if len(names) == 1 else ""
                out.append(Leaf(shape=node.shape, product=product, occurrence=occurrence))
            return
        for child in children:
            found = products.below(definitions, child.name)
            given = {one.words[0] for one in found}
            walk(child, {one.of for one in found}, given.pop() if len(given) == 1 else "")

    for top in tree.children:
        named = {number for number in products.roots if products.names[number] == top.name}
        walk(top, named or products.roots, "")
    return out


def named_by_product(solids: Sequence[Any], found: Sequence[Leaf]) -> list[str]:
    """The name of each solid after its product, "" where there is none that tells it from the others.

    Solids that one product holds together have its name where the file holds several products. Where a product occurs
    several times, the names of its occurrences stand for it, if they are names and differ.
    """
    out = [""] * len(solids)
    several = len(found) > 1
    owned: dict[str, list[tuple[int, str]]] = {}
    for leaf in found:
        own_solids = [k for k, solid in enumerate(solids) if any(solid == one for one in leaf.shape.solids)]
        if leaf.product.startswith(PLACEHOLDER) or not leaf.product.strip() or (len(own_solids) > 1 and not several):
            continue
        for k in own_solids:
            owned.setdefault(leaf.product, []).append((k, leaf.occurrence if len(own_solids) == 1 else ""))
    for product, places in owned.items():
        called = [occurrence for _, occurrence in places]
        apart = len(set(called)) == len(called) > 1 and not any(COUNTED.fullmatch(word) for word in called)
        for k, occurrence in places:
            out[k] = occurrence if apart else product
    return out


def _name(words: Sequence[str | int]) -> str:
    """The name of a product, its id where that is empty."""
    texts = [word for word in words if isinstance(word, str)]
    return next((word for word in (*texts[1:2], *texts[:1]) if word.strip()), "")


def _arguments(text: str, start: int) -> Iterator[str | int]:
    """Texts and references among the arguments of an entity, from behind its bracket on; not those of lists within."""
    depth = 1
    for found in _ARGUMENT.finditer(text, start):
        if found[3] == "(":
            depth += 1
        elif found[3] == ")":
            depth -= 1
            if not depth:
                return
        elif depth == 1 and found[1] is not None:
            yield decoded(found[1])
        elif depth == 1 and found[2]:
            yield int(found[2])


def decoded(text: str) -> str:
    r"""Text as a STEP file writes it, with '' for ' and \X2\...\X0\ for letters outside of ASCII."""

    def letter(found: re.Match[str]) -> str:
        if found[1]:
            return bytes.fromhex(found[1]).decode("utf-16-be", errors="replace")
        if found[2]:
            return bytes.fromhex(found[2]).decode("utf-32-be", errors="replace")
        return chr(int(found[3], 16)) if found[3] else chr(ord(found[4]) + 128)

    return _ESCAPE.sub(letter, text.replace("''", "'")).replace("\\\\", "\\")
