"""A contact law on the faying faces of a structure."""
