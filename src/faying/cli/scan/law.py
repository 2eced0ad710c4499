"""`faying law`: the curves of one contact law, or of several on one scan, as tables, JSON, CSV and figures."""

from __future__ import annotations

from contextlib import nullcontext
from dataclasses import asdict, replace
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import click

from faying.cli.options import PATH, NamedPath, quantity, refuse_given
from faying.errors import InputError
from faying.files import write_text
from faying.output.terminal import folded, indented
from faying.text import csv_text as csv_rows
from faying.text import json_text
from faying.units import lengths, parse, show

if TYPE_CHECKING:
    from collections.abc import Mapping

    from faying.contact.auto import Choice
    from faying.contact.build import LawKind
    from faying.contact.law import ContactLaw
    from faying.contact.mates import Mates
    from faying.contact.response import Response
    from faying.contact.two_faces import RoughPair
    from faying.materials import ContactPair
    from faying.typing import Array

# what the table shows: heading and factor from SI
SHOWN = {
    "pressure": ("p [MPa]", 1e-6),
    "area": ("Ar/A0", 1.0),
    "k_n": ("k_n", 1e-12),
    "k_load": ("k_load", 1e-12),
    "k_t": ("k_t", 1e-12),
    "k_n_low": ("k_n low", 1e-12),
    "k_n_high": ("k_n high", 1e-12),
    "loss_n": ("loss n", 1.0),
    "loss_t": ("loss t", 1.0),
    "h": ("h", 1.0),
}
HEAT = "W/(m^2*K)"
WIDTH = 78
PRESSURES = "0.1 MPa:50 MPa"
OF_NUMBERS = ("D", "G", "G_majumdar_bhushan", "scan_area", "side")  # what laws take from --D, --G and --scan-area


