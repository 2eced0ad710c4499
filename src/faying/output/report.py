"""One self-contained HTML file from a result: tables, figures, flags, sources."""

from html import escape
from pathlib import Path
from typing import Any

from faying import __version__
from faying.files import write_atomically
from faying.output import page, report_measured, table
from faying.output.page import STYLE
from faying.result import Result


def html(result: Result, drawn: dict[str, Any] | None = None) -> str:
    """Return the report as HTML text with its figures inside, those of `drawn` where they exist already."""
    parts = [
        f"<h1>{escape(result.title)}</h1>",
        f"<p>{result.unknowns:,} unknowns, factorised by {escape(result.solver)}; Faying {__version__}.</p>",
    ]
    if result.warnings:
        parts.append("<h2>Read this first</h2>")
        parts += [f'<p class="flag">{escape(line)}</p>' for line in result.warnings]
    parts += [
        "<h2>Modes</h2>",
        page.table(table.modes(result)),
        f"<p>Loss factors come from complex modes with {result.damping} loss in the joints. Free: faces apart. Tied: "
        f"faces grown together. Rigid-body values: up to {result.rigid.max():.1e} Hz.</p>",
    ]
    if result.comparison is not None:
        parts += [
            "<h2>Comparison with the test</h2>",
            page.table(table.comparison(result)),
            f"<p>{escape(result.comparison.source)}</p>",
        ]
    drawn = drawn or figures(result)
    if result.hammer is not None:
        of_test = {name.removeprefix(TEST): figure for name, figure in drawn.items() if name.startswith(TEST)}
        parts.append(report_measured.section(result.hammer, of_test))
    parts += ["<h2>Joints</h2>", page.table(table.joints(result))]
    if result.tightening:
        parts += [
            "<h2>Bolts</h2>",
            page.table(table.bolts(result)),
            f"<p>Tightened in the order {escape(', '.join(result.tightening))}.</p>",
        ]
    parts.append("<h2>Figures</h2>")
    for name, figure in drawn.items():
        if not name.startswith(TEST):
            parts.append(f"<figure>{page.picture(name, figure)}<figcaption>{CAPTIONS[name]}</figcaption></figure>")
    parts += _contact(result)
    parts += ["<h2>Sources</h2>", "<ul>", *(f"<li>{escape(line)}</li>" for line in result.sources), "</ul>"]
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{escape(result.title)}</title>'
    return f"<!doctype html><html lang='en'><head>{head}<style>{STYLE}</style></head><body>{''.join(parts)}</body></html>\n"


def _contact(result: Result) -> list[str]:
    """Surface and law; with several joints those of the first, which is what the result holds, and the names of all laws."""
    whose = f" of {escape(result.joints[0])}" if len(result.joints) > 1 else ""
    parts = [f"<h2>Surface{whose}</h2>", page.facts(result.surface)]
    parts += [f"<h2>Contact law{whose}</h2>", page.facts(result.law)]
    laws = [line.removeprefix(LAW) for line in result.sources if line.startswith(LAW)]
    if len(laws) > 1:
        parts.append(
            f"<p>The joints have several laws: {escape(', '.join(laws))}. Their parameters stand in the study.</p>"
        )
    return parts


LAW = "contact law "  # so begin the sources of laws
TEST = "test_"  # the figures of the hammer test begin with it
CAPTIONS = {
    "frequencies": "Frequency against preload, relative to the tied value of each mode.",
    "comparison": "Error against the test.",
    "pressure": "Pressure on each joint at the least and the greatest preload.",
    "modes": "Mode shapes at the greatest preload.",
    "mac": "MAC of the modes at the first preload (rows) with those at another: modes that change places or mix.",
    "response": "Accelerance at every preload: response over force, at the points and along the directions of the study.",
    "law": "Stiffness per area over the pressures that the joints reach at the greatest preload.",
}


def figures(result: Result) -> dict[str, Any]:
    """Return every figure of the report by name."""
    from matplotlib.figure import Figure

    from faying.output.figures import response, structure

    out: dict[str, Any] = {}

    def single(name: str, draw: Any, width: float = 7.0) -> None:
        fig = Figure(figsize=(width, 4.2), layout="constrained")
        draw(fig.add_subplot(), result)
        out[name] = fig

    single("frequencies", structure.frequencies)
    if result.comparison is not None:
        single("comparison", structure.comparison)
    loads = sorted({0, len(result.loads) - 1})
    fig = Figure(figsize=(5.2 * len(loads), 3.8 * len(result.joints)), layout="constrained")
    for row in range(len(result.joints)):
        for column, load in enumerate(loads):
            ax = fig.add_subplot(len(result.joints), len(loads), row * len(loads) + column + 1)
            structure.pressure_map(ax, result, load, row)
    out["pressure"] = fig
    out["law"] = structure.law_curves(result)
    out["modes"] = structure.mode_shapes(result)
    if len(result.loads) > 1:
        out["mac"] = response.macs(result)
    if result.response:
        out["response"] = response.responses(result)
    if result.hammer is not None:
        out |= {TEST + name: figure for name, figure in report_measured.figures(result.hammer).items()}
    return out


def write(result: Result, folder: Path) -> list[Path]:
    """Write result.nc, modes.csv, the figures as SVG (mode shapes as PNG) and report.html into a folder that exists.

    With a hammer test: comparison.csv, and its figures with test_ before their names.
    """
    made = [result.to_netcdf(folder / "result.nc"), result.to_csv(folder / "modes.csv")]
    drawn = figures(result)
    if result.hammer is not None:
        of_test = {name.removeprefix(TEST): figure for name, figure in drawn.items() if name.startswith(TEST)}
        made += report_measured.write_parts(result.hammer, of_test, folder, TEST)
    for name, figure in drawn.items():
        if name.startswith(TEST):
            continue
        made.append(page.save(figure, folder / f"{name}.{'png' if name == 'modes' else 'svg'}"))
    made.append(
        write_atomically(folder / "report.html", lambda path: path.write_text(html(result, drawn), encoding="utf-8"))
    )
    return made
