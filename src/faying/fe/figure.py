"""Pictures of surfaces of triangles: parts with their faces, and mode shapes."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from faying.errors import InputError
from faying.fe.outline import normals, outline
from faying.fe.solids import SolidMesh
from faying.style import COLUMN, colour, drawing, plain
from faying.typing import Array, Index

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ELEVATION, AZIMUTH = 12, -62  # deg: where a structure is looked at from
LIGHT = np.array([0.35, -0.8, 0.48])  # direction towards the light
BARE = "0.82"  # colour of what has no name
DEFORMED = 0.06  # greatest motion of a mode shape as it is drawn, of the size of the structure
MAX_COLOURS = 8  # faces with a colour of their own


def axes_in_space(ax: "Axes | None") -> Any:
    """Axes with three dimensions: those given, or new ones that a notebook or `matplotlib.pyplot.show` shows.

    Raises InputError for axes that are flat.
    """
    if ax is None:
        from matplotlib import pyplot

        figure = pyplot.figure(figsize=(COLUMN, 3.2), layout="constrained")
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
    moved, motion = moved_by(points, shape)
    return _draw(ax, moved, triangles, shades(motion[triangles].mean(axis=1)))


def _draw(ax: Any, points: Array, triangles: Index, colours: Array) -> Any:
    """Draw a surface (n, 3) [m] with the colour of each triangle, in mm, and look at it."""
    from mpl_toolkits.mplot3d.art3d import Poly3DCollection

    corners = 1e3 * points[triangles]
    ax.add_collection3d(Poly3DCollection(corners, facecolors=colours, edgecolors="none", linewidths=0))
    return framed_in_space(ax, 1e3 * points)


def projected_view(points: Array) -> tuple[Array, Array]:
    """Points (n, 3) as they are looked at: places on paper (n, 2), right and up, and nearness to the eye (n,)."""
    up, side = np.radians(ELEVATION), np.radians(AZIMUTH)
    eye = np.array([np.cos(up) * np.cos(side), np.cos(up) * np.sin(side), np.sin(up)])
    right = np.array([-np.sin(side), np.cos(side), 0.0])
    return points @ np.stack([right, np.cross(eye, right)], axis=1), points @ eye


def shades(values: Array) -> Array:
    """Colours (n, 4) of the size of a motion, 0 to 1."""
    from matplotlib import colormaps

    return np.asarray(colormaps["viridis"](values))


def draw_flat(ax: Any, points: Array, triangles: Index, colours: Array) -> None:
    """Draw a closed surface of triangles (t, 3) as seen from the eye on flat axes; colours: RGBA (t, 4), lit here."""
    from matplotlib.collections import PolyCollection

    flat, near = projected_view(points)
    faces = normals(points, triangles)
    front = np.flatnonzero(projected_view(faces)[1] > 0)
    order = front[np.argsort(near[triangles[front]].mean(axis=1))]
    lit = np.array(colours, float)[order]
    lit[:, :3] *= (0.72 + 0.28 * np.clip(faces[order] @ LIGHT, 0, None))[:, None]
    # an edge of its own colour closes the hairlines between neighbours
    corners = list(flat[triangles[order]])
    lines = PolyCollection(corners, facecolors=lit, edgecolors=lit, linewidths=0.25, rasterized=True, clip_on=False)
    ax.add_collection(lines)


def draw_shape_flat(ax: Any, points: Array, triangles: Index, shape: Array, *, frame: Array | None = None) -> Any:
    """Draw a shape (n, 3) of a surface (n, 3) [m], with its form at rest pale behind it, on flat axes without a frame.

    The greatest motion is drawn as 6 % of the diagonal. frame: corners (2, 2) of what the axes show, those of this
    shape where None; shapes in one frame have one scale.
    """
    moved, motion = moved_by(points, shape)
    draw_flat(ax, points, triangles, np.tile((0.9, 0.91, 0.92, 1.0), (len(triangles), 1)))
    draw_flat(ax, moved, triangles, shades(motion[triangles].mean(axis=1)))
    low, high = frame_of([points, moved]) if frame is None else frame
    ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal")
    ax.set_axis_off()
    return ax


def moved_by(points: Array, shape: Array) -> tuple[Array, Array]:
    """Points (n, 3) [m] moved by a shape as it is drawn, and the motion of each relative to the greatest (n,)."""
    motion = np.linalg.norm(shape, axis=1)
    most = max(float(motion.max()), 1e-300)
    return points + DEFORMED * float(np.linalg.norm(np.ptp(points, axis=0))) * shape / most, motion / most


def frame_of(surfaces: Sequence[Array]) -> Array:
    """Corners (2, 2) of the smallest frame that holds these points as they are looked at."""
    flat = np.concatenate([projected_view(points)[0] for points in surfaces])
    low, high = flat.min(axis=0), flat.max(axis=0)
    room = 0.01 * float((high - low).max())
    return np.stack([low - room, high + room])


def draw_faces(
    ax: Any, points: Array, triangles: Index, face_of_triangle: Index, colours: Mapping[int, str], alpha: float = 1.0
) -> Any:
    """Draw a surface (n, 3) [m] with the faces of some numbers in colours of their own, the rest grey.

    alpha: of the rest, below 1 where what is behind it should be seen.
    """
    from matplotlib.colors import to_rgb

    base = np.array([to_rgb(colours.get(int(face), BARE)) for face in face_of_triangle])
    bright = 0.62 + 0.38 * np.clip(normals(points, triangles) @ LIGHT, 0, None)
    shaded = np.column_stack([base * bright[:, None], np.where(np.isin(face_of_triangle, list(colours)), 1.0, alpha)])
    return _draw(ax, points, triangles, shaded)


def key_of(ax: Any, colours: Mapping[str, str]) -> None:
    """Say beside the axes which colour is which, name -> colour."""
    from matplotlib.patches import Patch

    handles = [Patch(color=colour, label=plain(name)) for name, colour in colours.items()]
    if handles:
        ax.legend(handles=handles, loc="upper center", bbox_to_anchor=(0.5, 0.06), ncols=2)


@drawing
def mesh_axes(mesh: SolidMesh, ax: "Axes | None" = None) -> "Axes":
    """Draw a mesh with its named faces in colours of their own; as many as there are colours."""
    ax = axes_in_space(ax)
    outer = outline(mesh)
    sizes = np.bincount(outer.face_of_triangle[outer.face_of_triangle >= 0], minlength=len(outer.faces))
    largest = [int(k) for k in np.argsort(-sizes, kind="stable") if sizes[k]][:MAX_COLOURS]
    colours = {k: colour(number) for number, k in enumerate(sorted(largest))}
    draw_faces(ax, mesh.points[outer.nodes], outer.triangles, outer.face_of_triangle, colours, alpha=0.45)
    key_of(ax, {outer.faces[k]: colour for k, colour in colours.items()})
    ax.set_title(f"{', '.join(map(plain, mesh.parts))}: {mesh.unknowns:,} unknowns")
    return ax
