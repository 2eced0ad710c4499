"""Backbones from free decays whose curves are known: linear, Duffing's and Jenkins' oscillators."""

import os
import re
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import cumulative_simpson, simpson, solve_ivp
from scipy.io import loadmat
from scipy.optimize import brentq

import faying
from faying.errors import InputError
from faying.measured.frf import FRF
from faying.measured.ring_down import MeasuredBackbone, ring_down, ring_down_of_frf
from tests.helpers.hits import frf_of_hit

RATE, HZ = 4096.0, 100.0
OMEGA = 2 * np.pi * HZ
DATA = Path(os.environ.get("FAYING_DATA", Path(__file__).parents[2].parent / "shared" / "data"))
HAMMER = DATA / "brake-reuss-hammer" / "HammerImpact.mat"


def decay(t, hz=HZ, ratio=0.01, amplitude=10.0, phase=0.4):
    """Exact decay of a linear mode: `hz` is the damped frequency, `ratio` the decay over 2 pi hz."""
    return amplitude * np.exp(-ratio * 2 * np.pi * hz * t) * np.cos(2 * np.pi * hz * t + phase)


@pytest.mark.parametrize("quantity", ["acceleration", "velocity", "displacement"])
def test_a_linear_mode_keeps_its_frequency_and_damping(quantity):
    t = np.arange(int(2 * RATE)) / RATE
    found = ring_down(decay(t, ratio=0.003), RATE, band=(70, 130), quantity=quantity)
    assert found.frequency == pytest.approx(HZ, rel=1e-6)
    assert found.damping == pytest.approx(0.003, rel=5e-4)
    power = {"acceleration": 0, "velocity": 1, "displacement": 2}[quantity]
    exact = 10.0 * np.exp(-0.003 * OMEGA * found.time) * OMEGA**power
    assert found.acceleration == pytest.approx(exact, rel=1e-4)


def test_other_modes_and_an_offset_outside_the_band_do_not_matter():
    t = np.arange(int(2 * RATE)) / RATE
    others = decay(t, hz=170.0, ratio=0.004, amplitude=30.0) + decay(t, hz=33.0, ratio=0.01) + 5.0
    found = ring_down(decay(t, ratio=0.003) + others, RATE, band=(70, 130))
    assert found.frequency == pytest.approx(HZ, rel=2e-5)
    assert found.damping == pytest.approx(0.003, rel=0.01)


def test_the_largest_of_three_modes_in_the_band():
    """4 and 5 Hz beside it, with half and 0.8 of its amplitude: one exponential a window was refused here."""
    t = np.arange(int(3 * RATE)) / RATE
    noise = np.random.default_rng(1).normal(size=t.size) * 0.01
    others = decay(t, hz=104.0, ratio=0.002, amplitude=5.0) + decay(t, hz=95.0, ratio=0.004, amplitude=8.0, phase=2.0)
    found = ring_down(decay(t, ratio=0.003) + others + noise, RATE, band=(70, 130))
    assert np.all(np.abs(found.damping - 0.003) < 3 * found.damping_error)
    assert np.all(np.abs(found.frequency - HZ) < 3 * found.frequency_error)
    assert found.damping_error.max() < 1e-4
    assert found.acceleration == pytest.approx(10.0 * np.exp(-0.003 * OMEGA * found.time), rel=0.01)


