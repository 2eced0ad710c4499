"""
A scan: roughness, spectrum, D and G
====================================

A synthetic fractal surface with known D and G, and what the estimator finds on it.
"""

import faying

# %%
# 256 by 256 points over 1 mm, D = 2.4, G = 1e-11 m: the levelled map and its spectrum.

scan = faying.synthesize.spectral((256, 256), spacing=1e-3 / 256, D=2.4, G=1e-11, seed=1)
print(scan)
scan.plot()

# %%
# The fit: its band is shaded, its power law drawn.

fit = scan.fractal()
print(fit)
fit.plot()

# %%
# The interval is one of 95 %.

assert fit.D_interval[0] - 0.05 < 2.4 < fit.D_interval[1] + 0.05
