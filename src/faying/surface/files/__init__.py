"""Scans from the files of instruments, and into files."""
