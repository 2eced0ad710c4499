"""The figures of load cases: pressure on a joint under each of them, and where it opens."""

from typing import Any

import numpy as np

from faying.joint.figure import in_plane, painted_points
from faying.loads.record import LoadCases
from faying.style import WIDE, drawing, new_panels

MAX_PANELS = 12  # the preload, and cases
COLUMNS = 3
SMALL = 0.2  # size of the points of small panels, against those of one


@drawing
def figure(found: LoadCases, joint: int = 0) -> Any:
    """Return the figure of the pressure on a joint, counted from 0, under the preload and under each case."""
    cases: list[int | None] = [None, *range(min(len(found.cases), MAX_PANELS - 1))]
    columns = min(COLUMNS, len(cases))
    fig = new_panels(columns, -(-len(cases) // columns), width=WIDE / COLUMNS, height=2.1)
    for ax in fig.axes[len(cases) :]:
        ax.set_visible(False)
    shown = fig.axes[: len(cases)]
    maps = [found.face(case, joint, size=SMALL) for case in cases]
    flat = 1e3 * in_plane(maps[0].places)[0]
    room = 0.04 * np.ptp(flat, axis=0)
    low, high = flat.min(axis=0) - room, flat.max(axis=0) + room
    for number, (ax, drawn) in enumerate(zip(shown, maps, strict=True)):
        painted = painted_points(drawn, ax)
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        ax.set_xlabel(ax.get_xlabel() if number + columns >= len(cases) else "")
        ax.set_ylabel(ax.get_ylabel() if number % columns == 0 else "")
    fig.colorbar(painted, ax=fig.axes, label="pressure [MPa]", location="bottom", shrink=0.5, aspect=40)
    return fig
