"""What scatters, and what a test can tell of it."""
