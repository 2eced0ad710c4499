"""`faying surface FILE`: roughness, D and G of a scan, on the terminal, as JSON, and as a figure."""

from dataclasses import asdict, replace
from typing import Any

import click

from faying.cli.options import NamedPath
from faying.errors import InputError
from faying.output.terminal import folded, indented
from faying.surface.estimators.table import METHODS
from faying.text import finite, json_text
from faying.units import lengths, show


@click.command()
@click.argument("file", type=NamedPath())
@click.option("--xy-unit", help='Unit of x and y where the file states none, for example "mm".')
@click.option("--z-unit", help='Unit of the heights where the file states none, for example "um".')
@click.option("--method", type=click.Choice([*METHODS, "all"]), default="psd", show_default=True, help="Estimator.")
@click.option(
    "--degree", type=click.IntRange(0, 8), default=1, show_default=True, help="Form removed: polynomial degree."
)
@click.option("--keep-spikes", is_flag=True, help="Leave single outlying points in.")
@click.option("--size", metavar="LENGTHS", help='Size of a scan whose file states none, for example "4 mm x 3 mm".')
@click.option("--spacing", metavar="LENGTHS", help='Distance of its points, in place of --size, for example "5 um".')
@click.option("--channel", help="Name of the map of heights, where the file holds several.")
@click.option("--iso", is_flag=True, help="All areal parameters of ISO 25178-2 that Faying has.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON in SI units instead of a table.")
@click.option("--plot", type=NamedPath(dir_okay=False), help="Write a figure (png, pdf, svg).")
def command(
    file: str,
    size: str | None,
    spacing: str | None,
    method: str,
    degree: int,
    keep_spikes: bool,
    iso: bool,
    as_json: bool,
    plot: str | None,
    **given: str | None,
) -> None:
    """Roughness, fractal dimension D and fractal roughness G of the scan in FILE."""
    from faying.surface.areal import ArealParameters
    from faying.surface.files.read import read_scan
    from faying.surface.form import prepared
    from faying.surface.fractal import fit_all
    from faying.surface.roughness import roughness

    sides = {"size": size, "spacing": spacing}
    sizes: dict[str, Any] = {name: lengths(text, name=f"--{name}") for name, text in sides.items() if text}
    scan = read_scan(file, **given, **sizes)
    if iso and scan.heights.ndim == 1:
        raise InputError("--iso is for scans; the parameters of a profile (ISO 21920-2) stand without it")
    ready = prepared(scan, degree=degree, spikes=not keep_spikes)
    methods = tuple(METHODS) if method == "all" else (method,)
    fits = fit_all(scan, methods=methods, degree=degree, spikes=not keep_spikes)
    document = describe(scan, ready, roughness(ready), fits)
    if iso:
        areal = ArealParameters.of(ready)
        document["areal"] = dict(finite(asdict(areal)))
    if plot:
        from faying.surface.figure import overview

        overview(scan, ready, fits, plot)
    click.echo(json_text(document) if as_json else table(document))
    if iso and not as_json:
        click.echo(f"\n{folded(str(areal))}")


def describe(scan: Any, ready: Any, rough: Any, fits: Any) -> dict[str, Any]:
    """Everything that the command knows, as a tree for JSON (SI units; None for what is not finite)."""
    shape = list(scan.heights.shape)
    areal = len(shape) == 2
    out = {
        "file": scan.source,
        "points": shape,
        "spacing": list(scan.spacing) if areal else [scan.spacing],
        "size": list(scan.size) if areal else [scan.length],
        "instrument": asdict(scan.instrument),
        "missing": ready.missing,
        "spikes": ready.spikes,
        "roughness": {name: value for name, value in asdict(rough).items() if name != "areal"},
        "fits": {n: {"error": f} if isinstance(f, str) else _fit(f) for n, f in fits.items()},
        "units": "SI: lengths in metres",
    }
    return dict(finite(out))


def _fit(fit: Any) -> dict[str, Any]:
    """A fit as a tree, without the heights that it was made from."""
    return {name: value for name, value in asdict(replace(fit, drawn=None)).items() if name != "drawn"}


def table(document: dict[str, Any]) -> str:
    """Format the document for the terminal."""
    from faying.output import table as tables

    def m(value: float | None) -> str:
        return "-" if value is None else show(value, "m")

    points, size = document["points"], document["size"]
    areal = len(points) == 2
    shown = f"{' x '.join(map(str, points[::-1]))} points, {' x '.join(map(m, size))}"
    step = " x ".join(m(s) for s in document["spacing"])
    rough = document["roughness"]
    q, a, z, slope = ("Sq", "Sa", "Sz", "Sdq") if areal else ("Rq", "Ra", "Rz", "Rdq")
    lines = [
        document["file"],
        f"  {shown}, spacing {step}",
        f"  missing {document['missing']}, spikes {document['spikes']}",
        f"  {q} {m(rough['Rq'])}, {a} {m(rough['Ra'])}, {z} {m(rough['Rz'])}, {slope} {rough['Rdq']:.4g}, "
        f"skewness {rough['skewness']:.3g}, kurtosis {rough['kurtosis']:.3g}",
        "",
    ]
    words: list[str] = []
    rows = [["method", *tables.FRACTAL[:-1], f"implied {q}"]]
    for name, fit in document["fits"].items():
        if "error" in fit:
            words.append(f"  {name}: no D and G: {fit['error']}")
            continue
        rows.append([name, *tables.fractal(fit)])
        words += [f"  {name}: {word}" for word in fit["warnings"]]
    convention = next((f["convention"] for f in document["fits"].values() if "error" not in f), "")
    if convention:
        lines += [*indented(rows), "", f"  {convention}"]
    lines += words
    return folded("\n".join(lines))
