"""A contact law computed on a scan: a ladder of half-space contacts, read between its rungs."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from math import isfinite, pi
from pathlib import Path
from typing import Any, ClassVar, Literal, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.inputs import HeightMap
from faying.contact.ladder import Ladder, cached, cached_numbers, climb
from faying.contact.law import ContactLaw, Response
from faying.contact.parameter import TABLE, TEXT, Parameter
from faying.errors import InputError
from faying.halfspace.arrays import Device
from faying.halfspace.solution import HalfSpaceContact
from faying.halfspace.solve import halved_map, solve_half_space
from faying.materials import ContactPair
from faying.typing import Array

FEWEST_POINTS = 30
RESOLVED = 0.25  # greatest change of ln k_n on half the points each way


@final
@dataclass(frozen=True)
class HalfSpace(ContactLaw):
    """The numerical contact of a scan with a flat, both bodies as one elastic half-space; limited to hardness.

    Closure variable: the pressure [Pa]. k_n_low and k_n_high: the range in which k_n of a scan with four times as many
    points each way is looked for, from what k_n changed by on half and a quarter of the points, and from what it
    differs by between the quarters of the window. Flagged where fewer than 30 points touch, and where k_n changes by
    more than 25 % on half the points. The law ends where every point touches.

    Args:
        scan: of the rough face (levelled, without missing points; anything with heights [m] and spacing (dx, dy)
            [m]); where both faces are rough, the scan of their sum.
        pair: the materials that meet.
        elastic: leave out the hardness; a pair that does not yield has none.
        stiffness: "unloading", k_n against a small fall of the load, which is what a vibration sees: elastic, energy_n
            the strain energy; or "loading", k_n against its growth, loss_n the plastic work of first loading over 2 pi
            times the strain energy, energy_n their sum.
        area: "corrected" for the size of the points, or as "counted".
        shear_ratio: X = T/(mu F); above 0, k_t is that of the points that still stick and loss_t follows from their
            slip (needs the pair's friction); at 0 no loss is predicted.
        periodic: as in `solve_half_space`.
        points: pressures at which the contact is solved, spaced evenly in ln(pressure); between them each quantity is a
            monotone cubic in logarithms. Large maps are solved on fewer of them.
        lowest, highest: the first and the last of these pressures [Pa].
        tol: as in `solve_half_space`.
        device: "cpu", or "gpu" to solve with CuPy on a graphics card.
        progress: called with (solutions done, solutions in all) while they are solved, on first use.
        cache: folder that keeps solved contacts by the hash of all that they depend on; None keeps nothing.

    Raises:
        InputError: for parameters out of range and whatever `solve_half_space` does not accept.

    Source:
        Polonsky and Keer 1999, doi:10.1016/S0043-1648(99)00113-1.
    """

    scan: HeightMap
    pair: ContactPair
    elastic: bool = False
    stiffness: Literal["unloading", "loading"] = "unloading"
    area: Literal["corrected", "counted"] = "corrected"
    shear_ratio: float = 0.0
    periodic: bool = True
    points: int = 13
    lowest: float | None = None
    highest: float | None = None
    tol: float = 1e-5
    device: Device = "cpu"
    progress: Callable[[int, int], object] | None = field(default=None, repr=False, compare=False)
    cache: Path | None = field(default=None, repr=False, compare=False)

    name: ClassVar[str] = "half-space"
    source: ClassVar[str] = "doi:10.1016/S0043-1648(99)00113-1"
    parameters: ClassVar[Mapping[str, Parameter]] = {
        "scan": Parameter(TABLE, "levelled heights of the scan", surface="scan"),
        "stiffness": Parameter(TEXT, "direction in which k_n is taken", choices=("unloading", "loading")),
        "area": Parameter(TEXT, "real area, freed of the points' size or as counted", choices=("corrected", "counted")),
        "shear_ratio": Parameter("", "tangential load over friction times normal load", 0, 1, "[)"),
        "points": Parameter("", "pressures at which the contact is solved", 4, 200, "[]", whole=True),
        "lowest": Parameter("Pa", "least pressure covered", 0),
        "highest": Parameter("Pa", "greatest pressure covered, above the least and below the hardness", 0),
        "tol": Parameter("", "error bound asked of every contact", 0, 1),
        "device": Parameter(TEXT, "where contacts are solved: CPU, or graphics card with CuPy", choices=("cpu", "gpu")),
        "cache": Parameter(TABLE, "folder that keeps solved contacts", surface="cache"),
        "progress": Parameter(TABLE, "told how many contacts are solved", surface="progress"),
    }
    validity: ClassVar[str] = (
        "the scan resolves the roughness that touches: at least 30 points in contact, some open, and "
        "k_n within 25 % on half the points each way"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "points", int(self.points))  # the command line reads numbers as floats
        low, high = self.asked
        if not 0 < low < high < np.inf:
            raise InputError(f"half-space: pressures from {low:.4g} to {high:.4g} Pa; give 0 < lowest < highest")
        if self._hardness is not None and high >= self._hardness:
            raise InputError(
                f"half-space: highest = {high:.4g} Pa is not below the hardness {self.pair.hardness:.4g} Pa; "
                "lower it, or set elastic=True"
            )
        if self.shear_ratio > 0:
            _ = self.pair.friction

    @property
    def closure_range(self) -> tuple[float, float]:
        """Least and greatest pressure of the ladder [Pa]: as asked, or up to where every point touches."""
        return float(self.ladder.pressure[0]), float(self.ladder.pressure[-1])

    @property
    def asked(self) -> tuple[float, float]:
        """Least and greatest pressure to solve [Pa]; by default 1e-5 and 0.9 of the hardness.

        Elastic: 1e-5 and 0.3 of the pressure that closes the surface, half of E* times its rms slope.
        """
        if self._hardness is None:
            heights, (dx, dy) = np.asarray(self.scan.heights), self.scan.spacing
            slope = np.hypot(np.diff(heights, axis=1).std() / dx, np.diff(heights, axis=0).std() / dy)
            full, share = self.pair.E_star * float(slope) / 2, 0.3
        else:
            full, share = self._hardness, 0.9
        low = 1e-5 * full if self.lowest is None else self.lowest
        return low, share * full if self.highest is None else self.highest

    @property
    def _hardness(self) -> float | None:
        """What a point can carry [Pa]; None without end."""
        return None if self.elastic or not isfinite(self.pair.hardness) else self.pair.hardness

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
            device=self.device,
            hardness=self._hardness,
            periodic=self.periodic,
            **options,
        )

    def _numbers(self, contact: HalfSpaceContact, detail: bool = True) -> dict[str, float]:
        unloading = self.stiffness == "unloading"
        work = 0.0 if unloading else contact.plastic_work
        area = contact.area_corrected if self.area == "corrected" else contact.area
        out = {"area": area, "energy_n": contact.elastic_energy + work}
        if not detail:
            return out | {"k_n": contact.normal_stiffness(loading=not unloading)}
        tangent = contact.tangent()
        out |= {"k_n": tangent.k_n_unloading if unloading else tangent.k_n_loading, "k_t": tangent.k_t}
        if unloading:
            out["k_load"] = tangent.k_n_loading
        else:
            out["loss_n"] = work / (2 * pi * contact.elastic_energy)
        if self.shear_ratio > 0:
            slip = contact.slip(self.shear_ratio, self.pair.friction)
            out |= {"k_t": slip.k_t, "loss_t": slip.loss_factor}
            out["energy_t"] = slip.tangential_pressure * slip.displacement / 2
        return out

    def stiffness_of_contact(self, pressure: float) -> float:
        """k_n [Pa/m] of the one contact at a pressure [Pa], solved or read from the cache, not from the ladder."""

        def make() -> Mapping[str, Array]:
            return {"k_n": np.asarray(self.contact_at(pressure).normal_stiffness(loading=self.stiffness == "loading"))}

        names = ("elastic", "stiffness", "periodic", "tol")
        key = self._key(names) | {"pressure": float(pressure)}
        return float(
            cached_numbers(make, self.cache, "contact", key, np.asarray(self.scan.heights, dtype=float))["k_n"]
        )

    def _key(self, names: tuple[str, ...]) -> dict[str, object]:
        """What contacts of this scan depend on beside its heights: entries of these names, spacing, and pair."""
        key: dict[str, object] = {name: getattr(self, name) for name in names}
        key |= {"spacing": tuple(map(float, self.scan.spacing)), "nu": self.nu}
        return key | {"E_star": self.pair.E_star, "hardness": self._hardness}

    @cached_property
    def ladder(self) -> Ladder:
        """The numbers of the contacts, solved on first use or read from the cache."""
        heights = np.asarray(self.scan.heights, dtype=float)
        names = ("elastic", "stiffness", "area", "shear_ratio", "periodic", "points", "tol")
        key = self._key(names) | {"pressure": self.asked}
        if self.shear_ratio > 0:
            key["friction"] = self.pair.friction

        def make() -> Ladder:
            pressure = np.geomspace(*self.asked, self.points)
            return climb(heights, self.scan.spacing, pressure, self._solve, self._numbers, self.progress)

        return cached(make, self.cache, key, heights)

    @cached_property
    def _curves(self) -> Mapping[str, Callable[[Array], Array]]:
        """Every quantity as a function of ln(pressure)."""
        ladder = self.ladder
        rows = {"points": ladder.points, **ladder.values}
        rows |= {"low": ladder.least_factor, "high": ladder.greatest_factor}
        return {name: _monotone(np.log(ladder.pressure), row) for name, row in rows.items()}

    def at_closure(self, closure: ArrayLike) -> Response:
        """Return the response at pressures [Pa] within `closure_range`, any shape."""
        p = np.asarray(closure, dtype=float)
        x = np.log(p)
        curve = self._curves
        values = {name: curve[name](x) for name in self.ladder.values}
        change = np.interp(x, np.log(self.ladder.pressure), np.abs(self.ladder.change[0]))
        return Response(
            pressure=p,
            k_n_low=values["k_n"] * curve["low"](x),
            k_n_high=values["k_n"] * curve["high"](x),
            **values,
            reasons={
                f"fewer than {FEWEST_POINTS} points of the scan touch": curve["points"](x) < FEWEST_POINTS,
                f"k_n changes by more than {RESOLVED:.0%} on half the points each way": change > RESOLVED,
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


def _monotone(x: Array, values: Array) -> Callable[[Array], Array]:
    """A monotone cubic through the logarithms where all values are positive, through the values else."""
    from scipy.interpolate import PchipInterpolator

    if not np.all(values > 0):
        return lambda at: np.asarray(PchipInterpolator(x, values)(at))
    curve = PchipInterpolator(x, np.log(values))
    return lambda at: np.asarray(np.exp(curve(at)))
