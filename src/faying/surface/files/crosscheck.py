"""A second opinion on a file: other readers, each in a process of its own, compared in points, spacing and heights.

The processes keep readers of other licences (surfalize is GPL) out of this program, and a reader's crash out of it.
"""

import json
import subprocess
import sys
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Any, final

import numpy as np

from faying.errors import InputError
from faying.surface.heights import steps_of
from faying.surface.scan import Profile, Scan

# each prints points (ny, nx), spacing (dx, dy) [m] and the standard deviation of the heights as read [m]
_TAIL = """
z = np.asarray(z, float)
print(json.dumps({"points": list(z.shape), "spacing": spacing, "deviation": float(np.nanstd(z))}))
"""
_READERS = {
    "surfalize": """
import json, sys, warnings
warnings.simplefilter("ignore")
import numpy as np, surfalize
s = surfalize.Surface.load(sys.argv[1])
z = np.asarray(s.data, float) * 1e-6
spacing = [float(s.step_x) * 1e-6, float(s.step_y) * 1e-6]
""",
    "SurfaceTopography": """
import json, sys, warnings
warnings.simplefilter("ignore")
import numpy as np
from SurfaceTopography import read_topography
t = read_topography(sys.argv[1]).to_unit("m")
z = np.ma.filled(np.ma.asarray(t.heights(), float), np.nan).T
spacing = [float(s) / n for s, n in zip(t.physical_sizes, t.nb_grid_pts)]
""",
    "numpy": """
import json, sys
import numpy as np
d = np.loadtxt(sys.argv[1], delimiter=",")
x, y = np.unique(d[:, 0]), np.unique(d[:, 1])
xy, h = float(sys.argv[2]), float(sys.argv[3])
spacing = [float(np.ptp(x)) / (len(x) - 1) * xy, float(np.ptp(y)) / (len(y) - 1) * xy]
z = d[np.lexsort((d[:, 0], d[:, 1])), 2].reshape(len(y), len(x)) * h
""",
}


@final
@dataclass(frozen=True, kw_only=True)
class Opinion:
    """What another reader makes of the file: agreement, or the differences (or its failure) in words."""

    reader: str
    agrees: bool | None
    text: str


def cross_check(
    scan: Scan | Profile, path: str | Path, xy_unit: str | None = None, z_unit: str | None = None
) -> list[Opinion]:
    """Read `path` by every other reader at hand and compare with `scan` (as returned by read_scan for that path).

    Readers: surfalize where installed, SurfaceTopography for X3P (all other formats come through it in the first
    place), NumPy for x,y,z text. `agrees` is None where the reader does not know the format. Points must be equal,
    spacings within 0.1 %, the heights' standard deviation within 1 %.
    Raises InputError where no other reader is installed.
    """
    from faying.units import scale

    with open(path, "rb") as handle:
        ours = handle.read(2) == b"PK"  # X3P is read by our own code, so SurfaceTopography is a second reader there
    others = ("surfalize", "SurfaceTopography") if ours else ("surfalize",)
    names = [name for name in others if find_spec(name) is not None]
    extra: list[str] = []
    if xy_unit is not None and z_unit is not None:
        names = ["numpy"]
        extra = [repr(scale(xy_unit, "m")), repr(scale(z_unit, "m"))]
    if not names:
        raise InputError(
            "no second reader is installed to check the file with; install SurfaceTopography (pip install "
            "SurfaceTopography) or surfalize"
        )
    return [_ask(name, scan, str(path), extra) for name in names]


def _ask(name: str, scan: Scan | Profile, path: str, extra: list[str]) -> Opinion:
    try:
        done = subprocess.run(
            [sys.executable, "-c", _READERS[name] + _TAIL, path, *extra],
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as fault:
        return Opinion(reader=name, agrees=None, text=f"could not be run ({type(fault).__name__})")
    if done.returncode != 0:
        last = done.stderr.strip().splitlines()
        return Opinion(reader=name, agrees=None, text=f"cannot read it ({last[-1][:99] if last else 'no reason'})")
    return compare(name, scan, json.loads(done.stdout.strip().splitlines()[-1]))


def compare(name: str, scan: Scan | Profile, seen: dict[str, Any]) -> Opinion:
    """Compare a reader's points, spacing [m] and standard deviation of heights [m] with the scan's."""
    faults = []
    own = list(scan.heights.shape)
    if seen["points"] != own:
        faults.append(f"points {seen['points']} against {own}")
    faults += [
        f"spacing {theirs:.6g} m against {ours:.6g} m"
        for theirs, ours in zip(seen["spacing"], steps_of(scan)[::-1], strict=False)
        if abs(theirs / ours - 1) > 1e-3
    ]
    deviation = float(np.nanstd(scan.heights))
    ratio = seen["deviation"] / deviation if deviation > 0 else float("inf")
    if not 0.99 < ratio < 1.01:
        faults.append(f"heights {ratio:.4g} times ours (deviation {seen['deviation']:.4g} m against {deviation:.4g} m)")
    return Opinion(reader=name, agrees=not faults, text="; ".join(faults) or "agrees in points, spacing and heights")
