"""Pictures of surfaces of triangles: parts with their faces, and mode shapes."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from faying.errors import InputError
from faying.fe.mesh import Mesh
from faying.fe.outline import normals, outline
from faying.style import plain
from faying.typing import Array, Index

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ELEVATION, AZIMUTH = 12, -62  # deg: where a structure is looked at from
LIGHT = np.array([0.35, -0.8, 0.48])  # direction towards the light
BARE = "0.82"  # colour of what has no name
DEFORMED = 0.06  # greatest motion of a mode shape as it is drawn, of the size of the structure
MOST_COLOURS = 10  # faces with a colour of their own


def axes_in_space(ax: "Axes | None", *, width: float = 5.2, height: float = 4.6) -> Any:
    """Axes with three dimensions: those given, or new ones that a notebook or `matplotlib.pyplot.show` shows.

    Raises InputError for axes that are flat.
    """
    if ax is None:
        from matplotlib import pyplot

        figure = pyplot.figure(figsize=(width, height), layout="constrained")
        return figure.add_subplot(projection="3d")
    if not hasattr(ax, "add_collection3d"):
        raise InputError(
            f"this plot draws into one matplotlib axes with three dimensions; got {type(ax).__name__}. Make it with "
            'figure.add_subplot(projection="3d"), or leave it out'
        )
    return ax


def framed_in_space(ax: Any, points: Array) -> Any:
    """Look at points (n, 3) with one scale along all axes, and without the axes themselves."""
    low, high = points.min(axis=0), points.max(axis=0)
    ax.set_xlim(low[0], high[0])
    ax.set_ylim(low[1], high[1])
    ax.set_zlim(low[2], high[2])
    ax.set_box_aspect(np.maximum(high - low, 1e-6 * np.max(high - low)))
    ax.set_axis_off()
    for axis in (ax.xaxis, ax.yaxis, ax.zaxis):
        axis.set_visible(False)  # or a layout measures its labels, although none is drawn
    ax.view_init(elev=ELEVATION, azim=AZIMUTH)
    return ax


def draw_shape(ax: Any, points: Array, triangles: Index, shape: Array) -> Any:
    """Draw a surface (n, 3) [m] moved by a shape (n, 3), coloured by the size of the motion.

    The greatest motion is drawn as 6 % of the diagonal of the surface.
    """
    from matplotlib import colormaps
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    size = float(np.linalg.norm(np.ptp(points, axis=0)))
    motion = np.linalg.norm(shape, axis=1)
    moved = (points + DEFORMED * size * shape / motion.max()) * 1e3
    colour = motion[triangles].mean(axis=1) / motion.max()
    surface = Poly3DCollection(
        moved[triangles], facecolors=colormaps["viridis"](colour), edgecolors="none", linewidths=0
    )
    ax.add_collection3d(surface)
    return framed_in_space(ax, moved)


def draw_faces(
    ax: Any, points: Array, triangles: Index, face_of_triangle: Index, colours: Mapping[int, str], alpha: float = 1.0
) -> Any:
    """Draw a surface (n, 3) [m] with the faces of some numbers in colours of their own, the rest grey.

    alpha: of the rest, below 1 where what is behind it should be seen.
    """
    from matplotlib.colors import to_rgb
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    base = np.array([to_rgb(colours.get(int(face), BARE)) for face in face_of_triangle])
    bright = 0.62 + 0.38 * np.clip(normals(points, triangles) @ LIGHT, 0, None)
    shaded = np.column_stack([base * bright[:, None], np.where(np.isin(face_of_triangle, list(colours)), 1.0, alpha)])
    ax.add_collection3d(Poly3DCollection(points[triangles] * 1e3, facecolors=shaded, edgecolors="none", linewidths=0))
    return framed_in_space(ax, points * 1e3)


def key_of(ax: Any, colours: Mapping[str, str]) -> None:
    """Say beside the axes which colour is which, name -> colour."""
    from matplotlib.patches import Patch

    handles = [Patch(color=colour, label=plain(name)) for name, colour in colours.items()]
    if handles:
        ax.legend(handles=handles, fontsize=7, loc="upper left", bbox_to_anchor=(0.0, 1.0), frameon=False)


def mesh_axes(mesh: Mesh, ax: "Axes | None" = None) -> "Axes":
    """Draw a mesh with its named faces in colours of their own; as many as there are colours."""
    ax = axes_in_space(ax)
    outer = outline(mesh)
    sizes = np.bincount(outer.face_of_triangle[outer.face_of_triangle >= 0], minlength=len(outer.faces))
    largest = [int(k) for k in np.argsort(-sizes, kind="stable") if sizes[k]][:MOST_COLOURS]
    colours = {k: f"C{number}" for number, k in enumerate(sorted(largest))}
    draw_faces(ax, mesh.points[outer.nodes], outer.triangles, outer.face_of_triangle, colours, alpha=0.45)
    key_of(ax, {outer.faces[k]: colour for k, colour in colours.items()})
    ax.set_title(f"{', '.join(map(plain, mesh.parts))}: {mesh.unknowns:,} unknowns", fontsize=9)
    return ax
