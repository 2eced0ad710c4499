"""Mode 1 of the Brake-Reuss beam with one slider for each measured asperity, in place of the law's own microslip.

Run `python benchmarks/asperity_sliders.py flat|measured-form`; minutes. Every asperity that touches under the preload
is one spring, which springs back as it does after yielding, with one slider: it holds without loss until it slides as a
whole, as in the published model (doi:10.1016/j.ymssp.2023.110210). Those that first touch in motion are left out.
Everything else is that of `faying backbone`. docs/backbone.md quotes the rows beside those of the law's own curve.
"""

import sys
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

import faying
from faying.contact.models.measured_heights import MeasuredHeights
from faying.joint.joint_law import JointLaw
from faying.microslip.microslip import Microslip
from faying.typing import Array

EXAMPLE = Path(__file__).parents[1] / "examples" / "brake-reuss-beam"
CLASSES = 60  # of asperities alike, by their gap
LEVELS = 1.0, 3.0, 10.0, 20.0, 40.0, 59.5  # m/s2
FRICTION, VISCOUS, RANGE = 0.03, 0.00087, (0.3, 60.0)


def asperities(law: JointLaw, approach: Array, *, friction: float, gap: Array | None) -> Microslip:
    """One spring for each class of asperities at each point (q,), whose sum is the pressure there."""
    model = law.model
    assert isinstance(model, MeasuredHeights)
    p, _ = law.pressure(np.asarray(approach))
    w = np.geomspace(*model.closure_range, 2000)
    known = np.interp(np.log(np.maximum(p, 1.0)), np.log(model._pressure_at(w)), np.log(w))
    closing = np.where(p > 0, np.exp(known), 0.0)
    g, density = np.asarray(model.gaps) - model._touch, np.asarray(model.probability)
    share = np.concatenate([[0.0], np.cumsum(np.diff(g) * (density[1:] + density[:-1]) / 2)])
    # classes of one share each of the asperities that touch at a point
    middle = (np.arange(CLASSES) + 0.5) / CLASSES
    touching = np.interp(closing, g, share)
    at = np.interp(touching[:, None] * middle, share, g)
    depth = np.maximum(closing[:, None] - at, 0.0)
    number = model.density * touching[:, None] / CLASSES
    some = np.maximum(depth, 1e-15)
    force = number * model._asperity.at(some).force
    k_n = number * 2 * model.pair.E_star * np.sqrt(model.radius * some)
    k_t = number * 8 * model.pair.G_star * np.sqrt(model.radius * some)
    total = force.sum(axis=1, keepdims=True)
    force *= np.where(total > 0, p[:, None] / np.where(total > 0, total, 1.0), 0.0)
    closed = (p > 0)[:, None]
    onset = np.asarray(approach)[:, None] - np.where(closed, force / k_n, -1.0)
    stiffness = {"k_n": np.where(closed, k_n, 0.0), "k_t": np.where(closed, k_t, 0.0)}
    return Microslip(onset=onset, **stiffness, friction=friction, gap=np.zeros(len(p)) if gap is None else gap)


def main(name: str) -> None:
    """Print fall of the frequency and damping at the published levels."""

    def cut(law: JointLaw, approach: Array, *, springs: int = 0, **options: Any) -> Microslip:
        del springs  # as many as there are classes
        return asperities(law, approach, **options)

    with patch.object(Microslip, "cut", cut):
        curve = faying.backbone(EXAMPLE / f"{name}.toml", 1, FRICTION, RANGE, rest_damping=VISCOUS)
    print(f"{name}: {curve.linear_frequency:.3f} Hz at rest; ends: {curve.reason}")
    for level in LEVELS:
        if level <= curve.acceleration[-1]:
            f, z = (float(x) for x in curve.at_acceleration(level))
            print(f"{level:6.4g} m/s2: {100 * (1 - f / curve.linear_frequency):6.3f} % down, {100 * z:6.4f} %")


if __name__ == "__main__":
    main(sys.argv[1])
