"""Figures: one function each, data and Axes in, Axes out."""
