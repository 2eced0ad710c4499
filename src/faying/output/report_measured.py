"""The section of the report that sets a hammer test beside the model, and the files of `faying compare`."""

from html import escape
from pathlib import Path
from typing import Any

from faying import __version__
from faying.files import write_text
from faying.measured.compare import ModalComparison
from faying.output.figures.save import new_figure, save
from faying.output.page import BITMAPS, document, picture, table

CAPTIONS = {
    "mac": "MAC of the modes of the test against those of the model, at the points of the test. Pairs are framed.",
    "frf": "FRFs of the test and of the model, its full response or its elastic modes superposed, as the legend says.",
    "shapes": "Paired mode shapes: motion measured at the points of the test (left), the model's (right).",
}
MOST_FRFS = 4


def figures(comparison: ModalComparison) -> dict[str, Any]:
    """Return the figures of a comparison by name; FRFs only where there are some."""
    from faying.output.figures import measured

    t, m = comparison.mac.shape
    mac = new_figure(2.6 + 0.42 * m, 1.8 + 0.42 * t)
    measured.mac_map(mac.add_subplot(), comparison)
    out = {"mac": mac}
    if comparison.frf is not None:
        pairs = comparison.frf.measured[:MOST_FRFS]
        fig = new_figure(8.0, 2.9 * len(pairs))
        for k, (o, i) in enumerate(pairs):
            measured.frf_overlay(fig.add_subplot(len(pairs), 1, k + 1), comparison, o, i)
        out["frf"] = fig
    out["shapes"] = measured.shapes_side_by_side(comparison)
    return out


def section(comparison: ModalComparison, drawn: dict[str, Any] | None = None) -> str:
    """Return the section as HTML, its figures inside, to stand in any report."""
    points = comparison.point_map
    worst = max(points.distance.values())
    parts = [
        "<h2>Hammer test</h2>",
        f"<p>{escape(comparison.test.source)} beside {escape(comparison.model.title)} at "
        f"{comparison.model.load / 1e3:g} kN. {len(points.nodes)} points of the test found a node, the farthest "
        f"{worst * 1e3:.3g} mm away.</p>",
    ]
    parts += [f'<p class="flag">{escape(note)}</p>' for note in comparison.notes]
    parts += [
        table(comparison.rows()),
        "<p>Difference: model over test. Intervals of the test's loss factors: 95 %.</p>",
    ]
    for name, figure in (drawn or figures(comparison)).items():
        parts.append(f"<figure>{picture(name, figure)}<figcaption>{CAPTIONS[name]}</figcaption></figure>")
    return "".join(parts)


def write_parts(comparison: ModalComparison, drawn: dict[str, Any], folder: Path, prefix: str = "") -> list[Path]:
    """Write comparison.csv and the figures as SVG (shapes as PNG), their names after `prefix`."""
    made = [write_text(folder / "comparison.csv", comparison.csv_text())]
    for name, figure in drawn.items():
        made.append(save(figure, folder / f"{prefix}{name}.{'png' if name in BITMAPS else 'svg'}"))
    return made


def write(comparison: ModalComparison, folder: Path) -> list[Path]:
    """Write comparison.csv, the figures as SVG (shapes as PNG) and comparison.html into a folder that exists."""
    drawn = figures(comparison)
    made = write_parts(comparison, drawn, folder)
    title = escape(comparison.model.title)
    page = document("Hammer test", f"<h1>{title}</h1>{section(comparison, drawn)}<p>Faying {__version__}.</p>")
    made.append(write_text(folder / "comparison.html", page))
    return made
