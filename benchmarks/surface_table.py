"""Bias, spread and coverage of every estimator of D and G on synthetic surfaces, with other packages beside them.

Run: python benchmarks/surface_table.py [--count 200] [--beside 80] [--rows FILE.jsonl]
    [--output docs/theory/surface-table.md]
Takes about a quarter of an hour of one free core for 200 surfaces. Each surface is drawn
by its number alone: H = 3 - D uniform in 0.3 .. 0.9; side 256 (half of them), 512, 1024 or 2048 points; and, each with
even odds, a lay (stretch 2, any direction), white noise of 1 % of Rq, a tilt of ten times Rq over the side, 5 % of the
points missing. Surfaces are cut from periodic Gaussian ones of twice the side. Rows found in FILE.jsonl are not
computed again.

SurfaceTopography (power spectrum of the area, Hann window, straight line in the logarithms over the same band) runs in
this process; fracDimPy (GPL) in one of its own, at 256 points; both come with `--group peers`.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from faying.errors import FayingError
from faying.surface.estimators.table import METHODS
from faying.surface.form import prepared
from faying.surface.fractal import fit_fractal
from faying.surface.scan import Scan
from faying.surface.synthesize import spectral
from tests.helpers.imperfect import with_missing, with_noise

SIZES = (256, 512, 1024, 2048)
SHARES = (0.5, 0.35, 0.12, 0.03)
FRACDIMPY = """
import json, sys, warnings
warnings.simplefilter("ignore")
import numpy as np
import fracDimPy
z = np.load(sys.argv[1])
out = {}
for name, call in (("variogram", lambda: fracDimPy.variogram_method(z, dimension_type="surface")),
                   ("box", lambda: fracDimPy.box_counting(z, data_type="surface"))):
    try:
        out[name] = float(call()[0])
    except Exception:
        out[name] = None
