"""Sheets of bolts by VDI 2230: load cases at three preloads, steps R0 to R13, text and page."""
