"""The tables that answer first: each mode with its interval, what makes the intervals, what narrows them, the test."""

import numpy as np

from faying.case.scatter import SCATTER
from faying.notes import INCOMPLETE
from faying.output.table import Rows, by_mode, damping_at
from faying.result import Result
from faying.result.groups import Levels
from faying.result.interval import Interval
from faying.result.run_record import preload_slope
from faying.result.score import Score
from faying.result.shape_names import part_and_axis
from faying.text import or_dash
from faying.typing import Array
from faying.units import load_text

SLIGHT_SLIP = 0.1  # of the damping at rest: what slip adds is less than a tenth of its spread
SAME_REST = 1e-6  # relative difference of the damping at rest of two modes that is rounding
MIN_GAIN = 5e-3  # by how much narrower an interval gets [-], below which the table would say 0 %


def answer(result: Result) -> Rows:
    """One row per mode at the last preload: its motion, best estimate with interval, as modelled, and what follows.

    That is the change with preload, and damping.
    """
    interval = result.interval
    if interval is None:
        return []
    several, damped = len(result.loads) > 1, None if damping_line(result) else result.levels
    heads = ["mode", "moves most", f"{result.load_names[-1]} [Hz]", "5 to 95 %", "as modelled"]
    if any(note.code == INCOMPLETE for note in result.notes):
        heads[3] += ", incomplete"
    heads += ["Hz/kN"] * several
    middle = 0 if damped is None else _middle(damped)
    heads += [] if damped is None else [f"damping, {damped.accelerations[middle]:g} m/s2 [%]"]
    rows: Rows = [heads]
    slopes = 1e3 * preload_slope(result.frequencies, result.loads) if several else np.zeros(result.frequencies.shape[1])
    ends = np.stack([interval.low[-1], interval.best[-1], interval.high[-1]], axis=1)
    for j, (low, best, high) in enumerate(ends.tolist()):
        cells = [str(j + 1), moves(result, j), f"{best:.{_digits(low, high)}f}", _interval(low, high)]
        cells.append(f"{result.frequencies[-1, j]:.2f}")
        cells += [f"{slopes[j]:+.0f}" if abs(slopes[j]) >= 100 else f"{slopes[j]:+.2g}"] * several
        cells += [] if damped is None else [damping_at(damped, middle, j)]
        rows.append(cells)
    return rows


def _middle(damped: Levels) -> int:
    """The level that the answer shows."""
    return len(damped.accelerations) // 2


def damping_line(result: Result) -> str:
    """Damping in a sentence where it is that at rest, and one for all modes; "" where it is not."""
    damped = result.levels
    if damped is None:
        return ""
    level = _middle(damped)
    rest = (damped.damping - damped.slip)[-1, level]
    if np.ptp(rest) > SAME_REST * rest.max() or not np.all(damped.slip[-1, level] < SLIGHT_SLIP * rest):
        return ""
    values = damping_at(damped, level, int(np.argmin(damped.slip[-1, level])))
    return (
        f"Damping at {damped.accelerations[level]:g} m/s2: {values} %, in every mode; slip of the joints adds less "
        "than a tenth of that at rest."
    )


def lead(result: Result) -> str:
    """The answer in two or three sentences: the modes at the last preload, how the test lies, what limits it."""
    interval = result.interval
    where = f"At {result.load_names[-1]}" if result.bolts else "Without bolts,"
    f = result.frequencies[-1] if interval is None else interval.best[-1]
    if len(f) == 1:
        words = [f"{where} the structure has one elastic mode of interest, at {_hertz(f[0])} Hz."]
    else:
        words = [f"{where} the lowest {len(f)} elastic modes are from {_hertz(f.min())} to {_hertz(f.max())} Hz."]
    if interval is not None:
        ends = _interval(float(interval.low[-1, 0]), float(interval.high[-1, 0])).replace("..", "and")
        words.append(f"The first is between {ends} Hz (5 to 95 %).")
    found = Score.of(result)
    return " ".join([*words, *_inside(found)])


