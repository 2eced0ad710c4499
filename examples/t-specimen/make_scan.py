"""Write milled.x3p: a synthetic scan of a milled faying surface, 4 x 4 mm, Ra 0.8 um, spacing 5 um.

The paper (doi:10.3390/fractalfract8100611) measured its specimen with a 5 um step over 4 x 4 mm and found D = 2.39 and
Ra 0.8 um; the scan itself is not published. This one has the same size, step, Ra and D: a fractal part of D = 2.39 at
all wavelengths, and feed marks of a face mill (arcs 0.8 mm apart) that carry a tenth of the mean square. G follows
from D and Ra; the paper's G = 1.53e-10 m would mean an rms of 3.3 um and does not fit Ra 0.8 um.

Run: python examples/t-specimen/make_scan.py [FILE]
"""

import sys
from pathlib import Path

import numpy as np

from faying.surface.convention import G_from_Rq
from faying.surface.files.write import write_scan
from faying.surface.form import levelled
from faying.surface.fractal import fit_fractal
from faying.surface.scan import Scan
from faying.surface.synthesize import spectral

D, RA, SIDE, POINTS, SEED = 2.39, 0.8e-6, 4e-3, 800, 1
FEED, CUTTER, MARKS = 0.8e-3, 31.5e-3, 0.1  # distance of the marks, cutter radius, their share of the mean square


def milled() -> tuple[Scan, float]:
    """Return the scan and the G [m] of its fractal part."""
    step = SIDE / POINTS
    G = G_from_Rq(D, 1e-6, SIDE)
    fractal = spectral((POINTS, POINTS), spacing=step, D=D, G=G, seed=SEED).heights
    x = (np.arange(POINTS) + 0.5) * step
    # the tool leaves grooves along arcs of the cutter's radius
    position = x[None, :] + (x[:, None] - SIDE / 2) ** 2 / (2 * CUTTER)
    groove = np.cos(2 * np.pi * position / FEED)
    z = fractal + groove / groove.std() * fractal.std() * (MARKS / (1 - MARKS)) ** 0.5
    scan = levelled(Scan(heights=z, spacing=(step, step)))
    factor = RA / float(np.abs(scan.heights).mean())
    # heights times s mean G^(D-2) times s
    rough = Scan(heights=scan.heights * factor, spacing=(step, step), source="synthetic milled surface")
    return rough, G * factor ** (1 / (D - 2))


def main() -> None:
    """Write the scan and print what was put in and what is found again."""
    path = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(__file__).with_name("milled.x3p")
    scan, G = milled()
    write_scan(scan, path, precision="I")
    print(f"{path}: {path.stat().st_size / 1e6:.2f} MB, put in: D {D}, G {G:.4g} m, Ra {RA * 1e6} um")
    for method in ("psd", "structure"):
        fit = fit_fractal(scan, method)
        low, high = fit.D_interval
        print(
            f"  {method}: D {fit.D:.3f} ({low:.3f} .. {high:.3f}), G {fit.G:.3g} m "
            f"({fit.G_interval[0]:.3g} .. {fit.G_interval[1]:.3g}), Rq {fit.Rq:.3g} m, implied {fit.implied_Rq:.3g} m"
        )


if __name__ == "__main__":
    main()
