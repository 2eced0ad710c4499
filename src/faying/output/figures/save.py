"""How every figure is made and written."""

from pathlib import Path
from typing import Any

from faying.errors import InputError
from faying.files import write_atomically

RESOLUTION = 150  # dots per inch of what is no line


def new_figure(width: float, height: float) -> Any:
    """Return an empty figure [inches] that needs no display."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def plain(text: str) -> str:
    """A name as it stands: without this, matplotlib reads what is between dollar signs as mathematics."""
    return text.replace("$", r"\$")


def check_ending(path: Path) -> None:
    """Raise InputError unless figures can be written under this name."""
    kinds = new_figure(1, 1).canvas.get_supported_filetypes()
    if path.suffix[1:].lower() not in kinds:
        raise InputError(f"{path}: figures can be written as {', '.join(sorted(kinds))}; end the name in one of them")


def check_figure(path: str | Path) -> None:
    """Raise InputError, before anything is computed, for a figure that cannot be written."""
    file = Path(path)
    check_ending(file)
    if not file.parent.is_dir():
        raise InputError(f"no folder {file.parent} to write {file.name} in; make it first")


def save(figure: Any, path: str | Path) -> Path:
    """Write a figure in the format of the ending of `path`; the file appears complete or not at all.

    Raises InputError for other endings and where the file cannot be written.
    """
    file = Path(path)
    check_ending(file)
    return write_atomically(
        file, lambda temporary: figure.savefig(temporary, format=file.suffix[1:].lower(), dpi=RESOLUTION)
    )
