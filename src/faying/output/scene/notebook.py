"""The viewer inside a notebook: the same page as `faying view` writes, in a frame of its own, without a server."""

from html import escape
from pathlib import Path
from typing import final

from faying.errors import InputError
from faying.fe.mesh import Mesh
from faying.files import write_text
from faying.misuse import checked_call
from faying.output.scene.build import of_mesh, of_result
from faying.output.scene.files import of_file
from faying.output.scene.model import Scene
from faying.output.scene.pages import page
from faying.result import Result


@final
class View:
    """A structure to look at: a notebook shows it as the last line of a cell; `save` writes it as a page."""

    def __init__(self, scene: Scene, *, height: int = 620) -> None:
        """Hold a scene, to be shown so many pixels high."""
        self.scene, self.height = scene, height

    def __repr__(self) -> str:
        """Return what it shows, and how to see it."""
        return f"View of {self.scene.title!r}: a notebook shows it; .save(PATH) writes it as a page"

    def _repr_html_(self) -> str:
        """Return the viewer in a frame, which keeps its styles and its script apart from those of the notebook."""
        style = f"width:100%;height:{self.height}px;border:0"
        title = escape(self.scene.title, quote=True)
        return f'<iframe title="{title}" style="{style}" srcdoc="{escape(page(self.scene), quote=True)}"></iframe>'

    def save(self, path: str | Path) -> Path:
        """Write one page that opens anywhere, with everything inside.

        Args:
            path: of the page, such as "view.html".

        Returns:
            The path.

        Raises:
            InputError: the folder is missing or the file cannot be written.
        """
        return write_text(Path(path), page(self.scene))


@checked_call
def view(of: Result | Mesh | str | Path, *, unit: str | None = None, height: int = 620) -> View:
    """Look at a result, a mesh or a file in a notebook, as `faying view` does in the browser.

    Args:
        of: a `Result`, a `Mesh`, or a file: study (.toml), result (.nc), STEP or mesh.
        unit: of a mesh file, such as "mm", since no mesh file says its own.
        height: of the view [pixels], 200 to 4000.

    Returns:
        What a notebook shows as the last line of a cell.

    Raises:
        InputError: it is nothing that can be shown, or the unit or height does not fit.
        ReadError: the file is missing or cannot be read.
    """
    if not 200 <= height <= 4000:
        raise InputError(f"height = {height}; a view is 200 to 4000 pixels high")
    if isinstance(of, str | Path):
        return View(of_file(of, unit), height=height)
    if unit is not None:
        raise InputError("unit is for mesh files; leave it out")
    if isinstance(of, Result):
        return View(of_result(of), height=height)
    return View(of_mesh(of), height=height)
