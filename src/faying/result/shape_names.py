"""Mode shapes in words: bending, torsion or stretching of a long structure, else which part moves most."""

import numpy as np

from faying.result.run_record import RunRecord
from faying.typing import Array

BOTH = 0.6  # of the greater motion that the other parts must have for "all"
SLENDER = 2.5  # times the next longest side: longer structures bend, twist and stretch
SLICES = 16  # along a long structure
MOSTLY = 0.7  # of the mean square motion that a word must account for


def part_and_axis(result: RunRecord, mode: int, load: int = -1) -> tuple[str, str]:
    """Which part moves most ("all" or "both" where they move alike, "" where there is one), and along which axis."""
    shape = result.shapes[load, mode].astype(float)
    part_of_node = np.zeros(len(shape), dtype=int)
    part_of_node[result.triangles.ravel()] = np.repeat(result.part_of_triangle, 3)
    parts = [np.sqrt(np.mean(shape[part_of_node == k] ** 2, axis=0)) for k in range(len(result.parts))]
    sizes = np.array([np.linalg.norm(one) for one in parts])
    axis = "xyz"[int(np.argmax(np.sum(np.square(parts), axis=0)))] if parts else ""
    if len(parts) < 2:
        return "", axis
    if np.sort(sizes)[0] > BOTH * sizes.max():
        return "all" if len(parts) != 2 else "both", axis
    return result.parts[int(np.argmax(sizes))], axis


def shape_name(result: RunRecord, mode: int, load: int = -1) -> str:
    """Return a short name of a mode shape: "bending, y", "torsion", "stretch", or which part moves along which axis."""
    found = long_shape(result.outline, result.shapes[load, mode].astype(float))
    if found:
        return found
    part, axis = part_and_axis(result, mode, load)
    return ", ".join(filter(None, (part, axis)))


def long_shape(points: Array, shape: Array) -> str:
    """Return what a long structure does in a shape (n, 3) of its points (n, 3) [m]; "" where no one word fits.

    The structure is cut into slices across its longest side. The motion of each is split, as that of a rigid slice,
    into one across that side with a tilt (bending), one along it (stretch), and a turn about it (torsion). Each slice
    counts alike; the word is that of what holds most of the mean square.
    """
    extents = np.ptp(points, axis=0)
    along = int(np.argmax(extents))
    across = [k for k in range(3) if k != along]
    if extents[along] < SLENDER * max(extents[across].max(), 1e-300):
        return ""
    slices = np.minimum((points[:, along] - points[:, along].min()) / extents[along] * SLICES, SLICES - 1).astype(int)
    energy, total = np.zeros(4), 0.0  # bending in two directions, stretch, torsion
    for k in np.unique(slices):
        here = slices == k
        motion, arm = shape[here], points[here][:, across]
        mean, arm = motion.mean(axis=0), arm - arm.mean(axis=0)
        turned = np.stack([-arm[:, 1], arm[:, 0]], axis=1)
        square = np.mean(arm**2, axis=0)
        inner = motion - mean
        tilt = np.divide(np.mean(inner[:, [along]] * arm, axis=0) ** 2, square, out=np.zeros(2), where=square > 0)
        turn = np.mean(np.sum(inner[:, across] * turned, axis=1)) ** 2 / max(float(square.sum()), 1e-300)
        energy += [*(mean[across] ** 2 + tilt), mean[along] ** 2, turn]
        total += float(np.mean(np.sum(motion**2, axis=1)))
    if total <= 0:
        return ""
    bending = float(energy[:2].sum())
    kinds = {"bending": bending, "stretch": float(energy[2]), "torsion": float(energy[3])}
    kind = max(kinds, key=kinds.__getitem__)
    if kinds[kind] < MOSTLY * total:
        return ""
    return f"bending, {'xyz'[across[int(np.argmax(energy[:2]))]]}" if kind == "bending" else kind
