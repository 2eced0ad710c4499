"""`faying asperity`: press one asperity, or a table of them, by finite elements."""

from pathlib import Path
from typing import Any

import click

from faying.cli.options import NamedPath
from faying.cli.progress import Shown
from faying.errors import FayingError, InputError, ReadError
from faying.text import json_text
from faying.units import parse, show

COLUMNS = {
    "R": "m",
    "h_a": "m",
    "displacement": "m",
    "force": "N",
    "E": "Pa",
    "substrate_E": "Pa",
    "yield_strength": "Pa",
    "substrate_yield_strength": "Pa",
    "nu": "",
    "hardening": "",
    "elements": "",
}
NEEDED = ("R", "h_a")
OF_CAPS = {"m": "1 um", "Pa": "300 MPa"}  # examples in messages


@click.command()
@click.option("--R", "R", metavar="LENGTH", help='Radius of the cap, for example "15 um".')
@click.option("--h-a", "h_a", metavar="LENGTH", help="Height of the cap; R makes half a sphere.")
@click.option(
    "--displacement",
    multiple=True,
    metavar="LENGTH",
    help="Displacement of the plane from first touch; repeat for turning points, 0 at the end unloads.",
)
@click.option("--force", multiple=True, metavar="FORCE", help="Force on the plane, in place of the displacement.")
@click.option("--material", default="45 steel", show_default=True, help="Cap and substrate: a name of the catalogue.")
@click.option("--E", "E", metavar="STRESS", help="Young's modulus of the cap.")
@click.option("--nu", type=float, help="Poisson's ratio of both.")
@click.option(
    "--yield-strength", metavar="STRESS", help="Yield strength of the cap, and of the substrate unless it has its own."
)
@click.option("--hardening", type=float, default=0.0, show_default=True, help="Tangent modulus over E.")
@click.option(
    "--substrate",
    type=click.Choice(["same", "rigid", "sliding"]),
    default="same",
    show_default=True,
    help="Deformable; rigid and bonded; rigid and sliding (half of a sphere).",
)
@click.option("--substrate-E", "substrate_E", metavar="STRESS", help="Young's modulus of the substrate.")
@click.option("--substrate-yield-strength", metavar="STRESS", help="Yield strength of the substrate.")
@click.option("--layer-E", "layer_E", metavar="STRESS", help="Young's modulus of a layer under the cap.")
@click.option("--layer-yield-strength", metavar="STRESS", help="Yield strength of the layer.")
@click.option("--layer-thickness", metavar="LENGTH", help="Thickness of the layer.")
@click.option("--elements", type=click.IntRange(4, 400), default=40, show_default=True, help="Over the contact radius.")
@click.option("--steps", type=click.IntRange(1, 100_000), help="Load steps [1.5 for each contact element].")
@click.option("--table", "table_file", type=NamedPath(), help=f"CSV of cases with columns from {', '.join(COLUMNS)}.")
@click.option("--processes", type=click.IntRange(1, 1024), help="For --table [the number of cores].")
@click.option("--netcdf", type=NamedPath(dir_okay=False), help="Write histories and results.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON in SI units instead of a table.")
@click.option("--plot", type=NamedPath(dir_okay=False), help="Figure of one case with the published laws.")
def command(
    table_file: str | None,
    processes: int | None,
    netcdf: str | None,
    as_json: bool,
    plot: str | None,
    **options: Any,
) -> None:
    """Force, contact area and pressure of a spherical cap under a smooth rigid plane, by finite elements.

    Example: faying asperity --R "15 um" --h-a "100 nm" --displacement "10 nm" --E "100 GPa"
    """
    from faying.asperity_fe.cases import solve_cases, write_netcdf

    if table_file:
        cases = [case_of({**options, **row}) for row in rows_of(table_file)]
    else:
        cases = [case_of(options)]
    if plot and len(cases) > 1:
        raise InputError(f"--plot draws one case and the table has {len(cases)}; leave out --plot or --table")
    with Shown("asperity") as report:
        results = solve_cases(cases, processes=processes, progress=lambda done: report("cases", done, len(cases)))
    if netcdf:
        write_netcdf(netcdf, cases, results)
    first: Any = results[0]
    if len(cases) == 1 and isinstance(first, FayingError):
        raise first
    if plot:
        from faying.output.figures.asperity import overview
        from faying.style import save

        save(overview(cases[0], first), plot)
    document = [described(case, result) for case, result in zip(cases, results, strict=True)]
    click.echo(json_text(document) if as_json else table(document))
    failed = sum("error" in entry for entry in document)
    if failed:
        raise FayingError(f"{failed} of {len(cases)} cases failed; see their messages above")


