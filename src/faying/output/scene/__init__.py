"""Structures to look at: scenes as compact arrays, and the viewer that shows them in a page."""

from faying.output.scene.build import of_file, of_mesh, of_result, of_step
from faying.output.scene.pages import ASSETS, View, inline, page, view
from faying.output.scene.text import Scene, to_text

__all__ = ["ASSETS", "Scene", "View", "inline", "of_file", "of_mesh", "of_result", "of_step", "page", "to_text", "view"]
