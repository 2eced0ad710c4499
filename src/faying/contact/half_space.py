"""A contact law computed on a scan: a ladder of half-space contacts, read between its rungs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, Literal, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.inputs import HeightMap
from faying.contact.law import ContactLaw, Response
from faying.contact.parameter import TABLE, TEXT, Parameter
from faying.errors import InputError
from faying.halfspace.solution import HalfSpaceContact
from faying.halfspace.solve import halved_map, solve_half_space
from faying.materials import ContactPair
from faying.typing import Array

FEWEST_POINTS = 30
RESOLVED = 0.1  # greatest change of k_n on half the points each way


@final
@dataclass(frozen=True, kw_only=True)
class _Ladder:
    """The contacts' numbers at rising pressures, as ln where the quantity is positive throughout."""

    pressure: Array
    values: Mapping[str, Array]
    contact_points: Array
    k_n_change: Array


@final
@dataclass(frozen=True)
class HalfSpace(ContactLaw):
    """The numerical contact of a scan with a flat, both bodies as one elastic half-space; limited to hardness.

    scan of the rough face (levelled, without missing points; anything with heights [m] and spacing (dx, dy) [m]);
    where both faces are rough, the scan of their sum. pair of materials. elastic=True leaves out the hardness.
    stiffness: "unloading", k_n against a small fall of the load, which is what a vibration sees: elastic, loss_n 0,
    energy_n the strain energy; or "loading", k_n against its growth, loss_n the plastic work of first loading over
    the strain energy, energy_n their sum. area: "corrected" for the size of the points, or as "counted". shear_ratio X
    = T/(mu F): above 0, k_t is that of the points that still stick and loss_t follows from their slip (needs the
    pair's friction). periodic as in `solve_half_space`. points: rungs of the ladder, spaced evenly in ln(pressure)
    from lowest to highest pressure [Pa]; between them each quantity is a monotone cubic in logarithms. tol as in
    `solve_half_space`.
    progress: called with (rungs done, points) while the ladder is climbed, on first use.

    Closure variable: the pressure [Pa]. Flagged where fewer than 30 points touch or none is open, and where k_n changes
    by more than 10 % when the ladder is climbed on half as many points each way (a quarter of the work on top).
    Raises InputError for parameters out of range and whatever `solve_half_space` does not accept.
    """

    scan: HeightMap
    pair: ContactPair
    elastic: bool = False
    stiffness: Literal["unloading", "loading"] = "unloading"
    area: Literal["corrected", "counted"] = "corrected"
    shear_ratio: float = 0.0
    periodic: bool = True
    points: int = 12
    lowest: float | None = None
    highest: float | None = None
    tol: float = 1e-6
    progress: Callable[[int, int], object] | None = field(default=None, repr=False, compare=False)

    name: ClassVar[str] = "half-space"
    source: ClassVar[str] = "doi:10.1016/S0043-1648(99)00113-1"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "scan": Parameter(TABLE, "levelled heights of the scan", surface="scan"),
        "stiffness": Parameter(TEXT, "direction in which k_n is taken", choices=("unloading", "loading")),
        "area": Parameter(TEXT, "real area, freed of the points' size or as counted", choices=("corrected", "counted")),
        "shear_ratio": Parameter("", "tangential load over friction times normal load", 0, 1, "[)"),
        "points": Parameter("", "pressures at which the contact is solved", 4, ends="[)", whole=True),
        "lowest": Parameter("Pa", "least pressure covered", 0),
        "highest": Parameter("Pa", "greatest pressure covered, above the least and below the hardness", 0),
        "tol": Parameter("", "error bound asked of every contact", 0, 1),
    }
    validity: ClassVar[str] = (
        "the scan resolves the roughness that touches: at least 30 points in contact, some open, and "
        "k_n within 10 % on half the points each way"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "points", int(self.points))  # the command line reads numbers as floats
        low, high = self.closure_range
        if not 0 < low < high < np.inf:
            raise InputError(f"half-space: pressures from {low:.4g} to {high:.4g} Pa; give 0 < lowest < highest")
        if not self.elastic and high >= self.pair.hardness:
            raise InputError(
                f"half-space: highest = {high:.4g} Pa is not below the hardness {self.pair.hardness:.4g} Pa; "
                "lower it, or set elastic=True"
            )
        if self.shear_ratio > 0:
            _ = self.pair.friction

    @property
    def closure_range(self) -> tuple[float, float]:
        """Least and greatest pressure of the ladder [Pa]; by default 1e-5 and 0.9 of the hardness.

        Elastic: 1e-5 and 0.3 of the pressure that closes the surface, half of E* times its rms slope.
        """
        if self.elastic:
            heights, (dx, dy) = np.asarray(self.scan.heights), self.scan.spacing
            slope = np.hypot(np.diff(heights, axis=1).std() / dx, np.diff(heights, axis=0).std() / dy)
            full, share = self.pair.E_star * float(slope) / 2, 0.3
        else:
            full, share = self.pair.hardness, 0.9
        low = 1e-5 * full if self.lowest is None else self.lowest
        return low, share * full if self.highest is None else self.highest

    @property
    def nu(self) -> float:
        """Poisson's ratio of the one body that has the pair's normal and tangential compliance [-]."""
        # compliances: (1 - nu)/G normal, 1/G and nu/G tangential; those of the pair are sums over its bodies
        bodies = [m for m in (self.pair.first, self.pair.second) if not m.is_rigid]
        return sum(m.nu / m.G for m in bodies) / sum(1 / m.G for m in bodies)

    def contact_at(self, pressure: float, *, start: HalfSpaceContact | None = None, **options: Any) -> HalfSpaceContact:
        """Solve the contact itself at one pressure [Pa], with maps, certificate and tangent."""
        return self._solve(np.asarray(self.scan.heights), self.scan.spacing, pressure, start=start, **options)

    def _solve(self, heights: Array, spacing: tuple[float, float], pressure: float, **options: Any) -> HalfSpaceContact:
        return solve_half_space(
            heights,
            spacing,
            E_star=self.pair.E_star,
            pressure=pressure,
            nu=self.nu,
            tol=self.tol,
            hardness=None if self.elastic else self.pair.hardness,
            periodic=self.periodic,
            **options,
        )

    def _numbers(self, contact: HalfSpaceContact) -> dict[str, float]:
        tangent = contact.tangent()
        out = {
            "area": contact.area_corrected if self.area == "corrected" else contact.area,
            "k_n": tangent.k_n_unloading if self.stiffness == "unloading" else tangent.k_n_loading,
            "k_t": tangent.k_t,
            "loss_n": 0.0 if self.stiffness == "unloading" else contact.plastic_work / contact.elastic_energy,
            "loss_t": 0.0,
            "energy_n": contact.elastic_energy + (0.0 if self.stiffness == "unloading" else contact.plastic_work),
            "energy_t": 0.0,
        }
        if self.shear_ratio > 0:
            slip = contact.slip(self.shear_ratio, self.pair.friction)
            out |= {"k_t": slip.k_t, "loss_t": slip.loss_factor}
            out["energy_t"] = slip.tangential_pressure * slip.displacement / 2
        return out

    @cached_property
    def ladder(self) -> tuple[HalfSpaceContact, ...]:
        """The solved contacts, from the least to the greatest pressure."""
        contacts: list[HalfSpaceContact] = []
        for pressure in np.geomspace(*self.closure_range, self.points):
            contacts.append(self.contact_at(float(pressure), start=contacts[-1] if contacts else None))
            if self.progress is not None:
                self.progress(len(contacts), self.points)
        return tuple(contacts)

    @cached_property
    def _rungs(self) -> _Ladder:
        rows = [self._numbers(contact) for contact in self.ladder]
        return _Ladder(
            pressure=np.geomspace(*self.closure_range, self.points),
            values={name: np.array([row[name] for row in rows]) for name in rows[0]},
            contact_points=np.array([np.count_nonzero(c.traction) for c in self.ladder], dtype=float),
            k_n_change=self._k_n_change(np.array([row["k_n"] for row in rows])),
        )

    def _k_n_change(self, fine: Array) -> Array:
        """Relative change of k_n [Pa/m] at the rungs on half as many points each way; 0 where all points touch."""
        heights, spacing = halved_map(np.asarray(self.scan.heights), self.scan.spacing)
        change, contact = np.zeros(fine.shape), None
        for i, pressure in enumerate(np.geomspace(*self.closure_range, self.points)):
            if np.isfinite(fine[i]):
                contact = self._solve(heights, spacing, float(pressure), start=contact)
                tangent = contact.tangent()
                coarse = tangent.k_n_unloading if self.stiffness == "unloading" else tangent.k_n_loading
                change[i] = coarse / fine[i] - 1
        return change

    def at_closure(self, closure: ArrayLike) -> Response:
        """Return the response at pressures [Pa] within `closure_range`, any shape."""
        from scipy.interpolate import PchipInterpolator

        p = np.asarray(closure, dtype=float)
        table = self._rungs
        x, at = np.log(table.pressure), np.log(p)

        def between(values: Array) -> Array:
            finite = np.isfinite(values)
            if np.all(values[finite] > 0) and finite.sum() >= 2:
                inside = np.exp(PchipInterpolator(x[finite], np.log(values[finite]))(at))
            else:
                inside = PchipInterpolator(x[finite], values[finite])(at)
            # stiffness is infinite from the first rung on at which every point touches
            return np.where(at > x[finite][-1], values[-1], inside) if not finite.all() else np.asarray(inside)

        points = between(table.contact_points)
        change = np.interp(at, x, np.abs(table.k_n_change))
        return Response(
            pressure=p,
            **{name: between(values) for name, values in table.values.items()},
            reasons={
                f"fewer than {FEWEST_POINTS} points of the scan touch": points < FEWEST_POINTS,
                f"k_n changes by more than {RESOLVED:.0%} on half the points each way": change > RESOLVED,
                "every point of the scan touches": points >= self.scan.heights.size * (1 - 1e-9),
            },
        )

    def resolution_error(self, pressure: float) -> dict[str, float]:
        """Relative change of area, k_n and k_t when the scan is halved in points each way [-].

        The scan's own error is of the same order where the change is small, and the answer rests on roughness that
        the scan does not resolve where it is not.
        """
        heights, spacing = halved_map(np.asarray(self.scan.heights), self.scan.spacing)
        fine = self._numbers(self.contact_at(pressure))
        coarse = self._numbers(self._solve(heights, spacing, pressure))
        return {name: coarse[name] / fine[name] - 1 for name in ("area", "k_n", "k_t")}
