"""One asperity ready to be pressed: its mesh, the part that may yield, and the elastic rest condensed to its border."""

from dataclasses import dataclass, replace
from functools import cached_property
from math import sqrt
from typing import Any

import numpy as np

from asperity_fe.body import Body, CapState, Spring
from asperity_fe.equilibrium import CapEquilibrium, CapSolver, balanced, follow
from asperity_fe.mesh import CapMesh
from asperity_fe.plasticity import equivalent
from faying.materials import Material
from faying.numerics.solve import factorise
from faying.typing import Array, Index


@dataclass(frozen=True, kw_only=True)
class FarField:
    """Elements that stay elastic, `body`, seen from the degrees of freedom `border` that they share with the others."""

    body: Body
    border: Index
    solver: str | None = None

    @cached_property
    def _split(self) -> tuple[Index, Index]:
        edge = self.body.unknown_of_dof[self.border]
        inside = np.setdiff1d(np.arange(self.body.size), edge)
        return edge, inside

    @cached_property
    def _followers(self) -> Array:
        """Displacements inside (i, d) for a unit displacement of each degree of freedom of the border."""
        edge, inside = self._split
        stiffness = self.body.elastic
        rows: Any = stiffness[inside]
        return -factorise(rows[:, inside], self.solver).solve(rows[:, edge].toarray())

    @cached_property
    def spring(self) -> Spring:
        """The stiffness at the border: static condensation, exact while these elements are elastic."""
        edge, inside = self._split
        rows = self.body.elastic[edge]
        stiffness = rows[:, edge].toarray() + rows[:, inside] @ self._followers
        return Spring(dofs=self.border, stiffness=(stiffness + stiffness.T) / 2)

    def unknowns(self, at_border: Array) -> Array:
        """Displacement of this body (its unknowns) when its border is moved."""
        edge, inside = self._split
        full = np.zeros(self.body.size)
        full[edge] = at_border
        full[inside] = self._followers @ at_border
        return full

    def utilisation(self, at_border: Array) -> float:
        """Largest von Mises stress over yield strength in these elements."""
        flow = self.body.flow
        strain = self.body.strain(self.unknowns(at_border))
        return float(np.max(equivalent(elastic_stress(flow.bulk, flow.shear, strain)) / flow.strength))


def elastic_stress(bulk: Array, shear: Array, strain: Array) -> Array:
    """Hooke's law at points: stress (p, 4) of strain (p, 4), the last one the engineering shear."""
    dilatation = strain[:, :3].sum(axis=1)
    stress = 2 * shear[:, None] * strain
    stress[:, 3] *= 0.5
    stress[:, :3] += ((bulk - 2 * shear / 3) * dilatation)[:, None]
    return stress


def shared(first: Body, second: Body) -> Index:
    """Degrees of freedom that two bodies of one mesh have in common."""
    return np.flatnonzero((first.unknown_of_dof >= 0) & (second.unknown_of_dof >= 0))


PLASTIC_RADIUS = 2.5  # radius of the part that may yield, over the contact radius


@dataclass(frozen=True, kw_only=True)
class PlaneContact:
    """What the plane feels: force [N]; radius of the contact and its bounds [m], on the deformed surface."""

    force: float
    radius: float
    bounds: tuple[float, float]


