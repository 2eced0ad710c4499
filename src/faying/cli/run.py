"""faying run STUDY.toml"""

from contextlib import nullcontext
from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from faying.cli.options import PATH, show
from faying.cli.progress import Form, Shown, progress_options
from faying.errors import InputError
from faying.files import together


@click.command()
@click.argument("study", type=PATH)
@click.option(
    "--out", type=PATH, help="Folder for the results (default: results/ of study.toml, results/NAME/ of NAME.toml)."
)
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
@click.option("--no-files", is_flag=True, help="Write no files, only print.")
@click.option("--uff", is_flag=True, help="Write modes and frequency responses as universal files, too (.uff).")
@click.option(
    "--mpi",
    type=click.IntRange(1, 1_000_000),
    metavar="PROCESSES",
    help="Solve by multigrid in this number of processes, started by mpiexec, instead of a factorisation.",
)
@click.option(
    "--engine",
    type=click.Choice(("reanalysis", "direct")),
    default="reanalysis",
    help="reanalysis: one factorisation for many states; direct: one for every step, as a check.",
)
@click.option(
    "--refine",
    metavar="TOLERANCE",
    help="Mesh finer and run again until the error of every frequency by the mesh is below it, such as 0.2%.",
)
@progress_options
def command(
    study: Path,
    out: Path | None,
    as_json: bool,
    no_files: bool,
    uff: bool,
    mpi: int | None,
    engine: str,
    refine: str | None,
    progress: Form | None,
) -> None:
    """Run STUDY: surface, contact law, preload, modes; write NetCDF, CSV, figures and a report."""
    from faying.answer.run import run, stages
    from faying.export import universal
    from faying.numerics.solve import MPI
    from faying.output import report
    from faying.study import Study

    plan = Study.read(study)
    if mpi is not None:
        plan = replace(plan, modes=replace(plan.modes, solver=f"{MPI}:{mpi}"))
    if uff and no_files:
        raise InputError("--uff writes files and --no-files forbids them; leave one out")
    if uff:
        universal.check(plan.response)
    folder = out or plan.results
    every = [*stages(plan), *([] if no_files else ["report"])]
    bar = Shown("study", progress, every)
    with nullcontext() if no_files else together(folder, "give another with --out", [report.RESULT]) as hidden, bar:
        result = run(plan, report=lambda stage, done, _: bar(stage, done, len(every)), engine=engine, refine=refine)
        files = []
        if hidden is not None:
            bar("report", len(every) - 1, len(every))
            files = report.write(result, hidden)
            files += universal.write(result, hidden) if uff else []
            files = [folder / file.name for file in files]
    show(as_json, result.to_dict, lambda: text(result), files, folder)


def text(result: Any) -> str:
    """The tables and notes of a result for the terminal."""
    from faying.notes import FIRST_NOTES, TITLES, by_severity, grave
    from faying.output import answer, table
    from faying.output.sections import sections
    from faying.output.terminal import wrapped

    head = (
        f"{result.title}: {result.unknowns:,} unknowns, {result.solver} ({result.factor_memory / 1e9:.2g} GB), "
        f"{result.damping} loss in the joints"
    )
    first, *others = (
        "\n".join([*wrapped(section.above), table.text(section.rows), ""]) for section in sections(result)
    )
    every = grave(result.notes)
    before = every[:FIRST_NOTES]
    lines = [line for one in (answer.limit(result), answer.score_line(result)) if one for line in wrapped(one)]
    lines += [line for note in before for line in _item(note.text)]
    more = len(every) - len(before)
    lines += [f"  {more} more at the end"] if more > 0 else []
    notes = [
        line
        for kind, some in by_severity(result.notes, before).items()
        for line in (f"\n{TITLES[kind]}", *(part for note in some for part in _item(note.text)))
    ]
    hammer = [] if result.hammer is None else [line for text in result.hammer.notes for line in _item(text)]
    return "\n".join([*wrapped(head), "", first, *([*lines, ""] if lines else []), *others, *notes, *hammer])


def _item(text: str) -> list[str]:
    """A note as an item of a list."""
    from faying.output.terminal import wrapped

    return wrapped(text, first="- ", rest="  ")
