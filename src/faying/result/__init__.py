"""The result of a study, as it is kept in memory and on disk."""

from faying.result.bolts import BoltNumbers
from faying.result.provenance import Provenance
from faying.result.result import MeasuredComparison, Receptance, Result, read_model_modes

__all__ = ["BoltNumbers", "MeasuredComparison", "Provenance", "Receptance", "Result", "read_model_modes"]
