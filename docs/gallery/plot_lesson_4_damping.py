"""
Lesson 4: modes and damping
===========================

A study file holds structure, joint, bolts and what is asked for. ``faying.run`` answers it, ``Study.with_`` changes one
key, and a mode has a damping for each level of vibration, because a joint slips.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import faying

examples = next(path / "examples" for path in Path.cwd().parents if (path / "examples" / "two-blocks").is_dir())
study = faying.Study.read(examples / "two-blocks" / "study.toml").with_("joint.friction", 0.2)
result = faying.run(study)
print(result)
result.plot()

# %%
# Slip grows faster than the motion: damping rises with the level, and the frequency falls.

levels = np.geomspace(0.1, 1000.0, 13)
alone = study.with_("modes.levels", [f"{level:.5g} m/s^2" for level in levels]).with_("modes.intervals", False)
curves = faying.run(alone.with_("bolt.preload", "3 kN"))
slip, frequencies = curves.levels.slip[0], curves.levels.frequencies[0]

fig, axes = plt.subplots(1, 2, figsize=(8.0, 3.4), layout="constrained")
for mode in range(slip.shape[1]):
    axes[0].semilogx(levels, 100 * (frequencies[:, mode] / frequencies[0, mode] - 1), label=f"mode {mode + 1}")
    axes[1].loglog(levels, 100 * np.where(slip[:, mode] > 1e-9, slip[:, mode], np.nan))
axes[0].set(xlabel="peak acceleration [m/s²]", ylabel="change of frequency [%]")
axes[1].set(xlabel="peak acceleration [m/s²]", ylabel="damping by slip [%]")
axes[0].legend()
assert np.all(slip[-1] >= slip[0])
assert np.all(frequencies[-1] < frequencies[0] * (1 + 1e-5))

# %%
# At small levels the faces slip only where the pressure ends. There the loss of a cycle goes with the cube of the
# motion over the friction, and the damping ratio with the motion: ten times the level, ten times the damping by slip.

third = slip[slip[:, 2] > 0, 2]
print((third[1:] / third[:-1]).round(2), f"for a level {levels[1] / levels[0]:.2f} times as high")

# %%
# **Exercises.** (a) Repeat with a friction of 0.6. Which end of the curves changes? (b) Ask harmonic balance about
# one mode, ``faying.backbone(study, 1, friction=0.2)``: how far are both apart? (c) What does a preload of 10 kN do
# to the damping, ``study.with_("bolt.preload", "10 kN")``?
