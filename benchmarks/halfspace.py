"""Half-space contact beside other codes on the same heights: CPU seconds, accuracy by one measure, growth with size.

    python benchmarks/halfspace.py [--witness PYTHON] [--contactmechanics PYTHON] [--quick]

PYTHON: interpreters that have tamaas and aspher, and ContactMechanics (their needs may clash; neither is a dependency
of faying). Without them only faying is measured. Every run is on one thread; CPU seconds of the solution alone, median
of three for faying, one run for the others. "residual" is faying's error bound, computed by faying for everyone.
"""

import argparse
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

for name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ[name] = "1"

sys.path.insert(0, str(Path(__file__).parent.parent))
import numpy as np  # noqa: E402  the thread counts come first

from faying.halfspace import error_bound, solve_half_space  # noqa: E402
from tests.helpers.self_affine import self_affine  # noqa: E402

WITNESS = Path(__file__).with_name("halfspace_witness.py")
PEERS = {"tamaas": 1e-6, "contactmechanics": 1e-6, "aspher-periodic": 1e-7}


def ours(h, pressure, hardness, repeats=3):
    seconds = []
    for _ in range(repeats):
        begin = time.process_time()
        contact = solve_half_space(h, 1 / h.shape[0], E_star=1.0, pressure=pressure, hardness=hardness)
        seconds.append(time.process_time() - begin)
    return contact, statistics.median(seconds)


def theirs(code, python, h, pressure, hardness, tol):
    with tempfile.TemporaryDirectory() as folder:
        given, found = Path(folder) / "in.npz", Path(folder) / "out.npz"
        np.savez(given, heights=h, pressure=pressure, hardness=hardness or 0.0, tol=tol)
        run = subprocess.run([python, WITNESS, code, given, found], capture_output=True, text=True)
        if run.returncode:
            return None, run.stderr.strip().splitlines()[-1][:100] if run.stderr.strip() else "failed"
        with np.load(found) as out:
            return out["traction"], float(out["seconds"])


def line(code, area, mean, residual, seconds, ratio):
    print(
        f"  {code:18s} area {area:.5f}  load error {mean:8.1e}  residual {residual:8.1e}  {seconds:8.2f} s  x "
        f"{ratio:6.1f}",
        flush=True,
    )


def compare(n, pressure, hardness, peers):
    h = self_affine(n)
    contact, mine = ours(h, pressure, hardness)
    print(
        f"{n} x {n}, p/E* {pressure:g}, H/E* {hardness or 'none'}: {contact.iterations} steps, "
        f"{contact.applications} products on the finest map"
    )
    line("faying", contact.area, contact.pressure / pressure - 1, contact.residual, mine, 1.0)
    for code, python in peers.items():
        if hardness and code.startswith("aspher"):
            continue
        traction, seconds = theirs(code, python, h, pressure, hardness, PEERS[code])
        if traction is None:
            print(f"  {code:18s} {seconds}")
            continue
        residual = error_bound(h, 1 / n, traction, E_star=1.0, hardness=hardness)
        line(
            code,
            np.count_nonzero(traction > 0) / n**2,
            traction.mean() / pressure - 1,
            residual,
            seconds,
            seconds / mine,
        )


def growth(largest):
    print("growth with size at p/E* .01 (s) and H/E* .005 at p/E* .002 (s); per N log2 N, in ns")
    n = 128
    while n <= largest:
        cells = n * n
        row = []
        for pressure, hardness in ((0.01, None), (0.002, 0.005)):
            contact, seconds = ours(self_affine(n), pressure, hardness, repeats=3 if n <= 1024 else 1)
            row.append(
                f"{seconds:8.3f} s {contact.applications:4d} products {seconds / cells / np.log2(cells) * 1e9:7.1f} ns"
            )
        print(f"  {n:5d}  " + "   |   ".join(row), flush=True)
        n *= 2


def main():
    ask = argparse.ArgumentParser()
    ask.add_argument("--witness", help="interpreter with tamaas and aspher")
    ask.add_argument("--contactmechanics", help="interpreter with ContactMechanics")
    ask.add_argument("--quick", action="store_true", help="maps of 256 points a side only")
    given = ask.parse_args()
    peers = {}
    if given.witness:
        peers |= {"tamaas": given.witness, "aspher-periodic": given.witness}
    if given.contactmechanics:
        peers["contactmechanics"] = given.contactmechanics
    ours(self_affine(64), 0.01, None)  # imports
    if given.quick:
        compare(256, 0.01, None, peers)
        compare(256, 0.002, 0.005, peers)
        return
    for n, pressure in ((512, 0.002), (512, 0.01), (1024, 0.002), (1024, 0.01), (1024, 0.02)):
        compare(n, pressure, None, peers)
    compare(512, 0.002, 0.005, peers)
    growth(4096)


if __name__ == "__main__":
    sys.exit(main())
