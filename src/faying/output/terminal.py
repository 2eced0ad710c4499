"""Tables and sentences as plain text that a terminal of 80 columns holds."""

from collections.abc import Sequence
from textwrap import wrap

Rows = Sequence[Sequence[str]]
WIDTH = 80  # columns of a terminal
GAP = "  "
MAX_NAME_COLUMNS = 2  # columns of names that each block repeats
MIN_WIDTH = 16  # columns that a folded cell has at least
# heads of columns of names, which go to the left
NAMED = ("preload", "source", "law", "joint", "part", "bolt", "method", "scan")


def text(rows: Rows, left: Sequence[int] | None = None, width: int = WIDTH) -> str:
    """Align rows in columns: those of `left`, or the first two that hold names, to the left, others to the right.

    What is wider than the terminal gets heads of several lines, then words of several lines in the columns to the left.
    Where that is not enough, it gets blocks one below the other, each with the first columns to the left.

    Args:
        rows: cells, the heads first.
        left: columns to the left.
        width: columns of the terminal.
    """
    if not rows:
        return ""
    names = [k for k, head in enumerate(rows[0]) if (k in left if left is not None else k < 2 and head in NAMED)]
    plain = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))]
    if _total(plain) <= width:
        return _lines(rows, plain, names)
    folded = [max(*(len(row[k]) for row in rows[1:]), _word(rows[0][k]), 1) for k in range(len(rows[0]))]
    words = [max(MIN_WIDTH, *(_word(row[k]) for row in rows)) if k in names else plain[k] for k in range(len(plain))]
    whole = _narrowed(folded, words, width)
    if _total(whole) <= width:
        return _lines(rows, _widened(rows[0], whole, width), names)
    kept = [k for k in range(MAX_NAME_COLUMNS) if all(i in names for i in range(k + 1))] or [0]
    blocks: list[list[int]] = [[]]
    for k in range(len(kept), len(plain)):
        if blocks[-1] and _total([folded[i] for i in (*kept, *blocks[-1], k)]) > width:
            blocks.append([])
        blocks[-1].append(k)
    out = []
    for block in blocks:
        columns = [*kept, *block]
        part = [[row[k] for k in columns] for row in rows]
        least = [words[k] if k in names or len(columns) > len(kept) + 1 else MIN_WIDTH for k in columns]
        widths = _widened(part[0], _narrowed([folded[k] for k in columns], least, width), width)
        out.append(_lines(part, widths, [i for i, k in enumerate(columns) if k in names]))
    return "\n\n".join(out)


def indented(rows: Rows, left: Sequence[int] | None = None, width: int = WIDTH) -> list[str]:
    """The lines of aligned rows, two columns in."""
    return [f"{GAP}{line}".rstrip() for line in text(rows, left, width - len(GAP)).splitlines()]


def _total(widths: Sequence[int]) -> int:
    return sum(widths) + len(GAP) * (len(widths) - 1)


def _word(cell: str) -> int:
    """The length of the longest word of a cell."""
    return max(map(len, cell.split()), default=0)


def _narrowed(widths: Sequence[int], least: Sequence[int], width: int) -> list[int]:
    """Widths that fit as far as the least ones allow, the widest column narrowed first."""
    found = list(widths)
    while _total(found) > width:
        able = [k for k in range(len(found)) if found[k] > least[k]]
        if not able:
            break
        found[max(able, key=found.__getitem__)] -= 1
    return found


def _widened(heads: Sequence[str], widths: list[int], width: int) -> list[int]:
    """Widths with the room that is left given to the heads of most lines, one line less at a time."""
    found = list(widths)
    while True:
        heights = [len(wrapped(head, w)) for head, w in zip(heads, found, strict=True)]
        most = heights.index(max(heights))
        if heights[most] == 1:
            return found
        head = heads[most]
        wider = next(w for w in range(found[most], len(head) + 1) if len(wrapped(head, w)) < heights[most])
        if _total(found) + wider - found[most] > width:
            return found
        found[most] = wider


def _lines(rows: Rows, widths: Sequence[int], names: Sequence[int]) -> str:
    """Rows in columns of these widths; a head that has fewer lines than another stands at the bottom."""
    lines = []
    for number, row in enumerate(rows):
        cells = [wrapped(cell, w) for cell, w in zip(row, widths, strict=True)]
        height = max(map(len, cells))
        full = [[*[""] * (height - len(cell)), *cell] if number == 0 else [*cell, *[""] * height] for cell in cells]
        for i in range(height):
            line = [
                cell[i].ljust(w) if k in names else cell[i].rjust(w)
                for k, (cell, w) in enumerate(zip(full, widths, strict=True))
            ]
            lines.append(GAP.join(line).rstrip())
    return "\n".join(lines)


def wrapped(sentence: str, width: int = WIDTH, first: str = "", rest: str = "") -> list[str]:
    """The lines of a sentence; first, rest: what stands before its first line and before the others.

    What fits is left as it is, and words stay whole.
    """
    if len(first) + len(sentence) <= width:
        return [first + sentence]
    return wrap(
        sentence, width, initial_indent=first, subsequent_indent=rest, break_long_words=False, break_on_hyphens=False
    ) or [""]


def folded(words: str, width: int = WIDTH) -> str:
    """A text whose sentences fit the terminal, their further lines two columns in; lines of tables stay as they are."""
    lines = []
    for line in words.split("\n"):
        bare = line.strip()
        margin = line[: len(line) - len(line.lstrip())]
        if len(line) <= width or GAP in bare:
            lines.append(line)
        else:
            lines += wrapped(bare, width, first=margin, rest=margin + GAP)
    return "\n".join(lines)
