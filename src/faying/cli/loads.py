"""faying loads STUDY.toml: what the preloaded structure does under its load cases."""

from pathlib import Path

import click

from faying.cli.options import FILE, PATH, show
from faying.cli.progress import Form, Shown, progress_options


@click.command()
@click.argument("study", type=PATH)
@click.option("--preload", metavar="FORCE", help='Preload of the study, such as "8 kN" (default: the last).')
@click.option("--no-modes", is_flag=True, help="Leave out the modes about each loaded state.")
@click.option("--intervals", is_flag=True, help="Find 90 % intervals over the scatter of preload and friction.")
@click.option("--out", type=PATH, help="Write all numbers and pressure maps as NetCDF (.nc).")
@click.option("--plot", type=FILE, help="Draw the pressure (svg, png, pdf).")
@click.option("--json", "as_json", is_flag=True, help="Print JSON in SI units.")
@progress_options
def command(
    study: Path,
    preload: str | None,
    no_modes: bool,
    intervals: bool,
    out: Path | None,
    plot: Path | None,
    as_json: bool,
    progress: Form | None,
) -> None:
    """Find bolt forces, opening, pressure and slip of STUDY under each [[load]], about its preload."""
    from faying.loads import table as shown
    from faying.loads.figure import figure
    from faying.loads.load_cases import load_cases
    from faying.style import check_ending, save

    if plot is not None:
        check_ending(plot)
    with Shown("loads", progress) as report:
        found = load_cases(study, preload=preload, modes=not no_modes, intervals=intervals, report=report)
    files = [] if out is None else [found.save(out)]
    files += [] if plot is None else [save(figure(found), plot)]
    show(as_json, found.to_dict, lambda: shown.terminal(found), files, heading="written:")
