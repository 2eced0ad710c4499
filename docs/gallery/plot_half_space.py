"""
Where a rough surface touches
=============================

The contact of a map with a flat, solved at two pressures: open points, elastic points, points at hardness.
"""

import matplotlib.pyplot as plt
import numpy as np

import faying

scan = faying.synthesize.spectral((256, 256), spacing=1e-3 / 256, D=2.2, Rq=0.5e-6, longest=1e-4, seed=3)
steel = faying.CATALOGUE["45 steel"]
pair = faying.ContactPair(steel, steel)

# %%
# A contact is found at a nominal pressure; the stiffness follows from the set of points that touch.

fig, axes = plt.subplots(1, 2, figsize=(8.4, 4.2), layout="constrained")
areas = []
for ax, pressure in zip(axes, (5e6, 50e6), strict=True):
    here = faying.solve_half_space(
        scan.heights, scan.spacing, E_star=pair.E_star, pressure=pressure, hardness=pair.hardness, nu=steel.nu
    )
    kind = np.where(here.traction >= pair.hardness * (1 - 1e-6), 2.0, np.where(here.traction > 0, 1.0, np.nan))
    ax.imshow(kind, cmap="viridis", vmin=0, vmax=2.2, extent=(0, 1, 0, 1))
    tangent = here.tangent()
    areas.append(here.area)
    title = f"{pressure / 1e6:g} MPa: area {here.area:.2%}, k_n {tangent.k_n / 1e12:.0f} MPa/um"
    ax.set(title=title, xlabel="x [mm]", ylabel="y [mm]")

# %%
# Ten times the pressure touches about ten times the area: each spot keeps its mean pressure.

assert 5 < areas[1] / areas[0] < 12
