"""Areal parameters by another package, in its own interpreter.

    python heights.py CODE IN.npz OUT.npz

IN holds heights (n, n) [um], levelled, the same on a slope (sloped), and spacing [um]; OUT gets the parameters.
"""

import sys

import numpy as np


def surfalize(heights, sloped, spacing):
    from surfalize import Surface

    one = Surface(heights, spacing, spacing)
    found = {name: getattr(one, name)() for name in ("Sq", "Sa", "Sz", "Ssk", "Sku", "Sdq")}
    level = Surface(sloped, spacing, spacing).level()
    found |= {name: getattr(one, name)() for name in ("Sp", "Sv", "Sk", "Spk", "Svk", "Sxp", "Sal", "Str")}
    found |= {name: getattr(one, name)() for name in ("Vmp", "Vmc", "Vvc", "Vvv")}
    found |= {name: getattr(one, name)() / 100 for name in ("Smr1", "Smr2", "Sdr")}
    return found | {"Sq of the slope": level.Sq()}


def surfacetopography(heights, sloped, spacing):
    from SurfaceTopography import Topography

    size = tuple(spacing * n for n in heights.T.shape)
    one, slope = (Topography(np.ascontiguousarray(z.T), size, unit="um") for z in (heights, sloped))
    return {
        "Sq": one.rms_height_from_area(),
        "Sdq": one.rms_gradient(),
        "Sq of the slope": slope.detrend("height").rms_height_from_area(),
    }


if __name__ == "__main__":
    code, source, target = sys.argv[1:]
    given = np.load(source)
    np.savez(target, **globals()[code](given["heights"], given["sloped"], float(given["spacing"])))
