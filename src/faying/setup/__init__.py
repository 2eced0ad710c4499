"""From a STEP file to a study, and what a study is checked for."""
