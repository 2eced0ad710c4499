"""faying condense STUDY.toml: a joint as a 6 x 6 stiffness between two points, or the whole as a superelement."""

from pathlib import Path
from typing import Any

import click

from faying import units
from faying.cli.options import PATH, refuse_given, show
from faying.cli.progress import Form, Shown, progress_options
from faying.decks.programs import CONDENSED, IN_SI, REDUCED
from faying.errors import InputError
from faying.text import toml
from faying.units import load_text

WORDS = ("x", "y", "z", "turn x", "turn y", "turn z")

NUMBER = click.IntRange(1, 99_999_999)  # eight digits, the field of a bulk data card


@click.command()
@click.argument("study", type=PATH)
@click.option("--joint", metavar="NAME", help="Joint of the study; the only one where left out.")
@click.option("--preload", metavar="FORCE", help='Preload of the study, such as "8 kN" (default: the last).')
@click.option("--point-a", metavar="POINT", help='Point of the first face, "0 mm; 10 mm; 5 mm" (default: its centre).')
@click.option("--point-b", metavar="POINT", help="Point of the second face.")
@click.option("--superelement", "whole", is_flag=True, help="The whole structure, reduced to interfaces and modes.")
@click.option(
    "--interface",
    "interfaces",
    multiple=True,
    metavar="FACE|POINT",
    help="Of the superelement, once for each: a face by its name or selector, as in a study, or a point.",
)
@click.option("--up-to", metavar="FREQUENCY", help="Of the superelement: where its modes end (default: the study's).")
@click.option("--to", "solver", type=click.Choice(sorted({*CONDENSED, *REDUCED, *IN_SI})), help="What to write for.")
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
    whole: bool,
    interfaces: tuple[str, ...],
    up_to: str | None,
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
    """Condense a joint of STUDY to a 6 x 6 stiffness between two points, or all of STUDY to a superelement."""
    from faying.export.condense import condense
    from faying.export.superelement import superelement
    from faying.output.table import text
    from faying.study import Study

    if solver not in (None, *IN_SI) and unit is None:
        raise InputError('--to needs --unit, the unit of length of that model, such as "mm"')
    if whole:
        of_joint = {"joint", "point_a", "point_b", "node_b", "element"}
        refuse_given(of_joint, "of one joint; a superelement has --interface")
    else:
        refuse_given({"interfaces", "up_to"}, "of a superelement; add --superelement")
    if solver in (None, *IN_SI):
        of_deck = {"unit", "force_unit", "node_a", "node_b", "element"}
        refuse_given(of_deck, "of a deck that has units and numbers (--to)")
    plan = Study.read(study)
    folder, system = out or plan.folder / "joint", {"unit": unit or "m", "force_unit": force_unit}
    if whole:
        with Shown("condense", progress) as report:
            made = superelement(plan, [*map(_interface, interfaces)], up_to=up_to, preload=preload, report=report)
        files = made.write(solver, folder, **system, node=node_a) if solver else []
        show(as_json, made.to_dict, lambda: f"{made}\n\n{text(made.rows())}", files, folder)
        return
    points = (_point(point_a, "--point-a"), _point(point_b, "--point-b"))
    with Shown("condense", progress) as report:
        found = condense(plan, joint=joint, preload=preload, points=points, report=report)
    files = found.write(solver, folder, **system, nodes=(node_a, node_b), element=element) if solver else []
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
    show(as_json, found.to_dict, lambda: "\n".join(lines), files if as_json else ())


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


def _interface(given: str) -> Any:
    """A face by its name or as a selector, or a point."""
    if given.lstrip().startswith("{"):
        try:
            return toml(f"face = {given}")["face"]
        except ValueError as fault:
            raise InputError(f"--interface '{given}' is not a selector: {fault}") from None
    return _point(given, "--interface") if ";" in given else given
