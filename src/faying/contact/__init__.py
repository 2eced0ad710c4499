"""Contact laws: pressure in; real area, stiffness and loss out.

Every law is a file of its own under `models` and every single-asperity model one under `asperity`; `laws()` lists the
laws that it finds. Names are imported when they are first used.
"""

import re
from importlib import import_module
from importlib.util import find_spec
from typing import Any

import lazy_loader

_from_stub, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    """Names of the stub first; then a class Name out of the file name.py, so that a new model is one file."""
    try:
        return _from_stub(name)
    except AttributeError:
        if name[:1].isupper():
            for file in (re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower(), name.lower()):
                if find_spec(f"{__name__}.models.{file}") is not None:
                    return getattr(import_module(f"{__name__}.models.{file}"), name)
        raise
