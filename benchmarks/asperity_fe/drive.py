"""Press one asperity: geometry and materials in, history of force and area out."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from math import inf, isfinite, pi, sqrt
from typing import Literal

import numpy as np

from asperity_fe.body import CapState
from asperity_fe.equilibrium import CapEquilibrium
from asperity_fe.mesh import cap_mesh, rim_radius
from asperity_fe.model import CapModel, build, expected_radius
from asperity_fe.result import AsperityResult, CapField, History
from faying.checks import number
from faying.errors import InputError, NotConverged
from faying.materials import RIGID, ContactPair, Material

FORCE_TOLERANCE = 1e-4  # of the largest force asked for
BISECTIONS = 6  # a step that does not converge is halved this often before the run gives up


@dataclass(frozen=True, kw_only=True)
class AsperityCase:
    """The problem that `solve_asperity` solves; its keywords mean the same there."""

    R: float
    h_a: float
    cap: Material
    substrate: Material
    displacement: float | Sequence[float] | None = None
    force: float | Sequence[float] | None = None
    layer: Material | None = None
    layer_thickness: float = 0.0
    hardening: float = 0.0
    foot: Literal["bonded", "sliding"] = "bonded"
    elements: int = 40
    steps: int | None = None
    domain: float | None = None
    solver: str | None = None

    @property
    def base(self) -> float:
        """Radius of the cap's base [m]."""
        return rim_radius(self.R, self.h_a)

    def solve(self, progress: Callable[[float], None] | None = None) -> AsperityResult:
        """Solve this case; `progress` is called with the share done."""
        if (self.displacement is None) == (self.force is None):
            raise InputError("give displacement or force, one of them")
        _check_shape(self)
        name = "displacement" if self.force is None else "force"
        targets = _turning_points(getattr(self, name), name)
        radius, top = _expected(self, max(targets))
        model = build(
            mesh=cap_mesh(
                R=self.R,
                h_a=self.h_a,
                contact_radius=radius,
                elements=self.elements,
                domain=None if self.substrate.is_rigid else self.domain or 40 * self.base,
                layer_thickness=self.layer_thickness if self.layer else 0.0,
            ),
            h_a=self.h_a,
            materials=(self.cap, self.layer or self.cap, self.cap if self.substrate.is_rigid else self.substrate),
            hardening=(self.hardening,) * 3,
            sliding=self.foot == "sliding",
            contact_radius=radius,
            solver=self.solver,
        )
        run = _Run(model, self.steps or round(1.5 * self.elements), targets, progress)
        return run.result() if self.force is None else run.to_forces(sqrt(top))


def solve_asperity(
    *,
    R: float,
    h_a: float,
    cap: Material,
    substrate: Material,
    displacement: float | Sequence[float] | None = None,
    force: float | Sequence[float] | None = None,
    layer: Material | None = None,
    layer_thickness: float = 0.0,
    hardening: float = 0.0,
    foot: Literal["bonded", "sliding"] = "bonded",
    elements: int = 40,
    steps: int | None = None,
    domain: float | None = None,
    solver: str | None = None,
    progress: Callable[[float], None] | None = None,
) -> AsperityResult:
    """Press a spherical cap on a substrate with a smooth rigid plane, by axisymmetric elastic-plastic finite elements.

    Strains are small and geometry is linear inside the body; the contact is closed on the plane's true height.

    Args:
        R: radius of the cap [m], positive.
        h_a: its height [m], 0 < h_a <= R; its base has the radius sqrt(2 R h_a - h_a^2).
        cap: its material; without a yield strength it stays elastic.
        substrate: what it stands on; RIGID fixes the base of the cap.
        displacement: of the plane from first touch [m], one value or the turning points of a history. A smaller value
            after a larger one unloads; 0 unloads until contact is lost.
        force: of the plane [N], in place of the displacement and in the same way.
        layer: a third material under the cap.
        layer_thickness: of that layer [m].
        hardening: tangent modulus over E, 0 <= hardening < 1.
        foot: "bonded" or "sliding" base on a rigid substrate; h_a = R sliding is half of a sphere between two planes.
        elements: over the contact radius, 4 or more.
        steps: load steps for the largest displacement (default: 1.5 for each contact element).
        domain: radius and depth of the substrate [m] (default: 40 radii of the base); its foot keeps its height, its
            wall its radius.
        solver: name of the factorisation.
        progress: called with the share done.

    Returns:
        AsperityResult: the history of the plane and the field at its last step.

    Raises:
        InputError: for impossible geometry or loads.
        NotConverged: with the step and the place; the steps done are in its attribute `result`.

    Source:
        Zhang et al. 2024, doi:10.3390/fractalfract8100611, section 2.4, for the setting.
    """
    given = locals()
    return AsperityCase(**{f.name: given[f.name] for f in fields(AsperityCase)}).solve(progress)


