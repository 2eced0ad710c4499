"""Pictures of a bolted structure: its parts and joints, the pressure on a joint, a mode shape."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from faying.fe.face_map import joint_map
from faying.fe.figure import axes_in_space, draw_faces, draw_shape, key_of
from faying.fe.interface import Interface
from faying.fe.outline import Outline
from faying.joint.springs import Springs
from faying.style import INK, axes_of, colour, drawing, percent, plain
from faying.text import titled
from faying.typing import Array, Index

if TYPE_CHECKING:
    from matplotlib.axes import Axes

EDGE = 0.5  # share of contact at the edge of contact
OPEN = "#e4e7ea"  # colour of what is open
STRAIGHT = 0.9999  # least part of a normal along an axis for a face across that axis
Fastening = tuple[str, str, tuple[str, ...], Array | None]  # kind, name, faces and maybe seats of what is drawn
BOLT_ENDS = 0.3  # how far a bolt stands out of its seats as it is drawn, of its length


@dataclass(frozen=True, kw_only=True, eq=False)
class DrawnFace:
    """Pressure, or what else there is, on a joint as it is drawn.

    Args:
        places: (k, 3) [m].
        triangles: Between them (t, 3); None where only points are known.
        values: What is drawn, in SI units (k,).
        most: Greatest value of the colours.
        areas: Area of each place [m2] (k,), where there are no triangles.
        contact: Share of the area around each place that carries pressure (k,); from the pressure where left out.
        title: What stands above.
        label: Of the colour bar.
        unit: That of the label in SI.
    """

    places: Array
    triangles: Index | None
    values: Array
    most: float
    areas: Array | None = None
    contact: Array | None = None
    title: str = ""
    label: str = "pressure [MPa]"
    unit: float = 1e6

    def paint(self, ax: Any) -> Any:
        """Draw it on the face at one scale and return what a colour bar needs.

        What is open stays pale, with a line at the edge of contact.
        """
        flat, names = in_plane(self.places)
        values = self.values / self.unit
        style: dict[str, Any] = {"cmap": "viridis", "vmin": 0.0, "vmax": max(self.most, 1e-300) / self.unit}
        if self.triangles is None:
            size = 2e5 * np.asarray(self.areas) / max(float(np.prod(np.ptp(flat, axis=0))), 1e-300)
            here = self.values > 0 if self.contact is None else self.contact > EDGE
            drawn = ax.scatter(*(flat[here].T * 1e3), c=values[here], s=size[here], linewidths=0, **style)
        else:
            grid = (*(flat.T * 1e3), self.triangles)
            drawn = ax.tripcolor(*grid, values, shading="gouraud", rasterized=True, **style)
            shut = self.values > 0 if self.contact is None else self.contact
            _open_zone(ax, grid, np.asarray(shut, float))
        ax.set(aspect="equal", xlabel=f"{names[0]} [mm]", ylabel=f"{names[1]} [mm]", title=self.title)
        ax.spines[:].set_visible(False)
        return drawn


def _open_zone(ax: Any, grid: tuple[Any, ...], contact: Array) -> None:
    """Cover what is open, a share of contact below one half, and draw the edge of contact as a line."""
    if contact.min() >= EDGE:
        return
    if contact.max() <= EDGE:
        from matplotlib.colors import ListedColormap

        ax.tripcolor(*grid, np.zeros(len(contact)), shading="gouraud", cmap=ListedColormap([OPEN]), rasterized=True)
        return
    ax.tricontourf(*grid, contact, levels=[-1.0, EDGE], colors=[OPEN])
    ax.tricontour(*grid, contact, levels=[EDGE], colors=[INK], linewidths=0.7)


def in_plane(places: Array) -> tuple[Array, tuple[str, str]]:
    """Places (k, 3) of a nearly plane face in axes of that plane (k, 2), and what to call these axes.

    A face across an axis of the model is drawn along the other two. A tilted one is drawn as it looks from above it,
    its first axis as near to x, y or z as the plane allows.
    """
    middle = places.mean(axis=0)
    normal = np.linalg.svd(places - middle, full_matrices=False)[2][-1]
    across = int(np.argmax(np.abs(normal)))
    if abs(normal[across]) > STRAIGHT:
        x, y = (k for k in range(3) if k != across)
        return places[:, [x, y]], ("xyz"[x], "xyz"[y])
    first = np.eye(3)[int(np.argmin(np.abs(normal)))]
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    second = np.cross(normal, first)
    second *= np.sign(second[int(np.argmax(np.abs(second)))])
    name = "xyz"[int(np.argmin(np.abs(normal)))]
    return (places - middle) @ np.stack([first, second], axis=1), (f"along {name}", "across")


@drawing
def pressure_axes(
    outer: Outline,
    points: Array,
    faces: tuple[str, str],
    springs: Springs[Interface],
    *,
    most: float,
    title: str,
    ax: "Axes | None" = None,
) -> "Axes":
    """Draw the pressure on a joint, shaded over the elements where its faces touch.

    Args:
        outer: The outer surface of the structure.
        points: Of the mesh (nodes, 3) [m].
        faces: Names of both faces of the joint.
        springs: Of the joint, with the pressure at their points.
        most: Greatest pressure of the colours [Pa].
        title: Joint and preload; the share that is open stands behind it.
        ax: Axes to draw into; new ones where None.
    """
    here = [outer.triangles[outer.face_of_triangle == outer.faces.index(face)] for face in faces]
    points = points[outer.nodes]
    weights, pressure = springs.interface.weights, springs.pressure
    values = joint_map(
        points,
        [face for face in here if len(face)],
        springs.interface.positions,
        weights,
        {"pressure": pressure[None], "contact": (pressure[None] > 0).astype(float)},
    )
    share = float(weights @ (pressure <= 0) / weights.sum())
    drawn = DrawnFace(
        places=points[values.parents].mean(axis=1),
        triangles=values.triangles,
        values=values.fields["pressure"][0],
        contact=values.fields["contact"][0],
        most=most,
        title=f"{plain(title)}: {percent(share)} open",
    )
    return face_axes(drawn, ax)


def painted_points(drawn: DrawnFace, ax: Any) -> Any:
    """Draw a face of points, with what is open in a pale colour below it; return what a colour bar needs."""
    flat = 1e3 * in_plane(drawn.places)[0]
    ax.scatter(*flat.T, s=2.0, color=OPEN, linewidths=0, zorder=0)
    return drawn.paint(ax)


@drawing
def face_axes(drawn: DrawnFace, ax: "Axes | None" = None) -> "Axes":
    """Draw a face with its colour bar: of triangles, or of points with what is open below them."""
    (target,) = axes_of(ax, 1)
    width, height = np.ptp(in_plane(drawn.places)[0], axis=0)
    place: Any = "bottom" if height < 0.7 * width else "right"
    painted = painted_points(drawn, target) if drawn.triangles is None else drawn.paint(target)
    target.figure.colorbar(painted, ax=target, label=drawn.label, location=place, shrink=0.9, pad=0.02)
    return target


@drawing
def mode_axes(points: Array, triangles: Index, shape: Array, title: str, ax: "Axes | None" = None) -> "Axes":
    """Draw a shape (n, 3) on a surface: its points (n, 3) [m], and triangles (t, 3) between them."""
    target: Any = axes_in_space(ax)
    draw_shape(target, points, triangles, shape)
    target.set_title(title)
    out: Axes = target
    return out


@drawing
def structure_axes(outer: Outline, points: Array, shown: Sequence[Fastening], ax: "Axes | None" = None) -> "Axes":
    """Draw the parts, with the faces of joints, seats of bolts, dowels and supports in colours of their own.

    Args:
        outer: The outer surface.
        points: Of the mesh (nodes, 3) [m].
        shown: Kind, name and faces of each joint, bolt, dowel and support, and its two seats (2, 3) [m] if it has an
            axis.
        ax: Axes with three dimensions; new ones where None.
    """
    target: Any = axes_in_space(ax)
    colours: dict[int, str] = {}
    key: dict[str, str] = {}
    for kind, name, faces, _ in shown:
        label = titled(kind, name)
        key[label] = colour(len(key))
        for face in faces:
            colours.setdefault(outer.faces.index(face), key[label])
    draw_faces(target, points[outer.nodes], outer.triangles, outer.face_of_triangle, colours, alpha=0.4)
    for kind, name, _, seats in shown:
        if seats is not None:
            start, end = seats
            out = BOLT_ENDS * (end - start)
            target.plot(*(np.stack([start - out, end + out]) * 1e3).T, color=key[titled(kind, name)], lw=2.5)
    key_of(target, dict(list(key.items())[:8]))
    drawn: Axes = target
    return drawn
