"""`faying compare RESULT.nc OTHER`: the result of a study next to a hammer test, or to another result."""

from pathlib import Path
from typing import Any

import click

from faying import units
from faying.cli.options import PATH, refuse_given, show
from faying.file_kinds import RESULT, kind_of
from faying.files import together, write_text
from faying.output.terminal import folded
from faying.units import load_text

FOR_BOTH = {"result", "other", "load", "out", "as_json"}


def show_two_runs(files: tuple[Path, Path], load: str | None, out: Path | None, *, as_json: bool) -> None:
    """Print how two results differ, at one preload or at each that both have; write tables and figures to `out`."""
    from faying.output import table
    from faying.result import Result
    from faying.result.difference import compare_runs, differences, shared_preloads
    from faying.style import save

    first, second = (Result.load(file) for file in files)
    shared = [float(first.loads[i]) for i, _ in shared_preloads(first, second)]
    wanted: list[float | str | None] = [load] if load else list(shared) or [None]
    found = [compare_runs(first, second, one) for one in wanted]
    written: list[Path] = []
    if out:
        with together(out, "give another with --out") as hidden:
            for one in found:
                stem = f"difference-{load_text(one.preloads[0]).replace(' ', '-')}"
                write_text(hidden / f"{stem}.csv", one.csv_text())
                save(differences(one, (files[0].name, files[1].name)), hidden / f"{stem}.svg")
                written += [out / f"{stem}.csv", out / f"{stem}.svg"]
    lines = [f"first: {files[0]}, {first.title}", f"second: {files[1]}, {second.title}"]
    for one in found:
        loads = " and ".join(dict.fromkeys(map(load_text, one.preloads)))
        lines += ["", loads, "", table.text(one.mode_rows()), "", table.text(one.joint_rows())]
    lines += [folded(f"note: {line}") for line in dict.fromkeys(line for one in found for line in one.notes)]
    show(as_json, lambda: {"differences": [one.to_dict() for one in found]}, lambda: "\n".join(lines), written)


@click.command()
@click.argument("result", type=PATH)
@click.argument("other", type=PATH)
@click.option("--load", help='Preload to compare at, for example "8 kN". Default: the last; of two results, each.')
@click.option("--points", type=PATH, help="CSV table of the test's positions: point,x [mm],y [mm],z [mm].")
@click.option(
    "--frame",
    type=PATH,
    help="The same table for three points or more, with their places in the model; turns and shifts the test.",
)
@click.option("--length-unit", help='Unit of the positions in TEST, where it states none, for example "mm".')
@click.option("--tolerance", help='Greatest distance of point and node, for example "5 mm". Default: 2 % of the model.')
@click.option(
    "--direction", type=click.Choice(["x", "y", "z"]), help="Direction of the test, where the file states none."
)
@click.option(
    "--quantity",
    type=click.Choice(["receptance", "mobility", "accelerance"]),
    help="What the FRFs are, where the file is silent.",
)
@click.option(
    "--least-mac",
    type=click.FloatRange(0, 1, min_open=True),
    default=0.5,
    show_default=True,
    help="MAC that a pair must have.",
)
@click.option(
    "--greatest-shift",
    type=click.FloatRange(0, min_open=True),
    default=0.3,
    show_default=True,
    help="Difference of frequency that a pair may have, relative to the test.",
)
@click.option("--out", type=PATH, help="Folder for the table, the figures and the report.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON in SI units instead of a table.")
def command(
    result: Path,
    other: Path,
    load: str | None,
    frame: Path | None,
    tolerance: str | None,
    least_mac: float,
    greatest_shift: float,
    out: Path | None,
    as_json: bool,
    **options: Any,
) -> None:
    """Compare RESULT (result.nc of `faying run`) with the hammer test in OTHER, or with another result.

    A test is a universal file. Its mode shapes are taken where it holds some; otherwise they are identified from its
    FRFs. For another result, modes are paired by their shapes, at each preload that both results have.
    """
    if kind_of(other) is RESULT:
        of_test = {str(one.name) for one in click.get_current_context().command.params} - FOR_BOTH
        refuse_given(of_test, "for a hammer test alone, where two results are compared")
        show_two_runs((result, other), load, out, as_json=as_json)
        return
    from faying.measured.compare import compare_modes
    from faying.measured.tested import read_test
    from faying.output import report_measured, table
    from faying.result import Result

    model = Result.load(result).modes_at(load, source=str(result))
    distance = units.parse(tolerance, "m", name="--tolerance") if tolerance else None
    tested = read_test(other, **options)
    if tested.identified:
        click.echo(f"{other}: no mode shapes; modes are identified from its FRFs", err=True)
    comparison = compare_modes(
        tested.modes,
        model,
        transform=tested.transform(frame) if frame else None,
        tolerance=distance,
        frf=tested.frf,
        least_mac=least_mac,
        greatest_shift=greatest_shift,
    )
    files: list[Path] = []
    if out:
        click.echo("figures and report", err=True)
        with together(out, "give another with --out") as hidden:
            files = [out / file.name for file in report_measured.write(comparison, hidden)]
    for line in tested.notes:
        click.echo(f"note: {line}", err=True)
    nodes = len(comparison.point_map.nodes)
    head = f"{model.title} at {load_text(model.load)}; {nodes} points of the test found a node"
    lines = [head, "", table.text(comparison.rows()), *(f"note: {line}" for line in comparison.notes)]
    show(as_json, comparison.to_dict, lambda: folded("\n".join(lines)), files, out)
