"""One asperity by finite elements: an elastic-plastic cap on its substrate under a smooth rigid plane."""

from faying.asperity_fe.drive import AsperityResult, Field, History, solve_asperity

__all__ = ["AsperityResult", "Field", "History", "solve_asperity"]
