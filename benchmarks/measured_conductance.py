"""Every law on measured contact conductance and stiffness: law over measured, per finish and materials.

`docs/theory/measured-stiffness.csv` has the measurements, `docs/theory/measured-materials.csv` the materials. The
sources state a roughness, not the slope of profiles: m = 0.125 (sigma/um)^0.402 of each face (Antonetti, White and
Simons). Both faces have the stated roughness, so that sigma and m of both together are sqrt(2) times that of one.
Laws that need a scan get a synthetic Gaussian surface of that sigma and m, Hurst 0.8, with a band of 16 from the
longest to the shortest wave: sigma and m then fix both waves. k_n = h E* (1/K1 + 1/K2)/2 (Barber 2003). Prints a table
in Markdown: median and, in brackets, 10 and 90 % of the ratio; rows whose source gives one h for a range of pressures
wider than 3 to 1 are left out.
"""

import csv
from collections import defaultdict
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

import faying
from faying.contact.auto import pick
from faying.contact.inputs import RoughSurface
from faying.contact.two_faces import faces_of
from faying.surface.scan import Scan
from faying.surface.synthesize import spectral

FOLDER = Path(__file__).parents[1] / "docs" / "theory"
LAWS = "half-space", "cmy", "mikic", "gw", "gw-ke", "persson", "jk"
POINTS, BAND, HURST = 256, 16, 0.8


@dataclass(frozen=True, kw_only=True)
class Measured:
    """One measurement: the pair, its finish, branch and source, pressure [Pa], k_n [Pa/m], roughness of a face [m]."""

    pair: faying.ContactPair
    finish: str
    branch: str
    source: str
    kind: str
    pressure: float
    k_n: float
    roughness: float

    @property
    def slope(self) -> float:
        """Mean absolute slope of one face [-]."""
        return float(0.125 * (self.roughness * 1e6) ** 0.402)


def table(name: str) -> list[dict[str, str]]:
    """Rows of a table of the theory pages."""
    with (FOLDER / name).open(newline="") as file:
        return list(csv.DictReader(file))


def materials() -> dict[str, faying.Material]:
    """The materials by name; those with a Brinell hardness have a hardness over the size of spots."""
    out = {}
    for row in table("measured-materials.csv"):
        brinell = float(row["HB [GPa]"]) * 1e9 if row["HB [GPa]"] else None
        hardness = float(row["hardness [GPa]"]) * 1e9 if row["hardness [GPa]"] else brinell
        material = faying.Material(
            name=row["material"],
            E=float(row["E [GPa]"]) * 1e9,
            nu=float(row["nu"]),
            hardness=hardness,
            brinell=brinell,
            conductivity=float(row["K [W/(m K)]"]),
            source=row["source"],
        )
        out[material.name] = material
    return out


def measured() -> list[Measured]:
    """All measurements as stiffness."""
    known = materials()
    out = []
    for row in table("measured-stiffness.csv"):
        pair = faying.ContactPair(known[row["first"]], known[row["second"]])
        value = float(row["value"])
        conducts = row["unit"] == "W/(m2 K)"
        resistance = sum(1 / (m.conductivity or np.nan) for m in (pair.first, pair.second))
        out.append(
            Measured(
                pair=pair,
                finish=row["finish"],
                branch=row["branch"],
                source=row["source"],
                kind=row["kind"],
                pressure=1e6 * float(np.sqrt(float(row["p low [MPa]"]) * float(row["p high [MPa]"]))),
                k_n=value * pair.E_star * resistance / 2 if conducts else value * 1e12,
                roughness=float(row["roughness [um]"]) * 1e-6,
            )
        )
    return out


@cache
def unit_map() -> np.ndarray:
    """Heights of rms 1 on a grid of spacing 1: Hurst 0.8, four of the longest waves a side, four points to the last."""
    scan = spectral(
        (POINTS, POINTS),
        spacing=1.0,
        D=3 - HURST,
        Rq=1.0,
        longest=POINTS / 4,
        shortest=POINTS / 4 / BAND,
        periodic=True,
        seed=1,
    )
    return np.asarray(scan.heights)


@cache
def surface(sigma: float, slope: float) -> RoughSurface:
    """A surface of this rms height [m] and mean absolute slope of profiles [-], against a smooth plane."""
    z = unit_map()
    steep = np.mean([np.abs(np.diff(z, axis=axis)).mean() for axis in (0, 1)])
    spacing = float(sigma * steep / slope)
    return faces_of(Scan(heights=z * sigma, spacing=(spacing, spacing), source="synthetic"), "smooth").rough


def predicted(law: str, one: Measured) -> float:
    """k_n, or the slope of first loading where that was measured [Pa/m]; NaN where the law has no answer."""
    sigma, slope = np.sqrt(2) * one.roughness, np.sqrt(2) * one.slope
    try:
        made = made_once(law, float(sigma), float(slope), one.pair)
        r = made.at_pressure(one.pressure)
    except faying.FayingError:
        return float("nan")
    k = r.k_load if one.branch == "loading" and r.k_load is not None else r.k_n
    return float("nan") if k is None else float(k)


@cache
def made_once(law: str, sigma: float, slope: float, pair: faying.ContactPair) -> faying.contact.ContactLaw:
    """The law of a surface, made once for all pressures."""
    return pick(law, {}, surface(sigma, slope), pair).law


def cell(ratios: list[float]) -> str:
    """Median and, of three or more, 10 and 90 % of the ratios."""
    good = [r for r in ratios if np.isfinite(r)]
    if not good:
        return "-"
    middle = f"{np.median(good):.2g}"
    return middle if len(good) < 3 else f"{middle} ({np.quantile(good, 0.1):.2g} to {np.quantile(good, 0.9):.2g})"


def main() -> None:
    """Print the table."""
    groups: dict[tuple[str, str, str], list[Measured]] = defaultdict(list)
    for one in measured():
        if one.kind != "range":
            groups[one.branch, f"{one.pair.first.name} on {one.pair.second.name}", one.finish].append(one)
            groups[one.branch, "all metals" if one.pair.first.name != "UO2" else "", ""].append(one)
    print("| branch | pair, finish | points | measured k_n [MPa/um] | " + " | ".join(LAWS) + " |")
    print("|---|---|---|---|" + "---|" * len(LAWS))
    for (branch, pair, finish), rows in sorted(groups.items(), reverse=True):
        if not pair:
            continue
        k = [row.k_n * 1e-12 for row in rows]
        cells = [cell([predicted(law, row) / row.k_n for row in rows]) for law in LAWS]
        what = ", ".join(filter(None, (pair, finish)))
        print(f"| {branch} | {what} | {len(rows)} | {min(k):.3g} to {max(k):.3g} | " + " | ".join(cells) + " |")


if __name__ == "__main__":
    main()
