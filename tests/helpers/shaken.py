"""Masses in a row that noise shakes, by integration in time: many realisations at once, each with its own sliders."""

import numpy as np


def integrated(masses, springs, stiffness, limits, *, density, damping, time, realisations, seed=1, steps=40):
    """Motion of each mass against its moving base, after the first fifth of the time.

    The first spring stands on the base, sliders act between it and the first mass. Central differences, with `damping`
    of each mode at rest; density: one-sided, of the acceleration of the base; steps: in a period of the fastest mode.

    Returns:
        Motion (k, realisation, mass) and the time between its rows; each tenth step has a row.
    """
    n = len(masses)
    K = stiffness_of(springs)
    at_rest = K.copy()
    at_rest[0, 0] += np.sum(stiffness)
    root = 1 / np.sqrt(masses)
    squared, shapes = np.linalg.eigh(root[:, None] * at_rest * root)
    modes = root[:, None] * shapes
    C = np.diag(masses) @ modes @ np.diag(2 * damping * np.sqrt(squared)) @ modes.T @ np.diag(masses)
    dt = 2 * np.pi / np.sqrt(squared[-1]) / steps
    count = int(time / dt)
    rng = np.random.default_rng(seed)
    x, v = np.zeros((2, realisations, n))
    stretch, reach = np.zeros((realisations, len(stiffness))), limits / stiffness
    out = []
    for k in range(count):
        stretch = np.clip(stretch, -reach, reach)
        force = -x @ K - v @ C
        force[:, 0] -= stretch @ stiffness
        force -= np.sqrt(density / (2 * dt)) * rng.standard_normal((realisations, 1)) * masses
        v = v + dt * force / masses  # half a step ahead of x
        x = x + dt * v
        stretch = stretch + dt * v[:, :1]
        if k > count / 5 and k % 10 == 0:
            out.append(x)
    return np.array(out), 10 * dt, modes


def stiffness_of(springs):
    """Of masses in a row, each on a spring to the one before, the first to the base."""
    n = len(springs)
    K = np.zeros((n, n))
    for i, k in enumerate(springs):
        K[i, i] += k
        if i:
            K[i - 1, i - 1] += k
            K[i, i - 1] = K[i - 1, i] = -k
    return K
