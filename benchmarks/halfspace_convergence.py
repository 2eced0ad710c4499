"""Stiffness of one surface on ever more points: unloading and loading, one hardness and hardness by the size of spots.

    python benchmarks/halfspace_convergence.py [--points 64 128 256 512 1024]

A Gaussian, self-affine surface of 1 mm side and 1 um rms height with waves from a quarter of the side on, 45 steel on a
like flat. Each map holds the means over what its points cover, so that the finer maps have shorter waves as well.
k_n is that of the solved contact; k_load is the difference quotient of its closing between 1/1.05 and 1.05 times the
pressure. Prints a table in Markdown, MPa/um.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent))

from faying import CATALOGUE, ContactPair
from faying.contact.models.half_space import STEP, HalfSpace
from tests.contact.test_loading_and_size import self_affine

STEEL = CATALOGUE["45 steel"]
PAIRS = {
    "by size": ContactPair(STEEL, STEEL),
    "0.994 GPa": ContactPair(*(replace(STEEL, brinell=None, vickers=None),) * 2),
}
PRESSURES = 3e6, 30e6  # Pa


def stiffness(law: HalfSpace, pressure: float) -> tuple[float, float]:
    """k_n on unloading and k_load [Pa/m] of the contact at one pressure [Pa]."""
    contact = law.contact_at(pressure)
    low, high = (law.contact_at(p, start=contact) for p in (pressure / STEP, pressure * STEP))
    return contact.normal_stiffness(loading=False), (high.pressure - low.pressure) / (high.closing - low.closing)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--points", type=int, nargs="+", default=[64, 128, 256, 512, 1024])
    points = parser.parse_args().points
    heads = " | ".join(map(str, points))
    print(f"| branch | Hurst | p [MPa] | hardness | {heads} |\n|---|---|---|---|{'---|' * len(points)}")
    rows: dict[tuple[str, float, float, str], list[float]] = {}
    for hurst in (0.8, 0.5):
        for n in points:
            for name, pair in PAIRS.items():
                law = HalfSpace(self_affine(n, hurst), pair, tol=1e-4)
                for p in PRESSURES:
                    both = stiffness(law, p)
                    print(f"# Hurst {hurst}, {n} points, {name}, {p / 1e6:g} MPa: {both}", file=sys.stderr, flush=True)
                    for branch, k in zip(("unloading, k_n", "loading, k_load"), both, strict=True):
                        rows.setdefault((branch, hurst, p, name), []).append(k / 1e12)
    for (branch, hurst, p, name), values in sorted(rows.items(), reverse=True):
        cells = " | ".join(f"{k:.3g}" for k in values)
        print(f"| {branch} | {hurst} | {p / 1e6:g} | {name} | {cells} |")


if __name__ == "__main__":
    main()