def _expected(case: AsperityCase, greatest: float) -> tuple[float, float]:
    """Contact radius to mesh for and displacement [m] at the greatest displacement or force asked for."""
    cap, R, h_a = case.cap, case.R, case.h_a
    if case.force is None and greatest > h_a:
        raise InputError(
            f"displacement {greatest:.6g} m is more than the height h_a of the cap, {h_a:.6g} m; give less"
        )
    soft = [m for m in (cap, case.substrate, case.layer) if m is not None and m.hardness is not None and not m.is_rigid]
    weakest = min(soft, key=lambda m: m.hardness or np.inf) if soft else None
    E_star = ContactPair(cap, RIGID).E_star
    hardness = weakest.hardness if weakest else None
    if case.force is not None:
        radius = max((0.75 * greatest * R / E_star) ** (1 / 3), sqrt(greatest / (pi * hardness)) if hardness else 0.0)
        top = radius**2 / (1.5 * R)  # between Hertz's a^2/R and the truncated sphere's a^2/(2R)
        if top > h_a:
            raise InputError(
                f"force {greatest:.6g} N would press the cap {top:.3g} m, more than its height {h_a:.6g} m; give less"
            )
        return radius, top
    radius = expected_radius(R, greatest, E_star, hardness, 0.454 + 0.41 * (weakest or cap).nu)
    if not case.substrate.is_rigid:
        radius /= sqrt(1 + 0.75 * cap.E / case.substrate.E * sqrt(greatest / h_a))  # what the substrate gives way
    return radius, greatest


class _Run:
    """One history being driven; every step is kept as it is found."""

    def __init__(
        self, model: CapModel, steps: int, targets: list[float], progress: Callable[[float], None] | None
    ) -> None:
        self.model, self.steps, self.targets, self.progress = model, steps, targets, progress
        self.state: CapState = model.body.virgin
        self.at: CapEquilibrium | None = None
        self.rows: list[tuple[float, float, float, float, float, float, int]] = []
        self.residual: float | None = None
        self.factorisations = 0

    def result(self) -> AsperityResult:
        """Go to displacements, one after the other."""
        goals = _path(self.targets, self.steps)
        goal = 0.0
        try:
            for number, (start, goal) in enumerate(zip([0.0, *goals[:-1]], goals, strict=True)):
                if self.residual is not None and goal < start:
                    continue  # the plane has left the asperity already
                self.residual = None
                self._go(start, goal, BISECTIONS)
                if self.progress is not None:
                    self.progress((number + 1) / len(goals))
        except NotConverged as fault:
            raise self._stopped(fault, goal) from None
        return self._gathered()

    def to_forces(self, root: float) -> AsperityResult:
        """Go to forces: steps of even length in the root of the displacement, the last one shortened to the force."""
        here, now = 0.0, 0.0
        stride = root / self.steps
        scale = max(self.targets)
        goal = 0.0
        try:
            for number, target in enumerate(self.targets):
                way = 1.0 if target > now else -1.0
                while abs(now - target) > FORCE_TOLERANCE * scale:
                    goal = max(sqrt(here) + way * stride, 0.0) ** 2
                    if goal > self.model.h_a:
                        raise NotConverged(
                            f"force {target:.6g} N is not reached while the cap is being pressed down to its base"
                        )
                    force = self._try(goal)
                    if way * (force - target) > FORCE_TOLERANCE * scale:
                        goal, force = self._between(here, now, goal, force, target, FORCE_TOLERANCE * scale)
                    self._step(goal)
                    here, now = goal, force
                    if target == 0 and self.residual is not None:
                        break
                if self.progress is not None:
                    self.progress((number + 1) / len(self.targets))
        except NotConverged as fault:
            raise self._stopped(fault, goal) from None
        return self._gathered()

    def _try(self, displacement: float) -> float:
        return self.model.contact(self.model.press(displacement, self.at, self.state)).force

    def _between(
        self, low: float, f_low: float, high: float, f_high: float, target: float, tolerance: float
    ) -> tuple[float, float]:
        """Displacement in one step from here that gives the force `target`, and the force (regula falsi, Illinois)."""
        a, fa, b, fb = low, f_low - target, high, f_high - target
        middle, f = b, fb
        for _ in range(40):
            middle = (a * fb - b * fa) / (fb - fa)
            f = self._try(middle) - target
            if abs(f) <= tolerance:
                break
            if f * fb < 0:
                a, fa = b, fb
            else:
                fa *= 0.5
            b, fb = middle, f
        return middle, f + target

    def _stopped(self, fault: NotConverged, goal: float) -> NotConverged:
        done = self.rows[-1][0] if self.rows else 0.0
        stop = NotConverged(f"between displacements {done:.6g} and {goal:.6g} m: {fault}")
        stop.result = self._gathered() if self.rows else None  # type: ignore[attr-defined]
        return stop

    def _go(self, start: float, goal: float, halvings: int) -> None:
        try:
            self._step(goal)
        except NotConverged:
            if not halvings:
                raise
            middle = 0.5 * (start + goal)
            self._go(start, middle, halvings - 1)
            self._go(middle, goal, halvings - 1)

    def _step(self, displacement: float) -> None:
        while True:
            found = self.model.press(displacement, self.at, self.state)
            if self.model.utilisation(found) <= 1 or self.model.far is None:
                break
            if self.at is None:
                raise NotConverged("the first step yields outside the fine part of the mesh; take more steps")
            self.factorisations += self.model.factors.factorisations
            self.model, self.at, self.state = self.model.enlarged(self.at, self.state)
        returned = found.balance.returned
        self.state = CapState(plastic=returned.plastic, hardened=returned.hardened)
        self.at = found
        contact = self.model.contact(found)
        low, high = contact.bounds
        volume = float(self.model.body.quads.weight.reshape(-1)[returned.yielding].sum())
        self.rows.append(
            (
                displacement,
                contact.force,
                pi * contact.radius**2,
                pi * low**2,
                pi * high**2,
                volume,
                found.iterations,
            )
        )
        if contact.force <= 1e-9 * max(row[1] for row in self.rows):
            moved = self.model.body.spread(found.unknowns)[self.model.body.surface, 1]
            highest = float(np.max(self.model.mesh.nodes[self.model.body.surface, 1] + moved))
            self.residual = self.model.h_a - highest

    def _gathered(self) -> AsperityResult:
        assert self.at is not None
        displacement, force, area, low, high, volume, iterations = np.array(self.rows, float).T
        stress, plastic = self.model.stress_of(self.at)
        mesh = self.model.mesh
        return AsperityResult(
            history=History(
                displacement=displacement,
                force=force,
                area=area,
                area_bounds=np.stack([low, high], axis=-1),
                yielding=volume,
                iterations=iterations.astype(np.int64),
            ),
            field=CapField(
                nodes=mesh.nodes,
                displacement=self.model.displacement_of(self.at),
                quads=mesh.quads,
                body=mesh.body,
                stress=stress,
                plastic_strain=plastic,
            ),
            residual=self.residual,
            unknowns=self.model.body.size,
            factorisations=self.factorisations + self.model.factors.factorisations,
        )


