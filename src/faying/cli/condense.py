"""faying condense STUDY.toml: one joint as a 6 x 6 stiffness and loss between two points."""

from pathlib import Path
from typing import Any

import click

from faying import units
from faying.cli.options import PATH
from faying.cli.progress import Form, Shown, progress_options
from faying.decks.programs import CONDENSED
from faying.errors import InputError
from faying.text import json_text
from faying.units import load_text

WORDS = ("x", "y", "z", "turn x", "turn y", "turn z")

NUMBER = click.IntRange(1, 99_999_999)  # eight digits, the field of a bulk data card


@click.command()
@click.argument("study", type=PATH)
@click.option("--joint", metavar="NAME", help="Joint of the study; the only one where left out.")
@click.option("--preload", metavar="FORCE", help='Preload of the study, such as "8 kN" (default: greatest).')
@click.option("--point-a", metavar="POINT", help='Point of the first face, "0 mm; 10 mm; 5 mm" (default: its centre).')
@click.option("--point-b", metavar="POINT", help="Point of the second face.")
@click.option("--to", "solver", type=click.Choice(CONDENSED), help="The solver to write for.")
@click.option("--unit", help='Unit of length of that model, such as "mm".')
@click.option("--force-unit", default="N", show_default=True, help="Unit of force of that model.")
@click.option("--node-a", type=NUMBER, default=900001, show_default=True, help="Number of the first point's node.")
@click.option("--node-b", type=NUMBER, default=900002, show_default=True, help="Number of the second point's node.")
@click.option("--element", type=NUMBER, default=900001, show_default=True, help="Number of the element and property.")
@click.option("--out", type=PATH, help="Folder of the deck (default: joint/ next to the study).")
@click.option("--json", "as_json", is_flag=True, help="Print JSON in SI units.")
@progress_options
def command(
    study: Path,
    joint: str | None,
    preload: str | None,
    point_a: str | None,
    point_b: str | None,
    solver: str | None,
    unit: str | None,
    force_unit: str,
    node_a: int,
    node_b: int,
    element: int,
    out: Path | None,
    as_json: bool,
    progress: Form | None,
) -> None:
    """Condense a joint of STUDY to a 6 x 6 stiffness between two points, with the error of that."""
    from faying.export.condense import condense
    from faying.output.table import text
    from faying.study import Study

    if solver is not None and unit is None:
        raise InputError('--to needs --unit, the unit of length of that model, such as "mm"')
    plan = Study.read(study)
    points = (_point(point_a, "--point-a"), _point(point_b, "--point-b"))
    with Shown("condense", progress) as report:
        found = condense(plan, joint=joint, preload=preload, points=points, report=report)
    files: list[Path] = []
    if solver is not None:
        files = found.write(
            solver,
            out or plan.folder / "joint",
            unit=unit or "",
            force_unit=force_unit,
            nodes=(node_a, node_b),
            element=element,
        )
    if as_json:
        click.echo(json_text(found.to_dict() | {"files": [str(f) for f in files]}))
        return
    place = ", ".join(f"{x:.4g}" for x in (1e3 * found.joint.point).round(6) + 0.0)
    lines = [
        f"{found.name} at {load_text(found.load)}, about ({place}) mm: stiffness [N/m, N, N m]",
        *_matrix(found.joint.stiffness),
        *(["no loss is predicted"] if found.lossless else ["loss, its imaginary part", *_matrix(found.joint.loss)]),
        "",
        text(found.rows()),
        "",
        f"mean ties are right within 1 % up to {found.reach:.4g} Hz"
        if found.reach
        else "mean ties err by more than 1 % in the first mode already",
        *(f"written: {file}" for file in files),
    ]
    click.echo("\n".join(lines))


def _matrix(values: Any) -> list[str]:
    import numpy as np

    own = np.sqrt(np.abs(np.diag(values)))
    rows = zip(WORDS, np.where(np.abs(values) > 1e-12 * np.outer(own, own), values, 0.0), strict=True)
    return [f"  {word:>7}" + "".join(f"{value:>13.4e}" for value in row) for word, row in rows]


def _point(given: str | None, name: str) -> Any:
    import numpy as np

    if given is None:
        return None
    parts = given.split(";")
    if len(parts) != 3:
        raise InputError(f'{name} "{given}": give three lengths with semicolons between, such as "0 mm; 10 mm; 5 mm"')
    return np.array([units.parse(part.strip(), "m", name=name) for part in parts])
