"""Bolt sheets as text of a terminal and as a page that prints one bolt on each sheet of paper."""

from html import escape

from faying.output import page
from faying.output.table import Rows, text
from faying.output.terminal import folded
from faying.sheet.bolt_sheet import BoltSheet, BoltSheets
from faying.sheet.rows import Quantity, Row
from faying.text import in_columns
from faying.units import show

# units of the rows, with the factor from SI
SHOWN = {"m^2": (1e6, "mm^2"), "m/N": (1e9, "um/kN"), "N m": (1.0, "N m"), "": (1.0, "")}
DIGITS = 4
HEADS = ["step", "quantity", "value", "limit", "used", "verdict"]
STYLE = (
    "<style>.bolt:not(:last-of-type){break-after:page}.bolt :is(td,th){text-align:left;vertical-align:top}"
    ".bolt :is(td:nth-child(5),td:nth-child(9)){white-space:nowrap}@page{size:A4 landscape}"
    "@media print{.bolt .scroll{break-inside:auto}.bolt h3{break-after:avoid}}</style>"
)
SCOPE = (
    "Concentric clamping and loading. Load cases are solved at the least preload in service (R5, R9, R12), at the mean "
    "one (load factor of R3) and at the greatest at assembly (R8, R10). Typed loads are shared by the load factor, "
    "which holds while the joint neither opens nor slips. Bending of the bolt is in R9 alone."
)


def value_of(one: Quantity | None) -> str:
    """Write a quantity with a unit that reads well; a dash where it is not known."""
    if one is None or one.value is None:
        return "-"
    if one.unit in SHOWN:
        factor, unit = SHOWN[one.unit]
        return f"{one.value * factor:.{DIGITS}g} {unit}".rstrip()
    return show(one.value, one.unit, digits=DIGITS)


def _used(row: Row) -> str:
    used = row.utilisation
    return "-" if used is None else "all" if used == float("inf") else f"{100 * used:.0f} %"


def _verdict(row: Row) -> str:
    if row.verdict == "not known":
        return f"not known: needs {'; '.join(row.missing)}"
    return "" if row.verdict == "value" else row.verdict


def rows_of(sheet: BoltSheet) -> Rows:
    """Return one row for each row of a sheet: step, quantity, value, limit, use, verdict."""
    out: Rows = [HEADS]
    for row in sheet.rows:
        name = f"{row.result.symbol}: {row.result.name}"
        out.append([row.step, name, value_of(row.result), value_of(row.limit), _used(row), _verdict(row)])
    return out


def inputs_of(sheet: BoltSheet) -> Rows:
    """Return one row for each quantity that is an input of a row or a limit, and no row itself."""
    own = {row.result.symbol for row in sheet.rows}
    found: dict[str, Quantity] = {}
    for row in sheet.rows:
        for one in (*row.inputs, *(() if row.limit is None else (row.limit,))):
            if one.symbol not in own:
                found.setdefault(one.symbol, one)
    return [["input", "what it is", "value"], *([k, one.name, value_of(one)] for k, one in found.items())]


def terminal(found: BoltSheets) -> str:
    """Return all sheets as text."""
    parts = []
    for sheet in found.sheets:
        head = f"bolt {sheet.bolt!r}, {sheet.size}, at {show(sheet.preload, 'N')}: {sheet.verdict}"
        parts += [head, "", text(rows_of(sheet), left=(0, 1, 5)), "", text(inputs_of(sheet), left=(0, 1)), ""]
    return folded("\n".join([*parts, SCOPE]))


def html(found: BoltSheets) -> str:
    """Return all sheets as one page, each bolt on its own sheet when printed."""
    body = [STYLE, f"<h1>{escape(found.title)}: bolt sheets</h1>"]
    for sheet in found.sheets:
        rows = sheet.rows
        limits = ["-" if row.limit is None else f"{row.limit.symbol} = {value_of(row.limit)}" for row in rows]
        detail = in_columns(
            ("step", [row.step for row in rows], ""),
            ("quantity", [f"{row.result.symbol}: {row.result.name}" for row in rows], ""),
            ("formula", [row.formula for row in rows], ""),
            ("from", [", ".join(f"{one.symbol} = {value_of(one)}" for one in row.inputs) for row in rows], ""),
            ("value", [value_of(row.result) for row in rows], ""),
            ("limit", limits, ""),
            ("used", map(_used, rows), ""),
            ("verdict", map(_verdict, rows), ""),
            ("source", [row.source for row in rows], ""),
        )
        body += [
            f'<section class="bolt"><h2>Bolt "{escape(sheet.bolt)}", {escape(sheet.size)}, ',
            f"at {escape(show(sheet.preload, 'N'))}</h2>",
            f"<p>{escape(sheet.verdict)}. {escape(SCOPE)}</p>",
            page.table(detail, "sheet"),
            "<h3>Inputs</h3>",
            page.table(inputs_of(sheet), "inputs"),
            "</section>",
        ]
    return page.document(f"{found.title}: bolt sheets", "".join(body))
