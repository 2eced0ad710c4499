"""Samples of a study or of a surrogate, and how they are drawn and kept."""
