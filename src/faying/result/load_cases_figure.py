"""The figures of load cases: pressure on a joint under each of them, and where it opens."""

from typing import TYPE_CHECKING, Any

import numpy as np

from faying.joint.figure import OPEN, DrawnFace, in_plane
from faying.result.load_cases import LoadCases
from faying.style import WIDE, axes_of, drawing, headline, new_panels, percent

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_PANELS = 12  # the preload, and cases
COLUMNS = 3
SMALL = 0.2  # size of the points of small panels, against those of one


def _map(found: LoadCases, case: int | None, joint: int, size: float = 1.0) -> DrawnFace:
    """The map of a joint under a case, or under the preload alone; size: of its points."""
    here = found.joint_of_point == joint
    pressures = np.vstack([found.rest_pressure[here], found.pressure[:, here]])
    title = "preload" if case is None else headline(found.cases[case], 14)
    opens = "" if case is None else f": {percent(float(found.opened[case, joint]))} opens"
    return DrawnFace(
        places=found.positions[here],
        triangles=None,
        values=pressures[0 if case is None else case + 1],
        most=float(pressures.max()),
        areas=size * found.areas[here],
        title=title + opens,
    )


def _painted(drawn: DrawnFace, ax: Any) -> Any:
    """Draw a map, with what is open in a pale colour below it; return what a colour bar needs."""
    flat = 1e3 * in_plane(drawn.places)[0]
    ax.scatter(*flat.T, s=2.0, color=OPEN, linewidths=0, zorder=0)
    return drawn.paint(ax)


@drawing
def case_axes(found: LoadCases, case: int, joint: int, ax: "Axes | None" = None) -> "Axes":
    """Draw the pressure on a joint under a case, both counted from 0, on a scale that all cases share."""
    (target,) = axes_of(ax, 1)
    drawn = _map(found, case, joint)
    width, height = np.ptp(in_plane(drawn.places)[0], axis=0)
    place: Any = "bottom" if height < 0.7 * width else "right"
    target.figure.colorbar(_painted(drawn, target), ax=target, label=drawn.label, location=place, shrink=0.9, pad=0.02)
    return target


@drawing
def figure(found: LoadCases, joint: int = 0) -> Any:
    """Return the figure of the pressure on a joint, counted from 0, under the preload and under each case."""
    cases: list[int | None] = [None, *range(min(len(found.cases), MOST_PANELS - 1))]
    columns = min(COLUMNS, len(cases))
    fig = new_panels(columns, -(-len(cases) // columns), width=WIDE / COLUMNS, height=2.1)
    for ax in fig.axes[len(cases) :]:
        ax.set_visible(False)
    shown = fig.axes[: len(cases)]
    maps = [_map(found, case, joint, size=SMALL) for case in cases]
    flat = 1e3 * in_plane(maps[0].places)[0]
    room = 0.04 * np.ptp(flat, axis=0)
    low, high = flat.min(axis=0) - room, flat.max(axis=0) + room
    for number, (ax, drawn) in enumerate(zip(shown, maps, strict=True)):
        painted = _painted(drawn, ax)
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        ax.set_xlabel(ax.get_xlabel() if number + columns >= len(cases) else "")
        ax.set_ylabel(ax.get_ylabel() if number % columns == 0 else "")
    fig.colorbar(painted, ax=fig.axes, label="pressure [MPa]", location="bottom", shrink=0.5, aspect=40)
    return fig
