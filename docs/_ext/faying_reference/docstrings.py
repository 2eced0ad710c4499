"""Our docstrings as reStructuredText: Args, Returns, Raises and Source, and plain text that is no markup."""

import re
from collections.abc import Sequence
from itertools import groupby
from typing import Any

from sphinx.application import Sphinx

from faying_reference.rst import escape, indented

SECTIONS = {"Args": "Parameters", "Returns": "Returns", "Raises": "Raises", "Source": "Source"}
ENTRY = re.compile(r"([\w*.]+(?:, [\w*.]+)*): (.*)")


def rendered(lines: Sequence[str]) -> list[str]:
    """Return a docstring as reStructuredText."""
    out: list[str] = []
    rest = list(lines)
    while rest:
        name = rest[0].rstrip(":")
        if rest[0].endswith(":") and name in SECTIONS:
            body = _block(rest[1:])
            rest = rest[1 + len(body) :]
            inside = [line[4:] for line in body]
            text = _entries(inside) if name in ("Args", "Raises") else plain(inside)
            out += [f":{SECTIONS[name]}:", *indented(text), ""]
        else:
            size = next(
                (i for i, line in enumerate(rest) if line.endswith(":") and line.rstrip(":") in SECTIONS), len(rest)
            )
            out += plain(rest[:size])
            rest = rest[size:]
    return out


def _block(lines: Sequence[str]) -> list[str]:
    size = next((i for i, line in enumerate(lines) if line and not line.startswith("    ")), len(lines))
    return list(lines[:size])


def _entries(lines: Sequence[str]) -> list[str]:
    """Return `name: text` entries as a list; a line that is farther in goes on with the entry before it."""
    out: list[str] = []
    for line in (one for one in lines if one.strip()):
        found = ENTRY.fullmatch(line)
        if found and not line.startswith(" "):
            names = ", ".join(f"**{escape(name)}**" for name in found[1].split(", "))
            out.append(f"* {names}: {escape(found[2])}")
        elif out:
            out.append(f"  {escape(line.strip())}")
        else:
            out.append(f"* {escape(line.strip())}")
    return [*out, ""]


def plain(lines: Sequence[str]) -> list[str]:
    """Paragraphs, lists and indented lines, with every sign taken as it is written."""
    out: list[str] = []
    for empty, group in groupby(lines, key=lambda line: not line.strip()):
        if empty:
            continue
        part = list(group)
        if part[0].startswith("  "):
            out += ["", ".. code-block:: text", "", *indented(line.rstrip() for line in part), ""]
            continue
        for line in part:
            if line.startswith("- "):
                out += ["", f"* {escape(line[2:])}"]
            elif line.startswith("  "):
                out.append(f"  {escape(line.strip())}")
            else:
                out.append(escape(line))
        out.append("")
    return out


def process(_app: Sphinx, _what: str, _name: str, _obj: Any, _options: Any, lines: list[str]) -> None:
    """Render in place, for autodoc."""
    lines[:] = rendered(lines)
