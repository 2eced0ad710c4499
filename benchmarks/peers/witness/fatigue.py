"""Damage of Gaussian stresses by FLife, in its own interpreter: python fatigue.py IN.npz OUT.npz.

IN holds frequencies [Hz], densities [Pa2/Hz] (n, f), slopes and constants of the curves N = constant/amplitude^slope;
OUT gets the damage a second of each density and curve by Dirlik and of a narrow band.
"""

import sys

import FLife
import numpy as np

given = np.load(sys.argv[1])
curves = list(zip(given["slopes"].tolist(), given["constants"].tolist(), strict=True))
found = {"dirlik": [], "narrow": []}
for density in given["densities"]:
    spectrum = FLife.SpectralData(input={"PSD": density, "f": given["frequencies"]})
    for name, method in (("dirlik", FLife.Dirlik), ("narrow", FLife.Narrowband)):
        found[name] += [1 / method(spectrum).get_life(C=constant, k=slope) for slope, constant in curves]
np.savez(sys.argv[2], **found)
