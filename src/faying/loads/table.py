"""Load cases as text of a terminal, 80 columns wide, and as rows."""

from functools import partial
from textwrap import wrap

import numpy as np

from faying.loads.record import ENOUGH, LoadCases
from faying.output.table import Rows, text
from faying.output.terminal import wrapped
from faying.text import in_columns
from faying.typing import Array
from faying.units import in_mm, show

WIDTH = 80
CASES_IN_TABLE = 3  # cases in one table of frequencies
MAX_MODES = 10  # that the table of frequencies has
PARTS = "greatest stress of von Mises in each part, and how far elements differ there"
SERVICE = "bolts in service: alternating stress, damage, and motion of the head over that at which it slides"
SCOPE = (
    "Forces in N where no unit is given, moments in N m, pressures in MPa. F_A: load that pulls the parts apart at a "
    "bolt; Phi: change of the bolt's force over it, as found; M, V: bending moment of the bolt and force across it; "
    "seat: mean pressure on it. N, Q, T: normal force, shear force and torque of a joint; mu >: friction that the "
    "part round the worst bolt needs. A margin is friction over the shear and torque to carry, of a head, a joint, or "
    "round its worst bolt: at 1 it slips. Shear that tightening left is not counted."
)


def terminal(found: LoadCases) -> str:
    """Return all cases as text."""
    lines = [f"{found.title}: load cases at a preload of {show(found.preload, 'N')}", ""]
    for k in range(len(found.cases)):
        lines += [*wrapped(heading(found, k)), text(bolt_rows(found, k), left=(0,)), ""]
        lines += [text(joint_rows(found, k), left=(0,)), ""]
        dowels = dowel_rows(found, k)
        lines += [text(dowels, left=(0,)), ""] if dowels else []
    for first in range(0, len(found.cases), CASES_IN_TABLE):
        modes = mode_rows(found, slice(first, first + CASES_IN_TABLE))
        lines += ["frequency under each load [Hz], and its change", text(modes), ""] if modes else []
    parts = part_rows(found)
    lines += [PARTS, text(parts, left=(0, 1)), ""] if parts else []
    service = service_rows(found)
    lines += [*wrapped(SERVICE), text(service, left=(0, 1)), ""] if service else []
    lines += interval_lines(found)
    lines += wrapped(SCOPE)
    for note in found.notes:
        lines += wrap(note.text, WIDTH, initial_indent="- ", subsequent_indent="  ", break_long_words=False)
    return "\n".join(lines)


def heading(found: LoadCases, k: int) -> str:
    """Return what a case comes to, in one sentence."""
    after = f" after {found.after[k]!r}" if found.after[k] else ""
    apart = float(found.superposition[k])
    linear = f"superposition holds, to {apart:.1%}" if apart <= ENOUGH else f"superposition is off by {apart:.0%}"
    return f"load {found.cases[k]!r}{after}: moves up to {show(float(found.displacement[k]), 'm')}; {linear}"


def bolt_rows(found: LoadCases, k: int) -> Rows:
    """Return one row for each bolt under a case."""
    force, rest, signed = found.bolt_force[k], found.bolt_preload, partial(_short, sign="+")
    return in_columns(
        ("bolt", [_cut(name, 8) for name in found.bolts], ""),
        ("F [kN]", force / 1e3, ".4g"),
        ("change", map(signed, force - rest), ""),
        ("linear", map(signed, found.bolt_force_linear[k] - rest), ""),
        ("F_A", map(signed, found.working_load[k]), ""),
        ("Phi", found.load_factor[k], ".3f"),
        ("M", map(_short, found.bolt_moment[k]), ""),
        ("V", map(_short, found.bolt_shear[k]), ""),
        ("seat", map(_short, found.seat_pressure[k] / 1e6), ""),
        ("margin", map(margin, found.head_margin[k]), ""),
    )


def joint_rows(found: LoadCases, k: int) -> Rows:
    """Return one row for each joint under a case."""
    return in_columns(
        ("joint", [_cut(name, 8) for name in found.joints], ""),
        ("N [kN]", found.normal_force[k] / 1e3, ".4g"),
        ("Q", map(_short, found.shear_force[k]), ""),
        ("T", map(_short, found.torque[k]), ""),
        ("mean", map(_short, found.mean_pressure[k] / 1e6), ""),
        ("peak", map(_short, found.greatest_pressure[k] / 1e6), ""),
        ("opens", found.opened[k], ".1%"),
        ("slides", np.where(np.isnan(found.friction), np.nan, found.sliding[k]), ".1%"),
        ("mu >", map(_short, found.friction_needed_worst[k]), ""),
        ("margin", map(margin, found.slip_margin[k]), ""),
        ("worst", map(margin, found.slip_margin_worst[k]), ""),
    )


