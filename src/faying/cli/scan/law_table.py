"""`faying law --models`: several laws of one scan in one table and on one plot, with the factor between them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from faying.cli.options import quantity
from faying.cli.progress import Shown
from faying.files import write_text
from faying.output.terminal import folded
from faying.text import csv_text, json_text
from faying.units import show as unit

if TYPE_CHECKING:
    from faying.contact.compare import Comparison
    from faying.contact.mates import Mates
    from faying.contact.response import Response
    from faying.materials import ContactPair
    from faying.typing import Array

SURFACE_UNITS = {"G": "m", "scan_area": "m^2", "m0": "m^2", "m4": "1/m^2", "h_rms": "m", "shortest": "m"}


def show(
    mates: Mates,
    names: list[str] | None,
    pressures: Array,
    *,
    as_json: bool,
    conductance: bool,
    csv_file: str | None,
    plot: str | None,
) -> None:
    """Compare the laws and print, write and draw the outcome."""
    from faying.contact.compare import compare

    inputs = mates.faces.rough.inputs
    with watched(mates) as seen:
        made, left_out = seen.laws(names)
        comparison = compare(made, pressures, left_out)
    heat = conducted(comparison, mates.pair) if conductance else {}
    if csv_file:
        write_text(Path(csv_file), csv(comparison, heat))
    if plot:
        from faying.contact.figure import curves
        from faying.style import save

        save(curves(comparison.responses), plot)
    if as_json:
        tree = {"mates": mates.line} | document(inputs, comparison, heat)
        click.echo(json_text(tree))
        return
    click.echo(folded(f"mates: {mates.line}\n{table(inputs, comparison, heat)}"))


def conducted(comparison: Comparison, pair: ContactPair) -> dict[str, Array]:
    """Conductance of heat [W/(m2 K)] of every law with a stiffness, by name; InputError without conductivities."""
    from faying.contact.conductance import heat_conductance

    return {n: heat_conductance(r.k_n, pair) for n, r in comparison.responses.items() if r.k_n is not None}


@contextmanager
def watched(mates: Mates) -> Iterator[Mates]:
    """The mates, with a bar on the terminal that follows the contacts that are solved on their scan."""
    with Shown("law") as report:
        yield mates.watched(lambda done, total: report("contact of the scan", done, total))


def document(inputs: Any, comparison: Comparison, heat: dict[str, Array]) -> dict[str, Any]:
    """Everything that the command knows, as a tree for JSON; SI."""
    from faying.contact.response import UNITS
    from faying.result.fields import listed

    quantities = ("area", "k_n", "k_t")
    return {
        "surface": {name: quantity(value, SURFACE_UNITS.get(name, "")) for name, value in vars(inputs).items()},
        "pressure": quantity(comparison.pressure.tolist(), "Pa"),
        "laws": {
            name: {n: quantity(listed(v), UNITS[n]) for n, v in r.quantities().items()}
            | ({"h": quantity(listed(heat[name]), "W/(m^2*K)")} if name in heat else {})
            | {"valid": r.valid.tolist(), "reasons": {k: m.tolist() for k, m in r.reasons.items() if m.any()}}
            for name, r in comparison.responses.items()
        },
        "over half-space": {
            q: {name: listed(row) for name, row in comparison.ratios(q).items()} for q in ("area", "k_n")
        },
        "largest over smallest": {q: listed(comparison.spread(q)) for q in quantities},
        "left out": dict(comparison.left_out),
    }


def table(inputs: Any, comparison: Comparison, heat: dict[str, Array]) -> str:
    """Format area, k_n and h of every law at a few pressures, and the factor between the laws."""
    import numpy as np

    shown = np.unique(np.linspace(0, comparison.pressure.size - 1, min(7, comparison.pressure.size)).astype(int))
    lines = [
        f"D {inputs.D:.4g}, G {unit(inputs.G, 'm')}, rms height {unit(inputs.h_rms, 'm')}, rms gradient "
        f"{inputs.slope:.4g}, summits {inputs.summit_density * 1e-6:.4g} per mm2 of radius "
        f"{unit(inputs.summit_radius, 'm')} and deviation {unit(inputs.summit_deviation, 'm')}",
    ]
    for what, title, scale in (("area", "real area / nominal area", 1.0), ("k_n", "k_n [MPa/um]", 1e-12)):
        laws = {n: r for n, r in comparison.responses.items() if what in r.quantities()}
        lines += ["", title, _row("p [MPa]", comparison.pressure[shown] * 1e-6)]
        for name, response in laws.items():
            marks = ["" if valid else "*" for valid in response.valid[shown]]
            lines.append(_row(name, response.quantities()[what][shown] * scale, marks=marks))
        ratios = comparison.ratios(what)
        if ratios:
            unknown = np.full(comparison.pressure.shape, np.nan)
            lines.append("  times that of the half-space")
            lines += [_row(name, ratios.get(name, unknown)[shown], ".3g") for name in laws]
        lines.append(f"  {'max / min':<12}" + "".join(f"{value:>11.4g}" for value in comparison.spread(what)[shown]))
    if heat:
        lines += ["", "h [W/(m2 K)], clean metal in vacuum", *(_row(name, h[shown]) for name, h in heat.items())]
    lines += ["", "* outside the validity range of the model (`faying models`); - outside what it covers"]
    for name, response in comparison.responses.items():
        lines += [f"  {name}: {reason}" for reason in reasons(response)]
    without = [n for n, r in comparison.responses.items() if r.k_n is None]
    if without:
        lines.append(f"without a stiffness of their own: {', '.join(without)}")
    lines += [f"left out: {name}: {why}" for name, why in comparison.left_out.items()]
    return "\n".join(lines)


def _row(name: str, values: Array, form: str = ".4g", marks: Sequence[str] = ()) -> str:
    """A name with numbers, each with its mark; a dash where there is none."""
    cells = ["-" if value != value else format(value, form) for value in values]
    return f"  {name:<12}" + "".join(f"{cell + mark:>11}" for cell, mark in zip_longest(cells, marks, fillvalue=""))


def reasons(response: Response) -> Iterator[str]:
    """Return why a response leaves its validity range, with the pressures from and to; coverage shows as -."""
    for reason, mask in response.reasons.items():
        if mask.any() and not reason.startswith("pressure "):
            p = response.pressure[mask]
            yield f"{reason}, at {unit(float(p.min()), 'Pa')} to {unit(float(p.max()), 'Pa')}"


def csv(comparison: Comparison, heat: dict[str, Array]) -> str:
    """Return one row per law and pressure, SI, with units in the head."""
    from faying.contact.response import UNITS

    names = ("area", "k_n", "k_t", "loss_n", "loss_t", *(("h",) if heat else ()))
    units = UNITS | {"h": "W/(m^2*K)"}
    rows: list[list[str]] = [["law", "pressure [Pa]", *(f"{n} [{units[n] or '-'}]" for n in names), "valid"]]
    for law, r in comparison.responses.items():
        columns = r.quantities() | ({"h": heat[law]} if law in heat else {})
        for i, p in enumerate(comparison.pressure.tolist()):
            cells = [repr(float(columns[n][i])) if n in columns else "" for n in names]
            rows.append([law, repr(p), *cells, str(bool(r.valid[i])).lower()])
    return csv_text(rows)
