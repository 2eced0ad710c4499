"""A small result with every field filled in, for tests of what is made from results."""

import numpy as np

from faying.result import Result


def small_result(loads=(2e3, 8e3), joints=("a", "b"), bolts=("left", "right"), **changes):
    """Two modes, four points on the first joint and one on each other, one triangle; `changes` replace fields."""
    count, points = len(loads), 3 + len(joints)
    f = np.array([[100.0 + 10 * k, 300.0 + 10 * k] for k in range(count)])
    q = np.ones((count, points))
    per_joint = np.full((count, len(joints)), 1e9)
    given = {
        "title": "mass",
        "loads": np.array(loads),
        "frequencies": f,
        "loss_factors": 0.02 + 0 * f,
        "loss_error": 0 * f,
        "free": f[0],
        "bonded": f[-1],
        "rigid": np.zeros(6),
        "mac": np.stack([np.eye(2)] * count),
        "points": np.zeros((points, 3)),
        "weights": np.ones(points),
        "joint_of_point": np.array([0, 0, 0, 0, *range(1, len(joints))]),
        "pressure": q,
        "k_n": q,
        "k_t": q,
        "slipping": 0 * per_joint,
        "total_k_n": per_joint,
        "total_k_t": per_joint,
        "outside_share": np.zeros(count),
        "above_range_share": np.zeros(count),
        "bolt_forces": np.outer(loads, np.linspace(1, 0.75, len(bolts))),
        "imbalance": np.full(count, 1e-12),
        "newton_steps": np.full(count, 7),
        "outline": np.eye(3),
        "triangles": np.array([[0, 1, 2]]),
        "shapes": np.ones((count, 2, 3, 3)),
        "part_masses": np.array([1.0]),
        "slip": 0 * q,
        "gap": np.zeros(points),
        "bolt_seats": np.zeros((len(bolts), 2, 3)),
        "bolt_diameters": np.full(len(bolts), np.nan),
        "bolt_extents": np.tile([0.01, 0.02], (len(bolts), 1)),
        "parts": ("part",),
        "faces": (),
        "joint_faces": tuple((f"{name}.first", f"{name}.second") for name in joints),
        "joints": joints,
        "bolts": bolts,
        "unknowns": 90,
        "solver": "none",
        "surfaces": tuple({"D": 2.4} for _ in joints),
        "laws": tuple({"name": "JK", "cutoff": 0.01, "greatest_pressure [Pa]": 1e9} for _ in joints),
    }
    given |= changes
    none = np.zeros(len(given["triangles"]), dtype=int)
    follow = {"shapes_imaginary": 0 * given["shapes"], "part_of_triangle": none, "face_of_triangle": none - 1}
    return Result(**(follow | given))
