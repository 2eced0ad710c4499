"""Greenwood and Williamson's sum over measured asperities: any distribution of gaps, elastic-plastic loading."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from typing import Any, ClassVar, Self, final

import numpy as np
from numpy.typing import ArrayLike

from faying.columns import Wanted, read_list
from faying.contact.asperity.base import AsperityModel, summed_model
from faying.contact.law import ContactLaw, Response, checked, require
from faying.contact.parameter import FILE, TABLE, TEXT, Parameter
from faying.errors import InputError
from faying.materials import ContactPair
from faying.typing import Array

FIRST, REACH = 1e-3, 2.0  # closures covered, in spans of the gaps from the first touch
KNOTS, HINGES = 2000, 5000  # closures at which the sum is taken; pieces of the asperity's curve


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class MeasuredHeights(ContactLaw):
    """p = eta int f(w - g) phi(g) dg over asperities of gap g, as measured. doi:10.1016/j.ymssp.2023.110210.

    gaps [m] (n,), rising: how far an asperity stands off when the highest touches; probability (n,), their probability
    density on any scale, linear between the points; density eta [1/m2]; radius R [m]; pair; asperity: name of a model
    of `faying.contact.asperity`; tangent_ratio: E_t/E for Ghaednia's.

    Closure variable: the closing w [m] from first touch. f is loading, elastic-plastic: `k_load` is dp/dw. What follows
    is small motion about that load, along the elastic unloading of Brake 2015 (doi:10.1016/j.ijsolstr.2015.02.018):
    its slope at the top is 2 E* sqrt(R delta) whatever the force there, its contact radius sqrt(R delta), so that
    k_n = 2 E* eta int sqrt(R delta) phi and k_t = 8 G* eta int sqrt(R delta) phi (Mindlin, no slip). No loss without
    slip. Raises InputError for tables that do not rise, weigh nothing or are negative, and values out of range.
    """

    gaps: ArrayLike
    probability: ArrayLike
    density: float
    radius: float
    pair: ContactPair
    asperity: str = "Ghaednia"
    tangent_ratio: float | None = None

    name: ClassVar[str] = "GW-measured"
    source: ClassVar[str] = "doi:10.1016/j.ymssp.2023.110210"
    validity: ClassVar[str] = "real area up to 0.3; closing within the measured gaps; no interaction between asperities"
    parameters: ClassVar = {
        "gaps": Parameter(TABLE, "distances of the asperities at first touch [m], rising"),
        "probability": Parameter(TABLE, "their probability density, any scale"),
        "density": Parameter("1/m^2", "asperities per area", 0),
        "radius": Parameter("m", "radius of the asperities, both faces together", 0),
        "asperity": Parameter(TEXT, "law of one asperity, one of faying.contact.asperity"),
        "tangent_ratio": Parameter("", "E_t/E of bilinear hardening, Ghaednia's only", 0, 1, "[)"),
    }

    @classmethod
    def entries(cls) -> Mapping[str, Parameter]:
        """A file of gaps and their density stands for the two arrays."""
        own = {name: p for name, p in cls.parameters.items() if p.unit != TABLE}
        return {
            "gaps": Parameter(FILE, "gaps of the asperities and their probability density, in two columns"),
            "gaps_unit": Parameter(TEXT, "unit of the gaps in that file"),
            **own,
        }

    @classmethod
    def from_entries(cls, given: Mapping[str, object], pair: ContactPair) -> Self:
        """Read the file of gaps, then make the law."""
        own: dict[str, Any] = {name: value for name, value in given.items() if name not in ("gaps", "gaps_unit")}
        form = "measured heights have the columns gap and probability density"
        unit = given.get("gaps_unit")
        gaps = Wanted(names=("gap", "gaps"), unit="m", given=None if unit is None else str(unit), key="gaps_unit")
        density = Wanted(names=("probability", "probability density", "density", "chance"), unit="", given=None, key="")
        table = read_list(Path(str(given["gaps"])), (gaps, density), form)
        return cls(gaps=table[:, 0], probability=table[:, 1], pair=pair, **own)

    def __post_init__(self) -> None:
        super().__post_init__()
        need = partial(require, self.name)
        g = checked(self.gaps, name="gaps", unit="m", zero=True)
        c = checked(self.probability, name="probability of the gaps", unit="1/m", zero=True)
        need(
            g.ndim == 1 and g.size >= 2 and g.shape == c.shape,
            f"gaps of shape {g.shape} and probability of shape {c.shape}; give two rows of one length, 2 or more",
        )
        need(bool(np.all(np.diff(g) > 0)), "gaps do not rise; sort the table and drop repetitions")
        need(bool(np.trapezoid(c, g) > 0), "the probability of every gap is 0")
        for name, value in (("gaps", g.copy()), ("probability", c / np.trapezoid(c, g))):
            value.setflags(write=False)
            object.__setattr__(self, name, value)
        self._asperity  # noqa: B018  # names its own faults

    @cached_property
    def _asperity(self) -> AsperityModel:
        cls = summed_model(self.asperity, self.name)
        if self.tangent_ratio is None:
            return cls(R=self.radius, pair=self.pair)
        require(
            self.name,
            cls.__name__ == "Ghaednia",
            f"tangent_ratio belongs to asperity = 'Ghaednia', not {self.asperity!r}; leave it out",
        )
        return cls(R=self.radius, pair=self.pair, tangent_ratio=self.tangent_ratio)  # type: ignore[call-arg]

    @cached_property
    def _touch(self) -> float:
        """The least gap that an asperity has [m]."""
        g, c = np.asarray(self.gaps), np.asarray(self.probability)
        return float(g[max(int(np.argmax(c > 0)) - 1, 0)])

    @cached_property
    def _span(self) -> float:
        return float(np.asarray(self.gaps)[-1]) - self._touch

    @property
    def closure_range(self) -> tuple[float, float]:
        """Closings from the first touch at the least and at the greatest load [m]."""
        return FIRST * self._span, REACH * self._span

    def _summed(self, closing: Array) -> Array:
        """Pressure, area, dp/dw and eta int sqrt(R delta) phi at closings (m,), as (m, 4).

        Each curve f(t) of an asperity is laid on hinges: slopes that change at points t_k, close enough that the sum of
        c_k max(t - t_k, 0) is f to 1e-5. Then int f(w - g) phi dg is the sum of c_k Phi(w - t_k) exactly, with Phi the
        second integral of phi, and steps of phi or of f cost nothing.
        """
        model, end = self._asperity, REACH * self._span
        borders = np.array([x * model.critical for x in model.borders if x * model.critical < end])
        graded = np.geomspace(1e-4 * FIRST * self._span, end, HINGES)
        t = np.unique(np.concatenate([[0.0], graded, borders]))
        below, above = model.at(borders * (1 - 1e-12)), model.at(borders * (1 + 1e-12))
        at = model.at(np.where(np.isin(t, borders), t * (1 - 1e-12), t))
        steps = {"force": above.force - below.force, "area": above.area - below.area}
        passed = t[:, None] > borders
        curves = np.stack(
            [at.force - passed @ steps["force"], at.area - passed @ steps["area"], np.sqrt(self.radius * t)]
        )
        slope = np.diff(curves, axis=1) / np.diff(t)
        hinges = np.diff(slope, axis=1, prepend=0.0)
        out = np.empty((len(closing), 4))
        for begin in range(0, len(closing), 100):  # as much as fits the cache
            w = closing[begin : begin + 100, None]
            second, first = self._integrals(w - t[:-1])
            p, area, radii = hinges @ second.T
            out[begin : begin + 100] = np.stack([p, area, first @ hinges[0], radii], axis=1)
        late = closing[:, None] - borders
        shares = self._integrals(late)[1]
        g, c = np.asarray(self.gaps) - self._touch, np.asarray(self.probability)
        out[:, 0] += shares @ steps["force"]
        out[:, 1] += shares @ steps["area"]
        out[:, 2] += np.interp(late, g, c, left=0.0, right=0.0) @ steps["force"]
        return self.density * out

    def _integrals(self, place: Array) -> tuple[Array, Array]:
        """Second [m] and first [-] integral of the probability density up to a place [m], any shape."""
        from scipy.interpolate import PPoly

        g, c = np.asarray(self.gaps) - self._touch, np.asarray(self.probability)
        density, inside = PPoly(np.stack([np.diff(c) / np.diff(g), c[:-1]]), g), np.clip(place, g[0], g[-1])
        return density.antiderivative(2)(inside) + np.maximum(place - g[-1], 0.0), density.antiderivative()(inside)

    @cached_property
    def _curves(self) -> tuple[Any, ...]:
        """Splines of the logarithms of pressure, area and the sum of contact radii over ln w."""
        from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

        first, last = self.closure_range
        w = np.geomspace(first, last, KNOTS)
        w[[0, -1]] = first, last
        p, area, slope, radii = self._summed(w).T
        x = np.log(w)
        return (
            CubicHermiteSpline(x, np.log(p), slope * w / p),
            PchipInterpolator(x, np.log(area)),
            PchipInterpolator(x, np.log(radii)),
        )

    def _inside(self, closing: ArrayLike) -> Array:
        w = checked(closing, name="closing", unit="m", zero=False)
        first, last = self.closure_range
        if not np.all((w >= first * (1 - 1e-9)) & (w <= last * (1 + 1e-9))):
            raise InputError(f"{self.name}: closings from {first:.4g} to {last:.4g} m are covered")
        return np.log(np.clip(w, first, last))

    def _pressure_at(self, closure: Array) -> Array:
        return np.asarray(np.exp(self._curves[0](self._inside(closure))))

    def at_closure(self, closing: ArrayLike) -> Response:
        """Return the response at closings from first touch [m], any shape; InputError outside `closure_range`."""
        x = self._inside(closing)
        curve, areas, sums = self._curves
        p, area, radii = np.exp(curve(x)), np.exp(areas(x)), np.exp(sums(x))
        return Response(
            pressure=np.asarray(p),
            area=np.asarray(area),
            k_n=np.asarray(2 * self.pair.E_star * radii),
            k_t=np.asarray(8 * self.pair.G_star * radii),
            k_load=np.asarray(p * curve(x, 1) / np.exp(x)),
            reasons={
                "real area above 0.3 of the nominal area": np.asarray(area > 0.3),
                "closing above the largest measured gap": np.asarray(np.exp(x) > self._span * (1 + 1e-9)),
            },
        )
