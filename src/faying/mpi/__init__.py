"""Modes over several processes: partition, multigrid, and the scripts that each process runs."""
