"""
Frequency and damping against amplitude
=======================================

The backbone of the first mode of two blocks, and the response to a force that follows from it.
"""

from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import faying

study = next(
    path / "examples" / "two-blocks" / "study.toml"
    for path in Path.cwd().parents
    if (path / "examples" / "two-blocks").is_dir()
)
curve = faying.backbone(study, mode=1, friction=0.03, amplitude=(300.0, 4000.0), harmonics=1)

# %%
# Damping is that of slip alone: it rises with the amplitude, the frequency falls. How much of that hangs on the few
# points of this coarse joint stands in the error lines of ``faying backbone``.

fig, (left, right) = plt.subplots(1, 2, figsize=(8.4, 3.6), layout="constrained")
left.semilogx(curve.acceleration, curve.frequency, ".-")
left.set(xlabel="acceleration [m/s2]", ylabel="frequency [Hz]")
right.loglog(curve.acceleration, 100 * curve.damping, ".-")
right.set(xlabel="acceleration [m/s2]", ylabel="damping ratio [%]")
for ax in (left, right):
    ax.xaxis.set_minor_formatter("")
    ax.grid(alpha=0.3)

# %%
# At small amplitude the energy lost in a cycle grows with about the third power of the amplitude, as for spheres that
# begin to slip (Mindlin and Deresiewicz). A viscous damper would have the second.

small = curve.acceleration < 1000
energy = curve.energy.sum(axis=1)[small]
power = np.polyfit(np.log(curve.acceleration[small]), np.log(energy), 1)[0]
print(f"energy per cycle goes with the amplitude to the power {power:.2f}")
assert 2.8 < power < 3.3
