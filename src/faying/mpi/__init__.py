"""Solutions over several processes: partition, multigrid, and the script that each process runs."""
