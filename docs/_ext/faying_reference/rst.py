"""Small pieces of reStructuredText."""

import re
from collections.abc import Iterable, Sequence
from typing import ClassVar

from docutils import nodes
from docutils.parsers.rst import directives
from sphinx.util.docutils import SphinxDirective

DOI = re.compile(r"\bdoi:\s?(10\.\d{4,}/[^\s,;]*[^\s,;.])")
BETWEEN = "\u241f"  # between the cells of a row
LITERAL = re.compile(r"(`[^`\n]+`)")


def escape(text: str) -> str:
    """Return text that reStructuredText takes as it is; `code` stays code, and a DOI becomes a link."""
    out = ""
    for part in LITERAL.split(text):
        literal = LITERAL.fullmatch(part) is not None
        ready = f"`{part}`" if literal else DOI.sub(_link, re.sub(r"([\\*|`_<>])", r"\\\1", part))
        # code ends and begins where no word touches it
        between = (
            "\\ " if out and part and (out[-1] == "`" or literal) and (part[0].isalnum() or out[-1].isalnum()) else ""
        )
        out += between + ready
    return out


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
    options = ["   :header:"] if head else []
    if widths:
        options.append(f"   :widths: {' '.join(map(str, widths))}")
    lines = [
        "   " + BETWEEN.join(" ".join(cell.split()) or "\\ " for cell in row)
        for row in ([head] if head else []) + list(rows)
    ]
    return [".. cells::", *options, "", *lines, ""]


class Cells(SphinxDirective):
    """A table with a row on each line and a sign of its own between the cells: `list-table` takes ten times as long."""

    has_content = True
    option_spec: ClassVar = {"header": directives.flag, "widths": directives.positive_int_list}

    def run(self) -> list[nodes.Node]:
        """Return the table."""
        rows = [self._row(line) for line in self.content]
        size = max(len(row.children) for row in rows)
        widths = self.options.get("widths") or [1] * size
        group = nodes.tgroup(cols=size)
        group += [nodes.colspec(colwidth=width) for width in widths]
        if "header" in self.options:
            group += nodes.thead("", rows.pop(0))
        group += nodes.tbody("", *rows)
        return [nodes.table("", group, classes=["colwidths-given"] if "widths" in self.options else [])]

    def _row(self, line: str) -> nodes.row:
        row = nodes.row()
        for cell in line.split(BETWEEN):
            inline, messages = self.parse_inline(cell)
            row += nodes.entry("", nodes.paragraph("", "", *inline), *messages)
        return row


def indented(lines: Iterable[str], by: int = 3) -> list[str]:
    """Lines moved to the right."""
    return [" " * by + line if line else "" for line in lines]
