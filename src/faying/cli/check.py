"""faying check STUDY.toml"""

import textwrap
from dataclasses import asdict
from pathlib import Path
from typing import Any

import click

from faying.cli.options import PATH
from faying.output.terminal import folded, wrapped
from faying.text import json_text

COLUMNS = 80


@click.command()
@click.argument("study", type=PATH)
@click.option("--json", "as_json", is_flag=True, help="Print JSON, with the key and the line of each finding.")
def command(study: Path, as_json: bool) -> int:
    """Check STUDY without solving: keys, names, contacts, bolts, reach of the laws, mesh, unknowns, memory, time."""
    from faying.setup.check import by_level, check

    found = check(study, mesh=True)
    if as_json:
        click.echo(json_text(to_dict(found)))
    else:
        lines = [line for one in by_level(found) for line in _lines(one)]
        if found.expected is not None:
            lines += textwrap.wrap(f"what the run needs: {found.expected.basis}", COLUMNS)
        count = len(found.faults)
        notes = sum(one.level == "note" for one in found.findings)
        last = f"{count} fault{'s' * (count != 1)}, {notes} note{'s' * (notes != 1)}"
        lines.append(f"{last}; run it with: faying run {study}" if not count else f"{last}; the study cannot run")
        click.echo(folded("\n".join(lines)))
    return 1 if found.faults else 0


def _lines(finding: Any) -> list[str]:
    """A finding in lines of 80 columns: level, line of the study, text."""
    place = "" if finding.line is None else f"line {finding.line}"
    head = f"{finding.level:<6}{place:<10}"
    return wrapped(finding.text, COLUMNS, first=head, rest=" " * len(head))


def to_dict(found: Any) -> dict[str, Any]:
    """Findings, and what a run is expected to need."""
    from faying.cli.options import quantity

    expected = found.expected
    return {
        "findings": [asdict(one) for one in found.findings],
        "faults": len(found.faults),
        "expected": None
        if expected is None
        else {
            "unknowns": expected.unknowns,
            "memory": quantity(expected.memory, "B"),
            "time": quantity(expected.seconds, "s"),
            "basis": expected.basis,
        },
    }