print("RESULT" + json.dumps(out))
"""


def surface(number: int) -> tuple[Scan, float, float, int, tuple[str, ...]]:
    """Return surface `number`, its D, G [m], side in points, and what was done to it."""
    rng = np.random.default_rng([20260101, number])
    D = 3 - rng.uniform(0.3, 0.9)
    side = int(rng.choice(SIZES, p=SHARES))
    G = 10 ** rng.uniform(-11, -8)
    what = [name for name in ("lay", "noise", "tilt", "missing") if rng.random() < 0.5]
    lay = (rng.uniform(0, np.pi), 2.0) if "lay" in what else None
    scan = spectral((side, side), spacing=1e-6, D=D, G=G, lay=lay, seed=rng)
    rq = float(scan.heights.std())
    if "tilt" in what:
        scan = scan.with_heights(scan.heights + 10 * rq * np.linspace(0, 1, side)[None, :])
    if "noise" in what:
        scan = with_noise(scan, rms=0.01 * rq, seed=number)
    if "missing" in what:
        scan = with_missing(scan, share=0.05, seed=number)
    return scan, D, G, side, tuple(what)


def ours(scan: Scan, D: float, G: float, method: str) -> dict[str, Any] | None:
    """Error of D, its interval, and how G fared; None where the method refuses."""
    try:
        fit = fit_fractal(scan, method)
    except FayingError:
        return None
    low, high = fit.D_interval
    return {
        "error": fit.D - D,
        "half": (high - low) / 2,
        "D_in": bool(low <= D <= high),
        "G_in": bool(fit.G_interval[0] <= G <= fit.G_interval[1]),
        "G_ratio": fit.G / G if np.isfinite(fit.G) else None,
        "G_factor": (fit.G_interval[1] / max(fit.G_interval[0], 1e-300)) ** 0.5,
    }


def peers(scan: Scan, D: float, side: int) -> dict[str, Any]:
    """Errors of D by SurfaceTopography and fracDimPy on the same levelled, filled heights."""
    ready = prepared(scan).scan
    out: dict[str, Any] = {}
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        from SurfaceTopography import Topography

        length = side * scan.spacing[0]
        topography = Topography(ready.heights.T, (length, length), unit="m")
        q, power = topography.power_spectrum_from_area(window="hann", nb_points_per_decade=10)
    f = q / (2 * np.pi)
    use = np.isfinite(power) & (power > 0) & (f >= 6 / length) & (f <= 0.25 / scan.spacing[0])
    out["SurfaceTopography PSD"] = {"error": float(4 + np.polyfit(np.log(f[use]), np.log(power[use]), 1)[0] / 2 - D)}
    if side == SIZES[0]:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "z.npy"
            np.save(path, ready.heights / ready.heights.std())
            done = subprocess.run(
                [sys.executable, "-c", FRACDIMPY, str(path)], capture_output=True, text=True, check=False
            )
        for line in done.stdout.splitlines():
            if line.startswith("RESULT"):
                for name, value in json.loads(line[6:]).items():
                    if value is not None:
                        out[f"fracDimPy {name}"] = {"error": value - D}
    return out


def row(number: int, beside: int) -> dict[str, Any]:
    """Everything about one surface; other packages for the first `beside` surfaces only."""
    scan, D, G, side, what = surface(number)
    fits: dict[str, Any] = {m: ours(scan, D, G, m) for m in METHODS}
    if number >= beside:
        return {"number": number, "D": D, "G": G, "side": side, "what": what, "fits": fits}
    return {"number": number, "D": D, "G": G, "side": side, "what": what, "fits": fits | peers(scan, D, side)}


def table(rows: list[dict[str, Any]]) -> str:
    """Markdown table over all rows, and one of PSD by side and treatment."""
    names = [*METHODS, "SurfaceTopography PSD", "fracDimPy variogram", "fracDimPy box"]
    head = "| estimator | surfaces | bias of D | spread of D | coverage of D | median half-width | coverage of G |\n"
    head += "|---|---:|---:|---:|---:|---:|---:|\n"
    lines = [line(name, [r["fits"].get(name) for r in rows]) for name in names]
    text = f"All {len(rows)} surfaces\n\n" + head + "\n".join(x for x in lines if x) + "\n"
    groups = [(f"side {s}", [r for r in rows if r["side"] == s]) for s in SIZES]
    for kind in ("lay", "noise", "tilt", "missing"):
        groups += [(f"with {kind}", [r for r in rows if kind in r["what"]])]
        groups += [(f"without {kind}", [r for r in rows if kind not in r["what"]])]
    groups += [(f"D {a} .. {b}", [r for r in rows if a <= r["D"] < b]) for a, b in ((2.1, 2.3), (2.3, 2.5), (2.5, 2.7))]
    parts = [line(label, [r["fits"].get("psd") for r in part]) for label, part in groups if part]
    text += "\npsd\n\n" + head.replace("estimator", "surfaces of") + "\n".join(x for x in parts if x) + "\n"
    return text


def line(name: str, fits: list[dict[str, Any] | None]) -> str:
    """One line of the table."""
    good = [f for f in fits if f]
    if not good:
        return ""
    e = np.array([f["error"] for f in good])
    text = f"| {name} | {len(good)} | {e.mean():+.4f} +- {e.std() / len(e) ** 0.5:.4f} | {e.std():.4f} |"
    if "D_in" not in good[0]:
        return text + " | | |"
    d, g = (100 * np.mean([f[k] for f in good]) for k in ("D_in", "G_in"))
    return text + f" {d:.0f} % | {np.median([f['half'] for f in good]):.3f} | {g:.0f} % |"


def main() -> None:
    """Compute the rows that are lacking, then write the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--beside", type=int, default=80, help="surfaces that the other packages see")
    parser.add_argument("--rows", type=Path, default=Path("surface_table.jsonl"))
    parser.add_argument("--output", type=Path)
    given = parser.parse_args()
    rows = [json.loads(text) for text in given.rows.read_text().splitlines()] if given.rows.exists() else []
    have = {r["number"] for r in rows}
    for number in range(given.count):
        if number not in have:
            rows.append(row(number, given.beside))
            with given.rows.open("a") as handle:
                handle.write(json.dumps(rows[-1]) + "\n")
    text = table(sorted((r for r in rows if r["number"] < given.count), key=lambda r: int(r["number"])))
    if given.output:
        given.output.write_text(text)
    print(text)


if __name__ == "__main__":
    main()
