"""Commands about tests, and what they tell of a model."""
