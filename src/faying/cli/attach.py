"""faying attach MODEL: the joint into a deck of another solver, or into matrices that one has assembled."""

from pathlib import Path
from typing import Any

import click

from faying.cli.options import PATH, refuse_given
from faying.decks.programs import SOLVERS
from faying.errors import InputError
from faying.text import json_text


@click.command()
@click.argument("model", type=PATH)
@click.option("--face-a", required=True, metavar="NAME", help="Face, set or component of the rough part.")
@click.option("--face-b", required=True, metavar="NAME", help="The face it meets.")
@click.option("--unit", required=True, help='Unit of the coordinates, such as "mm"; no mesh file says.')
@click.option("--force-unit", default="N", show_default=True, help="Unit of force of the model.")
@click.option(
    "--law",
    required=True,
    type=PATH,
    metavar="STUDY.toml",
    help="Study with surface, law and materials; with --pressure solve also with bolts.",
)
@click.option("--joint", metavar="NAME", help="Joint of the study; else the one with these faces, or the only one.")
@click.option(
    "--pressure",
    required=True,
    metavar="FILE|VALUE|solve",
    help='CSV with the heading "node,pressure [MPa]", or "5 MPa", or solve.',
)
@click.option("--preload", metavar="FORCE", help='With --pressure solve: preload of the study, such as "8 kN".')
@click.option(
    "--tolerance", metavar="LENGTH", help="Greatest distance between the faces (default: 1 % of the model's size)."
)
@click.option(
    "--coupling",
    type=click.Choice(["auto", "nodes", "faces"]),
    default="auto",
    show_default=True,
    help="Springs node by node, or per area between all nodes that share an overlap.",
)
@click.option(
    "--frequency", metavar="FREQUENCY", help="Frequency at which viscous dampers c = eta k/omega give the loss factor."
)
@click.option("--to", "solver", type=click.Choice(SOLVERS), help="The solver to write for.")
@click.option("--out", type=PATH, help="Folder of the decks (default: joint/ next to the model).")
@click.option("--any-size", is_flag=True, help="Accept a joint of any area.")
@click.option(
    "--matrices",
    type=PATH,
    metavar="FILE",
    help="Stiffness and mass of the bare parts: job.sti of CalculiX, .mtx, .npz, DMIG; gives modes with the joint.",
)
@click.option("--mass", type=PATH, help="With a .mtx or .npz: file of the mass matrix.")
@click.option("--dofs", type=PATH, help='With a .mtx or .npz: "node direction" of each row.')
@click.option("--stiffness-unit", metavar="UNIT", help='Unit of the stiffness, such as "N/mm".')
@click.option("--mass-unit", metavar="UNIT", help='Unit of the mass, such as "t".')
@click.option(
    "--modes",
    "count",
    type=click.IntRange(1, 10_000),
    default=10,
    show_default=True,
    help="With --matrices: number of modes.",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON in SI units.")
def command(
    model: Path,
    face_a: str,
    face_b: str,
    law: Path,
    solver: str | None,
    out: Path | None,
    matrices: Path | None,
    mass: Path | None,
    dofs: Path | None,
    stiffness_unit: str | None,
    mass_unit: str | None,
    count: int,
    as_json: bool,
    **options: Any,
) -> None:
    """Apply the contact law of a study to two faces of MODEL and write the joint for another solver.

    MODEL: .inp of Abaqus or CalculiX, .bdf, .msh, .cdb.
    """
    from faying.export.attach import attach
    from faying.export.matrix_modes import modes_with_joint

    if solver is None and matrices is None:
        raise InputError(f"nothing to do: name a solver with --to ({', '.join(SOLVERS)}), or matrices with --matrices")
    if matrices is None:
        refuse_given({"mass", "dofs", "stiffness_unit", "mass_unit", "count"}, "with --matrices alone")
    if options["pressure"] != "solve":
        refuse_given({"preload"}, "with --pressure solve alone")
    made = attach(model, (face_a, face_b), study=law, **options)
    document = made.to_dict()
    files: list[Path] = []
    lines = [*made.deck.facts, f"{len(made.pairs)} pairs of nodes"]
    if matrices is not None:
        found, rigid = modes_with_joint(
            made, matrices, stiffness_unit=stiffness_unit, mass_unit=mass_unit, mass=mass, dofs=dofs, count=count
        )
        modes = found.frequencies.tolist(), found.loss_factors.tolist()
        document["modes"] = {"frequencies [Hz]": modes[0], "rigid": rigid, "loss_factors": modes[1]}
        lines += ["", f"{'mode':>6}{'f [Hz]':>14}{'loss factor':>14}"]
        lines += [f"{i:>6}{f:>14.4f}{eta:>14.3e}" for i, (f, eta) in enumerate(zip(*modes, strict=True), 1)]
    if solver is not None:
        files = made.write(solver, out or model.parent / "joint")
        document["files"] = [str(file) for file in files]
    if as_json:
        click.echo(json_text(document))
        return
    lines += [f"note: {note}" for note in made.notes]
    lines += [f"written: {file}" for file in files]
    click.echo("\n".join(lines))
