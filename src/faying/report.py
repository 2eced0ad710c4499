"""One self-contained HTML file from a result: tables, figures, flags, sources."""

from html import escape
from io import BytesIO, StringIO
from pathlib import Path
from typing import Any

from faying import __version__, table
from faying.files import whole
from faying.result import Result

STYLE = """
body{font:15px/1.5 system-ui,sans-serif;max-width:66rem;margin:2rem auto;padding:0 1rem;color:#1c2733}
h1{font-size:1.5rem}h2{font-size:1.15rem;margin-top:2.2rem;border-bottom:1px solid #d5dde5;padding-bottom:.2rem}
table{border-collapse:collapse;font-size:.84rem;font-variant-numeric:tabular-nums;margin:.6rem 0}
th,td{padding:.18rem .7rem;text-align:right;border-bottom:1px solid #e6ebf0}th{background:#f3f6f9}
td:first-child,th:first-child,.words td{text-align:left}.scroll{overflow-x:auto}
.flag{background:#fff4e0;border-left:4px solid #e0912f;padding:.4rem .8rem;margin:.4rem 0}
figure{margin:1rem 0}figure svg,figure img{max-width:100%;height:auto}figcaption{font-size:.85rem;color:#52616f}
"""


def html(result: Result, drawn: dict[str, Any] | None = None) -> str:
    """Return the report as HTML text with its figures inside, those of `drawn` where they exist already."""
    parts = [f"<h1>{escape(result.title)}</h1>",
             f"<p>{result.unknowns:,} unknowns, factorised by {escape(result.solver)}; Faying {__version__}.</p>"]  # fmt: skip
    if result.warnings:
        parts.append("<h2>Read this first</h2>")
        parts += [f'<p class="flag">{escape(line)}</p>' for line in result.warnings]
    parts += ["<h2>Modes</h2>", _table(table.modes(result)),
              "<p>Loss factors come from complex modes with hysteretic loss in the joints. Free: faces apart. Tied: faces "
              f"grown together. Rigid-body values: up to {result.rigid.max():.1e} Hz.</p>"]  # fmt: skip
    if result.comparison is not None:
        parts += [
            "<h2>Comparison with the test</h2>",
            _table(table.comparison(result)),
            f"<p>{escape(result.comparison.source)}</p>",
        ]
    parts += ["<h2>Joints</h2>", _table(table.joints(result))]
    for name, figure in (drawn or figures(result)).items():
        parts.append(f"<figure>{_picture(name, figure)}<figcaption>{CAPTIONS[name]}</figcaption></figure>")
    parts += ["<h2>Surface</h2>", _facts(result.surface), "<h2>Contact law</h2>", _facts(result.law)]
    parts += ["<h2>Sources</h2>", "<ul>", *(f"<li>{escape(line)}</li>" for line in result.sources), "</ul>"]
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{escape(result.title)}</title>'
    return f"<!doctype html><html lang='en'><head>{head}<style>{STYLE}</style></head><body>{''.join(parts)}</body></html>\n"


CAPTIONS = {
    "frequencies": "Frequency against preload, relative to the tied value of each mode.",
    "comparison": "Error against the test.",
    "pressure": "Pressure on each joint at the least and the greatest preload.",
    "modes": "Mode shapes at the greatest preload.",
    "law": "Stiffness per area over the pressures that the joints reach at the greatest preload.",
}


def figures(result: Result) -> dict[str, Any]:
    """Return every figure of the report by name."""
    from matplotlib.figure import Figure

    from faying.plot import structure

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
    return out


def write(result: Result, folder: Path) -> list[Path]:
    """Write result.nc, modes.csv, the figures as SVG (mode shapes as PNG) and report.html into a folder that exists."""
    made = [result.to_netcdf(folder / "result.nc"), result.to_csv(folder / "modes.csv")]
    drawn = figures(result)
    for name, figure in drawn.items():
        kind = "png" if name == "modes" else "svg"
        made.append(whole(folder / f"{name}.{kind}", lambda path, f=figure, k=kind: f.savefig(path, format=k, dpi=150)))  # type: ignore[misc]
    made.append(whole(folder / "report.html", lambda path: path.write_text(html(result, drawn), encoding="utf-8")))
    return made


def _picture(name: str, figure: Any) -> str:
    if name in ("modes", "pressure"):  # tens of thousands of polygons: a bitmap is smaller than their outlines
        from base64 import b64encode

        buffer = BytesIO()
        figure.savefig(buffer, format="png", dpi=130)
        return f'<img alt="{name}" src="data:image/png;base64,{b64encode(buffer.getvalue()).decode()}">'
    text = StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None})
    svg = text.getvalue()
    return svg[svg.index("<svg") :]


def _table(rows: table.Rows) -> str:
    head = "".join(f"<th>{escape(cell)}</th>" for cell in rows[0])
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows[1:])
    return f'<div class="scroll"><table><tr>{head}</tr>{body}</table></div>'


def _facts(facts: dict[str, Any]) -> str:
    def show(value: Any) -> str:
        if isinstance(value, list | tuple):
            return " to ".join(show(v) for v in value)
        return f"{value:.4g}" if isinstance(value, float) else str(value)

    rows = "".join(f"<tr><td>{escape(k)}</td><td>{escape(show(v))}</td></tr>" for k, v in facts.items())
    return f'<table class="words">{rows}</table>'
