"""One asperity: displacement in; force, area, stiffness and energy out. One published model per file."""
