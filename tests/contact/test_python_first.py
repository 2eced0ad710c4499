"""Laws, responses and mates at a Python prompt: what they print and draw."""

import numpy as np
import pytest
from matplotlib.figure import Figure

import faying
from faying.contact import Mikic, PowerLaw, TabulatedLaw
from faying.contact.build import kinds
from faying.surface.synthesize import spectral

SCAN = spectral((64, 64), spacing=2e-6, D=2.3, Rq=2e-7, seed=2, periodic=True)
PAIR = faying.ContactPair("45 steel", "45 steel")
MATES = faying.Mates(SCAN, materials=PAIR, D=2.4, G=1e-11)
JK = faying.JK(D=2.4, G=1e-11, scan_area=1.6e-8, pair=PAIR)
P = np.array([1e6, 2e6, 5e6])


@pytest.fixture(autouse=True)
def closed():
    import matplotlib.pyplot as plt

    yield
    plt.close("all")


def labels(ax):
    return [line.get_label() for line in ax.get_lines() if not line.get_label().startswith("_")]


@pytest.mark.slow
def test_every_law_of_a_scan_prints_a_dozen_lines_at_most():
    made, _ = MATES.laws([kind for kind in kinds() if kind not in ("Table", "GW-measured", "Power law")])
    assert len(made) > 10
    for name, law in made.items():
        lines = str(law).splitlines()
        assert len(lines) <= 12
        assert max(map(len, lines)) < 400
        assert lines[0] == f"Contact law {name}"
        assert law.source in str(law)
        assert "45 steel on 45 steel" in str(law)
        assert f"{len(SCAN.heights)} heights" not in str(law)
        assert "<th" in law._repr_html_()


def test_a_law_says_where_it_ends_and_what_it_assumes():
    end = JK.greatest_pressure
    assert f"to {end / 1e6:.4g} MPa" in str(JK)
    assert JK.assumptions[0] in str(JK)
    assert "alpha 0.2" in str(JK)


def test_printing_a_half_space_solves_no_contact(monkeypatch):
    law = faying.HalfSpace(scan=SCAN, pair=PAIR)
    monkeypatch.setattr(faying.HalfSpace, "_solve", lambda *_, **__: pytest.fail("solved"))
    assert "contacts are solved on first use" in str(law)
    assert "64 x 64 points" in str(law)


def test_a_response_prints_values_with_units_and_reasons():
    one = JK.at_pressure("1 MPa")
    assert str(one).splitlines()[0] == "Response at 1 MPa"
    assert f"{float(one.k_n) * 1e-12:.4g} MPa/um" in str(one)
    many = JK.at_pressure(np.geomspace(1e3, JK.greatest_pressure, 50))
    assert "of shape (50,)" in str(many)
    assert f"at {int(many.valid.sum())} of 50 pressures" in str(many)
    assert all(reason in str(many) for reason, mask in many.reasons.items() if mask.any())
    assert len(str(many).splitlines()) <= 12


def test_text_with_a_unit_counts_for_every_law():
    for law in (JK, Mikic(h_rms=1e-6, mean_slope=0.1, pair=PAIR), PowerLaw.measured(C=0.5, m=0.5, origin="x")):
        assert law.at_pressure("1 MPa").k_n == law.at_pressure(1e6).k_n
        assert np.array_equal(law.at_pressure(["1 MPa", "2 MPa"]).k_n, law.at_pressure([1e6, 2e6]).k_n)


@pytest.mark.slow
def test_a_law_draws_its_branches_by_name_and_its_area():
    law = MATES.law("half-space", points=5)
    stiff, area = law.plot([1e6, 1e7, 1e8])
    assert labels(stiff)[:2] == [r"$k_\mathrm{n}$, unloading", r"$k_\mathrm{load}$, loading"]
    assert (stiff.get_xlabel(), stiff.get_ylabel()) == ("nominal pressure [MPa]", "stiffness per area [MPa/µm]")
    assert (stiff.get_xscale(), stiff.get_yscale()) == ("log", "log")
    assert "area" in area.get_ylabel()
    drawn = {line.get_label(): line.get_xydata() for line in stiff.get_lines()}
    response = law.at_pressure([1e6, 1e7, 1e8])
    assert response.valid.any()
    shown = np.where(response.valid, response.k_n * 1e-12, np.nan)
    np.testing.assert_allclose(drawn[r"$k_\mathrm{n}$, unloading"][:, 1], shown)
    loading = law.with_(stiffness="loading")
    assert labels(loading.plot([1e6, 1e7])[0])[0] == r"$k_\mathrm{n}$, loading"
    assert labels(JK.plot()[0])[0] == r"$k_\mathrm{n}$, loading and unloading"


def test_a_curve_is_thick_where_the_law_is_valid_alone():
    p = np.geomspace(1e3, JK.greatest_pressure * (1 - 1e-9), 40)
    valid = JK.at_pressure(p).valid
    assert 0 < valid.sum() < 40
    thick = next(line for line in JK.plot(p)[0].get_lines() if line.get_label().startswith(r"$k_\mathrm{n}$"))
    assert np.array_equal(np.isfinite(thick.get_ydata()), valid)


def test_a_law_without_area_draws_one_panel_over_its_own_pressures():
    table = TabulatedLaw(pressure=P, k_n=P * 1e6)
    (ax,) = table.plot()
    x = ax.get_lines()[0].get_xdata()
    assert (x[0], x[-1]) == pytest.approx((1.0, 5.0))
    far = TabulatedLaw(pressure=P * 1e3, k_n=P * 1e6)
    assert far.plot()[0].get_lines()[0].get_xdata()[0] == pytest.approx(1e3)
    with pytest.raises(faying.InputError, match="at least two different pressures"):
        table.plot(2e6)
    with pytest.raises(faying.InputError, match="one matplotlib axes"):
        table.plot(axes=list(Figure().subplots(1, 2)))


def test_a_comparison_of_what_no_law_gives_is_refused():
    with pytest.raises(faying.InputError, match="none of these laws gives loss_n"):
        MATES.compare_plot([1e5, 1e6], laws=["persson"], quantity="loss_n")


def test_mates_of_a_line_take_the_G_of_the_surface():
    line = spectral((16, 512), spacing=1e-6, D=2.4, G=1e-10, seed=2).profile("x", 5)
    fit = line.fractal()
    mates = faying.Mates(line, materials=PAIR, scan_area="1 mm^2", other="smooth")
    assert mates.faces.rough.inputs.G == pytest.approx(fit.surface_G)
    assert fit.surface_G > 1.2 * fit.G
    assert any("isotropic" in text for text in mates.faces.warnings)
    by_fit = faying.Mates.of_fit(fit, scan_area="1 mm^2", materials=PAIR, of="both faces")
    assert by_fit.faces.rough.inputs.G == pytest.approx(fit.surface_G)
    given = faying.Mates(line, materials=PAIR, scan_area="1 mm^2", G=2e-11)
    assert given.faces.rough.inputs.G == 2e-11
    assert not any("isotropic" in text for text in given.faces.warnings)
