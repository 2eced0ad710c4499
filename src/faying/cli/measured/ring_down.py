"""`faying ring-down RECORD --band LOW:HIGH`: the measured backbone of a mode from a free decay."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import click

from faying import units
from faying.cli.options import FILE, PATH, frequency_band, quantity
from faying.errors import InputError
from faying.file_kinds import taken
from faying.text import json_text


@click.command()
@click.argument("record", type=PATH)
@click.option("--band", required=True, metavar="LOW:HIGH", help='Band around this mode, for example "150 Hz:180 Hz".')
@click.option("--start", metavar="TIME", help='Start of the free decay, for example "0.02 s", in the time of the file.')
@click.option("--impulse", metavar="TEXT", help='Impulse of the hit, if RECORD is an FRF, for example "0.3 N s".')
@click.option(
    "--function", type=click.IntRange(1, 10_000), help="Number of the FRF in a universal file, from 1 [the only one]."
)
@click.option(
    "--cycles", type=click.IntRange(3, 10_000), default=20, show_default=True, help="Least periods that give one point."
)
@click.option("--out", type=FILE, help="CSV file for faying backbone --measured.")
@click.option("--plot", type=FILE, help="Draw the points (svg, png, pdf).")
@click.option("--json", "as_json", is_flag=True, help="Print JSON in SI units instead of a table.")
def command(record: Path, **options: Any) -> None:
    """Frequency and damping of one mode against its amplitude, from the free decay in RECORD.

    RECORD is a CSV file with the columns time [s] and acceleration [m/s^2] (or velocity [m/s], displacement [m]), or a
    universal file with the FRF of a single hit. One to three exponentials in moving stretches give the points of the
    mode that is the largest at the start.
    """
    from faying.output.table import measured_backbone, text
    from faying.result import backbone as drawing
    from faying.style import check_figure, save

    if options["plot"]:
        check_figure(options["plot"])
    found = decay(record, options)
    if options["out"]:
        found.to_csv(options["out"])
    if options["plot"]:
        save(drawing.measured(found), options["plot"])
    if options["as_json"]:
        known = {"acceleration": "m/s2", "frequency": "Hz", "damping": "1", "time": "s"}
        known |= {"frequency_error": "Hz", "damping_error": "1"}
        click.echo(json_text({n: quantity(getattr(found, n).tolist(), u) for n, u in known.items()}))
        return
    click.echo(text(measured_backbone(found)))


def decay(record: Path, options: dict[str, Any]) -> Any:
    """The measured points of a record, or of the FRF of a hit."""
    from faying.measured.ring_down import read_record, ring_down, ring_down_of_frf
    from faying.measured.uff import read_uff

    band, cycles = frequency_band(options["band"]), options["cycles"]
    if "numbers" in taken(record, "test", "numbers").serves:
        if options["impulse"] is not None or options["function"] is not None:
            raise InputError("--impulse and --function are for the FRF of a universal file; a record in time has none")
        signal, rate, motion, begin = read_record(record)
        start = begin if options["start"] is None else units.parse(options["start"], "s", name="--start")
        found = ring_down(signal, rate, band=band, quantity=motion, cycles=cycles, start=start - begin)
        return replace(found, source=record.name, time=begin + found.time)
    file = read_uff(record)
    frf, pairs = file.frf(), file.pairs
    if options["impulse"] is None:
        raise InputError(f'{record}: an FRF does not give the strength of the hit; give --impulse "0.3 N s"')
    if options["start"] is not None:
        raise InputError("--start is for a record in time; an FRF begins with the hit, so leave --start out")
    number = (options["function"] or 1) - 1
    if (options["function"] is None and len(pairs) > 1) or number >= len(pairs):
        named = ", ".join(f"{k}: {output} by {by}" for k, (output, by) in enumerate(pairs, start=1))
        raise InputError(f"{record} has {len(pairs)} FRFs; give one of them with --function ({named})")
    if (first := pairs.index(pairs[number])) < number:
        raise InputError(
            f"{record}: FRF {number + 1} is of the points of FRF {first + 1}, which is the one that is read"
        )
    output, by = frf.outputs.index(pairs[number][0]), frf.inputs.index(pairs[number][1])
    impulse = units.parse(options["impulse"], "N*s", name="--impulse")
    found = ring_down_of_frf(frf, impulse=impulse, band=band, output=output, input=by, cycles=cycles)
    of_which = ", {} by {}".format(*pairs[number]) if len(pairs) > 1 else ""
    return replace(found, source=f"{record.name}{of_which}")
