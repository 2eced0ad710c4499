"""Figures: one function per figure, data and Axes in, Axes out."""
