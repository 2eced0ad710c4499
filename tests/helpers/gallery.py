"""The gallery's scripts as modules, imported by path."""

import importlib.util
import sys
from pathlib import Path

GALLERY = Path(__file__).parents[2] / "docs" / "gallery"


def script(name):
    """docs/gallery/<name>.py as a module."""
    spec = importlib.util.spec_from_file_location(f"gallery_{name}", GALLERY / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module
