"""How long work says what it is doing: (stage, done, total)."""

from collections.abc import Callable

Report = Callable[[str, int, int], None]
"""Called with what is being done now, how many steps are done, and how many there are; 0 of 0 where not counted."""


def silent(_stage: str, _done: int, _total: int) -> None:
    """Report nothing."""
