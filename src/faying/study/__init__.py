"""The study file and the one pipeline that runs it."""

from faying.study.build import build
from faying.study.run import run
from faying.study.schema import Study

__all__ = ["Study", "build", "run"]
