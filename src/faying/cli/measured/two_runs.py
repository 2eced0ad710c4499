"""Two results of `faying run` next to each other, for `faying compare`."""

from pathlib import Path

import click

from faying.output.terminal import folded
from faying.text import json_text
from faying.units import load_text


def show_two_runs(files: tuple[Path, Path], load: str | None, out: Path | None, *, as_json: bool) -> None:
    """Print how two results differ, at one preload or at each that both have; write tables and figures to `out`."""
    from faying.files import together, write_text
    from faying.output import table
    from faying.result import Result
    from faying.result.difference import compare_runs, shared_preloads
    from faying.result.difference_figure import differences
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
    if as_json:
        click.echo(json_text({"differences": [one.to_dict() for one in found], "files": [str(f) for f in written]}))
        return
    click.echo(f"first: {files[0]}, {first.title}\nsecond: {files[1]}, {second.title}")
    for one in found:
        loads = " and ".join(dict.fromkeys(map(load_text, one.preloads)))
        click.echo(f"\n{loads}\n\n{table.text(one.mode_rows())}\n\n{table.text(one.joint_rows())}")
    for line in dict.fromkeys(line for one in found for line in one.notes):
        click.echo(folded(f"note: {line}"))
    if written:
        click.echo(f"\nwritten to {', '.join(map(str, written))}")
