"""Areas and stiffness of metric bolts, and their fatigue under random stress."""

import numpy as np

from faying.bolt.fatigue import DETAIL, FatigueCurve, dirlik, narrow_band
from faying.bolt.threads import Thread
from faying.bolt.vdi2230 import bolt_sections
from peers.peer import ask
from peers.rows import Problem, worst

E = 205e9  # Pa
SIZES = (5, 8, 12, 20, 30, 39, 64)  # mm, coarse


def bolts(python):
    threads = [Thread.coarse(size * 1e-3) for size in SIZES]
    d = np.array([one.diameter for one in threads])
    shank, clamped = 2 * d, 4 * d
    theirs = ask(
        python, "thread.py", diameter=d, pitch=[one.pitch for one in threads], shank=shank, clamped=clamped, E=E
    )
    stiffness = [
        1 / sum(piece.compliance for piece in bolt_sections(one, free=4 * x, E=E, shank=2 * x))
        for one, x in zip(threads, d, strict=True)
    ]
    span = f"M{SIZES[0]} to M{SIZES[-1]}"
    quantities = (
        ("stress area", [one.stress_area * 1e6 for one in threads], theirs["area"] * 1e6, "mm2"),
        ("minor diameter", [one.minor_diameter * 1e3 for one in threads], theirs["minor"] * 1e3, "mm"),
        ("stiffness over four diameters", np.array(stiffness) * 1e-6, theirs["stiffness"] * 1e-6, "MN/m"),
    )
    return [worst(f"{what}, {span}, number", a, b, bound=4e-6, unit=u) for what, a, b, u in quantities]


def fatigue(python):
    """Two resonances, one of them, and a plateau, by curves of one slope."""
    f = np.linspace(1.0, 2000.0, 20001)
    hump, other = np.exp(-(((f - 300) / 60) ** 2)), np.exp(-(((f - 900) / 150) ** 2))
    densities = 1e12 * np.stack([hump + 0.4 * other, hump, np.where(f < 500, 1.0, 1e-3)])
    curves = [FatigueCurve(endurance=20e6, slope=slope, slope_below=slope) for slope in (3.0, 5.0, 9.0)]
    theirs = ask(
        python,
        "fatigue.py",
        frequencies=f,
        densities=densities,
        slopes=[one.slope for one in curves],
        constants=[one.knee * one.endurance**one.slope for one in curves],
    )
    moments = [np.array([np.trapezoid(one * f**n, f) for n in (0, 1, 2, 4)]) for one in densities]
    ours = {
        "dirlik": [dirlik(curve, m) for m in moments for curve in curves],
        "narrow": [narrow_band(curve, np.sqrt(m[0]), np.sqrt(m[2] / m[0])) for m in moments for curve in curves],
    }
    names = {"dirlik": "damage by Dirlik, three spectra, three slopes, number", "narrow": "the same of a narrow band"}
    return [worst(names[key], ours[key], theirs[key], bound=1e-9, unit="1/s") for key in names]


def spectrum(python):
    """A spectrum on both sides of the knee, on bolts up to 30 mm."""
    diameters = np.array([12e-3, 20e-3, 30e-3])
    ranges, cycles = np.linspace(5e6, 120e6, 24), np.geomspace(1e8, 1e3, 24)
    theirs = ask(python, "bolt_curve.py", diameters=diameters, detail=DETAIL, ranges=ranges, cycles=cycles)
    ours = [FatigueCurve.iec(d).damage(ranges / 2, cycles) for d in diameters]
    return [worst("damage of 24 ranges, M12 to M30, number", ours, theirs["damage"], bound=1e-12, unit="")]


PROBLEMS = [
    Problem(
        name="metric bolts",
        peer="pyFlange",
        seconds=2,
        bound="The same formulas of ISO 898-1 and VDI 2230; Faying has their printed factors 0.64952 and 1.22687, "
        "which are 5e-6 of the pitch off at most, or 1e-6 of the diameter and 2e-6 of its square; twice that.",
        solve=bolts,
    ),
    Problem(
        name="bolts in tension, IEC 61400-6",
        peer="pyFlange",
        seconds=2,
        bound="The same two slopes and knee, of detail category 36 without a partial factor: rounding. Beyond 30 mm "
        "pyFlange follows the amendment of the standard, (30 mm/d)^0.1, and Faying its first edition, (30 mm/d)^0.25.",
        solve=spectrum,
    ),
    Problem(
        name="random stress",
        peer="FLife",
        seconds=2,
        bound="The same closed forms of the same moments; Faying's rule for curves of two slopes is exact for one.",
        solve=fatigue,
    ),
]
