"""The JK paper's figures 3, 6 and 7 and its Table 1: one asperity.

doi:10.3390/fractalfract8100611, sections 2.2 to 2.4: R 15 um, h_a 0.1 um, E 100 GPa, nu 0.3, yield strength 355 MPa.
"""

from dataclasses import dataclass
from math import pi, sqrt
from pathlib import Path
from typing import Any, final

import numpy as np

from faying.contact.asperity.base import AsperityModel
from faying.contact.asperity.jk import JK
from faying.contact.asperity.kogut_etsion import KogutEtsion
from faying.contact.asperity.lin_lin import LinLin
from faying.contact.substrate import asperity_share
from faying.materials import RIGID, ContactPair, Material
from faying.style import new_panels, save
from faying.typing import Array

R, HEIGHT, DIMENSION = 15e-6, 0.1e-6, 2.9961
HARDNESS = 994e6
METAL = Material(name="of section 2.4", E=100e9, nu=0.3, yield_strength=355e6, hardness=HARDNESS)
PAIR = ContactPair(METAL, RIGID)


def deformation(delta: Array, ratio: float, xi: float) -> tuple[Array, Array]:
    """Return the asperity's own deformation [m] at applied delta [m] by eq. (1) and by eq. (2).

    Eq. (2) puts a height h_ai that runs linearly over the range of delta in place of delta_a under the root:
    delta_a = delta/(1 + Er xi sqrt(delta)).
    """
    exact = delta * asperity_share(delta, ratio, xi)
    return exact, delta / (1 + ratio * xi * np.sqrt(delta))


def figure_3() -> Any:
    """Draw delta_a against delta, exact and approximate, for several Er at xi = 1e4 m^-0.5, and for several xi."""
    delta = np.linspace(0, 15e-9, 200)
    fig = new_panels(2)
    cases = ([(r, 1e4, f"Er {r:g}") for r in (0.5, 1.0, 2.0)], [(1.0, x, f"xi {x:g} m^-0.5") for x in (5e2, 3e3, 1e4)])
    for ax, part in zip(fig.axes, cases, strict=True):
        for i, (ratio, xi, name) in enumerate(part):
            exact, rough = deformation(delta, ratio, xi)
            ax.plot(delta * 1e9, exact * 1e9, color=f"C{i}", label=f"{name}, eq. (1)")
            ax.plot(delta * 1e9, rough * 1e9, "--", color=f"C{i}", label=f"{name}, eq. (2)")
        ax.set(xlabel="applied deformation delta [nm]", ylabel="deformation of the asperity [nm]")
        ax.grid(alpha=0.3)
        ax.legend(fontsize=8)
    return fig


def single_models() -> dict[str, AsperityModel]:
    """Models of figures 6 and 7 on the paper's asperity."""
    return {
        "JK": JK(R=R, pair=PAIR, closure="printed"),
        "KE": KogutEtsion(R=R, pair=PAIR),
        "LL-2005": LinLin(R=R, pair=PAIR),
    }


def dimensionless(model: AsperityModel, x: Array) -> dict[str, Array]:
    """Return f/(pi R delta H), a/(pi R delta) and p/H, eqs. (21), (22), at x = delta/d1c of the undeformed cap."""
    delta = x * LinLin(R=R, pair=PAIR).critical
    r = model.at(delta)
    unit = pi * R * delta
    return {"f": r.force / (unit * HARDNESS), "a": r.area / unit, "p": r.pressure / HARDNESS}


def figure_6() -> Any:
    """Draw dimensionless load, area and mean pressure against interference for JK, KE and LL-2005."""
    x = np.geomspace(0.1, 300, 1200)
    fig = new_panels(3)
    labels = {"f": "f/(pi R delta H)", "a": "a/(pi R delta)", "p": "mean pressure / H"}
    styles = {"JK": "-", "KE": "-", "LL-2005": "--"}
    for ax, (key, label) in zip(fig.axes, labels.items(), strict=True):
        for name, model in single_models().items():
            ax.semilogx(x, dimensionless(model, x)[key], styles[name], label=name)
        for border in (1, 6, 76.8, 110):
            ax.axvline(border, color="0.8", lw=0.8)
        ax.set(xlabel="delta/d1c", ylabel=label)
        ax.grid(alpha=0.3)
    fig.axes[0].legend(fontsize=8)
    return fig


