"""Half-space contact beside other codes on the same heights: CPU seconds, accuracy by one measure, growth with size.

    python benchmarks/halfspace.py [--witness PYTHON] [--contactmechanics PYTHON] [--quick]
    python benchmarks/halfspace.py --sizes 1024 2048 4096 8192 [--kinds elastic saturated] [--precision single]
    python benchmarks/halfspace.py --beside 2048 --witness PYTHON

PYTHON: interpreters that have tamaas and aspher, and ContactMechanics (their needs may clash; neither is a dependency
of faying). Without them only faying is measured. Every run is on one thread; CPU seconds of the solution alone, median
of three for faying, one run for the others. "residual" is faying's error bound, computed by faying for everyone.
"""

import argparse
import json
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
from peers.peer import ask  # noqa: E402

from faying.halfspace import error_bound, solve_half_space  # noqa: E402
from tests.helpers.self_affine import self_affine  # noqa: E402

PEERS = {"tamaas": 1e-6, "contactmechanics": 1e-6, "aspher-periodic": 1e-7}


def ours(h, pressure, hardness, repeats=3, **options):
    seconds, contact = [], None
    for _ in range(repeats):
        del contact  # its maps do not count in the next one's memory
        begin = time.process_time()
        contact = solve_half_space(h, 1 / h.shape[0], E_star=1.0, pressure=pressure, hardness=hardness, **options)
        seconds.append(time.process_time() - begin)
    return contact, statistics.median(seconds)


def theirs(code, python, h, pressure, hardness, tol):
    try:
        out = ask(python, "half_space.py", code, heights=h, pressure=pressure, hardness=hardness or 0.0, tol=tol)
    except RuntimeError as fault:
        return None, str(fault)
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


LOADS = {"elastic": (0.01, None), "saturated": (0.002, 0.005)}  # pressure and hardness over E*


def memory(name):
    """Of this process now (VmRSS) or at its peak (VmHWM) [B]; Linux."""
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(float(line.split()[1]) * 1024 for line in lines if line.startswith(name))


def one(file, pressure, hardness, precision, repeats):
    """Solve one map in this process; CPU seconds, the peak of memory with the map [B a point], and counts."""
    ours(self_affine(64), 0.01, None, 1)  # imports
    h = np.load(file)
    Path("/proc/self/clear_refs").write_text("5")  # the peak so far was a smaller map's or the parent's
    before = memory("VmRSS")
    tol = 1e-6 if precision == "double" else 1e-5
    contact, seconds = ours(h, pressure, hardness, repeats, precision=precision, tol=tol)
    peak = memory("VmHWM") - before + h.nbytes
    names = ("iterations", "applications", "residual", "area", "saturated")
    print(json.dumps({"seconds": seconds, "memory": peak / h.size} | {name: getattr(contact, name) for name in names}))


def sizes(counts, kinds, precision):
    """The table of growth with size: every map in a process of its own, so that its peak of memory is its own."""
    head = "points a side, load, CPU s, ns a point, over 1024, peak B a point, steps, products, residual, area, hard"
    print("| " + head.replace(", ", " | ") + " |\n|" + "---|" * (head.count(", ") + 1), flush=True)
    least = {}
    for n in counts:
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "map.npy"
            np.save(file, self_affine(n))
            for kind in kinds:
                pressure, hardness = LOADS[kind]
                ask = ["--one", file, pressure, hardness or 0, precision, 3 if n <= 4096 else 1]
                run = subprocess.run([sys.executable, __file__, *map(str, ask)], capture_output=True, text=True)
                if run.returncode:
                    print(f"| {n} | {kind} | {run.stderr.strip().splitlines()[-1]} |", flush=True)
                    continue
                found = json.loads(run.stdout)
                each = found["seconds"] / n**2 * 1e9
                least.setdefault(kind, each) if n >= 1024 else None
                print(
                    f"| {n} | {kind} | {found['seconds']:.3g} | {each:.0f} | {each / least.get(kind, np.nan):.2f} | "
                    f"{found['memory']:.0f} | {found['iterations']} | {found['applications']} | "
                    f"{found['residual']:.1e} | {found['area']:.4f} | {found['saturated']:.4f} |",
                    flush=True,
                )


def main():
    ask = argparse.ArgumentParser()
    ask.add_argument("--witness", help="interpreter with tamaas and aspher")
    ask.add_argument("--contactmechanics", help="interpreter with ContactMechanics")
    ask.add_argument("--quick", action="store_true", help="maps of 256 points a side only")
    ask.add_argument("--sizes", type=int, nargs="+", metavar="N", help="only the table of growth, for these sizes")
    ask.add_argument("--kinds", nargs="+", choices=LOADS, default=list(LOADS), help="loads of that table")
    ask.add_argument("--precision", choices=("double", "single"), default="double", help="precision of that table")
    ask.add_argument("--beside", type=int, metavar="N", help="only the other codes, elastic at this size")
    ask.add_argument("--one", nargs=5, help=argparse.SUPPRESS)
    given = ask.parse_args()
    if given.one:
        file, pressure, hardness, precision, repeats = given.one
        one(file, float(pressure), float(hardness) or None, precision, int(repeats))
        return
    if given.sizes:
        sizes(given.sizes, given.kinds, given.precision)
        return
    peers = {}
    if given.witness:
        peers |= {"tamaas": given.witness, "aspher-periodic": given.witness}
    if given.contactmechanics:
        peers["contactmechanics"] = given.contactmechanics
    ours(self_affine(64), 0.01, None)  # imports
    if given.beside:
        for pressure in (0.002, 0.01):
            compare(given.beside, pressure, None, peers)
        return
    if given.quick:
        compare(256, 0.01, None, peers)
        compare(256, 0.002, 0.005, peers)
        return
    for n, pressure in ((512, 0.002), (512, 0.01), (1024, 0.002), (1024, 0.01), (1024, 0.02)):
        compare(n, pressure, None, peers)
    compare(512, 0.002, 0.005, peers)
    sizes((256, 512, 1024, 2048, 4096), LOADS, "double")


if __name__ == "__main__":
    sys.exit(main())
