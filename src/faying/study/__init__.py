"""The study file and the one pipeline that runs it."""

from faying.study.run import build, run
from faying.study.schema import Study

__all__ = ["Study", "build", "run"]
