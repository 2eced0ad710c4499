"""Short texts of objects, for a console and for a notebook, and trees as JSON."""

import json
from collections.abc import Iterable, Mapping
from math import isfinite
from typing import Any

MOST_NAMES = 6


def listed(names: Iterable[str], most: int = MOST_NAMES) -> str:
    """Names with commas; how many more there are, where they are many."""
    every = list(names)
    return ", ".join(every[:most]) + (f" and {len(every) - most} more" if len(every) > most else "")


def titled(kind: str, name: str) -> str:
    """What a thing is and its name, the former once: "joint 1", "joint flange"."""
    return name if kind in name.lower() else f"{kind} {name}"


def json_text(tree: Any) -> str:
    """A tree as JSON, indented; numbers that are not finite, which JSON does not know, become null."""
    return json.dumps(_finite(tree), indent=2, allow_nan=False)


def _finite(tree: Any) -> Any:
    if isinstance(tree, Mapping):
        return {name: _finite(value) for name, value in tree.items()}
    if isinstance(tree, list | tuple):
        return [_finite(value) for value in tree]
    return None if isinstance(tree, float) and not isfinite(tree) else tree
