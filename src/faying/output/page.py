"""What pages are made of: style, tables, pictures as text of HTML."""

from html import escape
from io import BytesIO, StringIO
from pathlib import Path
from typing import Any

from faying.files import write_text
from faying.output.figures.save import RESOLUTION, save
from faying.output.table import Rows

STYLE = """
body{font:15px/1.5 system-ui,sans-serif;max-width:66rem;margin:2rem auto;padding:0 1rem;color:#1c2733}
h1{font-size:1.5rem}h2{font-size:1.15rem;margin-top:2.2rem;border-bottom:1px solid #d5dde5;padding-bottom:.2rem}
table{border-collapse:collapse;font-size:.84rem;font-variant-numeric:tabular-nums;margin:.6rem 0}
th,td{padding:.18rem .7rem;text-align:right;border-bottom:1px solid #e6ebf0}th{background:#f3f6f9}
td:first-child,th:first-child,.words td{text-align:left}.scroll{overflow-x:auto}
.flag{background:#fff4e0;border-left:4px solid #e0912f;padding:.4rem .8rem;margin:.4rem 0}
figure{margin:1rem 0}figure svg,figure img{max-width:100%;height:auto}figcaption{font-size:.85rem;color:#52616f}
"""
BITMAPS = ("modes", "pressure", "shapes")  # tens of thousands of polygons: a bitmap is smaller than their outlines


def picture(name: str, figure: Any) -> str:
    """Return a figure as SVG, or as a bitmap where its name is one of BITMAPS."""
    if name in BITMAPS:
        from base64 import b64encode

        buffer = BytesIO()
        figure.savefig(buffer, format="png", dpi=130)
        return f'<img alt="{name}" src="data:image/png;base64,{b64encode(buffer.getvalue()).decode()}">'
    return _inline(_svg(figure))


def saved(name: str, figure: Any, file: Path) -> tuple[Path, str]:
    """Write a figure into a file and return it with the text that a page shows; what both have is drawn once."""
    if name in BITMAPS:
        save(figure, file)
        figure.set_layout_engine("none")  # it has found its layout
        return file, picture(name, figure)
    svg = _svg(figure)
    return write_text(file, svg), _inline(svg)


def _svg(figure: Any) -> str:
    text = StringIO()
    figure.savefig(text, format="svg", dpi=RESOLUTION, metadata={"Date": None})
    return text.getvalue()


def _inline(svg: str) -> str:
    """An SVG file as it stands in a page."""
    return svg[svg.index("<svg") :]


def table(rows: Rows) -> str:
    """Return rows as a table, the first as its heading."""
    head = "".join(f"<th>{escape(cell)}</th>" for cell in rows[0])
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows[1:])
    return f'<div class="scroll"><table><tr>{head}</tr>{body}</table></div>'


def facts(known: dict[str, Any]) -> str:
    """Return names and values as a table of two columns."""

    def show(value: Any) -> str:
        if isinstance(value, list | tuple):
            return " to ".join(show(v) for v in value)
        return f"{value:.4g}" if isinstance(value, float) else str(value)

    rows = "".join(f"<tr><td>{escape(k)}</td><td>{escape(show(v))}</td></tr>" for k, v in known.items())
    return f'<table class="words">{rows}</table>'


def document(title: str, body: str) -> str:
    """Return a whole page."""
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{escape(title)}</title>'
    return f"<!doctype html><html lang='en'><head>{head}<style>{STYLE}</style></head><body>{body}</body></html>\n"
