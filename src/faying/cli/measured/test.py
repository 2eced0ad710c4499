"""`faying test FILE...`: modes of a hammer test out of its FRFs."""

from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import click

from faying import units
from faying.cli.options import FILE, PATH, NamedPath, frequency_band
from faying.errors import InputError
from faying.file_kinds import taken
from faying.text import in_columns, json_text


@click.command()
@click.argument("files", nargs=-1, required=True, type=PATH)
@click.option(
    "--quantity",
    type=click.Choice(["receptance", "mobility", "accelerance"]),
    help="What was measured; needed where the file does not state it (text files never do).",
)
@click.option(
    "--frequency-step",
    metavar="TEXT",
    help='Spacing of the lines of text files that hold values alone, for example "1 Hz".',
)
@click.option(
    "--direction", type=click.Choice(["x", "y", "z"]), help="Direction of the test, where the file states none."
)
@click.option("--length-unit", help='Unit of the positions, where the file states none, for example "mm".')
@click.option("--points", type=PATH, help="CSV table of the positions: point,x [mm],y [mm],z [mm].")
@click.option("--band", metavar="LOW:HIGH", help='Lines to use, for example "20 Hz:800 Hz". Default: all above 0 Hz.')
@click.option(
    "--order", type=click.IntRange(2, 200), help="Highest order of the poles. Default: 80, or an eighth of the lines."
)
@click.option(
    "--stays",
    type=click.IntRange(1, 200),
    help="Orders over which a pole must stay to be a mode. Default: a fifth of them.",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON in SI units instead of a table.")
@click.option(
    "--plot", type=NamedPath(dir_okay=False), help="Write the stabilisation diagram and a fitted FRF (png, pdf, svg)."
)
@click.option("--out", type=FILE, help="Write modes and FRFs as a universal file.")
def command(
    files: tuple[Path, ...],
    band: str | None,
    order: int | None,
    stays: int | None,
    as_json: bool,
    plot: str | None,
    out: Path | None,
    **options: Any,
) -> None:
    """Identify the modes of a hammer test from the FRFs in FILES: one universal file, or text files of one FRF each."""
    from faying.measured.identify import identify_modes
    from faying.measured.poles import Rule
    from faying.measured.uff_write import write_uff

    limits = frequency_band(band) if band else None
    frf = read_frf(files, **options)
    low, high = limits or (0.0, float("inf"))
    lines = int(((frf.frequency > 0) & (frf.frequency >= low) & (frf.frequency <= high)).sum())
    rule = Rule.fitting(lines, highest_order=order, orders=stays)
    click.echo(f"{len(frf.measured)} FRFs, {lines} lines: poles up to order {rule.highest_order}", err=True)
    found = identify_modes(frf, band=limits, rule=rule)
    if plot:
        from faying.measured import figure
        from faying.style import save

        save(figure.identified(found), plot)
    if out:
        write_uff(out, found.modes, replace(frf, values=frf.values.conj()) if found.turned else frf)
    for line in found.frf.warnings:
        click.echo(f"note: {line}", err=True)
    click.echo(json_text(document(found)) if as_json else table(found))


def read_frf(
    files: tuple[Path, ...],
    quantity: str | None,
    frequency_step: str | None,
    direction: str | None,
    length_unit: str | None,
    points: Path | None,
) -> Any:
    """The FRFs of universal or text files, with the user's words where the files say nothing."""
    from faying.measured.mapping import read_points
    from faying.measured.text import read_frf_text
    from faying.measured.uff import read_uff

    if all("numbers" in taken(file, "test", "numbers").serves for file in files):
        if quantity is None:
            raise InputError(
                "text files do not state what was measured; give --quantity receptance, mobility or accelerance"
            )
        step = units.parse(frequency_step, "Hz", name="--frequency-step") if frequency_step else None
        frf = read_frf_text(files, quantity=quantity, frequency_step=step, direction=direction or "")
    elif len(files) > 1:
        raise InputError(
            "give one universal file, or text files (.txt, .csv) of one FRF each; several tests are several runs"
        )
    else:
        frf = read_uff(files[0], length_unit=length_unit).frf(quantity=quantity)
    if points:
        frf = replace(frf, positions=read_points(points))
    return frf.directed(direction) if direction else frf


def table(found: Any) -> str:
    """Format the modes for the terminal."""
    modes = found.modes
    rows = in_columns(
        ("mode", range(1, len(modes.frequencies) + 1), ""),
        ("frequency [Hz]", modes.frequencies, ".2f"),
        ("95 % interval", [f"{low:.3f} .. {high:.3f}" for low, high in modes.frequency_interval], ""),
        ("loss factor", modes.loss_factors, ".2e"),
        ("95 % interval", [f"{low:.1e} .. {high:.1e}" for low, high in modes.loss_interval], ""),
        ("orders", [f"{count} of {found.rule.highest_order}" for count in modes.found_in], ""),
    )
    widths = [max(len(row[c]) for row in rows) for c in range(len(rows[0]))]
    lines = ["  ".join(cell.rjust(w) for cell, w in zip(row, widths, strict=True)) for row in rows]
    lines += ["", f"the modes leave {found.misfit:.1%} of the FRFs (rms) unexplained"]
    notes: dict[str, list[str]] = {}
    for k, words in enumerate(modes.notes):
        for word in words:
            notes.setdefault(word, []).append(str(k + 1))
    return "\n".join(lines + [f"note: mode {', '.join(which)}: {word}" for word, which in notes.items()])


def document(found: Any) -> dict[str, Any]:
    """Everything that the command knows, as a tree for JSON; SI."""
    modes = found.modes
    return {
        "source": modes.source,
        "quantity": found.frf.quantity,
        "frequencies": modes.frequencies.tolist(),
        "frequency_interval": modes.frequency_interval.tolist(),
        "loss_factors": modes.loss_factors.tolist(),
        "loss_interval": modes.loss_interval.tolist(),
        "orders": modes.found_in.tolist(),
        "dofs": [str(d) for d in modes.dofs],
        "shapes": {"real": modes.shapes.real.tolist(), "imaginary": modes.shapes.imag.tolist()},
        "misfit": found.misfit,
        "rule": asdict(found.rule),
        "notes": [list(words) for words in modes.notes],
        "warnings": list(found.frf.warnings),
        "units": "SI: Hz; loss factors and shapes without unit; intervals of 95 %",
    }
