"""Cooper, Mikic and Yovanovich 1969: spots that yield, measured on joints by the heat that they conduct."""

from dataclasses import dataclass
from functools import cached_property
from math import pi, sqrt
from typing import Any, ClassVar, final

import numpy as np
from numpy.typing import ArrayLike

from faying.contact.law import Response, require
from faying.contact.measured_range import MeasuredRange
from faying.contact.models.area_fraction import OF_PROFILES, AreaFractionLaw
from faying.contact.parameter import Parameter
from faying.errors import InputError
from faying.hardness import VickersHardness
from faying.materials import ContactPair


@final
@dataclass(frozen=True, kw_only=True)
class CMY(AreaFractionLaw):
    """k_n = 1.25 E* (m/sigma) (p/H_c)^0.95, A = p/H_c. doi:10.1016/0017-9310(69)90011-8.

    h_rms sigma [m] of both faces together; mean_slope m [-], mean absolute slope of profiles, both faces together;
    pair; hardness H_c of the spots [Pa], or c1 [Pa] and c2 [-] of a Vickers hardness c1 (d/1 um)^c2, from which H_c
    follows by the size of the spots (doi:10.1109/TCAPT.2005.848483). Where neither is given, the pair gives it.

    The correlation is one of conductance, h = 1.25 K_s (m/sigma) (p/H_c)^0.95; k_n = h E*/K_s (Barber 2003,
    doi:10.1098/rspa.2002.1038) is the stiffness of unloading. First loading: the mean planes lie Y apart,
    A = erfc(Y/(sqrt(2) sigma))/2, and k_load = -dp/dY, at most k_n. k_t is k_n times Mindlin's ratio 4 G*/E*. No
    energy and no loss: the source defines none.

    Closure variable: the real area fraction, p/H_c. Raises InputError for values out of range, for a hardness and
    c1 or c2 at once, and for one of c1, c2 without the other.
    """

    h_rms: float
    mean_slope: float
    pair: ContactPair
    hardness: float | None = None
    c1: float | None = None
    c2: float | None = None

    name: ClassVar[str] = "CMY"
    measured_ranges: ClassVar = {"CMY": MeasuredRange(hard=1.6, soft=0.16, factor=6.6)}
    source: ClassVar[str] = "doi:10.1016/0017-9310(69)90011-8"
    validity: ClassVar[str] = "isotropic rough faces, flat, whose spots yield; p/H_c from 1e-6 to 0.023; first loading"
    parameters: ClassVar = {
        **OF_PROFILES,
        "hardness": Parameter("Pa", "hardness of the spots; that of the pair where not given", 0),
        "c1": Parameter("Pa", "Vickers hardness at a diagonal of 1 um", 0),
        "c2": Parameter("", "power of the diagonal in the Vickers hardness", -1, 1),
    }

    def __post_init__(self) -> None:
        super().__post_init__()
        sized = self.c1 is not None or self.c2 is not None
        require(self.name, not (sized and self.hardness is not None), "give hardness, or c1 and c2, not both")
        require(self.name, (self.c1 is None) == (self.c2 is None), "c1 and c2 belong together: give both")
        self._hardness  # noqa: B018  # the pair must give what the user does not

    @cached_property
    def _hardness(self) -> VickersHardness:
        """The hardness over the size of an indentation; one without a size is a power 0."""
        if self.c1 is not None and self.c2 is not None:
            return VickersHardness(c1=self.c1, c2=self.c2)
        of_pair = self.pair.vickers
        if self.hardness is None and of_pair is not None:
            return of_pair
        try:
            return VickersHardness(c1=self.pair.hardness if self.hardness is None else self.hardness, c2=0.0)
        except InputError as fault:
            raise InputError(f"{self.name}: {fault}; or give hardness, or c1 and c2, of the spots") from None

    def facts(self) -> dict[str, Any]:
        """Facts of every law, with the hardness over the size of an indentation that is used."""
        return super().facts() | {"c1 [Pa]": self._hardness.c1, "c2": self._hardness.c2}

    @property
    def assumptions(self) -> tuple[str, ...]:
        """That all spots have the hardness of the pair, where nobody gives that of small ones."""
        if self.hardness is not None or self._hardness.c2 != 0:
            return ()
        return (
            f"k_n: the spots have the hardness of {self.pair.softer.name}, {self._hardness.c1 * 1e-6:.4g} MPa, at any "
            "size; small spots are harder: give c1 and c2",
        )

    def at_closure(self, area: ArrayLike) -> Response:
        """Return the response at real area fractions, any shape; InputError unless above 0 and at most a half."""
        from scipy.special import erfcinv

        A = self._area(area)
        grows = 1 + 0.071 * self._hardness.c2
        p = self._hardness.at(1.62 * self.h_rms / self.mean_slope) * A**grows
        H = p / A
        k_n = 1.25 * self.pair.E_star * self.mean_slope / self.h_rms * A**0.95
        Y = sqrt(2) * erfcinv(2 * A)
        flattening = grows * H * np.exp(-(Y**2) / 2) / (sqrt(2 * pi) * self.h_rms)
        elastic = self.pair.E_star * self.mean_slope / sqrt(2)
        return Response(
            pressure=np.asarray(p),
            area=A.copy(),
            k_n=np.asarray(k_n),
            k_t=np.asarray(k_n * 4 * self.pair.G_star / self.pair.E_star),
            k_load=np.asarray(np.minimum(flattening, k_n)),
            reasons={
                "p/H_c outside of 1e-6 to 0.023": self._unfitted(A),
                "contacts stay elastic: H_c above E* m/sqrt(2)": np.asarray(elastic < H),
            },
        )
