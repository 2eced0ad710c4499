"""The seam of all laws: responses, inversion for pressure, the list of laws."""

from dataclasses import dataclass
from typing import ClassVar, final

import numpy as np
import pytest
from numpy.typing import ArrayLike

import faying.contact
from faying.contact import ContactLaw, Response, laws
from faying.contact.build import find
from faying.errors import InputError, NotConverged


@final
@dataclass(frozen=True, kw_only=True)
class Power(ContactLaw):
    """p = c g^m over a closing g on a linear scale: a law whose inverse is known."""

    c: float = 1e6
    m: float = 2.0
    wavy: float = 0.0

    name: ClassVar[str] = "Power"
    source: ClassVar[str] = "test"
    ground: ClassVar[str] = "everywhere"
    parameters: ClassVar = {}
    geometric: ClassVar[bool] = False

    @property
    def closure_range(self) -> tuple[float, float]:
        return 0.1, 2.0

    def at_closure(self, closure: ArrayLike) -> Response:
        g = np.asarray(closure, float)
        p = self.c * g**self.m * (1 + self.wavy * np.sin(40 * g))
        return Response(pressure=p, area=g / 2, k_n=self.m * p / g, reasons={"g above 1": g > 1})


LAW = Power()


def test_inversion_gives_back_the_closed_form() -> None:
    p = np.geomspace(*(1e6 * np.array([0.1, 2.0]) ** 2), 50)
    response = LAW.at_pressure(p)
    assert response.area == pytest.approx(np.sqrt(p / 1e6) / 2, rel=1e-12)
    assert response.pressure.tolist() == p.tolist()
    assert response.k_t is None
    assert response.valid.tolist() == (p <= 1e6).tolist()


def test_pressures_beyond_the_ends_are_told() -> None:
    assert LAW.greatest_pressure == pytest.approx(4e6, rel=1e-12)
    with pytest.raises(InputError, match="more than Power covers"):
        LAW.at_pressure(4.1e6)
    with pytest.raises(InputError, match=r"below the least that Power resolves.*use 0 for an open point"):
        LAW.at_pressure(1.0)


def test_a_law_whose_pressure_falls_is_refused() -> None:
    with pytest.raises(NotConverged, match="pressure does not grow with closure"):
        Power(wavy=0.5).at_pressure(1e6)


def test_with_changes_a_copy_and_knows_its_parameters() -> None:
    other = LAW.with_(m=3.0)
    assert (LAW.m, other.m) == (2.0, 3.0)
    with pytest.raises(InputError, match="Power has no parameter n; it has c, m, wavy"):
        LAW.with_(n=1)


def test_laws_are_listed_and_found_by_any_spelling() -> None:
    assert laws()["JK"] is faying.JK
    assert find("jk").law is faying.JK
    with pytest.raises(InputError, match="the known ones are"):
        find("none")


@pytest.mark.parametrize("cls", laws().values(), ids=laws())
def test_every_law_describes_itself(cls: type[ContactLaw]) -> None:
    from dataclasses import MISSING, fields

    assert cls.source.startswith(("doi:", "measured", "isbn:", "ISBN "))
    assert cls.__doc__
    assert cls.validity
    own = {f.name for f in fields(cls) if f.init}  # type: ignore[arg-type]
    needed = {f.name for f in fields(cls) if f.init and f.default is MISSING}  # type: ignore[arg-type]
    assert set(cls.parameters) <= own
    assert needed - {"pair", "scan"} <= set(cls.parameters)
    assert getattr(faying.contact, cls.__name__) is cls
