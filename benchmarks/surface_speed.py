"""CPU seconds of the spectrum, the structure function and the command, beside SurfaceTopography in the same run.

Run: OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 python benchmarks/surface_speed.py   (needs --group peers)
"""

import resource
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

from faying.surface.files.write import write_scan
from faying.surface.form import prepared
from faying.surface.spectrum import spectrum, structure_function
from faying.surface.synthesize import spectral


def seconds(call: Callable[[], Any], rounds: int) -> float:
    """Median CPU seconds of a call."""
    taken = []
    for _ in range(rounds):
        start = time.process_time()
        call()
        taken.append(time.process_time() - start)
    return statistics.median(taken)


def child(arguments: list[str], rounds: int) -> float:
    """Median CPU seconds of a process."""
    taken = []
    for _ in range(rounds):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(arguments, check=True, capture_output=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        taken.append(after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)
    return statistics.median(taken)


def main() -> None:
    """Print the table."""
    warnings.simplefilter("ignore")
    from SurfaceTopography import Topography

    scan = prepared(spectral((2048, 2048), spacing=1e-6, D=2.4, Rq=1e-6, seed=1)).scan
    peer = Topography(scan.heights.T, scan.size, unit="m")
    print("| CPU seconds, median | Faying | SurfaceTopography | ratio |\n|---|---:|---:|---:|")
    pairs = (
        (
            "areal power spectrum, 2048 x 2048",
            lambda: spectrum(scan),
            lambda: peer.power_spectrum_from_area(window="hann"),
        ),
        (
            "areal structure function, 2048 x 2048",
            lambda: structure_function(scan),
            lambda: peer.autocorrelation_from_area(),
        ),
    )
    for name, ours, theirs in pairs:
        a, b = [], []
        for _ in range(5):  # taken in turns, so that a busy machine slows both alike
            a.append(seconds(ours, 1))
            b.append(seconds(theirs, 1))
        x, y = statistics.median(a), statistics.median(b)
        print(f"| {name} | {x:.2f} | {y:.2f} | {x / y:.2f} |")
    with tempfile.TemporaryDirectory() as folder:
        path = write_scan(spectral((1024, 1024), spacing=1e-6, D=2.4, Rq=1e-6, seed=1), Path(folder) / "a.x3p")
        taken = child([sys.executable, "-m", "faying", "surface", str(path)], 5)
        print(f"| `faying surface` on a 1024 x 1024 X3P file | {taken:.2f} | | |")


if __name__ == "__main__":
    main()
