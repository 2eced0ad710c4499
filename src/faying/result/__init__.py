"""The result of a study, as it is kept in memory and on disk."""

from faying.result.bolts import BoltNumbers
from faying.result.provenance import Provenance
from faying.result.result import Result, read_model_modes
from faying.result.run_record import MeasuredComparison, Receptance

__all__ = ["BoltNumbers", "MeasuredComparison", "Provenance", "Receptance", "Result", "read_model_modes"]
