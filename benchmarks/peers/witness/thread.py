"""Areas and stiffness of metric bolts by pyFlange, in its own interpreter: python thread.py IN.npz OUT.npz.

IN holds diameters and pitches [m], lengths of the plain shank and clamped lengths [m] and E [Pa]; OUT gets stress
areas, minor diameters and stiffnesses.
"""

import sys

import numpy as np
from pyflange.bolts import MetricBolt

given = np.load(sys.argv[1])
columns = (given[name] for name in ("diameter", "pitch", "shank", "clamped"))
area, minor, stiffness = [], [], []
for diameter, pitch, shank, clamped in zip(*columns, strict=True):
    bolt = MetricBolt(diameter, pitch, 640e6, 800e6, elastic_modulus=float(given["E"]), shank_length=shank)
    area.append(bolt.thread_cross_section.area)
    minor.append(bolt.thread_minor_diameter)
    stiffness.append(bolt.axial_stiffness(clamped))
np.savez(sys.argv[2], area=area, minor=minor, stiffness=stiffness)
