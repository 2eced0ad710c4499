"""A result of two boxes in a row with a joint and a bolt, with complex modes and pressures made by formula."""

import numpy as np

from faying.fe.interface import join
from faying.fe.outline import outline
from tests.helpers.boxes import stack
from tests.helpers.results import small_result

LOADS, MODES = 2, 3


def two_boxes(*, names=("flange",), title="two boxes", lengths=(0.1, 0.2), counts=(3, 6), **changes):
    """Waves along x whose imaginary part lags by a quarter; pressure falls from the middle of the joint."""
    mesh = stack(lengths, counts, width=0.05, height=0.04, sections=[(4, 4), (4, 4)])
    outer = outline(mesh, ("p0.right", "p1.left"))
    points = mesh.points[outer.nodes]
    met = join(mesh, "p0.right", "p1.left")
    arm = met.positions - met.positions.mean(axis=0)
    pressure = 8e6 * np.exp(-(arm**2).sum(axis=1) / 0.015**2) * np.array([[1.0], [2.0]])
    shapes, lagging = np.zeros((2, LOADS, MODES, len(points), 3))
    for load, mode in np.ndindex(LOADS, MODES):
        wave = 2 * np.pi * (mode + 1) * points[:, 0] / sum(lengths)
        shapes[load, mode, :, 2] = np.cos(wave) + 0.1 * load
        shapes[load, mode, :, 0] = 0.2 * points[:, 2] / 0.04
        lagging[load, mode, :, 2] = 0.5 * np.sin(wave)
    f = np.array([[100.0, 250.0, 600.0], [110.0, 260.0, 610.0]])
    given = {
        "title": title,
        "loads": np.array([2e3, 8e3]),
        "frequencies": f,
        "loss_factors": 0.01 + 0 * f,
        "loss_error": 0 * f,
        "free": f[0],
        "bonded": f[-1],
        "mac": np.stack([np.eye(MODES)] * LOADS),
        "points": met.positions,
        "weights": met.weights,
        "joint_of_point": np.zeros(len(met.weights)),
        "pressure": pressure,
        "k_n": 1e6 * pressure,
        "k_t": 0.8e6 * pressure,
        "slip": 1e-13 * pressure,
        "gap": 0 * met.weights,
        "outline": points,
        "triangles": outer.triangles,
        "part_of_triangle": outer.part_of_triangle,
        "face_of_triangle": outer.face_of_triangle,
        "faces": outer.faces,
        "parts": tuple(mesh.parts),
        "part_masses": np.array([1.57, 3.14]),
        "joint_faces": (("p0.right", "p1.left"),),
        "bolt_seats": np.array([[[0.0, 0.025, 0.02], [sum(lengths), 0.025, 0.02]]]),
        "bolt_diameters": np.array([0.008]),
        "bolt_extents": np.array([[0.0, 0.05]]),
        "shapes": shapes,
        "shapes_imaginary": lagging,
    }
    return small_result(**({"joints": names, "bolts": ("long",)} | given | changes))
