"""faying init [STUDY.toml]"""

import json
from pathlib import Path

import click

from faying.cli.options import PATH


@click.command()
@click.argument("study", type=PATH, default="study.toml")
@click.option("--force", is_flag=True, help="Replace files that exist with other content.")
@click.option("--json", "as_json", is_flag=True, help="Print what was written as JSON.")
def command(study: Path, force: bool, as_json: bool) -> None:
    """Write a commented study to STUDY, with the geometry and the scan of a small bolted pair, so that it runs."""
    from faying.setup.template import write

    made = list(map(str, write(study, force=force)))
    text = f"written: {', '.join(made)}; run it with: faying run {study}"
    click.echo(json.dumps({"files": made}) if as_json else text)
