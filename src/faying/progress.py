"""How long work says what it is doing: (stage, done, total), and how long it takes."""

from collections.abc import Callable

Report = Callable[[str, int, int], None]
"""Called with what is being done now, how many steps are done, and how many there are; 0 of 0 where not counted."""


def duration(seconds: float) -> str:
    """A time [s] in the unit that it is told in, rounded."""
    minutes = int(seconds) // 60
    return f"{seconds:.0f} s" if minutes < 2 else f"{minutes} min" if minutes < 120 else f"{minutes / 60:.1f} h"


def silent(_stage: str, _done: int, _total: int) -> None:
    """Report nothing."""
