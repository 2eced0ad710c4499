"""faying run STUDY.toml"""

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path

import click


@click.command()
@click.argument("study", type=click.Path(path_type=Path))
@click.option(
    "--out", type=click.Path(path_type=Path), help="Folder for the results (default: results/ beside the study)."
)
@click.option("--json", "as_json", is_flag=True, help="Print the result as JSON.")
@click.option("--no-files", is_flag=True, help="Write no files, only print.")
@click.option("--uff", is_flag=True, help="Write modes and frequency responses as universal files, too (.uff).")
def command(study: Path, out: Path | None, as_json: bool, no_files: bool, uff: bool) -> None:
    """Run STUDY: surface, contact law, preload, modes; write NetCDF, CSV, figures and a report."""
    from faying.errors import InputError
    from faying.output import report, table
    from faying.study import Study, run, universal

    plan = Study.read(study)
    if uff and no_files:
        raise InputError("--uff writes files and --no-files forbids them; leave one out")
    if uff:
        universal.check(plan.response)
    folder = out or plan.folder / "results"
    stages = 3 + (2 + (plan.response is not None)) * plan.load_count + (plan.hammer is not None) + (not no_files)
    bar = click.progressbar(length=stages, file=sys.stderr, label="study", item_show_func=lambda s: s or "")
    with nullcontext() if no_files else _folder(folder), bar:

        def tell(stage: str) -> None:
            bar.update(0 if stage.endswith("of the test") else 1, stage)

        result = run(plan, report=tell)
        files = []
        if not no_files:
            tell("report")
            files = report.write(result, folder)
            files += universal.write(result, folder) if uff else []
    if as_json:
        click.echo(json.dumps(result.to_dict() | {"files": [str(f) for f in files]}, indent=2))
        return
    click.echo(
        f"{result.title}: {result.unknowns:,} unknowns, {result.solver} ({result.factor_memory / 1e9:.2g} GB), "
        f"{result.damping} loss in the joints\n"
    )
    at = "" if result.hammer is None else f" at {result.hammer.model.load / 1e3:g} kN"
    for name, rows in (
        ("modes", table.modes(result)),
        ("joints", table.joints(result)),
        (f"bolts, tightened in the order {', '.join(result.tightening)}", table.bolts(result)),
        ("comparison with the test", table.comparison(result)),
        (f"hammer test{at}", table.hammer(result)),
    ):
        if rows:
            click.echo(f"{name}\n{table.text(rows)}\n")
    for line in (*result.warnings, *(() if result.hammer is None else result.hammer.notes)):
        click.echo(f"note: {line}")
    if files:
        click.echo(f"\nwritten to {folder}: {', '.join(f.name for f in files)}")


@contextmanager
def _folder(folder: Path) -> Iterator[None]:
    """Make a folder before hours of work, and take it away again if they come to nothing."""
    from faying.errors import InputError

    new = [path for path in (folder, *folder.parents) if not path.exists()]
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as fault:
        raise InputError(f"cannot make the folder {folder}: {fault.strerror}; give another with --out") from None
    try:
        yield
    except BaseException:
        for path in new:
            with suppress(OSError):  # it holds something by now
                path.rmdir()
        raise
