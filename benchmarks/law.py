"""Speed of contact laws against peers measured in the same run: CPU seconds, medians.

    uv run python benchmarks/law.py [--json]

1. A law's curve: at_closure at 500 points, all quantities, for a law just built; in milliseconds.
2. at_pressure over the naive way: one scipy.optimize.brentq per pressure on at_closure.
"""

import json
import sys
import time
from collections.abc import Callable
from statistics import median

import numpy as np
from scipy.optimize import brentq

from faying import CATALOGUE, JK, RIGID, ContactPair
from faying.contact import SurfaceInputs
from faying.contact.mates import Mates

LAW = JK(D=2.39, G=1.53e-10, pair=ContactPair(CATALOGUE["45 steel"], RIGID), scan_area=16e-6)


def cpu(work: Callable[[], object], repeats: int) -> float:
    """Median CPU seconds of one call."""
    times = []
    for _ in range(repeats):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return median(times)


def curve() -> dict[str, float]:
    al = np.geomspace(*LAW.closure_range, 500)
    LAW.at_closure(al)
    return {"curve of 500 points [ms]": 1e3 * cpu(lambda: LAW.with_(G=1.54e-10).at_closure(al), 51)}


def curves() -> dict[str, float]:
    surface = SurfaceInputs.from_fractal(D=2.4, G=1e-11, scan_area=16e-6, shortest=1e-5)
    times = {}
    for name, law in Mates.of_surface(surface, materials=LAW.pair).laws()[0].items():
        first, last = law.closure_range
        u = np.linspace(0, 1, 500)
        at = first * (last / first) ** u if law.geometric else first + u * (last - first)
        law.at_closure(at)
        times[name] = 1e3 * cpu(lambda law=law, at=at: law.with_().at_closure(at), 11)
    slowest = max(times, key=lambda name: times[name])
    return {f"the same, slowest of {len(times)} laws: {slowest} [ms]": times[slowest]}


def naive() -> dict[str, float]:
    p = np.geomspace(1e4, 0.9 * LAW.greatest_pressure, 60)
    first, last = np.log(LAW.closure_range)

    def one(target: float) -> float:
        return brentq(
            lambda u: float(np.log(LAW.at_closure(np.exp(u)).pressure)) - np.log(target), first, last, xtol=1e-12
        )

    ours = cpu(lambda: LAW.at_pressure(p), 11)
    peer = cpu(lambda: [LAW.at_closure(np.exp(one(v))) for v in p], 3)
    return {"exact inversion over brentq per point, 60 points": ours / peer}


if __name__ == "__main__":
    figures = curve() | curves() | naive()
    if "--json" in sys.argv:
        print(json.dumps(figures, indent=2))
    else:
        for name, value in figures.items():
            print(f"{name:<52}{value:12.4g}")