@click.command()
@click.option("--model", help="The law; `faying models` lists them. Default: auto on a scan, JK on D and G.")
@click.option("--D", "D", help="Fractal dimension of both faces together, 2 to 3.")
@click.option("--G", "G", metavar="LENGTH", help='Fractal roughness of both faces together, for example "1.53e-10 m".')
@click.option("--scan-area", metavar="AREA", help='Area that D and G belong to, for example "16 mm^2".')
@click.option(
    "--set",
    "settings",
    multiple=True,
    metavar="NAME=VALUE",
    help='Any parameter of the model, for example --set cutoff=0.01 or --set "sigma=0.8 um".',
)
@click.option(
    "--material", default=None, help='Material of the scanned face, from the catalogue, for example "45 steel".'
)
@click.option(
    "--against",
    default="same",
    show_default=True,
    help='Material of the other face: "same", a name of the catalogue, or "rigid".',
)
@click.option("--E", "E", metavar="STRESS", help="Young's modulus, in place of or over --material.")
@click.option("--nu", type=float, help="Poisson's ratio.")
@click.option("--hardness", metavar="STRESS", help="Hardness.")
@click.option("--yield-strength", metavar="STRESS", help="Yield strength; hardness is 2.8 times it where not given.")
@click.option("--friction", type=float, help="Static friction coefficient.")
@click.option(
    "--conductivity", metavar="W/(m K)", help='Thermal conductivity, for --conductance, for example "50 W/(m K)".'
)
@click.option(
    "--pressure",
    metavar="FROM:TO[:POINTS]",
    help="Nominal pressures, spaced logarithmically; or one pressure. Default: 0.1 to 50 MPa, as far as the law goes.",
)
@click.option(
    "--after",
    metavar="STRESS",
    help='Greatest pressure that the faces have carried before, such as "40 MPa"; none where left out.',
)
@click.option("--scan", type=PATH, help="A scan: D, G, moments and area come from it.")
@click.option("--xy-unit", help='Unit of x and y where the scan states none, for example "mm".')
@click.option("--z-unit", help='Unit of the heights where the scan states none, for example "um".')
@click.option("--size", metavar="LENGTHS", help='Size of a scan whose file states none, for example "4 mm x 3 mm".')
@click.option("--spacing", metavar="LENGTHS", help='Distance of its points, in place of --size, for example "5 um".')
@click.option("--channel", help="Name of the map of heights, where the file holds several.")
@click.option(
    "--counter",
    metavar="FILE|same|smooth",
    help="The other face: its scan; statistically alike, the default; or smooth. With --scan.",
)
@click.option("--method", default="psd", show_default=True, help="Estimator of D and G; `faying surface` lists them.")
@click.option("--models", metavar="LIST", help='Several laws of the scan, for example "jk,gw,gw-ke,persson".')
@click.option("--all-models", is_flag=True, help="All laws of a scan, with their ratio to the half-space.")
@click.option("--conductance", is_flag=True, help="Also the thermal conductance h from k_n, for clean metal in vacuum.")
@click.option(
    "--to",
    "program",
    type=click.Choice(["abaqus", "calculix"]),
    help="Print the law as a surface interaction of that program, with --unit; --pressure: where friction sticks.",
)
@click.option("--unit", help='With --to: unit of length of the model, such as "mm"; force in N.')
@click.option("--json", "as_json", is_flag=True, help="Print JSON in SI units instead of a table.")
@click.option("--csv", "csv_file", type=NamedPath(dir_okay=False), help="Write all columns to a CSV file.")
@click.option("--plot", type=NamedPath(dir_okay=False), help="Write a figure (png, pdf, svg).")
def command(
    model: str | None,
    settings: tuple[str, ...],
    pressure: str | None,
    as_json: bool,
    csv_file: str | None,
    plot: str | None,
    models: str | None,
    all_models: bool,
    after: str | None,
    program: str | None,
    unit: str | None,
    **options: Any,
) -> None:
    """Real area, stiffness and loss of a contact law against nominal pressure.

    Example: faying law --D 2.39 --G "1.53e-10 m" --scan-area "16 mm^2" --material "45 steel"
    """
    from faying.cli.scan import law_table
    from faying.contact.auto import pick
    from faying.contact.build import find

    on_scan = options["scan"] is not None
    if not on_scan:
        refuse_given({*OF_SCAN, "method"}, "with --scan FILE alone")
    if models or all_models:
        refuse_given({"after"}, "for one law")
    if program:
        others = {"models", "all_models", "after", "csv_file", "plot", "as_json", "conductance"}
        refuse_given(others, "--to prints one law on first loading")
    if (program is None) is not (unit is None):
        raise InputError('--to takes --unit, such as "mm"')
    kind = find(model or ("auto" if on_scan else "JK"))
    needed = on_scan or options["conductance"] or kind.label == "auto" or kind.law.takes_materials()
    pair = pair_of(options, needed=needed)
    mates = mates_of(options, kind, pair)
    pressures = pressures_of(pressure or PRESSURES)
    several = None if all_models else [name for name in (models or "").split(",") if name.strip()]
    if models or all_models:
        if mates is None or not on_scan or settings:
            raise InputError("--models and --all-models take every input from a scan: give --scan FILE and no --set")
        files = {"csv_file": csv_file, "plot": plot}
        law_table.show(mates, several, pressures, **files, as_json=as_json, conductance=options["conductance"])
        return
    given = given_of(kind, options, settings, mates)
    with nullcontext() if mates is None else law_table.watched(mates) as seen:
        choice = pick(kind, given, None, pair) if seen is None else seen.choose(kind, given)
        law = choice.law
        if program is not None:
            from faying.export.law_tables import law_tables

            click.echo(law_tables(law, program, unit=unit or "m", pressure=pressure), nl=False)
            return
        response = law.at_pressure(pressures if pressure is not None else reached(law, pressures), after=after)
    h = conducted(law, response, pair) if options["conductance"] else None
    if csv_file:
        write_text(Path(csv_file), csv_text(law, response, h))
    if plot:
        from faying.contact.figure import curves
        from faying.style import save

        if after:
            save(law.plot(response.pressure, after=after)[0].get_figure(), plot)
        else:
            save(curves({law.name: response}), plot)
    if as_json:
        about: dict[str, Any] = {"reason": choice.reason, "mates": choice.mates}
        if mates is not None and on_scan:
            from faying.study.keys.surface import Surface

            about["surface"] = Surface(faces=mates.faces, origin=mates.faces.origin).facts()
        about |= {} if h is None else {"h": quantity(h.tolist(), HEAT)}
        about |= {} if after is None else {"after": quantity(parse(after, "Pa", name="--after"), "Pa")}
        click.echo(json_text(document(law, response) | about))
        return
    before = [] if after is None else [f"the faces have carried {after} before, in place", ""]
    click.echo(folded("\n".join([*heading(choice, mates, kind, given), *before, table(law, response, h)])))


