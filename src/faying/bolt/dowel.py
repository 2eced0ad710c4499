"""Dowels: pins that fit holes of several parts without play and carry shear, and no force along their axis."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import pi
from typing import Any

import numpy as np
from numpy.polynomial.legendre import leggauss, legint, legval

from faying.bolt.bolt import frame_about, solid_of
from faying.bolt.tapped import RoundHole, round_hole
from faying.checks import number
from faying.errors import InputError
from faying.fe.elasticity import Solid
from faying.fe.elements import FACES
from faying.fe.line import FACING, Line
from faying.fe.mesh import Mesh
from faying.fe.sides import NamedFaces, nodes_of, sampled
from faying.misuse import checked_call, shortened
from faying.notes import Note
from faying.typing import Array
from faying.units import show

ORDER = 6  # greatest power of the depth in the pressure on the wall of a hole
PLAY = 0.02  # of the diameter: holes that differ by more from the pin do not hold it without play
AXIS_OFFSET = 0.02  # of the diameter: axes of holes that lie farther apart take no pin
CONDITION = 1e2  # of the moments of a wall: beyond it its mesh does not tell so many apart


@checked_call
@dataclass(frozen=True, init=False)
class Dowel:
    """A pin in holes of several parts on one axis, which it fits without play, as pressed in.

    It carries shear between the parts, and bends as a beam. It takes no force along its axis and no torque.
    Every side of a hole pushes and pulls at it; lengths also as text with a unit.

    Args:
        name: What messages and results call the dowel.
        walls: Walls of the holes, two or more, each on a part of its own.
        material: Material of the pin, or its name in the catalogue.
        diameter: Diameter [m] of the pin; that of its first hole where None.
        ends: Points (3,) [m] of the axis where the pin begins and ends; where its holes do if None.

    Raises:
        InputError: Fewer than two walls, one wall twice, or a length that is not one; at the fit, a face that is not a
            hole, holes that are not on one axis or not of one diameter, two holes of one part or at one depth, or a
            pin that ends before it reaches a hole.
    """

    name: str
    walls: tuple[str, ...]
    material: Solid
    diameter: float | None
    ends: tuple[tuple[float, float, float], tuple[float, float, float]] | None

    def __init__(
        self,
        name: str,
        walls: Sequence[str],
        *,
        material: Solid | str,
        diameter: float | str | None = None,
        ends: Sequence[Sequence[float | str]] | None = None,
    ) -> None:
        what = f"dowel {name!r}"
        if isinstance(walls, str) or len(walls) < 2:
            raise InputError(f"{what}: walls = {shortened(walls)}; name the walls of its holes, one on each part")
        twice = [wall for k, wall in enumerate(walls) if wall in walls[:k]]
        if twice:
            raise InputError(f"{what} names the wall {twice[0]!r} twice; name the hole of each part once")
        if ends is not None and (len(ends) != 2 or any(isinstance(end, str) or len(end) != 3 for end in ends)):
            raise InputError(f"{what}: ends = {shortened(ends)}; give two points of three coordinates")
        points = None if ends is None else tuple(tuple(number(x, f"{what}: ends", "m") for x in end) for end in ends)
        values = {
            "name": name,
            "walls": tuple(walls),
            "material": solid_of(material, what),
            "diameter": None if diameter is None else number(diameter, f"{what}: diameter", "m", least=0),
            "ends": points,
        }
        for key, value in values.items():
            object.__setattr__(self, key, value)

    def placed(self, mesh: NamedFaces) -> "DowelPlace":
        """Return where the dowel lies. Raises InputError as the class says."""
        found = [_hole(mesh, wall, self.name) for wall in self.walls]
        holes = [hole for hole, _ in found]
        first, diameter = holes[0], self.diameter or 2 * found[0][1]
        for wall, (hole, radius) in zip(self.walls, found, strict=True):
            aside = Line(point=first.point, axis=first.axis).aside(hole.point)
            if abs(hole.axis @ first.axis) < FACING or aside > AXIS_OFFSET * diameter:
                raise InputError(
                    f"dowel {self.name!r}: the holes {self.walls[0]!r} and {wall!r} are not on one axis "
                    f"({show(aside, 'm', digits=3)} apart); name the holes that one pin fits"
                )
            if abs(2 * radius - diameter) > PLAY * diameter:
                raise InputError(
                    f"dowel {self.name!r} is {show(diameter, 'm')} thick, but the hole {wall!r} is "
                    f"{show(2 * radius, 'm')} wide; a dowel fits its holes without play. Take a [[bolt]] for a bolt "
                    "in a clearance hole, or give the holes one diameter"
                )
        depths = [sorted(((hole.point + z * hole.axis) @ first.axis) for z in (hole.low, hole.high)) for hole in holes]
        order = np.argsort([low for low, _ in depths])
        place = DowelPlace(
            dowel=self,
            diameter=diameter,
            point=first.point - (first.point @ first.axis) * first.axis,
            axis=first.axis,
            walls=tuple(self.walls[k] for k in order),
            depths=np.array([depths[k] for k in order]),
        )
        return place.checked(mesh).within_its_ends()

    def fitted(self, mesh: Mesh) -> "FittedDowel":
        """Return the dowel in its place on a mesh. Raises InputError as the class says, or for too coarse a mesh."""
        place = self.placed(mesh)
        walls = [_Wall.of(mesh, place, k) for k in range(len(place.walls))]
        return FittedDowel(place=place, walls=tuple(walls))


@dataclass(frozen=True, kw_only=True)
class DowelPlace:
    """Where a dowel lies.

    diameter [m]; point (3,) [m] of the axis at depth 0, and its direction; walls: from the first to the last along the
    axis; depths (walls, 2) [m]: where each begins and ends to hold the pin.
    """

    dowel: Dowel
    diameter: float
    point: Array
    axis: Array
    walls: tuple[str, ...]
    depths: Array

    def checked(self, mesh: NamedFaces) -> "DowelPlace":
        """The same. Raises InputError where two holes are of one part or lie at one depth."""
        name, parts = self.dowel.name, [mesh.face_part[wall] for wall in self.walls]
        for k, wall in enumerate(self.walls[1:], 1):
            if parts[k] in parts[:k]:
                raise InputError(
                    f"dowel {name!r}: the walls {self.walls[parts.index(parts[k])]!r} and {wall!r} are both on part "
                    f"{parts[k]!r}; name one hole of each part, its faces together where they are several"
                )
            if self.depths[k, 0] < self.depths[k - 1, 1] - PLAY * self.diameter:
                raise InputError(
                    f"dowel {name!r}: the holes {self.walls[k - 1]!r} and {wall!r} lie at one depth, one in the other; "
                    "name holes that lie one behind the other"
                )
        return self

    def within_its_ends(self) -> "DowelPlace":
        """The same with the depths between the ends of the pin. Raises InputError where it misses a hole."""
        if self.dowel.ends is None:
            return self
        low, high = sorted(float(np.array(end) @ self.axis) for end in self.dowel.ends)
        depths = np.clip(self.depths, low, high)
        lengths = depths[:, 1] - depths[:, 0]
        if lengths.min() < PLAY * self.diameter:
            short = self.walls[int(np.argmin(lengths))]
            raise InputError(
                f"dowel {self.dowel.name!r} is {show(high - low, 'm')} long and does not reach the hole {short!r}; "
                "give other ends, or leave them out for a pin as long as its holes"
            )
        return replace(self, depths=depths)

    @property
    def seats(self) -> Array:
        """Points (2, 3) [m] where the pin begins and ends."""
        return self.point + np.array([[self.depths[0, 0]], [self.depths[-1, 1]]]) * self.axis

    @property
    def frame(self) -> Array:
        """Unit vectors (3, 3): the axis, and two across it."""
        return frame_about(self.axis)


def _hole(mesh: NamedFaces, wall: str, name: str) -> tuple[RoundHole, float]:
    """The hole whose wall a face is, and its radius at the corners. Raises InputError where it is none."""
    hole = round_hole(mesh.points, mesh.face(wall))
    if hole is None:
        raise InputError(f"dowel {name!r}: the face {wall!r} is not the wall of a round hole; name that wall")
    corners = nodes_of(tuple(block[:, : FACES[block.shape[1]].corners] for block in mesh.face(wall)))
    return hole, float(Line(point=hole.point, axis=hole.axis).about(mesh.points[corners])[0].mean())


@dataclass(frozen=True, kw_only=True)
class _Wall:
    """How the wall of a hole moves with a dowel.

    order: of the polynomials; across: two sparse operators (order + 1, unknowns) to the coefficients [m] of Legendre
    polynomials in the depth of the motion along two directions across the axis; mean (3, unknowns): to its translation.
    """

    order: int
    across: tuple[Any, Any]
    mean: Any

    @classmethod
    def of(cls, mesh: Mesh, place: DowelPlace, number: int) -> "_Wall":
        """Fit the motion of a wall in the mean square. Raises InputError for too coarse a mesh."""
        for order in range(ORDER, 0, -1):
            found = cls._fit(mesh, place, number, order)
            if found is not None:
                return found
        raise InputError(
            f"dowel {place.dowel.name!r}: the mesh of the hole {place.walls[number]!r} is too coarse for the "
            f"{show(float(np.ptp(place.depths[number])), 'm')} of it that hold the pin; refine it there"
        )

    @classmethod
    def _fit(cls, mesh: Mesh, place: DowelPlace, number: int, order: int) -> "_Wall | None":
        """The fit by polynomials of an order; None where the mesh cannot tell them apart.

        Along the axis the motion is that of a rigid wall, and it may turn about the axis: with these, every rigid
        motion is met exactly, so that it strains no pin.
        """
        from scipy.sparse import csr_array

        low, high = place.depths[number]
        frame, count = place.frame, 2 * (order + 1) + 4
        gram = np.zeros((count, count))
        columns, entries = [], []
        for faces, values, position, _, share in sampled(mesh.points, mesh.face(place.walls[number])):
            local = (position - place.point) @ frame.T  # (f, q, 3): depth, and two across
            depth = 2 * (local[..., 0] - low) / (high - low) - 1
            weight = share * (np.abs(depth) <= 1 + 1e-9)
            motions = _motions(depth, local, order) @ frame  # (f, q, count, 3) in the axes of the model
            gram += np.einsum("fq,fqik,fqjk->ij", weight, motions, motions)
            spread = np.einsum("fq,qa,fqik->ifak", weight, values, motions)
            columns.append((3 * faces[:, :, None] + np.arange(3)).reshape(-1))
            entries.append(spread.reshape(count, -1))
        size = np.sqrt(np.diag(gram))
        if size.min() <= 0 or np.linalg.cond(gram / np.outer(size, size)) > CONDITION:
            return None
        column = np.concatenate(columns)
        solved = np.linalg.solve(gram, np.concatenate(entries, axis=1))
        at = np.repeat(np.arange(count), len(column)), np.tile(column, count)
        operator = csr_array((solved.ravel(), at), shape=(count, mesh.unknowns))
        operator.sum_duplicates()
        both = order + 1
        along = csr_array(np.outer(frame[0], [1.0])) @ operator[[2 * both]]
        mean = along + csr_array(frame[1:].T.copy()) @ operator[[0, both]]
        return cls(order=order, across=(operator[:both], operator[both : 2 * both]), mean=mean)


def _motions(depth: Array, local: Array, order: int) -> Array:
    """Motions (f, q, count, 3) of places in the axes of the pin: polynomials across it, rigid ones along and about."""
    count = 2 * (order + 1) + 4
    out = np.zeros((*depth.shape, count, 3))
    for k in range(order + 1):
        out[..., k, 1] = out[..., order + 1 + k, 2] = legval(depth, np.eye(order + 1)[k])
    out[..., -4, 0] = 1.0
    out[..., -3, 0], out[..., -2, 0] = local[..., 1], local[..., 2]
    out[..., -1, 1], out[..., -1, 2] = -local[..., 2], local[..., 1]
    return out


@dataclass(frozen=True, kw_only=True)
class FittedDowel:
    """A dowel in its place.

    The pin presses each wall across its axis with a force per length that is a polynomial of the depth, the same
    all around: what a rigid round inclusion bonded in a plate does. The forces balance, so that nothing but the shear
    and the bending of the pin resists them. With C the compliance of the pin under such forces, and N the forces that
    balance, its stiffness is N (N' C N)^-1 N'.
    """

    place: DowelPlace
    walls: tuple[_Wall, ...]

    @property
    def dowel(self) -> Dowel:
        """What was fitted."""
        return self.place.dowel

    @property
    def seats(self) -> Array:
        """Points (2, 3) [m] where the pin begins and ends."""
        return self.place.seats

    @property
    def notes(self) -> tuple[Note, ...]:
        """Where the mesh of a hole allows less than the full degree, by which the pin comes out softer."""
        low = [
            (wall.order, name) for wall, name in zip(self.walls, self.place.walls, strict=True) if wall.order < ORDER
        ]
        if not low:
            return ()
        order, name = min(low)
        text = (
            f"dowel {self.dowel.name!r}: the mesh of the hole {name!r} allows pressures of degree {order} over its "
            f"depth in place of {ORDER}; the dowel comes out softer, some 10 % at degree 3: refine the hole"
        )
        return (Note(code="dowel-mesh", text=text),)

    @cached_property
    def motion(self) -> tuple[Any, Any]:
        """Sparse operators (coefficients of all walls, unknowns) to the motion of the walls across the axis [m]."""
        from scipy.sparse import csr_array, vstack

        first, second = (vstack([wall.across[k] for wall in self.walls]) for k in (0, 1))
        return csr_array(first), csr_array(second)

    @cached_property
    def beam(self) -> Array:
        """Stiffness [N/m] of the pin between the coefficients of its walls, in one plane."""
        orders = [wall.order for wall in self.walls]
        return pin_stiffness(self.place.depths, orders, self.place.diameter, self.dowel.material)

    @cached_property
    def stiffness(self) -> Any:
        """Sparse stiffness [N/m] between the walls."""
        from scipy.sparse import csr_array

        beam = csr_array(self.beam)
        return sum((one.T @ beam @ one).tocsr() for one in self.motion)

    @cached_property
    def mass(self) -> Any:
        """Sparse mass [kg]: what lies in each hole, and half of what lies between two, moves with that hole."""
        density, area = self.dowel.material.density or 0.0, pi / 4 * self.place.diameter**2
        inner = (self.place.depths[1:, 0] + self.place.depths[:-1, 1]) / 2
        cuts = np.array([self.place.depths[0, 0], *inner, self.place.depths[-1, 1]])
        lumps = density * area * np.diff(cuts)
        return sum((lump * (wall.mean.T @ wall.mean)).tocsr() for lump, wall in zip(lumps, self.walls, strict=True))

    def forces(self, displacement: Array) -> Array:
        """Force [N] (walls, 3) of the pin on each wall, in the axes of the model, under a displacement (unknowns,)."""
        first = np.cumsum([0, *(wall.order + 1 for wall in self.walls)])[:-1]
        across = np.stack([-(self.beam @ (one @ displacement))[first] for one in self.motion], axis=1)
        return np.asarray(across @ self.place.frame[1:])

    def shear(self, displacement: Array) -> float:
        """The greatest shear force [N] of the pin between two of its parts under a displacement (unknowns,)."""
        return float(np.linalg.norm(np.cumsum(self.forces(displacement), axis=0)[:-1], axis=1).max())

    def bearing(self, displacement: Array) -> float:
        """The greatest force on a wall over diameter and depth of its hole [Pa] under a displacement (unknowns,)."""
        force = np.linalg.norm(self.forces(displacement), axis=1)
        return float((force / (self.place.diameter * np.ptp(self.place.depths, axis=1))).max())


def pin_stiffness(depths: Array, orders: Sequence[int], diameter: float, material: Solid) -> Array:
    """Return the stiffness [N/m] of a free round pin between the motions of the walls that hold it, in one plane.

    Args:
        depths: Where each wall begins and ends (walls, 2) [m], one behind the other.
        orders: Of each wall: order of the Legendre polynomials of its motion over its depth.
        diameter: Of the pin [m].
        material: E [Pa] and nu [-] of the pin.

    Returns:
        The matrix between the coefficients of all walls [m], wall after wall. Rigid motions of all strain nothing.

    Source:
        Complementary energy of a beam with shear, kappa of G. R. Cowper 1966, doi:10.1115/1.3625046.
    """
    from scipy.linalg import null_space

    E, nu = material.E, material.nu
    area, bending = pi / 4 * diameter**2, pi / 64 * diameter**4
    kappa = 6 * (1 + nu) / (7 + 6 * nu)
    shear = kappa * E / (2 * (1 + nu)) * area
    middle = float(depths.mean())
    count = sum(orders) + len(orders)
    compliance, rigid = np.zeros((count, count)), np.zeros((count, 2))
    cuts = np.unique(depths)
    nodes, weights = leggauss(max(orders) + 4)
    for low, high in pairwise(cuts):
        z = (low + high) / 2 + (high - low) / 2 * nodes
        V, M = _sections(z, depths, orders)
        compliance += (high - low) / 2 * (np.einsum("q,iq,jq->ij", weights, M, M) / (E * bending))
        compliance += (high - low) / 2 * (np.einsum("q,iq,jq->ij", weights, V, V) / shear)
    row = 0
    for (low, high), order in zip(depths, orders, strict=True):
        rigid[row] = 1.0, (low + high) / 2 - middle
        rigid[row + 1, 1] = (high - low) / 2
        row += order + 1
    rigid[:, 1] /= np.abs(rigid[:, 1]).max()
    balanced = null_space(rigid.T)
    inner = balanced.T @ compliance @ balanced
    return np.asarray(balanced @ np.linalg.solve((inner + inner.T) / 2, balanced.T))


def _sections(z: Array, depths: Array, orders: Sequence[int]) -> tuple[Array, Array]:
    """Shear force and moment (coefficients, depths z) of the pin per force of each coefficient, from its first end.

    The force of coefficient k is spread over its wall of length l as (2k + 1) P_k/l, whose work on the motion P_k is 1.
    """
    V, M = [], []
    for (low, high), order in zip(depths, orders, strict=True):
        half, place = (high - low) / 2, np.clip(2 * (z - low) / (high - low) - 1, -1, 1)
        excess = np.maximum(z - high, 0.0)
        for k in range(order + 1):
            load = (2 * k + 1) / (2 * half) * np.eye(order + 1)[k]
            once = legint(load, 1, lbnd=-1) * half
            V.append(legval(place, once))
            M.append(legval(place, legint(once, 1, lbnd=-1) * half) + excess * float(k == 0))
    return np.array(V), np.array(M)
