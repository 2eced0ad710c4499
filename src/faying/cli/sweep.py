"""faying sweep STUDY.toml --set KEY=FIRST:LAST:COUNT"""

from pathlib import Path

import click

from faying.cli.options import FILE, PATH
from faying.cli.progress import Form, Shown, progress_options
from faying.files import new_folder
from faying.text import json_text


@click.command()
@click.argument("study", type=PATH)
@click.option(
    "--set",
    "settings",
    multiple=True,
    required=True,
    metavar="KEY=VALUES",
    help="What varies: surface.D=2.2:2.6:40, bolt.preload='1 kN:20 kN:30', surface.G='1e-12 m:1e-10 m:9:log', "
    "law.model=jk,gw. Several give all combinations.",
)
@click.option("--out", type=PATH, help="NetCDF file (default: sweep.nc in the folder that run writes to).")
@click.option("--tolerance", type=float, default=4e-6, show_default=True, help="Relative error of a frequency.")
@click.option("--jobs", type=click.IntRange(1, 1024), default=1, show_default=True, help="Processes on this machine.")
@click.option("--plot", type=FILE, help="Draw one axis or two (svg, png, pdf).")
@click.option("--json", "as_json", is_flag=True, help="Print a summary as JSON.")
@progress_options
def command(
    study: Path,
    settings: tuple[str, ...],
    out: Path | None,
    tolerance: float,
    jobs: int,
    plot: Path | None,
    as_json: bool,
    progress: Form | None,
) -> None:
    """Evaluate STUDY for many laws, surfaces and preloads: the parts are solved once, only the joint changes.

    Finished work is saved next to the output; the same command resumes after an interruption.
    """
    from faying.output.figures import sweep as drawing
    from faying.study import Study
    from faying.style import save
    from faying.sweeps.axes import axis_of
    from faying.sweeps.sweep import sweep

    axes = [axis_of(text) for text in settings]
    if plot:
        drawing.check(plot, len(axes))
    plan = Study.read(study)
    out = out or plan.results / "sweep.nc"
    with new_folder(out.parent, "give another file with --out"), Shown("sweep", progress) as report:
        done = sweep(plan, axes, out, tolerance=tolerance, jobs=jobs, report=report)
    summary = done.to_dict()
    if plot:
        summary["plot"] = str(save(drawing.figure(done), plot))
    if as_json:
        click.echo(json_text(summary))
        return
    if done.found:
        click.echo(f"{done.found} of {summary['points']} points were done before, by a sweep that was interrupted")
    click.echo(
        f"{done.title}: {summary['points']} points, {summary['answered']} with an answer; {done.unknowns:,} unknowns, "
        f"bases of {done.basis[0]} and {done.basis[1]} vectors"
    )
    for axis in axes:
        click.echo(f"  {axis.read()}")
    span = summary["frequency_range"]
    click.echo("\nmode   lowest     highest")
    for mode, (low, high) in enumerate(zip(span["lowest"], span["highest"], strict=True), start=1):
        click.echo(f"{mode:4d} {low:9.2f} Hz {high:9.2f} Hz")
    for text, count in done.reasons.items():
        click.echo(f"note: {count} point{'s have' if count > 1 else ' has'} no answer: {text}")
    for axis in axes:
        if axis.key.startswith("material."):
            click.echo(f"note: {axis.key} is that of the parts; the law keeps that of the study, and bolts theirs")
    for key in done.unchanged_by():
        click.echo(f"note: {key} changes no answer by more than the tolerance: nothing in this study depends on it")
    if summary["beyond_law"]:
        click.echo(
            f"note: {summary['beyond_law']} of the points press more than a tenth of the contact above the end of the "
            "law, where its stiffness stays constant; faying run bounds what that does to a frequency"
        )
    click.echo(f"\nwritten to {done.path}" + (f" and {plot}" if plot else ""))
