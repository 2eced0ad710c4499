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

STYLE = Path(__file__).with_name("page.css").read_text(encoding="utf-8")
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
