"""Make blocks.uff and frame.csv: a synthetic hammer test of the two blocks that `faying init` writes.

    faying init study.toml && faying run study.toml && python make_test.py results/result.nc

It is no measurement: the model's own modes at 6 kN with frequencies shifted by up to 2.5 %, less damping, a rigid-body
line, noise of .5 %, and positions in a frame of the test's own, turned and shifted.
"""

import sys
from pathlib import Path

import numpy as np

from faying.measured.frf import FRF
from faying.measured.mapping import Transform
from faying.measured.model import ModelModes, read_model_modes
from faying.measured.uff_write import write_uff

HERE = Path(__file__).parent
POINTS = 8
SHIFT = (0.012, -0.009, 0.025, -0.018, 0.007, 0.02)


def frame() -> Transform:
    """From the test's frame to the model's: turned by 30 degrees about z and 90 about x, shifted."""
    a = np.radians(30)
    about_z = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1.0]])
    about_x = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    return Transform(rotation=about_z @ about_x, shift=np.array([0.05, -0.02, 0.1]))


def spread_nodes(points: np.ndarray, count: int) -> list[int]:
    """Nodes far from each other, the first a corner."""
    chosen = [int(np.argmin(points @ [1.0, 1.1, 1.2]))]
    while len(chosen) < count:
        distance = np.linalg.norm(points[:, None] - points[chosen], axis=2).min(axis=1)
        chosen.append(int(distance.argmax()))
    return chosen


def main(result: str) -> None:
    """Write both files beside this one."""
    rng = np.random.default_rng(1)
    model = read_model_modes(result)
    nodes = spread_nodes(model.points, POINTS)
    turn = frame()
    tested = ModelModes(
        frequencies=model.frequencies * (1 + np.array(SHIFT[: len(model.frequencies)])),
        loss_factors=0.15 * model.loss_factors,
        shapes=model.shapes,
        points=model.points,
    )
    places = [(k + 1, d) for k in range(POINTS) for d in "xyz"]
    axes = np.tile(turn.directions(np.eye(3)), (POINTS, 1))
    frequency = np.arange(0, 20001, 50.0)
    outputs, inputs = (np.repeat(nodes, 3), axes), (np.array([nodes[0]]), axes[2:3])
    values = tested.frf(frequency, outputs, inputs, "accelerance") + 0.4 * (axes @ axes[2])[:, None, None]
    noise = rng.standard_normal((2, *values.shape))
    values = values + 0.005 * np.sqrt(np.mean(np.abs(values) ** 2)) * (noise[0] + 1j * noise[1]) / np.sqrt(2)
    here = (model.points[nodes] - turn.shift) @ turn.rotation
    positions = {k + 1: tuple(float(v) for v in xyz) for k, xyz in enumerate(here)}
    frf = FRF(frequency=frequency, values=values, outputs=tuple(places), inputs=((1, "z"),), quantity="accelerance",
              positions=positions)  # fmt: skip
    write_uff(HERE / "blocks.uff", frf, title="two blocks, synthetic hammer test")
    rows = [f"{k + 1},{','.join(f'{1e3 * v:.3f}' for v in model.points[nodes[k]])}" for k in range(4)]
    (HERE / "frame.csv").write_text("\n".join(["point,x [mm],y [mm],z [mm]", *rows]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
