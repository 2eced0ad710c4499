"""Other programs: one file for each, which reads its meshes and matrices and writes joints for it."""
