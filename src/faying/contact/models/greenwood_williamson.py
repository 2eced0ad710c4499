"""Greenwood and Williamson 1966: summits of one radius and Gaussian heights, with any asperity law."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from math import pi, sqrt
from typing import ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.asperity.base import AsperityModel, AsperityResponse, summed_model
from faying.contact.asperity.hertz import Hertz
from faying.contact.asperity.jackson_green import JacksonGreen
from faying.contact.asperity.kogut_etsion import KogutEtsion
from faying.contact.asperity.unloading import EtsionKligermanKadin
from faying.contact.law import ContactLaw, Response
from faying.contact.measured_range import MeasuredRange
from faying.contact.memory import DEEPEST, Memory
from faying.contact.parameter import TEXT, Parameter
from faying.errors import InputError
from faying.materials import ContactPair
from faying.typing import Array

# what is summed: heights to this many standard deviations, with this many points on each panel
HIGHEST, NODES = 8.5, 10
FARTHEST, NEAREST = 6.0, -3.0
SUMMITS_UNLOAD = (KogutEtsion, JacksonGreen)  # laws of loading on which the fits of unloading are used
UNLOADED = 400  # separations of a curve of unloading: ln p over ln k between them to 1e-4


@final
@dataclass(frozen=True, kw_only=True)
class GreenwoodWilliamson(ContactLaw):
    """p = eta int_d^inf f(z - d) phi(z) dz over the heights z of the summits, likewise area, stiffness and energy.

    doi:10.1098/rspa.1966.0242. density eta of summits [1/m2]; radius R [m]; sigma, standard deviation of their heights
    [m]; pair; asperity, the name of any model of `faying.contact.asperity` (Chang, Etsion and Bogy 1987, Kogut and
    Etsion 2003, Zhao, Maietta and Chang 2000, Jackson and Green 2006 are this law with theirs).

    Closure variable: the separation d [m] from the mean plane of the summits, 6 to -3 sigma. Stiffness is the exact
    derivative -dp/dd, jumps of the asperity's force included. No tangential stiffness and no loss: the source
    defines none. Raises InputError for values that are not positive and unknown asperities.
    """

    density: float
    radius: float
    sigma: float
    pair: ContactPair
    asperity: str = "Hertz"

    name: ClassVar[str] = "GW"
    measured_ranges: ClassVar = {
        "GW": MeasuredRange(hard=2.7, soft=1.1, factor=3.8),
        "GW-CEB": MeasuredRange(hard=3.0, soft=1.7, factor=3.8),
        "GW-KE": MeasuredRange(hard=2.9, soft=1.6, factor=3.8),
        "GW-ZMC": MeasuredRange(hard=2.8, soft=1.6, factor=3.8),
        "GW-JG": MeasuredRange(hard=2.9, soft=1.8, factor=3.9),
    }
    source: ClassVar[str] = "doi:10.1098/rspa.1966.0242"
    validity: ClassVar[str] = "real area up to 0.3, separation above that of the summits' mean plane; no interaction"
    geometric: ClassVar[bool] = False
    plastic_summits: ClassVar[bool] = True
    # the asperities that published models put into the sum
    variants: ClassVar = {
        "GW-CEB": {"asperity": "ChangEtsionBogy"},
        "GW-KE": {"asperity": "KogutEtsion"},
        "GW-ZMC": {"asperity": "ZhaoMaiettaChang"},
        "GW-JG": {"asperity": "JacksonGreen"},
    }
    parameters: ClassVar = {
        "density": Parameter("1/m^2", "summits per area", 0, surface="summit_density"),
        "radius": Parameter("m", "radius of the summits", 0, surface="summit_radius"),
        "sigma": Parameter("m", "standard deviation of the summit heights", 0, surface="summit_deviation"),
        "asperity": Parameter(TEXT, "law of one asperity, one of faying.contact.asperity"),
    }

    def __post_init__(self) -> None:
        super().__post_init__()
        self._asperity  # noqa: B018  # names its own faults

    @cached_property
    def _asperity(self) -> AsperityModel:
        return summed_model(self.asperity, "GW")(R=self.radius, pair=self.pair)

    @property
    def closure_range(self) -> tuple[float, float]:
        """Separations at the least and the greatest load [m]."""
        return FARTHEST * self.sigma, NEAREST * self.sigma

    @cached_property
    def _jumps(self) -> list[tuple[float, float]]:
        """Interference in units of sigma and size [N] of each jump of the asperity's force."""
        law = self._asperity
        unit = 4 / 3 * self.pair.E_star * sqrt(self.radius) * law.critical**1.5
        return [(x * law.critical / self.sigma, unit * law.jump(x)) for x in law.borders]

    @cached_property
    def _points(self) -> tuple[Array, Array]:
        """Interferences t in units of sigma, and their weights (n,).

        Panels end where the asperity's formulas change and grow threefold from there, up to half of sigma; on
        each t = a + (b-a) s^2, so that the square root at first touch is a polynomial in s.
        """
        end = HIGHEST - NEAREST
        edges = [0.0, *(t for t, _ in self._jumps if t < end)]
        even = np.linspace(0, end, int(2 * end) + 1)
        first = min([*edges[1:], even[1]])
        graded = np.geomspace(first, even[1], 1 + int(np.ceil(np.log(even[1] / first) / np.log(3))))[:-1]
        cuts = np.unique(np.concatenate([even, edges, graded]))
        s, w = np.polynomial.legendre.leggauss(NODES)
        s, w = (s + 1) / 2, w / 2
        low, span = cuts[:-1, None], np.diff(cuts)[:, None]
        t = (low + span * s**2).ravel()
        return t, (span * 2 * s * w).ravel()

    @cached_property
    def _nodes(self) -> tuple[Array, Array]:
        """Interferences t in units of sigma, and the weighted values of force, area, k_n, energy there (n, 4)."""
        t, weight = self._points
        return t, _values(self._asperity.at(t * self.sigma)) * weight[:, None]

    @cached_property
    def memory(self) -> Memory | None:
        """Each summit unloads from the interference that it had (Etsion, Kligerman, Kadin 2005); Hertz' stays elastic.

        None for other asperities.
        """
        if not isinstance(self._asperity, (Hertz, *SUMMITS_UNLOAD)):
            return None
        return Memory.of(self.least_pressure, self.greatest_pressure, self._ratios)

    def _ratios(self, pressure: Array) -> Mapping[str, Array]:
        """Ratios (n, n) of unloading to first loading at pressures [Pa] after each of them; see `Memory.of`."""
        names, n = ("area", "k_n", "energy_n"), len(pressure)
        if isinstance(self._asperity, Hertz):
            return dict.fromkeys(names, np.ones((n, n)))
        t, weight = self._points
        way = EtsionKligermanKadin(loading=self._asperity, delta_max=t * self.sigma)
        raised = np.concatenate([[0.0], np.geomspace(1e-4, FARTHEST, UNLOADED) * self.sigma])
        values = _values(way.at(np.maximum(t * self.sigma - raised[:, None], 0.0)))  # (separations, summits, 4)
        closures = self._closure_at(pressure)
        first = self.at_closure(closures).quantities()
        out = {name: np.full((n, n), np.nan) for name in names}
        for after, closure in enumerate(closures):
            heights = weight * np.exp(-((t + closure / self.sigma) ** 2) / 2) / sqrt(2 * pi)
            force, area, k_n, energy = self.density * np.einsum("s,dsq->qd", heights, values)
            lower = slice(max(after - DEEPEST, 0), after + 1)
            x = np.log(pressure[lower])
            shut = (force > 0) & (k_n > 0)
            for name, row in zip(names, (area, k_n, energy), strict=True):
                found = np.interp(x, np.log(force[shut][::-1]), np.log(row[shut][::-1]))
                out[name][lower, after] = np.exp(found) / first[name][lower]
        return out

    def at_closure(self, separation: ArrayLike) -> Response:
        """Return the response at separations d [m], any shape; InputError unless between -3 and 6 sigma."""
        d = np.asarray(separation, float)
        far, near = self.closure_range
        if not np.all((d >= near * (1 + 1e-9)) & (d <= far * (1 + 1e-9))):
            raise InputError(f"GW: separations from {near:.4g} to {far:.4g} m (-3 to 6 sigma) are covered")
        h = (d / self.sigma)[..., None]
        t, values = self._nodes
        heights = np.exp(-((t + h) ** 2) / 2) / sqrt(2 * pi)
        force, area, k_n, energy = np.moveaxis(self.density * heights @ values, -1, 0)
        for jump, size in self._jumps:
            k_n = k_n + self.density * size / self.sigma * np.exp(-((jump + h[..., 0]) ** 2) / 2) / sqrt(2 * pi)
        reasons = {
            "real area above 0.3 of the nominal area": np.asarray(area > 0.3),
            "separation below the mean plane of the summits": np.asarray(d < 0),
        }
        if isinstance(self._asperity, Hertz) and any(m.hardness for m in (self.pair.first, self.pair.second)):
            reasons["mean pressure of the contacts above the hardness"] = np.asarray(force > self.pair.hardness * area)
        return Response(
            pressure=np.asarray(force),
            area=np.asarray(area),
            k_n=np.asarray(k_n),
            energy_n=np.asarray(energy),
            reasons=reasons,
        )


def _values(at: AsperityResponse) -> Array:
    """Force, area, stiffness and energy of summits, along a last axis of four."""
    return np.stack([at.force, at.area, at.stiffness, at.energy], axis=-1)
