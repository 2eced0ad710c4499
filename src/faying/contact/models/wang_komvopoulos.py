"""Wang and Komvopoulos 1994: Majumdar and Bhushan's law over an extended island distribution."""

from dataclasses import dataclass
from functools import cached_property
from typing import ClassVar, final

from faying.contact.models.islands import Islands
from faying.contact.models.majumdar_bhushan import MajumdarBhushanBase


@final
@dataclass(frozen=True, kw_only=True)
class WangKomvopoulos(MajumdarBhushanBase):
    """n(a) = (d/2) psi^((2-d)/2) aL^(d/2) a^-(d/2+1), psi from D. doi:10.1115/1.2927035.

    Parameters, asperities and errors as of `MajumdarBhushan`.
    """

    name: ClassVar[str] = "WK"
    source: ClassVar[str] = "doi:10.1115/1.2927035"
    validity: ClassVar[str] = "real area up to 0.3, 2.1 <= D <= 2.9; bearing area, no interaction; plastic to elastic"

    @cached_property
    def _islands(self) -> Islands:
        return Islands(self.D)
