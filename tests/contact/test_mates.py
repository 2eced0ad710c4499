"""Both faces of a joint as one object: its default, what it computes and when, its table, and what it refuses."""

import numpy as np
import pytest

import faying
from faying.contact import two_faces
from faying.contact.build import kinds
from faying.contact.models.half_space import HalfSpace
from tests.helpers.scans import gaussian

POINTS, SIDE = 64, 0.5e-3
PRESSURES = (2e6, 7e6, 20e6)


def rough(seed=1, rms=1e-6, source="a.x3p", points=POINTS, shortest=8e-6):
    z = gaussian(0.8, 0.06e-3, shortest, rms, seed, points=points, side=SIDE)
    return faying.Scan(heights=z, spacing=(SIDE / points,) * 2, source=source)


SCAN = rough()
STEEL = faying.CATALOGUE["45 steel"]
PAIR = faying.ContactPair(STEEL, STEEL)


def k_n(law, pressures=PRESSURES):
    return np.asarray(law.at_pressure(pressures).k_n)


@pytest.mark.parametrize(
    "materials",
    ["45 steel", STEEL, ("45 steel", "45 steel"), [STEEL, "45 steel"], PAIR, faying.ContactPair("45 steel", STEEL)],
)
def test_every_way_to_say_the_materials_is_one_pair(materials):
    mates = faying.Mates(SCAN, materials=materials)
    assert mates.pair == PAIR
    assert mates.line == "both faces as a.x3p, unrelated; 45 steel on 45 steel"


def test_the_face_with_the_scan_comes_first():
    pair = faying.Mates(SCAN, materials=("S355", "rigid")).pair
    assert (pair.first.name, pair.second.is_rigid) == ("S355", True)


def test_the_other_face_doubles_the_mean_squares():
    """Heights of two unrelated faces add as squares; of a smooth one nothing is added."""
    same, smooth = (faying.Mates(SCAN, materials=PAIR, other=o).faces.unfitted.inputs for o in ("same", "smooth"))
    assert same.m0 == pytest.approx(2 * smooth.m0, rel=1e-12)
    fit = faying.fit_fractal(SCAN)
    one, both = fit.G, faying.Mates(SCAN, materials=PAIR).faces.rough.inputs.G
    assert (both / one) ** (2 * fit.D - 4) == pytest.approx(2, rel=1e-9)


def test_a_fit_of_one_face_gives_the_law_that_its_scan_gives():
    area = SCAN.size[0] * SCAN.size[1]
    fit = faying.fit_fractal(SCAN)
    by_scan = k_n(faying.Mates(SCAN, materials=PAIR).law("jk"))
    by_fit = faying.Mates.of_fit(fit, scan_area=area, materials="45 steel")
    assert k_n(by_fit.law("jk")) == pytest.approx(by_scan, rel=1e-12)
    inputs = faying.Mates(SCAN, materials=PAIR).faces.rough.inputs
    both = faying.Mates.of_fractal(D=inputs.D, G=inputs.G, scan_area=area, materials=PAIR)
    assert k_n(both.law("jk")) == pytest.approx(by_scan, rel=1e-12)
    assert "of one face, the other alike" in repr(by_fit)
    assert "both faces together" in repr(both)


def test_the_fit_of_a_profile_counts_as_that_of_the_surface_it_is_cut_from():
    """The power of a cut is the mean of |cos|^(6 - 2 D) over all directions of that of the surface, by quadrature."""
    scan = faying.synthesize.spectral((512, 512), spacing=4e-6, D=2.3, Rq=0.6e-6, seed=0)
    line = faying.Profile(heights=scan.heights[5] - scan.heights[5].mean(), spacing=4e-6, source="line")
    fit = faying.fit_fractal(line)
    angles = (np.arange(200_000) + 0.5) / 200_000 * np.pi / 2
    share = np.mean(np.cos(angles) ** (6 - 2 * fit.D))
    inputs = faying.Mates.of_fit(fit, scan_area=SIDE**2, materials=PAIR, of="both faces").faces.rough.inputs
    assert (fit.D, share * (inputs.G / fit.G) ** (2 * fit.D - 4)) == (inputs.D, pytest.approx(1, rel=1e-3))
    assert inputs.G > 1.1 * fit.G
    by_line = faying.Mates(line, scan_area=SIDE**2, materials=PAIR)
    by_fit = faying.Mates.of_fit(fit, scan_area=SIDE**2, materials=PAIR)
    assert k_n(by_fit.law("jk")) == pytest.approx(k_n(by_line.law("jk")), rel=1e-12)


