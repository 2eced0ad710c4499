"""The picture of the README: a mode of the T-specimen, the pressure on its joint, a frequency beside the hammer test.

After `faying run examples/t-specimen/study.toml`, `python docs/gallery/front_page.py` writes
docs/figures/t-specimen.png.
"""

from pathlib import Path
from typing import Any

import numpy as np

from faying.result import Result
from faying.result.figure import pressure_map
from faying.style import new_figure, save

ROOT = Path(__file__).parents[2]
MODE = 0  # of the test, from 0


def shape(ax: Any, result: Result, mode: int) -> None:
    """Draw a mode shape at the last load, coloured by its motion."""
    from matplotlib import colormaps
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    motion = np.asarray(result.shapes[-1, mode], float)
    size = np.linalg.norm(motion, axis=1)
    scale = 0.12 * np.ptp(result.outline[:, 2]) / size.max()
    points = (result.outline + scale * motion)[:, [2, 0, 1]] * 1e3
    level = size[result.triangles].mean(axis=1) / size.max()
    faces = Poly3DCollection(points[result.triangles], facecolors=colormaps["viridis"](level), edgecolors="none")
    ax.add_collection3d(faces)
    low, high = points.min(axis=0), points.max(axis=0)
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    ax.set_box_aspect(high - low, zoom=1.05)
    ax.view_init(elev=28, azim=-68)
    ax.set_axis_off()
    ax.set_title(f"mode {MODE + 1} of the test: {result.frequencies[-1, mode]:.0f} Hz at {result.loads[-1] / 1e3:g} kN")


def beside_the_test(ax: Any, result: Result) -> None:
    """Draw a frequency over preload with the range of the law, the test, and the published model."""
    c = result.comparison
    assert c is not None
    assert c.published is not None
    assert result.low is not None
    assert result.high is not None
    load, rows = result.loads / 1e3, np.arange(len(result.loads))
    places = c.modes[:, MODE]
    ax.fill_between(load, result.low[rows, places], result.high[rows, places], color="C0", alpha=0.2, lw=0)
    ax.plot(load, result.frequencies[rows, places], "C0o-", label="Faying, with the law's range")
    ax.plot(load, c.frequencies[:, MODE], "ks", label="hammer test")
    ax.plot(load, c.published[:, MODE], "C3x:", label="published model")
    ax.axhline(result.bonded[places[-1]], color="0.5", ls="--", lw=1, label="faces bonded")
    ax.set(xlabel="preload of each bolt [kN]", ylabel="frequency [Hz]", title=f"mode {MODE + 1} of the test")
    ax.legend(fontsize=8, loc="upper left", bbox_to_anchor=(1.02, 1))
    ax.grid(alpha=0.3)


def draw(result: Result) -> Any:
    """Return the figure."""
    fig = new_figure(13.0, 3.4)
    grid = fig.add_gridspec(1, 3, width_ratios=(1.4, 1, 1))
    assert result.comparison is not None
    shape(fig.add_subplot(grid[0], projection="3d"), result, int(result.comparison.modes[-1, MODE]))
    pressure_map(fig.add_subplot(grid[1]), result)
    beside_the_test(fig.add_subplot(grid[2]), result)
    return fig


if __name__ == "__main__":
    result = Result.load(ROOT / "examples" / "t-specimen" / "results" / "result.nc")
    save(draw(result), ROOT / "docs" / "figures" / "t-specimen.png")
