"""`faying form FILE`: a measured form of a face, or of a gap: map, flatness, crowns and twist."""

from pathlib import Path
from typing import Any

import click

from faying.cli.options import FILE
from faying.errors import ReadError
from faying.text import json_text
from faying.units import show


@click.command()
@click.argument("file", type=FILE)
@click.option("--xy-unit", help='Unit of x and y where the file states none, for example "mm".')
@click.option("--z-unit", help='Unit of the heights or gaps where the file states none, for example "um".')
@click.option("--channel", help="Name of the map of heights, where the file holds several.")
@click.option("--gap", "is_gap", is_flag=True, help="The values are gaps between two faces, not heights of one.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON in SI units instead of text.")
@click.option("--plot", type=FILE, help="Write the map (png, pdf, svg).")
def command(file: Path, is_gap: bool, as_json: bool, plot: Path | None, **given: Any) -> None:
    """Flatness, crowns and twist of the form in FILE: a list of points x, y, z (csv, txt, dat, xyz, asc) or a scan."""
    from faying.form import fit as drawing
    from faying.form.fit import fit_form
    from faying.form.gap_map import read_heights
    from faying.style import check_ending, save

    if plot:
        check_ending(plot)
    if not file.is_file():
        raise ReadError(f"no file {file}")
    fit = fit_form(*read_heights(file, is_gap=is_gap, **given), is_gap=is_gap)
    if plot:
        save(drawing.figure(fit, file.name), plot)
    if as_json:
        click.echo(json_text({"file": str(file), **fit.to_dict()}))
        return
    click.echo(text(file.name, fit) + (f"\n\nwritten to {plot}" if plot else ""))


def text(name: str, fit: Any) -> str:
    """The numbers, and the table of a study that stands for them."""
    sides = " x ".join(show(side, "m") for side in fit.lengths)
    lines = [
        f"{name}: {len(fit.values):,} {'gaps' if fit.is_gap else 'heights'} over {sides}, longer along {fit.along}",
        f"flatness (minimum zone)     {show(fit.zone.flatness, 'm', digits=4)}",
        f"left by crowns and twist    {show(fit.rest, 'm', digits=4)}",
        "",
        "as named shapes in a study:",
        "[joint.form]",
    ]
    shapes = ("crown_along", "crown_across", "twist")
    lines += [f'{shape} = "{show(getattr(fit, shape), "m", digits=3)}"' for shape in shapes]
    where = "of a gap whose axes see the first face from inside" if fit.is_gap else "where it is the second face"
    return "\n".join([*lines, f"twist counts as seen from outside the first face of a joint: change its sign {where}"])