def test_the_fit_of_two_scans_is_that_of_both():
    one, other = rough(1, points=192, shortest=0), rough(2, points=192, shortest=0, source="b.x3p")
    mates = faying.Mates(one, materials=PAIR, other=other)
    assert mates.line == "a.x3p on b.x3p; 45 steel on 45 steel"
    of_fit = faying.Mates.of_fit(faying.combine(one, other).fit, scan_area=SIDE**2, materials=PAIR, of="both faces")
    assert k_n(of_fit.law("jk")) == pytest.approx(k_n(mates.law("jk")), rel=1e-12)


def test_numbers_of_majumdar_and_bhushan_go_through_the_one_convention():
    """G is that of Yan and Komvopoulos for every law; a law of the other convention gets it converted."""
    mates = faying.Mates.of_fractal(D=2.4, G="0.1 nm", scan_area="16 mm^2", materials=PAIR)
    law = mates.law("mb")
    assert law.G == pytest.approx(1e-10 * np.log(1.5) ** (1 / (2 * 0.4)), rel=1e-12)


def test_text_with_units_is_read_everywhere():
    mates = faying.Mates.of_fractal(D=2.39, G="0.153 nm", scan_area="16 mm^2", materials="45 steel")
    same = faying.Mates.of_fractal(D=2.39, G=0.153e-9, scan_area=16e-6, materials=PAIR)
    law = mates.law("jk", alpha="0.3", shear_stress="1 MPa")
    assert (law.alpha, law.shear_stress) == (0.3, 1e6)
    assert k_n(law, 2e6) == pytest.approx(k_n(same.law("JK", alpha=0.3, shear_stress=1e6), 2e6), rel=1e-12)
    at = law.at_pressure(["2 MPa", "3000 kPa"])
    assert at.k_n.tolist() == law.at_pressure([2e6, 3e6]).k_n.tolist()
    assert law.at_pressure("2 MPa").k_n.shape == ()


@pytest.mark.slow
def test_what_a_law_does_not_ask_for_is_not_computed(monkeypatch):
    """D and G are fitted for JK, once; not for the solved contact, the default, or laws of moments."""
    calls = []
    true = two_faces.fit_fractal
    monkeypatch.setattr(two_faces, "fit_fractal", lambda *a, **k: calls.append(1) or true(*a, **k))
    mates = faying.Mates(SCAN, materials=PAIR)
    for name in ("auto", "half-space", "gw-ke", "persson"):
        mates.law(name)
    assert repr(mates)
    assert not calls
    mates.law("jk")
    mates.law("yk")
    assert len(calls) == 1


@pytest.mark.slow
def test_the_contact_is_solved_once_for_the_default_and_the_comparison(monkeypatch):
    monkeypatch.setenv("FAYING_CACHE", "off")
    solved = []
    inner = HalfSpace._solve
    monkeypatch.setattr(HalfSpace, "_solve", lambda self, *a, **k: solved.append(1) or inner(self, *a, **k))
    mates = faying.Mates(rough(11), materials=PAIR)
    assert mates.law().at_pressure(5e6).k_n > 0
    once = len(solved)
    assert once > 0
    mates.compare(["1 MPa", "5 MPa"])
    mates.law()
    assert len(solved) == once
    other = faying.Mates(rough(12), materials=PAIR)
    other.compare([1e6, 5e6])
    first = len(solved)
    assert first > once
    other.law().at_pressure(5e6)
    assert len(solved) == first


def test_the_scan_is_levelled_once(monkeypatch):
    from faying.surface import form

    levelled, true = [], form._prepared
    monkeypatch.setattr(form, "_prepared", lambda scan, *a: levelled.append(id(scan)) or true(scan, *a))
    scan = rough(9)
    mates = faying.Mates(scan, materials=PAIR)
    for name in ("auto", "jk", "gw", "persson"):
        mates.law(name)
    assert levelled.count(id(scan)) == 1


def test_a_variant_has_its_own_name_everywhere():
    for label, kind in kinds().items():
        if not kind.fixed:
            continue
        law = faying.Mates(SCAN, materials=PAIR).law(label)
        assert law.name == law.facts()["name"] == label
        assert type(law).name == "GW"
        assert law.with_(asperity="Hertz").name == "GW"


