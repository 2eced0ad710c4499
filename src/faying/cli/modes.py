"""faying modes [STUDY.toml] --stiffness FILE --mass FILE"""

from pathlib import Path
from typing import Any

import click

from faying import units
from faying.cli.options import PATH
from faying.errors import InputError
from faying.text import json_text


@click.command()
@click.argument("study", required=False, type=PATH)
@click.option("--stiffness", type=PATH, help="In place of a study: .mtx, .npz, .sti of CalculiX, or DMIG of Nastran.")
@click.option("--mass", type=PATH, help="Mass matrix, where the file of --stiffness has none.")
@click.option("--stiffness-unit", default="N/m", show_default=True, help="Unit of the stiffness entries.")
@click.option("--mass-unit", default="kg", show_default=True, help="Unit of the mass entries.")
@click.option(
    "--count", type=click.IntRange(1, 10_000), default=20, show_default=True, help="Modes, rigid motions among them."
)
@click.option("--shift", metavar="FREQUENCY", help='Frequency of the spectral shift, for example "100 Hz" [found].')
@click.option(
    "--points",
    type=PATH,
    help="With --stiffness and --mpi: x y z [m] of each node, in the order of the matrices, three unknowns a node.",
)
@click.option(
    "--mpi",
    type=click.IntRange(1, 1_000_000),
    metavar="PROCESSES",
    help="Solve with PETSc in this number of processes, started by mpiexec.",
)
@click.option(
    "--export",
    type=PATH,
    metavar="DIR",
    help="Write stiffness.npz, mass.npz, dofs.txt and points.txt and solve nothing.",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def command(
    study: Path | None,
    stiffness: Path | None,
    mass: Path | None,
    stiffness_unit: str,
    mass_unit: str,
    count: int,
    shift: str | None,
    points: Path | None,
    mpi: int | None,
    export: Path | None,
    as_json: bool,
) -> None:
    """Real modes of STUDY at its first preload, or of assembled matrices."""
    from faying.export.assembled import Assembled
    from faying.export.matrix_modes import modes_of
    from faying.study import Study

    if (study is None) == (stiffness is None):
        raise InputError("give either a study or --stiffness and --mass, for example faying modes study.toml")
    if study is not None:
        for name, option in (("--mass", mass), ("--points", points)):
            if option is not None:
                raise InputError(f"{name} is for --stiffness; a study has its own")
        given = Assembled.of_study(Study.read(study))
    else:
        assert stiffness is not None
        given = Assembled.of_files(stiffness, mass, stiffness_unit=stiffness_unit, mass_unit=mass_unit, points=points)
    if export is not None:
        files = given.write(export)
        click.echo(f"shift {given.shift_frequency:.6g} Hz; written to {export}: {', '.join(f.name for f in files)}")
        return
    frequency = units.parse(shift, "Hz", name="--shift") if shift else given.shift_frequency
    found = modes_of(given, count, frequency).to_dict() if mpi is None else _over_mpi(given, count, frequency, mpi)
    if as_json:
        click.echo(json_text(found))
        return
    click.echo(f"{found['source']}: {found['unknowns']:,} unknowns, {found['solver']}")
    if mpi is not None:
        peaks = ", ".join(f"{peak / 1e9:.3g}" for peak in found["process_memory"]["values"])
        click.echo(f"{found['iterations']} iterations; memory of the {mpi} processes: {peaks} GB")
    if "mass" in found:
        click.echo(f"mass along x, y, z: {', '.join(f'{m:.6g} kg' for m in found['mass']['values'])}")
    click.echo("")
    for number, value in enumerate(found["frequencies"]["values"], start=1):
        click.echo(f"{number:4d} {value:14.6f} Hz")
    if found.get("missed"):
        click.echo(
            f"note: {found['missed']} modes below the last of these are missing; give another --shift, below the first"
        )


def _over_mpi(given: Any, count: int, shift: float, processes: int) -> dict[str, Any]:
    from faying.export.modes_over_mpi import modes_over_mpi

    modes, solver = modes_over_mpi(
        given.stiffness, given.mass, count, shift_frequency=shift, processes=processes, points=given.points
    )
    return {
        "source": given.source,
        "unknowns": int(given.mass.shape[0]),
        "solver": modes.factorisation.name,
        "processes": processes,
        "iterations": solver.steps,
        "process_memory": {"unit": "B", "values": solver.peak.tolist()},
        "process_cpu": {"unit": "s", "values": solver.cpu.tolist()},
        "error_of_squares": modes.error.tolist(),
        "frequencies": {"unit": "Hz", "values": modes.frequencies.tolist()},
    }
