"""A law from a curve: exact on power laws, honest outside, read back from a file."""

import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from faying import InputError, ReadError
from faying.contact import TabulatedLaw

P = np.geomspace(1e5, 1e8, 25)
LAW = TabulatedLaw(pressure=P, area=P / 1e9, k_n=3e9 * P**0.5, loss_n=0.01 * (P[-1] - P) / P[-1])


@given(st.floats(0, 1))
def test_power_laws_stay_exact_between_the_points(u: float) -> None:
    p = 1e5 * 1000**u
    r = LAW.at_pressure(p)
    assert float(r.area) == pytest.approx(p / 1e9, rel=1e-10)
    assert float(r.k_n) == pytest.approx(3e9 * p**0.5, rel=1e-10)
    assert 0 <= float(r.loss_n) <= 0.01
    assert r.k_t is None


def test_points_come_back_and_shapes_stay() -> None:
    r = LAW.at_pressure(P.reshape(5, 5))
    assert r.k_n == pytest.approx((3e9 * P**0.5).reshape(5, 5), rel=1e-12)
    assert r.loss_n == pytest.approx((0.01 * (P[-1] - P) / P[-1]).reshape(5, 5), abs=1e-12)
    assert float(LAW.at_pressure(0.0).k_n) == 0


def test_outside_the_table_is_refused() -> None:
    with pytest.raises(InputError, match="more than Table covers"):
        LAW.at_pressure(2e8)
    with pytest.raises(InputError, match="below the least"):
        LAW.at_pressure(1e4)
    with pytest.raises(InputError, match="the table covers"):
        LAW.at_closure(2e8)


def test_monotone_tables_stay_monotone() -> None:
    rng = np.random.default_rng(0)
    k = np.cumsum(rng.uniform(0.01, 5, 25))
    law = TabulatedLaw(pressure=P, k_n=k)
    assert np.all(np.diff(law.at_pressure(np.geomspace(1e5, 1e8, 2000)).k_n) >= -1e-12 * k[-1])


def test_approach_gives_the_stiffness_of_a_power_law() -> None:
    # Ito: approach = C p^m, k_n = p^(1-m)/(C m)
    C, m = 0.046e-6 / 1e6**0.48, 0.48
    law = TabulatedLaw.from_approach(P, C * P**m)
    p = np.geomspace(2e5, 9e7, 7)
    assert law.at_pressure(p).k_n == pytest.approx(p ** (1 - m) / (C * m), rel=1e-9)


def test_a_file_comes_back_in_si(tmp_path: Path) -> None:
    file = tmp_path / "joint.csv"
    file.write_text('\ufeff# a comment\n"pressure [MPa]", k_n [MPa/um], area [-]\n1, 40, .1 # by hand\n\n2, 60, .2\n')
    law = TabulatedLaw.from_csv(file)
    assert law.at_pressure([1e6, 2e6]).k_n == pytest.approx([40e12, 60e12], rel=1e-12)
    assert law.at_pressure([1e6, 2e6]).area == pytest.approx([0.1, 0.2], rel=1e-12)
    assert law.origin == str(file)


def test_files_of_the_command_law_are_read(tmp_path: Path) -> None:
    from faying import JK, ContactPair
    from faying.cli.scan.law import csv_text
    from faying.materials import CATALOGUE

    steel = CATALOGUE["45 steel"]
    jk = JK(D=2.39, G=1.53e-10, scan_area=16e-6, pair=ContactPair(steel, steel))
    made = jk.at_pressure(np.geomspace(1e5, 4e7, 40))
    (tmp_path / "law.csv").write_text(csv_text(jk, made))
    back = TabulatedLaw.from_csv(tmp_path / "law.csv").at_pressure(made.pressure).quantities()
    assert back.keys() == made.quantities().keys()
    for name, value in made.quantities().items():
        assert back[name] == pytest.approx(value, rel=1e-12)


