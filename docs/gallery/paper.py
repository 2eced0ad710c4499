"""The JK paper's figures 8 to 13, and measured steel joints beside the models: data first, then one drawing each.

doi:10.3390/fractalfract8100611, with its parameters: E 200 GPa, nu 0.3, H 994 MPa against a rigid plane, scanned side
4 mm, friction 0.25, alpha 0.2, the printed closure, lam 1. Figures 3, 6 and 7 are in `paper_asperity.py`.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from faying.contact.compare import Comparison, compare
from faying.contact.inputs import SurfaceInputs
from faying.contact.law import Response
from faying.contact.mates import Mates
from faying.contact.models.jk import JK
from faying.contact.models.power_law import PowerLaw
from faying.materials import CATALOGUE, RIGID, ContactPair
from faying.style import new_panels, save
from faying.typing import Array

STEEL = CATALOGUE["45 steel"]
PAIR = ContactPair(STEEL, RIGID)
SIDE = 4e-3
DIMENSIONS = (2.3, 2.4, 2.5, 2.6)  # at G = 1e-11 m
ROUGHNESSES = (1e-12, 1e-11, 1e-10)  # at D = 2.4
LOADS = np.geomspace(1e-12, 1e-3, 181)  # F/(E* A0)

# Ito, Modular Design for Machine Tools, Table 6-5: ground S45C on itself, dry, approach = C p^m (um, MPa) to 9.8 MPa
S45C = {
    "100/40": (0.40, 0.089),
    "80/40": (0.36, 0.046),
    "60/40": (0.75, 0.017),
    "50/40": (0.58, 0.008),
    "100/24": (0.39, 0.090),
    "80/24": (0.58, 0.053),
    "60/24": (0.61, 0.022),
    "50/24": (0.21, 0.048),
}
S45C_MEAN = (0.48, 0.046)


def law(D: float, G: float) -> JK:
    """Return the JK law of the paper's section 3.8."""
    return JK(D=D, G=G, pair=PAIR, scan_area=SIDE**2, closure="printed")


def families() -> tuple[dict[float, JK], dict[float, JK]]:
    """Laws of the paper's figures 10 to 13: by D at one G, and by G at one D."""
    return {D: law(D, 1e-11) for D in DIMENSIONS}, {G: law(2.4, G) for G in ROUGHNESSES}


def dimensionless(one: JK, loads: Array = LOADS) -> dict[str, Array]:
    """Return F*, Ar*, Kn*, Kt*, Cn*, the ratio Kt/Kn and the small/meso/large stage (0, 1, 2) over loads F/(E* A0).

    F/(E* A0), Ar/A0, K/(E* sqrt(A0)), C/(A0^.25 sqrt(M E*)) = eta sqrt(K*): section 3.8. Only loads below al3'.
    """
    E = one.pair.E_star
    end = min(one.greatest_pressure, float(one.at_closure(one.limits[2]).pressure))
    p = loads[loads * E <= end] * E
    r: Response = one.at_pressure(p)
    assert r.k_n is not None
    assert r.k_t is not None
    assert r.loss_n is not None
    assert r.area is not None
    stiff = SIDE / E
    stages = one.at_closure(np.array(one.limits[:2])).pressure
    return {
        "F": p / E,
        "Ar": r.area,
        "Kn": r.k_n * stiff,
        "Kt": r.k_t * stiff,
        "Cn": r.loss_n * np.sqrt(r.k_n * stiff),
        "ratio": r.k_t / r.k_n,
        "stage": np.searchsorted(stages, p).astype(float),
    }


def critical_areas(one: JK, al: Array) -> tuple[Array, Array]:
    """Return a1c' and a2c' [m2], eqs. (10), (11), at largest truncated areas al' [m2]."""
    a1 = al * (al / one.limits[1]) ** (one.D - 2)
    return a1, 76.8 * a1


def figure_8(D: float = 2.4, G: float = 1e-11) -> Any:
    """Draw a1c' and a2c' against al': which asperities are plastic, elastic-plastic and elastic in which stage."""
    one = law(D, G)
    al1, al2, al3 = one.limits
    al = np.geomspace(al1 * 1e-3, al3, 400)
    a1, a2 = critical_areas(one, al)
    fig = new_panels(1, width=6.0, height=4.6)
    (ax,) = fig.axes
    floor = np.full_like(al, a1.min() * 1e-3)
    lower, upper = np.minimum(a1, al), np.minimum(a2, al)
    ax.fill_between(al, floor, lower, color="#f4c7c3", label="elastic")
    ax.fill_between(al, lower, upper, color="#cfe8cf", label="elastic-plastic")
    ax.fill_between(al, upper, al, color="#c9daf4", label="fully plastic")
    ax.plot(al, a1, "C3", label="a1c'")
    ax.plot(al, a2, "C2", label="a2c'")
    ax.plot(al, al, "k", lw=1, label="a' = al'")
    for value, name in ((al1, "al1'"), (al2, "al2'"), (al3, "al3'")):
        ax.axvline(value, color="0.4", ls=":", lw=1)
        ax.text(value, 0.96, f" {name}", transform=ax.get_xaxis_transform(), va="top", fontsize=8)
    ax.set(
        xscale="log",
        yscale="log",
        ylim=(floor[0], al3 * 10),
        xlabel="largest truncated area al' [m2]",
        ylabel="truncated area a' [m2]",
        title=f"D {D:g}, G {G:.0e} m",
    )
    ax.legend(fontsize=8, loc="lower right", framealpha=1)
    return fig


