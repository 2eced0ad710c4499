"""faying schema"""

from pathlib import Path

import click

from faying.cli.options import PATH
from faying.errors import InputError
from faying.files import write_text


@click.command()
@click.option("--out", type=PATH, help="File to write, such as faying.schema.json.")
@click.option("--json", "as_json", is_flag=True, help="Print the schema, as it does without --out.")
def command(out: Path | None, as_json: bool) -> None:
    """Give the JSON schema of a study: editors complete keys and mark faults with it, without a network.

    A study names it in its first line: #:schema ./faying.schema.json
    """
    from faying.study.schema import schema_text

    if out is not None and as_json:
        raise InputError("--json prints the schema and --out writes it; leave one out")
    text = schema_text()
    if out is None:
        click.echo(text, nl=False)
    else:
        click.echo(f"written: {write_text(out, text)}")
