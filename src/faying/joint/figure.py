"""Pictures of a bolted structure: its parts and joints, the pressure on a joint, a mode shape."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from faying.fe.face_map import joint_map
from faying.fe.figure import axes_in_space, draw_faces, draw_shape, key_of
from faying.joint.state import State, VibrationModes
from faying.joint.structure import Structure
from faying.style import axes_of, plain
from faying.text import titled
from faying.typing import Array, Index
from faying.units import show

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BOLT_ENDS = 0.3  # how far a bolt stands out of its seats as it is drawn, of its length


@dataclass(frozen=True, kw_only=True, eq=False)
class PressureMap:
    """Pressure on a joint as it is drawn.

    Args:
        places: (k, 3) [m].
        triangles: Between them (t, 3); None where only points are known.
        values: Pressure [Pa] (k,).
        most: Greatest pressure of the colours [Pa].
        areas: Area of each place [m2] (k,), where there are no triangles.
        title: What stands above.
    """

    places: Array
    triangles: Index | None
    values: Array
    most: float
    areas: Array | None = None
    title: str = ""

    def draw(self, ax: Any, *, bar: bool = True) -> Any:
        """Draw it along the axes of the model; what carries nothing stays pale."""
        across = int(np.argmin(np.ptp(self.places, axis=0)))  # the axis that the face lies across
        x, y = (k for k in range(3) if k != across)
        flat, values = self.places[:, [x, y]], self.values * 1e-6
        most = max(self.most, 1e-300) * 1e-6
        style: dict[str, Any] = {"cmap": _pale(), "vmin": 1e-6 * most, "vmax": most}
        if self.triangles is None:
            size = 2e5 * np.asarray(self.areas) / max(float(np.prod(np.ptp(flat, axis=0))), 1e-300)
            drawn = ax.scatter(*(flat.T * 1e3), c=values, s=size, linewidths=0, rasterized=True, **style)
        else:
            grid = (*(flat.T * 1e3), self.triangles)
            drawn = ax.tripcolor(*grid, values, shading="gouraud", rasterized=True, **style)
        if bar:
            ax.figure.colorbar(drawn, ax=ax, label="pressure [MPa]", shrink=0.8)
        ax.set(aspect="equal", xlabel=f"{'xyz'[x]} [mm]", ylabel=f"{'xyz'[y]} [mm]", title=self.title)
        ax.title.set_fontsize(10)
        return ax


def _pale() -> Any:
    """The colour map of the pressure: pale where there is none."""
    from matplotlib import colormaps

    return colormaps["viridis"].with_extremes(under="0.9")


def pressure_axes(state: State, joint: int, ax: "Axes | None" = None) -> "Axes":
    """Draw the pressure on a joint of a state, shaded over the elements of its first face."""
    structure, springs = state.structure, state.springs[joint]
    outer, found = structure.surface(), structure.joints[joint]
    here = outer.face_of_triangle == outer.faces.index(found.faces[0])
    points = structure.mesh.points[outer.nodes]
    weights, pressure = springs.interface.weights, springs.pressure
    values = joint_map(
        points, outer.triangles[here], springs.interface.positions, weights, {"pressure": pressure[None]}
    )
    share = float(weights @ (pressure <= 0) / weights.sum())
    drawn = PressureMap(
        places=points[values.parents].mean(axis=1),
        triangles=values.triangles,
        values=values.fields["pressure"][0],
        most=max(float(s.pressure.max()) for s in state.springs),
        title=f"{plain(found.name)}, {state.load}: open on {share:.0%}",
    )
    (target,) = axes_of(ax, 1)
    drawn.draw(target)
    return target


def mode_axes(modes: VibrationModes, mode: int, ax: "Axes | None" = None) -> "Axes":
    """Draw the shape of a mode, counted from 0."""
    target: Any = axes_in_space(ax)
    structure = modes.structure
    nodes, triangles = structure.outline()
    draw_shape(target, structure.mesh.points[nodes], triangles, modes.shapes[mode][nodes])
    zeta = modes.damping[mode]
    damping = "" if np.isnan(zeta) else f", damping ratio {zeta:.2g}"
    target.set_title(f"mode {mode + 1}: {show(modes.frequencies[mode], 'Hz')}{damping}", fontsize=9)
    out: Axes = target
    return out


def structure_axes(structure: Structure, ax: "Axes | None" = None) -> "Axes":
    """Draw the parts, with the faces of joints, seats of bolts and supports in colours of their own."""
    target: Any = axes_in_space(ax)
    outer = structure.surface()
    colours: dict[int, str] = {}
    key: dict[str, str] = {}

    def paint(kind: str, name: str, faces: tuple[str, ...]) -> str:
        label = titled(kind, name)
        key[label] = f"C{len(key) % 10}"
        for face in faces:
            colours.setdefault(outer.faces.index(face), key[label])
        return key[label]

    for joint in structure.joints:
        paint("joint", joint.name, joint.faces)
    of_bolt = [paint("bolt", bolt.name, bolt.faces) for bolt in structure.bolts]
    for support in structure.supports:
        paint("support", support.face, (support.face,))
    points = structure.mesh.points[outer.nodes]
    draw_faces(target, points, outer.triangles, outer.face_of_triangle, colours, alpha=0.4)
    for fitted, colour in zip(structure.fitted_bolts, of_bolt, strict=True):
        start, end = fitted.seats
        out = BOLT_ENDS * (end - start)
        line = np.stack([start - out, end + out]) * 1e3
        target.plot(*line.T, color=colour, lw=2.5)
    key_of(target, dict(list(key.items())[:10]))
    drawn: Axes = target
    return drawn
