"""faying bolts STUDY.toml: a sheet for each bolt."""

from pathlib import Path

import click

from faying.cli.options import PATH, show
from faying.cli.progress import Form, Shown, progress_options
from faying.files import write_text


@click.command()
@click.argument("study", type=PATH)
@click.option("--preload", metavar="FORCE", help='Preload of the study, such as "8 kN" (default: the last).')
@click.option("--html", "page", type=PATH, help="Write the sheets as a page, with all formulas.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON in SI units.")
@progress_options
def command(study: Path, preload: str | None, page: Path | None, as_json: bool, progress: Form | None) -> None:
    """Calculate each bolt of STUDY by VDI 2230, steps R0 to R13, with compliances found by finite elements.

    [[bolt_sheet]] gives working loads, friction and the way of tightening.
    """
    from faying.sheet import page as shown
    from faying.sheet.bolt_sheet import bolt_sheet

    with Shown("bolts", progress) as report:
        found = bolt_sheet(study, preload, report=report)
    files = [] if page is None else [write_text(page, shown.html(found))]
    show(as_json, found.to_dict, lambda: shown.terminal(found), files, heading="written:")
