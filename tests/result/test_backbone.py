"""What follows from a curve, against closed forms of one degree of freedom; files."""

import numpy as np
import pytest

import faying
from faying.errors import InputError, ReadError
from faying.result.backbone import Backbone, ErrorBounds
from tests.helpers.backbones import made

LINEAR = made(frequency=100.0, damping=0.01)


def test_ring_down_of_a_linear_mode_is_an_exponential():
    found = LINEAR.ring_down(10.0, 0.5)
    np.testing.assert_allclose(found.acceleration, 10 * np.exp(-0.01 * 2 * np.pi * 100 * found.time), rtol=1e-6)
    assert np.all(found.frequency == 100.0)


def test_ring_down_of_damping_that_grows_with_amplitude():
    curve = made(frequency=100.0, damping=lambda a: 0.001 * a)
    found = curve.ring_down(10.0, 0.5)
    # da/dt = -c a^2 has the solution a0/(1 + c a0 t); the curve is interpolated between its points
    c = 0.001 * 2 * np.pi * 100
    np.testing.assert_allclose(found.acceleration, 10 / (1 + c * 10 * found.time), rtol=5e-3)


def test_ring_down_of_a_frequency_that_falls():
    curve = made(frequency=lambda a: 100 * a**-0.1, damping=0.001, points=400)
    found = curve.ring_down(10.0, 0.5)
    # w q^2 falls by exp(-2 zeta w t); with q ~ a/w^2 = a^1.2 and w ~ a^-.1 it is a^2.3
    w = 2 * np.pi * 100 * found.acceleration**-0.1
    fall = np.diff(np.log(found.acceleration)) * 2.3
    np.testing.assert_allclose(fall, -2 * 0.001 * (w[1:] + w[:-1]) / 2 * np.diff(found.time), rtol=2e-3)


def test_below_its_first_point_the_curve_goes_to_rest():
    curve = made(frequency=lambda a: 100 - a, damping=lambda a: 0.001 * a, rest=0.0, linear=100.0)
    f, z = curve.at_acceleration([0.05, 1.0])
    np.testing.assert_allclose(f, [99.95, 99.0], rtol=1e-4)
    np.testing.assert_allclose(z, [5e-5, 1e-3], rtol=1e-2)
    with pytest.raises(InputError, match="it has no value at 1e"):
        curve.at_acceleration(1e6)


def test_a_curve_that_is_read_is_the_one_that_was_written(tmp_path):
    file = LINEAR.save(tmp_path / "curve.nc")
    again = Backbone.load(file)
    assert again == LINEAR
    assert again.bounds == ErrorBounds() or np.isnan(again.bounds.residual)
    assert again != made(frequency=101.0, damping=0.01)
    text = LINEAR.to_csv(tmp_path / "curve.csv").read_text()
    assert text.startswith("acceleration [m/s2],frequency [Hz],damping [-],")
    with pytest.raises(ReadError, match="no such file"):
        Backbone.load(tmp_path / "none.nc")
    file.write_bytes(b"nothing")
    with pytest.raises(ReadError, match="no backbone of Faying"):
        Backbone.load(file)


def test_the_curve_as_json_has_units_and_no_nan():
    import json

    found = LINEAR.to_dict()
    assert found["frequency"]["unit"] == "Hz"
    assert "slip_map" not in found
    json.dumps(found, allow_nan=False)


def test_xarray_opens_the_file(tmp_path):
    import xarray

    data = xarray.load_dataset(LINEAR.save(tmp_path / "curve.nc"), engine="h5netcdf")
    assert data["damping"].dims == ("amplitude",)
    assert data["frequency"].attrs["units"] == "Hz"
    assert faying.load(tmp_path / "curve.nc") == LINEAR


def test_a_curve_prints_in_a_dozen_lines_and_plots(tmp_path):
    assert len(repr(LINEAR).splitlines()) <= 12
    assert "100.000 Hz" in repr(LINEAR)
    upper, lower = LINEAR.plot()
    upper.figure.savefig(tmp_path / "curve.png")
    assert (upper.get_ylabel(), lower.get_ylabel()) == ("frequency [Hz]", "damping ratio [%]")
    assert np.array_equal(upper.lines[0].get_ydata(), LINEAR.frequency)
