"""Two results of `faying run` next to each other, for `faying compare`."""

from pathlib import Path

from faying.cli.options import show
from faying.files import together, write_text
from faying.output.terminal import folded
from faying.units import load_text


def show_two_runs(files: tuple[Path, Path], load: str | None, out: Path | None, *, as_json: bool) -> None:
    """Print how two results differ, at one preload or at each that both have; write tables and figures to `out`."""
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
    lines = [f"first: {files[0]}, {first.title}", f"second: {files[1]}, {second.title}"]
    for one in found:
        loads = " and ".join(dict.fromkeys(map(load_text, one.preloads)))
        lines += ["", loads, "", table.text(one.mode_rows()), "", table.text(one.joint_rows())]
    lines += [folded(f"note: {line}") for line in dict.fromkeys(line for one in found for line in one.notes)]
    show(as_json, lambda: {"differences": [one.to_dict() for one in found]}, lambda: "\n".join(lines), written)
