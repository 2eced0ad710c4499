"""Macros for other programs."""
