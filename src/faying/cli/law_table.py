"""`faying law --models`: several laws of one scan in one table and on one plot, with the factor between them."""

import json
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import click

from faying.cli.options import quantity

SURFACE_UNITS = {"G": "m", "scan_area": "m^2", "m0": "m^2", "m4": "1/m^2", "h_rms": "m", "shortest": "m"}


def show(
    surface: Any,
    pair: Any,
    names: list[str] | None,
    pressures: Any,
    as_json: bool,
    csv_file: str | None,
    plot: str | None,
    contact_map: str | None = None,
) -> None:
    """Compare the laws and print, write and draw the outcome."""
    from faying.contact.compare import compare, laws_of_surface
    from faying.files import write_atomically

    inputs = surface.inputs
    made, left_out = laws_of_surface(surface, pair, names=names)
    if contact_map:
        draw_contact(made, float(pressures[-1]), contact_map)
    with progress_bar(made) as made:
        comparison = compare(made, pressures, left_out)
    if csv_file:
        write_atomically(Path(csv_file), lambda path: path.write_text(csv(comparison)))
    if plot:
        from faying.output.figures.law import curves
        from faying.output.figures.save import save

        save(curves(comparison.responses), plot)
    click.echo(
        json.dumps(document(inputs, comparison), indent=2, allow_nan=False) if as_json else table(inputs, comparison)
    )


def draw_contact(laws: dict[str, Any], pressure: float, path: str) -> None:
    """Write the picture of where the scan touches at a pressure [Pa]; InputError unless one is solved on the scan."""
    from faying.contact.half_space import HalfSpace
    from faying.errors import InputError
    from faying.output.figures.contact_map import contact_figure
    from faying.output.figures.save import save

    solved = [law for law in laws.values() if isinstance(law, HalfSpace)]
    if not solved:
        raise InputError("--contact-map shows the numerical contact: put halfspace among --models")
    save(contact_figure(solved[0].contact_at(pressure)), path)


@contextmanager
def progress_bar(laws: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """The laws, those that are solved on the scan with a bar on the terminal that follows their loads."""
    from faying.contact.half_space import HalfSpace

    slow = [name for name, law in laws.items() if isinstance(law, HalfSpace)]
    if not slow:
        yield laws
        return
    loads = sum(laws[name].points for name in slow)
    with click.progressbar(length=loads, label="contact of the scan", file=sys.stderr) as bar:
        yield {n: law.with_(progress=lambda *_: bar.update(1)) if n in slow else law for n, law in laws.items()}


def clean(values: Any) -> list[float | None]:
    """Return a row for JSON, None in place of NaN."""
    return [float(v) if v == v else None for v in values]


def document(inputs: Any, comparison: Any) -> dict[str, Any]:
    """Everything that the command knows, as a tree for JSON; SI."""
    from faying.contact.response import UNITS

    quantities = ("area", "k_n", "k_t")
    return {
        "surface": {name: quantity(value, SURFACE_UNITS.get(name, "")) for name, value in vars(inputs).items()},
        "pressure": quantity(comparison.pressure.tolist(), "Pa"),
        "laws": {
            name: {n: quantity(clean(v), UNITS[n]) for n, v in r.quantities().items()}
            | {"valid": r.valid.tolist(), "reasons": {k: m.tolist() for k, m in r.reasons.items() if m.any()}}
            for name, r in comparison.responses.items()
        },
        "largest over smallest": {q: clean(comparison.spread(q)) for q in quantities},
        "left out": dict(comparison.left_out),
    }


def table(inputs: Any, comparison: Any) -> str:
    """Format area and k_n of every law at a few pressures, and the factor between the laws."""
    import numpy as np

    from faying.units import show as unit

    shown = np.unique(np.linspace(0, comparison.pressure.size - 1, min(7, comparison.pressure.size)).astype(int))
    lines = [
        f"D {inputs.D:.4g}, G {unit(inputs.G, 'm')}, rms height {unit(inputs.h_rms, 'm')}, rms gradient "
        f"{inputs.slope:.4g}, summits {inputs.summit_density * 1e-6:.4g} per mm2 of radius "
        f"{unit(inputs.summit_radius, 'm')} and deviation {unit(inputs.summit_deviation, 'm')}",
    ]
    for what, title, scale in (("area", "real area / nominal area", 1.0), ("k_n", "k_n [MPa/um]", 1e-12)):
        laws = {n: r for n, r in comparison.responses.items() if what in r.quantities()}
        lines += ["", title, f"  {'p [MPa]':<12}" + "".join(f"{comparison.pressure[i] * 1e-6:>11.4g}" for i in shown)]
        for name, response in laws.items():
            cells = []
            for i in shown:
                value = response.quantities()[what][i] * scale
                text = "-" if np.isnan(value) else f"{value:.4g}"
                cells.append(f"{text + ('' if response.valid[i] else '*'):>11}")
            lines.append(f"  {name:<12}" + "".join(cells))
        spread = comparison.spread(what)
        lines.append(f"  {'max / min':<12}" + "".join(f"{spread[i]:>11.4g}" for i in shown))
    lines += ["", "* outside the validity range of the model (`faying models`); - outside what it covers"]
    for name, response in comparison.responses.items():
        lines += [f"  {name}: {reason}" for reason in reasons(response)]
    without = [n for n, r in comparison.responses.items() if r.k_n is None]
    if without:
        lines.append(f"without a stiffness of their own: {', '.join(without)}")
    lines += [f"left out: {name}: {why}" for name, why in comparison.left_out.items()]
    return "\n".join(lines)


def reasons(response: Any) -> list[str]:
    """Return why a response leaves its validity range, with the pressures from and to; coverage shows as -."""
    from faying.units import show as unit

    lines = []
    for reason, mask in response.reasons.items():
        if mask.any() and not reason.startswith("pressure "):
            p = response.pressure[mask]
            lines.append(f"{reason}, at {unit(float(p.min()), 'Pa')} to {unit(float(p.max()), 'Pa')}")
    return lines


def csv(comparison: Any) -> str:
    """Return one row per law and pressure, SI, with units in the head."""
    names = ("area", "k_n", "k_t", "loss_n", "loss_t")
    from faying.contact.response import UNITS

    rows = ["law,pressure [Pa]," + ",".join(f"{n} [{UNITS[n] or '-'}]" for n in names) + ",valid"]
    for law, r in comparison.responses.items():
        for i, p in enumerate(comparison.pressure.tolist()):
            cells = [repr(float(r.quantities()[n][i])) if n in r.quantities() else "" for n in names]
            rows.append(",".join([law, repr(p), *cells, str(bool(r.valid[i])).lower()]))
    return "\n".join(rows) + "\n"
