"""`faying models`: every contact model with its source, inputs and ranges."""

from dataclasses import MISSING, fields
from typing import Any

import click

from faying.output.terminal import folded
from faying.text import json_text


@click.command()
@click.argument("name", required=False)
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def command(name: str | None, as_json: bool) -> None:
    """List the contact laws and the single-asperity models, or all about the law NAME."""
    from faying.contact import asperity
    from faying.contact.build import find, laws

    entries = [describe(cls) for cls in ([find(name).law] if name else laws().values())]
    singles = [] if name else [single(cls) for cls in asperity.models().values()]
    if as_json:
        click.echo(json_text({"laws": entries, "asperities": singles}))
        return
    lines = ["Laws of rough surfaces, faying.contact", ""] if not name else []
    for entry in entries:
        lines += [f"{entry['class']} ({entry['name']}), {entry['source']}"]
        lines += [f"  holds: {entry['validity']}; takes {entry['takes']}"]
        lines += [*(f"  {n}{mark(p)}: {p['meaning']}; {p['allowed']}" for n, p in entry["parameters"].items()), ""]
    if singles:
        lines += ["Models of one asperity, faying.contact.asperity", ""]
        lines += [f"{e['class']} ({e['name']}), {e['source']}\n  holds: {e['validity']}" for e in singles]
    click.echo(folded("\n".join(lines).rstrip()))


def mark(parameter: dict[str, Any]) -> str:
    """Write the unit and the default of a parameter."""
    unit = parameter["unit"]
    text = f" [{unit}]" if unit not in ("", "text") else ""
    return text + ("" if parameter["needed"] else f" = {parameter['default']}")


def describe(cls: Any) -> dict[str, Any]:
    """Return what a law declares."""
    from faying.contact.inputs import OF_SCAN

    defaults = {f.name: f.default for f in fields(cls)}
    parameters = {}
    for name, p in cls.entries().items():
        if p.surface in OF_SCAN[1:]:
            continue  # nothing that a user gives
        default = defaults.get(name, MISSING)
        parameters[name] = {
            "unit": p.unit,
            "meaning": p.meaning,
            "allowed": p.allowed,
            "needed": default is MISSING,
            "default": None if default is MISSING else default,
        }
    return single(cls) | {"takes": cls.takes(), "variants": list(cls.variants), "parameters": parameters}


def single(cls: Any) -> dict[str, Any]:
    """Return what any model says of itself."""
    summary = (cls.__doc__ or "").split("\n")[0]
    own = {name: getattr(cls, name) for name in ("name", "source", "validity")}
    return {"class": cls.__name__, **own, "summary": summary}
