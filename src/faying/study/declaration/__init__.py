"""How keys of a study are declared, read and checked."""
