"""What pages are made of: style, tables, pictures as text of HTML."""

import json
from base64 import b64encode
from html import escape
from pathlib import Path
from typing import Any

from faying.files import write_atomically
from faying.output.scene import pages
from faying.output.table import Rows
from faying.style import drawn

STYLE = """
:root{--ink:#1c2733;--soft:#52616f;--line:#d5dde5;--head:#f3f6f9;--back:#fff;--flag:#fff4e0;--accent:#0a63b0}
body{font:15px/1.5 system-ui,sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem;color:var(--ink)}
body,html{background:var(--back)}h1,h2,h3,li,summary{overflow-wrap:anywhere}td,th{overflow-wrap:break-word}
h1{font-size:1.5rem}h2{font-size:1.15rem;margin-top:2.2rem;border-bottom:1px solid var(--line);padding-bottom:.2rem}
h3{font-size:1rem;margin:1.2rem 0 .3rem}
table{border-collapse:collapse;font-size:.84rem;font-variant-numeric:tabular-nums;margin:.6rem 0}
th,td{padding:.18rem .7rem;text-align:right;border-bottom:1px solid var(--line)}th{background:var(--head)}
td:first-child,th:first-child,.words td{text-align:left}.scroll{overflow-x:auto}
[data-table=joints] :is(td,th):nth-child(2),[data-table=bolting] :is(td,th):nth-child(2){text-align:left}
.flag{background:var(--flag);border-left:4px solid #e0912f;padding:.4rem .8rem;margin:.4rem 0}
figure{margin:1rem 0}figure svg,figure img{max-width:100%;height:auto;background:#fff}
figcaption,.soft{font-size:.85rem;color:var(--soft)}
pre{font:13px/1.45 ui-monospace,monospace;overflow-x:auto;background:var(--head);padding:.7rem .9rem}
summary{cursor:pointer;font-weight:600;margin:.6rem 0}code{font-size:.92em;overflow-wrap:anywhere}
#stage{height:min(45rem,94vh);min-height:30rem;
border:1px solid var(--line);border-radius:6px;overflow:hidden;display:none}
.live #stage{display:block}
.live .static,.has-response .of-response,.has-backbones .of-backbones,
.has-test-frf .of-test-frf{display:none}
button.link{font:inherit;color:var(--accent);background:none;border:0;padding:0;cursor:pointer;text-align:inherit;
text-decoration:underline;text-decoration-color:transparent;font-variant-numeric:inherit}
button.link:is(:hover,:focus-visible){text-decoration-color:currentcolor}
tr.now td{background:color-mix(in srgb,var(--accent) 12%,var(--back))}
@media (max-width:760px){#stage{height:auto}}
@media (prefers-color-scheme:dark){:root{--ink:#e3e8ee;--soft:#a3afbb;--line:#38424d;--head:#1a2027;--back:#14181d;
--flag:#33291a;--accent:#63b0f0;color-scheme:dark}figure svg,figure img{border-radius:6px}}
@media print{body{max-width:none;margin:0}#stage,.live #stage,[data-curves],#why{display:none}
.live .static,.has-response .of-response,.has-backbones .of-backbones,
.has-test-frf .of-test-frf{display:block}figure{break-inside:avoid}
tr.now td{background:none}
button.link{color:inherit}}
"""
BITMAPS = ("modes", "shapes")  # tens of thousands of polygons: a bitmap is smaller than their outlines


def picture(name: str, figure: Any) -> str:
    """Return a figure as SVG, or as a bitmap where its name is one of BITMAPS."""
    return _inline(name, drawn(figure, _kind(name)))


def saved(name: str, figure: Any, file: Path) -> tuple[Path, str]:
    """Write a figure into a file and return it with the text that a page shows, drawn once for both."""
    made = drawn(figure, _kind(name))
    return write_atomically(file, lambda temporary: temporary.write_bytes(made)), _inline(name, made)


def _kind(name: str) -> str:
    return "png" if name in BITMAPS else "svg"


def _inline(name: str, made: bytes) -> str:
    """A figure as it stands in a page."""
    if name in BITMAPS:
        return f'<img alt="{name}" src="data:image/png;base64,{b64encode(made).decode()}">'
    svg = made.decode()
    return svg[svg.index("<svg") :]


def table(rows: Rows, name: str = "") -> str:
    """Return rows as a table, the first as its heading; name: what scripts find it by."""
    head = "".join(f"<th>{escape(cell)}</th>" for cell in rows[0])
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows[1:])
    known = f' data-table="{escape(name)}"' if name else ""
    return f'<div class="scroll"><table{known}><tr>{head}</tr>{body}</table></div>'


def facts(known: dict[str, Any]) -> str:
    """Return names and values as a table of two columns."""

    def show(value: Any) -> str:
        if isinstance(value, list | tuple):
            return " to ".join(show(v) for v in value)
        return f"{value:.4g}" if isinstance(value, float) else str(value)

    rows = "".join(f"<tr><td>{escape(k)}</td><td>{escape(show(v))}</td></tr>" for k, v in known.items())
    return f'<table class="words">{rows}</table>'


def curves(name: str, groups: Any) -> str:
    """A place for curves that zoom, with their data; pictures of the class of-NAME stand in for them."""
    return f'<div data-curves="{name}"></div>{pages.data(json.dumps(groups), name)}'


def document(title: str, body: str, run: str = "") -> str:
    """Return a whole page; run: text of the one script that it runs. It asks for nothing beyond itself."""
    head = (
        f'<meta charset="utf-8">{pages.policy(run)}<meta name="viewport" content="width=device-width">'
        f"<title>{escape(title)}</title><style>{STYLE}</style>"
    )
    end = pages.script(run) if run else ""
    return f"<!doctype html><html lang='en'><head>{head}</head><body>{body}{end}</body></html>\n"
