"""Bolts: threads, tightening, compliance."""
