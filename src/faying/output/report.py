"""One self-contained HTML file from a result: tables, figures, flags, sources."""

from collections.abc import Callable
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

from faying import __version__
from faying.files import write_text
from faying.output import page, report_measured
from faying.output.figures import response, structure
from faying.output.figures.save import new_figure
from faying.output.sections import sections
from faying.result import Result


def html(result: Result, pictures: dict[str, str] | None = None) -> str:
    """Return the report as HTML text with its figures inside; pictures: those that are drawn already, as HTML."""
    parts = [
        f"<h1>{escape(result.title)}</h1>",
        f"<p>{result.unknowns:,} unknowns, factorised by {escape(result.solver)}; Faying {__version__}.</p>",
    ]
    if result.warnings:
        parts.append("<h2>Read this first</h2>")
        parts += [f'<p class="flag">{escape(line)}</p>' for line in result.warnings]
    if pictures is None:
        pictures = {name: page.picture(name.removeprefix(TEST), figure) for name, figure in figures(result).items()}
    for section in sections(result):
        if section.name == "hammer" and result.hammer is not None:
            of_test = {name.removeprefix(TEST): text for name, text in pictures.items() if name.startswith(TEST)}
            parts.append(report_measured.section(result.hammer, of_test))
        else:
            parts += [f"<h2>{escape(section.title)}</h2>", page.table(section.rows)]
            parts += [f"<p>{escape(section.below)}</p>"] if section.below else []
    parts.append("<h2>Figures</h2>")
    for name, picture in pictures.items():
        if not name.startswith(TEST):
            parts.append(f"<figure>{picture}<figcaption>{FIGURES[name].caption}</figcaption></figure>")
    parts += _contact(result)
    parts += ["<h2>Sources</h2>", "<ul>", *(f"<li>{escape(line)}</li>" for line in result.sources), "</ul>"]
    return page.document(result.title, "".join(parts))


def _contact(result: Result) -> list[str]:
    """Surface and law of every joint; joints that share both have one section."""
    shared: dict[str, list[str]] = {}
    for name, surface, law in zip(result.joints, result.surfaces, result.laws, strict=True):
        text = f"<h3>Surface</h3>{page.facts(surface)}<h3>Contact law</h3>{page.facts(law)}"
        shared.setdefault(text, []).append(name)
    return [f"<h2>Contact of {escape(', '.join(names))}</h2>{text}" for text, names in shared.items()]


TEST = "test_"  # the figures of the hammer test begin with it
BITMAP_FILES = ("modes", "shapes")  # figures whose files are bitmaps, too


@dataclass(frozen=True, kw_only=True)
class ReportFigure:
    """A figure of the report: what draws it, its caption, and which results have it."""

    draw: Callable[[Result], Any]
    caption: str
    applies: Callable[[Result], bool] = lambda result: True


def _on_axes(draw: Callable[[Any, Result], Any]) -> Callable[[Result], Any]:
    def drawn(result: Result) -> Any:
        fig = new_figure(7.0, 4.2)
        draw(fig.add_subplot(), result)
        return fig

    return drawn


FIGURES = {
    "frequencies": ReportFigure(
        draw=_on_axes(structure.frequencies),
        caption="Frequency against preload, relative to the bonded value of each mode.",
    ),
    "comparison": ReportFigure(
        draw=_on_axes(structure.comparison),
        caption="Error against the test.",
        applies=lambda result: result.comparison is not None,
    ),
    "pressure": ReportFigure(
        draw=structure.pressures, caption="Pressure on each joint at the least and the greatest preload."
    ),
    "law": ReportFigure(
        draw=structure.law_curves,
        caption="Stiffness per area over the pressures that the joints reach at the greatest preload.",
    ),
    "modes": ReportFigure(draw=structure.mode_shapes, caption="Mode shapes at the greatest preload."),
    "mac": ReportFigure(
        draw=response.macs,
        caption="MAC of the modes at the first preload (rows) with those at another: modes that change places or mix.",
        applies=lambda result: len(result.loads) > 1,
    ),
    "response": ReportFigure(
        draw=response.responses,
        caption="Accelerance at every preload, at the points and along the directions of the study.",
        applies=lambda result: result.response is not None,
    ),
}


def figures(result: Result) -> dict[str, Any]:
    """Return every figure of the report by name."""
    out = {name: figure.draw(result) for name, figure in FIGURES.items() if figure.applies(result)}
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
        made.append(write_text(folder / "comparison.csv", result.hammer.csv_text()))
    pictures = {}
    for name, figure in drawn.items():
        kind = name.removeprefix(TEST)
        file, pictures[name] = page.saved(kind, figure, folder / f"{name}.{'png' if kind in BITMAP_FILES else 'svg'}")
        made.append(file)
    made.append(write_text(folder / "report.html", html(result, pictures)))
    return made
