"""Sliding in a joint: hysteresis of each point, the reduced model, and its nonlinear modes."""