@dataclass(frozen=True, kw_only=True)
class CapModel:
    """Mesh, materials and supports of one asperity; plastic flow is followed within `plastic_radius` [m]."""

    mesh: CapMesh
    h_a: float
    materials: tuple[Material, ...]
    hardening: tuple[float, ...]
    constrained: Index
    plastic_radius: float
    solver: str | None = None

    def _part(self, elements: Index) -> Body:
        return Body(
            mesh=self.mesh,
            materials=self.materials,
            hardening=self.hardening,
            constrained=self.constrained,
            elements=elements,
        )

    @cached_property
    def _near(self) -> Array:
        centre = self.mesh.nodes[self.mesh.quads].mean(axis=1)
        return np.asarray(np.hypot(centre[:, 0], centre[:, 1] - self.h_a) < self.plastic_radius)

    @cached_property
    def far(self) -> FarField | None:
        """The elastic rest, or None where all of the model may yield."""
        if self._near.all():
            return None
        near = self._part(np.flatnonzero(self._near))
        rest = self._part(np.flatnonzero(~self._near.astype(bool)))
        return FarField(body=rest, border=shared(near, rest), solver=self.solver)

    @cached_property
    def body(self) -> Body:
        """The part that may yield, resting on the condensed rest."""
        near = self._part(np.flatnonzero(self._near))
        return near if self.far is None else replace(near, far=self.far.spring)

    @cached_property
    def factors(self) -> CapSolver:
        """The factorisations of this model's tangents."""
        return CapSolver(self.solver)

    def room(self, displacement: float) -> Array:
        """How far each surface node may rise before the plane stops it [m]."""
        return np.asarray(self.h_a - displacement - self.mesh.nodes[self.body.surface, 1])

    def press(self, displacement: float, at: CapEquilibrium | None, state: CapState) -> CapEquilibrium:
        """Find the equilibrium with the plane at `displacement` [m], in one step from `state`, starting from `at`."""
        room = self.room(displacement)
        if at is None:
            start = np.zeros(self.body.size)
        else:
            moves = room[at.pressing] - at.unknowns[self.body.touching[at.pressing]]
            start = follow(self.body, self.factors, at, moves)
        return balanced(self.body, self.factors, start, state, room)

    def utilisation(self, at: CapEquilibrium) -> float:
        """Largest von Mises stress over yield strength in the part that is taken as elastic."""
        if self.far is None:
            return 0.0
        return self.far.utilisation(at.unknowns[self.body.unknown_of_dof[self.far.border]])

    def displacement_of(self, at: CapEquilibrium) -> Array:
        """Displacement of every node (n, 2) [m]."""
        moved = self.body.spread(at.unknowns)
        if self.far is not None:
            border = at.unknowns[self.body.unknown_of_dof[self.far.border]]
            rest = self.far.body.spread(self.far.unknowns(border))
            ours = np.zeros(len(self.mesh.nodes), bool)
            ours[self.mesh.quads[self._near.astype(bool)]] = True
            moved = np.where(ours[:, None], moved, rest)
        return moved

    def stress_of(self, at: CapEquilibrium) -> tuple[Array, Array]:
        """Stress (m, 4) [Pa] and equivalent plastic strain (m,) of every element, means over its four points."""
        stress = np.zeros((len(self.mesh.quads), 4))
        strain = np.zeros(len(self.mesh.quads))
        stress[self.body.elements] = at.balance.returned.stress.reshape(-1, 4, 4).mean(axis=1)
        strain[self.body.elements] = at.balance.returned.hardened.reshape(-1, 4).mean(axis=1)
        if self.far is not None:
            far, border = self.far.body, at.unknowns[self.body.unknown_of_dof[self.far.border]]
            hooke = elastic_stress(far.flow.bulk, far.flow.shear, far.strain(self.far.unknowns(border)))
            stress[far.elements] = hooke.reshape(-1, 4, 4).mean(axis=1)
        return stress, strain

    def enlarged(self, at: CapEquilibrium, state: CapState) -> tuple["CapModel", CapEquilibrium, CapState]:
        """Return the model with a larger part that may yield, and the same equilibrium and state in it."""
        larger = replace(self, plastic_radius=1.4 * self.plastic_radius)
        field = self.displacement_of(at).reshape(-1)
        number = larger.body.unknown_of_dof
        unknowns = np.zeros(larger.body.size)
        unknowns[number[number >= 0]] = field[number >= 0]
        place = np.searchsorted(larger.body.elements, self.body.elements)
        points = (4 * place[:, None] + np.arange(4)).reshape(-1)
        plastic, hardened = larger.body.virgin.plastic.copy(), larger.body.virgin.hardened.copy()
        plastic[points], hardened[points] = state.plastic, state.hardened
        wider = CapState(plastic=plastic, hardened=hardened)
        balance = larger.body.balance(unknowns, wider)
        same = CapEquilibrium(unknowns=unknowns, balance=balance, pressing=at.pressing, iterations=0)
        return larger, same, wider

    def contact(self, at: CapEquilibrium) -> PlaneContact:
        """Read force and contact radius off an equilibrium."""
        body = self.body
        count = len(at.pressing)
        if not count:
            return PlaneContact(force=0.0, radius=0.0, bounds=(0.0, 0.0))
        moved = body.spread(at.unknowns)[body.surface]
        r = self.mesh.nodes[body.surface, 0] + moved[:, 0]
        height = self.mesh.nodes[body.surface, 1] + moved[:, 1]
        last = int(at.pressing[-1])
        gap = height[at.pressing].mean() - height
        press = np.maximum(-at.balance.force[body.touching[: last + 1]], 0.0)
        return PlaneContact(force=float(press.sum()), radius=_edge(r, gap, press), bounds=_bounds(r, last))


