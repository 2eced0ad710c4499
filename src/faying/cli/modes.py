"""faying modes [STUDY.toml] --stiffness FILE --mass FILE"""

from pathlib import Path

import click

from faying import units
from faying.cli.options import PATH, refuse_given
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
    export: Path | None,
    as_json: bool,
) -> None:
    """Real modes of STUDY at its first preload, or of assembled matrices."""
    from faying.export.matrix_modes import Assembled, modes_of
    from faying.study import Study

    if (study is None) == (stiffness is None):
        raise InputError("give either a study or --stiffness and --mass, for example faying modes study.toml")
    if study is not None:
        refuse_given({"mass", "stiffness_unit", "mass_unit"}, "for --stiffness; a study has its own")
        given = Assembled.of_study(Study.read(study))
    else:
        assert stiffness is not None
        given = Assembled.of_files(stiffness, mass, stiffness_unit=stiffness_unit, mass_unit=mass_unit)
    if export is not None:
        files = given.write(export)
        click.echo(f"shift {given.shift_frequency:.6g} Hz; written to {export}: {', '.join(f.name for f in files)}")
        return
    frequency = units.parse(shift, "Hz", name="--shift") if shift else given.shift_frequency
    modes = modes_of(given, count, frequency)
    found = modes.to_dict()
    if as_json:
        click.echo(json_text(found))
        return
    click.echo(f"{found['source']}: {found['unknowns']:,} unknowns, {found['solver']}")
    click.echo(f"mass: {modes.summary()[1]['mass']}\n")
    for number, value in enumerate(found["frequencies"]["values"], start=1):
        click.echo(f"{number:4d} {value:14.6f} Hz")
    if found["missed"]:
        click.echo(
            f"note: {found['missed']} modes below the last of these are missing; give another --shift, below the first"
        )
