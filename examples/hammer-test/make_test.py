"""Make blocks.uff and frame.csv: a synthetic hammer test of the two blocks that `faying init` writes.

    python make_test.py

It is no measurement. What is hammered is a model, too, but another one than study.toml's: a finer mesh, a modulus 3 %
higher, a rougher surface, 7 kN, and 0.2 of the loss in the joint. Its full response, rigid motion and all, at eight
points gets noise of 0.5 %, and positions in a frame of the test's own, turned and shifted.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from faying.case.case import build
from faying.case.response import LoadedStructure
from faying.joint.tighten import tighten
from faying.measured.frf import FRF
from faying.measured.mapping import Transform
from faying.measured.uff_write import write_uff
from faying.numerics.damped import damped_modes
from faying.numerics.modes import lowest_modes
from faying.study import Study

HERE = Path(__file__).parent
POINTS = 8
PRELOAD, LOSS, STIFFER, ROUGHER = 7e3, 0.2, 1.03, 2.0


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


def hammered() -> LoadedStructure:
    """The structure that is hammered, at its preload."""
    study = Study.read(HERE / "study.toml")
    steel = study.materials["45 steel"]
    study = replace(
        study,
        materials=study.materials | {steel.name: replace(steel, E=STIFFER * steel.E)},
        geometry=replace(study.geometry, size=8e-3, face_size={"upper.joint": 4e-3}),
        surface=replace(study.surface, G=ROUGHER * study.surface.G),
    )
    structure = build(study)
    preload = tighten(structure, structure.assembly(), [PRELOAD])
    stiffness, loss = structure.coupled(structure.springs(preload.pressures))
    mass = structure.dynamic_matrices[1]
    modes = lowest_modes(stiffness, mass, 40, shift_frequency=structure.shift_frequency)
    damped = damped_modes(modes, stiffness, mass, LOSS * loss, rigid=6, count=30)
    return LoadedStructure(
        study=study, structure=structure, modes=modes, damped=damped, stiffness=stiffness, mass=mass, loss=LOSS * loss
    )


def main() -> None:
    """Write both files beside this one."""
    rng = np.random.default_rng(1)
    solved, turn = hammered(), frame()
    outline, _ = solved.structure.outline()
    points = solved.structure.mesh.points[outline]
    nodes = spread_nodes(points, POINTS)
    places = [(k + 1, d) for k in range(POINTS) for d in "xyz"]
    axes = np.tile(turn.directions(np.eye(3)), (POINTS, 1))
    frequency = np.arange(50.0, 19001, 50.0)
    outputs, inputs = (outline[np.repeat(nodes, 3)], axes), (outline[nodes[:1]], axes[2:3])
    full, notes = solved.at_test(frequency, outputs, inputs)
    print(*notes, sep="\n")
    values = -((2 * np.pi * frequency) ** 2) * full.receptance
    noise = rng.standard_normal((2, *values.shape))
    values = values + 0.005 * np.sqrt(np.mean(np.abs(values) ** 2)) * (noise[0] + 1j * noise[1]) / np.sqrt(2)
    here = (points[nodes] - turn.shift) @ turn.rotation
    positions = {k + 1: tuple(float(v) for v in xyz) for k, xyz in enumerate(here)}
    frf = FRF(
        frequency=frequency,
        values=values,
        outputs=tuple(places),
        inputs=((1, "z"),),
        quantity="accelerance",
        positions=positions,
    )
    write_uff(HERE / "blocks.uff", frf, title="two blocks, synthetic hammer test")
    rows = [f"{k + 1},{','.join(f'{1e3 * v:.3f}' for v in points[nodes[k]])}" for k in range(4)]
    (HERE / "frame.csv").write_text("\n".join(["point,x [mm],y [mm],z [mm]", *rows]) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
