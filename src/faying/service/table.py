"""Vibration as rows of tables, and as text of a terminal."""

from typing import Any

import numpy as np

from faying.result.vibration import VibrationResponse, life_text
from faying.text import in_columns
from faying.typing import Array
from faying.units import GRAVITY, in_mm, load_text

Rows = list[list[str]]
HELP = (
    "Values are rms of random vibration (heads and margins at 3 sigma, three times the rms), amplitudes of a sweep. "
    "Level: displacement where a mode moves most, of it alone, times its own circular frequency squared; at resonance "
    "that is its acceleration. Head: transverse motion over that at which the head slides; above 1 a bolt turns loose, "
    "between 0.5 and 1 it may. Margin: friction over shear and torque of a joint, and round its worst bolt; at 1 it "
    "slips."
)


def heading(found: VibrationResponse) -> str:
    """What shakes the structure, in a sentence."""
    first, last = found.input_frequency[[0, -1]]
    what = "supports move" if found.base else "force acts"
    kind = "random" if found.kind == "random" else "sine sweep"
    return (
        f"vibration {found.name!r} at {load_text(found.preload)}: {kind}, {what} along "
        f"({', '.join(f'{one:.3g}' for one in found.direction)}), {first:g} to {last:g} Hz"
    )


def mode_rows(found: VibrationResponse) -> Rows:
    """One row for each mode that is shaken: level, frequency and damping that it reaches, with their ends."""
    some = found.shaken
    return in_columns(
        ("mode", some + 1, "d"),
        ("at rest [Hz]", found.rest_frequency[some], ".2f"),
        ("reached [Hz]", found.frequency[1, some], ".2f"),
        ("level [m/s2]", found.level[1, some], ".3g"),
        *([("curve to", found.reach[some], ".3g")] if np.isfinite(found.reach[some]).any() else []),
        ("5 to 95 %", _ends(found.level[:, some], ".3g"), ""),
        ("damping [%]", 100 * found.damping[1, some], ".3g"),
        ("5 to 95 %", _ends(100 * found.damping[:, some], ".3g"), ""),
    )


def point_rows(found: VibrationResponse) -> Rows:
    """One row for each point: acceleration along the axes in g, velocity and displacement."""
    g = found.acceleration / GRAVITY
    worst = np.argmax(g[1], axis=1)
    ends = np.stack([row[np.arange(len(worst)), worst] for row in g])
    return in_columns(
        ("point [mm]", [in_mm(one).removesuffix(" mm") for one in found.points], ""),
        *((f"{axis} [g]", g[1, :, k], ".3g") for k, axis in enumerate("xyz")),
        ("5 to 95 %", _ends(ends, ".3g"), ""),
        ("[mm/s]", 1e3 * np.linalg.norm(found.velocity[1], axis=1), ".3g"),
        ("[um]", 1e6 * np.linalg.norm(found.displacement[1], axis=1), ".3g"),
    )


def bolt_rows(found: VibrationResponse) -> Rows:
    """One row for each bolt: change of its force, bending, stress, damage, life, motion of its head."""
    if not found.bolts:
        return []
    return in_columns(
        ("bolt", found.bolts, ""),
        ("force [N]", found.bolt_force[1], ".3g"),
        ("stress [MPa]", found.stress[1] / 1e6, ".3g"),
        ("5 to 95 %", _ends(found.stress / 1e6, ".3g"), ""),
        ("damage", found.damage[1], ".2g"),
        ("to 95 %", found.damage[2], ".2g"),
        ("life", [_life(found, one) for one in found.life[1].tolist()], ""),
        ("bending [N m]", found.bolt_moment[1], ".3g"),
        ("head, 95 %", found.head_motion[2], ".2g"),
    )


def _life(found: VibrationResponse, life: float) -> str:
    """Time, or sweeps, until a bolt fails, in words."""
    return life_text(life) if found.kind == "random" or not np.isfinite(life) else f"{life:.3g} sweeps"


def joint_rows(found: VibrationResponse) -> Rows:
    """One row for each joint: margin of slip, of all of it and round its worst bolt, with the least."""
    if not found.joints:
        return []
    return in_columns(
        ("joint", found.joints, ""),
        ("margin of slip", found.slip_margin[1], ".3g"),
        ("from 5 %", found.slip_margin[0], ".3g"),
        ("round the worst bolt", found.slip_margin_worst[1], ".3g"),
        ("from 5 %", found.slip_margin_worst[0], ".3g"),
    )


def part_rows(found: VibrationResponse) -> Rows:
    """One row for each part: its greatest stress of von Mises, and the place."""
    return in_columns(
        ("part", found.parts, ""),
        ("stress [MPa]", found.part_stress[1] / 1e6, ".3g"),
        ("5 to 95 %", _ends(found.part_stress / 1e6, ".3g"), ""),
        ("at [mm]", [in_mm(one).removesuffix(" mm") for one in found.part_stress_place], ""),
    )


TABLES: dict[str, Any] = {
    "modes that are shaken": mode_rows,
    "points": point_rows,
    "bolts": bolt_rows,
    "margin of slip": joint_rows,
    "greatest stress of von Mises in the parts": part_rows,
}


def _ends(values: Array, form: str) -> list[str]:
    """The 5 and 95 % ends (3, n) of numbers in words; a dash where they are not known."""
    return ["-" if np.isnan(low + high) else f"{low:{form}} .. {high:{form}}" for low, _, high in values.T]
