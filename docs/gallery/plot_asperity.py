"""
One asperity: finite elements beside published laws
===================================================

A spherical cap under a rigid plane, loaded beyond yield and let go.
"""

import matplotlib.pyplot as plt
import numpy as np

from faying import RIGID, ContactPair, Material, solve_asperity
from faying.contact.asperity import Hertz, JacksonGreen, KogutEtsion

steel = Material(name="steel", E=200e9, nu=0.3, yield_strength=355e6)
found = solve_asperity(R=20e-6, h_a=0.75e-6, cap=steel, substrate=steel, displacement=(75e-9, 0.0), elements=12)

# %%
# The history holds force and displacement of every step, loading and unloading.

displacement = np.linspace(1e-9, 75e-9, 100)
fig, ax = plt.subplots(figsize=(6.0, 4.2), layout="constrained")
ax.plot(found.history.displacement * 1e9, found.history.force * 1e3, "k.-", label="finite elements")
for model in (Hertz, KogutEtsion, JacksonGreen):
    law = model(R=20e-6, pair=ContactPair(steel, RIGID))
    ax.plot(displacement * 1e9, law.at(displacement).force * 1e3, label=model.name)
ax.set(xlabel="displacement [nm]", ylabel="force [mN]", ylim=(0, 12))
ax.legend()
ax.grid(alpha=0.3)

# %%
# What remains after unloading is the depth of the flattened cap.

print(f"residual displacement {found.residual * 1e9:.1f} nm")
assert 0 < found.residual < 75e-9