def conducted(law: ContactLaw, response: Response, pair: ContactPair) -> Array:
    """Conductance of heat [W/(m2 K)] that goes with k_n; InputError without k_n or without the conductivities."""
    from faying.contact.conductance import heat_conductance

    if response.k_n is None:
        raise InputError(f"--conductance follows from k_n, and {law.name} gives none; name another --model")
    return heat_conductance(response.k_n, pair)


def heading(choice: Choice, mates: Mates | None, kind: LawKind, given: Mapping[str, object]) -> list[str]:
    """Both faces, what the scan says of D and G where the law takes them, and why the law was taken."""
    from faying.contact.mates import takes_fit
    from faying.output import table

    lines = []
    if mates is not None:
        lines += wrap(f"mates: {mates.line}", WIDTH)
        fitted = takes_fit(kind, given, mates.faces)
        if fitted and (fit := mates.faces.fit) is not None:
            rows = [["method", *table.FRACTAL], [fit.method, *table.fractal(asdict(fit))]]
            lines += indented(rows, width=WIDTH)
        lines += [line for text in mates.faces.warnings if fitted for line in wrap(f"note: {text}", WIDTH)]
    if choice.reason:
        lines += wrap(f"law: {choice.reason}", WIDTH)
    return [*lines, ""] if lines else []


def mates_of(options: dict[str, Any], kind: LawKind, pair: ContactPair) -> Mates | None:
    """Both faces with their materials: of --scan, read as a study does, or of --D, --G and --scan-area together.

    None where a law has no surface, or takes none of these numbers from one.
    """
    from faying.contact.mates import Mates
    from faying.contact.parameter import FRACTAL

    numbers: dict[str, Any] = {
        name: FRACTAL[name].read(str(options[name]), name) for name in FRACTAL if options[name] is not None
    }
    if options["scan"] is not None:
        if 0 < len(numbers) < len(FRACTAL):
            raise InputError(
                f"{', '.join(numbers)} beside --scan: D, G and scan_area are one answer; give all, or none"
            )
        return Mates(faces_of(options, numbers), materials=pair)
    if len(numbers) < len(FRACTAL) or not (kind.label == "auto" or kind.takes(OF_NUMBERS, ())):
        return None
    return Mates.of_fractal(**numbers, materials=pair)


def faces_of(options: dict[str, Any], numbers: dict[str, Any]) -> RoughPair:
    """Read, level and fit the scan of --scan, as a study does; numbers: D, G and area in place of its own."""
    from faying.contact.two_faces import COUNTERS
    from faying.study.keys.surface import SurfaceChoice

    names = ("scan", "xy_unit", "z_unit", "channel", "method")
    sizes: dict[str, Any] = {
        name: lengths(options[name], name=f"--{name}") for name in ("size", "spacing") if options[name]
    }
    counter = options["counter"] or "same"
    if counter not in COUNTERS and not Path(counter).is_file():
        raise InputError(f'--counter {counter}: no such file; give the scan of the other face, "same" or "smooth"')
    choice = SurfaceChoice(**{name: options[name] for name in names}, counter=counter, **sizes, **numbers)
    faces = choice.read().faces
    if faces is None or faces.unfitted.scan is None:
        raise InputError(f"{options['scan']} is a profile; contact laws need an areal scan")
    return faces


