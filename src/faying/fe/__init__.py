"""Finite elements for solids."""
