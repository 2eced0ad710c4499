"""
Lesson 2: from two faces to a stiffness
=======================================

Two rough faces under a pressure have a real area, a normal and a tangential stiffness. A contact law says how they
depend on the pressure. This lesson asks several laws about the same faces.
"""

import faying

scan = faying.synthesize.spectral((200, 200), spacing=10e-6, D=2.3, G=2e-12, seed=3)
faces = faying.Mates(scan, materials="45 steel")
print(faces)

# %%
# The other face is alike, and of the same material. The default law solves the contact of the scan itself.

law = faces.law("half-space")
answer = law.at_pressure("5 MPa")
print(law)
print(f"loading {answer.k_load / 1e12:.1f} MPa/µm, unloading {answer.k_n / 1e12:.1f} MPa/µm")
print(f"k_t/k_n {answer.k_t / answer.k_n:.2f}")
law.plot()

# %%
# Loading is what a slow approach feels, since spots yield. Unloading is what a vibration feels, since spots spring
# back. So a joint vibrates on the stiffer of both.

assert answer.k_n > answer.k_load

# %%
# Closed laws see a few numbers of the faces only. They disagree, some of them by a factor of ten.

faces.compare_plot(laws=["half-space", "jk", "gw", "persson"])
table = faces.compare("5 MPa", laws=["half-space", "jk", "gw", "persson"]).k_n.squeeze() / 1e12
print(table.to_series().round(1))

# %%
# **Exercises.** (a) Give ``materials=("45 steel", "EN AW-6082 T6")``. Which branch changes more? (b) Ask for 0.5 and
# 50 MPa: where does each law end? (c) Halve the resolution of the surface. Which law changes most, and what does
# ``answer.k_n_low`` to ``answer.k_n_high`` say of it?