def pair_of(options: dict[str, Any], *, needed: bool) -> ContactPair:
    """Build the pair from --material, --E ... and --against; needed: whether a law takes it."""
    from faying.materials import ContactPair, Material, material_of

    stresses = ("E", "hardness", "yield_strength")
    given: dict[str, Any] = {
        n: parse(options[n], "Pa", name=f"--{n.replace('_', '-')}") for n in stresses if options[n] is not None
    }
    given |= {n: options[n] for n in ("nu", "friction") if options[n] is not None}
    if options["conductivity"] is not None:
        given["conductivity"] = parse(options["conductivity"], "W/(m*K)", name="--conductivity")
    if options["material"] is None:
        if not given and not needed:
            return ContactPair("45 steel", "45 steel")  # of a law that was measured, which takes none
        if not {"E", "nu"} <= set(given):
            raise InputError('no material: give --material, for example "45 steel", or --E and --nu')
        rough = Material(name="given", **given)
    else:
        rough = material_of(options["material"])
        if "yield_strength" in given and "hardness" not in given:
            given["hardness"] = None
        if {"yield_strength", "hardness"} & set(given):
            given |= {"brinell": None, "vickers": None}  # else laws that take a hardness for each size of spot have it
        rough = replace(rough, **given)
    against = options["against"]
    return ContactPair(rough, rough if against == "same" else against)


def given_of(
    kind: LawKind, options: dict[str, Any], settings: tuple[str, ...], mates: Mates | None = None
) -> dict[str, Any]:
    """Read the parameters of a law from --set, and from --D, --G and --scan-area where they are not those of mates.

    Every fault is in one message.
    """
    from faying.contact.build import check_entries

    own = ("D", "G", "scan_area") if mates is None else ()
    texts = {name: str(options[name]) for name in own if options[name] is not None}
    faults = []
    for setting in settings:
        name, mark, text = setting.partition("=")
        if not mark:
            faults.append(f'--set "{setting}" is not NAME=VALUE')
        else:
            texts[name.strip()] = text.strip()
    out: dict[str, Any] = {}
    for name, text in texts.items():
        try:
            check_entries(kind, [name])
            out[name] = kind.law.entries()[name].read(text, name)
        except InputError as fault:
            faults.append(str(fault))
    if faults:
        raise InputError("\n  ".join(faults))
    return out


def pressures_of(text: str) -> Array:
    """Read "FROM:TO", "FROM:TO:POINTS" or one pressure [Pa]; InputError otherwise."""
    import numpy as np

    parts = [part.strip() for part in text.split(":")]
    if len(parts) > 3:
        raise InputError(f'--pressure "{text}"; write FROM:TO or FROM:TO:POINTS, for example "0.1 MPa:50 MPa:20"')
    values = [parse(part, "Pa", name="--pressure") for part in parts[:2]]
    if len(values) == 1:
        return np.array(values)
    if not 0 < values[0] < values[1]:
        raise InputError(f'--pressure "{text}": the first must be above 0 and below the second')
    points = parts[2] if len(parts) == 3 else "19"
    if not points.isdigit() or not 2 <= int(points) <= MAX_POINTS:
        raise InputError(f'--pressure "{text}": POINTS = {points}; it must be a whole number from 2 to {MAX_POINTS:,}')
    return np.geomspace(values[0], values[1], int(points))


def reached(law: ContactLaw, pressures: Array) -> Array:
    """As many pressures [Pa] over the part of their range that a law covers; all of them where it covers none."""
    import numpy as np

    first, last = max(pressures[0], law.least_pressure), min(pressures[-1], law.greatest_pressure)
    return np.geomspace(first, last, pressures.size) if first < last else pressures


MAX_POINTS = 1_000_000
OF_SCAN = ("counter", "xy_unit", "z_unit", "size", "spacing", "channel")  # options that say how a scan is read


def parameter_values(law: ContactLaw) -> dict[str, Any]:
    """Return the parameters of a law as they are, by name, for print and JSON."""
    values = {name: getattr(law, name) for name in law.parameters}
    return {name: value for name, value in values.items() if isinstance(value, (int, float, str))}


