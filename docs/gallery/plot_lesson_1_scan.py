"""
Lesson 1: what a scan says
==========================

The first of six lessons: a bolted joint in 90 minutes. Each lesson runs by itself and ends with exercises. The scan is
that of a milled face, 4 mm wide.
"""

from pathlib import Path

import faying

examples = next(path / "examples" for path in Path.cwd().parents if (path / "examples" / "t-specimen").is_dir())
scan = faying.read_scan(examples / "t-specimen" / "milled.x3p")
print(scan)
scan.plot()

# %%
# Heights have an rms value, slopes have another. A contact law of summits needs heights, slopes and curvatures;
# slopes and curvatures grow with the number of points, because finer points see finer waves.

half = scan.cropped(0.5).levelled()
for name, part in (("all of the window", scan), ("its middle quarter", half)):
    print(f"{name}: Sq {1e6 * part.Sq:.3f} µm, Sdq {part.roughness().Sdq:.4f}")

# %%
# The spectrum is a power law over a band of wavelengths. Its exponent and its level are D and G.

fit = scan.fractal()
print(fit)
fit.plot()
assert 2 < fit.D < 3
assert half.Sq < 1.3 * scan.Sq

# %%
# **Exercises.** (a) Read a scan of your own. Which wavelengths does ``fit.band`` leave out, and why? (b) Take every
# second point each way: ``scan.with_heights`` with ``scan.heights[::2, ::2]`` would need another spacing; why? (c)
# Make a surface of known D with ``faying.synthesize.spectral`` and look whether the interval of ``fractal()`` holds
# it.
