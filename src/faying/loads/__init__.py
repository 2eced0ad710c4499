"""What a preloaded structure does under loads: forces of bolts, opening, slip."""