def document(law: ContactLaw, response: Response) -> dict[str, Any]:
    """Everything that the command knows, as a tree for JSON; SI units."""
    from faying.contact.response import UNITS

    pair = law.made_for
    parameters = law.parameters
    return {
        "law": law.name,
        "source": law.source,
        "parameters": {n: quantity(v, parameters[n].unit) for n, v in parameter_values(law).items()},
        "materials": None if pair is None else [pair.first.name, pair.second.name],
        "E_star": None if pair is None else quantity(pair.E_star, "Pa"),
        **{name: quantity(value.tolist(), UNITS[name]) for name, value in response.quantities().items()},
        "valid": response.valid.tolist(),
        "reasons": {reason: mask.tolist() for reason, mask in response.reasons.items() if mask.any()},
    }


def table(law: ContactLaw, response: Response, h: Array | None = None) -> str:
    """Format the response for the terminal; * marks rows outside the validity range, with the reasons below."""
    quantities = response.quantities() | ({} if h is None else {"h": h})
    names = [name for name in SHOWN if name in quantities]
    given = []
    for n, v in parameter_values(law).items():
        unit = law.parameters[n].unit
        given.append(f"{n} {v if isinstance(v, str) else show(v, unit) if unit else f'{v:.6g}'}")
    lines = [f"{law.name}, {law.source}"]
    while given:
        line = "  " + given.pop(0)
        while given and len(line) + len(given[0]) < WIDTH:
            line += ", " + given.pop(0)
        lines.append(line)
    pair = law.made_for
    if pair is not None:
        lines.append(f"  {pair.first.name} against {pair.second.name}, E* {show(pair.E_star, 'Pa')}")
    lines.append("")
    if "k_n" in names:
        lines += [f"  {line}" for line in branches(law, quantities)] + [""]
    width = min(13, WIDTH // len(names))
    digits = 4 if width > 10 else 3
    lines.append("".join(f"{SHOWN[name][0]:>{width}}" for name in names))
    for i, good in enumerate(response.valid):
        row = "".join(f"{quantities[name][i] * SHOWN[name][1]:>{width}.{digits}g}" for name in names)
        lines.append(row + ("" if good else " *"))
    if not response.valid.all():
        lines += ["", "  * outside the validity range of the model:"]
        for reason, mask in response.reasons.items():
            if mask.any():
                low, high = response.pressure[mask].min(), response.pressure[mask].max()
                lines.append(f"    {reason}, at {show(float(low), 'Pa')} to {show(float(high), 'Pa')}")
    lines += [f"note: {text}" for text in law.assumptions]
    if h is not None:
        lines.append("h in W/(m2 K): clean metal in vacuum; films hinder the flow, gas and grease help it")
    if response.loss_n is None and response.loss_t is None:
        lines.append("loss: not predicted")
    return "\n".join(lines)


def branches(law: ContactLaw, quantities: Mapping[str, Array]) -> list[str]:
    """Which stiffness is which, in MPa/um."""
    if "k_load" in quantities:
        return [
            "stiffness in MPa/um; k_n on unloading: vibration, ultrasound, conductance;",
            "k_load on loading: slow approach curves, preload, embedding",
        ]
    branch = getattr(law, "stiffness", "")
    return [f"stiffness in MPa/um{f', on {branch}' if branch else ''}"]


def csv_text(law: ContactLaw, response: Response, h: Array | None = None) -> str:
    """Return every column with its unit, and whether the law is within its validity range."""
    from faying.contact.response import UNITS

    quantities = response.quantities() | ({} if h is None else {"h": h})
    units = UNITS | {"h": HEAT}
    head = [f"{name} [{units[name] or '-'}]" for name in quantities]
    rows = zip(*(value.tolist() for value in quantities.values()), response.valid.tolist(), strict=True)
    cells = ([repr(v) if isinstance(v, float) else str(v).lower() for v in row] for row in rows)
    return f"# {law.name}, {law.source}\n" + csv_rows([[*head, "valid"], *cells])
