"""The study file and the one pipeline that runs it."""

from faying.study.case import build
from faying.study.run import run
from faying.study.study import Study

__all__ = ["Study", "build", "run"]
