"""One asperity by finite elements: an elastic-plastic cap on its substrate under a smooth rigid plane."""

from faying.asperity_fe.drive import solve_asperity
from faying.asperity_fe.result import AsperityResult, CapField, History

__all__ = ["AsperityResult", "CapField", "History", "solve_asperity"]
