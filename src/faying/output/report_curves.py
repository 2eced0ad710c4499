"""Curves of a report's page, which readers zoom into."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from faying.output.scene.text import packed_backbones, packed_curves
from faying.result import Result
from faying.result.backbone import ROUNDING, Backbone, label
from faying.result.response_figure import words
from faying.units import in_mm

MAX_PAIRS = 12  # of output and input
POINTS = 200  # of a backbone
AROUND = 1.05  # room beside measured points, as a factor of the acceleration


def response_curves(result: Result) -> list[dict[str, Any]]:
    """Accelerance of the first pairs of output and input at every preload, for curves in a page."""
    found = result.response
    assert found is not None
    loads = list(result.load_names)
    accelerance = -((2 * np.pi * found.frequencies) ** 2)[None, :, None, None] * found.values
    return [
        packed_curves(
            f"{words(*found.outputs[o])} / {words(*found.inputs[i])}",
            "|accelerance| [m/s²/N]",
            found.frequencies,
            dict(zip(loads, accelerance[:, :, o, i], strict=True)),
        )
        for o, i in list(np.ndindex(*found.values.shape[2:]))[:MAX_PAIRS]
    ]


def backbone_curves(curves: Sequence[Backbone]) -> dict[str, Any]:
    """Curves of one mode for a page: on one grid of accelerations, none beyond its own end."""
    low = max(curve.acceleration[0] for curve in curves)
    grid = np.geomspace(low, max(curve.acceleration[-1] for curve in curves), POINTS)
    measured, marked = curves[0].measured, ""
    if measured is not None:
        ends = measured.acceleration.min() / AROUND, measured.acceleration.max() * AROUND
        grid = np.unique(np.concatenate([grid, measured.acceleration, ends]))
    found = {}
    for curve in curves:
        inside = (grid >= low) & (grid <= curve.acceleration[-1] * (1 + 1e-9))
        frequency, damping = (np.full(len(grid), np.nan) for _ in range(2))
        frequency[inside], damping[inside] = curve.at_acceleration(grid[inside])
        damping[damping < ROUNDING * curve.damping.max()] = np.nan  # nothing slips yet
        found[label(curve, curves)] = (frequency, 100 * damping)
    if measured is not None:
        place = np.searchsorted(grid, measured.acceleration)
        frequency, damping = (np.full(len(grid), np.nan) for _ in range(2))
        frequency[place], damping[place] = measured.frequency, 100 * measured.damping
        marked = f"measured ({measured.source})"
        found[marked] = (frequency, damping)
    return packed_backbones(f"acceleration at {in_mm(curves[0].at)} [m/s²]", grid, found, marked)
