"""A contact law computed on a scan: half-space contacts at rising pressures, read between them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import isfinite, pi
from pathlib import Path
from typing import Any, ClassVar, Literal, final

import numpy as np
from numpy.typing import ArrayLike

from faying.checks import flag
from faying.contact.inputs import HeightMap
from faying.contact.law import ContactLaw, Response
from faying.contact.measured_range import MeasuredRange
from faying.contact.memory import DEEPEST, Memory
from faying.contact.parameter import TABLE, TEXT, Parameter
from faying.contact.pressure_series import PressureSeries, cached, cached_numbers, monotone, solve_series
from faying.errors import InputError, shown
from faying.halfspace.sized import solve_with_size
from faying.halfspace.solution import HalfSpaceContact
from faying.halfspace.solve import halved_map, solve_half_space
from faying.hardness import VickersHardness
from faying.materials import ContactPair
from faying.typing import Array
from faying.units import show

MIN_SPOTS = 10
COARSE = 0.5  # greatest share of the stiffness on spots of fewer than 4 points
LAY = 0.02  # relative difference of k_t along and across the lay that is said
STEP = 1.05  # factor of pressure either way over which the slope of one contact's loading curve is taken
FINEST = 512  # points a side up to which unloading is solved: its ratios to first loading change by 5 % from 400 to 800
RESOLVED = 0.25  # greatest change of ln k_n on half the points each way


@final
@dataclass(frozen=True)
class HalfSpace(ContactLaw):
    """The numerical contact of a scan with a flat, both bodies as one elastic half-space; limited to hardness.

    Closure variable: the pressure [Pa]. The contact is solved at rising pressures. Both branches follow from it:

    - unloading, k_n = dp/d(approach) while the load changes by little: every touching point is elastic. It is what
      vibration, ultrasound and conductance see.
    - loading, k_load = dp/d(approach) on first loading: the slope of pressure over the approach of the solved contacts.
      It is what a slow approach curve, the preload and embedding see.

    Where the pair has a hardness over the size of an indentation, each spot has the hardness of its own size.

    k_n_low and k_n_high: the range in which k_n of a scan with four times as many points each way is looked for, from
    what k_n changed by on half and a quarter of the points, widened by what it differs by between the quarters of the
    window, and by what it changes by with a hardness 1.35 times as high or as low. Flagged where fewer than 10 spots
    touch, where more than half of the stiffness rests on spots of fewer than 4 points, and where k_n changes by more
    than 25 % on half the points. The law ends where every point touches.

    Args:
        scan: of the rough face (levelled, without missing points; anything with heights [m] and spacing (dx, dy)
            [m]); where both faces are rough, the scan of their sum.
        pair: the materials that meet.
        elastic: leave out the hardness; a pair that does not yield has none.
        stiffness: the branch that k_n is: "unloading", with energy_n the strain energy and k_load of its own; or
            "loading", with loss_n the plastic work of first loading over 2 pi times the strain energy, and energy_n
            their sum.
        area: "corrected" for the size of the points, or as "counted".
        shear_ratio: X = T/(mu F); above 0, k_t is that of the points that still stick and loss_t follows from their
            slip (needs the pair's friction); at 0 no loss is predicted.
        periodic: as in `solve_half_space`.
        points: pressures of the series, spaced evenly in ln(pressure); between them each quantity is a monotone cubic.
            The map on a quarter of the points each way is solved at all of them, a large map itself at a quarter of
            them and where its loading curve needs more.
        lowest, highest: the first and the last of these pressures [Pa].
        tol: as in `solve_half_space`.
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
    points: int = 25
    lowest: float | None = None
    highest: float | None = None
    tol: float = 1e-5
    progress: Callable[[int, int], object] | None = field(default=None, repr=False, compare=False)
    cache: Path | None = field(default=None, repr=False, compare=False)

    name: ClassVar[str] = "half-space"
    measured_ranges: ClassVar = {"half-space": MeasuredRange(hard=1.4, soft=0.18, factor=5.8)}
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
        "cache": Parameter(TABLE, "folder that keeps solved contacts", surface="cache"),
        "progress": Parameter(TABLE, "told how many contacts are solved", surface="progress"),
    }
    validity: ClassVar[str] = (
        "the scan resolves the roughness that touches: at least 10 spots, half of the stiffness on spots of 4 points "
        "or more, some points open, and k_n within 25 % on half the points each way"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        flag(self.elastic, "half-space: elastic")
        flag(self.periodic, "half-space: periodic")
        heights, spacing = (np.asarray(getattr(self.scan, name, None)) for name in ("heights", "spacing"))
        if heights.ndim != 2 or spacing.size != 2:
            raise InputError(
                f"half-space: scan: {shown(self.scan)}; give an areal scan, as faying.read_scan returns it, levelled "
                "and filled"
            )
        object.__setattr__(self, "points", int(self.points))  # the command line reads numbers as floats
        low, high = self.pressure_ends
        if not 0 < low < high < np.inf:
            raise InputError(f"half-space: pressures from {low:.4g} to {high:.4g} Pa; give 0 < lowest < highest")
        if self._hardness is not None and high >= self._hardness:
            raise InputError(
                f"half-space: highest = {high:.4g} Pa is not below the hardness {self._hardness:.4g} Pa; "
                "lower it, or set elastic=True"
            )
        if self.shear_ratio > 0:
            _ = self.pair.friction

    @property
    def closure_range(self) -> tuple[float, float]:
        """Least and greatest pressure of the series [Pa]: as asked, or up to where every point touches."""
        return float(self.series.pressure[0]), float(self.series.pressure[-1])

    @property
    def pressure_ends(self) -> tuple[float, float]:
        """Least and greatest pressure to solve [Pa]; by default 1e-5 and 0.9 of the hardness.

        Where spots are the harder the smaller they are, 0.55 of that of the bulk.

        Elastic: 1e-5 and 0.3 of the pressure that closes the surface, half of E* times its rms slope.
        """
        if self._hardness is None:
            heights, (dx, dy) = np.asarray(self.scan.heights), self.scan.spacing
            slope = np.hypot(np.diff(heights, axis=1).std() / dx, np.diff(heights, axis=0).std() / dy)
            full, share = self.pair.E_star * float(slope) / 2, 0.3
        else:
            full, share = self._hardness, 0.9 if self._size is None else 0.55
        low = 1e-5 * full if self.lowest is None else self.lowest
        return low, share * full if self.highest is None else self.highest

    @property
    def _hardness(self) -> float | None:
        """What a point of a large spot can carry [Pa]; None without end."""
        if self.elastic:
            return None
        if self._size is not None:
            return self.pair.bulk_hardness
        return self.pair.hardness if isfinite(self.pair.hardness) else None

    @property
    def _size(self) -> VickersHardness | None:
        """Hardness over the size of a spot; None where all spots have one."""
        law = None if self.elastic else self.pair.vickers
        return law if law is not None and law.c2 != 0 else None

    @property
    def nu(self) -> float:
        """Poisson's ratio of the one body that has the pair's normal and tangential compliance [-]."""
        # compliances: (1 - nu)/G normal, 1/G and nu/G tangential; those of the pair are sums over its bodies
        bodies = [m for m in (self.pair.first, self.pair.second) if not m.is_rigid]
        return sum(m.nu / m.G for m in bodies) / sum(1 / m.G for m in bodies)

    def contact_at(self, pressure: float, *, start: HalfSpaceContact | None = None, **options: Any) -> HalfSpaceContact:
        """Solve the contact itself at one pressure [Pa], with maps, error bound and tangent."""
        return self._solve(np.asarray(self.scan.heights), self.scan.spacing, pressure, start=start, **options)

    def _solve(
        self,
        heights: Array,
        spacing: tuple[float, float],
        pressure: float,
        *,
        start: HalfSpaceContact | None = None,
        harder: float = 1.0,
        **options: Any,
    ) -> HalfSpaceContact:
        def solve(hardness: float | Array | None, start: HalfSpaceContact | None) -> HalfSpaceContact:
            return solve_half_space(
                heights,
                spacing,
                E_star=self.pair.E_star,
                pressure=pressure,
                nu=self.nu,
                tol=self.tol,
                hardness=hardness,
                periodic=self.periodic,
                start=start,
                **options,
            )

        size = self._size
        if size is None:
            return solve(None if self._hardness is None else harder * self._hardness, start)
        return solve_with_size(solve, heights.shape, spacing, size.times(harder), start)

    def _numbers(self, contact: HalfSpaceContact, detail: bool = True) -> dict[str, float]:
        unloading = self.stiffness == "unloading"
        work = 0.0 if unloading else contact.plastic_work
        area = contact.area_corrected if self.area == "corrected" else contact.area
        k_n = contact.normal_stiffness(loading=False)
        out = {"area": area, "energy_n": contact.elastic_energy + work, "k_n": k_n}
        if not detail:
            return out
        tensor = contact.tangential_stiffness()
        along = np.linalg.eigvalsh(tensor)
        out |= {"k_t": float(np.trace(tensor)) / 2, "lay": float(along[1] / along[0])}
        if not unloading:
            out["loss_n"] = work / (2 * pi * contact.elastic_energy)
        if self.shear_ratio > 0:
            slip = contact.slip(self.shear_ratio, self.pair.friction)
            out |= {"k_t": slip.k_t, "loss_t": slip.loss_factor}
            out["energy_t"] = slip.tangential_pressure * slip.displacement / 2
        return out

    def stiffness_of_contact(self, pressure: float) -> float:
        """k_n [Pa/m] of the contact at one pressure [Pa], solved or read from the cache, not from the series.

        On loading it is the slope of the approach between contacts at 1/1.05 and 1.05 times the pressure.
        """

        def make() -> Mapping[str, Array]:
            contact = self.contact_at(pressure)
            if self.stiffness == "unloading":
                return {"k_n": np.asarray(contact.normal_stiffness(loading=False))}
            low, high = (self.contact_at(p, start=contact) for p in (pressure / STEP, pressure * STEP))
            return {"k_n": np.asarray((high.pressure - low.pressure) / (high.closing - low.closing))}

        names = ("elastic", "stiffness", "periodic", "tol")
        key = self._key(names) | {"pressure": float(pressure)}
        heights = np.asarray(self.scan.heights, dtype=float)
        return float(cached_numbers(make, self.cache, "contact", key, heights)["k_n"])

    def _key(self, names: tuple[str, ...]) -> dict[str, object]:
        """What contacts of this scan depend on beyond its heights: entries of these names, spacing, and pair."""
        key: dict[str, object] = {name: getattr(self, name) for name in names}
        key |= {"spacing": tuple(map(float, self.scan.spacing)), "nu": self.nu}
        size = self._size
        key["size"] = None if size is None else (size.c1, size.c2, size.least)
        return key | {"E_star": self.pair.E_star, "hardness": self._hardness}

    @cached_property
    def series(self) -> PressureSeries:
        """The numbers of the contacts at rising pressures, solved on first use or read from the cache."""
        heights = np.asarray(self.scan.heights, dtype=float)
        names = ("elastic", "stiffness", "area", "shear_ratio", "periodic", "points", "tol")
        key = self._key(names) | {"pressure": self.pressure_ends}
        if self.shear_ratio > 0:
            key["friction"] = self.pair.friction

        def make() -> PressureSeries:
            return solve_series(
                heights,
                self.scan.spacing,
                np.geomspace(*self.pressure_ends, self.points),
                self._solve,
                self._numbers,
                self.progress,
                sized=self._size is not None,
            )

        return cached(make, self.cache, key, heights)

    @cached_property
    def _curves(self) -> Mapping[str, Callable[[Array], Array]]:
        """Every quantity as a function of ln(pressure)."""
        from scipy.interpolate import PchipInterpolator

        series, loading = self.series, self.stiffness == "loading"
        rows = {"spots": series.spots, "coarse": series.coarse, **series.values}
        rows |= {"low": series.least_factor(loading=loading), "high": series.greatest_factor(loading=loading)}
        x = np.log(series.pressure)
        closing = PchipInterpolator(x, series.closing)
        own = {"closing": closing, "closing_slope": closing.derivative()}
        return own | {name: monotone(x, row) for name, row in rows.items()}

    def closing(self, pressure: ArrayLike) -> Array:
        """Return how far the faces have closed [m] at pressures [Pa], any shape, counted from the mean heights.

        The loading curve: k_load is the slope of the pressure over it.
        """
        return np.asarray(self._curves["closing"](np.log(np.asarray(pressure, dtype=float))))

    def at_closure(self, closure: ArrayLike) -> Response:
        """Return the response at pressures [Pa] within `closure_range`, any shape."""
        p = np.asarray(closure, dtype=float)
        x = np.log(p)
        curve = self._curves
        values = {name: curve[name](x) for name in self.series.values if name != "lay"}
        # the faces close by no less than they spring back: where spots have just merged k_load is k_n
        unloading = curve["k_n"](x)
        k_load = p / np.maximum(curve["closing_slope"](x), p / unloading)
        if self.stiffness == "loading":
            values["k_n"] = k_load
        else:
            values["k_load"] = k_load
        change = np.interp(x, np.log(self.series.pressure), np.abs(self.series.change[0]))
        return Response(
            pressure=p,
            k_n_low=values["k_n"] * curve["low"](x),
            k_n_high=values["k_n"] * curve["high"](x),
            **values,
            reasons={
                f"fewer than {MIN_SPOTS} spots of the scan touch": curve["spots"](x) < MIN_SPOTS,
                f"more than {COARSE:.0%} of the stiffness rests on spots of fewer than 4 points; a finer lens would "
                "change it": curve["coarse"](x) > COARSE,
                f"k_n changes by more than {RESOLVED:.0%} on half the points each way": change > RESOLVED,
            },
        )

    @cached_property
    def memory(self) -> Memory | None:
        """Unloading and loading again on the heights that a greatest pressure has flattened; None on loading."""
        if self.stiffness == "loading" and self._hardness is not None:
            return None
        return Memory.of(*self.closure_range, self._ratios)

    def _ratios(self, pressure: Array) -> Mapping[str, Array]:
        """Ratios (n, n) at pressures [Pa] after each of them; see `Memory.of`."""
        heights, spacing = np.asarray(self.scan.heights, dtype=float), self.scan.spacing
        while max(heights.shape) > FINEST:
            heights, spacing = halved_map(heights, spacing)
        last, elastic = len(pressure) - 1, replace(self, elastic=True)

        def make() -> Mapping[str, Array]:
            contacts: list[HalfSpaceContact] = []
            for p in pressure:
                contacts.append(self._solve(heights, spacing, p, start=contacts[-1] if contacts else None))
            first = [self._numbers(contact) for contact in contacts]
            out = {name: np.full((last + 1, last + 1), np.nan) for name in first[0] if name not in ("lay", "loss_n")}
            for name in out:
                np.fill_diagonal(out[name], 1.0)
            for after in range(last, 0, -1):
                contact, flat = contacts[after], contacts[after].flattened
                for at in range(after - 1, max(after - DEEPEST, 0) - 1, -1):
                    contact = elastic._solve(flat, spacing, float(pressure[at]), start=contact)
                    numbers = self._numbers(contact)
                    for name, ratios in out.items():
                        ratios[at, after] = numbers[name] / first[at][name]
                if self.progress is not None:
                    self.progress(last - after, last)
            return out

        if self._hardness is None:
            return dict.fromkeys(self.series.values, np.ones((last + 1, last + 1)))
        names = ("area", "shear_ratio", "periodic", "tol")
        key = self._key(names) | {"pressure": tuple(pressure), "friction": self.shear_ratio and self.pair.friction}
        return cached_numbers(make, self.cache, "memory", key, np.asarray(self.scan.heights, dtype=float))

    @property
    def branch(self) -> str:
        """What k_n is the slope of."""
        return self.stiffness

    def _reach(self) -> str:
        """What the solved contacts cover; what is asked of them as long as none is solved."""
        if "series" in vars(self):
            return super()._reach()
        low, high = self.pressure_ends
        return f"from {show(low, 'Pa')} to {show(high, 'Pa')} at most; contacts are solved on first use"

    def _assumed(self) -> tuple[str, ...]:
        return self.assumptions if "series" in vars(self) else ()

    def summary(self) -> tuple[str, dict[str, str]]:
        """As of every law, with the size of the map."""
        rows, columns = np.shape(self.scan.heights)
        dx, dy = self.scan.spacing
        heading, own = super().summary()
        size = f"{columns} x {rows} points on {show(columns * dx, 'm')} x {show(rows * dy, 'm')}"
        return heading, {"source": own.pop("source"), "scan": size, **own}

    @property
    def assumptions(self) -> tuple[str, ...]:
        """That k_t is one number, where the lay makes two of it; that spots of every size have one hardness."""
        out, ratio = [], float(np.median(self.series.values["lay"]))
        if ratio >= 1 + LAY:
            out.append(f"its k_t is the mean of two directions, which differ by {ratio - 1:.0%} (lay of the scan)")
        if self._hardness is not None and self.pair.vickers is None:
            out.append(
                f"the spots have the hardness of {self.pair.softer.name}, {show(self._hardness, 'Pa')}, at any size; "
                "small spots are harder, so that frequencies may be a tenth too high: give brinell of the material"
            )
        return tuple(out)
