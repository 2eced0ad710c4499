"""faying run STUDY.toml"""

from contextlib import nullcontext
from pathlib import Path
from typing import Any

import click

from faying.cli.options import PATH, show
from faying.cli.progress import Form, Shown, progress_options
from faying.errors import InputError
from faying.files import together
from faying.notes import FIRST_NOTES

MAX_LINES, MAX_ROWS = 36, 18  # of the answer on one screen of 40 lines, and of its table; the files take the rest
MIN_MODES = 3  # that the table has, however wide it is


@click.command()
@click.argument("study", type=PATH)
@click.option(
    "--out", type=PATH, help="Folder for the results (default: results/ of study.toml, results/NAME/ of NAME.toml)."
)
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
@click.option("--all", "everything", is_flag=True, help="Print all tables and notes, not the answer alone.")
@click.option("--no-files", is_flag=True, help="Write no files, only print.")
@click.option("--no-figures", is_flag=True, help="Write the files and the report without figures: seconds less.")
@click.option("--uff", is_flag=True, help="Write modes and frequency responses as universal files, too (.uff).")
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
    everything: bool,
    no_files: bool,
    no_figures: bool,
    uff: bool,
    engine: str,
    refine: str | None,
    progress: Form | None,
) -> None:
    """Run STUDY: surface, contact law, preload, modes; write NetCDF, CSV, figures and a report."""
    from faying.answer.run import run, stages
    from faying.export import universal
    from faying.output import report
    from faying.result.fields import RESULT_FILE
    from faying.study import Study

    plan = Study.read(study)
    if uff and no_files:
        raise InputError("--uff writes files and --no-files forbids them; leave one out")
    if uff:
        universal.check(plan.response)
    folder = out or plan.results
    every = [*stages(plan), *([] if no_files else ["report"])]
    bar = Shown("study", progress, every)
    with nullcontext() if no_files else together(folder, "give another with --out", [RESULT_FILE]) as hidden, bar:
        result = run(plan, report=lambda stage, done, _: bar(stage, done, len(every)), engine=engine, refine=refine)
        files = []
        if hidden is not None:
            bar("report", len(every) - 1, len(every))
            files = report.write(result, hidden, drawn=not no_figures)
            files += universal.write(result, hidden) if uff else []
            files = [folder / file.name for file in files]
    show(as_json, result.to_dict, lambda: text(result, everything=everything), files, folder)


def text(result: Any, *, everything: bool = True) -> str:
    """The answer for the terminal, on one screen; or all tables and notes."""
    from faying.notes import TITLES, by_severity, grave
    from faying.output import table
    from faying.output.sections import sections
    from faying.output.terminal import wrapped

    answer, *others = sections(result)
    modes = len(answer.rows)
    rows = table.text(answer.rows).splitlines()
    while not everything and len(rows) > MAX_ROWS and modes > MIN_MODES + 1:
        modes -= 1
        rows = table.text(answer.rows[:modes]).splitlines()
    hidden = len(answer.rows) - modes
    first = [*wrapped(answer.above), *rows, *[f"{hidden} more modes with --all"] * (hidden > 0), ""]
    head = f"{result.title}: {result.unknowns:,} unknowns, {result.solver} ({result.factor_memory / 1e9:.2g} GB)"
    head += f", {result.damping} loss in the joints, {result.joint_state}" if result.joints else ""
    lines = [*wrapped(head), "", *first, *_sentences(result)]
    before: list[Any] = []
    for note in grave(result.notes)[:FIRST_NOTES]:
        item = _item(note.text)
        if before and not everything and len(lines) + len(item) > MAX_LINES:
            break
        before.append(note)
        lines += item
    rest = len(grave(result.notes)) - len(before)
    lines += [f"  {rest} more at the end"] if everything and rest > 0 else []
    more = [line for one in others for line in (*wrapped(one.above), *table.text(one.rows).splitlines(), "")]
    for kind, some in by_severity(result.notes, before).items():
        more += ["", TITLES[kind], *(line for note in some for line in _item(note.text))]
    more += [] if result.hammer is None else [line for note in result.hammer.notes for line in _item(note)]
    if everything:
        return "\n".join([*lines, "", *more] if more else lines)
    return "\n".join([*lines, "faying run --all prints all tables and notes"] if more else lines)


def _sentences(result: Any) -> list[str]:
    """What stands below the answer: damping where it is one number, what limits the answer, how the test lies."""
    from faying.output import answer
    from faying.output.terminal import wrapped

    every = (answer.damping_line(result), answer.limit(result), answer.score_line(result))
    return [line for one in every if one for line in wrapped(one)]


def _item(text: str) -> list[str]:
    from faying.output.terminal import wrapped

    return wrapped(text, first="- ", rest="  ")
