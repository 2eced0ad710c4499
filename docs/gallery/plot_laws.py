"""
Stiffness of contact laws on one surface
========================================

Every law that lives on the moments of a surface, for the same surface and the same pair of materials.
"""

import matplotlib.pyplot as plt
import numpy as np

import faying
from faying.contact import RoughSurface, SurfaceInputs, laws_of_surface

# %%
# The surface: D and G of a fractal surface, with waves from 4 mm down to 10 um. Its moments follow.

surface = RoughSurface(
    inputs=SurfaceInputs.from_fractal(D=2.3, G=2e-12, scan_area=16e-6, shortest=10e-6),
)
steel = faying.CATALOGUE["45 steel"]
pair = faying.ContactPair(steel, steel)
laws, left_out = laws_of_surface(surface, pair, names=["GW", "GW-KE", "Persson", "JK", "ME"])

# %%
# Each law is asked for the same pressures. Where it says that it is outside its validity range the line is dotted.

pressure = np.geomspace(1e5, 1e7, 60)
fig, ax = plt.subplots(figsize=(6.4, 4.2), layout="constrained")
for i, (name, law) in enumerate(laws.items()):
    p = pressure[pressure <= law.greatest_pressure]
    found = law.at_pressure(p)
    ax.plot(p / 1e6, found.k_n / 1e12, ":", color=f"C{i}")
    ax.plot(p / 1e6, np.where(found.valid, found.k_n, np.nan) / 1e12, color=f"C{i}", label=name)
ax.set(xscale="log", yscale="log", xlabel="nominal pressure [MPa]", ylabel="normal stiffness [MPa/um]")
ax.legend()
ax.grid(alpha=0.3)

# %%
# Laws disagree by a factor of ten and more on one surface: see :doc:`/which-law`.

at_1_MPa = {name: float(law.at_pressure(1e6).k_n) / 1e12 for name, law in laws.items()}
print({name: round(value, 1) for name, value in at_1_MPa.items()})
assert max(at_1_MPa.values()) > 5 * min(at_1_MPa.values())