def figure_9() -> Any:
    """Draw the stage limits al1', al2', al3' against D, for several G."""
    D = np.linspace(2.25, 2.65, 81)
    fig = new_panels(1, width=6.0, height=4.6)
    (ax,) = fig.axes
    for i, G in enumerate(ROUGHNESSES):
        limits = np.array([law(float(d), G).limits for d in D])
        ax.semilogy(D, limits[:, 0], "--", color=f"C{i}", label=f"al1', G {G:.0e} m")
        ax.semilogy(D, limits[:, 1], "-", color=f"C{i}", label=f"al2', G {G:.0e} m")
    ax.semilogy(D, limits[:, 2], "k", label="al3'")
    ax.set(xlabel="fractal dimension D", ylabel="limits of the stages [m2]")
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8)
    return fig


def _curves(quantity: str, label: str, *, logarithmic: bool = True) -> Any:
    fig = new_panels(2)
    for ax, part in zip(fig.axes, families(), strict=True):
        for i, one in enumerate(part.values()):
            d = dimensionless(one)
            ax.plot(d["F"], d[quantity], color=f"C{i}", label=f"D {one.D:g}, G {one.G:.0e} m")
            for stage in (1, 2):
                at = int(np.searchsorted(d["stage"], stage))
                if 0 < at < d["F"].size:
                    ax.plot(d["F"][at], d[quantity][at], "o", color=f"C{i}", ms=4)
        ax.set(xscale="log", xlabel="F* = F/(E* A0)", ylabel=label)
        if logarithmic:
            ax.set_yscale("log")
        ax.grid(alpha=0.3)
        ax.legend(fontsize=8)
    return fig


def figure_10() -> Any:
    """Draw the real area against load; dots mark the ends of the small and the meso stage."""
    return _curves("Ar", "Ar* = Ar/A0")


def figure_11() -> Any:
    """Draw the normal stiffness against load with the bulk stiffness 1.129 E* sqrt(A0); dots mark ends of stages."""
    fig = _curves("Kn", "Kn* = Kn/(E* sqrt(A0))")
    for ax in fig.axes:
        ax.axhline(2 / np.sqrt(np.pi), color="r", ls=":", label="bulk, 1.129")
        ax.legend(fontsize=8)
    return fig


def figure_12() -> Any:
    """Draw tangential over normal stiffness with Mindlin's value and its bounds; dots mark ends of stages."""
    fig = _curves("ratio", "Kt/Kn", logarithmic=False)
    nu = STEEL.nu
    for ax in fig.axes:
        for value in (1 - nu, 1.0):
            ax.axhline(value, color="r", ls=":")
        ax.axhline(2 * (1 - nu) / (2 - nu), color="k", ls=":", label="Mindlin, eq. (67)")
        ax.legend(fontsize=8)
    return fig


def figure_13() -> Any:
    """Draw the normal damping against load, the loss factor held beyond the small stage; dots mark ends of stages."""
    return _curves("Cn", "Cn* = Cn/(A0^0.25 sqrt(M E*))")


def measured_joints(pressure: Array | None = None) -> tuple[Comparison, Mapping[str, PowerLaw]]:
    """Return the models on the paper's surface, and the measured joints of S45C, at pressures [Pa] up to 9.8 MPa.

    D 2.39, G 1.53e-10 m, both bodies of 45 steel, side 4 mm; moments summed over the waves from 4 mm to 10 um.
    """
    p = np.geomspace(1e5, 9.8e6, 60) if pressure is None else pressure
    surface = SurfaceInputs.from_fractal(D=2.39, G=1.53e-10, scan_area=SIDE**2, shortest=10e-6)
    pair = ContactPair(STEEL, STEEL)
    laws, left_out = Mates.of_surface(surface, materials=pair).laws(["JK", "ME", "Persson", "GW", "GW-KE", "GW-JG"])
    laws["JK, rigid plane"] = JK.from_surface(surface, PAIR)
    steel = {name: PowerLaw.measured(C=C, m=m, origin=f"S45C {name}") for name, (m, C) in S45C.items()}
    steel["mean"] = PowerLaw.measured(C=S45C_MEAN[1], m=S45C_MEAN[0], origin="S45C mean")
    return compare(laws, p, left_out), steel


def figure_s45c() -> Any:
    """Draw the measured stiffness of ground steel joints beside the models on the paper's surface."""
    comparison, steel = measured_joints()
    fig = new_panels(1, width=7.4, height=5.0)
    (ax,) = fig.axes
    p = comparison.pressure
    for name, one in steel.items():
        k = one.at_pressure(p).k_n
        assert k is not None
        style = (
            {"color": "k", "lw": 2.5, "label": "measured, S45C mean"} if name == "mean" else {"color": "0.75", "lw": 1}
        )
        ax.plot(p * 1e-6, k * 1e-12, **style)
    for i, (name, r) in enumerate(comparison.responses.items()):
        assert r.k_n is not None
        ax.plot(p * 1e-6, r.k_n * 1e-12, color=f"C{i}", ls="-" if r.valid.all() else "--", label=name)
    ax.set(
        xscale="log",
        yscale="log",
        xlabel="nominal pressure [MPa]",
        ylabel="normal stiffness k_n [MPa/um]",
        title="grey: single specimens; dashed: model outside its validity range somewhere",
    )
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8)
    return fig


FIGURES = {
    "figure-08": figure_8,
    "figure-09": figure_9,
    "figure-10": figure_10,
    "figure-11": figure_11,
    "figure-12": figure_12,
    "figure-13": figure_13,
    "s45c": figure_s45c,
}

if __name__ == "__main__":  # python docs/gallery/paper.py writes them to docs/figures
    for name, draw in FIGURES.items():
        save(draw(), str(Path(__file__).parents[1] / "figures" / f"{name}.png"))