def rows_of(file: str) -> list[dict[str, str]]:
    """Rows of the CSV of cases; InputError for columns that are unknown or missing."""
    import csv

    try:
        with Path(file).open(newline="", encoding="utf-8") as handle:
            reader = csv.DictReader(handle)
            rows = [{k: v for k, v in row.items() if v} for row in reader]
            names = list(reader.fieldnames or [])
    except (OSError, UnicodeDecodeError) as fault:
        raise ReadError(f"{file}: cannot be read ({fault}); give a CSV file with a line of headings") from None
    unknown = [n for n in names if n not in COLUMNS]
    missing = [n for n in NEEDED if n not in names]
    if unknown or missing:
        raise InputError(
            f"{file}: columns {', '.join(map(str, unknown)) or 'none'} unknown, {', '.join(missing) or 'none'} missing;"
            f" allowed are {', '.join(COLUMNS)}, with units in the cells"
        )
    return rows


def case_of(options: dict[str, Any]) -> Any:
    """Build one case from texts with units."""
    from faying.asperity_fe.drive import AsperityCase
    from faying.materials import CATALOGUE, RIGID, Material

    def number(key: str, unit: str, default: float | None = None) -> float:
        value = options.get(key)
        if value in (None, "", ()):
            if default is None:
                raise InputError(f"{key} is missing; give --{key.replace('_', '-')}, for example '{OF_CAPS[unit]}'")
            return default
        return float(value) if unit == "" else parse(value, unit, name=key)

    def below(name: str) -> Material:
        """What is under the cap: as the cap, where nothing else is given."""
        own = number(f"{name}_E", "Pa", E), number(f"{name}_yield_strength", "Pa", strength)
        return Material(name=name, E=own[0], nu=nu, yield_strength=own[1])

    base = CATALOGUE.get(options["material"])
    if base is None:
        raise InputError(f"material {options['material']!r} is unknown; choose from {', '.join(CATALOGUE)}")
    nu = number("nu", "", base.nu)
    strength = number("yield_strength", "Pa", base.yield_strength)
    E = number("E", "Pa", base.E)
    cap = Material(name="cap", E=E, nu=nu, yield_strength=strength)
    under = below("substrate")
    thickness = number("layer_thickness", "m", 0.0)
    layer = None
    if thickness or options.get("layer_E") or options.get("layer_yield_strength"):
        layer = below("layer")
    moves, forces = (
        history_of(options.get(key) or (), key, unit) for key, unit in (("displacement", "m"), ("force", "N"))
    )
    if not moves and not forces:
        raise InputError("displacement is missing; give --displacement, for example '10 nm', or --force, '1 mN'")
    return AsperityCase(
        R=number("R", "m"),
        h_a=number("h_a", "m"),
        cap=cap,
        substrate=under if options["substrate"] == "same" else RIGID,
        foot="sliding" if options["substrate"] == "sliding" else "bonded",
        displacement=moves or None,
        force=forces or None,
        layer=layer,
        layer_thickness=thickness,
        hardening=number("hardening", "", 0.0),
        elements=int(number("elements", "", 40)),
        steps=options.get("steps"),
    )


def history_of(given: Any, name: str, unit: str) -> tuple[float, ...]:
    """Turning points of a history from texts with units; 0 needs none. A cell of a table separates them by ";"."""
    words = given.split(";") if isinstance(given, str) else given
    return tuple(0.0 if str(v).strip() == "0" else parse(v, unit, name=name) for v in words)


def described(case: Any, result: Any) -> dict[str, Any]:
    """Inputs and outcome of one case, SI units."""
    out: dict[str, Any] = {
        "R": case.R,
        "h_a": case.h_a,
        "E_cap": case.cap.E,
        "given": list(case.displacement or case.force),
    }
    if isinstance(result, FayingError):
        return out | {"error": str(result)}
    last = ("force", "area", "area_bounds", "pressure", "residual", "unknowns")
    every = ("displacement", "force", "area", "pressure", "area_bounds")
    history = {name: getattr(result.history, name).tolist() for name in every}
    return out | {name: getattr(result, name) for name in last} | {"history": history}


def table(document: list[dict[str, Any]]) -> str:
    """Format the outcome for the terminal: the greatest load and, where there is one, the residual displacement."""
    columns = {"R": 10, "h_a": 10, "displacement": 14, "force": 12, "area": 14, "bounds": 26, "pressure": 12}
    lines = ["".join(f"{name:>{width}}" for name, width in (columns | {"residual": 12}).items())]
    for entry in document:
        head = f"{show(entry['R'], 'm'):>10}{show(entry['h_a'], 'm'):>10}"
        if "error" in entry:
            lines.append(f"{head}  {entry['error']}")
            continue
        history = entry["history"]
        top = max(range(len(history["force"])), key=history["force"].__getitem__)
        low, high = history["area_bounds"][top]
        bounds = f"{low * 1e12:.4g} .. {high * 1e12:.4g} um2"
        residual = "-" if entry["residual"] is None else show(entry["residual"], "m")
        lines.append(
            f"{head}{show(history['displacement'][top], 'm'):>14}{show(history['force'][top], 'N'):>12}"
            f"{history['area'][top] * 1e12:>10.4g} "
            f"um2{bounds:>26}{show(history['pressure'][top], 'Pa'):>12}{residual:>12}"
        )
    return "\n".join(lines)