def part_rows(found: LoadCases) -> Rows:
    """One row for each case: the part with the greatest stress, and its place."""
    if found.stress is None or found.stress_place is None or found.stress_spread is None:
        return []
    rows: Rows = [["load", "part", "stress [MPa]", "+- [%]", "at [mm]"]]
    for k, name in enumerate(found.cases):
        p = int(np.argmax(found.stress[k]))
        cells = [_short(found.stress[k, p] / 1e6), f"{100 * found.stress_spread[k, p]:.2g}"]
        place = in_mm(found.stress_place[k, p]).removesuffix(" mm")
        rows.append([_cut(name, 18), _cut(found.parts[p], 14), *cells, place])
    return rows


def service_rows(found: LoadCases) -> Rows:
    """One row for each case: the bolt whose stress changes most, its damage, and the head that is nearest to slide."""
    rows: Rows = [["load", "bolt", "+- [MPa]", "cycles", "damage", "head", "motion", "slides at [um]"]]
    for k, name in enumerate(found.cases):
        stress, motion = found.stress_amplitude[k], found.head_motion[k]
        if not len(stress) or np.isnan(stress).all():
            continue
        b = int(np.nanargmax(stress))
        h = b if np.isnan(motion).all() else int(np.nanargmax(motion))
        damage = _short(found.damage[k, b]) if found.cycles[k] else "-"
        cells = [_cut(name, 12), _cut(found.bolts[b], 8), _short(stress[b] / 1e6), f"{found.cycles[k]:.3g}", damage]
        rows.append([*cells, _cut(found.bolts[h], 8), _short(motion[h]), _short(1e6 * found.slide_motion[h])])
    return rows if len(rows) > 1 else []


def dowel_rows(found: LoadCases, k: int) -> Rows:
    """Return one row for each dowel under a case; empty where there are none."""
    if found.dowel_shear is None or found.dowel_bearing is None:
        return []
    rows: Rows = [["dowel", "shear force by the load [N]", "pressure on its hole [MPa]"]]
    for d, name in enumerate(found.dowels):
        rows.append([_cut(name, 18), _short(found.dowel_shear[k, d]), _short(found.dowel_bearing[k, d] / 1e6)])
    return rows


def mode_rows(found: LoadCases, some: slice = slice(None)) -> Rows:
    """Return one row for each mode, with its frequency under some cases; empty where no modes were asked for."""
    if found.rest_frequency is None or found.frequency is None or found.frequency_change is None:
        return []
    rows: Rows = [["mode", "preload", *(_cut(name, 18) for name in found.cases[some])]]
    for m, rest in enumerate(found.rest_frequency[:MAX_MODES]):
        cells = [
            f"{f:.2f} {change:+.2%}"
            for f, change in zip(found.frequency[some, m], found.frequency_change[some, m], strict=True)
        ]
        rows.append([str(m + 1), f"{rest:.2f}", *cells])
    return rows


def interval_lines(found: LoadCases) -> list[str]:
    """Return the table of the intervals with what scatters; nothing where none were asked for."""
    some = found.intervals
    if some is None:
        return []
    rows: Rows = [["load", "least bolt [kN]", "margin of joint", "of head", "opens", "check"]]
    slip, head = some.slip_margin, some.head_margin
    for k, name in enumerate(found.cases):
        bolt = int(np.argmin(some.bolt_force[0, k]))
        low, high = some.bolt_force[:, k, bolt] / 1e3
        rows.append(
            [
                _cut(name, 18),
                f"{low:.3g} to {high:.3g}",
                _least(slip[:, k]),
                _least(head[:, k]),
                " to ".join(f"{one:.0%}" for one in some.opened[:, k].max(axis=1)),
                f"{some.check[k]:.0%}",
            ]
        )
    words = (
        f"90 % intervals over {'; '.join(some.inputs)}. The check says by how much first order is off where all move."
    )
    return [*wrapped(words), text(rows, left=(0,)), ""]


def _least(bounds: Array) -> str:
    """The interval of whichever has the least lower bound (bound, n); a dash where none is known."""
    if np.isnan(bounds[0]).all():
        return "-"
    k = int(np.nanargmin(bounds[0]))
    return f"{margin(bounds[0, k])} to {margin(bounds[1, k])}"


def margin(value: float) -> str:
    """A margin in words: a dash where it is not known."""
    return "-" if np.isnan(value) else ">999" if value > 999 else f"{value:.3g}"


def _short(value: float, sign: str = "") -> str:
    """A number in six characters or so, 0 where it is less than a thousandth."""
    if not np.isfinite(value):
        return "-"
    if abs(value) < 1e-3:
        return "0"
    return f"{value:{sign}.0f}" if abs(value) >= 100 else f"{value:{sign}.3g}"


def _cut(name: str, most: int) -> str:
    return name if len(name) <= most else name[: most - 1] + "…"
