"""Damping and frequency of every mode at levels of acceleration, with what is not known of friction and of rest."""

from collections.abc import Sequence

import numpy as np

from faying.case.case import Case
from faying.case.scatter import LEVELS, Known, of_number, stated
from faying.errors import InputError
from faying.joint.bolted import BoltedStructure
from faying.joint.equilibrium import PreloadState
from faying.joint.modal import Vibration
from faying.microslip.levels import SPRINGS, AtLevels, cut_laws, level_basis, level_model
from faying.microslip.microslip import Microslip
from faying.notes import Note
from faying.result.groups import Levels
from faying.typing import Array

# coefficient of friction of faces of which nothing is said: 5 %, median and 95 % of a lognormal. Handbooks have 0.1 to
# 0.6 for dry steel; the measured curve of the Brake-Reuss beam is met with 0.03
FRICTION = (0.03, 0.12, 0.5)
# damping ratio at rest of bolted structures of which nothing is measured: 5 %, median and 95 % of a lognormal. Five of
# docs/theory/damping-at-rest.csv have 0.054 to 0.32 % in the mean of their modes, single modes 0.034 to 0.97 %
REST = (3e-4, 1.6e-3, 9e-3)
SLIGHT = 0.1  # of the spread at rest: slip below it moves the low end by 0.005 of that spread, whatever friction is
# into which a law is cut for the basis, and for the ends of friction: they differ by factors, this changes a hundredth
SPRINGS_AT_ENDS = 12


def level_damping(case: Case, preload: PreloadState, found: Vibration) -> Levels | None:
    """Damping at the levels of a case under one preload.

    Args:
        case: the case.
        preload: its equilibrium.
        found: its modes at rest; a loss that the laws predict counts as damping at rest, else that has its prior.

    Returns:
        With one load; None where no level is asked for, or where a law has no stiffness that slips.
    """
    structure, choice = case.structure, case.study.modes
    # springs per node do not slip
    if not choice.levels or any(joint.per_node for joint in structure.joints):
        return None
    frictions = frictions_of(structure, stated(case.study.uncertain))
    scatters = bool(np.any(np.ptp(frictions, axis=0)))
    try:
        coarse = [cut_laws(structure, preload, friction, SPRINGS_AT_ENDS) for friction in frictions]
        middle_laws = cut_laws(structure, preload, frictions[1], SPRINGS)
    except InputError:
        return None
    basis = level_basis(structure, preload, found, coarse[: 1 + scatters], np.full(choice.count, max(choice.levels)))

    def at(laws: Sequence[Microslip]) -> AtLevels:
        return level_model(structure, preload, basis, laws).at(choice.levels, choice.count)

    middle = at(middle_laws)
    rest, moved = rest_damping(structure, found, case.study.parts_loss), moved_by_loss(structure, found)
    slip = least = most = middle.damping
    if scatters:
        ends = [at(coarse[0]).damping, np.zeros_like(slip)]
        if np.any(slip > SLIGHT * (rest[1] - rest[0])):
            ends[1] = at(coarse[2]).damping
        # where the least friction has no answer the greatest damping is not known
        least, most = np.fmin(slip, np.fmin(*ends)), np.maximum(slip, np.maximum(*ends))
    # friction and rest are independent: the squares of their distances add, apart for each side
    return Levels(
        accelerations=np.array(choice.levels),
        frequencies=(middle.frequencies * moved)[None],
        damping=(slip + rest[1])[None],
        low=(slip + rest[1] - np.hypot(slip - least, rest[1] - rest[0]))[None],
        high=(slip + rest[1] + np.hypot(most - slip, rest[2] - rest[1]))[None],
        slip=slip[None],
        error=middle.error[None],
    )


def assumes_friction(structure: BoltedStructure, known: Known) -> bool:
    """Whether the friction of a joint has its prior, since nothing is said of it; known: what scatters, by its key."""
    return any(joint.friction is None and not of_number(known, joint.name, "friction") for joint in structure.joints)


def frictions_of(structure: BoltedStructure, known: Known) -> Array:
    """Friction of each joint (3, j), 5 %, median and 95 %: as what scatters lists it, as given, or as assumed."""
    out = []
    for joint in structure.joints:
        listed = of_number(known, joint.name, "friction")
        given = FRICTION if joint.friction is None else (joint.friction,) * 3
        out.append(given if listed is None else listed.quantile(LEVELS))
    return np.array(out).reshape(-1, 3).T


