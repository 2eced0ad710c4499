"""Bolts: threads, tightening, compliance, and the sheet of VDI 2230."""
