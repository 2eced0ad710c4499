"""Friction elements: forces and work of one motion, and frequency and damping against amplitude."""

from dataclasses import replace
from functools import partial

import numpy as np
from backbone import theirs

from faying.microslip.epmc import Epmc
from peers.rows import Problem, Row, worst
from tests.helpers.slips import chain, slider

SAMPLES, STEPS = 256, 40
# amplitudes [m kg^1/2] from and to which tmdsimpy goes on: from others it turns back before the slider slides
SPANS = {"jenkins": (0.5, 3.0), "dry": (0.01, 1.0)}


def masses(law):
    """Three masses in a row; the first slides on the ground, under a force that the third one changes, if it moves."""
    model = chain([1.0, 0.5, 0.8], [3.0, 2.0, 4.0], slider(2.0, 0.4))
    if law == "jenkins":
        return model
    (joint,) = model.joints
    relative = joint.relative.copy()
    relative[0, 2] = -0.3  # closes as the third mass moves forwards
    return replace(model, joints=(replace(joint, relative=relative),))


def work(motion, forces):
    """Work [J] that forces take in a cycle, from Fourier coefficients (1 + 2H, m) of both."""
    return sum(
        np.pi * h * (forces[2 * h - 1] @ motion[2 * h] - forces[2 * h] @ motion[2 * h - 1])
        for h in range(1, len(motion) // 2 + 1)
    )


def slides(law, python):
    model = masses(law)
    found, motion, forces = theirs(model, 0, law, *SPANS[law], SAMPLES, STEPS, python=python)
    epmc = Epmc(model=model, mode=0, harmonics=3, samples=SAMPLES)
    damped = found["damping"] > 0.01
    amplitude, frequency, damping = (found[name][damped] for name in ("amplitude", "frequency", "damping"))
    known = []
    for one in amplitude:
        known.append(epmc.solve(one, known[-3:]))
    return [
        Row(
            quantity="work of a cycle",
            ours=float(work(motion, forces)),
            theirs=float(work(motion, found["forces"])),
            bound=1e-12,
            unit="J",
        ),
        worst("frequency of point", [p.frequency for p in known], frequency, bound=2e-6, unit="rad/s"),
        worst("damping ratio of point", [p.damping for p in known], damping, bound=2e-4, unit=""),
    ]


BOUND = (
    "The same elements at the same 256 instants: rounding, 1e-12, for the work. tmdsimpy stops at steps of 1e-6 and "
    "Faying at residuals of 1e-7, relative to the mode: 2e-6 of a frequency, and as much of a damping ratio of 1, "
    "which is 2e-4 of 1 %. Points with less damping are left out."
)
PROBLEMS = [
    Problem(name=f"slider, {what}", peer="tmdsimpy", seconds=20, bound=BOUND, solve=partial(slides, law))
    for law, what in (("jenkins", "constant normal load"), ("dry", "moving normal load"))
]