def _path(targets: list[float], steps: int) -> list[float]:
    """Displacements to stop at: even in the contact radius, so in the root of the displacement, up and down."""
    top = sqrt(max(targets))
    goals: list[float] = []
    here = 0.0
    for target in targets:
        there = sqrt(target)
        count = max(1, round(steps * abs(there - here) / top))
        goals += [float(v) ** 2 for v in np.linspace(here, there, count + 1)[1:-1]] + [target]
        here = there
    return goals


def _turning_points(given: float | Sequence[float] | None, name: str) -> list[float]:
    """Return the turning points of a history of displacements or forces, after refusing those that make no sense."""
    targets = [float(v) for v in np.atleast_1d(np.asarray(given, float))]
    if not targets or not all(isfinite(v) and v >= 0 for v in targets) or targets[0] <= 0:
        raise InputError(f"{name} = {given}; give one positive value, or several, none below 0")
    if any(a == b for a, b in pairwise(targets)):
        raise InputError(f"{name} = {given}; two turning points in a row are equal: leave one out")
    return targets


def _check_shape(case: AsperityCase) -> None:
    """Refuse what cannot be meshed."""
    R, h_a, layer, thickness = case.R, case.h_a, case.layer, case.layer_thickness
    number(R, "R", "m", least=0)
    number(h_a, "h_a", "m", least=0, greatest=R, ends="(]")
    if case.cap.is_rigid:
        raise InputError("the cap is rigid; it must be deformable, only the substrate may be RIGID")
    if (layer is None) != (thickness == 0) or not 0 <= thickness < inf:
        raise InputError(
            f"layer {layer.name if layer else None!r} with layer_thickness = {thickness:.6g} m; give both, or neither"
        )
    number(case.hardening, "hardening", least=0, greatest=1, ends="[)")
    if case.elements < 4 or (case.steps is not None and case.steps < 1):
        raise InputError(f"elements = {case.elements}, steps = {case.steps}; at least 4 elements and 1 step are needed")
    if case.domain is not None and not (
        isfinite(case.domain) and case.domain > 2 * case.base and case.domain > 2 * thickness
    ):
        raise InputError(
            f"domain = {case.domain:.6g} m; it must be more than twice the cap's base radius {case.base:.4g} m and the "
            "layer"
        )