def neighbours(seed):
    """A record of two modes 0.6 to 3 % apart with 0.1 % of noise, and frequency and damping of the larger one.

    The larger one at 0.21 s, where the filter has stopped to ring: the smaller one may die more slowly.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(int(rng.uniform(2, 5) * 2048)) / 2048.0
    hz = 300 * np.array([1, 1 + rng.choice([-1, 1]) * rng.uniform(0.006, 0.03)])
    size = np.array([1, 10 ** rng.uniform(-2, 0)])
    ratio = 10 ** rng.uniform(np.log10(0.0005), np.log10(0.003), 2)
    parts = [decay(t, f, z, a, rng.uniform(0, 6)) for f, z, a in zip(hz, ratio, size, strict=True)]
    larger = np.argmax(size * np.exp(-ratio * 2 * np.pi * hz * 0.21))
    return sum(parts) + 0.001 * rng.normal(size=t.size), hz[larger], ratio[larger]


@pytest.mark.slow  # 8 CPU s
def test_a_neighbour_does_not_move_a_mode_beyond_its_errors():
    beyond, number, refused = 0, 0, 0
    for seed in range(60):
        signal, hz, ratio = neighbours(seed)
        try:
            found = ring_down(signal, 2048.0, band=(270, 330))
        except InputError:
            refused += 1
            continue
        assert np.all(found.damping > 0)
        assert np.all(np.diff(found.acceleration) < 0)
        beyond += np.count_nonzero(np.abs(found.damping - ratio) > 3 * found.damping_error)
        beyond += np.count_nonzero(np.abs(found.frequency - hz) > 3 * found.frequency_error)
        number += 2 * len(found.damping)
    assert beyond < 0.05 * number
    assert refused < 6


@pytest.mark.parametrize(("hz", "within"), [(303.0, 0.01), (299.5, 0.03)])
def test_a_beat_is_no_change_of_damping(hz, within):
    """0.15 % at 297.7 Hz beside 0.12 % with a tenth of the amplitude: slopes of one phase gave -0.56 to 0.90 %."""
    t = np.arange(int(3 * RATE)) / RATE
    both = decay(t, 297.7, 0.0015, 10.0) + decay(t, hz, 0.0012, 1.0, 1.0)
    found = ring_down(both + np.random.default_rng(3).normal(size=t.size) * 0.01, RATE, band=(270, 330))
    assert found.damping == pytest.approx(0.0015, rel=within)
    assert found.frequency == pytest.approx(297.7, abs=0.02)


def test_the_hammer_record_of_a_brake_reuss_beam():
    """Mode 1 of the record with publication doi:10.1016/j.ymssp.2021.108401: 0.14 to 0.19 % over 1 to 13 m/s2."""
    if not HAMMER.is_file():
        pytest.skip(f"the measured record is absent: {HAMMER}, of github mattiacenedese/BRBtesting; set FAYING_DATA")
    record = loadmat(HAMMER, squeeze_me=True, struct_as_record=False)["HIdata"]
    found, elsewhere = (ring_down(a, 12800.0, band=(65, 96), start=0.02) for a in (record.acc1, record.acc3))
    some = (found.acceleration > 1) & (found.acceleration < 13)
    assert np.count_nonzero(some) > 20
    assert np.all((found.damping[some] > 0.0014) & (found.damping[some] < 0.0019))
    assert elsewhere.damping == pytest.approx(np.interp(elsewhere.time, found.time, found.damping), rel=0.04)
    assert elsewhere.frequency == pytest.approx(np.interp(elsewhere.time, found.time, found.frequency), rel=1e-4)
    # another mode of the same beam, where slopes of one phase gave -0.16 to 0.24 %
    found = ring_down(record.acc2, 12800.0, band=(270, 330), start=0.02)
    assert np.all((found.damping > 0.0008) & (found.damping < 0.0013))


def test_duffings_oscillator():
    """x'' + c x' + w0^2 x + b x^3 = 0: frequency by the exact period; damping c/(2 w), which the decay alone is not.

    The frequency falls by 20 % over the record, and c is small, so that each cycle is nearly one without damping.
    """
    c, b = 2.0, 0.8 * OMEGA**2
    t = np.arange(int(1.2 * RATE)) / RATE
    path = solve_ivp(
        lambda _, y: [y[1], -c * y[1] - OMEGA**2 * y[0] - b * y[0] ** 3],
        (0, t[-1]),
        [1.0, 0.0],
        t_eval=t,
        rtol=1e-10,
        atol=1e-10,
    )
    found = ring_down(path.y[0], RATE, band=(60, 180), quantity="displacement", cycles=8)
    size = found.acceleration / (2 * np.pi * found.frequency) ** 2
    for fundamental, hz in list(zip(size, found.frequency, strict=True))[::3]:
        amplitude = brentq(lambda a, q=fundamental: duffing(a, b)[1] - q, fundamental, 1.2 * fundamental)
        assert hz == pytest.approx(duffing(amplitude, b)[0], rel=2e-4)
    assert found.frequency[0] > 1.1 * found.frequency[-1]
    assert found.damping == pytest.approx(c / (4 * np.pi * found.frequency), rel=0.01)


def duffing(q, b):
    """Frequency [Hz] of free motion of amplitude q without damping, and its first harmonic."""
    rate = lambda a: np.sqrt(OMEGA**2 + b * q**2 * (1 + np.sin(a) ** 2) / 2)  # noqa: E731  # da/dt where x = q sin a
    a = np.linspace(0, np.pi / 2, 2001)
    time = cumulative_simpson(1 / rate(a), x=a, initial=0)
    omega = np.pi / 2 / time[-1]
    return omega / (2 * np.pi), 4 / np.pi * simpson(q * np.sin(a) * np.sin(omega * time) * omega / rate(a), x=a)


def test_jenkins_oscillator_gives_the_loss_of_its_hysteresis():
    """A slider of 4 % of the spring's stiffness: damping and frequency by the first harmonic's exact integrals.

    Damping rises from 0 to about 1 % and falls again; the cycle is nearly harmonic since the slider is weak.
    """
    weak, limit = 0.04 * OMEGA**2, 0.04 * OMEGA**2 * 1.0  # slips at a displacement of 1
    c = 2 * 0.0005 * OMEGA
    step = 1 / (16 * RATE)
    x, v, rest = 12.0, 0.0, 0.0  # displacement, velocity, force of the slider
    record = []
    for k in range(int(3 * RATE) * 16):
        if k % 16 == 0:
            record.append(x)
        v += step * (-(OMEGA**2) * x - rest - c * v)  # symplectic Euler: frequency right to (w dt)^2/24
        x += step * v
        rest = min(max(rest + weak * step * v, -limit), limit)
    found = ring_down(record, RATE, band=(60, 140), quantity="displacement", cycles=10)
    q = found.acceleration / (2 * np.pi * found.frequency) ** 2
    slips = q > 1.3  # away from the knee, which a stretch rounds off
    assert np.count_nonzero(slips) > 10
    turn = np.arccos(1 - 2 / q[slips])
    stiff = OMEGA**2 + weak / np.pi * (turn - np.sin(2 * turn) / 2)
    ratio = c / (2 * np.sqrt(stiff)) + 4 * limit * (q[slips] - 1) / (2 * np.pi * stiff * q[slips] ** 2)
    assert found.frequency[slips] == pytest.approx(np.sqrt(stiff) / (2 * np.pi), rel=5e-4)
    assert found.damping[slips] == pytest.approx(ratio, rel=0.03)
    sticks = (q < 0.8) & (q > 0.05)
    assert found.damping[sticks] == pytest.approx(c / (2 * OMEGA), rel=0.03)
    assert found.frequency[sticks] == pytest.approx(np.sqrt(1.04) * HZ, rel=1e-4)


def test_noise_widens_the_standard_errors_and_ends_the_curve():
    """Errors are within three standard errors nearly always, and the curve stops above the noise."""
    rng = np.random.default_rng(5)
    t = np.arange(int(4 * RATE)) / RATE
    beyond, number = 0, 0
    for _ in range(8):
        found = ring_down(decay(t, ratio=0.003) + rng.normal(size=t.size) * 0.05, RATE, band=(70, 130), cycles=40)
        beyond += np.count_nonzero(np.abs(found.damping - 0.003) > 3 * found.damping_error)
        beyond += np.count_nonzero(np.abs(found.frequency - HZ) > 3 * found.frequency_error)
        number += 2 * len(found.damping)
        assert found.acceleration.min() > 0.05
        assert found.damping_error[-1] > 2 * found.damping_error[0]
    assert beyond < 0.05 * number


@pytest.mark.parametrize("decay", [0.0, 2.0])
def test_a_hammers_frf_with_the_impulse_of_its_hit_is_the_same_decay(decay):
    """Accelerance of one hit: the decay begins with the hit; the window's decay is taken off."""
    t = np.arange(int(4 * RATE)) / RATE
    ratio, mass, impulse = 0.004, 2.0, 0.05
    damped = OMEGA * np.sqrt(1 - ratio**2)
    speed = (
        impulse / mass * np.exp(-ratio * OMEGA * t) * (np.cos(damped * t) - ratio * OMEGA / damped * np.sin(damped * t))
    )
    force = np.zeros_like(t)
    force[0] = impulse * RATE
    frf = frf_of_hit(force, speed, RATE, "mobility", decay)
    found = ring_down_of_frf(frf, impulse=impulse, band=(70, 130))
    head = found.time < 0.8
    assert found.frequency[head] == pytest.approx(damped / (2 * np.pi), rel=1e-5)
    assert found.damping[head] == pytest.approx(ratio * OMEGA / damped, rel=2e-3)
    exact = impulse / mass * OMEGA * np.exp(-ratio * OMEGA * found.time[head])
    assert found.acceleration[head] == pytest.approx(exact, rel=5e-3)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"band": (130, 70)}, "it must rise and be between"),
        ({"band": (70, 3000)}, "it must rise and be between 0 and 2048 Hz"),
        ({"band": (99, 101)}, "too short for a band of 2 Hz"),
        ({"quantity": "strain"}, 'give "displacement" or "velocity" or "acceleration"'),
        ({"sampling_rate": 0.0}, "sampling_rate = 0 1/s; it must be positive"),
        ({"signal": [1.0, np.nan]}, "one row of finite samples"),
        ({"signal": np.random.default_rng(0).normal(size=8192)}, "noise, or more than one mode"),
        ({"signal": np.zeros(8192)}, "noise, or more than one mode"),
        ({"signal": np.cos(OMEGA * np.arange(8192) / RATE)}, "noise, or more than one mode"),
        ({"signal": decay(np.arange(8192) / RATE, ratio=-0.002)}, "the amplitude at 100 Hz rises: this is not a free"),
        (
            {"signal": decay(np.arange(8192) / RATE) + decay(np.arange(8192) / RATE, hz=100.3, amplitude=9.0, phase=3)},
            "more than one mode in the band that this record cannot separate|the amplitude at .* rises",
        ),
    ],
)
def test_what_gives_no_curve_is_refused(changes, message):
    given = {"signal": decay(np.arange(8192) / RATE), "sampling_rate": RATE, "band": (70, 130)} | changes
    with pytest.raises(faying.InputError, match=message):
        ring_down(given.pop("signal"), given.pop("sampling_rate"), **given)


