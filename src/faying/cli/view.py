"""`faying view FILE`: a study, a result, a mesh or a STEP file as a page to look at."""

import tempfile
from pathlib import Path
from typing import Any

import click

from faying.cli.options import FILE, PATH
from faying.errors import InputError
from faying.file_kinds import RESULT, kind_of
from faying.files import write_text


@click.command()
@click.argument("file", type=PATH)
@click.option("--out", type=FILE, help="The page (default: next to FILE).")
@click.option("--unit", help='Unit of a mesh file, such as "mm"; no mesh file says.')
@click.option("--vtu", type=FILE, help="Write a result for ParaView: NAME.pvd.")
@click.option("--open/--no-open", "show", default=True, help="Open the page in the browser.")
def command(file: Path, out: Path | None, unit: str | None, vtu: Path | None, show: bool) -> None:
    """Show FILE: a study (.toml) before it is run, a result (.nc), a mesh, or a STEP file.

    Writes one page that opens anywhere, with everything inside, and opens it in the browser. A study shows its mesh
    with joints, bolts, supports and masses; a result its moving modes and the maps of its joints; a click on a face
    tells its number, name, part, area and centre. With --vtu a result is written for ParaView in place of the page:
    NAME.pvd and one .vtu for each preload, with shapes, stress, pressure, gap, slip and stiffness. So are load cases
    and vibrations, with their stress.
    """
    import webbrowser

    from faying.output.scene import of_file, page

    if vtu is not None:
        _for_paraview(file, vtu, page_too=out is not None or unit is not None)
        return
    scene = of_file(file, unit)
    made = write_text(out or place(file), page(scene))
    named = sum(1 for face in scene.faces if face.name)
    click.echo(f"{scene.title}: {len(scene.parts)} parts, {len(scene.faces)} faces, {named} of them named")
    click.echo(f"written: {made}")
    if show and not webbrowser.open(made.resolve().as_uri()):
        click.echo(f"no browser was found; open {made.resolve().as_uri()} in one", err=True)


def _for_paraview(file: Path, vtu: Path, *, page_too: bool) -> None:
    from faying.saved import load

    found: Any = load(file) if kind_of(file) is RESULT else None
    found = getattr(found, "surface", found)  # of load cases and vibrations
    if not hasattr(found, "save_vtu"):
        raise InputError(
            f"--vtu writes a result, load cases or a vibration (.nc) for ParaView; {file.name} is none. Run the study "
            "first"
        )
    if page_too:
        raise InputError("--vtu writes no page; leave out --out and --unit")
    for made in found.save_vtu(vtu):
        click.echo(f"written: {made}")


def place(file: Path) -> Path:
    """Where the page is written by default: beside the file, or in a temporary folder where that cannot be."""
    import os

    name = f"{file.stem}-view.html"
    return file.with_name(name) if os.access(file.resolve().parent, os.W_OK) else Path(tempfile.mkdtemp()) / name
