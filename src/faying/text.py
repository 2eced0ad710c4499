"""Short texts of objects, for a console and for a notebook."""

from collections.abc import Iterable

MOST_NAMES = 6


def listed(names: Iterable[str], most: int = MOST_NAMES) -> str:
    """Names with commas; how many more there are, where they are many."""
    every = list(names)
    return ", ".join(every[:most]) + (f" and {len(every) - most} more" if len(every) > most else "")


def titled(kind: str, name: str) -> str:
    """What a thing is and its name, the former once: "joint 1", "joint flange"."""
    return name if kind in name.lower() else f"{kind} {name}"
