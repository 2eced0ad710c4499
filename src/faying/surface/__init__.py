"""Measured heights in, numbers out."""