@pytest.mark.parametrize("size", [1e-200, 1e150])
def test_the_size_of_a_motion_does_not_matter(size):
    found = ring_down(size * decay(np.arange(8192) / RATE), RATE, band=(70, 130))
    assert found.damping == pytest.approx(0.01, rel=2e-3)
    assert found.acceleration == pytest.approx(size * 10 * np.exp(-0.01 * OMEGA * found.time), rel=1e-3)


def test_a_motion_that_goes_on_longer_than_any_decay_is_refused():
    t = np.arange(int(25 * RATE)) / RATE
    with pytest.raises(InputError, match="a decay for at most 10,000: narrow the band"):
        ring_down(decay(t, hz=600.0, ratio=1e-5), RATE, band=(300, 900))


def test_an_impulse_is_needed_for_an_frf():
    frf = FRF(frequency=[1.0, 2.0], values=[[[1, 1]]], outputs=[(1, "z")], inputs=[(1, "z")], quantity="accelerance")
    with pytest.raises(faying.InputError, match="impulse of the hit"):
        ring_down_of_frf(frf, impulse=0.0, band=(1, 2))


def test_lines_between_the_multiples_of_their_spacing_are_refused():
    """They were moved to the nearest multiple: 99.90 Hz for 100."""
    lines = np.arange(50.35, 150, 0.25)
    values = 1 / (OMEGA**2 - (2 * np.pi * lines) ** 2 + 0.008j * OMEGA * 2 * np.pi * lines)
    frf = FRF(frequency=lines, values=values[None, None], outputs=[(1, "z")], inputs=[(1, "z")], quantity="receptance")
    with pytest.raises(faying.InputError, match=r"the first spectral line, 50.35 Hz, is not a multiple of .* 0.25 Hz"):
        ring_down_of_frf(frf, impulse=1.0, band=(85, 115))