def _inside(found: Score | None) -> list[str]:
    """How many of the measured frequencies lie in their intervals; empty where that is not known."""
    if found is None or found.inside is None:
        return []
    return [f"{int(found.inside.sum())} of {found.measured} measured frequencies are within 5 to 95 %."]


def _hertz(f: float) -> str:
    return f"{f:.0f}" if f >= 1000 else f"{f:.4g}"


def _interval(low: float, high: float) -> str:
    """Both ends to a tenth of their distance or so."""
    digits = _digits(low, high)
    return f"{low:.{digits}f} .. {high:.{digits}f}"


def _digits(low: float, high: float) -> int:
    """Digits after the point that show a tenth of a distance."""
    return max(0, 1 - int(np.floor(np.log10(max(high - low, 1e-9)))))


def moves(result: Result, mode: int) -> str:
    """Which part moves most at the last preload, and along which axis."""
    return ", ".join(filter(None, part_and_axis(result, mode)))


def limit(result: Result) -> str:
    """What limits the answer, in a sentence: the widest interval, what makes it, what would narrow it; "" without."""
    interval = result.interval
    if interval is None:
        return ""
    mode = int(np.argmax(interval.width[-1]))
    most = interval.sources[int(np.argmax(interval.shares[:, -1, mode]))]
    width = f"{100 * interval.width[-1, mode]:.2g} %"
    text = f"The widest interval is that of mode {mode + 1}: {width} from 5 to 95 %. Most of it comes from {most}."
    less = gains(interval).get(most)
    if less is not None:
        text += f" What helps: {SCATTER[most].remedy}; the interval is then {100 * less[mode]:.0f} % narrower."
    return text


def gains(interval: Interval) -> dict[str, Array]:
    """How much narrower each mode's interval at the last preload is (m,) [-] with one source known better each."""
    width = interval.width[-1]
    known = {name: SCATTER[name] for name in interval.sources if SCATTER[name].remedy}
    return {name: 1 - interval.narrowed_width({name: one.left})[-1] / width for name, one in known.items()}


def shares(result: Result) -> Rows:
    """One row per mode at the last preload: width of its interval, and the share of each source in its square."""
    interval = result.interval
    if interval is None:
        return []
    columns = zip(interval.width[-1], *interval.shares[:, -1], strict=True)
    cells = ([f"{100 * width:.2g}", *(f"{100 * share:.0f}" for share in shares)] for width, *shares in columns)
    return by_mode(["width", *interval.sources], cells)


def narrowing(result: Result) -> Rows:
    """One row per source that can be known better, the best first: what to do, and how much narrower the intervals get.

    Of the median mode, and of the mode that gains most, at the last preload. What narrows no mode by half a per
    cent is left out.
    """
    interval = result.interval
    if interval is None:
        return []
    rows: Rows = [["not known", "what would narrow it", "median [%]", "most [%]"]]
    for name, less in sorted(gains(interval).items(), key=lambda one: -float(np.mean(one[1]))):
        best = int(np.argmax(less))
        if less[best] >= MIN_GAIN:
            cells = [f"{100 * float(np.median(less)):.0f}", f"{100 * less[best]:.0f} (mode {best + 1})"]
            rows.append([name, SCATTER[name].remedy, *cells])
    return rows


def score(result: Result) -> Rows:
    """One row per guess of the measured frequencies: rms error at each load, Faying first."""
    found = Score.of(result)
    if found is None:
        return []
    rows = ([name, *(or_dash(100 * e, ".2f") for e in found.errors(name))] for name in found.guesses)
    return [["rms error [%]", *map(load_text, found.loads)], *rows]


def score_line(result: Result) -> str:
    """What the score comes to, in a sentence or two; empty where there is none."""
    found = Score.of(result)
    if found is None:
        return ""
    words = _inside(found)
    if np.isfinite(found.gain):
        helps = "helps" if found.gain < 1 else "does not help"
        words.append(
            f"The joint model {helps}: the test at one preload, times the model's change to the next preload, misses "
            f"the test there by {found.gain:.2f} times as much as without that change."
        )
    return " ".join(words)
