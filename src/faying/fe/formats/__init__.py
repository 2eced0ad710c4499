"""Readers of mesh files: each gives what its file holds, in the file's own numbers and unit."""
