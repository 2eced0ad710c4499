"""Small pieces of reStructuredText."""

import re
from collections.abc import Iterable, Sequence

DOI = re.compile(r"\bdoi:\s?(10\.\d{4,}/[^\s,;]*[^\s,;.])")
LITERAL = re.compile(r"(`[^`\n]+`)")


def escape(text: str) -> str:
    """Return text that reStructuredText takes as it is; `code` stays code, and a DOI becomes a link."""
    parts = []
    for part in LITERAL.split(text):
        if LITERAL.fullmatch(part):
            parts.append(f"`{part}`")
            continue
        plain = re.sub(r"([\\*|`_<>])", r"\\\1", part)
        parts.append(DOI.sub(_link, plain))
    return re.sub(r"(\w)(``[^`]+``)", r"\1\\ \2", re.sub(r"(``[^`]+``)(\w)", r"\1\\ \2", "".join(parts)))


def _link(found: re.Match[str]) -> str:
    written = found[1]
    # a bracket that was opened before the DOI does not belong to it
    end = written[-1] == ")" and written.count(")") > written.count("(")
    inside = written[:-1] if end else written
    return f"`doi:{inside} <https://doi.org/{inside.replace(chr(92), '')}>`__" + (r"\ )" if end else "")


def heading(text: str, line: str = "-") -> list[str]:
    """A section's title."""
    return [text, line * len(text), ""]


def table(head: Sequence[str], rows: Iterable[Sequence[str]], widths: Sequence[int] = ()) -> list[str]:
    """Return a table, without a heading where `head` is empty; cells are reStructuredText of one line."""
    lines = [".. list-table::", *(["   :header-rows: 1"] if head else [])]
    if widths:
        lines.append(f"   :widths: {' '.join(map(str, widths))}")
    lines.append("")
    for row in ([head] if head else []) + list(rows):
        lines += [f"   {'* -' if i == 0 else '  -'} {cell}".rstrip() for i, cell in enumerate(row)]
    return [*lines, ""]


def indented(lines: Iterable[str], by: int = 3) -> list[str]:
    """Lines moved to the right."""
    return [" " * by + line if line else "" for line in lines]
