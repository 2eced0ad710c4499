"""Find dimensions of the T-specimen from the five test frequencies at 4 kN, by least squares within bounds.

Identified: height and thickness of the stems, how far the flanges stand out beyond them, thickness of the flanges. Chosen, not identified: the width
(bending across the thin side of the stems hardly depends on it) and the bolts. The joint lowers each frequency a little
below that of a specimen in one piece; the ratio comes from a run of the study and is renewed until it settles.
Not used here: the rows at 8 and 12 kN and everything the paper computed. They are predictions of the study.

Run: uv run --extra pardiso python examples/t-specimen/identify.py (some minutes). It prints the dimensions, which
make_geometry.py carries rounded to 0.1 mm.
"""

import json
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from make_geometry import HERE, Dimensions, write
from scipy.optimize import least_squares

import faying
from faying.fe.elasticity import assemble
from faying.fe.geometry import mesh_step
from faying.fe.modes import lowest_modes
from faying.joint.structure import tie
from faying.study import Study

TEST = np.array([406.0, 1126.0, 2145.0, 3249.0, 4700.0])  # Hz at 4 kN, Table 3
NAMES = ("stem_height", "stem_thickness", "wing", "flange_thickness")
BOUNDS = np.array([[150.0, 14.0, 24.0, 18.0], [400.0, 60.0, 60.0, 45.0]])  # mm
START = np.array([290.0, 34.0, 30.0, 25.0])
MODES = 18


def dimensions(x: np.ndarray) -> Dimensions:
    """The wing is what the flange stands out beyond the stem; the bolt sits in its middle."""
    height, thickness, wing, flange = map(float, x)
    return replace(Dimensions(), stem_height=height, stem_thickness=thickness, flange_length=thickness + 2 * wing,
                   flange_thickness=flange, bolt_distance=thickness + wing)  # fmt: skip


def bending_in_one_piece(d: Dimensions) -> np.ndarray:
    """First five frequencies [Hz] that move the end of the upper stem across its thin side, both T's grown together."""
    with tempfile.TemporaryDirectory() as folder:
        step = Path(folder) / "t.step"
        write(step, d)
        mesh = mesh_step(step, size=20e-3)
    steel = faying.CATALOGUE["45 steel"]
    K, M = assemble(mesh, dict.fromkeys(mesh.parts, steel))
    grown = tie(mesh, [("upper.joint", "lower.joint")])
    found = lowest_modes((grown.T @ K @ grown).tocsr(), (grown.T @ M @ grown).tocsr(), MODES, shift_frequency=200.0)
    top = np.array([d.stem_thickness / 2, 0.0, d.stem_height + d.flange_thickness]) * 1e-3
    node = int(np.argmin(np.linalg.norm(mesh.points - top, axis=1)))
    motion = np.abs((grown @ found.shapes)[3 * node, 6:])
    return found.frequencies[6:][motion > 0.1 * motion.max()][:5]


def joint_ratio(d: Dimensions) -> np.ndarray:
    """Predicted over grown-together frequency of the five modes at 4 kN."""
    with tempfile.TemporaryDirectory() as folder:
        step = Path(folder) / "t.step"
        write(step, d)
        study = Study.read(HERE / "study.toml")
        test = replace(study.test, frequencies=study.test.frequencies[:1], published=None,
                       points=((d.stem_thickness / 2e3, 0.0, (d.stem_height + d.flange_thickness) / 1e3),))  # fmt: skip
        bolts = tuple(replace(b, preload=b.preload[:1]) for b in study.bolts)
        result = faying.run(replace(study, geometry=replace(study.geometry, step=step), test=test, bolts=bolts))
    c = result.comparison
    return c.predicted[0] / result.tied[c.modes[0]]


def main() -> None:
    x = START
    ratio = np.ones(5)
    for _ in range(2):
        fit = least_squares(
            lambda v: np.log(bending_in_one_piece(dimensions(v)) * ratio / TEST),  # noqa: B023
            x, bounds=BOUNDS, x_scale=x, diff_step=0.02, xtol=1e-4, ftol=1e-6, max_nfev=8,
        )  # fmt: skip
        x = fit.x
        fresh = joint_ratio(dimensions(x))
        print(json.dumps({"mm": dict(zip(NAMES, x.round(2), strict=True)), "misfit %": (100 * fit.fun).round(2).tolist(),
                          "joint ratio": fresh.round(4).tolist(), "at bounds": fit.active_mask.tolist()}), flush=True)  # fmt: skip
        if np.abs(fresh / ratio - 1).max() < 1e-3:
            break
        ratio = fresh


if __name__ == "__main__":
    sys.exit(main())
