"""What there is to say of load cases: where the law ends, what opens, what friction is not known."""

from collections.abc import Mapping, Sequence

import numpy as np

from faying.joint.bolted import BoltedStructure
from faying.loads.contact import LoadedContact
from faying.notes import Note, percent
from faying.typing import Array
from faying.units import show

WHOLLY = 0.999  # share of the area that touches, from which all of it slides
LITTLE = 0.01  # of a joint's normal force beyond which it is said that the load presses harder than the preload did


def load_notes(
    structure: BoltedStructure,
    contacts: Sequence[LoadedContact],
    cases: Sequence[str],
    pressures: Sequence[Sequence[Array]],
    found: Mapping[str, Array],
) -> list[Note]:
    """Return the notes on all cases; found: arrays of `LoadCases` by their names."""
    out = []
    for k, case in enumerate(cases):
        for j, (joint, contact) in enumerate(zip(structure.joints, contacts, strict=True)):
            out += _joint(case, joint.name, contact, pressures[k][j], float(found["opened"][k, j]))
            if found["sliding"][k, j] > WHOLLY:
                shear, torque = float(found["shear_force"][k, j]), float(found["torque"][k, j])
                borne = f"{show(shear, 'N')} and {show(torque, 'N*m')}"
                text = (
                    f"load {case!r}: {joint.name} slides on all of its area; friction carries {borne}, the bolts the "
                    "rest, by shear of their shanks (V)"
                )
                out.append(Note(code="load-slides", joint=joint.name, text=text))
        for b, fitted in enumerate(structure.fitted_bolts):
            out += _bolt(case, fitted.bolt, float(found["bolt_force"][k, b]))
    sticking = [joint.name for joint in structure.joints if joint.friction is None]
    if sticking:
        text = (
            f"{', '.join(sticking)} sticks everywhere under the loads, since no friction is given; the table has the "
            'friction that it needs ("mu >"). Give joint.friction to let it slip'
        )
        out.append(Note(code="loads-stick", text=text))
    return out


def _joint(case: str, name: str, contact: LoadedContact, pressure: Array, opened: float) -> list[Note]:
    out, weights, law = [], contact.weights, contact.law
    if not np.any(pressure > 0):
        text = f"load {case!r}: {name} opens fully; the bolts alone hold its parts together"
        out.append(Note(code="load-opens", joint=name, share=1.0, text=text))
    share = float(weights @ (pressure > law.model.greatest_pressure) / weights.sum())
    if share > 0:
        text = (
            f"load {case!r}: on {percent(share)} of {name} the pressure exceeds the "
            f"{show(law.model.greatest_pressure, 'Pa')} at which {law.model.name} ends"
        )
        out.append(Note(code="beyond-law", joint=name, share=share, text=text))
    more = float(weights @ np.maximum(pressure - contact.pressure, 0.0))
    if law.yields and more > LITTLE * float(weights @ contact.pressure):
        text = (
            f"load {case!r}: {name} is pressed harder in places than by the preload, with {show(more, 'N')} more in "
            f"all; asperities of {law.model.name} would yield further there and close more, which the model leaves out"
        )
        out.append(Note(code="load-yields", joint=name, text=text))
    return out


def _bolt(case: str, bolt: object, force: float) -> list[Note]:
    fastener, name = getattr(bolt, "fastener", None), getattr(bolt, "name", "")
    if force <= 0:
        text = f"load {case!r}: bolt {name!r} has no tension left ({show(force, 'N')}); its head comes off its seat"
        return [Note(code="bolt-loose", text=text)]
    if fastener is not None and force > fastener.proof_load:
        text = (
            f"load {case!r}: bolt {name!r} carries {show(force, 'N')}, more than its proof load of "
            f"{show(fastener.proof_load, 'N')}; it stretches permanently, which the model leaves out"
        )
        return [Note(code="beyond-proof", load=force, text=text)]
    return []
