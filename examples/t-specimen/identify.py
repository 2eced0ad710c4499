"""Find dimensions and form of the T-specimen from its test frequencies at 4 and 8 kN, by least squares within bounds.

Identified: height and thickness of the stems, how far the flanges stand out beyond them, thickness of the flanges, and
the crown of the flanges across, negative where they are hollow; five numbers from ten frequencies, under the study's
default law. A crown along the flanges in place of that fits the same rows less well. The dimensions lie in a valley: a
shorter wing with a thicker flange fits nearly as well, and the search may end there on a bound.
Chosen, not identified: the width (bending across the thin side of the stems hardly depends on it), holes and washers,
the bolts in the middle of what stands out. Not used: the row at 12 kN, and everything that the paper computed.

The model misses each mode by some percent at every load alike, for the real shape is not known; from one load to the
next the test is far more exact. So the mean error of a mode over both loads counts in units of MODEL_ERROR, and what
changes between the loads in units of TEST_ERROR.

Least squares run on a plane-stress model of the two T's grown together, which takes a moment. What it leaves out (the
joint with its form, the third dimension, the holes) is the ratio of the study's frequencies to its own: computed for
the dimensions found at two crowns, and put back into the model until dimensions and crown rest.

Run: uv run --extra pardiso python examples/t-specimen/identify.py (some minutes). It prints the dimensions, which
make_geometry.py carries rounded to 0.1 mm, and the crown, which study.toml carries.
"""

import json
import sys
import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import skfem
from make_geometry import HERE, Dimensions, write
from scipy.optimize import least_squares
from scipy.sparse.linalg import eigsh
from skfem.helpers import ddot, dot, eye, sym_grad, trace

import faying
from faying.joint.form import Form
from faying.study import Study

STUDY = Study.read(HERE / "study.toml")
TEST = np.array(STUDY.test.frequencies[:2])  # Hz at 4 and 8 kN, Table 3
MODEL_ERROR, TEST_ERROR = 0.02, 0.002  # of a frequency: 5 Hz in 2145, as the test is rounded
NAMES = ("stem height", "stem thickness", "wing", "flange thickness")
# mm. A flange thinner than 25 would bend away from its bolts; a wing under 30 leaves an M8 washer no room
BOUNDS = np.array([[150.0, 14.0, 30.0, 25.0], [400.0, 60.0, 60.0, 45.0]])
START = np.array([364.7, 51.2, 33.8, 26.6])
CROWN, CROWN_STEP = -3.0, 0.5  # um: where the search starts, and between the two crowns that are computed
MOST_CROWN, MOST_STEP = 40.0, 1.5  # um: bound, and how far one round may move it
STEEL = faying.CATALOGUE["45 steel"]


def dimensions(x: np.ndarray) -> Dimensions:
    """The wing is what the flange stands out beyond the stem on each side; the bolt sits in its middle."""
    height, thickness, wing, flange = map(float, x)
    return replace(
        Dimensions(),
        stem_height=height,
        stem_thickness=thickness,
        flange_length=thickness + 2 * wing,
        flange_thickness=flange,
        bolt_distance=thickness + wing,
    )


