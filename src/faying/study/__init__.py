"""The study file: what it may say, and what it says."""

from faying.study.study import Study

__all__ = ["Study"]
