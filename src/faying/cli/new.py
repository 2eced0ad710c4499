"""faying new FILE"""

import sys
from pathlib import Path
from typing import Any

import click

from faying import units
from faying.cli.options import PATH
from faying.errors import InputError
from faying.text import json_text


@click.command()
@click.argument("step", metavar="FILE", type=PATH)
@click.option("--unit", help='Unit of a mesh file\'s coordinates, such as "mm".')
@click.option("--scan", type=PATH, help="Scan of one face (default: a synthetic one of a fine finish).")
@click.option("--out", type=PATH, default="study.toml", show_default=True, help="The study file.")
@click.option("--mesh-bolts", is_flag=True, help="Mesh bolts that are drawn with their nuts (default: beams).")
@click.option("--yes", is_flag=True, help="Ask nothing; assume steel, class 8.8 and what its sheet accepts; print it.")
@click.option("--force", is_flag=True, help="Replace files that exist.")
@click.option("--json", "as_json", is_flag=True, help="Print what was found and written as JSON; asks nothing.")
def command(
    step: Path, unit: str | None, scan: Path | None, out: Path, mesh_bolts: bool, yes: bool, force: bool, as_json: bool
) -> None:
    """Write a commented study of the part or assembly in FILE: joints, bolts, seats, mesh, and what to fill in.

    FILE is a STEP file, or a mesh of another program whose faces have names; its pretension sections become bolts.
    """
    from faying.setup import new

    silent = yes or as_json
    if not silent and not sys.stdin.isatty():
        raise InputError("faying new asks questions and there is no terminal to ask; give --yes to assume the answers")
    proposal = new.find(step, unit, mesh_bolts=mesh_bolts)
    answers = new.Answers(scan=scan) if silent else asked(proposal, scan)
    written = new.write(proposal, step, out, answers, force=force)
    click.echo(json_text(written.to_dict()) if as_json else "\n".join(new.summary(written, out)))


def asked(proposal: Any, scan: Path | None) -> Any:
    """Ask what the geometry does not tell; each question has its default."""
    from faying.materials import CATALOGUE
    from faying.setup import new

    facts = proposal.facts
    click.echo(f"{facts.file}: {len(facts.parts)} parts, {len(proposal.joints)} joints, {len(proposal.bolts)} bolts")
    bolts = new.alike((bolt.name, bolt.remark) for bolt in proposal.bolts)
    dowels = [f"{dowel.name}: {dowel.remark}" for dowel in proposal.dowels]
    for line in (*bolts, *dowels, *proposal.remarks):
        click.echo(f"  {line}")
    choice = click.Choice(list(CATALOGUE))
    materials = {
        part.name: click.prompt(f"material of {part.name}", default=new.STEEL, type=choice) for part in facts.parts
    }
    known = next((bolt.preload for bolt in proposal.bolts if bolt.preload is not None), None)
    preload = None
    if proposal.bolts:
        answered = click.prompt(
            "preload of each bolt",
            default=units.show(known, "N") if known is not None else "10 kN",
            value_proc=lambda text: units.parse(text, "N", name="preload") and text,
        )
        preload = units.parse(answered, "N", name="preload")
    if scan is None and not proposal.alone:
        named = click.prompt("scan of one face (empty for a synthetic fine finish)", default="", show_default=False)
        scan = Path(named) if named.strip() else None
    return new.Answers(materials=materials, preload=preload, scan=scan)
