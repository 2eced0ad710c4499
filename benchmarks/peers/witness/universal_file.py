"""A universal file as pyuff reads it, in its own interpreter: python universal_file.py IN.npz OUT.npz.

IN holds its path (source); OUT gets the sum of the magnitudes of its FRFs, their last line, and the frequencies and
damping ratios of its modes.
"""

import sys

import numpy as np
import pyuff

given = np.load(sys.argv[1])
sets = pyuff.UFF(str(given["source"])).read_sets()
frfs = [one for one in sets if one["type"] == 58 and one["func_type"] == 4]
modes = [one for one in sets if one["type"] == 55]
np.savez(
    sys.argv[2],
    magnitude=sum(float(np.abs(one["data"]).sum()) for one in frfs),
    last=frfs[0]["x"][-1],
    frequency=[one["freq"] for one in modes],
    damping=[one["modal_damp_vis"] for one in modes],
)
