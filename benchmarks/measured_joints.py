"""Every law and the measured stiffness of ground S45C joints, on surfaces made from what the source states.

Ito, Modular Design for Machine Tools, Table 6-5: ground faces, Rmax 1.0 um, dry, approach C p^m: slow approach curves,
so that k_load is the quantity to compare; k_n of unloading is printed as well. A law without a loading curve has one
branch. The source states neither the
wavelengths nor the spectrum: they are varied, and the range of each law over them is printed with its median.
"""

import numpy as np

import faying
from faying.contact.auto import pick
from faying.contact.models.half_space import HalfSpace
from faying.contact.two_faces import faces_of
from faying.surface.scan import Scan
from faying.surface.synthesize import spectral

# exponent and coefficient of approach [um] = C (p/MPa)^m for eight specimens
MEASURED = [
    (0.40, 0.089),
    (0.36, 0.046),
    (0.75, 0.017),
    (0.58, 0.008),
    (0.39, 0.090),
    (0.58, 0.053),
    (0.61, 0.022),
    (0.21, 0.048),
]
RMAX = 1e-6  # m, largest height over one sampling length
PRESSURES = 1e6, 5e6  # Pa
LAWS = "auto", "half-space", "jk", "gw-ke", "gw-jg", "gw", "persson", "me"
SIDE, POINTS = 0.8e-3, 192


def measured(p: float) -> np.ndarray:
    """Measured k_n [MPa/um] at a pressure [Pa], one value for each specimen."""
    return np.array([(p / 1e6) ** (1 - m) / (C * m) for m, C in MEASURED])


def surfaces() -> list[tuple[str, Scan]]:
    """Ground faces with the stated Rmax: dimension, longest wavelength and lay are not stated."""
    out = []
    for D in (2.2, 2.4):
        for longest in (0.03e-3, 0.1e-3):
            for stretch in (1.0, 5.0):
                scan = spectral(
                    (POINTS, POINTS), spacing=SIDE / POINTS, D=D, Rq=1e-7, longest=longest, lay=(0.0, stretch), seed=1
                )
                # Rmax of profiles across the lay, over a sampling length of 0.8 mm
                rmax = float(np.mean(np.ptp(scan.heights, axis=0)))
                name = f"D {D}, {longest * 1e3:g} mm, lay {stretch:g}"
                out.append((name, scan.with_heights(scan.heights * (RMAX / rmax))))
    return out


def predicted(scan: Scan) -> dict[str, list[tuple[float, float]]]:
    """k_load and k_n [MPa/um] of each law at the pressures; NaN where it has no answer."""
    steel = faying.CATALOGUE["45 steel"]
    pair = faying.ContactPair(steel, steel)
    surface = faces_of(scan, "same").rough
    exact = pick("half-space", {}, surface, pair).law
    assert isinstance(exact, HalfSpace)
    out = {}
    for law in LAWS:
        try:
            made = exact if law == "half-space" else pick(law, {}, surface, pair, exact=exact).law
            said = made.at_pressure(np.array(PRESSURES))
        except faying.FayingError:
            out[law] = [(np.nan, np.nan)] * len(PRESSURES)
            continue
        k_n = np.full(len(PRESSURES), np.nan) if said.k_n is None else said.k_n
        k_load = k_n if said.k_load is None else said.k_load  # without a loading curve of its own a law has one branch
        out[law] = [(float(a) / 1e12, float(b) / 1e12) for a, b in zip(k_load, k_n, strict=True)]
    return out


def cell(values: np.ndarray, over: float) -> str:
    """Median, range and, in units of a measured value, the median; a dash without an answer."""
    good = values[np.isfinite(values)]
    if not len(good):
        return " - | - |"
    middle = float(np.median(good))
    return f" {middle:.3g} ({good.min():.3g} to {good.max():.3g}) | {middle / over:.2g} |"


def main() -> None:
    """Print the table."""
    found: dict[str, list[list[tuple[float, float]]]] = {name: [] for name in LAWS}
    for name, scan in surfaces():
        for law, row in predicted(scan).items():
            found[law].append(row)
        print(f"# {name}: " + ", ".join(f"{law} {found[law][-1][0][1]:.3g}" for law in LAWS), flush=True)
    heads = "".join(f" at {p / 1e6:g} MPa [MPa/um] (range) | over measured |" for p in PRESSURES)
    print(f"| law | branch |{heads}\n|---|---|{'---|---|' * len(PRESSURES)}")
    at = [measured(p) for p in PRESSURES]
    print("| measured, eight specimens | loading |" + "".join(cell(m, float(np.median(m))) for m in at))
    for law, rows in found.items():
        values = np.array(rows)  # surface, pressure, branch
        one_branch = np.array_equal(values[..., 0], values[..., 1], equal_nan=True)
        for i, branch in enumerate(("both",) if one_branch else ("loading, k_load", "unloading, k_n")):
            cells = "".join(cell(values[:, j, i], float(np.median(m))) for j, m in enumerate(at))
            print(f"| {law} | {branch} |{cells}")


if __name__ == "__main__":
    main()
