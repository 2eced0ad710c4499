"""faying modes [STUDY.toml] --stiffness FILE --mass FILE"""

import json
from pathlib import Path
from typing import Any

import click


@click.command()
@click.argument("study", required=False, type=click.Path(path_type=Path))
@click.option(
    "--stiffness",
    type=click.Path(path_type=Path),
    help="In place of a study: .mtx, .npz, .sti of CalculiX, or DMIG of Nastran.",
)
@click.option("--mass", type=click.Path(path_type=Path), help="Beside --stiffness, where that file does not hold it.")
@click.option("--stiffness-unit", default="N/m", show_default=True, help="Of the entries of the stiffness.")
@click.option("--mass-unit", default="kg", show_default=True, help="Of the entries of the mass.")
@click.option(
    "--count", type=click.IntRange(1, 10_000), default=20, show_default=True, help="Modes, rigid motions among them."
)
@click.option("--shift", metavar="FREQUENCY", help='Of the shift of the spectrum, for example "100 Hz" [found].')
@click.option("--slepc", is_flag=True, help="Solve with SLEPc and MUMPS over the processes of mpiexec.")
@click.option(
    "--export",
    type=click.Path(path_type=Path),
    metavar="DIR",
    help="Write stiffness.npz, mass.npz and dofs.txt and solve nothing.",
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
    slepc: bool,
    export: Path | None,
    as_json: bool,
) -> None:
    """Real modes of STUDY at its first preload, or of assembled matrices.

    Over several processes: mpiexec -n 4 faying modes --slepc --stiffness stiffness.npz --mass mass.npz
    """
    from faying import units
    from faying.errors import InputError
    from faying.study import Study
    from faying.study.assembled import Assembled

    if (study is None) == (stiffness is None):
        raise InputError("give either a study or --stiffness and --mass, for example faying modes study.toml")
    if study is not None:
        if mass is not None:
            raise InputError("--mass goes with --stiffness; a study brings its own")
        given = Assembled.of_study(Study.read(study))
    else:
        assert stiffness is not None
        given = Assembled.of_files(stiffness, mass, stiffness_unit=stiffness_unit, mass_unit=mass_unit)
    if export is not None:
        files = given.write(export)
        click.echo(f"shift {given.shift_frequency:.6g} Hz; written to {export}: {', '.join(f.name for f in files)}")
        return
    frequency = units.parse(shift, "Hz", name="--shift") if shift else given.shift_frequency
    found = _by_slepc(given, count, frequency) if slepc else _here(given, count, frequency)
    if found is None:  # another process prints
        return
    if as_json:
        click.echo(json.dumps(found, indent=2))
        return
    click.echo(f"{found['source']}: {found['unknowns']:,} unknowns, {found['solver']}")
    if "mass" in found:
        click.echo(f"mass along x, y, z: {', '.join(f'{m:.6g} kg' for m in found['mass']['values'])}")
    click.echo("")
    for number, value in enumerate(found["frequencies"]["values"], start=1):
        click.echo(f"{number:4d} {value:14.6f} Hz")
    if found.get("missed"):
        click.echo(
            f"note: {found['missed']} modes below the last of these are missing; give another --shift, below the first"
        )


def _here(given: Any, count: int, shift: float) -> dict[str, Any]:
    from faying.decks.matrices import total_mass
    from faying.fe.memory import check_modes
    from faying.fe.modes import lowest_modes, missed_modes

    check_modes(count, given.stiffness.shape[0])
    modes = lowest_modes(given.stiffness, given.mass, count, shift_frequency=shift)
    missed = missed_modes(given.stiffness, given.mass, modes)
    return {
        "source": given.source,
        "unknowns": int(given.mass.shape[0]),
        "solver": modes.factorisation.name,
        "factor_memory": {"unit": "B", "value": modes.factorisation.memory},
        "processes": 1,
        "missed": missed,
        "mass": {"unit": "kg", "values": total_mass(given.mass, given.dofs).tolist()},
        "frequencies": {"unit": "Hz", "values": modes.frequencies.tolist()},
    }


def _by_slepc(given: Any, count: int, shift: float) -> dict[str, Any] | None:
    from faying.errors import InputError, NotConverged
    from faying.fe import slepc_worker

    try:
        frequencies, facts = slepc_worker.lowest(given.stiffness.tocsr(), given.mass.tocsr(), count, shift)
    except ImportError as fault:
        raise InputError(
            f"--slepc needs petsc4py and slepc4py in this Python ({fault}); install them, or write the matrices with "
            f"--export DIR and run them where they are: mpiexec -n 4 python3 {slepc_worker.__file__} "
            f"DIR/stiffness.npz DIR/mass.npz --count {count} --shift {shift:.6g}"
        ) from None
    except RuntimeError as fault:
        raise NotConverged(f"SLEPc: {fault}; ask for fewer modes, or give --shift nearer to the first") from None
    if facts.pop("rank"):
        return None
    return facts | {"source": given.source, "frequencies": {"unit": "Hz", "values": frequencies.tolist()}}
