"""Find dimensions of the T-specimen from its test frequencies, by least squares within bounds.

Identified: height and thickness of the stems, how far the flanges stand out beyond them, thickness of the flanges; four
numbers from what five modes have in the mean over all three loads, under the study's default law and with the waves
that its process leaves. Nothing is fitted to what changes between the loads: the faces have the waves that the study
says, drawn at random. The dimensions lie in a valley: a shorter wing with a thicker flange fits nearly as well, and the
search may end there on a bound.
Chosen, not identified: the width (bending across the thin side of the stems hardly depends on it), holes and washers,
the bolts in the middle of what stands out. Not used: everything that the paper computed.

Least squares run on a plane-stress model of the two T's bonded, which takes a moment. What it leaves out (the
joint, the third dimension, the holes) is the ratio of the study's frequencies to its own: computed for the dimensions
found, and put back into the model until they rest.

Run: uv run --extra pardiso python examples/t-specimen/identify.py (some minutes). It prints the dimensions, which
make_geometry.py carries rounded to 0.1 mm.
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
from faying.study import Study

STUDY = Study.read(HERE / "study.toml")
TEST = np.array(STUDY.test.frequencies)  # Hz, Table 3
NAMES = ("stem height", "stem thickness", "wing", "flange thickness")
# mm. A flange thinner than 25 would bend away from its bolts; a wing under 30 leaves an M8 washer no room
BOUNDS = np.array([[150.0, 14.0, 30.0, 25.0], [400.0, 60.0, 60.0, 45.0]])
START = np.array([364.7, 51.2, 33.8, 26.6])
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


def in_study(d: Dimensions) -> np.ndarray:
    """The study's five frequencies [Hz] (3, 5) at all loads."""
    with tempfile.TemporaryDirectory() as folder:
        step = Path(folder) / "t.step"
        write(step, d)
        end = (d.stem_thickness / 2e3, 0.0, (d.stem_height + d.flange_thickness) / 1e3)
        test = replace(STUDY.test, published=None, points=(end,))
        geometry = replace(STUDY.geometry, step=step)
        result = faying.run(replace(STUDY, geometry=geometry, test=test, alternatives=()))
    return result.comparison.predicted


def misfit(x: np.ndarray, ratio: np.ndarray) -> np.ndarray:
    """Mean over the loads of ln(model over test) of each mode.

    x: dimensions [mm]; ratio (3, 5): ln study over plane model.
    """
    return (np.log(in_plane(dimensions(x))) + ratio - np.log(TEST)).mean(axis=0)


def main() -> None:
    """Alternate between the plane model and the study until the dimensions rest."""
    x = START
    for _ in range(8):
        plane = np.log(in_plane(dimensions(x)))
        found = in_study(dimensions(x))
        start = np.clip(x, BOUNDS[0] + 1e-3, BOUNDS[1] - 1e-3)
        fit = least_squares(misfit, start, args=(np.log(found) - plane,), bounds=BOUNDS, x_scale=START, diff_step=1e-3)
        error = np.log(found / TEST).mean(axis=0)
        print(
            json.dumps(
                {
                    "mm": dict(zip(NAMES, x.round(2).tolist(), strict=True)),
                    "error % in the mean over the loads": (100 * error).round(2).tolist(),
                    "sum of squares, half": round(0.5 * float(error @ error) * 1e4, 3),
                    "at bounds": fit.active_mask.tolist(),
                    "next": fit.x.round(2).tolist(),
                }
            ),
            flush=True,
        )
        moved, x = np.abs(fit.x / x - 1), (x + fit.x) / 2  # halfway, so that it does not swing
        if moved.max() < 5e-3:
            break


if __name__ == "__main__":
    sys.exit(main())
