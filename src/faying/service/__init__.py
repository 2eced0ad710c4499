"""Structures in service: random vibration and sine sweeps with damping that depends on the level."""
