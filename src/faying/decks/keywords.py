"""What the decks of CalculiX and Abaqus share: keyword blocks, orientations, springs, the law as a contact table."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import count
from pathlib import Path

import numpy as np

from faying.decks.deck import ContactProperty, JointDeck, grouped, members, real, reals
from faying.decks.raw import check_included, read_text
from faying.errors import InputError, ReadError
from faying.files import named_by
from faying.typing import Array, Index

DATA = {"NODE", "ELEMENT", "NSET", "ELSET", "SURFACE"}


@dataclass(frozen=True)
class Block:
    """A keyword with its parameters and the data lines below it."""

    keyword: str
    options: dict[str, str]
    lines: list[str]
    where: str

    def rows(self) -> list[list[str]]:
        """The entries of each data line."""
        return [[word.strip() for word in line.split(",")] for line in self.lines]

    def words(self) -> list[str]:
        """All entries that are not empty."""
        return [word for row in self.rows() for word in row if word]


def blocks(path: Path) -> Iterator[Block]:
    """Keyword blocks of a file and of the files it includes."""
    current: Block | None = None
    for where, line in _lines(path):
        if isinstance(line, Block):
            if current is not None:
                yield current
            current = line
        elif current is not None:
            current.lines.append(line)
        elif re.match(r"\s*[-+]?[\d.]+\s*(,|$)", line):  # numbers, where a title is none
            raise ReadError(f"{where}: data before the first keyword; is this an Abaqus input file?")
    if current is not None:
        yield current


def _lines(
    path: Path, seen: tuple[Path, ...] = (), count: list[int] | None = None
) -> Iterator[tuple[str, Block | str]]:
    """Where each line stands, and the line: a keyword as a block without data, or data.

    The lines of a file that *INCLUDE or INPUT= names stand in the place of that name; comments are left out.
    """
    count = [0] if count is None else count
    check_included(path, seen, count)
    lines = iter(enumerate(read_text(path, "input file").splitlines(), 1))
    for number, line in lines:
        where = f"{path.name}, line {number}"
        if not line.strip() or line.lstrip().startswith("**"):
            continue
        if not line.lstrip().startswith("*"):  # blanks may stand before a keyword
            yield where, line
            continue
        while line.rstrip().endswith(","):
            more = next(lines, None)
            if more is None:
                raise ReadError(f"{where}: the file ends within a keyword; is it complete?")
            line = line.rstrip() + more[1]
        block = _keyword(line.lstrip(), where)
        if block.keyword != "INCLUDE":
            yield where, block
        elif "INPUT" not in block.options:
            raise ReadError(f"{where}: *INCLUDE without INPUT=file")
        if block.keyword in {"INCLUDE", *DATA} and "INPUT" in block.options:
            yield from _lines(named_by(path, block.options["INPUT"]), (*seen, path.resolve()), count)


def _keyword(line: str, where: str) -> Block:
    """A keyword with its parameters, whose values may stand in quotes with commas in them."""
    name, *rest = re.findall(r'(?:"[^"]*"|[^,])+', line[1:]) or [""]
    pairs = (part.partition("=") for part in rest if part.strip())
    options = {key.strip().upper(): value.strip().strip('"') for key, _, value in pairs}
    return Block(re.sub(r"\s+", " ", name.strip().upper()), options, [], where)


def orientations(deck: JointDeck) -> tuple[list[str], Index]:
    """Keyword lines of the axes of all pairs, and which of them each pair takes; their names are JKA0, JKA1, ...

    The first local axis is the normal, the second a tangent.
    """
    first, group = grouped(deck.axes)
    lines = []
    for g, leader in enumerate(first):
        lines += [f"*ORIENTATION,NAME=JKA{g},SYSTEM=RECTANGULAR", reals(deck.axes[leader, :2].ravel())]
    return lines, group


def springs(deck: JointDeck, note: str, dampers: Array | None = None) -> str:
    """Write SPRING2 elements of one direction each, equal ones together, and DASHPOT2 of dampers (p, 3, 3).

    Raises InputError as `NodePairs.own`.
    """
    lines, axes = orientations(deck)
    one, two = deck.ends
    number = count(deck.first_element)
    for keyword, label, blocks in (("SPRING", "JK", deck.stiffness), ("DASHPOT", "JC", dampers)):
        values = np.zeros((len(one), 3)) if blocks is None else deck.pairs.own(blocks)  # along normal and tangents
        scale = max(float(np.abs(values).max()), 1e-300)
        for axis in range(3):
            first, group = grouped(np.column_stack([axes, values[:, axis] / scale]))
            for g, (leader, some) in enumerate(zip(first, members(group), strict=True)):
                if values[leader, axis] == 0:
                    continue
                name = f"{label}{axis + 1}_{g}"
                lines.append(f"*ELEMENT,TYPE={keyword}2,ELSET={name}")
                lines += [f"{next(number)},{one[i]},{two[i]}" for i in some]
                lines.append(f"*{keyword},ELSET={name},ORIENTATION=JKA{axes[leader]}")
                lines += [f"{axis + 1},{axis + 1}", real(float(values[leader, axis]), 20)]
    return "\n".join([*deck.header("**", note), *lines]) + "\n"


def interaction(deck: JointDeck) -> tuple[list[str], ContactProperty]:
    """Lines of a surface interaction JK with pressure over overclosure in the deck's units, and the contact it is."""
    contact = deck.contact
    if contact is None:
        raise InputError("the law gives no curve of pressure against approach; export springs")
    rows = np.column_stack([contact.pressure * deck.system.pressure, contact.approach * deck.system.metre])
    lines = ["*SURFACE INTERACTION,NAME=JK", "*SURFACE BEHAVIOR,PRESSURE-OVERCLOSURE=TABULAR", "0.,0."]
    return [*lines, *map(reals, rows)], contact
