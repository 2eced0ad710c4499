"""`faying view FILE`: a study, a result, a mesh or a STEP file as a page to look at."""

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from faying.output.scene import Scene


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--out", type=click.Path(dir_okay=False, path_type=Path), help="The page (default: beside FILE).")
@click.option("--unit", help='Unit of a mesh file, such as "mm"; no mesh file says.')
@click.option("--open/--no-open", "show", default=True, help="Open the page in the browser.")
def command(file: Path, out: Path | None, unit: str | None, show: bool) -> None:
    """Look at FILE: a study (.toml) before it is run, a result (.nc), a mesh, or a STEP file.

    Writes one page that opens anywhere, with everything inside, and opens it in the browser. A study shows its mesh
    with joints, bolts, supports and masses; a result its moving modes and the maps of its joints; a click on a face
    tells its number, name, part, area and centre.
    """
    import webbrowser

    from faying.files import write_text
    from faying.output.scene import page

    scene = scene_of(file, unit)
    made = write_text(out or place(file), page(scene))
    named = sum(1 for face in scene.faces if face.name)
    click.echo(f"{scene.title}: {len(scene.parts)} parts, {len(scene.faces)} faces, {named} of them named")
    click.echo(f"written: {made}")
    if show and not webbrowser.open(made.resolve().as_uri()):
        click.echo(f"no browser was found; open {made.resolve().as_uri()} in one", err=True)


def scene_of(file: Path, unit: str | None = None) -> "Scene":
    """The scene of a file by its ending. Raises ReadError and InputError as its readers do."""
    from faying.errors import InputError, ReadError
    from faying.output.scene import of_mesh, of_result, of_step

    kind = file.suffix.lower()
    if not file.is_file():
        raise ReadError(f"no file {file}")
    meshed = kind not in (".toml", ".nc", ".step", ".stp")
    if unit is not None and not meshed:
        raise InputError(f"--unit goes with a mesh file; {file.name} has its units inside")
    if kind == ".toml":
        from faying.study import Study
        from faying.study.case import checked_mesh

        study = Study.read(file)
        return of_mesh(checked_mesh(study), study)
    if kind == ".nc":
        from faying.result import Result

        return of_result(Result.load(file))
    if not meshed:
        return of_step(file)
    if unit is None:
        raise InputError(f'a mesh file does not say its unit; give that of {file.name}, for example --unit "mm"')
    from faying.decks.meshfile import read_mesh

    return of_mesh(read_mesh(file, unit=unit), title=file.name)


def place(file: Path) -> Path:
    """Where the page is written by default: beside the file, or in a temporary folder where that cannot be."""
    import os

    name = f"{file.stem}-view.html"
    return file.with_name(name) if os.access(file.resolve().parent, os.W_OK) else Path(tempfile.mkdtemp()) / name
