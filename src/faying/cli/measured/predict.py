"""faying predict STUDY.toml"""

import os
from pathlib import Path
from typing import TYPE_CHECKING

import click

from faying.cli.options import FILE, PATH, refuse_given, show
from faying.cli.progress import Form, Shown, progress_options
from faying.files import new_folder, write_text

if TYPE_CHECKING:
    from faying.study import Study


@click.command()
@click.argument("study", type=PATH)
@click.option(
    "--samples", type=click.IntRange(8, 1_000_000), default=1024, show_default=True, help="Points of Sobol's sequence."
)
@click.option("--seed", type=click.IntRange(0, 2**63 - 1), default=0, show_default=True, help="Seed of the samples.")
@click.option("--jobs", type=click.IntRange(1, 1024), help="Processes on this machine [one for each core].")
@click.option("--out", type=PATH, help="NetCDF file (default: prediction.nc in the folder that run writes to).")
@click.option("--plot", type=FILE, help="Draw the intervals (svg, png, pdf).")
@click.option("--tornado", type=FILE, help="Draw the shares of the variance.")
@click.option(
    "--assemblies",
    type=click.IntRange(2, 100_000),
    metavar="N",
    help="Take one structure apart and bolt it together again N times, in place of samples of structures.",
)
@click.option("--html", type=FILE, help="Write tables and figures as one page.")
@click.option("--json", "as_json", is_flag=True, help="Print the quantiles and shares as JSON.")
@progress_options
def command(
    study: Path,
    samples: int,
    seed: int,
    jobs: int | None,
    out: Path | None,
    plot: Path | None,
    tornado: Path | None,
    assemblies: int | None,
    html: Path | None,
    as_json: bool,
    progress: Form | None,
) -> None:
    """Intervals of the frequencies of STUDY from the scatter in its [uncertain], and which input causes them.

    With --assemblies the scatter of one structure that is taken apart and bolted together again.

    Finished work is saved next to the output; the same command resumes after an interruption.
    """
    from faying.identify import prediction as drawing
    from faying.identify.predict import check, predict
    from faying.output.prediction import text
    from faying.output.report_predicted import predicted
    from faying.study import Study
    from faying.style import check_figure, save

    if assemblies:
        refuse_given({"samples", "plot", "tornado", "html"}, "--assemblies gives tables and a file")
        _assembled(Study.read(study), assemblies, seed, jobs=jobs, out=out, as_json=as_json, progress=progress)
        return
    figures = {drawing.intervals: plot, drawing.tornado: tornado}
    for file in filter(None, figures.values()):
        check_figure(file)
    plan = Study.read(study)
    check(plan, samples)
    out = out or plan.results / "prediction.nc"
    with new_folder(out.parent, "give another file with --out"), Shown("predict", progress) as report:
        jobs = jobs or os.cpu_count() or 1
        found = predict(plan, samples, seed, jobs=jobs, out=out, report=report)
    files = [out, *(save(draw(found), file) for draw, file in figures.items() if file)]
    if html:
        files.append(write_text(html, predicted(found)))
    show(as_json, found.to_dict, lambda: text(found), files)


def _assembled(
    plan: "Study", count: int, seed: int, *, jobs: int | None, out: Path | None, as_json: bool, progress: Form | None
) -> None:
    from faying.identify.predict import predict
    from faying.identify.reassembly import check_assemblies
    from faying.output.assemblies import text

    check_assemblies(plan, count)
    out = out or plan.results / "assemblies.nc"
    with new_folder(out.parent, "give another file with --out"), Shown("predict", progress) as report:
        found = predict(plan, assemblies=count, seed=seed, jobs=jobs or os.cpu_count() or 1, out=out, report=report)
    show(as_json, found.to_dict, lambda: text(found), [out])
