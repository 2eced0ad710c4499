"""
A structure without a study file
================================

Two blocks, a contact law between them and a bolt force, put together and solved in Python.
"""

from pathlib import Path

import faying

examples = next(path / "examples" for path in Path.cwd().parents if (path / "examples" / "two-blocks").is_dir())
mesh = faying.read_mesh(examples / "two-blocks" / "model.inp", unit="mm")
print(mesh)

# %%
# The law is made from the two faces of the joint. Names stand for faces, materials and laws; text with units stands for
# numbers.

mates = faying.Mates.of_fractal(D=2.39, G="1.53e-10 m", scan_area="16 mm^2", materials="45 steel")
structure = faying.Structure(
    mesh,
    materials="45 steel",
    joints=[faying.Joint(("FACE_A", "FACE_B"), mates.law("jk"), name="contact")],
    bolts=[faying.Bolt("rod", ("END_B", "END_A"))],
)
print(structure)
structure.plot()

# %%
# One preload gives a state: the pressure on the joint, and the modes with their damping.

state = structure.solve(preload="3 kN", modes=6)
print(state)
state.plot_pressure()

# %%
state.modes.plot(1)

# %%
# The joint stiffens with the preload, and the first frequency rises.

soft = structure.solve(preload="1 kN", modes=6)
assert soft.modes.frequencies[0] < state.modes.frequencies[0]
