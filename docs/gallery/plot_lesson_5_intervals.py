"""
Lesson 5: how sure is a frequency
=================================

A number without an interval is half an answer. Friction, preload, waves of the faces and the law itself are not known
exactly. A run combines them, and says which of them matters.
"""

from pathlib import Path

import numpy as np

import faying

examples = next(path / "examples" for path in Path.cwd().parents if (path / "examples" / "two-blocks").is_dir())
study = faying.Study.read(examples / "two-blocks" / "study.toml")
result = faying.run(study)
for mode, (low, middle, high) in enumerate(
    zip(result.interval.low[-1], result.frequencies[-1], result.interval.high[-1], strict=True), start=1
):
    print(f"mode {mode}: {low:7.0f} .. {middle:7.0f} .. {high:7.0f} Hz")
assert (result.interval.low[-1] < result.frequencies[-1]).all()

# %%
# The frequencies are near the upper end or above it. With D and G alone the law is JK, and measured joints have a
# quarter of its stiffness in the median. The interval contains that, the frequency does not.
#
# Each source of doubt shifts every frequency to a lower and a higher one. The squares of these widths add up, so that
# their shares say what is worth a measurement.

width = np.ptp(result.interval.offsets, axis=1)[:, -1] ** 2
for name, share in zip(result.interval.sources, width / width.sum(axis=0), strict=True):
    print(f"{name:10s}", " ".join(f"{value:5.0%}" for value in share))

# %%
# ``predict`` draws all of them at once from distributions. Waves of the faces scatter by default; here the preload
# scatters as with a torque wrench.

wrench = {"tightening": "torque wrench, friction estimated"}
scattered = study.with_("uncertain", {"preload": wrench, "E": "205 GPa +- 4 GPa"})
prediction = faying.predict(scattered, samples=64)
print(prediction)
prediction.plot()
assert prediction.sound.all()

# %%
# **Exercises.** (a) Leave the scatter of E out: which modes become narrower? (b) Replace the tightening by
# ``{"scatter": "5 %"}``. (c) How many samples are needed before the 5 % quantile of the first mode stands still?
