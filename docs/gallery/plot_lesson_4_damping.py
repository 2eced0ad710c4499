"""
Lesson 4: modes and damping
===========================

A study file holds structure, joint, bolts and what is asked for. ``faying.run`` answers it, ``Study.with_`` changes one
key, and a mode has a damping for each level of vibration, because a joint slips.
"""

from pathlib import Path

import numpy as np

import faying

examples = next(path / "examples" for path in Path.cwd().parents if (path / "examples" / "two-blocks").is_dir())
study = faying.Study.read(examples / "two-blocks" / "study.toml").with_("joint.friction", 0.2)
result = faying.run(study)
print(result)
result.plot()

# %%
# Slip grows faster than the motion: damping rises with the level, and the frequency falls.

curves = faying.level_curves(study, amplitude=(0.1, 1000.0))
print(curves)
curves.plot()
assert np.all(curves.damping[-1] >= curves.damping[0])
assert np.all(curves.frequencies[-1] < curves.frequencies[0] * (1 + 1e-5))

# %%
# At small levels the faces slip only where the pressure ends. There the loss of a cycle goes with the cube of the
# motion over the friction, and the damping ratio with the motion: ten times the level, ten times the damping by slip.

slips = curves.damping[:, 2] > 0
third = curves.damping[slips, 2]
print((third[1:] / third[:-1]).round(2), f"for a level {curves.levels[1] / curves.levels[0]:.2f} times as high")

# %%
# **Exercises.** (a) Repeat with a friction of 0.6. Which end of the curves changes? (b) Ask harmonic balance about
# one mode, ``faying.backbone(study, 1, friction=0.2)``: how far are both apart? (c) What does a preload of 10 kN do
# to the damping, ``study.with_("bolt.preload", "10 kN")``?
