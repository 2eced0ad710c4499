"""faying backbone STUDY.toml --friction 0.2"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import click

from faying import units
from faying.cli.options import FILE, PATH, show
from faying.cli.progress import Shown, progress_options
from faying.errors import InputError
from faying.files import new_folder
from faying.output.terminal import folded
from faying.units import in_mm


@click.command()
@click.argument("study", type=PATH)
@click.option(
    "--mode", type=click.IntRange(1, 10_000), help="Elastic mode, counted from the lowest [that of the study, or 1]."
)
@click.option(
    "--amplitude", metavar="FIRST:LAST", help='Accelerations, for example "0.1 m/s^2:60 m/s^2" [0.1 to 100 m/s^2].'
)
@click.option(
    "--at", metavar="POINT", help='Point of the acceleration, for example "10,0,5 mm" [where the mode moves most].'
)
@click.option("--friction", metavar="MU[,MU]", help="Friction of all joints, a curve for each [that of the joints].")
@click.option("--law", metavar="LAW[,LAW]", help="Contact law of all joints, a curve for each [that of the study].")
@click.option(
    "--preload", "preloads", multiple=True, help='One of the study, for example "8 kN" [the greatest], or all.'
)
@click.option("--harmonics", type=click.IntRange(1, 9), help="Highest harmonic of the motion; 1 is quick [3].")
@click.option("--rest-damping", metavar="RATIO", help='Ratio to critical that is added, for example 0.001, or "law".')
@click.option("--coulomb", is_flag=True, help="One slider at each point in place of the law's own curve.")
@click.option("--measured", multiple=True, type=PATH, help="CSV of measured points to draw.")
@click.option("--out", type=PATH, help="NetCDF file (default: backbone.nc in the folder that run writes to).")
@click.option("--plot", type=FILE, help="Draw the curves (svg, png, pdf).")
@click.option("--json", "as_json", is_flag=True, help="Print the curves as JSON.")
@progress_options
def command(study: Path, **options: Any) -> None:
    """Frequency and damping of one mode of STUDY against its amplitude, from rest to large motions.

    Finished work is saved next to the output; the same command resumes after an interruption.
    """
    from faying.backbones.backbone import backbones, names
    from faying.measured.ring_down import MeasuredBackbone
    from faying.result import backbone as drawing
    from faying.study import Study
    from faying.style import check_figure, save

    plot, out = options["plot"], options["out"]
    if plot:
        check_figure(plot)
    measured = [MeasuredBackbone.read(path) for path in options["measured"]]
    plan = Study.read_bolted(study)
    choice, loads = asked(plan, options)
    out = out or plan.results / "backbone.nc"
    progress = Shown("backbone", options["progress"])
    with new_folder(out.parent, "give another file with --out"), progress as report:
        curves = backbones(plan, choice, loads=loads, out=out, report=report)
    files = names(out, len(curves))
    if plot:
        files.append(save(drawing.figure(curves, measured), plot))
    show(
        options["as_json"],
        lambda: {"curves": [curve.to_dict() for curve in curves]},
        lambda: "\n".join(map(text, curves)),
        files,
    )


def asked(plan: Any, options: dict[str, Any]) -> tuple[Any, list[int]]:
    """The choice of the study with the options in place of it, and the indices of its loads."""
    from faying.backbones.backbone import chosen
    from faying.checks import plain
    from faying.joint.preload_case import preload_index
    from faying.study.keys.backbone import accelerations, laws

    reads: dict[str, Callable[[Any], Any]] = {
        "amplitude": lambda text: accelerations(text, "--amplitude"),
        "at": place,
        "rest_damping": lambda text: "law" if text == "law" else plain(text, "--rest-damping"),
        "law": lambda text: laws(text.split(","), "--law"),
        "friction": lambda text: [plain(part, "--friction") for part in text.split(",")],
    }
    given = {name: read(options[name]) for name, read in reads.items() if options[name] is not None}
    given |= {"mode": options["mode"], "harmonics": options["harmonics"], "laws": given.pop("law", None)}
    given |= {"slip": "coulomb"} if options["coulomb"] else {}
    friction = given.pop("friction", None)
    preloads = options["preloads"]
    if "all" in preloads:
        if len(preloads) > 1:
            raise InputError("--preload all takes every preload of the study; leave out the others")
        loads = list(range(len(plan.loads)))
    elif preloads:
        loads = [preload_index(plan.loads, value, names=plan.load_names, name="--preload") for value in preloads]
    else:
        loads = [len(plan.loads) - 1]
    return chosen(plan, friction, given), loads


def place(text: str) -> tuple[float, float, float]:
    """Turn "10,0,5 mm" into a point [m]; InputError that shows the form otherwise."""
    numbers, _, unit = text.strip().rpartition(" ")
    parts = [part.strip() for part in numbers.split(",")]
    if len(parts) != 3 or not unit:
        raise InputError(f'--at = "{text}" should be three lengths with their unit, for example "10,0,5 mm"')
    x, y, z = (units.parse(f"{part} {unit}", "m", name="--at") for part in parts)
    return x, y, z


def text(curve: Any) -> str:
    """The table, error bounds and notes of a curve for the terminal."""
    from faying.output import table

    head = (
        f"{curve.title}: mode {curve.mode}, {curve.settings}; at {in_mm(curve.at)}\n"
        f"{curve.unknowns:,} unknowns in {curve.basis_size} vectors, harmonics 0 to {curve.harmonics}; at rest "
        f"{curve.linear_frequency:.3f} Hz\n"
    )
    parts = [head, table.text(table.backbone(curve)), f"\nends: {curve.reason}\n"]
    if curve.measured is not None:
        parts += [f"measured points of {curve.measured_source}", table.text(table.backbone_measured(curve)), ""]
    parts += ["error bounds", table.text(table.backbone_bounds(curve)), ""]
    return folded("\n".join([*parts, *(f"note: {line}" for line in curve.warnings)]))
