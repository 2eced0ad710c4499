"""
Stiffness of contact laws on one surface
========================================

Every law that lives on the moments of a surface, for the same surface and the same pair of materials.
"""

import numpy as np

import faying
from faying.contact import SurfaceInputs

# %%
# The surface: D and G of a fractal surface, with waves from 4 mm down to 10 um. Its moments follow.

surface = SurfaceInputs.from_fractal(D=2.3, G=2e-12, scan_area=16e-6, shortest=10e-6)
mates = faying.Mates.of_surface(surface, materials="45 steel")

# %%
# Each law is asked for the same pressures. Where it says that it is outside its validity range the line is dotted.

names = ["GW", "GW-KE", "Persson", "JK", "ME"]
mates.compare_plot(np.geomspace(1e5, 1e7, 60), laws=names)

# %%
# Laws disagree by a factor of ten and more on one surface: see :doc:`/which-law`.

at_1_MPa = mates.compare("1 MPa", laws=names).k_n.squeeze() / 1e12
print(at_1_MPa.to_series().round(1))
assert at_1_MPa.max() > 5 * at_1_MPa.min()
