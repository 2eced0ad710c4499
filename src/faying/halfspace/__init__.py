"""Numerical contact of a height map: elastic, saturated at hardness, its tangent stiffness and slip."""

from faying.halfspace.solution import HalfSpaceContact
from faying.halfspace.solve import error_bound, solve_half_space

__all__ = ["HalfSpaceContact", "error_bound", "solve_half_space"]
