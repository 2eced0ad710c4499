"""Hammer tests: frequency response functions and modes read, identified, and set beside the model's."""
