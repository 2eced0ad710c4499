"""A row of the comparison, and the table."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

HEAD = ("problem", "code", "quantity", "Faying", "other", "difference", "bound", "verdict")


@dataclass(frozen=True, kw_only=True)
class Row:
    """One quantity by both codes; bound: greatest relative difference that the note of its problem justifies."""

    quantity: str
    ours: float
    theirs: float
    bound: float
    unit: str = ""

    @property
    def difference(self) -> float:
        """Of ours from theirs, relative to theirs."""
        return self.ours / self.theirs - 1 if self.theirs else abs(self.ours)

    @property
    def verdict(self) -> str:
        """Within the bound, or above it."""
        return "within" if abs(self.difference) <= self.bound else "above"


@dataclass(frozen=True, kw_only=True)
class Problem:
    """What both codes solve.

    peer: name of the other code; seconds: of the CPU that it takes, both codes; bound: why the bounds are what they
    are; solve: from the interpreter of the peers to the rows.
    """

    name: str
    peer: str
    seconds: float
    bound: str
    solve: Callable[[str], list[Row]]


def worst(quantity: str, ours: Iterable[float], theirs: Iterable[float], *, bound: float, unit: str) -> Row:
    """The row of that pair of a list that differs most; it counts from 1."""
    pairs = [
        Row(quantity=f"{quantity} {k}", ours=float(a), theirs=float(b), bound=bound, unit=unit)
        for k, (a, b) in enumerate(zip(ours, theirs, strict=True), 1)
    ]
    return max(pairs, key=lambda row: abs(row.difference))


def cells(problem: Problem, row: Row) -> tuple[str, ...]:
    """The row as words."""
    unit = f" {row.unit}" if row.unit else ""
    digits = 8 if 0 < abs(row.difference) < 1e-4 else 6
    numbers = (f"{value:.{digits}g}{unit}" for value in (row.ours, row.theirs))
    return (
        problem.name,
        problem.peer,
        row.quantity,
        *numbers,
        f"{row.difference:+.1e}" if row.difference else "0",
        f"{row.bound:.1e}",
        row.verdict,
    )


def plain(rows: list[tuple[str, ...]]) -> str:
    """A table for the terminal."""
    lines = [HEAD, *rows]
    wide = [max(len(line[k]) for line in lines) for k in range(len(HEAD))]
    return "\n".join("  ".join(word.ljust(n) for word, n in zip(line, wide, strict=True)).rstrip() for line in lines)


def markdown(rows: list[tuple[str, ...]]) -> str:
    """The table of docs/peers.md; what repeats from the row above is left out."""
    lines = ["| " + " | ".join(HEAD) + " |", "|" + "---|" * len(HEAD)]
    above: tuple[str, ...] = ("",) * len(HEAD)
    for row in rows:
        same = row[:2] == above[:2]
        lines.append("| | | " + " | ".join(row[2:]) + " |" if same else "| " + " | ".join(row) + " |")
        above = row
    return "\n".join(lines)
