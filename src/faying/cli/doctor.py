"""`faying doctor`: what of Faying works on this machine, and what to do about the rest."""

import os
import sys
from collections.abc import Callable
from typing import Any

import click

from faying.errors import InputError
from faying.text import json_text


@click.command()
@click.option("--json", "as_json", is_flag=True, help="Print JSON.")
def command(as_json: bool) -> None:
    """Say what works here: versions, solver, memory, STEP files, instruments, browser, cache.

    Exits with 1 where something that `faying run` needs for a STEP file is missing.
    """
    rows = [{"what": what, **look()} for what, look in LOOKS.items()]
    if as_json:
        click.echo(json_text({"findings": rows}))
    else:
        width = max(len(row["what"]) for row in rows)
        for row in rows:
            click.echo(f"{row['state']:<8} {row['what']:<{width}}  {row['found']}")
            if row["remedy"]:
                click.echo(f"{'':<8} {'':<{width}}  {row['remedy']}")
    if any(row["state"] == "missing" for row in rows):
        raise SystemExit(1)


def finding(found: str, state: str = "ok", remedy: str = "") -> dict[str, str]:
    """One finding; state: "ok", "optional" where only some commands need it, "missing" where a run does."""
    return {"state": state, "found": found, "remedy": remedy}


def _versions() -> dict[str, str]:
    from importlib.metadata import version
    from platform import platform, python_version

    from faying import __version__

    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy"))
    return finding(f"Faying {__version__}, Python {python_version()}, {packages}, {platform()}")


def _solver() -> dict[str, str]:
    from faying.numerics.solve import available, chosen

    first, *others = (chosen(), *(name for name in available() if name != chosen()))
    more = f"; also {', '.join(others)}" if others else ""
    if first != "superlu":
        return finding(f"{first}{more}")
    return finding(f"{first}{more}", "optional", "several times slower than PARDISO: add --extra pardiso to uv run")


def _memory() -> dict[str, str]:
    from faying.memory import GB, available

    free = available()
    source = " (FAYING_MEMORY)" if os.environ.get("FAYING_MEMORY", "").strip() else ""
    if free is None:
        return finding("not known", "optional", "set FAYING_MEMORY to the gigabytes that may be taken")
    return finding(f"{free / GB:.3g} GB can be taken{source}")


def _step() -> dict[str, str]:
    from faying.geometry.cad import kernel

    try:
        kernel()
    except InputError as fault:
        return finding("STEP files cannot be read", "missing", str(fault))
    return finding("STEP files are read and meshed")


def _instruments() -> dict[str, str]:
    from importlib.util import find_spec

    if find_spec("SurfaceTopography") is None:
        return finding("SurfaceTopography is not installed", "optional", "add --extra instruments to uv run")
    return finding("files of most profilometers are read")


def _browser() -> dict[str, str]:
    import webbrowser

    try:
        webbrowser.get()
    except webbrowser.Error:
        return finding("none that Python can open", "optional", "open the address or the file that a command prints")
    return finding("faying app and faying view open in it")


def _cache() -> dict[str, str]:
    given = os.environ.get("FAYING_CACHE", "").strip()
    if given == "off":
        return finding("off: contacts and meshes are solved each time", "optional", "unset FAYING_CACHE")
    return finding(f"{given or '.faying next to the scan or the STEP file'}; it can be deleted at any time")


def _screen() -> dict[str, str]:
    encoding = (getattr(sys.stdout, "encoding", None) or "").lower().replace("-", "")
    if encoding != "utf8":
        return finding(f"text goes out as {encoding or 'unknown'}", "optional", "set PYTHONUTF8=1 for signs such as µ")
    return finding("UTF-8")


LOOKS: dict[str, Callable[[], dict[str, Any]]] = {
    "versions": _versions,
    "solver": _solver,
    "memory": _memory,
    "STEP": _step,
    "instruments": _instruments,
    "browser": _browser,
    "cache": _cache,
    "terminal": _screen,
}
