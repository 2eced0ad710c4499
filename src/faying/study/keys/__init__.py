"""The tables of a study file, one file each: what a user writes, checked, in SI units, with the files that it names."""
