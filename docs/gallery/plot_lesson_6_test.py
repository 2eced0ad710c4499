"""
Lesson 6: beside a hammer test
==============================

A test says whether all of this is so. Modes of the test are found in its FRFs, paired with those of the model by their
shapes, and compared.
"""

from pathlib import Path

import faying

examples = next(path / "examples" for path in Path.cwd().parents if (path / "examples" / "hammer-test").is_dir())
file = faying.read_uff(examples / "hammer-test" / "blocks.uff")
print(file)
frf = file.frf()
print(frf)
modes = faying.identify_modes(frf)
print(modes)

# %%
# The study names the file, and a run pairs the modes.

result = faying.run(examples / "hammer-test" / "study.toml")
print(result.hammer)
assert len(result.hammer.pairs) >= 5

# %%
# This test was made from the model itself, with shifted frequencies. A real one differs by dimensions, by materials
# and by the joint: three reasons that only several preloads can tell apart.

# %%
# **Exercises.** (a) Change ``part.upper.material`` to S355 with ``Study.with_``: do the pairs stay? (b) Set
# ``test.least_mac`` to 0.9: which pairs go, and what does the MAC of the others say? (c) With frequencies at several
# preloads, ``faying.identify`` tells what they say of friction, stiffness and dimensions: see :doc:`/intervals`.
