"""Masses in a row that noise shakes, by integration in time: many realisations at once, each with its own sliders."""

from dataclasses import dataclass

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


@dataclass(frozen=True)
class Integrated:
    """Mean squares of the first coordinate and of its linear twin, by realisation, and the damping of the first."""

    square: np.ndarray
    linear: np.ndarray
    damping: float

    def sigma(self, exact):
        """The rms, with what the twin misses of its exact rms as a control variate."""
        covariance = np.cov(self.square, self.linear)
        return np.sqrt(self.square.mean() - covariance[0, 1] / covariance[1, 1] * (self.linear.mean() - exact**2))


def integrated_joints(slip, force, *, density, rest, linear, time, copies, seed=1, cap=8.0):
    """The lowest mode of a reduced structure under white noise, all of its modes in the motion of the joints.

    Central differences. Modes above `cap` times the first get so much mass that they follow at rest. linear: speed and
    damping of the twin under the same noise; density: one-sided, of the input; force: of the first mode, the only one
    that it drives.
    """
    speeds, shapes = slip.modes
    slip = slip.turned(shapes)
    speed, most = speeds[0], cap * speeds[0]
    mass = np.maximum(1.0, (speeds / most) ** 2)[:, None]
    loss = 2 * np.where(speeds < most, rest, 0.01)[:, None] * speeds[:, None] * np.sqrt(mass)
    dt = 0.7 / most
    rng = np.random.default_rng(seed)
    x, v = np.zeros((2, len(speeds), copies))
    twin, rate = np.zeros((2, copies))
    joints = [_Sliding(joint, copies) for joint in slip.joints]
    square, linear_square, lost, fast = np.zeros((4, copies))
    count = int(1.3 * time / dt)
    for k in range(count):
        inner = -slip.stiffness @ x - loss * v - sum(joint.force(x) for joint in joints)
        noise = force * np.sqrt(density / (2 * dt)) * rng.standard_normal(copies)
        before, total = v, inner.copy()
        total[0] += noise
        v = v + dt * total / mass  # half a step ahead of x
        x = x + dt * v
        rate = rate + dt * (noise - linear[0] ** 2 * twin - 2 * linear[1] * linear[0] * rate)
        twin = twin + dt * rate
        if k > 0.23 * count:
            middle = (v[0] + before[0]) / (2 * np.cos(speed * dt / 2))  # of a wave in central differences
            square, linear_square = square + x[0] ** 2, linear_square + twin**2
            lost, fast = lost - inner[0] * middle, fast + middle**2
    omega = np.sqrt(fast.sum() / square.sum())
    n = count - int(0.23 * count) - 1
    return Integrated(square / n, linear_square / n, lost.sum() / (2 * omega * fast.sum()))


class _Sliding:
    """The springs and sliders of a joint in many realisations: directions first, then points, springs, realisations."""

    def __init__(self, joint, copies):
        law, q = joint.law, len(joint.weights)
        self.relative = joint.relative.reshape(q, 3, -1).transpose(1, 0, 2)
        self.weights, self.rest = joint.weights[:, None], joint.at_rest[0][:, 0, None]
        self.approach = -(joint.rest[:, 0] + law.gap)[:, None, None] - law.onset[:, :, None]
        self.k_n, self.k_t = law.k_n[:, None], law.k_t[:, None]
        ratio = np.divide(law.k_n, law.k_t, out=np.zeros_like(law.k_n), where=law.k_t > 0)
        self.reach = law.friction * ratio[:, :, None]
        self.stretch, self.last = np.zeros((2, *law.onset.shape, copies)), np.zeros((3, q, copies))

    def force(self, x):
        """Force on the coordinates (m, realisations), less that at rest."""
        motion = self.relative @ x
        depth = np.maximum(self.approach - motion[0][:, None], 0.0)
        stretch = self.stretch + (motion - self.last)[1:, :, None]
        size = np.sqrt(stretch[0] ** 2 + stretch[1] ** 2) + 1e-30
        self.stretch = stretch * np.minimum(self.reach * depth / size, 1.0)
        self.last = motion
        shear = [(self.k_t @ one)[:, 0] for one in self.stretch]
        traction = np.stack([-(self.k_n @ depth)[:, 0] - self.rest, *shear])
        return np.einsum("iqm,iqr->mr", self.relative, traction * self.weights, optimize=True)
