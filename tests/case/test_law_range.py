"""How far measured stiffness lies from each law: the fit, its data, and the ranges that intervals take from it."""

import csv
import importlib.util
import re
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from scipy.stats import t as student

import faying
from faying.answer.interval import law_notes, of_each
from faying.case.case import Case, checked_mesh, surfaces_of
from faying.case.law_range import is_soft, law_range, of_joint
from faying.case.scatter import known_of
from faying.contact.build import kinds
from faying.contact.measured_range import OF_CURVES as MEASURED
from faying.contact.models.jk import JK
from faying.distribution import FACTOR_SCORE, Distribution
from faying.study import Study
from faying.study.keys.uncertain import Input, UncertainChoice

COMPARED = {label: law_range(label) for label in kinds() if label != "auto"}
LAW_RANGES = {label: found for label, found in COMPARED.items() if found not in (None, MEASURED)}
SOLVED = law_range("half-space")
ONE = Distribution(kind="normal", centre=1.0, spread=0.2)
ROOT = Path(__file__).parents[2]


def loaded(name: str) -> ModuleType:
    """A script of benchmarks/."""
    spec = importlib.util.spec_from_file_location(name, ROOT / "benchmarks" / f"{name}.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # its dataclass asks for it
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="module")
def script() -> ModuleType:
    return loaded("law_range")


@pytest.fixture(scope="module")
def measurements() -> ModuleType:
    return loaded("measured_conductance")


def rows() -> list[dict[str, str]]:
    with (ROOT / "docs" / "theory" / "measured-over-laws.csv").open(newline="") as file:
        return list(csv.DictReader(file))


def test_the_fit_is_the_analysis_of_variance_of_a_balanced_design(script):
    """One class, as many specimens in each source: restricted likelihood has the mean squares in closed form."""
    rng = np.random.default_rng(3)
    sources, each = 6, 4
    y = rng.normal(0.0, 0.8, (sources, 1)) + rng.normal(0.3, 0.5, (sources, each))
    own = y.var(axis=1, ddof=1).mean()
    shared = y.mean(axis=1).var(ddof=1) - own / each
    assert shared > 0
    fit = script.fitted(
        [
            script.Specimen(source=str(i), name=str(k), soft=False, values=(y[i, k],))
            for i in range(sources)
            for k in range(each)
        ]
    )
    assert fit.specimens**2 == pytest.approx(own, rel=1e-4)
    assert fit.sources**2 == pytest.approx(shared, rel=1e-4)
    assert fit.medians == pytest.approx([y.mean()])
    error = shared / sources + own / (sources * each)
    assert fit.errors**2 == pytest.approx([error], rel=1e-4)
    freedom = (shared + error + own) ** 2 / ((shared + error) ** 2 / 5 + own**2 / 18)
    assert fit.half == pytest.approx([student.ppf(0.95, freedom) * np.sqrt(shared + error + own)], rel=1e-4)


def test_ranges_are_those_of_the_fit(script):
    assert set(LAW_RANGES) == set(script.LAWS)
    for law in script.LAWS:
        fit = script.fitted(script.specimens(law))
        own = LAW_RANGES[law]
        assert fit.classes == (False, True)
        assert [own.hard, own.soft] == pytest.approx(np.exp(fit.medians), rel=0.04), law  # two digits
        assert own.factor == pytest.approx(np.exp(fit.half.max()), rel=0.02), law
    solved = script.fitted(script.specimens("half-space"))
    assert MEASURED.factor == pytest.approx(np.exp(FACTOR_SCORE * solved.specimens), rel=0.02)
    own = law_range("half-space").of(soft=True)
    assert np.log(own.quantile(np.array([0.05, 0.5, 0.95]))) == pytest.approx(np.log([0.18 / 5.8, 0.18, 0.18 * 5.8]))


@pytest.mark.slow
def test_ranges_hold_what_was_measured_also_of_sources_that_were_left_out(script):
    """90 % is stated. Of a source that the fit has not seen at least 80 % of the values are inside, law by law."""
    for law in script.LAWS:
        every = script.specimens(law)
        fit = script.fitted(every)
        inside = [good for one in every for good in fit.inside(one)]
        assert np.mean(inside) >= 0.9, law
        kept = script.left_out(every)
        assert len(kept) == 4
        assert sum(k for k, _ in kept.values()) >= 0.8 * len(inside), law