def test_measured_points_from_a_table(tmp_path):
    file = tmp_path / "points.csv"
    file.write_text("# beam\nfrequency [Hz],damping [%],acceleration [g_0]\n180,0.1,0.5\n178.5,0.32,2\n")
    found = MeasuredBackbone.read(file)
    assert found.frequency == pytest.approx([180, 178.5])
    assert found.damping == pytest.approx([0.001, 0.0032])
    assert found.acceleration == pytest.approx([0.5 * 9.80665, 2 * 9.80665])
    file.write_text("displacement [um],frequency [Hz]\n3,100\n")
    found = MeasuredBackbone.read(file)
    assert found.acceleration == pytest.approx([3e-6 * (200 * np.pi) ** 2])
    assert np.all(np.isnan(found.damping))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("frequency [Hz],damping [%]\n1,2\n", "give either acceleration or displacement"),
        ("acceleration [m/s^2],displacement [um],frequency [Hz]\n1,2,3\n", "give either acceleration or displacement"),
        ("acceleration [m/s^2],frequency\n1,2\n", 'line 1: the column "frequency" lacks its unit'),
        ("acceleration [m/s^2],damping [%]\n1,2\n", 'no column "frequency [unit]"'),
        ("acceleration [m/s^2],frequency [Hz]\n1,180\n-2,170\n", 'line 3: -2 in the column "acceleration"'),
        ("acceleration [m/s^2],frequency [Hz]\n", "no rows under the head"),
        ("acceleration [m/s^2],zeta [%]\n", "the known ones are acceleration, displacement, frequency, damping, time"),
    ],
)
def test_a_table_of_another_form_is_refused(tmp_path, text, message):
    file = tmp_path / "points.csv"
    file.write_text(text)
    with pytest.raises(faying.ReadError, match=re.escape(message)):
        MeasuredBackbone.read(file)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"signal": []}, "shape \\(0,\\)"),
        ({"signal": 1.0}, "shape \\(\\)"),
        ({"start": np.nan}, "start = nan s"),
        ({"start": 1e9}, "ends before 1e\\+09 s"),
        ({"start": 8191.7 / RATE}, "ends before 1.9999"),
        ({"cycles": -1}, "cycles = -1"),
    ],
)
def test_records_and_stretches_that_cannot_be_are_refused(change, said):
    given = {"signal": decay(np.arange(8192) / RATE), "sampling_rate": RATE, "band": (70, 130)} | change
    with pytest.raises(InputError, match=said):
        ring_down(**given)
