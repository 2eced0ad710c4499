"""Miner's sum of bolts by pyFlange's curve of IEC 61400-6: python bolt_curve.py IN.npz OUT.npz.

IN holds diameters [m], the range at the knee [Pa], ranges of stress [Pa] and their cycles; OUT gets their sums.
"""

import sys

import numpy as np
from pyflange.fatigue import BoltFatigueCurve, MarkovMatrix

given = np.load(sys.argv[1])
ranges, cycles = given["ranges"], given["cycles"]
matrix = MarkovMatrix(range=ranges, mean=np.zeros_like(ranges), cycles=cycles, duration=1)
curves = [BoltFatigueCurve(d, DS_ref=float(given["detail"]), gamma_M=1.0) for d in given["diameters"]]
np.savez(sys.argv[2], damage=[curve.cumulated_damage(matrix) for curve in curves])
