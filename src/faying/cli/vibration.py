"""faying vibration STUDY.toml: what the structure does in service."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from faying.cli.options import FILE, PATH, show
from faying.cli.progress import Form, Shown, progress_options


@click.command()
@click.argument("study", type=PATH)
@click.option("--out", type=PATH, help="Write all numbers as NetCDF (.nc); several answers get numbers.")
@click.option("--plot", type=FILE, help="Draw the last answer: spectra and damping (svg, png, pdf).")
@click.option("--json", "as_json", is_flag=True, help="Print JSON in SI units.")
@progress_options
def command(study: Path, out: Path | None, plot: Path | None, as_json: bool, progress: Form | None) -> None:
    """Find what STUDY does under each [[vibration]] at each preload: levels, damping, bolts, margins of slip.

    The same numbers are in the result of faying run.
    """
    from faying.answer.run import run, stages
    from faying.backbones.backbone import names
    from faying.case.case import bare
    from faying.errors import InputError
    from faying.study import Study
    from faying.style import check_figure, save

    if plot is not None:
        check_figure(plot)
    plan = Study.read(study)
    if not plan.vibrations:
        raise InputError(f"{study} has no [[vibration]]; add one with psd or sine")
    plan = replace(bare(plan), vibrations=plan.vibrations)
    with Shown("vibration", progress, stages(plan)) as report:
        found = run(plan, report=report).vibrations
    files = [] if out is None else [one.save(file) for one, file in zip(found, names(out, len(found)), strict=True)]
    files += [] if plot is None else [save(found[-1].plot()[0].figure, plot)]
    show(
        as_json,
        lambda: {"vibrations": [one.to_dict() for one in found]},
        lambda: _text(found),
        files,
        heading="written:",
    )


def _text(found: Any) -> str:
    from faying.output import table
    from faying.output.terminal import wrapped
    from faying.service.table import HELP, TABLES, heading

    lines = []
    for one in found:
        lines += [*wrapped(heading(one)), ""]
        for title, rows in TABLES.items():
            made = rows(one)
            lines += [title, table.text(made), ""] if made else []
    lines += wrapped(HELP)
    notes = dict.fromkeys(note.text for one in found for note in one.notes)
    return "\n".join([*lines, *(line for note in notes for line in wrapped(note, first="- ", rest="  "))])
