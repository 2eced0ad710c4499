"""The section of the report that sets a hammer test against the model, and the files of `faying compare`."""

from html import escape
from pathlib import Path
from typing import Any

from faying import __version__
from faying.files import write_text
from faying.measured.compare import ModalComparison
from faying.output.page import BITMAPS, curves, document, saved, table
from faying.output.scene.text import packed_curves
from faying.style import COLUMN, WIDE, drawing, new_figure
from faying.units import load_text

CAPTIONS = {
    "mac": "MAC of the modes of the test against those of the model, at the points of the test. Pairs are framed.",
    "frf": "FRFs of the test and of the model, its full response or its elastic modes superposed, as the legend says.",
    "shapes": "Paired mode shapes: motion measured at the points of the test (left), the model's (right).",
}
MAX_FRFS = 4


@drawing
def figures(comparison: ModalComparison) -> dict[str, Any]:
    """Return the figures of a comparison by name; FRFs only where there are some."""
    from faying.measured import figure as measured

    t, m = comparison.mac.shape
    mac = new_figure(WIDE if m > 8 else COLUMN, 1.5 + min(max(0.3 * t, 1.0), 4.0))
    measured.mac_map(mac.add_subplot(), comparison)
    out = {"mac": mac}
    if comparison.frf is not None:
        pairs = comparison.frf.measured[:MAX_FRFS]
        fig = new_figure(WIDE, 2.3 * len(pairs))
        for k, (o, i) in enumerate(pairs):
            measured.frf_overlay(fig.add_subplot(len(pairs), 1, k + 1), comparison, o, i)
        out["frf"] = fig
    out["shapes"] = measured.shapes_side_by_side(comparison)
    return out


def section(comparison: ModalComparison, pictures: dict[str, str], *, moving: bool = False) -> str:
    """Return the section as HTML, its figures (by name, as HTML) inside, to stand in any report.

    moving: whether the page runs the script that draws curves; they stand in place of the figure of the FRFs then.
    """
    points = comparison.point_map
    worst = max(points.distance.values())
    parts = [
        "<h2>Hammer test</h2>",
        f"<p>{escape(comparison.test.source)} against {escape(comparison.model.title)} at "
        f"{load_text(comparison.model.load)}. {len(points.nodes)} points of the test found a node, the farthest "
        f"{worst * 1e3:.3g} mm away.</p>",
    ]
    parts += [f'<p class="flag">{escape(note)}</p>' for note in comparison.notes]
    parts += [
        table(comparison.rows()),
        "<p>Difference: model over test. Intervals of the test's loss factors: 95 %.</p>",
    ]
    for name, picture in pictures.items():
        live = moving and name == "frf" and comparison.frf is not None
        parts += [f"<h3>Test and model</h3>{curves('test-frf', _curves(comparison))}"] if live else []
        kind = ' class="of-test-frf"' if live else ""
        parts.append(f"<figure{kind}>{picture}<figcaption>{CAPTIONS[name]}</figcaption></figure>")
    return "".join(parts)


def _curves(comparison: ModalComparison) -> list[dict[str, Any]]:
    """The FRFs that the figure shows, for curves in a page."""
    frf, model = comparison.frf, comparison.predicted
    if frf is None or model is None or comparison.frac is None:
        return []
    return [
        packed_curves(
            f"{frf.outputs[o]} / {frf.inputs[i]}, FRAC {comparison.frac[o, i]:.2f}",
            f"|{frf.quantity}| [{frf.unit}]",
            frf.frequency,
            {"test": frf.values[o, i], "model": model[o, i]},
        )
        for o, i in frf.measured[:MAX_FRFS]
    ]


def write(comparison: ModalComparison, folder: Path) -> list[Path]:
    """Write comparison.csv, the figures as SVG (shapes as PNG) and comparison.html into a folder that exists."""
    made = [write_text(folder / "comparison.csv", comparison.csv_text())]
    pictures = {}
    for name, figure in figures(comparison).items():
        file, pictures[name] = saved(name, figure, folder / f"{name}.{'png' if name in BITMAPS else 'svg'}")
        made.append(file)
    title = escape(comparison.model.title)
    page = document("Hammer test", f"<h1>{title}</h1>{section(comparison, pictures)}<p>Faying {__version__}.</p>")
    made.append(write_text(folder / "comparison.html", page))
    return made