def rest_damping(structure: BoltedStructure, found: Vibration, parts_loss: float = 0.0) -> Array:
    """Damping ratio at rest [-] (3, m), 5 %, median and 95 %: of laws and parts, or where laws give none, its prior.

    The prior is of all that damps a structure: where the loss factor of the parts [-] makes more, that is taken.
    """
    speeds = 2 * np.pi * found.damped.frequencies
    of_parts = np.zeros(len(speeds))
    if parts_loss:
        own = found.modes.shapes[:, structure.rigid_count :][:, : len(speeds)]
        of_parts = parts_loss / 2 * np.einsum("im,im->m", own, structure.matrices[0] @ own) / speeds**2
    if structure.predicts_loss:
        return np.tile(found.damped.loss_factors / 2 + of_parts, (3, 1))
    return np.asarray(np.maximum(np.array(REST)[:, None], of_parts))


def assumes_rest(structure: BoltedStructure, parts_loss: float) -> bool:
    """Whether damping at rest has its prior, or some of it: see `rest_damping`."""
    return not structure.predicts_loss and parts_loss / 2 < REST[2]


def moved_by_loss(structure: BoltedStructure, found: Vibration) -> Array:
    """Frequencies of the complex modes over those of the real ones (m,): a loss at rest moves them."""
    count = len(found.damped.frequencies)
    return np.asarray(found.damped.frequencies / found.modes.frequencies[structure.rigid_count :][:count])


def assumed_words(*, friction: bool, rest: bool) -> list[str]:
    """What is assumed of friction and of damping at rest."""
    least, usual, most = FRICTION
    low, middle, high = (f"{100 * one:g}" for one in REST)
    words = [f"friction {usual:g}, between {least:g} and {most:g} (joint.friction gives it)"] * friction
    return words + [f"{middle} % at rest, between {low} and {high} %"] * rest


def _why_none(case: Case) -> str:
    """Why there is no damping at levels, and what to do."""
    per_node = [joint.name for joint in case.structure.joints if joint.per_node]
    if per_node:
        return (
            f"no damping at levels of acceleration: {', '.join(per_node)} has springs per node, which do not slip; "
            "leave springs out of the joint"
        )
    laws = dict.fromkeys(joint.law.model.name for joint in case.structure.joints)
    return (
        f"no damping at levels of acceleration: under {' and '.join(laws)} a joint has no stiffness that slips, or all "
        'of it is open; give joint.tangential a number, or "mindlin", or another law'
    )


def level_notes(case: Case, found: Sequence[Levels | None]) -> list[Note]:
    """What is assumed of friction and of rest."""
    if not found or not case.study.modes.levels or not case.structure.joints:
        return []
    if any(one is None for one in found):
        return [Note(code="no-level-damping", severity="limit", text=_why_none(case))]
    notes = _unanswered(case, [one for one in found if one is not None])
    rest = assumes_rest(case.structure, case.study.parts_loss)
    friction = assumes_friction(case.structure, stated(case.study.uncertain))
    words = assumed_words(friction=friction, rest=rest)
    if not words:
        return notes
    assumed = " and ".join(words) + ", as bolted structures have it" * rest
    text = f"damping at levels of acceleration assumes {assumed}; a ring-down of the structure narrows it most"
    return [*notes, Note(code="level-damping", severity="limit", text=text)]


def _unanswered(case: Case, found: Sequence[Levels]) -> list[Note]:
    """Which modes have no damping, or no upper end of it, at which levels."""
    missing = np.argwhere(np.any([np.isnan(one.high[0]) for one in found], axis=0))
    if not len(missing):
        return []
    where = ", ".join(f"mode {k + 1} at {case.study.modes.levels[i]:g} m/s2" for i, k in missing)
    text = (
        f"{where}: no damping, or no upper end of it ({FRICTION[0]:g} is the least friction where none is given); "
        "joints slide there as a whole, or open at their edges; ask for smaller levels, pull harder, or follow one "
        "mode by harmonic balance (faying backbone)"
    )
    return [Note(code="no-level-answer", severity="limit", text=text)]
