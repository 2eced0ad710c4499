"""faying check STUDY.toml"""

import textwrap
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
    from faying.setup.check import check

    found = check(study)
    if as_json:
        click.echo(json_text(found.to_dict()))
    else:
        lines = [line for one in found.by_level for line in _lines(one)]
        if found.expected is not None:
            lines += textwrap.wrap(f"what the run needs: {found.expected.basis}", COLUMNS)
        ending = "the study cannot run" if found.faults else f"run it with: faying run {study}"
        lines.append(f"{found.count}; {ending}")
        click.echo(folded("\n".join(lines)))
    return 1 if found.faults else 0


def _lines(finding: Any) -> list[str]:
    """A finding in lines of 80 columns: level, line of the study, text."""
    place = "" if finding.line is None else f"line {finding.line}"
    head = f"{finding.level:<6}{place:<10}"
    return wrapped(finding.text, COLUMNS, first=head, rest=" " * len(head))
