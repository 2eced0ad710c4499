"""Frequency and damping against amplitude from a free decay of one to three modes; measured points."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal, Self

import numpy as np

from faying.checks import number, whole
from faying.columns import read_columns
from faying.errors import InputError, ReadError
from faying.files import write_text
from faying.measured.exponentials import Track, widened
from faying.measured.frf import FRF, QUANTITIES
from faying.misuse import checked_call
from faying.style import Summary
from faying.typing import Array, Complex

EDGE = 0.25  # of the band, on both sides, over which the filter rises
RINGING = 3.2  # over the width of an edge: how long the ends of the record are felt [-]
CYCLES = 20  # least length of the stretch that gives one point
INDEPENDENT = 8  # least samples at the rate of the band in a stretch: three unknowns, and freedom to tell noise
MIN_POINTS = 5  # points without which there is no curve
STANDARD_ERRORS = 3.0  # in a damping, at least: a point knows it to a third
Motion = Literal["displacement", "velocity", "acceleration"]
MOTIONS: dict[Motion, int] = {"displacement": 0, "velocity": 1, "acceleration": 2}  # derivatives of the displacement
MOTION_UNITS = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s^2"}
UNEVEN = 0.05  # of the time between two samples: digits that the file leaves out
RECORD_FORM = "a record looks like: time [s],acceleration [m/s^2] and under it rows such as 0.0001,12.3"
KNOWN = {"acceleration": "m/s^2", "displacement": "m", "frequency": "Hz", "damping": "1", "time": "s"}
FORM = (
    "measured points look like: acceleration [m/s^2],frequency [Hz],damping [%] and under it rows such as 3,178.2,0.21"
)


@checked_call
@dataclass(frozen=True, kw_only=True, repr=False)
class MeasuredBackbone(Summary):
    """Frequency and damping of one mode against its amplitude, as measured; all arrays (n,), NaN where not known.

    acceleration [m/s2]: amplitude of the fundamental; frequency [Hz]; damping [-] of critical; frequency_error,
    damping_error: standard errors; time [s] in the record.
    """

    acceleration: Array
    frequency: Array
    damping: Array
    frequency_error: Array
    damping_error: Array
    time: Array
    source: str = ""

    def summary(self) -> tuple[str, dict[str, str]]:
        """Return a heading, and the ranges of what was measured."""
        a, f, z = self.acceleration, self.frequency, 100 * self.damping
        rows = {
            "acceleration": f"{np.nanmin(a):.3g} to {np.nanmax(a):.3g} m/s2",
            "frequency": f"{np.nanmin(f):.2f} to {np.nanmax(f):.2f} Hz" if np.isfinite(f).any() else "not known",
            "damping": f"{np.nanmin(z):.3g} to {np.nanmax(z):.3g} %" if np.isfinite(z).any() else "not known",
        }
        return f"Measured backbone of {len(a)} points, {Path(self.source).name or 'given in Python'}", rows

    @classmethod
    def read(cls, path: str | Path) -> Self:
        """Read measured points from a CSV file whose head names quantities and units.

        Columns: acceleration [m/s^2] or displacement [um] (amplitudes; the one follows from the other), frequency [Hz],
        and damping [%] where it is known. Lines from # on are comments.

        Raises:
            ReadError: with the file and the line, where it is not such a table.
        """
        path = Path(path)
        table = read_columns(path, KNOWN, needed="frequency", form=FORM)
        found, lines = table.values, table.lines
        if not lines:
            raise ReadError(f"{path}: no rows under the head; {FORM}")
        if ("acceleration" in found) == ("displacement" in found):
            raise ReadError(f"{path}: give either acceleration or displacement, the amplitude of each row; {FORM}")
        for name, values in found.items():
            low = values < 0 if name in ("damping", "time") else values <= 0
            if np.any(low):
                row = int(np.argmax(low))
                raise ReadError(
                    f'{path}, line {lines[row]}: {table.given(name, row)} in the column "{name}" must be positive'
                )
        frequency = found["frequency"]
        shift = (2 * np.pi * frequency) ** 2
        amplitude = found["acceleration"] if "acceleration" in found else found["displacement"] * shift
        return cls.of_points(amplitude, frequency, found.get("damping"), time=found.get("time"), source=str(path))

    @classmethod
    def of_points(
        cls,
        acceleration: Array,
        frequency: Array,
        damping: Array | None = None,
        *,
        time: Array | None = None,
        source: str = "",
    ) -> Self:
        """Return points (n,) whose errors are not known, nor what is None."""
        unknown = np.full(len(frequency), np.nan)
        return cls(
            acceleration=acceleration,
            frequency=frequency,
            damping=unknown if damping is None else damping,
            frequency_error=unknown,
            damping_error=unknown,
            time=unknown if time is None else time,
            source=source,
        )

    def to_csv(self, path: str | Path) -> Path:
        """Write the points as `read` takes them; the file appears complete or not at all."""
        rows = [f"# {self.source}"] if self.source else []
        rows.append("acceleration [m/s^2],frequency [Hz],damping [%]")
        columns = zip(self.acceleration, self.frequency, 100 * self.damping, strict=True)
        rows += [f"{a:.8g},{f:.8g},{z:.6g}" for a, f, z in columns]
        return write_text(Path(path), "\n".join([*rows, ""]))


def read_record(path: str | Path) -> tuple[Array, float, Motion, float]:
    """Read the record of one sensor from a CSV file: time [s] and one motion, such as acceleration [m/s^2].

    Returns:
        The samples (n,) in SI units, the sampling rate [1/s], what was measured, and when it begins [s].

    Raises:
        ReadError: with the file and the line, where it is not such a record or its samples are not evenly spaced.
    """
    path = Path(path)
    table = read_columns(path, {"time": "s", **MOTION_UNITS}, needed="time", form=RECORD_FORM)
    found = [name for name in MOTIONS if name in table.values]
    if len(found) != 1:
        raise ReadError(f"{path}, line {table.head}: give one of the columns {', '.join(MOTIONS)}; {RECORD_FORM}")
    time = table.values["time"]
    if len(time) < 2:
        raise ReadError(f"{path}: {len(time)} samples are too few for a record; {RECORD_FORM}")
    step = (time[-1] - time[0]) / (len(time) - 1)
    apart = np.abs(np.diff(time) - step)
    if not step > 0 or apart.max() > UNEVEN * step:
        row = int(np.argmax(apart)) + 1
        raise ReadError(f"{path}, line {table.lines[row]}: samples must follow each other evenly; resample the record")
    return table.values[found[0]], 1 / step, found[0], float(time[0])


@checked_call
def ring_down(
    signal: Any,
    sampling_rate: float,
    *,
    band: tuple[float, float],
    quantity: Motion = "acceleration",
    cycles: int = CYCLES,
    start: float = 0.0,
) -> MeasuredBackbone:
    """Frequency and damping of one mode along a free decay of one to three modes.

    The record is filtered by a band with smooth edges and without its negative frequencies, so that nothing is shifted
    in phase. Stretches of at least `cycles` periods, each a fourth of its length after the last, get one to three
    exponentials by matrix pencil and least squares; the mode that is the largest at the start is followed. Number of
    exponentials and length of the stretches are those that describe the record by the fewest parameters. What lies
    within 3.2 over the width of the filter's edges from an end of the record is discarded: there the filter rings.

    damping is that of a Backbone, the loss in a cycle over 2 pi w^2 q^2, with q the displacement amplitude times the
    root of the modal mass and w the circular frequency. A loss D lowers the action w q^2/2 by D/(w T) in a period T
    (dE = w dJ, whatever the restoring force), so that damping = -d ln(q sqrt w)/dt/w. Where the frequency changes with
    amplitude this is not -d ln q/dt/w: the two differ by d ln w/d ln q/2.

    Args:
        signal: (n,), in the SI unit of `quantity`, free from `start` on.
        sampling_rate: samples per second [1/s].
        band: [Hz] with this mode and at most two smaller ones; its width should be ten times the decay rate or more.
        quantity: of the signal.
        cycles: least of a stretch: more average the noise, fewer follow a quick change.
        start: of the free decay [s] in the record.

    Returns:
        Points up to where the damping is not known to a third of itself. The errors contain the noise and the scatter
        from stretch to stretch.

    Raises:
        InputError: a record that is too short for the band, a band outside it, an amplitude that rises, or noise or
            modes that this record cannot separate.

    Source:
        Hua and Sarkar 1990, doi:10.1109/29.56027 (matrix pencil); Schwarz 1978, doi:10.1214/aos/1176344136 (the choice
        of length and number).
    """
    x = np.asarray(signal, dtype=float)
    if quantity not in MOTIONS:
        raise InputError(f"quantity {quantity!r}: use one of {', '.join(MOTIONS)}")
    number(sampling_rate, "sampling_rate", "1/s", least=0)
    start = number(start, "start", "s", least=0, ends="[)")
    if x.ndim != 1 or not round(start * sampling_rate) < len(x) or not np.all(np.isfinite(x)):
        raise InputError(
            f"the record has the shape {x.shape}, has NaN or ends before {start:g} s; give one row of finite samples"
        )
    _check_band(band, sampling_rate / 2)
    x = x[round(start * sampling_rate) :]
    padded = 2 * len(x)  # so that the end does not wrap round onto the beginning
    lines = np.fft.rfft(x, padded)
    frequency = np.asarray(np.fft.rfftfreq(padded, 1 / sampling_rate), float)
    weighted = np.zeros(padded, dtype=complex)
    weighted[: len(lines)] = 2 * lines * _filter(frequency, band)
    analytic = np.fft.ifft(weighted)[: len(x)]
    return _curve(analytic, sampling_rate, band, MOTIONS[quantity], cycles, start)


@checked_call
def ring_down_of_frf(
    frf: FRF, *, impulse: float, band: tuple[float, float], output: int = 0, input: int = 0, cycles: int = CYCLES
) -> MeasuredBackbone:
    """Frequency and damping along the decay that a hammer's FRF stands for.

    A linear structure has one FRF, a joint one for each strength of the hit: take the FRF of a single hit, or of hits
    alike. Its lines in the band, transformed back and multiplied by the hit's impulse, are the analytic signal of the
    free decay after it; from there on as `ring_down`. An exponential window's decay is taken off.

    Args:
        frf: with evenly spaced lines.
        impulse: of the hit [N s], positive.
        band: [Hz] with this mode and at most two smaller ones.
        output, input: which function.
        cycles: least of a stretch.

    Raises:
        InputError: as `ring_down`.
    """
    number(impulse, "impulse of the hit", "N*s", least=0)
    whole(output, "output", least=0, greatest=len(frf.outputs) - 1)
    whole(input, "input", least=0, greatest=len(frf.inputs) - 1)
    _check_band(band, float(frf.frequency[-1]))
    values, step = frf.values[output, input], frf.whole_step
    if not np.all(np.isfinite(values)):
        raise InputError(f"output {output} and input {input} were not measured together")
    # more instants than lines, so that the curve is smooth: zeros beyond the last line
    count = 1 << int(np.ceil(np.log2(4 * frf.frequency[-1] / step)))
    weighted = np.zeros(count, dtype=complex)
    weighted[np.rint(frf.frequency / step).astype(int)] = values * _filter(frf.frequency, band)
    analytic = 2 * impulse * step * count * np.fft.ifft(weighted)
    if frf.window_decay:
        analytic = analytic * np.exp(frf.window_decay * np.arange(count) / (count * step))
    return _curve(analytic, count * step, band, QUANTITIES[frf.quantity], cycles, 0.0)


def _check_band(band: tuple[float, float], highest: float) -> None:
    low, high = band
    if not 0 < low < high <= highest:
        raise InputError(f"band = {low:g} to {high:g} Hz: it must rise and be between 0 and {highest:g} Hz")


def _filter(frequency: Array, band: tuple[float, float]) -> Array:
    """1 in the middle of the band, 0 outside, with edges without corners to any order."""
    low, high = band
    edge = EDGE * (high - low)
    inward = np.clip(np.minimum(frequency - low, high - frequency) / edge, 0.0, 1.0)
    inside = (inward > 0) & (inward < 1)
    x = np.where(inside, inward, 0.5)
    return np.where(inside, 1 / (1 + np.exp(np.clip(1 / x - 1 / (1 - x), -500, 500))), inward)


def _curve(
    analytic: Complex, rate: float, band: tuple[float, float], power: int, cycles: int, start: float
) -> MeasuredBackbone:
    """Frequency and damping of the mode that is the largest at the start of an analytic signal."""
    whole(cycles, "cycles", least=1)
    width, middle, given = band[1] - band[0], (band[0] + band[1]) / 2, f"{band[0]:g} to {band[1]:g} Hz"
    cut = int(np.ceil(RINGING / (EDGE * width) * rate))
    every = max(1, int(rate / width))  # without negative frequencies one sample in 1/width is enough
    free = analytic[cut : len(analytic) - cut]
    slow = (free * np.exp(-2j * np.pi * middle / rate * np.arange(len(free))))[::every]
    shortest = int(np.ceil(max(cycles / middle, INDEPENDENT / width) * rate / every))
    if len(slow) < shortest + 2:
        raise InputError(
            f"the record of {len(analytic) / rate:.3g} s is too short for a band of {width:g} Hz: {2 * cut / rate:.3g} "
            f"s are lost at its ends and one stretch takes {shortest * every / rate:.3g} s; widen the band or record "
            "longer"
        )
    scale = float(np.abs(slow).max()) or 1.0
    track = Track.follow(slow / scale, shortest, (1 - EDGE) * width * every / rate)
    points = None if track is None else _points(track, rate / every, middle, power)
    if points is None or len(points.time) < MIN_POINTS:
        raise InputError(
            f"{0 if points is None else len(points.time)} stretches have a damping in {given} that is known to a third "
            f"of itself; {MIN_POINTS} are needed: noise, or more than one mode in the band that this record cannot "
            "separate; move the band, start after the hit, or record longer"
        )
    return replace(points, time=start + cut / rate + points.time, acceleration=scale * points.acceleration)


def _points(track: Track, rate: float, middle: float, power: int) -> MeasuredBackbone:
    """Points of a mode's track, up to where its decay is known to a third; time from the start of the track."""
    growth, omega = track.pole.real * rate, track.pole.imag * rate + 2 * np.pi * middle
    error, bend_error = track.pole_error * rate, track.bend_error * rate**2
    change = 2 * track.bend.imag * rate**2 / omega  # d ln omega/dt
    damping = -(growth - (power - 0.5) * change) / omega
    damping_error = widened(np.hypot(error, (2 * power - 1) * bend_error / omega) / omega, damping)
    acceleration = np.abs(track.amplitude) * omega ** (2 - power)
    rises = track.clear() & (growth > STANDARD_ERRORS * error)
    if np.any(rises):
        raise InputError(
            f"the amplitude at {omega[np.argmax(rises)] / (2 * np.pi):.4g} Hz rises: this is not a free decay, or "
            "its modes are nearer each other than this record can separate; start after the last hit, or record longer"
        )
    good = track.clear() & (damping > STANDARD_ERRORS * damping_error) & np.append(True, np.diff(acceleration) < 0)
    count = len(good) if np.all(good) else int(np.argmin(good))
    frequency = omega / (2 * np.pi)
    return MeasuredBackbone(
        acceleration=acceleration[:count],
        frequency=frequency[:count],
        damping=damping[:count],
        frequency_error=widened(error / (2 * np.pi), frequency)[:count],
        damping_error=damping_error[:count],
        time=track.time[:count] / rate,
    )
