import numpy as np
import pytest
from matplotlib.figure import Figure

from faying import InputError
from faying.surface import figure as plot
from faying.surface.form import prepared
from faying.surface.fractal import fit_all
from faying.surface.spectrum import spectrum
from faying.surface.synthesize import spectral


@pytest.fixture
def rough():
    return spectral((96, 128), spacing=1e-6, D=2.5, G=1e-9, seed=1)


def axes():
    return Figure().subplots()


def test_map_has_physical_axes(rough):
    ax = plot.height_map(rough, axes())
    assert ax.get_xlabel() == "x [µm]"
    assert ax.get_images()[0].get_extent() == pytest.approx([0, 128, 0, 96])


def test_profile_reads_in_sensible_units(rough):
    line = rough.profile("x", 3)
    ax = plot.profile(line, axes())
    x, z = ax.get_lines()[0].get_data()
    assert x[-1] == pytest.approx(127)
    scale = {"height [nm]": 1e9, "height [µm]": 1e6}[ax.get_ylabel()]
    assert np.allclose(z, line.heights * scale)


def test_spectrum_shows_the_fitted_law_over_its_band(rough):
    fits = fit_all(rough)
    s = spectrum(prepared(rough).scan)
    ax = plot.power_spectrum(s, fits, axes())
    lines = {line.get_label(): line for line in ax.get_lines()}
    f, law = lines[f"psd, $D$ {fits['psd'].D:.3f}"].get_data()
    assert (f[0], f[-1]) == pytest.approx((1 / fits["psd"].band[1], 1 / fits["psd"].band[0]))
    middle = np.interp(f[25], s.frequency, s.density)
    assert 0.5 < law[25] / middle < 2


def test_estimators_draw_their_intervals(rough):
    fits = fit_all(rough) | {"failed": "no"}
    ax = plot.estimators(fits, axes())
    names = [t.get_text() for t in ax.get_yticklabels()]
    assert "failed" not in names
    assert "psd" in names
    low, high = fits["psd"].D_interval
    drawn = [line.get_xdata() for line in ax.get_lines()]
    assert any(len(x) == 2 and tuple(x) == pytest.approx((low, high)) for x in drawn)


def test_overview_refuses_unknown_suffix(rough, tmp_path):
    with pytest.raises(InputError, match="figures can be written as"):
        plot.overview(rough, prepared(rough), fit_all(rough), tmp_path / "a.what")
