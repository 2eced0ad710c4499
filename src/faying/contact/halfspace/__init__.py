"""Numerical contact of a height map: elastic, saturated at hardness, its tangent stiffness, slip, and a law from it."""

from faying.contact.halfspace.law import HalfSpace
from faying.contact.halfspace.solution import HalfSpaceContact
from faying.contact.halfspace.solve import certify, solve_half_space

__all__ = ["HalfSpace", "HalfSpaceContact", "certify", "solve_half_space"]
