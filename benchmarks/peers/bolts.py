"""Areas and stiffness of metric bolts."""

import numpy as np

from faying.bolt.threads import Thread
from faying.bolt.vdi2230 import bolt_sections
from peers.peer import ask
from peers.rows import Problem, worst

E = 205e9  # Pa
SIZES = (5, 8, 12, 20, 30, 39, 64)  # mm, coarse


def bolts(python):
    threads = [Thread.coarse(size * 1e-3) for size in SIZES]
    d = np.array([one.diameter for one in threads])
    shank, clamped = 2 * d, 4 * d
    theirs = ask(
        python, "thread.py", diameter=d, pitch=[one.pitch for one in threads], shank=shank, clamped=clamped, E=E
    )
    stiffness = [
        1 / sum(piece.compliance for piece in bolt_sections(one, free=4 * x, E=E, shank=2 * x))
        for one, x in zip(threads, d, strict=True)
    ]
    span = f"M{SIZES[0]} to M{SIZES[-1]}"
    quantities = (
        ("stress area", [one.stress_area * 1e6 for one in threads], theirs["area"] * 1e6, "mm2"),
        ("minor diameter", [one.minor_diameter * 1e3 for one in threads], theirs["minor"] * 1e3, "mm"),
        ("stiffness over four diameters", np.array(stiffness) * 1e-6, theirs["stiffness"] * 1e-6, "MN/m"),
    )
    return [worst(f"{what}, {span}, number", a, b, bound=4e-6, unit=u) for what, a, b, u in quantities]


PROBLEMS = [
    Problem(
        name="metric bolts",
        peer="pyFlange",
        seconds=2,
        bound="The same formulas of ISO 898-1 and VDI 2230; Faying has their printed factors 0.64952 and 1.22687, "
        "which are 5e-6 of the pitch off at most, or 1e-6 of the diameter and 2e-6 of its square; twice that.",
        solve=bolts,
    ),
]