@final
@dataclass(frozen=True, kw_only=True)
class TableRow:
    """A row of the paper's Table 1: radius and height [m], moduli of asperity and substrate [Pa], F [N] and A [m2]."""

    R: float
    height: float
    E_asperity: float
    E_substrate: float
    force_fe: float
    area_fe: float
    force: float
    area: float

    @property
    def pair(self) -> ContactPair:
        """The substrate's material against a rigid plane: the rule that the printed forces obey."""
        return ContactPair(Material(name="substrate", E=self.E_substrate, nu=0.3, hardness=HARDNESS), RIGID)

    @property
    def plastic(self) -> bool:
        """Whether the printed area exceeds that at which full plasticity begins."""
        model = JK(R=self.R, pair=self.pair, closure="printed")
        return self.area > 2 * pi * self.R * 76.8 * model.critical

    def force_of_area(self, area: float | None = None) -> float:
        """Return the force [N] that the printed laws (15)-(18) give to an area [m2], by default the printed one."""
        a = self.area if area is None else area
        c = JK(R=self.R, pair=self.pair, closure="printed").critical
        if self.plastic:
            return HARDNESS * a
        KH = self.pair.hardness_coefficient * HARDNESS
        return float(2 / 3 * KH * pi * self.R * c * (a / (pi * self.R * c)) ** (1.38 / 1.16))

    @property
    def model(self) -> JK:
        """The cap with the asperity's deformation equal to the applied one (lam 1)."""
        return JK(R=self.R, pair=self.pair, closure="printed")

    @property
    def interference(self) -> float:
        """1.06 times a tenth of the height, the cosine's depth at a tenth of the base area [m]."""
        return 1.06 * 0.1 * (self.height - self.height**2 / (2 * self.R))

    @property
    def implied_share(self) -> float:
        """lam that brings the model's area to the printed one [-]."""
        power = 1.0 if self.plastic else 1.16
        return float((self.area / float(self.model.at(self.interference).area)) ** (1 / power))

    @property
    def implied_mix(self) -> float | None:
        """Share x of the asperity in the compliance 1/E = x/Ea + (1-x)/Eb with which the printed force follows.

        None where the force does not depend on E (plastic) or both moduli are equal.
        """
        if self.plastic or self.E_asperity == self.E_substrate:
            return None
        # f ~ (area of yield)^(1 - 1.38/1.16), and that area ~ E^-2
        stiffer = (self.force / self.force_of_area()) ** (1 / (2 * (1.38 / 1.16 - 1)))
        return float((1 - 1 / stiffer) / (1 - self.E_substrate / self.E_asperity))


_CAPS = ((15e-6, 100e-9), (20e-6, 750e-9), (40e-6, 3000e-9), (80e-6, 6000e-9))
# FE force and area, then JK's, in mN and um2 = 1e-3 N and 1e-6 mm2
_PRINTED = {
    100e9: (
        (0.41, 0.589, 0.405, 0.646),
        (7.43, 8.01, 8.27, 8.94),
        (64.6, 74.1, 75.71, 76.17),
        (257.7, 296.3, 302.86, 304.69),
    ),
    150e9: (
        (0.43, 0.589, 0.402, 0.629),
        (7.70, 8.01, 8.70, 9.05),
        (70.1, 74.2, 75.07, 75.52),
        (279.4, 296.6, 300.77, 302.59),
    ),
    200e9: (
        (0.45, 0.590, 0.393, 0.611),
        (7.82, 8.01, 8.92, 9.07),
        (72.6, 74.2, 74.47, 74.92),
        (290.0, 296.8, 298.84, 300.65),
    ),
}


def table_1() -> list[TableRow]:
    """Return the 12 rows of the paper's Table 1; the substrate has 100 GPa in all of them."""
    return [
        TableRow(
            R=radius,
            height=height,
            E_asperity=E,
            E_substrate=100e9,
            force_fe=values[0] * 1e-3,
            area_fe=values[1] * 1e-12,
            force=values[2] * 1e-3,
            area=values[3] * 1e-12,
        )
        for E, row in _PRINTED.items()
        for (radius, height), values in zip(_CAPS, row, strict=True)
    ]


def figure_7() -> Any:
    """Draw force against interference for the models, and the rows of Table 1: ours and finite elements over print."""
    fig = new_panels(2)
    delta = np.linspace(0, 30e-9, 300)
    for name, model in single_models().items():
        fig.axes[0].plot(delta[1:] * 1e9, model.at(delta[1:]).force * 1e3, label=name)
    row = table_1()[0]
    fig.axes[0].plot(0.1 * HEIGHT * 1e9, row.force_fe * 1e3, "k^", label="finite elements, Table 1")
    fig.axes[0].plot(0.1 * HEIGHT * 1e9, row.force * 1e3, "kx", label="JK, Table 1")
    fig.axes[0].set(xlabel="interference [nm]", ylabel="force [mN]")
    rows = table_1()
    place = np.arange(len(rows))
    ours = np.array([float(r.model.at(r.interference).area) for r in rows])
    ax = fig.axes[1]
    ax.plot(place, [r.area_fe / r.area for r in rows], "k^", label="area, finite elements")
    ax.plot(place, ours / [r.area for r in rows], "C0o", label="area, ours with lam 1")
    ax.plot(
        place, [r.force_of_area() / r.force for r in rows], "C1s", ms=4, label="force of the printed area, our laws"
    )
    ax.axhline(1, color="0.5", lw=0.8)
    ticks = [f"{r.R * 1e6:.0f}, {r.E_asperity / 1e9:.0f}" for r in rows]
    ax.set_xticks(place, ticks, rotation=60, fontsize=7)
    ax.set(xlabel="R [um], E of the asperity [GPa]", ylabel="over the printed JK column", ylim=(0.85, 1.35))
    for axes in fig.axes:
        axes.grid(alpha=0.3)
        axes.legend(fontsize=8)
    return fig


def xi(radius: float, height: float) -> float:
    """Return the paper's geometric coefficient 1.5 sqrt(R)/r_a [m^-0.5], r_a = sqrt(2 R h - h^2)."""
    return 1.5 * sqrt(radius) / sqrt(2 * radius * height - height**2)


FIGURES = {"figure-03": figure_3, "figure-06": figure_6, "figure-07": figure_7}

if __name__ == "__main__":  # python docs/gallery/paper_asperity.py writes them to docs/figures
    for name, draw in FIGURES.items():
        save(draw(), str(Path(__file__).parents[1] / "figures" / f"{name}.png"))