def in_plane(d: Dimensions) -> np.ndarray:
    """First five elastic frequencies [Hz] of both T's in one piece, plane stress, biquadratic elements."""
    half, arm, flange, top = (
        d.stem_thickness / 2,
        d.flange_length / 2,
        d.flange_thickness,
        d.flange_thickness + d.stem_height,
    )
    x = np.concatenate([np.linspace(-arm, -half, 4), np.linspace(-half, half, 4)[1:], np.linspace(half, arm, 4)[1:]])
    side = np.concatenate([np.linspace(0, flange, 4), np.linspace(flange, top, 25)[1:]])
    mesh = skfem.MeshQuad.init_tensor(x * 1e-3, np.concatenate([-side[:0:-1], side]) * 1e-3)
    centre = mesh.p[:, mesh.t].mean(axis=1) * 1e3
    mesh = mesh.remove_elements(np.flatnonzero((np.abs(centre[0]) > half) & (np.abs(centre[1]) > flange)))
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementQuad2()))
    mu, lam = STEEL.G, STEEL.E * STEEL.nu / (1 - STEEL.nu**2)

    @skfem.BilinearForm
    def stiffness(u, v, _):
        e = sym_grad(u)
        return ddot(2 * mu * e + lam * eye(trace(e), 2), sym_grad(v))

    @skfem.BilinearForm
    def mass(u, v, _):
        return STEEL.density * dot(u, v)

    values = eigsh(stiffness.assemble(basis), k=9, M=mass.assemble(basis), sigma=-1e6, return_eigenvectors=True)
    order = np.argsort(values[0])
    found, shapes = np.sqrt(np.abs(values[0][order])) / (2 * np.pi), values[1][:, order]
    across = np.array([np.sum(s[basis.get_dofs(elements=True).all("u^1")] ** 2) for s in shapes.T])
    along = np.array([np.sum(s[basis.get_dofs(elements=True).all("u^2")] ** 2) for s in shapes.T])
    return found[(found > 1) & (across > 0.3 * along)][:5]


def in_study(d: Dimensions, crown: float) -> np.ndarray:
    """The study's five frequencies [Hz] (2, 5) at both loads with a crown [um]."""
    with tempfile.TemporaryDirectory() as folder:
        step = Path(folder) / "t.step"
        write(step, d)
        end = (d.stem_thickness / 2e3, 0.0, (d.stem_height + d.flange_thickness) / 1e3)
        test = replace(STUDY.test, frequencies=STUDY.test.frequencies[:2], published=None, points=(end,))
        bolts = tuple(replace(b, preload=b.preload[:2]) for b in STUDY.bolts)
        joints = (replace(STUDY.joints[0], form=Form(crown_across=crown * 1e-6)),)
        geometry = replace(STUDY.geometry, step=step)
        result = faying.run(replace(STUDY, geometry=geometry, joints=joints, bolts=bolts, test=test, beside=()))
    return result.comparison.predicted


def misfit(x: np.ndarray, ratio: np.ndarray, growth: np.ndarray, crown: float) -> np.ndarray:
    """Mean and change of ln(model over test) of each mode, in units of what they may be wrong by.

    x: dimensions [mm] and crown [um]; ratio (2, 5): ln study over plane model at `crown`; growth: of that per um.
    """
    error = np.log(in_plane(dimensions(x[:4]))) + ratio + growth * (x[4] - crown) - np.log(TEST)
    return np.concatenate([error.mean(axis=0) / MODEL_ERROR, (error[1] - error[0]) / TEST_ERROR])


def main() -> None:
    """Alternate between the plane model and the study until dimensions and crown rest."""
    x = np.append(START, CROWN)
    for _ in range(8):
        plane = np.log(in_plane(dimensions(x[:4])))
        found, further = (in_study(dimensions(x[:4]), x[4] + step) for step in (0.0, CROWN_STEP))
        ratio, growth = np.log(found) - plane, np.log(further / found) / CROWN_STEP
        near = np.clip([x[4] - MOST_STEP, x[4] + MOST_STEP], -MOST_CROWN, MOST_CROWN)
        bounds = np.column_stack([BOUNDS, near])
        start = np.clip(x, bounds[0] + 1e-3, bounds[1] - 1e-3)
        fit = least_squares(
            misfit,
            start,
            args=(ratio, growth, x[4]),
            bounds=bounds,
            x_scale=np.append(START, abs(CROWN)),
            diff_step=1e-3,
        )
        print(
            json.dumps(
                {
                    "mm": dict(zip(NAMES, x[:4].round(2).tolist(), strict=True)),
                    "crown um": round(float(x[4]), 2),
                    "error % at 4 and 8 kN": (100 * (found / TEST - 1)).round(2).tolist(),
                    "at bounds": fit.active_mask.tolist(),
                    "next": fit.x.round(2).tolist(),
                }
            ),
            flush=True,
        )
        moved, x = np.abs(fit.x / x - 1), (x + fit.x) / 2  # halfway, so that it does not swing
        if moved[:4].max() < 5e-3 and moved[4] < 0.05:
            break


if __name__ == "__main__":
    sys.exit(main())
