"""faying identify STUDY.toml"""

import os
from pathlib import Path
from typing import Any

import click

from faying.cli.options import FILE, PATH, show
from faying.cli.progress import Form, Shown, progress_options
from faying.files import new_folder, write_text
from faying.output.terminal import folded


@click.command()
@click.argument("study", type=PATH)
@click.option(
    "--leave-out", multiple=True, metavar="PRELOAD", help='Preload to predict and not to use, for example "12 kN".'
)
@click.option(
    "--seed", type=click.IntRange(0, 2**63 - 1), default=0, show_default=True, help="Seed of the random numbers."
)
@click.option(
    "--count", type=click.IntRange(100, 1_000_000), default=1000, show_default=True, help="Samples of the posterior."
)
@click.option("--jobs", type=click.IntRange(1, 1024), help="Processes on this machine [one for each core].")
@click.option("--out", type=PATH, help="NetCDF file (default: identification.nc in the folder that run writes to).")
@click.option("--plot", type=FILE, help="Draw priors, posteriors, frequencies.")
@click.option("--html", type=FILE, help="Write table and figure as one page.")
@click.option("--json", "as_json", is_flag=True, help="Print what was found as JSON.")
@progress_options
def command(
    study: Path,
    jobs: int | None,
    out: Path | None,
    plot: Path | None,
    html: Path | None,
    as_json: bool,
    progress: Form | None,
    **options: Any,
) -> None:
    """Update the uncertain numbers of STUDY from its test, and list those that the test cannot identify.

    Finished work is saved next to the output; the same command resumes after an interruption.
    """
    from faying.identify import identification as drawing
    from faying.identify.of_study import identify
    from faying.output.report_predicted import identified
    from faying.study import Study
    from faying.style import check_figure, save

    if plot:
        check_figure(plot)
    plan = Study.read(study)
    out = out or plan.results / "identification.nc"
    with new_folder(out.parent, "give another file with --out"), Shown("identify", progress) as report:
        found = identify(plan, jobs=jobs or os.cpu_count() or 1, out=out, report=report, **options)
    files = [out] + ([save(drawing.figure(found), plot)] if plot else [])
    source = plan.test.source if plan.test else ""
    if html:
        files.append(write_text(html, identified(found, plan.title, source)))
    show(as_json, found.to_dict, lambda: folded(f"{plan.title}: {source}\n\n{found.table()}"), files)
