"""What a user should know of a result: frequencies that fall, laws far from the exact contact, unstable windows."""

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from faying.case.case import Case, materials_at
from faying.case.solve import LoadedCase
from faying.contact.mates import Mates
from faying.contact.models.half_space import HalfSpace
from faying.contact.stability import COARSE, stability, stiffness_at
from faying.errors import FayingError
from faying.notes import Note, percent
from faying.units import load_text

FALL = 1e-6  # relative: a smaller fall is none
NOTED_RATIO = 2.0  # factor between a law and the exact contact that is noted


def falling(case: Case, states: Sequence[LoadedCase]) -> Iterator[Note]:
    """Say which modes fall as the preload grows, and why."""
    for before, after in pairwise(states):
        change = after.damped.frequencies / before.damped.frequencies - 1
        down = np.flatnonzero(change < -FALL)
        if not len(down) or after.load < before.load:
            continue
        area = sum(joint.interface.area for joint in case.structure.joints)
        less = more = 0.0
        for joint, p, q in zip(case.structure.joints, before.preload.pressures, after.preload.pressures, strict=True):
            less += float(joint.interface.weights @ (q < p)) / area
            more += float(joint.interface.weights @ ((p > 0) & (q <= 0))) / area
        opened = f" and {percent(more)} opens" if more else ""
        which = ", ".join(str(k + 1) for k in down)
        text = (
            f"mode{'s' * (len(down) > 1)} {which} fall{'s' * (len(down) == 1)} from {before.load / 1e3:g} to "
            f"{load_text(after.load)}, by up to {-100 * change.min():.2g} %: as the parts bend under the "
            f"bolts, pressure falls on {percent(less)} of the joint{opened}, while it grows elsewhere"
        )
        yield Note(code="falls", severity="limit", load=after.load, text=text)


def against_exact_contact(case: Case, state: LoadedCase) -> Iterator[Note]:
    """Say where a law lies far from the half-space contact of its own scan, and where the window decides its k_n.

    Both at the mean pressure of the joint where it touches. Joints that share surface and law have one note.
    """
    seen: set[object] = set()
    for choice, joint, surface, pressure in zip(
        case.study.joints, case.structure.joints, case.surfaces, state.preload.pressures, strict=True
    ):
        law, touching = joint.law.model, pressure > 0
        if surface.scans is None or surface.rough is None or surface.rough.scan is None or not touching.any():
            continue
        key = (id(surface), repr(law))
        if key in seen:
            continue
        seen.add(key)
        assert surface.faces is not None
        weights = joint.interface.weights
        mean = float(weights[touching] @ pressure[touching] / weights[touching].sum())
        mean = min(max(float(f"{mean:.3g}"), law.least_pressure), law.greatest_pressure)  # as it is shown
        chosen = case.study.law_of(choice)
        mates = Mates(surface.faces, materials=chosen.pair(*materials_at(case.study, case.structure.mesh, choice)))
        at = f"{joint.name}, {mean / 1e6:.3g} MPa"
        try:
            if not isinstance(law, HalfSpace):
                exact = mates.law("half-space")
                ratio = stiffness_at(law, mean) / stiffness_at(exact, mean)
                if not 1 / NOTED_RATIO <= ratio <= NOTED_RATIO:
                    text = f"{at}: k_n of {law.name} is {ratio:.2g} times that of the half-space contact of its scan"
                    yield Note(code="far-from-exact", severity="limit", joint=joint.name, text=text)
            given = chosen.given if chosen.kind.label == law.name else {}
            found = stability(mates, model=law.name, given=given, pressure=mean)
        except FayingError:
            continue
        if not found.stable:
            name, factor = found.worst
            remedy = "a finer scan" if name == COARSE else "a larger scan, or several,"
            text = (
                f"{at}: {law.name} has {factor:.2g} times the k_n on the {name} of the scan, compared with all of it; "
                f"{remedy} shows which one is right"
            )
            yield Note(code="window", severity="limit", joint=joint.name, text=text)
