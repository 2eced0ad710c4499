"""Figures of a frequency response and of the MAC between preloads, and the tables beside them."""

from dataclasses import replace

import numpy as np
import pytest
from matplotlib.figure import Figure

from faying.output import table
from faying.result import Receptance
from faying.result import response_figure as response
from tests.helpers.results import small_result

LINES = np.linspace(10, 200, 96)
MASS, HZ, LOSS = 3.0, 100.0, 0.02


@pytest.fixture
def result():
    """Two loads of a structure that answers as one mass on a spring of 100 and 110 Hz."""
    w = 2 * np.pi * LINES

    def one(f):
        return (1 / (MASS * ((2 * np.pi * f) ** 2 * (1 + 1j * LOSS) - w**2)))[:, None, None]

    found = Receptance(
        frequencies=LINES,
        values=np.stack([one(100.0), one(110.0)]),
        error=np.zeros(2),
        input_points=np.zeros((1, 3)),
        input_directions=np.array([[0.0, 0.0, 2.0]]),
        output_points=np.array([[0.04, 0.0, 0.0]]),
        output_directions=np.array([[0.0, -1.0, 0.0]]),
    )
    return small_result(
        weights=np.array([1.0, 1, 1, 1, 4]),
        mac=np.stack([np.eye(2), np.array([[0.0, 0.9], [1.0, 0.1]])]),
        response=found,
    )


def ax():
    return Figure().add_subplot()


def test_amplitude_is_accelerance_at_every_preload(result):
    axes = response.amplitude(ax(), result)
    assert [line.get_label() for line in axes.lines] == ["2 kN", "8 kN"]
    size = axes.lines[0].get_ydata()
    # far above the spring's frequency a mass answers with 1/m; at the peak with 1/(m eta)
    r = (LINES[-1] / HZ) ** 2
    assert size[-1] == pytest.approx(r / (r - 1) / MASS, rel=1e-3)
    assert size[np.argmin(np.abs(LINES - 100))] == pytest.approx(1 / (MASS * LOSS), rel=1e-9)
    assert axes.get_title("left") == "(40, 0, 0) mm along -y, force at (0, 0, 0) mm along z"
    assert (axes.get_xlabel(), axes.get_yscale()) == ("frequency [Hz]", "log")


def test_phase_goes_from_half_a_turn_to_nothing_through_a_quarter(result):
    phase = response.phase(ax(), result).lines[0].get_ydata()
    assert abs(phase[1]) == pytest.approx(180, abs=2)
    assert abs(phase[np.argmin(np.abs(LINES - 100))]) == pytest.approx(90, abs=1e-6)
    assert phase[-1] == pytest.approx(0, abs=1)
    assert len(response.responses(result).axes) == 2


def test_mac_between_loads_has_the_first_load_in_rows(result):
    axes = response.mac_between_loads(ax(), result)
    np.testing.assert_array_equal(axes.images[0].get_array(), result.mac[1])
    assert (axes.get_ylabel(), axes.get_xlabel()) == ("mode at 2 kN", "mode at 8 kN")
    assert {text.get_text() for text in axes.texts} == {"0.90", "1.00", "0.10"}
    assert len(response.macs(result).axes) == 2  # one map, one colour bar


def test_bolt_forces_stand_in_a_table(result):
    rows = table.bolts(result)
    assert rows == table.bolts(replace(result, tightening=("left", "right")))
    assert rows == [["preload", "left [kN]", "right [kN]"], ["2 kN", "2.000", "1.500"], ["8 kN", "8.000", "6.000"]]


def test_slipping_has_a_column_only_where_something_slips(result):
    assert "slipping [%]" not in table.joints(result)[0]
    rows = table.joints(replace(result, slipping=np.array([[0.0, 0.0], [0.5, 0.25]])))
    at = rows[0].index("slipping [%]")
    assert [row[:2] for row in rows[1:]] == [["2 kN", "a"], ["2 kN", "b"], ["8 kN", "a"], ["8 kN", "b"]]
    assert [row[at] for row in rows[1:]] == ["0.0", "0.0", "50.0", "25.0"]
