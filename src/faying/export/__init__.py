"""A joint laid on the model of another program."""