def _bounds(r: Array, last: int) -> tuple[float, float]:
    inner = 0.5 * (r[last] + r[last - 1]) if last else 0.0
    return float(inner), float(r[min(last + 1, len(r) - 1)])


def _edge(r: Array, gap: Array, press: Array) -> float:
    """Radius of the contact, between nodes, from nodal forces `press` (k,) and the gap of the surface nodes (s,).

    The pressure is taken as (1 - r^2/a^2)^b and its first moments give b and a: b = 1/2 is Hertz's, b = 0 the even
    pressure of full plastic flow. Outside, the gap opens as (r - a)^(1 + b), 1.5 with Hertz (Johnson 1985, eq. 3.42a)
    and 1 at the kink that flow leaves; the second and third open nodes are extrapolated, as the first feels the mesh.
    At a kink the one estimate lies a part of an element outside, the other as much inside: there the mean is taken.
    Measured over contacts anywhere between nodes: within 0.05 of an element for b = 1/2, 0.25 for b = 0.
    """
    last = len(press) - 1
    low, high = _bounds(r, last)
    total = press.sum()
    if last + 3 >= len(r) or total <= 0:
        return 0.5 * (low + high)
    second = float(press @ r[: last + 1] ** 2 / total)
    fourth = float(press @ r[: last + 1] ** 4 / total)
    b, a_pressure = 0.5, high
    if last >= 4:
        ratio = fourth / second**2  # 2 (b + 2)/(b + 3)
        b = float(np.clip((3 * ratio - 4) / (2 - ratio), 0.0, 0.5))
        a_pressure = sqrt((b + 2) * second)
    y1, y2 = np.maximum(gap[last + 2 : last + 4], 0.0) ** (1 / (1 + b))
    if y2 <= y1:
        return 0.5 * (low + high)
    a_gap = r[last + 2] - y1 * (r[last + 3] - r[last + 2]) / (y2 - y1)
    return float(np.clip(a_gap + (0.5 - b) * (a_pressure - a_gap), low, high))


def build(
    *,
    mesh: CapMesh,
    h_a: float,
    materials: tuple[Material, ...],
    hardening: tuple[float, ...],
    sliding: bool,
    contact_radius: float,
    solver: str | None,
) -> CapModel:
    """Support an asperity: axis and outer wall keep their radius, the foot its height (and, bonded, its radius)."""
    constrained = np.concatenate([2 * mesh.axis, 2 * mesh.base + 1, 2 * mesh.wall, [] if sliding else 2 * mesh.base])
    return CapModel(
        mesh=mesh,
        h_a=h_a,
        materials=materials,
        hardening=hardening,
        constrained=np.unique(constrained).astype(np.int64),
        plastic_radius=PLASTIC_RADIUS * contact_radius,
        solver=solver,
    )


def expected_radius(R: float, displacement: float, E_star: float, hardness: float | None, K: float) -> float:
    """Contact radius to mesh for [m]: Hertz's, growing to that of the truncated sphere as the cap turns plastic."""
    truncated = sqrt(2 * R * displacement - displacement**2)
    if hardness is None:
        return truncated / sqrt(2)
    x = displacement / ((np.pi * K * hardness / (2 * E_star)) ** 2 * R)
    return float(truncated * sqrt(min(1.0, 0.5 * max(x, 1.0) ** 0.16)))
