"""Load cases without a solution: a ring of pressure on one joint that a load shifts and opens."""

import numpy as np

from faying.loads.record import LoadCases


def made(cases=("10 g", "left_1", "both of them, one after the other")):
    """A square joint of 400 points between two bolts."""
    line = (np.arange(20) + 0.5) / 20 * 0.04
    x, y = (one.ravel() for one in np.meshgrid(line, line, indexing="ij"))
    rest = 2e7 * np.exp(-(((x - 0.02) ** 2 + (y - 0.02) ** 2) / 1e-4))
    count = len(cases)
    moved = [np.maximum(rest - 1e7 * (k + 1) * x, 0.0) for k in range(count)]
    weights = np.full(400, 4e-6)
    by_bolt, by_joint = np.ones((count, 2)), np.ones((count, 1))
    normal = np.array([[weights @ one] for one in moved])
    return LoadCases(
        title="a plate",
        preload=5e3,
        cases=cases,
        after=("",) * count,
        bolts=("left_1", "right"),
        joints=("flange_1",),
        superposition=np.linspace(0.001, 0.3, count),
        displacement=1e-5 * np.ones(count),
        error=np.zeros(count),
        bolt_force=5e3 * by_bolt + np.arange(count)[:, None],
        bolt_preload=np.full(2, 5e3),
        bolt_force_linear=5e3 * by_bolt,
        bolt_moment=by_bolt,
        bolt_shear=10 * by_bolt,
        working_load=100 * by_bolt,
        load_factor=0.1 * by_bolt,
        transverse_load=20 * by_bolt,
        seat_pressure=1e8 * by_bolt,
        head_friction=np.array([0.12, np.nan]),
        head_friction_needed=10 / 5e3 * by_bolt,
        cycles=np.zeros(len(by_bolt)),
        stress_amplitude=1e6 * by_bolt,
        damage=0 * by_bolt,
        slide_motion=1e-5 * by_bolt[0],
        normal_force=normal,
        normal_preload=np.array([weights @ rest]),
        friction=np.array([0.2]),
        shear_force=300 * by_joint,
        torque=2 * by_joint,
        mean_pressure=normal / weights.sum(),
        greatest_pressure=np.array([[one.max()] for one in moved]),
        opened=np.array([[np.mean(one <= 0)] for one in moved]),
        sliding=0.05 * by_joint,
        friction_needed=300 / normal,
        friction_needed_worst=400 / normal,
        worst_bolt=np.zeros((count, 1)),
        dissipated=1e-3 * by_joint,
        positions=np.stack([x, y, 0 * x], axis=1),
        areas=weights,
        joint_of_point=np.zeros(400),
        rest_pressure=rest,
        pressure=np.array(moved),
        shear=np.array(moved) / 10,
    )
