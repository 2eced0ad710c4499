"""Bolts that are alike, on one line."""

from collections.abc import Sequence

MAX_NAMES = 2  # bolts that a line names one by one


def grouped(names: Sequence[str]) -> str:
    """Names of bolts on one line: each of a few, else how many they are, the first and the last."""
    if len(names) <= MAX_NAMES:
        return ", ".join(names)
    return f"{len(names)} bolts ({names[0]} to {names[-1]})"