def test_the_table_has_what_was_measured_and_what_the_laws_give(script, measurements):
    """The stiffness of every row but ranges, and k_n of CMY worked out: 1.25 E* (m/sigma) (p/H)^0.95."""
    table, known = rows(), [one for one in measurements.measured() if one.kind != "range"]
    assert len(table) == len(known) == 42
    for row, one in zip(table, known, strict=True):
        assert float(row["measured [MPa/um]"]) == pytest.approx(one.k_n * 1e-12, rel=1e-4)
        assert float(row["p [MPa]"]) == pytest.approx(one.pressure * 1e-6, rel=1e-3)
        assert (row["class"] == "soft") == is_soft(one.pair.first, one.pair.second)
        if row["class"] == "soft":  # no size of spots: one hardness
            k = 1.25 * one.pair.E_star * one.slope / one.roughness * (one.pressure / one.pair.bulk_hardness) ** 0.95
            assert float(row["CMY"]) == pytest.approx(k * 1e-12, rel=0.03)  # sigma and m of the drawn surface
    assert len({(row["source"], row["specimen"]) for row in table}) == 20


@pytest.mark.slow
def test_the_solved_contact_of_the_table_is_solved_again(script, measurements):
    table, known = rows(), [one for one in measurements.measured() if one.kind != "range"]
    k = next(k for k, row in enumerate(table) if row["specimen"].startswith("304 stainless, ground"))
    assert float(table[k]["half-space"]) == pytest.approx(
        measurements.predicted("half-space", known[k]) * 1e-12, rel=1e-3
    )


def test_soft_metals_are_those_below_brinell_that_are_no_steel():
    known = faying.CATALOGUE
    steel, aluminium = known["45 steel"], known["EN AW-6082 T6"]
    assert not is_soft(steel, steel)
    assert is_soft(aluminium, steel)
    assert is_soft(steel, aluminium)
    # 2.8 times 355 MPa is 0.994 GPa, and still a steel
    assert not is_soft(steel, faying.Material(name="S355", E=210e9, nu=0.3, yield_strength=355e6))
    # titanium and cast iron are as compliant as copper, and harder
    assert not is_soft(steel, faying.Material(name="Ti", E=114e9, nu=0.34, brinell=3.3e9))


def test_joints_get_the_range_of_their_law_and_metals(tmp_path):
    study = Study.read(ROOT / "examples" / "two-blocks" / "study.toml")
    (joint,) = study.joints
    mesh, (surface,) = checked_mesh(study), surfaces_of(study)
    assert study.law_of(joint).model == "auto"
    jk = LAW_RANGES["JK"]  # the default of a study with D and G, where there is no map to solve
    assert of_joint(study, mesh, joint, surface) == jk.of(soft=False)
    assert known_of(Case.of(study))["joint.stiffness"] == jk.of(soft=False)
    part = sorted(study.parts)[0]
    mixed = replace(
        study,
        parts={**study.parts, part: "EN AW-6082 T6"},
        materials={**study.materials, "EN AW-6082 T6": faying.CATALOGUE["EN AW-6082 T6"]},
    )
    soft = jk.of(soft=True)
    assert of_joint(mixed, mesh, joint, surface) == soft
    assert known_of(Case.of(mixed))["joint.stiffness"] == soft


def test_the_default_law_of_a_map_has_the_range_of_the_solved_contact():
    study = Study.read(ROOT / "examples" / "t-specimen" / "study.toml")
    (joint,), mesh, (surface,) = study.joints, checked_mesh(study), surfaces_of(study)
    assert of_joint(study, mesh, joint, surface) == SOLVED.of(soft=False)


def test_laws_without_measurements_and_measured_curves():
    """A law that nobody has compared has no number; of a curve that was measured, other pairs lie about it."""
    for label in ("JS", "GW-measured", "WK", "MB", "YK"):
        assert law_range(label) is None
    assert law_range("Table") == law_range("Power law") == MEASURED


def test_a_law_that_was_not_compared_says_so_and_has_no_number(monkeypatch):
    """The file of a law declares its range; without one there is a note in words, and no factor anywhere."""
    study = Study.read(ROOT / "examples" / "two-blocks" / "study.toml")
    case = Case.of(study)
    known = known_of(case)
    (note,) = law_notes(case, known)
    assert (note.code, known["joint.stiffness"]) == ("law-off", LAW_RANGES["JK"].of(soft=False))
    monkeypatch.setattr(JK, "measured_ranges", {})
    known = known_of(case)
    (note,) = law_notes(case, known)
    assert (note.code, note.severity) == ("law-not-compared", "limit")
    assert "JK was not compared with measurements" in note.text
    assert not re.search(r"\d", note.text)
    assert of_each(case, known, "stiffness") == [None]
    assert not any(key.endswith("stiffness") for key in known)
    given = replace(study, uncertain=UncertainChoice(inputs=(Input(key="joint.stiffness", distribution=ONE, unit=""),)))
    changed = replace(case, study=given)
    stated = of_each(changed, known_of(changed), "stiffness")
    assert stated == [pytest.approx(ONE.quantile(np.array([0.05, 0.5, 0.95])).tolist())]
