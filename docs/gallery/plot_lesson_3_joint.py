"""
Lesson 3: a joint under its bolt
================================

The law meets a structure: two blocks of a STEP file, and a bolt through both. The bolt presses the faces together, and
the pressure is not even.
"""

from pathlib import Path

import numpy as np

import faying

examples = next(path / "examples" for path in Path.cwd().parents if (path / "examples" / "hammer-test").is_dir())
mesh = faying.read_mesh(examples / "hammer-test" / "two-blocks.step", size="12 mm", face_size={"upper.joint": "6 mm"})
print(mesh)

# %%
law = faying.Mates.of_fractal(D=2.39, G="1.53e-10 m", scan_area="16 mm^2", materials="45 steel").law("jk")
structure = faying.Structure(
    mesh,
    materials="45 steel",
    joints=[faying.Joint(("upper.joint", "lower.joint"), law)],
    bolts=[faying.Bolt("bolt", ("upper.seat", "lower.seat"))],
)
structure.plot()

# %%
# Pressure is highest round the bolt and falls to the edge. Where it is zero the faces are apart, and carry nothing.

states = [structure.solve(preload=force, modes=6) for force in ("2 kN", "6 kN")]
states[-1].plot_pressure()

# %%
# A joint lies between faces that are apart and faces that are one. Not every frequency rises with the preload: where
# faces touch they become stiffer, but the stiffer they are, the nearer to the bolt the pressure stays, and less of the
# face touches.

frequencies = np.stack([state.modes.frequencies for state in states])
print(frequencies.round(1))
assert frequencies[1, 2] > frequencies[0, 2]
assert frequencies[1, 0] < frequencies[0, 0]
states[-1].modes.plot(1)

# %%
# **Exercises.** (a) Which mode rises most from 2 to 6 kN? Plot it, and say how its joint moves. (b) Give the joint a
# hollow: ``faying.Form(crown_along="-5 um")``. Where is the pressure now? (c) Halve the sizes of the mesh: which
# digits of the frequencies stay?
