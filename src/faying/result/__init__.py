"""The result of a study, as it is kept in memory and on disk."""

from faying.result.bolts import BoltNumbers
from faying.result.result import Comparison, Provenance, Receptance, Result, read_model_modes

__all__ = ["BoltNumbers", "Comparison", "Provenance", "Receptance", "Result", "read_model_modes"]
