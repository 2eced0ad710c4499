"""
A scan: roughness, spectrum, D and G
====================================

A synthetic fractal surface with known D and G, and what the estimator finds on it.
"""

import matplotlib.pyplot as plt

import faying

# %%
# 256 by 256 points over 1 mm, D = 2.4, G = 1e-11 m.

scan = faying.synthesize.spectral((256, 256), spacing=1e-3 / 256, D=2.4, G=1e-11, seed=1)
fit = faying.fit_fractal(scan)
print(f"D {fit.D:.3f} ({fit.D_interval[0]:.3f} .. {fit.D_interval[1]:.3f}), G {fit.G:.2e} m")

fig, ax = plt.subplots(figsize=(5.4, 4.2), layout="constrained")
picture = ax.imshow(scan.heights * 1e6, extent=(0, 1, 0, 1), cmap="viridis")
fig.colorbar(picture, label="height [um]")
ax.set(xlabel="x [mm]", ylabel="y [mm]", title=f"D {fit.D:.2f}, G {fit.G:.1e} m")

# %%
# The interval is one of 95 %.

assert fit.D_interval[0] - 0.05 < 2.4 < fit.D_interval[1] + 0.05
