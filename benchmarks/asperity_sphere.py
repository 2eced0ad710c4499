"""A sphere pressed to x = 110: load, area and residual displacement beside the published laws, as a figure.

Run `python benchmarks/asperity_sphere.py FIGURE.png`: differences in per cent over x, for a perfectly plastic sphere
and for tangent moduli of 1 and 2 % of E.
"""

import sys

import numpy as np
from asperity_fe import solve_asperity

from faying import RIGID, ContactPair, Material
from faying.contact.asperity.jackson_green import JacksonGreen
from faying.contact.asperity.kogut_etsion import KogutEtsion
from faying.contact.asperity.unloading import EtsionKligermanKadin
from faying.style import new_panels, save

X = (1.5, 2, 3, 5.9, 6.1, 10, 20, 50, 76.8, 110)
STEEL = Material(name="steel", E=100e9, nu=0.3, yield_strength=355e6, hardness=994e6)


def main(path: str, elements: int = 32) -> None:
    pair = ContactPair(STEEL, RIGID)
    ke, jg = KogutEtsion(R=1.0, pair=pair), JacksonGreen(R=1.0, pair=pair)
    fig = new_panels(3, width=4.4, height=3.6)
    for hardening, style in ((0.0, "-"), (0.01, "--"), (0.02, ":")):
        rows = []
        for x in X:
            d = x * ke.critical
            found = solve_asperity(
                R=1.0,
                h_a=1.0,
                cap=STEEL,
                substrate=RIGID,
                foot="sliding",
                displacement=(d, 0.0),
                hardening=hardening,
                elements=elements,
            )
            top = int(np.argmax(found.history.displacement))
            force, area = found.history.force[top], found.history.area[top]
            residual = EtsionKligermanKadin(loading=ke, delta_max=d).residual
            a, b = ke.at(d), jg.at(d)
            rows.append(
                [
                    force / a.force - 1,
                    force / b.force - 1,
                    area / a.area - 1,
                    area / b.area - 1,
                    found.residual / residual - 1,
                ]
            )
            print(f"Et/E {hardening:<5} x {x:6.1f}  " + "  ".join(f"{100 * v:+6.2f} %" for v in rows[-1]))
        ke_f, jg_f, ke_a, jg_a, ekk = 100 * np.array(rows).T
        note = f"Et = {hardening:g} E"
        for ax, pairs in zip(
            fig.axes, (((ke_f, "KE"), (jg_f, "JG")), ((ke_a, "KE"), (jg_a, "JG")), ((ekk, "EKK"),)), strict=True
        ):
            for i, (value, law) in enumerate(pairs):
                ax.plot(X, value, style, color=f"C{i}", marker="o", ms=3, label=f"{law}, {note}")
    for ax, title in zip(fig.axes, ("force", "area", "residual displacement"), strict=True):
        ax.set(xscale="log", xlabel="x = displacement / critical", title=title, ylim=(-10, 10))
        ax.set_ylabel("finite elements - law [%]")
        ax.axhspan(-4, 4, color="0.92", zorder=0)
        ax.legend(fontsize=7)
        ax.grid(alpha=0.3)
    save(fig, path)


if __name__ == "__main__":
    main(*sys.argv[1:2])
