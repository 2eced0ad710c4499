"""Two caps of Table 1 with the published laws, and their stresses, as in docs/theory/asperity-fe.md.

Run `python benchmarks/asperity_figure.py FOLDER`.
"""

import sys
from pathlib import Path
from typing import Any

import numpy as np
from asperity_fe.drive import AsperityCase
from asperity_fe.plasticity import equivalent
from asperity_fe.result import AsperityResult

from faying.materials import RIGID, ContactPair, Material
from faying.style import WIDE, colour, drawing, new_panels, save

LAWS = ("KogutEtsion", "JacksonGreen", "LinLin", "ZhaoMaiettaChang", "JK")


def laws_of(case: AsperityCase) -> dict[str, Any]:
    """Return the published single-asperity models for the cap of a case against a rigid plane, by their short names."""
    from faying.contact.asperity.base import models

    pair = ContactPair(case.cap, RIGID)
    found = models()
    laws: dict[str, Any] = {}
    for name in LAWS:
        extra: dict[str, Any] = {}
        if name == "JK" and not case.substrate.is_rigid:
            extra = {"height": case.h_a, "modulus_ratio": case.cap.E / case.substrate.E}
        model = found[name](R=case.R, pair=pair, **extra)
        laws[model.name] = model
    return laws


@drawing
def curves(axes: Any, case: AsperityCase, result: AsperityResult) -> None:
    """Draw force and area, over displacement, into two axes: computed, with bounds, and the published laws."""
    history = result.history
    d = history.displacement
    fine = np.linspace(0, d.max(), 300)[1:]
    top = int(np.argmax(history.displacement))
    for ax, name, scale, label in (
        (axes[0], "force", 1e3, "force [mN]"),
        (axes[1], "area", 1e12, "contact area [µm²]"),
    ):
        for i, (law, model) in enumerate(laws_of(case).items()):
            ax.plot(fine * 1e9, getattr(model.at(fine), name) * scale, color=colour(i), lw=1.2, label=law)
        value = getattr(history, name) * scale
        ax.plot(d[: top + 1] * 1e9, value[: top + 1], "k-", lw=2, label="finite elements")
        if top < len(d) - 1:
            ax.plot(d[top:] * 1e9, value[top:], "k--", lw=1.5, label="unloading")
        if name == "area":
            low, high = history.area_bounds[: top + 1].T * scale
            ax.fill_between(d[: top + 1] * 1e9, low, high, color="0.8", label="between nodes")
        ax.set(xlabel="displacement [nm]", ylabel=label, xlim=(0, None), ylim=(0, None))
        ax.grid(alpha=0.3)


@drawing
def stresses(fig: Any, ax: Any, case: AsperityCase, result: AsperityResult) -> None:
    """Draw the von Mises stress over the yield strength of the cap near the contact."""
    from matplotlib.collections import PolyCollection

    field = result.field
    reach = 2.5 * float(np.sqrt(result.history.area.max() / np.pi))
    places = field.nodes + field.displacement
    corners = places[field.quads]
    centre = corners.mean(axis=1)
    near = (centre[:, 0] < 1.2 * reach) & (centre[:, 1] > case.h_a - 1.4 * reach)
    unit = case.cap.yield_strength or case.cap.E
    drawn = PolyCollection(corners[near] * 1e6, array=equivalent(field.stress[near]) / unit, cmap="viridis")
    drawn.set_edgecolor("face")
    ax.add_collection(drawn)
    ax.set(
        xlim=(0, reach * 1e6),
        ylim=((case.h_a - 1.2 * reach) * 1e6, (case.h_a + 0.1 * reach) * 1e6),
        aspect="equal",
        xlabel="radius [µm]",
        title=f"at {result.history.displacement[-1] * 1e9:.4g} nm",
        ylabel="height [µm]",
    )
    if not case.substrate.is_rigid:
        ax.axhline(0.0, color="white", lw=0.8, ls=":")
    label = "von Mises stress / yield strength" if case.cap.yield_strength else "von Mises stress / E"
    fig.colorbar(drawn, ax=ax, label=label, shrink=0.8)


@drawing
def overview(case: AsperityCase, result: AsperityResult) -> Any:
    """Return a figure: force, area, and the stress at the last step."""
    fig = new_panels(2, 2, width=WIDE / 2, height=2.6)
    *drawn, stress, last = fig.axes
    curves(drawn, case, result)
    stresses(fig, stress, case, result)
    last.set_axis_off()
    last.legend(*drawn[1].get_legend_handles_labels(), loc="center")
    return fig


def main(folder: str) -> None:
    steel = Material(name="steel", E=100e9, nu=0.3, yield_strength=355e6)
    for name, R, h_a in (("asperity-r40.png", 40e-6, 3e-6), ("asperity-r15.png", 15e-6, 0.1e-6)):
        case = AsperityCase(R=R, h_a=h_a, cap=steel, substrate=steel, displacement=(0.1 * h_a,))
        save(overview(case, case.solve()), Path(folder) / name)


if __name__ == "__main__":
    main(sys.argv[1])