def test_the_table_holds_what_the_laws_say():
    mates = faying.Mates(SCAN, materials=PAIR)
    table = mates.compare()
    assert {"half-space", "JK", "GW-KE", "Persson", "MB"} <= set(table.law.values.tolist())
    series = table.sel(pressure=5e6, method="nearest").k_n.to_series()
    p = float(table.pressure.sel(pressure=5e6, method="nearest"))
    assert series["GW-KE"] == pytest.approx(float(mates.law("gw-ke").at_pressure(p).k_n), rel=1e-12)
    assert table.k_n.attrs["units"] == "Pa/m"
    assert table.pressure.attrs["units"] == "Pa"
    assert table.area.attrs["units"] == "1"
    assert table.attrs["mates"] == mates.line
    ratio = table.over_half_space.sel(law="half-space")
    assert np.allclose(ratio[np.isfinite(ratio)], 1)
    own = table.k_n.sel(law="JK") / table.k_n.sel(law="half-space")
    assert np.allclose(own, table.over_half_space.sel(law="JK"), equal_nan=True)
    assert not table.valid.sel(law="JK").values[np.isnan(table.k_n.sel(law="JK").values)].any()
    few = mates.compare("5 MPa", laws=["jk", "gw_ke"])
    assert few.law.values.tolist() == ["JK", "GW-KE"]
    assert few.pressure.values.tolist() == [5e6]


def test_laws_that_numbers_cannot_feed_are_named_in_the_table():
    table = faying.Mates.of_fractal(D=2.39, G=1e-10, scan_area=16e-6, materials=PAIR).compare([1e6])
    assert "half-space" not in table.law.values
    assert any(line.startswith("Persson: ") for line in table.attrs["left_out"].splitlines())


def test_curves_are_drawn_with_their_names():
    import matplotlib

    matplotlib.use("Agg")
    axes = faying.Mates(SCAN, materials=PAIR).compare_plot(laws=["half-space", "jk", "gw-ke"])
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["half-space", "JK", "GW-KE"]
    assert axes.get_xlabel() == "nominal pressure [MPa]"
    assert "MPa/µm" in axes.get_ylabel()
    again = faying.Mates(SCAN, materials=PAIR).compare_plot(laws=["gw-ke"], quantity="area", ax=axes)
    assert again is axes


@pytest.mark.parametrize(
    "mates",
    [
        faying.Mates(SCAN, materials=PAIR),
        faying.Mates(SCAN, materials=("S355", "rigid"), other=rough(3, source="b.x3p")),
        faying.Mates(SCAN, materials=PAIR, other="smooth", D=2.4, G="1 nm"),
        faying.Mates.of_fractal(D=2.39, G=1e-10, scan_area=16e-6, materials=PAIR, of="one face"),
        faying.Mates(SCAN.profile("x", 3), materials=PAIR, scan_area="1 mm^2"),
    ],
)
def test_it_says_in_a_few_lines_what_it_is(mates):
    lines = repr(mates).splitlines()
    assert 3 <= len(lines) <= 12
    assert all(len(line) <= 160 for line in lines)
    assert mates.line in lines[0]
    for material in (mates.pair.first, mates.pair.second):
        assert material.name in repr(mates)
    assert " G " in repr(mates)


def of_scan(**given):
    return lambda: faying.Mates(SCAN, **({"materials": "45 steel"} | given))


def of_numbers(**given):
    good = {"D": 2.4, "G": 1e-10, "scan_area": 16e-6, "materials": "45 steel"}
    return lambda: faying.Mates.of_fractal(**(good | given))


def asked(name="jk", **given):
    return lambda: faying.Mates(SCAN, materials="45 steel").law(name, **given)


def at(pressure):
    return lambda: (
        faying.Mates.of_fractal(D=2.39, G=1e-10, scan_area=16e-6, materials=PAIR).law("jk").at_pressure(pressure)
    )


