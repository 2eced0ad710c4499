"""Every law beside the measured stiffness of ground S45C joints, on surfaces made from what the source states.

Ito, Modular Design for Machine Tools, Table 6-5: ground faces, Rmax 1.0 um, dry, approach C p^m. It states neither the
wavelengths nor the spectrum: they are varied, and the spread of each law's answer over them is printed beside it.
"""

import numpy as np

import faying
from faying.contact.auto import pick
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
                # Rmax of profiles across the lay, over a sampling length of .8 mm
                rmax = float(np.mean(np.ptp(scan.heights, axis=0)))
                name = f"D {D}, {longest * 1e3:g} mm, lay {stretch:g}"
                out.append((name, scan.with_heights(scan.heights * (RMAX / rmax))))
    return out


def main() -> None:
    """Print the table."""
    steel = faying.CATALOGUE["45 steel"]
    pair = faying.ContactPair(steel, steel)
    found: dict[str, list[list[float]]] = {name: [] for name in LAWS}
    for name, scan in surfaces():
        surface = faces_of(scan, "same").rough
        for law in LAWS:
            try:
                row = [float(pick(law, {}, surface, pair).law.at_pressure(p).k_n) / 1e12 for p in PRESSURES]
            except faying.FayingError:
                row = [np.nan] * len(PRESSURES)
            found[law].append(row)
        print(f"# {name}: " + ", ".join(f"{law} {found[law][-1][0]:.3g}" for law in LAWS))
    heads = "".join(f" k_n at {p / 1e6:g} MPa [MPa/um] (range) | over measured |" for p in PRESSURES)
    print(f"| law |{heads}\n|---|{'---|---|' * len(PRESSURES)}")
    cells = "".join(
        f" {np.median(m):.3g} ({m.min():.3g} to {m.max():.3g}) | 1 |" for m in (measured(p) for p in PRESSURES)
    )
    print(f"| measured, eight specimens |{cells}")
    for law, rows in found.items():
        cells = ""
        for p, values in zip(PRESSURES, np.array(rows).T, strict=True):
            kept = values[np.isfinite(values)]
            middle = np.median(kept) if len(kept) else np.nan
            cells += f" {middle:.3g} ({kept.min():.3g} to {kept.max():.3g}) | {middle / np.median(measured(p)):.2g} |"
        print(f"| {law} |{cells}")


if __name__ == "__main__":
    main()
