"""Memory that a factorisation needs beside the memory there is: asked before the work begins."""

import numpy as np

from faying.errors import InputError
from faying.memory import GB, available, require

# entries of a factor over unknowns^(4/3), as nested dissection of a compact solid grows (George 1973,
# doi:10.1137/0710032);
# PARDISO counts 14 to 16 on boxes of tet10 with 43,000 to 154,000 unknowns, less on slender structures
FILL = 16.0
FILL_MINIMUM_DEGREE = 25.0  # the only ordering SuperLU has for these: 19 counted at 43,000 unknowns, growing


def guessed(unknowns: int, *, fill: float = FILL, per_entry: float = 10.0) -> float:
    """Memory [B] of a factor where no library says: fill x unknowns^(4/3) entries."""
    return fill * per_entry * unknowns * float(np.cbrt(unknowns))


def in_single(unknowns: int) -> float:
    """Memory [B] of PARDISO's factor of a compact solid in single precision, before there is a matrix."""
    return guessed(unknowns, per_entry=5.0)


def check(needed: float, unknowns: int, solver: str) -> None:
    """Raise InputError where a factorisation needs more memory [B] than there is."""
    free = available()
    if free is None or needed <= free:
        return
    advice = ["a coarser mesh (memory grows as the power 4/3 of the unknowns)"]
    if solver != "PARDISO":
        advice.insert(0, "PARDISO, which needs less (add --extra pardiso to uv run, or pip install pypardiso)")
    raise InputError(
        f"{solver} needs {needed / GB:.3g} GB to factorise {unknowns:,} unknowns and {free / GB:.3g} GB are free; "
        f"choose {', or '.join(advice)}; or set FAYING_MEMORY to the GB that may be taken"
    )


def check_modes(count: int, unknowns: int) -> None:
    """Raise InputError where the shapes of so many modes, with what finds them, need more memory than there is."""
    # about two vectors for each mode, and their products with the mass
    require(4 * 8.0 * count * unknowns, f"{count:,} modes of {unknowns:,} unknowns", "ask for fewer modes")