MISUSES = {
    "an int for a scan": (lambda: faying.Mates(3, materials="45 steel"), "no surface|given as int"),
    "a file name for a scan": (lambda: faying.Mates("milled.x3p", materials="45 steel"), "given as str"),
    "nothing for a scan": (lambda: faying.Mates(None, materials="45 steel"), "given as NoneType"),
    "an array for a scan": (lambda: faying.Mates(SCAN.heights, materials="45 steel"), "given as ndarray"),
    "a profile without an area": (lambda: faying.Mates(SCAN.profile("x", 0), materials="45 steel"), "scan_area"),
    "a profile on a scan": (
        lambda: faying.Mates(SCAN.profile("x", 0), materials=PAIR, scan_area=1e-6, other=SCAN),
        "two areal scans",
    ),
    "faces and what they hold": (
        lambda: faying.Mates(faying.Mates(SCAN, materials=PAIR).faces, materials=PAIR, other="smooth"),
        "nothing but their materials",
    ),
    "an unknown material": (of_scan(materials="45 stel"), 'did you mean "45 steel"'),
    "an int for a material": (of_scan(materials=7), "material = 7"),
    "no material": (of_scan(materials=None), "material = None"),
    "two rigid faces": (of_scan(materials="rigid"), "both materials of the pair are rigid"),
    "the rigid plane alone": (of_scan(materials=faying.RIGID), "both materials of the pair are rigid"),
    "three materials": (of_scan(materials=("45 steel",) * 3), "3 of them"),
    "a pair of numbers": (of_scan(materials=(1, 2)), "material = 1"),
    "an unknown other face": (of_scan(other="alike"), '"same" or "smooth"'),
    "an int for the other face": (of_scan(other=3), "counter = int"),
    "a profile for the other face": (of_scan(other=SCAN.profile("x", 0)), "counter = Profile"),
    "an unknown estimator": (of_scan(method="guess"), "method = 'guess'"),
    "a list for an estimator": (of_scan(method=[]), "method"),
    "a dimension of a curve": (of_scan(D=1.4), "between 2 and 3"),
    "a dimension in words": (of_scan(D="2.4"), "plain number"),
    "a length without a unit": (of_scan(G="1e-10"), "has no unit"),
    "an area for a length": (of_scan(G="1 mm^2"), "not in a unit like m"),
    "a length that is a list": (of_scan(G=[1]), r"G = \[1\]"),
    "an area below 0": (of_scan(scan_area=-1.0), "positive"),
    "a folder that is none": (of_scan(cache=3), "cache = 3"),
    "D of nothing": (of_numbers(D=None), "plain number"),
    "D that is not a number": (of_numbers(D=float("nan")), "between 2 and 3"),
    "G below 0": (of_numbers(G=-1e-10), "positive"),
    "an area of no kind": (of_numbers(scan_area=object()), "scan_area"),
    "another share of the faces": (of_numbers(of="half"), '"both faces" together'),
    "a fit that is none": (lambda: faying.Mates.of_fit(3, scan_area=1e-6, materials=PAIR), "given as int"),
    "a fit of another convention": (
        lambda: faying.Mates.of_fit(
            faying.fit_fractal(SCAN, convention="majumdar-bhushan"), scan_area=1e-6, materials=PAIR
        ),
        "convention",
    ),
    "an unknown law": (asked("jkk"), "did you mean JK"),
    "an int for a law": (asked(3), "contact law = 3"),
    "an unknown parameter": (asked(alfa=0.3), "did you mean alpha"),
    "a parameter of no kind": (asked(alpha=[1]), r"alpha = \[1\]"),
    "a parameter in words": (asked(alpha="much"), "alpha = 'much'"),
    "a parameter out of range": (asked(alpha=-1.0), "alpha"),
    "what a variant fixes": (asked("gw-ke", asperity="Hertz"), "has the asperity"),
    "the half-space of numbers": (lambda: of_numbers()().law("half-space"), "half-space needs"),
    "a pressure without a unit": (at("5"), "has no unit"),
    "a pressure of another kind": (at("5 mm"), "not in a unit like Pa"),
    "no pressure": (at(None), "pressure = None"),
    "an object for a pressure": (at(object()), "pressure"),
    "a pressure below 0": (at(-1.0), "0 or more"),
    "ragged pressures": (at([[1e6], [1e6, 2e6]]), "pressure"),
    "a letter for a list of laws": (lambda: of_numbers()().compare(laws="jk"), "list of names"),
    "an unknown law in a table": (lambda: of_numbers()().compare(laws=["jk", "x"]), "no contact law"),
    "an int in a list of laws": (lambda: of_numbers()().compare(laws=[1]), "contact law = 1"),
    "a table at no pressure": (lambda: of_numbers()().compare(0.0), "positive"),
    "an unknown curve": (lambda: of_numbers()().compare_plot(quantity="colour"), "quantity = 'colour'"),
    "a pair of an unknown name": (lambda: faying.ContactPair("45 stel", "45 steel"), "no material"),
    "a pair of numbers alone": (lambda: faying.ContactPair(1, 2), "material = 1"),
    "a law of names": (lambda: faying.JK(D=2.4, G=1e-10, scan_area=1e-6, pair="45 steel"), "ContactPair"),
}


@pytest.mark.parametrize("name", MISUSES)
def test_misuse_is_answered_in_words(name):
    call, words = MISUSES[name]
    with pytest.raises(faying.InputError, match=words):
        call()
