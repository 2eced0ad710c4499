"""Mode 1 of the beam against its amplitude, flat and with the measured form, beside the published curves.

python examples/brake-reuss-beam/backbone.py [FOLDER]. The published curves are brb_epmc_flat.yaml and
brb_epmc_meso.yaml of github tmd-lab/tmdsimpy (examples/structures/results, MIT), looked for in FOLDER, or in
FAYING_DATA/brake-reuss-backbones; without them only ours are printed. Nothing is fitted: friction 0.03 and the viscous
part of 0.087 % are those of the published model.
"""

import os
import sys
from pathlib import Path

import numpy as np

import faying
from faying.measured.ring_down import MeasuredBackbone
from faying.result.backbone import panel
from faying.style import new_figure, save

HERE = Path(__file__).parent
DATA = Path(os.environ.get("FAYING_DATA", HERE.parents[2] / "shared" / "data")) / "brake-reuss-backbones"
FRICTION, VISCOUS, RANGE = 0.03, 0.00087, (0.3, 60.0)
LEVELS = 1.0, 3.0, 10.0, 20.0, 40.0, 59.5  # m/s2


def published(path: Path) -> MeasuredBackbone:
    """The curve in a published file: lines of names and lists of numbers."""
    rows = dict(line.split(":", 1) for line in path.read_text().splitlines() if ":" in line)
    found = {name.strip(): np.array([float(v) for v in text.strip(" []").split(",")]) for name, text in rows.items()}
    return MeasuredBackbone.of_points(
        found["acceleration_amplitude"],
        found["frequency_rad_per_s"] / (2 * np.pi),
        found["damping_factor_frac_crit"],
        source="published.yaml",
    )


def row(curve: faying.Backbone, theirs: MeasuredBackbone | None, level: float) -> str:
    """One line of the table: frequency, its fall and the damping, ours and theirs."""
    f, z = (float(x) for x in curve.at_acceleration(level))
    text = f"{level:6.4g} m/s2: {f:8.3f} Hz, {100 * (1 - f / curve.linear_frequency):6.3f} % down, {100 * z:6.4f} %"
    if theirs is None:
        return text
    x = np.log(theirs.acceleration)
    f, z = np.interp(np.log(level), x, theirs.frequency), np.exp(np.interp(np.log(level), x, np.log(theirs.damping)))
    return f"{text}; published {f:8.3f} Hz, {100 * (1 - f / theirs.frequency[0]):6.3f} % down, {100 * z:6.4f} %"


def main() -> None:
    """Compute both curves, print them, and draw the figure of docs/backbone.md."""
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else DATA
    fig = new_figure(7.4, 5.6)
    axes = fig.subplots(2, 2, sharex=True, squeeze=False)
    for column, (name, file) in enumerate((("flat", "brb_epmc_flat.yaml"), ("measured-form", "brb_epmc_meso.yaml"))):
        out = HERE / "results" / f"backbone-{name}.nc"
        out.parent.mkdir(exist_ok=True)
        if out.is_file():
            curve = faying.Backbone.load(out)
        else:
            study = HERE / f"{name}.toml"
            curve = faying.backbone(study, 1, FRICTION, RANGE, rest_damping=VISCOUS, out=out)
        theirs = published(folder / file) if (folder / file).is_file() else None
        print(f"{name}: {curve.linear_frequency:.3f} Hz at rest")
        for level in LEVELS:
            print(row(curve, theirs, level))
        for line, quantity in enumerate(("frequency", "damping")):
            panel(axes[line, column], [curve], quantity, [] if theirs is None else [theirs])
        axes[0, column].set_title(name.replace("-", " "), fontsize=10)
        axes[1, column].set_xlabel("acceleration at the tip [m/s²]")
    axes[0, 0].set_xlim(0.25, 70)
    axes[0, 0].legend(fontsize=8)
    print(save(fig, HERE / "results" / "backbone.png"))


if __name__ == "__main__":
    main()
