"""The table of published numbers that the tests compare with, from the file that they write."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from faying_reference.rst import escape, heading, table
from faying_reference.tables import Section

ENTRIES = Path(__file__).parents[2] / "validation.json"


class Validation(Section):
    """Two parts, what was measured first, with a section for each source."""

    def lines(self) -> list[str]:
        """Return the sections."""
        self.env.note_dependency(str(ENTRIES))
        entries = json.loads(ENTRIES.read_text(encoding="utf-8"))
        measured = [entry for entry in entries if entry.get("measured")]
        out = [*heading("Measured"), *_counts(measured), *_sections(measured)]
        rest = [entry for entry in entries if not entry.get("measured")]
        return [*out, *heading("Verified against other computations and standards"), *_counts(rest), *_sections(rest)]


def _counts(entries: Sequence[Mapping[str, Any]]) -> list[str]:
    sources = len({entry["source"] for entry in entries})
    return [f"{len(entries)} numbers of {sources} sources.", ""]


def _sections(entries: Sequence[Mapping[str, Any]]) -> list[str]:
    out: list[str] = []
    for source in dict.fromkeys(entry["source"] for entry in entries):
        own = [entry for entry in entries if entry["source"] == source]
        out += heading(_title(source), "~")
        out += [escape(f"{len(own)} {'number' if len(own) == 1 else 'numbers'}, {source}."), ""]
        out += table(HEAD, [_row(entry) for entry in own], (44, 15, 15, 13, 13))
        for why in dict.fromkeys(entry["why"] for entry in own if entry["why"]):
            out += [escape(f"What explains the difference or the tolerance: {why}."), ""]
        out += [escape(f"Run with version {', '.join(dict.fromkeys(entry['version'] for entry in own))}."), ""]
    return out


HEAD = ("quantity", "published", "Faying", "difference", "tolerance")


def _title(source: str) -> str:
    from pybtex.database import parse_file

    entries = parse_file(str(ENTRIES.parent / "references.bib")).entries.values()
    for entry in entries:
        if f"doi:{entry.fields.get('doi')}".lower() in source.lower():
            names = [" ".join(person.last_names) for person in entry.persons["author"]]
            shown = names[0] if len(names) == 1 else " and ".join(names) if len(names) == 2 else f"{names[0]} et al."
            rest = source.partition(f"doi:{entry.fields['doi']}")[2].lstrip(", ")
            return f"{shown} {entry.fields['year']}" + (f": {rest}" if rest else "")
    return source


def _row(entry: Mapping[str, Any]) -> tuple[str, ...]:
    published, ours = entry["published"], entry["ours"]
    unit = "" if entry["unit"] == "1" else f" {entry['unit']}"
    relative = entry["relative"] and published != 0
    difference = f"{100 * (ours / published - 1):+.2g} %" if relative else f"{ours - published:+.2g}{unit}"
    tolerance = f"{100 * entry['tolerance']:g} %" if entry["relative"] else f"{entry['tolerance']:g}{unit}"
    return (
        escape(entry["quantity"]),
        escape(f"{published:.5g}{unit}"),
        escape(f"{ours:.5g}{unit}"),
        escape(difference),
        escape(tolerance),
    )
