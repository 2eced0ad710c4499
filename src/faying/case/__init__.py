"""A study made ready, and solved at each preload."""