def test_tables_do_not_change() -> None:
    own = P.copy()
    law = TabulatedLaw(pressure=own, k_n=own)
    own[:] = 0
    assert float(law.at_pressure(1e6).k_n) == pytest.approx(1e6, rel=1e-9)
    with pytest.raises(ValueError, match="read-only"):
        law.pressure[0] = 1.0  # type: ignore[index]


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: TabulatedLaw(pressure=P), "nothing but pressure"),
        (lambda: TabulatedLaw(pressure=[1.0], k_n=[1.0]), "at least 2 values"),
        (lambda: TabulatedLaw(pressure=[2.0, 1.0], k_n=[1.0, 2.0]), "does not rise"),
        (lambda: TabulatedLaw(pressure=[1.0, 2.0], k_n=[1.0]), r"k_n has shape \(1,\)"),
        (lambda: TabulatedLaw(pressure=[1.0, 2.0], k_n=[1.0, -2.0]), "0 or more"),
        (lambda: TabulatedLaw(pressure=[1.0, 2.0], k_n=[1.0, float("nan")]), "NaN or infinite"),
        (lambda: TabulatedLaw(pressure=[0.0, 2.0], k_n=[1.0, 2.0]), "positive"),
        (lambda: TabulatedLaw.from_approach([1.0, 2.0], [2.0, 1.0]), "both rising"),
    ],
)
def test_bad_tables_are_refused(make: object, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make()  # type: ignore[operator]


HEAD = "pressure [MPa],k_n [MPa/um]\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", ": the head is empty; a table looks like: pressure"),
        ("1,40\n2,60\n", ", line 1: no head with the names of the columns; a table looks like: pressure"),
        (
            "pressure [MPa],kt [MPa/um]\n1,2\n2,3\n",
            ', line 1: the column "kt [MPa/um]" is unknown; the known ones are pressure, area, k_n',
        ),
        ("pressure [MPa],k_n [MPa/um],\n1,2\n2,3\n", ', line 1: the column "" is unknown'),
        ("k_n [MPa/um]\n1\n2\n", ', line 1: no column "pressure [unit]"; the head is k_n'),
        ("pressure [MPa]\n1\n2\n", ", line 1: nothing but pressure is given; add any of area, k_n"),
        ("pressure [MPa],k_n [MPa/um],k_n [Pa/m]\n1,2,3\n2,3,4\n", ', line 1: 2 columns are called "k_n"'),
        (
            "# c\npressure,k_n [MPa/um]\n1,2\n2,3\n",
            ', line 2: the column "pressure" lacks its unit; write for example "pressure [MPa]"',
        ),
        (
            "pressure [MPa],k_n [MPa]\n1,2\n2,3\n",
            ', line 1: "MPa" of the column "k_n [MPa]" is not a unit like Pa/m; write for example "k_n [MPa/um]"',
        ),
        ("pressure [MPa],area [%]\n1,2\n2,3\n", 'the column "area [%]" has no unit; give plain numbers under "area"'),
        ("pressure [MPa];k_n [MPa/um]\n1;2,5\n2;3\n", ", line 2: '1;2,5' has decimal commas"),
        ("pressure [MPa]\tk_n [MPa/um]\n1\t2,5\n2\t3\n", ", line 2: '1\\t2,5' has decimal commas"),
        (HEAD, ": 0 rows under the head; give 2 or more"),
        (HEAD + "1,2\n", ": 1 row under the head; give 2 or more"),
        (HEAD + "1,2\n\n2,x\n", ', line 4: "x" in the column "k_n" is not a number'),
        (HEAD + "1,2\n2\n", ', line 3: no value in the column "k_n"'),
        (HEAD + "1,2\n,3\n", ', line 3: no value in the column "pressure"'),
        (HEAD + "1,2\n2,3,4\n", ", line 3: 3 values under the 2 columns of the head"),
        (HEAD + "1,2\n2,nan\n", ', line 3: "nan" in the column "k_n" is not a finite number'),
        (HEAD + "1,2\n2,-3\n", ', line 3: -3 in the column "k_n"; it must be 0 or more'),
        (HEAD + "0,2\n2,3\n", ', line 2: 0 in the column "pressure"; pressures must be above 0'),
        (HEAD + "1,2\n2,3\n2,4\n", ", line 4: the pressure 2 does not rise above 2, that of the row before"),
    ],
)
def test_bad_files_are_refused_with_file_and_line(tmp_path: Path, text: str, message: str) -> None:
    file = tmp_path / "t.csv"
    file.write_text(text)
    with pytest.raises(ReadError, match=re.escape(f"{file}{message}" if message[0] in ":," else message)) as caught:
        TabulatedLaw.from_csv(file)
    assert str(caught.value).startswith(str(file))


def test_missing_files_are_told(tmp_path: Path) -> None:
    with pytest.raises(ReadError, match="cannot be read"):
        TabulatedLaw.from_csv(tmp_path / "none.csv")
