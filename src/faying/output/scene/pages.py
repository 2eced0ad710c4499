"""Pages that show scenes: the viewer and its data inside one file, which opens anywhere and asks for nothing."""

import re
from base64 import b64encode
from functools import cache
from hashlib import sha256
from html import escape
from pathlib import Path

from faying.output.scene.model import Scene
from faying.output.scene.text import to_text

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
