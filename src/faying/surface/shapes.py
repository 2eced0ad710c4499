"""Removal of a sphere's or cylinder's form by least squares."""

from math import atan2

import numpy as np

from faying.errors import InputError, NotConverged
from faying.surface.scan import Scan
from faying.typing import Array

SAMPLE = 40000  # points that the shape is fitted to, evenly chosen


def _points(scan: Scan) -> tuple[Array, Array, Array]:
    known = np.flatnonzero(~np.isnan(scan.heights.ravel()))
    if len(known) < 16:
        raise InputError(f"{scan.source}: {len(known)} known points cannot fix a sphere or cylinder")
    chosen = known[:: max(1, len(known) // SAMPLE)]
    y, x = np.divmod(chosen, scan.shape[1])
    return x * scan.spacing[0], y * scan.spacing[1], scan.heights.ravel()[chosen]


def _quadratic(x: Array, y: Array, z: Array) -> Array:
    a = np.stack([np.ones_like(x), x, y, x * x / 2, x * y, y * y / 2], axis=1)
    return np.asarray(np.linalg.lstsq(a, z, rcond=None)[0], float)


def without_sphere(scan: Scan) -> tuple[Scan, float]:
    """Return the scan less its least-squares sphere, and that sphere's radius [m], positive for a cap (convex).

    The distance is taken along z. Raises NotConverged where the scan has no curvature to fit, InputError for too few
    known points.
    """
    x, y, z = _points(scan)
    cx, cy = x.mean(), y.mean()
    q = _quadratic(x - cx, y - cy, z)
    bend = (q[3] + q[5]) / 2
    size = max(scan.size)
    if abs(bend) * size < 1e-9:
        raise NotConverged(f"{scan.source}: the scan is flat, no sphere fits; level it by a plane")
    start = np.array([bend, q[0], -q[1] / bend, -q[2] / bend])

    def shape(t: Array, u: Array, v: Array) -> Array:
        # z = z0 + k r^2 / (1 + (1 - k^2 r^2)^(1/2)), k the signed curvature, r the distance from the apex
        r2 = (u - t[2]) ** 2 + (v - t[3]) ** 2
        return np.asarray(t[1] + t[0] * r2 / (1 + np.sqrt(np.maximum(1 - t[0] ** 2 * r2, 1e-6))))

    t = _solve(lambda t: shape(t, x - cx, y - cy) - z, start, size, z)
    gx = np.arange(scan.shape[1])[None, :] * scan.spacing[0] - cx
    gy = np.arange(scan.shape[0])[:, None] * scan.spacing[1] - cy
    return scan.with_heights(scan.heights - shape(t, gx, gy), f"sphere of {-1 / t[0]:.5g} m removed"), float(-1 / t[0])


def without_cylinder(scan: Scan) -> tuple[Scan, float, float]:
    """Return the scan less its least-squares cylinder, its radius [m] (positive where convex) and axis angle [rad].

    The axis may tilt; the angle runs from x towards y. Errors as in `without_sphere`.
    """
    x, y, z = _points(scan)
    cx, cy = x.mean(), y.mean()
    q = _quadratic(x - cx, y - cy, z)
    tensor = np.array([[q[3], q[4]], [q[4], q[5]]])
    values, vectors = np.linalg.eigh(tensor)
    main = int(np.argmax(np.abs(values)))
    size = max(scan.size)
    if abs(values[main]) * size < 1e-9:
        raise NotConverged(f"{scan.source}: the scan is flat, no cylinder fits; level it by a plane")
    normal = vectors[:, main]
    slope = np.array([q[1], q[2]])
    angle = atan2(normal[1], normal[0])
    tilt = float(slope @ np.array([-np.sin(angle), np.cos(angle)]))
    start = np.array([values[main], q[0], -float(slope @ normal) / values[main], tilt, angle])

    def shape(t: Array, u: Array, v: Array) -> Array:
        across, along = u * np.cos(t[4]) + v * np.sin(t[4]), -u * np.sin(t[4]) + v * np.cos(t[4])
        r2 = (across - t[2]) ** 2
        return np.asarray(t[1] + t[3] * along + t[0] * r2 / (1 + np.sqrt(np.maximum(1 - t[0] ** 2 * r2, 1e-6))))

    t = _solve(lambda t: shape(t, x - cx, y - cy) - z, start, size, z)
    gx = np.arange(scan.shape[1])[None, :] * scan.spacing[0] - cx
    gy = np.arange(scan.shape[0])[:, None] * scan.spacing[1] - cy
    radius, axis = float(-1 / t[0]), float((t[4] + np.pi / 2) % np.pi)
    left = scan.with_heights(scan.heights - shape(t, gx, gy), f"cylinder of {radius:.5g} m removed")
    return left, radius, axis


def _solve(residual: object, start: Array, size: float, z: Array) -> Array:
    from scipy.optimize import least_squares

    spread = max(float(np.std(z)), 1e-300)
    scale = np.array([spread / size**2, spread, size, spread / size, 1.0])[: len(start)]
    if len(start) == 4:
        scale = np.array([spread / size**2, spread, size, size])
    found = least_squares(residual, start, x_scale=scale, ftol=1e-14, xtol=1e-14, gtol=None)
    if not found.success or not np.isfinite(found.x).all():
        raise NotConverged("the least-squares fit of the shape did not converge; remove a polynomial instead")
    return np.asarray(found.x, float)
