"""One asperity by finite elements: an elastic-plastic cap on its substrate under a smooth rigid plane.

A program beside the library, whose tests press it beside the published laws of one asperity. See
docs/theory/asperity-fe.md.
"""

from asperity_fe.drive import solve_asperity
from asperity_fe.result import AsperityResult, CapField, History

__all__ = ["AsperityResult", "CapField", "History", "solve_asperity"]
