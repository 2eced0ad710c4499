"""The checked table behind at_pressure for many pressures."""

import numpy as np
import pytest

from faying import JK, RIGID, ContactPair, InputError, Material
from faying.contact import GreenwoodWilliamson, JacksonStreator, MajumdarBhushan, Persson, TabulatedLaw
from faying.contact.law import TABLE_FROM, ContactLaw

PAIR = ContactPair(Material(name="m", E=200e9, nu=0.3, hardness=994e6, friction=0.25), RIGID)
SPECIMEN = JK(D=2.39, G=1.53e-10, pair=PAIR, scan_area=16e-6)
LAWS = {
    "JK": SPECIMEN,
    "JK literal, with its losses falling to zero": SPECIMEN.with_(loss="literal"),
    "JK printed, sheared": SPECIMEN.with_(closure="printed", shear_stress=5e6),
    "JK exact substrate": SPECIMEN.with_(substrate="exact"),
    "GW": GreenwoodWilliamson(density=1e10, radius=20e-6, sigma=0.5e-6, pair=PAIR),
    "MB": MajumdarBhushan(D=2.4, G=1e-10, pair=PAIR, scan_area=16e-6),
    "Persson": Persson(slope=0.05, h_rms=1e-6, pair=PAIR),
    "JS": JacksonStreator(D=2.4, G=1e-10, shortest=1e-5, pair=PAIR, scan_area=16e-6),
    "Table": TabulatedLaw(pressure=np.geomspace(1e4, 1e9, 12), k_n=np.cumsum(np.arange(1.0, 13.0) ** 3) * 1e12),
}


@pytest.mark.parametrize("name", LAWS)
def test_table_agrees_with_exact_inversion(name: str) -> None:
    law: ContactLaw = LAWS[name]
    top = law.greatest_pressure
    rng = np.random.default_rng(3)
    low = max(1e-14 * top, float(np.exp(law._grid[1][0])))
    p = np.exp(rng.uniform(np.log(low), np.log(top), 1500))
    edges = np.array([low * (1 + 1e-9), top * (1 - 1e-12), top])
    p = np.concatenate([p, edges])
    read, exact = law.at_pressure(p, exact=False), law.at_pressure(p, exact=True)
    for quantity, value in exact.quantities().items():
        assert read.quantities()[quantity] == pytest.approx(value, rel=1e-6, abs=1e-300), quantity
    assert read.reasons.keys() == exact.reasons.keys()
    for reason, mask in exact.reasons.items():
        assert read.reasons[reason].tolist() == mask.tolist(), reason


def test_pressures_on_a_kink_are_as_good() -> None:
    law = SPECIMEN.with_(loss="literal")
    kinks = law.at_closure(np.array(law.limits[:2])).pressure
    p = np.concatenate([k * (1 + np.linspace(-0.02, 0.02, 401)) for k in kinks])
    read, exact = law.at_pressure(p, exact=False), law.at_pressure(p, exact=True)
    for quantity, value in exact.quantities().items():
        assert read.quantities()[quantity] == pytest.approx(value, rel=1e-6, abs=1e-14), quantity
    assert not law._pressure_table.good.all()


def test_only_many_pressures_read_the_table() -> None:
    law = SPECIMEN.with_(G=2e-10)
    few = law.at_pressure(np.full(TABLE_FROM, 1e6))
    assert "_pressure_table" not in vars(law)
    many = law.at_pressure(np.full(TABLE_FROM + 1, 1e6))
    assert "_pressure_table" in vars(law)
    assert float(many.k_n[0]) == pytest.approx(float(few.k_n[0]), rel=1e-6)


def test_table_keeps_shapes_zeros_and_refusals() -> None:
    p = np.array([[0.0, 1e6], [2e6, 0.0]])
    read, exact = SPECIMEN.at_pressure(p, exact=False), SPECIMEN.at_pressure(p, exact=True)
    for quantity, value in exact.quantities().items():
        assert read.quantities()[quantity] == pytest.approx(value, rel=1e-6)
        assert read.quantities()[quantity][0, 0] == 0
    assert read.pressure.tolist() == p.tolist()
    with pytest.raises(InputError, match="more than JK covers"):
        SPECIMEN.at_pressure([1e12], exact=False)
    with pytest.raises(InputError, match="below the least"):
        SPECIMEN.at_pressure([1e-60], exact=False)
