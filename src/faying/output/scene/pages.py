"""Pages that show scenes: the viewer and its data inside one file, which opens anywhere and asks for nothing."""

import re
from base64 import b64encode
from functools import cache
from hashlib import sha256
from html import escape
from pathlib import Path
from typing import final

from faying.errors import InputError
from faying.fe.mesh import Mesh
from faying.files import write_text
from faying.misuse import checked_call
from faying.output.scene.build import of_file, of_mesh, of_result
from faying.output.scene.text import Scene, to_text
from faying.result import Result

HERE = Path(__file__).parent
# what a server gives out beside a page: address relative to the viewer -> file
ASSETS = {"viewer.js": HERE / "viewer.js", "vendor/three.min.js": HERE / "vendor" / "three.min.js"}
_EXPORT = re.compile(r"export\s*\{([^}]*)\};?\s*$")
_IMPORT = re.compile(r'^import \* as THREE from "\./vendor/three\.min\.js";$', re.M)


@cache
def inline() -> str:
    """The viewer with three.js as text of one inline `<script type="module">`, in which `mount` is then known."""
    three = ASSETS["vendor/three.min.js"].read_text(encoding="utf-8")
    found = _EXPORT.search(three)
    assert found is not None
    names = (pair.split(" as ") for pair in found.group(1).split(","))
    given = ",".join(f"{pair[-1].strip()}:{pair[0].strip()}" for pair in names)
    whole = f"const THREE=(()=>{{{three[: found.start()]};return{{{given}}}}})();"
    viewer = ASSETS["viewer.js"].read_text(encoding="utf-8")
    return safe(_IMPORT.sub(lambda _: whole, re.sub(r"^export ", "", viewer, flags=re.M)))


def safe(script: str) -> str:
    """A script that no HTML parser ends before its end: `</script` and `<!--` occur in strings alone."""
    return script.replace("</script", "<\\/script").replace("<!--", "<\\!--")


def added(name: str) -> str:
    """Another script of this folder, to stand behind the viewer in the same element."""
    return safe(re.sub(r"^export ", "", (HERE / name).read_text(encoding="utf-8"), flags=re.M))


def script(text: str) -> str:
    """An element with a module script."""
    return f'<script type="module">{text}</script>'


def policy(text: str) -> str:
    """The content security policy of a page: it runs this script and no other, and asks for nothing."""
    digest = b64encode(sha256(text.encode()).digest()).decode("ascii")
    rules = f"default-src 'none'; script-src 'sha256-{digest}'; style-src 'unsafe-inline'; img-src data:"
    return f'<meta http-equiv="Content-Security-Policy" content="{rules}">'


def data(text: str, name: str) -> str:
    """JSON text as an element that a script reads by its id; nothing in it can be markup."""
    inert = text.replace("&", "\\u0026").replace("<", "\\u003c").replace(">", "\\u003e")
    inert = inert.replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
    return f'<script type="application/json" id="{name}">{inert}</script>'


START, STYLE = ((HERE / name).read_text(encoding="utf-8") for name in ("start.js", "page.css"))


def page(scene: Scene) -> str:
    """Return one self-contained page that shows a scene."""
    title, run = escape(scene.title), f"{inline()}\n{START}"
    head = (
        f'<meta charset="utf-8">{policy(run)}<meta name="viewport" content="width=device-width"><title>{title}</title>'
        f'<meta name="color-scheme" content="light dark"><style>{STYLE}</style>'
    )
    body = (
        f'<h1>{title}</h1><div id="stage"><noscript>This page needs JavaScript.</noscript></div>'
        f"{data(to_text(scene), 'scene')}{script(run)}"
    )
    return f'<!doctype html><html lang="en"><head>{head}</head><body>{body}</body></html>\n'


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
