"""Structures to look at: scenes as compact arrays, and the viewer that shows them in a page."""

from faying.output.scene.build import of_mesh, of_result
from faying.output.scene.files import of_file
from faying.output.scene.model import Scene
from faying.output.scene.notebook import View, view
from faying.output.scene.pages import ASSETS, inline, page
from faying.output.scene.step import of_step
from faying.output.scene.text import to_text

__all__ = ["ASSETS", "Scene", "View", "inline", "of_file", "of_mesh", "of_result", "of_step", "page", "to_text", "view"]
