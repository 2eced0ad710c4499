"""What pages are made of: style, tables, pictures as text of HTML."""

import json
import re
from base64 import b64encode
from html import escape
from pathlib import Path
from typing import Any

from faying.files import write_atomically
from faying.output.scene import pages
from faying.output.table import Rows
from faying.style import drawn
from faying.typeset import unit

STYLE = """
:root{--ink:#1c2733;--soft:#52616f;--line:#d5dde5;--head:#f3f6f9;--back:#fff;--flag:#fff4e0;--accent:#0a63b0}
body{font:15px/1.5 system-ui,sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem;color:var(--ink)}
body,html{background:var(--back)}h1,h2,h3,li,summary{overflow-wrap:anywhere}td,th{overflow-wrap:break-word}
h1{font-size:1.5rem}h2{font-size:1.15rem;margin-top:2.2rem;border-bottom:1px solid var(--line);padding-bottom:.2rem}
h3{font-size:1rem;margin:1.2rem 0 .3rem}
table{border-collapse:collapse;font-size:.84rem;font-variant-numeric:tabular-nums;margin:.6rem 0}
th,td{padding:.18rem .7rem;text-align:right;border-bottom:1px solid var(--line)}th{background:var(--head)}
td:first-child,th:first-child,.words :is(td,th){text-align:left}.words th{font-weight:400}.scroll{overflow-x:auto}
[data-table=joints] :is(td,th):nth-child(2),[data-table=bolting] :is(td,th):nth-child(2){text-align:left}
.flag{background:var(--flag);border-left:4px solid #e0912f;padding:.4rem .8rem;margin:.4rem 0}
figure{margin:1rem 0}figure svg,figure img{width:100%;height:auto;background:#fff}
.lead{font-size:1.1rem}a{color:var(--accent)}.contents{list-style:none;display:flex;flex-wrap:wrap;gap:.2rem 1.2rem;
padding:.5rem 0;border-block:1px solid var(--line)}
.pair{display:flex;flex-wrap:wrap;gap:.5rem 1.5rem;align-items:flex-start}
.pair>figure{flex:1 1 30rem;min-width:min(30rem,100%);margin:.6rem 0}.pair>.scroll{flex:0 1 auto}
[data-table=answer] :is(td,th):nth-child(2),[data-table=narrowing] :is(td,th):nth-child(2){text-align:left}
h4{font-size:.95rem;margin:.9rem 0 .2rem}
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
@page{size:A4;margin:16mm 14mm}
@media print{:root{--ink:#000;--soft:#333;--line:#bbb;--head:#eee;--back:#fff;--flag:#fff4e0;--accent:#000}
body{max-width:none;margin:0;padding:0;font-size:9.5pt}nav,#stage,.live #stage,[data-curves],#why{display:none}
.live .static,.has-response .of-response,.has-backbones .of-backbones,
.has-test-frf .of-test-frf{display:block}figure,.flag,tr{break-inside:avoid}
figure svg,figure img{max-height:235mm;object-fit:contain}
h2,h3,h4,summary{break-after:avoid}thead{display:table-header-group}.scroll{overflow:visible;break-inside:avoid-page}
table{font-size:8pt}table.words{break-inside:avoid}
th,td{padding:.1rem .4rem}.pair{display:block}pre{white-space:pre-wrap;font-size:7.5pt}
tr.now td{background:none}
button.link{color:inherit}}
"""
GREEK = {"delta": "δ", "Phi": "Φ"}
BITMAPS = ("modes", "shapes")  # tens of thousands of polygons: a bitmap is smaller than their outlines


MAX_COLUMNS = 9  # of a table on paper
LINKED = ("modes", "joints")  # tables whose columns a page's script counts
_SYMBOL = re.compile(r"(?<![\w/.-])([A-Za-z]|delta|Phi)_([A-Za-z0-9]{1,4})(?![\w.])")


def picture(name: str, figure: Any, caption: str = "") -> str:
    """Return a figure as SVG, or as a bitmap where its name is one of BITMAPS; caption: for those who do not see it."""
    return _inline(name, drawn(figure, _kind(name)), caption)


def saved(name: str, figure: Any, file: Path, caption: str = "") -> tuple[Path, str]:
    """Write a figure into a file and return it with the text that a page shows, drawn once for both."""
    made = drawn(figure, _kind(name))
    return write_atomically(file, lambda temporary: temporary.write_bytes(made)), _inline(name, made, caption)


def _kind(name: str) -> str:
    return "png" if name in BITMAPS else "svg"


def _inline(name: str, made: bytes, caption: str) -> str:
    """A figure as it stands in a page."""
    words = escape(caption or name)
    if name in BITMAPS:
        return f'<img alt="{words}" src="data:image/png;base64,{b64encode(made).decode()}">'
    svg = made.decode()
    return svg[svg.index("<svg") :].replace("<svg", f'<svg role="img" aria-label="{words}"', 1)


def typeset(text: str) -> str:
    """Return escaped text with subscripts and signs of units: k_n and um as a book prints them."""
    return unit(_SYMBOL.sub(lambda found: f"<i>{GREEK.get(found[1], found[1])}</i><sub>{found[2]}</sub>", text))


def table(rows: Rows, name: str = "", keys: int = 1) -> str:
    """Return rows as a table, the first as its heading; name: what scripts find it by.

    Columns of zeros are left out and named below. A table of more than 9 columns becomes several below each other, each
    with the first `keys` columns.
    """
    if name in LINKED:
        return _one_table(rows, name)
    rows, zero = without_zeros(rows, keys)
    others = len(rows[0]) - keys
    count = -(-others // (MAX_COLUMNS - keys)) if len(rows[0]) > MAX_COLUMNS else 1
    size = max(1, -(-others // count))
    parts = [
        _one_table([[*row[:keys], *row[first : first + size]] for row in rows], name)
        for first in range(keys, max(len(rows[0]), keys + 1), size)
    ]
    left_out = f'<p class="soft">Zero in all rows: {typeset(escape(", ".join(zero)))}.</p>' if zero else ""
    return "".join(parts) + left_out


def without_zeros(rows: Rows, keys: int = 1) -> tuple[Rows, list[str]]:
    """Rows without the columns, beyond the first `keys`, that hold nothing but zeros, and the headings of these."""

    def zero(column: int) -> bool:
        cells = [row[column].rstrip("%") for row in rows[1:]]
        try:  # a hash of zeros is not a number
            return bool(cells) and all(len(cell) < 12 and float(cell) == 0 for cell in cells)
        except ValueError:
            return False

    out = [column for column in range(keys, len(rows[0])) if zero(column)]
    rest = [[cell for column, cell in enumerate(row) if column not in out] for row in rows]
    return rest, [rows[0][column] for column in out]


def _one_table(rows: Rows, name: str) -> str:
    head = "".join(f'<th scope="col">{typeset(escape(cell))}</th>' for cell in rows[0])
    body = "".join("<tr>" + "".join(f"<td>{escape(cell)}</td>" for cell in row) + "</tr>" for row in rows[1:])
    known = f' data-table="{escape(name)}"' if name else ""
    return f'<div class="scroll"><table{known}><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>'


def facts(known: dict[str, Any]) -> str:
    """Return names and values as a table of two columns."""

    def show(value: Any) -> str:
        if isinstance(value, list | tuple):
            return " to ".join(show(v) for v in value)
        return f"{value:.4g}" if isinstance(value, float) else str(value)

    names = {k: typeset(escape(k)).replace("_", " ") for k in known}
    rows = "".join(f'<tr><th scope="row">{names[k]}</th><td>{escape(show(v))}</td></tr>' for k, v in known.items())
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
