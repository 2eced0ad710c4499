"""Outer sides of elements on chosen nodes."""

import numpy as np

from faying.fe.sides import skin


def sides_on(chosen, blocks, nodes):
    """The outer sides all of whose nodes are among those chosen, normals outwards."""
    inside = np.zeros(nodes, dtype=bool)
    inside[chosen] = True
    picked = (side[inside[side].all(axis=1)] for side in skin(blocks, nodes))
    return tuple(side for side in picked if len(side))
