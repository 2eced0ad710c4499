"""Frequency and damping against amplitude, for a study."""
