"""Speed of the single asperity: the rows of Table 1, and CalculiX on the same mesh with the same load steps.

Run `python benchmarks/asperity.py [--elements N] [--calculix M]`. CPU seconds of one process with one thread, so that
a busy machine disturbs them little; CalculiX is given the nodes in contact at each step and has only plasticity to
solve.
"""

import argparse
import os
import shutil
import statistics
import sys
import tempfile
import time
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

from asperity_fe import solve_asperity  # noqa: E402  the thread limits are read when NumPy is loaded

from faying import Material  # noqa: E402
from faying.numerics.solve import available  # noqa: E402

sys.path.insert(0, str(Path(__file__).parent.parent))
CAPS = [(15, 100), (20, 750), (40, 3000), (80, 6000)]


def material(E: float) -> Material:
    return Material(name="m", E=E, nu=0.3, yield_strength=355e6)


def table_1(elements: int, solver: str) -> list[float]:
    seconds = []
    for ratio in (1.0, 1.5, 2.0):
        for R, h_a in CAPS:
            start = time.process_time()
            found = solve_asperity(
                R=R * 1e-6,
                h_a=h_a * 1e-9,
                cap=material(ratio * 100e9),
                substrate=material(100e9),
                displacement=h_a * 1e-10,
                elements=elements,
                solver=solver,
            )
            seconds.append(time.process_time() - start)
            print(
                f"  R {R:3d} um  Ea/Eb {ratio:.1f}  F {found.force * 1e3:8.4g} mN  A {found.area * 1e12:7.4g} um2"
                f"  {found.unknowns} unknowns  {found.factorisations} factorisations  {seconds[-1]:6.2f} s"
            )
    return seconds


def against_calculix(elements: int, repeats: int = 3) -> None:
    from tests.helpers import calculix

    for R, h_a, ratio in ((20e-6, 0.75e-6, 1.0), (20e-6, 0.75e-6, 2.0)):
        ours, theirs = [], []
        for _ in range(repeats):
            start = time.process_time()
            model = calculix.table_1_model(R, h_a, ratio, elements, material)
            touching, force = calculix.history(model, 0.1 * h_a, round(1.5 * elements))
            ours.append(time.process_time() - start)
            with tempfile.TemporaryDirectory() as folder:
                seen = calculix.run(Path(folder), model, touching, element="CAX4", increments=1)
            theirs.append(seen.seconds)
        a, b = statistics.median(ours), statistics.median(theirs)
        print(
            f"  R {R * 1e6:.0f} um, Ea/Eb {ratio}: {len(model.mesh.nodes)} nodes, force over CalculiX's"
            f" {force / seen.force:.4f}, CPU {a:.2f} s against {b:.2f} s: ratio {b / a:.1f}"
        )


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--elements", type=int, default=40)
    parser.add_argument("--calculix", type=int, default=16, help="elements over the contact radius for CalculiX")
    given = parser.parse_args()
    for solver in [s for s in ("pardiso", "superlu") if s in available()]:
        print(f"Table 1, {given.elements} elements over the contact radius, {solver}")
        seconds = table_1(given.elements, solver)
        print(
            f"  a row: median {statistics.median(seconds):.2f} s, most {max(seconds):.2f} s; all {sum(seconds):.1f} s"
        )
    if shutil.which("ccx"):
        print("CalculiX, same mesh and steps")
        against_calculix(given.calculix)
    else:
        print("CalculiX is not installed (Debian: calculix-ccx): left out")


if __name__ == "__main__":
    main()
