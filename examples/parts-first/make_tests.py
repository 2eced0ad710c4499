"""Print the tests of upper.toml and bolted.toml: weights and frequencies, with noise of 0.1 %.

    python make_tests.py

They are no measurements. What is weighed and hit is a model, too, but another one than that of the studies: a finer
mesh, Young's modulus, density and thickness of each block of its own, a stiffer law.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from faying.case.case import build
from faying.study import Study

HERE = Path(__file__).parent
FACTORS = {"upper": (1.035, 1.008, 1.012), "lower": (0.975, 0.995, 0.99)}  # on E, density and thickness
STIFFER, NOISE = 1.25, 1e-3
LISTED = 8  # frequencies


def listed(name: str, frequencies: np.ndarray, random: np.random.Generator) -> None:
    """Print frequencies as a study lists them."""
    noisy = frequencies * (1 + NOISE * random.standard_normal(len(frequencies)))
    words = [f'"{frequency:.0f} Hz"' for frequency in noisy]
    print(f"{name}: frequencies = [{', '.join(words)}]")


def main() -> None:
    """Solve each block alone, then both with their bolt."""
    random, study = np.random.default_rng(57), Study.read(HERE / "bolted.toml")
    whole = build(replace(study, geometry=replace(study.geometry, size=6e-3, face_size={"upper.joint": 4e-3})))
    points, materials = whole.mesh.points.copy(), {}
    plane = points[whole.mesh.face_nodes("upper.joint"), 2].mean()
    for part, (E, density, thickness) in FACTORS.items():
        steel, nodes = whole.materials[part], whole.mesh.part_nodes(part)
        materials[part] = replace(steel, E=E * steel.E, density=density * steel.density)
        points[nodes, 2] = plane + thickness * (points[nodes, 2] - plane)
    true = replace(
        whole,
        mesh=replace(whole.mesh, points=points),
        materials=materials,
        joints=tuple(replace(joint, law=joint.law.scaled(STIFFER)) for joint in whole.joints),
    )
    for part in FACTORS:
        alone = true.alone(part)
        print(f"{part}: mass = {alone.mass:.4f} kg")
        listed(part, alone.solve(modes=LISTED).modes.frequencies, random)
    listed("both", true.solve("8 kN", modes=LISTED).modes.frequencies, random)


if __name__ == "__main__":
    main()
