"""What lies beyond the end of a law: stiffness is held there in one answer and the faces bonded in the other."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from faying.case.case import Case, materials_at
from faying.contact.build import AUTO, kinds
from faying.contact.mates import Mates
from faying.contact.models.half_space import HalfSpace
from faying.errors import FayingError
from faying.fe.interface import Interface
from faying.joint.modal import EXACT
from faying.joint.shared_modes import coupled, modes_with
from faying.joint.springs import Springs
from faying.joint.structure import Structure
from faying.notes import Note, percent
from faying.numerics.damped import DampedModes, damped_modes
from faying.typing import Array, Mask
from faying.units import load_text

STIFF = 1e3  # times the stiffness of the parts over their size: what counts as bonded
STIFFER = 1e4  # and at least so many times the law's own
MATTERS = 5e-3  # relative difference of a frequency from which the law has no answer
MIN_PRINTED_CHANGE = 1e-4  # relative change of a frequency that is printed


@dataclass(frozen=True, kw_only=True)
class AboveRange:
    """Frequencies [Hz] and loss factors [-] (m,) with the points beyond the end of their law bonded, and notes."""

    frequencies: Array
    loss_factors: Array
    notes: tuple[Note, ...]


def bonded_above_range(
    case: Case, load: float, springs: Sequence[Springs[Interface]], at_end: DampedModes
) -> AboveRange | None:
    """Solve a case under one preload with the points beyond the end of their law bonded, at no loss there.

    Stiffness grows with pressure in every law, so the frequencies lie between those with the stiffness kept at the
    law's end, `at_end`, and these; modes count in rising order. None where no point is beyond.
    """
    structure, study = case.structure, case.study
    past = [joint.above_range(s) for joint, s in zip(structure.joints, springs, strict=True)]
    if not any(np.any(mask) for mask in past):
        return None
    parts = stiff_as_bonded(structure)
    bonded = [_bonded(s, mask, parts) for s, mask in zip(springs, past, strict=True)]
    stiffness, loss = coupled(case.modal, bonded)
    mass = structure.dynamic_matrices[1]
    found = damped_modes(
        modes_with(case.modal, stiffness, mass, rigid=structure.rigid),
        stiffness,
        mass,
        loss,
        rigid=case.rigid_count,
        count=study.modes.count,
        kind=study.modes.damping,
        tolerance=EXACT,
    )
    notes = tuple(_notes(case, load, springs, past, found.frequencies / at_end.frequencies - 1))
    return AboveRange(frequencies=found.frequencies, loss_factors=found.loss_factors, notes=notes)


def stiff_as_bonded(structure: Structure) -> float:
    """Springs per area [Pa/m] so stiff beside the parts that their faces count as bonded."""
    return STIFF * max(m.E for m in structure.materials.values()) / structure.mesh.size


def _bonded(springs: Springs[Interface], past: Mask, parts: float) -> Springs[Interface]:
    if not np.any(past):
        return springs
    stiff = max(parts, STIFFER * float(max(springs.k_n.max(), springs.k_t.max())))
    return replace(
        springs,
        k_n=np.where(past, stiff, springs.k_n),
        k_t=np.where(past, stiff, springs.k_t),
        loss_n=np.where(past, 0.0, springs.loss_n),
        loss_t=np.where(past, 0.0, springs.loss_t),
    )


def _notes(
    case: Case, load: float, springs: Sequence[Springs[Interface]], past: Sequence[Mask], change: Array
) -> Iterator[Note]:
    kilo = load_text(load)
    worst = int(np.argmax(np.abs(change)))
    effect = f"moves mode {worst + 1} most, by {change[worst]:+.2%}"
    if abs(change[worst]) < MIN_PRINTED_CHANGE:
        effect = f"moves no mode by {MIN_PRINTED_CHANGE:.2%}"
    for number, (joint, s, mask) in enumerate(zip(case.structure.joints, springs, past, strict=True)):
        if not np.any(mask):
            continue
        model, weights = joint.law.model, s.interface.weights
        share = float(weights @ mask / weights.sum())
        text = (
            f"{joint.name}, {kilo}: on {percent(share)} of the joint the pressure exceeds the "
            f"{model.greatest_pressure / 1e6:.3g} MPa at which {model.name} ends with this surface; stiffness stays "
            f"constant there; bonding these points instead {effect}"
        )
        yield Note(code="beyond-law", severity="limit", joint=joint.name, load=load, share=share, text=text)
        strong = np.flatnonzero(np.abs(change) > MATTERS)
        if len(strong):
            which = f"mode{'s' * (len(strong) > 1)} {', '.join(str(k + 1) for k in strong)}"
            text = (
                f"{joint.name}, {kilo}: {model.name} cannot answer for {which}: with constant stiffness above its end, "
                f"or bonded there, the frequencies differ by up to {np.abs(change).max():.1%}; take both as bounds. "
                f"{_others(case, number, float(s.pressure.max()))}"
            )
            yield Note(code="beyond-law-matters", severity="wrong", joint=joint.name, load=load, share=share, text=text)


def _others(case: Case, number: int, pressure: float) -> str:
    """Which laws on the same surface reach the pressure [Pa] of a joint, and how far."""
    choice, surface = case.study.joints[number], case.surfaces[number]
    if surface.faces is None:
        return "Give a law that reaches further, such as a table"
    pair = case.study.law_of(choice).pair(*materials_at(case.study, case.structure.mesh, choice))
    mates = Mates(surface.faces, materials=pair)
    found = []
    for label, kind in kinds().items():
        if label == AUTO or kind.law is HalfSpace or kind.missing({}, surface.rough):
            continue  # the half-space takes minutes to say how far it reaches
        try:
            reach = mates.choose(kind).law.greatest_pressure
        except FayingError:
            continue
        if reach >= pressure:
            found.append((reach, label.lower()))
    if not found:
        return "No law on this surface does"
    listed = ", ".join(f"{label} to {reach / 1e9:.3g} GPa" for reach, label in sorted(found, reverse=True))
    return f"On this surface these laws reach {pressure / 1e6:.3g} MPa: {listed}"
