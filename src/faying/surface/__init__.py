"""Measured heights in, numbers out."""

from faying.surface import synthesize

__all__ = ["synthesize"]
